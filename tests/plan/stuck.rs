//! What a plan says of parts that stay together: how far each got, and which could give, on cases small enough to know.

use super::Made;
use super::build::{assembly, cuboid, prism};
use glam::DVec3;
use weavelock::assembly::{Mobility, PartIx};
use weavelock::sequence::{Motions, Outcome, Plan, plan_by};

/// A closed case around the cavity from (1, 1, 1) to (4, 2, 2), and a block in it that is `long` along x.
fn shut(long: f64) -> Made {
    let case = vec![
        cuboid([0., 0., 0.], [5., 3., 1.]),
        cuboid([0., 0., 2.], [5., 3., 3.]),
        cuboid([0., 0., 1.], [1., 3., 2.]),
        cuboid([4., 0., 1.], [5., 3., 2.]),
        cuboid([1., 0., 1.], [4., 1., 2.]),
        cuboid([1., 2., 1.], [4., 3., 2.]),
    ];
    let block = vec![cuboid([1., 1., 1.], [1. + long, 2., 2.])];
    let (mut asm, patches) = assembly(vec![("case", case), ("block", block)]);
    asm.parts[0].mobility = Mobility::Held;
    (asm, patches)
}

fn planned(made: &Made, lock: Option<()>) -> Plan<()> {
    let all: Vec<PartIx> = made.0.ids().collect();
    plan_by(&made.0, &all, &made.1, Motions::Any, |_| lock).expect("sane parts")
}

/// A model unit is 20 mm.
#[test]
fn a_block_that_slides_in_a_shut_case_is_told_to_have_slid_so_far() {
    for (long, slides) in [(1.0, 40.0), (2.5, 10.0)] {
        let plan = planned(&shut(long), None);
        assert_eq!(plan.outcome, Outcome::NotFound);
        let reached = &plan.stuck[0].reached;
        let block = reached.iter().find(|r| r.part == "block").expect("each part is told");
        let off = (DVec3::from_array(block.direction) * block.distance_mm).distance(DVec3::X * slides);
        assert!(off < 0.01, "{long}: {block:?}");
        assert!(block.turned_degrees < 0.01, "{long}: {block:?}");
        let case = reached.iter().find(|r| r.part == "case").expect("each part is told");
        assert_eq!((case.distance_mm, case.turned_degrees), (0.0, 0.0), "it is held");
    }
}

/// A block of edge 1 in a cup whose rim hangs over it by `lip` along one side.
fn snapped(lip: f64) -> Made {
    let cup = vec![
        cuboid([-1., -1., -1.], [2., 2., 0.]),
        cuboid([-1., -1., 0.], [0., 2., 1.]),
        cuboid([1., -1., 0.], [2., 2., 1.]),
        cuboid([0., -1., 0.], [1., 0., 1.]),
        cuboid([0., 1., 0.], [1., 2., 1.]),
        prism(&[[-1., -1.], [lip, -1.], [lip, 2.], [-1., 2.]], 1.0, 1.5, DVec3::new),
    ];
    let (mut asm, patches) = assembly(vec![("cup", cup), ("block", vec![cuboid([0.; 3], [1.; 3])])]);
    asm.parts[0].mobility = Mobility::Held;
    (asm, patches)
}

/// On the way straight up it has to give way by the rim's overhang, over its width of 1; ways aslant may ask a little less.
#[test]
fn a_block_behind_a_rim_gives_way_by_the_rim() {
    for lip in [0.05, 0.2] {
        let plan = planned(&snapped(lip), Some(()));
        assert_eq!(plan.outcome, Outcome::NeedsFlexible);
        let gives = plan.stuck[0].gives.as_ref().expect("a part that could be soft");
        assert_eq!((gives.part.as_str(), gives.rest), ("block", Outcome::Assembled));
        assert_eq!(gives.past.iter().map(|p| p.part.as_str()).collect::<Vec<_>>(), ["cup"]);
        assert!(gives.direction[2] > 0.9, "{gives:?}");
        assert!(gives.depth_mm > 0.8 * 20.0 * lip && gives.depth_mm < 1.02 * 20.0 * lip, "{lip}: {gives:?}");
        assert!(gives.strain > 0.8 * lip && gives.strain < 1.02 * lip, "{lip}: {gives:?}");
    }
}

/// Who is not asked to give is not told to.
#[test]
fn without_a_lock_nobody_has_to_give() {
    assert!(planned(&snapped(0.2), None).stuck.iter().all(|s| s.gives.is_none()));
}

/// Boxes as an OBJ file, each from its corners; the walls of a hollow one look inward.
fn boxes(all: &[([f64; 3], [f64; 3], bool)]) -> String {
    const SIDES: [[usize; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut text = String::new();
    for (lo, hi, _) in all {
        for k in 0..8 {
            let at = |axis: usize| if k >> axis & 1 == 1 { hi[axis] } else { lo[axis] };
            text += &format!("v {} {} {}\n", at(0), at(1), at(2));
        }
    }
    for (n, (.., hollow)) in all.iter().enumerate() {
        for side in SIDES {
            let mut corners = side.map(|c| (8 * n + c + 1).to_string());
            if *hollow {
                corners.reverse();
            }
            text += &format!("f {}\n", corners.join(" "));
        }
    }
    text
}

/// A die that its box fits on all sides; the box rattles in a closed case. The whole can move, and never comes apart.
#[test]
fn a_locked_core_in_a_set_that_can_move_is_told() {
    let folder = std::env::temp_dir().join(format!("weavelock-cored-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let cube = |lo: f64, hi: f64, hollow| ([lo; 3], [hi; 3], hollow);
    let files = [
        ("case.obj", boxes(&[cube(0., 60., false), cube(10., 50., true)])),
        ("box.obj", boxes(&[cube(15., 45., false), cube(20., 40., true)])),
        ("die.obj", boxes(&[cube(20., 40., false)])),
    ];
    let part = |(file, _): &(&str, String)| format!("[[part]]\nid = \"{}\"\nmesh = \"{file}\"\n", &file[..3]);
    let spec: String = files.iter().map(part).collect();
    files.iter().for_each(|(file, text)| std::fs::write(folder.join(file), text).expect("written"));
    let file = folder.join("nested.toml");
    std::fs::write(&file, format!("name = \"nested\"\n{spec}")).expect("written");
    let program = std::process::Command::new(env!("CARGO_BIN_EXE_weavelock"))
        .args(["plan", &file.display().to_string(), "--json"])
        .output();
    let out = program.expect("the program runs");
    let answer: serde_json::Value = serde_json::from_slice(&out.stdout)
        .unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(&out.stderr)));
    let _ = std::fs::remove_dir_all(folder);
    assert_eq!(answer["outcome"], "not-found", "{answer}");
    let remarks = answer["remarks"].to_string();
    assert!(remarks.contains("locked among themselves") && remarks.contains("box, die"), "{remarks}");
}
