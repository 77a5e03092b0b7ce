//! What a shop wants of a plan: known small cases, each with the twin that must say the opposite.

use super::build::{assembly, cuboid};
use super::made::held;
use super::{Made, planned};
use glam::DVec3;
use std::path::Path;
use std::process::{Command, Output};
use weavelock::assembly::PartIx;
use weavelock::sequence::wanted::{Ask, Chosen, Preferred, Rest, Table, Wish, prefer};
use weavelock::sequence::{Motions, Plan, plan_by};
use weavelock::verify::plan::{Checked, check};
use weavelock::watch::Watch;

fn ask(first: &[Wish]) -> Ask {
    let mut ranked = Wish::RANKED;
    ranked.sort_by_key(|w| first.iter().position(|f| f == w).unwrap_or(first.len()));
    Ask { up: DVec3::Z, table: Table::There, ranked, flexible: Default::default() }
}

/// The plan as preferred, which the checker must accept.
fn preferred(made: &Made, ask: &Ask) -> (Plan<()>, Preferred) {
    let mut plan = planned(made);
    let found = prefer(&made.0, &made.1, &mut plan, ask, false, &Watch::default());
    let checked = check(&made.0, &plan);
    assert!(matches!(checked, Checked::Valid { .. }), "{checked:?}\n{plan:#?}");
    (plan, found)
}

fn order(plan: &Plan<()>) -> Vec<&str> {
    plan.steps.iter().map(|s| s.parts[0].as_str()).collect()
}

fn stack() -> Made {
    assembly(vec![
        ("low", vec![cuboid([0., 0., 0.], [2., 2., 1.])]),
        ("mid", vec![cuboid([0., 0., 1.], [2., 2., 2.])]),
        ("top", vec![cuboid([0., 0., 2.], [2., 2., 3.])]),
    ])
}

#[test]
fn a_stack_is_built_from_the_table_up_along_one_direction() {
    let made = stack();
    for (up, out) in [(DVec3::Z, ["top", "mid"]), (DVec3::NEG_Z, ["low", "mid"])] {
        let (plan, found) = preferred(&made, &Ask { up, ..ask(&[]) });
        assert_eq!(order(&plan), out, "up is {up}");
        let counts = Wish::RANKED.map(|w| found.judged.count(w));
        assert_eq!(counts, [Some(0), Some(2), Some(0), Some(0), Some(1)], "up is {up}");
        assert_eq!((found.judged.from_above, found.judged.least_steps), (2, 2));
    }
}

/// A beam on a post at its end tips over; with a second post under the other end it rests. Without a table the first part
/// is on the bench and the second post is not.
#[test]
fn a_beam_rests_on_two_posts_and_not_on_one() {
    let post = |x: f64| vec![cuboid([x, 0., 0.], [x + 1., 1., 1.])];
    let beam = ("beam", vec![cuboid([0., 0., 1.], [4., 1., 2.])]);
    let one = assembly(vec![("left", post(0.)), beam.clone()]);
    let (_, found) = preferred(&one, &ask(&[]));
    let [Rest::Held { parts, share }] = &found.judged.rests[..] else {
        panic!("it tips: {:?}", found.judged.rests)
    };
    assert_eq!((parts.as_slice(), *share > 0.1), (&[PartIx(1)][..], true));
    let two = assembly(vec![("left", post(0.)), ("right", post(3.)), beam.clone()]);
    let (plan, found) = preferred(&two, &ask(&[]));
    assert_eq!(order(&plan)[0], "beam", "it goes in last");
    assert_eq!(found.judged.count(Wish::Air), Some(0));
    let bench = Ask { table: Table::None, ..ask(&[]) };
    let (_, found) = preferred(&two, &bench);
    assert!(found.judged.count(Wish::Air) > Some(0), "the second post stands on nothing");
}

