//! Margins of locks: whatever is turned by less than the lower bound stays locked, by more parts than programs are made for, too.

use crate::support::{Dice, joined, tiles, window};
use glam::{DQuat, DVec3};
use std::path::Path;
use weavelock::assembly::PartIx;
use weavelock::contact::{Joined, join};
use weavelock::locking::margin::{self, Effort, Weighted};
use weavelock::locking::{Freedom, Row, Stress, Unknowns, Verdict, check, decide, rows};
use weavelock::spec;

fn lock(joined: &Joined) -> (Vec<Row>, Unknowns, Stress) {
    let check = check(&joined.assembly, &joined.patches, None);
    let still: Vec<PartIx> = check.held.iter().copied().chain(check.fixed).collect();
    let rows = rows(&joined.patches, Freedom::Rigid);
    let unknowns = Unknowns::new(&joined.assembly, &rows, &still, Freedom::Rigid);
    let Verdict::Locked(stress) = check.rigid else { panic!("{} is locked", joined.assembly.name) };
    (rows, unknowns, stress)
}

fn fixture(name: &str) -> Joined {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/assemblies/{name}.toml"));
    join(&spec::read(&file).unwrap_or_else(|e| panic!("{e}"))).unwrap_or_else(|e| panic!("{e}"))
}

/// Every normal turned by that angle, each about an axis of its own across it.
fn turned(rows: &[Row], angle: f64, dice: &mut Dice) -> Vec<Row> {
    let turn = |r: &Row| {
        let any = DVec3::new(dice.signed(), dice.signed(), dice.signed());
        let axis = r.normal.cross(any).normalize_or(r.normal.any_orthonormal_vector());
        Row { normal: DQuat::from_axis_angle(axis, angle) * r.normal, ..*r }
    };
    rows.iter().map(turn).collect()
}

fn holds(joined: &Joined, lower: f64, rounds: usize) {
    let (rows, unknowns, _) = lock(joined);
    let mut dice = Dice::new(3);
    for round in 0..rounds {
        let word = decide(&turned(&rows, 0.99 * lower, &mut dice), &unknowns).word();
        assert_eq!(word, "locked", "{}: round {round}, {lower} rad", joined.assembly.name);
    }
}

#[test]
fn what_is_turned_by_less_than_the_lower_bound_stays_locked() {
    let all = [fixture("burr-keyed"), fixture("swirl-two-held"), fixture("block-in-case")];
    for joined in all.into_iter().chain([joined(&window([1, 1, 1], 6, 2, 2))]) {
        let (rows, unknowns, stress) = lock(&joined);
        let weights = margin::speeds(&rows, &unknowns);
        let problem = Weighted { rows: rows.clone(), unknowns: &unknowns, weights };
        let [plain, tight] =
            [Effort::Plain, Effort::Programs].map(|e| margin::lock(&problem, &stress, e).expect("few parts"));
        assert!(plain.lower > 0.0 && tight.lower >= plain.lower, "{}", joined.assembly.name);
        let upper = margin::shown(&rows, &unknowns, &tight.near).expect("motions");
        println!("{}: {:.4} to {:.4}, plain {:.4}", joined.assembly.name, tight.lower, upper, plain.lower);
        assert!(tight.lower <= upper);
        holds(&joined, tight.lower, 20);
    }
}

#[test]
fn many_parts_have_a_margin_too() {
    for (n, rounds) in [(2, 5), (16, 1)] {
        let joined = joined(&tiles([1, 1, 1], 6, n, 2, 0));
        let (_, unknowns, stress) = lock(&joined);
        let lower = margin::of_many(&stress, &unknowns).expect("a bound");
        println!("{} parts: {lower:.2e}", joined.assembly.parts.len());
        holds(&joined, lower, rounds);
    }
}
