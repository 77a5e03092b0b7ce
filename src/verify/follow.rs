//! Takes parts as made and a motion of several of them at once; gives the share of it that they follow without overlap.
//!
//! Sound: each share given was checked over its whole way, as the step of a plan. Understated by up to [`STEP`], and
//! null where no share that is a multiple of it was shown.

use super::plan::{self, Checked};
use crate::assembly::{Assembly, PartIx};
use crate::locking::Twist;
use crate::sequence::{
    Ends, Motion, Mover, Order, Outcome, Plan, Rigid, Screw, Searched, Shift, Step, Straight, Stuck,
};
use glam::DVec3;
use std::collections::BTreeSet;

/// Shares are told to a thirty-second: play is of interest to a few percent.
pub const STEP: f64 = 1.0 / 32.0;

/// Turns below this, in radians for the whole motion, are left out: they move nothing by more than round-off of the plan
/// as written (nine digits).
const STRAIGHT: f64 = 1e-9;

/// `by` scales the twists: the whole motion turns each part by rotation x by.
pub fn followed(made: &Assembly, twists: &[(PartIx, Twist)], by: f64) -> Option<f64> {
    let holds =
        |share: f64| matches!(plan::check(made, &step(made, twists, by * share)), Checked::Valid { .. });
    if holds(1.0) {
        return Some(1.0);
    }
    let (mut lo, mut hi) = (0.0, 1.0);
    while hi - lo > STEP {
        let middle = (lo + hi) / 2.0;
        if holds(middle) { lo = middle } else { hi = middle }
    }
    (lo > 0.0).then_some(lo)
}

/// A plan of this one step, after which all parts are still together.
fn step(made: &Assembly, twists: &[(PartIx, Twist)], by: f64) -> Plan<()> {
    let motions: Vec<(PartIx, Rigid)> =
        twists.iter().filter_map(|(p, t)| rigid(t, by, made.mm_per_unit).map(|m| (*p, m))).collect();
    let moved: BTreeSet<PartIx> = motions.iter().map(|m| m.0).collect();
    let id = |p: PartIx| made.part(p).id.clone();
    let motion = motions.iter().map(|&(p, motion)| Mover { parts: vec![id(p)], motion }).collect();
    let step = Step {
        parts: moved.iter().map(|&p| id(p)).collect(),
        motion: Motion::Several { motions: motion },
        clear: 0.0,
        ends: Ends::Inside,
        stays: made.ids().filter(|p| !moved.contains(p)).map(id).collect(),
    };
    let parts = made.ids().map(id).collect();
    Plan {
        outcome: Outcome::NotFound,
        order: Order::Disassembly,
        steps: vec![step],
        stuck: vec![Stuck {
            parts,
            straight_moves: Straight::Unknown,
            lock: None,
            reached: vec![],
            gives: None,
        }],
        searched: Searched::default(),
        touch: 0.0,
        counted: None,
        stopped: false,
    }
}

/// The screw with this twist; none where nothing moves.
fn rigid(t: &Twist, by: f64, mm_per_unit: f64) -> Option<Rigid> {
    let (shift, turn) = (t.translation * by, t.rotation * by);
    if turn.length() < STRAIGHT {
        let distance = shift.length();
        return (distance > 0.0)
            .then(|| Rigid::Translation(Shift::new(shift / distance, distance, mm_per_unit)));
    }
    let axis = turn.normalize();
    let advance = shift.dot(axis);
    let point: DVec3 = t.centre + axis.cross(shift) / turn.length();
    let (angle, advance_mm) = (turn.length(), advance * mm_per_unit);
    Some(Rigid::Screw(Screw { point: point.to_array(), axis: axis.to_array(), angle, advance, advance_mm }))
}