/// A plate with a tower near one corner, on three posts that lie farthest out; only a fourth one, between two of those and
/// farthest along no axis, holds the tower up.
#[test]
fn a_corner_that_lies_farthest_along_no_axis_bears_what_only_it_can() {
    let post = |x: f64, y: f64| cuboid([x, y, 1.], [x + 0.2, y + 0.2, 2.]);
    let base = || vec![cuboid([0., 0., 0.], [10., 10., 1.]), post(0., 0.), post(9.8, 4.), post(4., 9.8)];
    let top = || vec![cuboid([0., 0., 2.], [10., 10., 2.1]), cuboid([7., 7., 2.1], [9., 9., 22.1])];
    let three = assembly(vec![("base", base()), ("top", top())]);
    let (_, found) = preferred(&three, &ask(&[]));
    assert!(matches!(found.judged.rests[..], [Rest::Held { .. }]), "{:?}", found.judged.rests);
    let four = [base(), vec![post(9., 9.)]].concat();
    let (_, found) = preferred(&assembly(vec![("base", four), ("top", top())]), &ask(&[]));
    assert_eq!(found.judged.rests, [Rest::Rests]);
}

/// A lid that is first shifted in its case and then lifted rests in its place; the case, too, whatever moves within.
#[test]
fn what_moves_within_a_set_first_is_judged_at_its_place() {
    let case = vec![
        cuboid([0., 0., 0.], [4., 2., 1.]),
        cuboid([0., 0., 1.], [1., 2., 2.]),
        cuboid([0., 0., 2.], [2., 2., 3.]),
        cuboid([3., 0., 1.], [4., 2., 3.]),
        cuboid([1., -1., 0.], [3., 0., 3.]),
        cuboid([1., 2., 0.], [3., 3., 3.]),
    ];
    let made = held(assembly(vec![("case", case), ("bolt", vec![cuboid([1., 0., 1.], [2., 2., 2.])])]), 0);
    let all: Vec<PartIx> = made.0.ids().collect();
    let mut plan = plan_by(&made.0, &all, &made.1, Motions::Any, |_| None::<()>).expect("sane parts");
    let found = prefer(&made.0, &made.1, &mut plan, &ask(&[]), false, &Watch::default());
    assert_eq!(plan.steps.len(), 2, "to the side, then up: {plan:#?}");
    assert_eq!(found.judged.rests, [Rest::Rests, Rest::Undecided]);
}

/// Sixty-four pieces that touch at a hundred thousand corners: each set is decided.
#[test]
#[ignore = "ten seconds"]
fn how_woven_swatches_rest_is_decided() {
    let joined = crate::support::joined(&crate::support::woven(
        [1, 1, 1],
        8,
        "[swatch]\nwefts = 8\nwarps = 8\ncut = \"tiles\"\nrepeat = 1\n",
    ));
    let made = (joined.assembly, joined.patches);
    let mut plan = planned(&made);
    let found = prefer(&made.0, &made.1, &mut plan, &ask(&[]), false, &Watch::default());
    assert_eq!((found.judged.rests.len(), found.judged.rests.contains(&Rest::Undecided)), (63, false));
}

/// A contact on its side alone bears no weight: hands lift the shelf, which is one of three units of volume, at its middle.
#[test]
fn a_part_beside_another_in_the_air_does_not_rest() {
    let made = assembly(vec![
        ("block", vec![cuboid([0., 0., 0.], [1., 1., 2.])]),
        ("shelf", vec![cuboid([1., 0., 1.], [2., 1., 2.])]),
    ]);
    let (_, found) = preferred(&made, &ask(&[]));
    assert!(matches!(&found.judged.rests[0], Rest::Held { parts, share }
        if parts == &[PartIx(1)] && (share - 1.0 / 3.0).abs() < 1e-6));
}

