//! The checker on turns, joint motions and moves that stop half way: plans written by hand, then spoiled.

use super::build::{assembly, cuboid, v};
use super::made::{LEAD, corner, held, ring_of_three, thread, twist_lock, two_bends};
use super::{Checked, Made, Motion, Outcome, Plan, Shift, Step, check};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, TAU};
use weavelock::sequence::{Ends, Mover, Order, Rigid, Screw, Searched};

const MM: f64 = 20.0;

fn screw(point: DVec3, axis: DVec3, angle: f64, advance: f64) -> Screw {
    let (point, axis) = (point.to_array(), axis.to_array());
    Screw { point, axis, angle, advance, advance_mm: advance * MM }
}

fn step(parts: &[&str], motion: Motion, ends: Ends, stays: &[&str]) -> Step {
    let ids = |ids: &[&str]| ids.iter().map(|id| (*id).to_owned()).collect();
    Step { parts: ids(parts), motion, clear: 0.0, ends, stays: ids(stays) }
}

fn straight(d: DVec3, l: f64) -> Motion {
    Motion::Translation(Shift::new(d, l, MM))
}

fn plan(steps: Vec<Step>) -> Plan<()> {
    Plan {
        outcome: Outcome::Assembled,
        order: Order::Disassembly,
        steps,
        stuck: vec![],
        searched: Searched::default(),
        touch: 0.0,
        counted: None,
        stopped: false,
    }
}

fn valid(made: &Made, p: &Plan<()>) {
    let found = check(&made.0, p);
    assert!(matches!(found, Checked::Valid { .. }), "{found:?}");
}

/// Refused for overlapping, not for a fault of the books.
fn overlaps(made: &Made, p: &Plan<()>, what: &str) {
    match check(&made.0, p) {
        Checked::Invalid { depth, why, .. } if depth > 0.0 || why.contains("clear") => {}
        other => panic!("{what}: {other:?}"),
    }
}

fn quarter_turn(angle: f64) -> Plan<()> {
    plan(vec![
        step(&["key"], Motion::Screw(screw(DVec3::ZERO, DVec3::Z, angle, 0.0)), Ends::Inside, &["case"]),
        step(&["key"], straight(DVec3::Z, 5.0), Ends::Apart, &["case"]),
    ])
}

#[test]
fn a_twist_lock_opens_by_its_turn_alone() {
    let made = twist_lock(0.0);
    valid(&made, &quarter_turn(FRAC_PI_2));
    valid(&made, &quarter_turn(-FRAC_PI_2));
    overlaps(&made, &quarter_turn(FRAC_PI_2 - 0.3), "turned too little");
    let first = |change: &dyn Fn(&mut Screw)| {
        let mut p = quarter_turn(FRAC_PI_2);
        let Motion::Screw(s) = &mut p.steps[0].motion else { panic!("a screw") };
        change(s);
        p
    };
    overlaps(&made, &first(&|s| (s.advance, s.advance_mm) = (0.01, 0.01 * MM)), "pressed into the lid");
    overlaps(&made, &first(&|s| (s.advance, s.advance_mm) = (-0.01, -0.01 * MM)), "pressed into the floor");
    overlaps(&made, &first(&|s| s.point[0] = 0.7), "about another axis");
    overlaps(&made, &first(&|s| s.axis = v(0.02, 0.0, 1.0).normalize().to_array()), "tilted");
    let mut p = quarter_turn(FRAC_PI_2);
    p.steps.remove(0);
    overlaps(&made, &p, "not turned at all");
    let mut p = quarter_turn(FRAC_PI_2);
    p.steps[0].clear = 0.01;
    assert!(matches!(check(&made.0, &p), Checked::Invalid { .. }), "it slides");
}

/// A rib of a hundredth, and of a ten thousandth, of the pitch hangs in the way of the turn.
#[test]
fn a_turn_through_a_thin_lip_is_refused() {
    for lip in [0.01, 0.0001] {
        overlaps(&twist_lock(lip), &quarter_turn(FRAC_PI_2), "through the rib");
        overlaps(&twist_lock(lip), &quarter_turn(FRAC_PI_2 + TAU), "and once more around");
    }
    // The other way around it passes another rib-free quarter: turned by -90 degrees the far end meets none either.
    let made = twist_lock(0.01);
    valid(&made, &quarter_turn(-FRAC_PI_2));
}

fn unscrew(turns: f64, lead: f64) -> Plan<()> {
    let angle = TAU * turns;
    plan(vec![
        step(
            &["nut"],
            Motion::Screw(screw(DVec3::ZERO, DVec3::Z, angle, lead * turns)),
            Ends::Inside,
            &["bolt"],
        ),
        step(&["nut"], straight(DVec3::Z, 8.0), Ends::Apart, &["bolt"]),
    ])
}

#[test]
fn a_nut_leaves_its_thread_by_the_screw_alone() {
    let made = thread();
    valid(&made, &unscrew(1.6, LEAD));
    overlaps(&made, &unscrew(1.6, -LEAD), "the other way");
    overlaps(&made, &unscrew(1.6, 0.5 * LEAD), "another lead");
    overlaps(&made, &unscrew(-1.6, LEAD), "against the thread");
    overlaps(&made, &unscrew(0.4, LEAD), "not far enough");
    let mut p = unscrew(1.6, LEAD);
    p.steps.remove(0);
    overlaps(&made, &p, "pulled off");
}

