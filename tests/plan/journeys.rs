//! The planner beyond single straight moves: every plan that it gives is checked by the checker.

use super::build::turned;
use super::made::{
    hook, ring_beside_dice, ring_of_three, thread, twist_lock, twist_lock_over_dice, two_bends,
};
use super::{Checked, Made, Motion, Outcome, Plan, check};
use weavelock::assembly::PartIx;
use weavelock::sequence::{Motions, plan_by};

fn planned(made: &Made) -> Plan<()> {
    let all: Vec<PartIx> = made.0.ids().collect();
    let p = plan_by(&made.0, &all, &made.1, Motions::Any, |_| None::<()>).expect("sane parts");
    match check(&made.0, &p) {
        Checked::Valid { .. } => p,
        bad => panic!("own plan refused: {bad:?}\n{p:#?}"),
    }
}

fn assembled(made: &Made) -> Plan<()> {
    let p = planned(made);
    assert_eq!(p.outcome, Outcome::Assembled, "{p:#?}");
    p
}

fn kinds(p: &Plan<()>) -> Vec<&'static str> {
    let kind = |m: &Motion| match m {
        Motion::Translation(_) => "straight",
        Motion::Screw(_) => "screw",
        Motion::Several { .. } => "several",
    };
    p.steps.iter().map(|s| kind(&s.motion)).collect()
}

#[test]
fn a_block_goes_around_two_bends() {
    for angle in [0.0, 0.7] {
        let p = assembled(&turned(&two_bends().0, angle));
        assert_eq!(kinds(&p), ["straight"; 3], "{p:#?}");
    }
}

#[test]
fn a_twist_lock_is_turned_and_pulled() {
    for angle in [0.0, 0.7] {
        let p = assembled(&turned(&twist_lock(0.0).0, angle));
        assert!(kinds(&p).contains(&"screw") && p.steps.len() <= 3, "{p:#?}");
    }
}

/// Of a set of twenty-six parts one turns; the dice cannot leave their chambers, so the rest is not found.
#[test]
fn one_part_of_a_large_set_turns() {
    let p = planned(&twist_lock_over_dice(4));
    assert!(kinds(&p).contains(&"screw") && p.steps.iter().all(|s| s.parts == ["key"]), "{p:#?}");
    assert_eq!(p.steps.last().map(|s| s.stays.len()), Some(25));
}

#[test]
fn three_of_a_large_set_move_at_once() {
    let p = planned(&ring_beside_dice(4));
    assert!(kinds(&p).contains(&"several"), "{p:#?}");
    let of_ring = |id: &String| !id.starts_with("die") && id != "case";
    assert!(p.steps.iter().all(|s| s.parts.iter().all(of_ring)), "{p:#?}");
}

#[test]
fn three_parts_move_at_once() {
    let p = assembled(&ring_of_three());
    assert!(kinds(&p).contains(&"several"), "{p:#?}");
}

#[test]
fn a_nut_is_screwed_off() {
    let p = assembled(&thread());
    assert!(kinds(&p).contains(&"screw"), "{p:#?}");
}

#[test]
fn a_hook_is_swung_out() {
    let p = assembled(&hook());
    assert!(kinds(&p).iter().any(|k| *k != "straight"), "{p:#?}");
}