#[test]
fn the_ranking_decides_between_a_flexible_part_and_one_in_the_air() {
    let made = stack();
    let flexible = [PartIx(0)].into_iter().collect();
    let soft = Ask { flexible, ..ask(&[Wish::Flexible]) };
    let (plan, found) = preferred(&made, &soft);
    assert_eq!(order(&plan)[0], "low", "last in, first out");
    assert_eq!(found.judged.count(Wish::Flexible), Some(0));
    assert!(found.judged.count(Wish::Air) >= Some(1) || found.judged.count(Wish::Above) >= Some(1));
    let firm = Ask { ranked: ask(&[Wish::Air, Wish::Above]).ranked, ..soft };
    let (plan, found) = preferred(&made, &firm);
    assert_eq!(order(&plan), ["top", "mid"]);
    assert_eq!((found.judged.count(Wish::Air), found.judged.count(Wish::Flexible)), (Some(0), Some(2)));
    let at = firm.ranked.iter().position(|w| *w == Wish::Flexible).expect("all are ranked");
    assert_eq!(found.alone[at], Some(0), "what the ranking costs it is told");
}

/// A rail that slides out at either end of its groove comes from above, whichever end that is.
#[test]
fn a_single_step_comes_from_the_better_side() {
    let groove = vec![
        cuboid([0., 0., 0.], [3., 4., 1.]),
        cuboid([0., 0., 1.], [1., 4., 2.]),
        cuboid([2., 0., 1.], [3., 4., 2.]),
        cuboid([0., 0., 2.], [3., 4., 3.]),
    ];
    let made = assembly(vec![("groove", groove), ("rail", vec![cuboid([1., 0., 1.], [2., 4., 2.])])]);
    for up in [DVec3::Y, DVec3::NEG_Y] {
        let (_, found) = preferred(&made, &Ask { up, ..ask(&[Wish::Above]) });
        assert_eq!((found.judged.count(Wish::Above), found.judged.from_above), (Some(0), 1), "up is {up}");
        assert_eq!(found.judged.through_table, 0, "up is {up}");
    }
}

/// A drawer in a case open at one side comes sideways, whatever is wished.
#[test]
fn what_cannot_be_met_is_said() {
    let case = vec![
        cuboid([0., 0., 0.], [3., 3., 1.]),
        cuboid([0., 0., 2.], [3., 3., 3.]),
        cuboid([0., 0., 1.], [1., 3., 2.]),
        cuboid([1., 0., 1.], [3., 1., 2.]),
        cuboid([1., 2., 1.], [3., 3., 2.]),
    ];
    let made = assembly(vec![("case", case), ("drawer", vec![cuboid([1., 1., 1.], [3., 2., 2.])])]);
    let (_, found) = preferred(&made, &ask(&[Wish::Above]));
    assert_eq!(found.judged.count(Wish::Above), Some(1));
    assert_eq!(found.alone[0], Some(1));
    assert_eq!(found.judged.count(Wish::Air), Some(0), "it lies on the case's floor");
}

/// Loose blocks on a plate: no order is better than one found by trying all.
#[test]
fn the_order_of_few_parts_is_the_best_of_all() {
    let mut parts = vec![("plate", vec![cuboid([0., 0., 0.], [9., 3., 1.])])];
    let names = ["a", "b", "c", "d"];
    for (k, name) in names.iter().enumerate() {
        let x = 2.0 * k as f64;
        parts.push((*name, vec![cuboid([x, 0., 1.], [x + 2., 3., 2.])]));
    }
    parts.push(("lid", vec![cuboid([0., 0., 2.], [8., 3., 3.])]));
    let made = assembly(parts);
    let (plan, found) = preferred(&made, &ask(&[Wish::Air, Wish::Above, Wish::Directions]));
    assert_ne!(found.chosen, Chosen::Some, "few enough for all orders");
    assert_eq!(order(&plan)[0], "lid");
    let counts = [Wish::Air, Wish::Above, Wish::Directions].map(|w| found.judged.count(w));
    assert_eq!(counts, [Some(0), Some(0), Some(1)]);
}

