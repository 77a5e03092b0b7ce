//! Takes an assembly and its contacts; gives the fewest parts that must be flexible, all such sets up to symmetry, and
//! the bound's proof.
//!
//! Plans are by straight moves, or along the axes of the parts' lattice where they lie on one.
//!
//! The lower bound is proven: each core is locked by itself, whatever the files' digits leave open, so a flexible part must lie in it, and the smallest set that
//! meets all cores is found by exhaustion. The upper side is as good as the planner: where a set stays together without
//! being locked, the two need not meet, and the gap is stated. With a clearance nothing is locked to first order and the
//! lower bound is 0: only the plans speak.

pub mod cover;
mod search;
pub mod symmetry;

use crate::contact::Touching;
use crate::cores::{Core, Set};
use crate::sequence::clearance::NoClearance;
use crate::sequence::{Fault, Plan};
use crate::watch::Watch;
use std::time::Instant;
use symmetry::Symmetry;

/// Some thousand questions about eighty bricks, or about sixteen woven parts of sixteen crossings: up to about half a minute.
pub const WORK: u64 = 4_000_000;

/// Vertices of woven tiles are rounded to 2^-40 of a crossing; a frame set on parts' centres carries that to no more
/// than 2^-30 across a thousand crossings.
pub const SAME_VERTEX: f64 = 1.0 / (1_u64 << 30) as f64;

/// What is asked.
#[derive(Clone, Debug)]
pub struct Ask {
    /// Air on each face of a contact, model units; 0: the parts as they touch.
    pub clearance: f64,
    pub wanted: Wanted,
    /// Locks and plans that may be tried, each counted as its pairs of parts and its contact patches.
    pub work: u64,
    /// When to stop; the answer then depends on the machine.
    pub until: Option<Instant>,
    /// Distance within which vertices count as one when symmetries are sought, model units.
    pub within: f64,
}

/// Which sets are listed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Those of the least size.
    Smallest,
    /// All from which no part can be left out.
    Minimal,
}

/// A set that is enough, and all that symmetries make of it.
#[derive(Clone, Debug)]
pub struct Enough {
    pub set: Set,
    pub orbit: Vec<Set>,
    /// Takes the other parts apart.
    pub plan: Plan<()>,
}

/// The answer. `minimum` is none where the bounds do not meet.
#[derive(Clone, Debug)]
pub struct Flex {
    pub lower: usize,
    /// Size of the smallest set that was shown to be enough.
    pub upper: usize,
    /// The sets that are enough, one for each orbit, by size.
    pub enough: Vec<Enough>,
    pub cores: Vec<Core>,
    /// Sets that no plan took apart although they are not locked.
    pub unproven: Vec<Set>,
    /// Locked as written, but not shown to be whatever the files' digits leave open of the contacts: no bound rests on them.
    pub doubtful: Vec<Set>,
    pub symmetries: Vec<Symmetry>,
    pub list: Listing,
    pub work: u64,
}

/// Whether `enough` names all that were wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listing {
    Complete,
    /// Those of the least size are all there, larger minimal ones may be missing.
    SmallestComplete,
    CutShort(Cut),
}

/// What ended the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    Work,
    Time,
    /// The user stopped it.
    Stopped,
    /// More candidates than are listed.
    Many,
}

impl Flex {
    pub fn minimum(&self) -> Option<usize> {
        (self.lower == self.upper).then_some(self.upper)
    }
}

/// Why nothing was looked for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoFlex {
    #[error(transparent)]
    Plan(#[from] Fault),
    #[error(transparent)]
    Clearance(#[from] NoClearance),
}

/// Finds locked cores until a smallest set that meets them all is enough (implicit hitting set), then all such sets.
pub fn flex(touching: Touching, ask: &Ask) -> Result<Flex, NoFlex> {
    flex_watched(touching, ask, &Watch::default())
}

/// The same, watched: a stop is as if the work were spent, but that no set is enough for want of a plan then made.
pub fn flex_watched(touching: Touching, ask: &Ask, watch: &Watch) -> Result<Flex, NoFlex> {
    search::Search::new(touching, ask, watch)?.run()
}