fn outward(lengths: [f64; 3]) -> Plan<()> {
    let mover = |k: usize| Mover {
        parts: vec![["a", "b", "c"][k].to_owned()],
        motion: Rigid::Translation(Shift::new(corner(k).normalize(), lengths[k], MM)),
    };
    // Seen from c: what all do is what c does not.
    let relative = |k: usize| {
        let by = corner(k).normalize() * lengths[k] - corner(2).normalize() * lengths[2];
        Mover { motion: Rigid::Translation(Shift::new(by.normalize(), by.length(), MM)), ..mover(k) }
    };
    let motions = vec![relative(0), relative(1)];
    plan(vec![step(&["a", "b"], Motion::Several { motions }, Ends::Apart, &["c"])])
}

#[test]
fn three_that_must_move_at_once() {
    let made = ring_of_three();
    valid(&made, &outward([2.0; 3]));
    overlaps(&made, &outward([2.0, 2.0, 2.1]), "one faster");
    overlaps(&made, &outward([0.2; 3]), "not far enough");
    let one = plan(vec![
        step(&["a"], straight(corner(0).normalize(), 6.0), Ends::Apart, &["b", "c"]),
        step(&["b"], straight(corner(1).normalize(), 6.0), Ends::Apart, &["c"]),
    ]);
    overlaps(&made, &one, "one after the other");
    let mut twice = outward([2.0; 3]);
    let Motion::Several { motions } = &mut twice.steps[0].motion else { panic!("several") };
    motions[1].parts = vec!["a".into()];
    assert!(matches!(check(&made.0, &twice), Checked::Invalid { .. }), "a part moves twice");
}

fn around_two_bends(up: f64, over: f64) -> Plan<()> {
    plan(vec![
        step(&["block"], straight(DVec3::Z, up), Ends::Inside, &["maze"]),
        step(&["block"], straight(DVec3::X, over), Ends::Inside, &["maze"]),
        step(&["block"], straight(DVec3::Z, 10.0), Ends::Apart, &["maze"]),
    ])
}

#[test]
fn poses_add_up_over_moves_that_stop_half_way() {
    let made = two_bends();
    valid(&made, &around_two_bends(1.0, 1.0));
    overlaps(&made, &around_two_bends(0.99, 1.0), "a hundredth low");
    overlaps(&made, &around_two_bends(1.01, 1.0), "a hundredth high");
    overlaps(&made, &around_two_bends(1.0, 0.99), "a hundredth short");
    let mut p = around_two_bends(1.0, 1.0);
    p.steps[1].ends = Ends::Apart;
    assert!(matches!(check(&made.0, &p), Checked::Invalid { .. }), "not apart yet");
    p = around_two_bends(1.0, 1.0);
    p.steps[2].ends = Ends::Inside;
    assert!(matches!(check(&made.0, &p), Checked::Invalid { .. }), "never apart");
}

/// A block turns past a post; how near it comes is known: its corner at 1.5 / sqrt 2 from the axis, the post at 1.2.
#[test]
fn the_distance_kept_on_a_turn_is_checked() {
    let made = held(
        assembly(vec![
            ("block", vec![cuboid([-0.75, -0.75, 0.], [0.75, 0.75, 1.])]),
            ("post", vec![cuboid([1.2, -0.3, -1.], [1.5, 0.3, 2.])]),
        ]),
        1,
    );
    let spin = |clear: f64| {
        let turn = Motion::Screw(screw(DVec3::ZERO, DVec3::Z, 1.0, 0.0));
        let mut p = plan(vec![
            step(&["block"], turn, Ends::Inside, &["post"]),
            step(&["block"], straight(-DVec3::X, 1.0), Ends::Apart, &["post"]),
        ]);
        p.steps[0].clear = clear;
        p
    };
    let truth = 1.2 - 0.75 * 2.0_f64.sqrt();
    valid(&made, &spin(truth - 1e-4));
    assert!(matches!(check(&made.0, &spin(truth + 1e-4)), Checked::Invalid { .. }));
}

/// What is written and read again is the same step, and a straight one has the keys it always had.
#[test]
fn steps_survive_json() {
    let mut all = quarter_turn(1.0).steps;
    all.extend(outward([1.0; 3]).steps);
    let text = serde_json::to_string(&all).expect("plain numbers");
    let back: Vec<Step> = serde_json::from_str(&text).expect("its own text");
    assert_eq!(back, all);
    let one = serde_json::to_value(&all[1]).expect("plain numbers");
    for key in ["parts", "kind", "direction", "distance", "distance_mm", "clear", "stays"] {
        assert!(one.get(key).is_some(), "{key}: {one}");
    }
    assert_eq!(one["kind"], "translation");
    let old = r#"{"parts":["a"],"kind":"translation","direction":[0,0,1],"distance":1,"distance_mm":20,"clear":0,"stays":["b"]}"#;
    let old: Step = serde_json::from_str(old).expect("a step as it was written before");
    assert_eq!(old.ends, Ends::Apart);
}