/// Two halves, each with a tab under the other, stand in a well: they leave it together and come apart outside.
fn halves_in_a_well(walls: bool) -> Made {
    let left = vec![
        cuboid([0., 0., 0.], [1., 3., 2.]),
        cuboid([1., 0., 0.], [2., 2., 2.]),
        cuboid([1., 2., 1.], [2., 3., 2.]),
        cuboid([2., 0., 0.], [3., 1., 1.]),
    ];
    let right = vec![
        cuboid([3., 0., 0.], [4., 3., 2.]),
        cuboid([2., 1., 0.], [3., 3., 2.]),
        cuboid([2., 0., 1.], [3., 1., 2.]),
        cuboid([1., 2., 0.], [2., 3., 1.]),
    ];
    let mut well = vec![cuboid([-1., -1., -1.], [5., 4., 0.])];
    if walls {
        well.extend([cuboid([-1., -1., 0.], [0., 4., 2.]), cuboid([4., -1., 0.], [5., 4., 2.])]);
        well.extend([cuboid([0., -1., 0.], [4., 0., 2.]), cuboid([0., 3., 0.], [4., 4., 2.])]);
    }
    let cap = vec![cuboid([0., 0., 2.], [4., 3., 3.])];
    held(assembly(vec![("well", well), ("left", left), ("right", right), ("cap", cap)]), 0)
}

/// Groups are put in order, too, and come apart as the planner found; without the walls there is no group.
#[test]
fn groups_are_reordered_and_come_apart_outside() {
    let wishes = ask(&[Wish::Above, Wish::Air, Wish::Directions]);
    for (walls, not_above) in [(true, 1), (false, 2)] {
        let (plan, found) = preferred(&halves_in_a_well(walls), &wishes);
        let groups = plan.steps.iter().filter(|s| s.parts.len() > 1).count();
        assert_eq!((plan.steps.len(), groups == 0), (3, !walls), "{plan:#?}");
        assert!(found.looked_at > 1, "orders were looked at");
        assert!(found.judged.count(Wish::Above) <= Some(not_above), "{:?}", found.judged);
        assert!(plan.steps[0].parts == ["cap"] || walls, "{plan:#?}");
    }
}

fn run(words: &[&str]) -> Output {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/examples/plain-2x2.toml");
    let file = file.display().to_string();
    let program = Command::new(env!("CARGO_BIN_EXE_weavelock")).arg("plan").arg(file).args(words).output();
    program.expect("the program runs")
}

#[test]
fn wishes_are_told_at_the_command_line_and_the_plan_verifies() {
    let of = ["--of", "weft-0,warp-0,weft-1", "--quiet"];
    let plain = run(&[&of[..], &["--json"]].concat());
    assert!(!String::from_utf8_lossy(&plain.stdout).contains("preferences"), "only where it is asked");
    let wishes = ["--table", "--up", "0,0,1", "--prefer", "above,directions", "--flexible", "weft-1"];
    let out = run(&[&of[..], &wishes[..], &["--json"]].concat());
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let answer: serde_json::Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let ranked = &answer["preferences"]["ranked"];
    let names: Vec<_> = ranked.as_array().expect("a list").iter().map(|w| w["wish"].clone()).collect();
    assert_eq!(names, ["above", "directions", "flexible", "steps", "air"]);
    let kept = std::env::temp_dir().join(format!("weavelock-wanted-{}.json", std::process::id()));
    std::fs::write(&kept, &out.stdout).expect("written");
    let again = Command::new(env!("CARGO_BIN_EXE_weavelock")).arg("verify").arg(&kept).output();
    assert_eq!(again.expect("it runs").status.code(), Some(0));
    let _ = std::fs::remove_file(kept);
    let words = run(&[&of[..], &wishes[..]].concat());
    let text = String::from_utf8_lossy(&words.stdout).to_string();
    assert!(text.contains("Wishes by rank") && text.contains("it stands on a table"), "{text}");
    for bad in [["--flexible", "nobody"], ["--up", "0,0,0"], ["--prefer", "speed"]] {
        assert_eq!(run(&bad).status.code(), Some(2), "{bad:?}");
    }
}
