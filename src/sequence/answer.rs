//! The plan as it is written down: parts by id, lengths in model units and in mm. Takes moves, gives steps.

use super::Move;
use super::field::{Field, Set};
use super::gap::least_gap;
use super::give::Giving;
use super::journey::{self, Leg, written};
use super::lattice::answer::Counted;
use super::motion::{Ends, Motion, Shift};
use crate::assembly::PartIx;
use crate::blocking::shadow::View;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Every part was separated, but for sets that a puzzle's groups allow to stay together: the reverse of the steps puts the assembly together.
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
    /// How far each part got in the search for a way out; empty where none was made.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reached: Vec<Reached>,
    /// For a set that is locked: the part that could be the flexible one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gives: Option<Gives>,
}

/// The part of a locked set that goes in last, by bending: an estimate from sampled straight ways, no proof.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Gives {
    /// Goes in when the others of the set are together, before every step of the plan that joins the set to more.
    pub part: String,
    /// Unit vector of its way out; it goes in the other way.
    pub direction: [f64; 3],
    /// Past whom it goes, and how deep it or they must give way.
    pub past: Vec<Past>,
    /// The greatest of these depths.
    pub depth_mm: f64,
    /// Depth over the width of the cells that must give, across the way; no finite element result.
    pub strain: f64,
    /// What a straight plan makes of the others of the set alone.
    pub rest: Outcome,
}

/// One part on the way of another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Past {
    pub part: String,
    /// A sideways shift that is enough for the two to pass.
    pub depth_mm: f64,
}

/// The farthest that a part got in a search, against the parts that stood still in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Reached {
    pub part: String,
    /// Of the middle of its box.
    pub distance_mm: f64,
    /// Unit vector toward there, in world coordinates; zero where it did not move.
    pub direction: [f64; 3],
    /// The most that it was turned, anywhere.
    pub turned_degrees: f64,
}

/// How much was looked at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Searched {
    pub sets: usize,
    pub directions: usize,
    /// Poses reached by moves that stop half way, turns and joint motions.
    #[serde(default)]
    pub states: usize,
    /// Programs solved for them.
    #[serde(default)]
    pub programs: usize,
}

impl Searched {
    pub(super) fn add(&mut self, more: Searched) {
        self.sets += more.sets;
        self.directions += more.directions;
        self.states += more.states;
        self.programs += more.programs;
    }
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
    /// True where the user stopped the search before it was done: what is told is the best until then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
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

/// A motion within a set.
pub(super) fn leg(field: &Field, set: &Set, leg: &Leg) -> Step {
    let moved: Set = leg.movers.iter().flat_map(|(parts, _)| parts.iter().copied()).collect();
    let stays = set.difference(&moved).copied().collect();
    Step {
        parts: ids(field, &moved),
        motion: written(leg, |parts| ids(field, parts)),
        clear: leg.clear,
        ends: Ends::Inside,
        stays: ids(field, &stays),
    }
}

pub(super) fn stuck<C>(
    field: &Field,
    (set, straight_moves): (Set, Straight),
    lock: Option<C>,
    reached: &[journey::Reached],
) -> Stuck<C> {
    let told = |r: &journey::Reached| Reached {
        part: field.asm.part(r.part).id.clone(),
        distance_mm: r.shift.length() * field.asm.mm_per_unit,
        direction: r.shift.normalize_or_zero().to_array(),
        turned_degrees: r.turn.to_degrees(),
    };
    Stuck {
        parts: ids(field, &set),
        straight_moves,
        lock,
        reached: reached.iter().map(told).collect(),
        gives: None,
    }
}

pub(super) fn gives(field: &Field, g: &Giving) -> Gives {
    let (id, mm) = (|p: PartIx| field.asm.part(p).id.clone(), field.asm.mm_per_unit);
    let past = g.past.iter().map(|&(p, depth)| Past { part: id(p), depth_mm: depth * mm });
    Gives {
        part: id(g.part),
        direction: g.along.to_array(),
        past: past.collect(),
        depth_mm: g.past.iter().map(|p| p.1).fold(0.0, f64::max) * mm,
        strain: g.strain,
        rest: g.rest,
    }
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
