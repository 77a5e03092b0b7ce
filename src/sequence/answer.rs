//! The plan as it is written down: parts by id, lengths in model units and in mm. Takes moves, gives steps.

use super::Move;
use super::field::{Field, Set};
use super::gap::least_gap;
use super::lattice::answer::Counted;
use super::motion::{Ends, Motion, Shift};
use crate::assembly::PartIx;
use crate::blocking::shadow::View;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Every part was separated: the reverse of the steps puts the assembly together.
    Assembled,
    /// A set that stayed together is proven locked: no rigid plan exists, something must bend.
    NeedsFlexible,
    /// A set stayed together and nothing is proven about it.
    NotFound,
}

/// The order of the steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Order {
    /// From assembled to apart. Read backward, with directions reversed, to assemble.
    Disassembly,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Step {
    /// Ids of all parts that move.
    pub parts: Vec<String>,
    #[serde(flatten)]
    pub motion: Motion,
    /// Least distance, in model units, that what moves keeps from the rest (and from what moves another way) on its
    /// way: 0 where they start in contact or slide.
    pub clear: f64,
    #[serde(default)]
    pub ends: Ends,
    /// Ids of the parts that stand still.
    pub stays: Vec<String>,
}

/// What is known about straight moves of any group of a set that stayed together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Straight {
    /// Every direction was excluded: no group can leave by one straight move.
    None,
    /// The search gave up.
    Unknown,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Stuck<C> {
    pub parts: Vec<String>,
    pub straight_moves: Straight,
    /// Proof that these parts are locked, where there is one.
    pub lock: Option<C>,
}

/// How much was looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Searched {
    pub sets: usize,
    pub directions: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Plan<C> {
    pub outcome: Outcome,
    pub order: Order,
    pub steps: Vec<Step>,
    /// Sets that stayed together; empty exactly when assembled.
    pub stuck: Vec<Stuck<C>>,
    pub searched: Searched,
    /// Depth, in model units, up to which an overlap counted as touching.
    pub touch: f64,
    /// Moves along the axes of a lattice, where the plan was made on one.
    #[serde(flatten, default, skip_serializing_if = "Option::is_none")]
    pub counted: Option<Counted>,
}

/// Share of the moved parts' extent along the direction that a move goes beyond being clear: enough to be seen and to
/// stand above every round-off.
const PARTING_SHARE: f64 = 1.0 / 16.0;

pub(super) fn step(field: &Field, m: &Move) -> Step {
    let distance = distance(field, m);
    Step {
        parts: ids(field, &m.parts),
        motion: Motion::Translation(Shift::new(m.along, distance, field.asm.mm_per_unit)),
        clear: least_gap(field, &m.parts, &m.stays, m.along * distance),
        ends: Ends::Apart,
        stays: ids(field, &m.stays),
    }
}

pub(super) fn stuck<C>(
    field: &Field,
    s: (Set, Straight),
    locked: impl Fn(&[PartIx]) -> Option<C>,
) -> Stuck<C> {
    let parts: Vec<PartIx> = s.0.iter().copied().collect();
    Stuck { parts: ids(field, &s.0), straight_moves: s.1, lock: locked(&parts) }
}

fn ids(field: &Field, set: &Set) -> Vec<String> {
    set.iter().map(|&p| field.asm.part(p).id.clone()).collect()
}

/// Far enough that a plane across the direction parts the moved from the rest.
fn distance(field: &Field, m: &Move) -> f64 {
    let view = View::new(&field.shapes, m.along);
    let ends = |set: &Set| {
        let spans = set.iter().map(|&p| view.span(p));
        spans.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), s| (lo.min(s.lo.z), hi.max(s.hi.z)))
    };
    let ((lo, hi), (_, end)) = (ends(&m.parts), ends(&m.stays));
    (end - lo).max(0.0) + PARTING_SHARE * (hi - lo)
}
