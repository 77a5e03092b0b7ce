//! Takes where parts touch; gives the sub-assemblies that are locked by themselves: largest ones, and in each one that
//! nothing can be left out of.
//!
//! Two locked sets that share a part are locked together, so the largest are apart; and parts of a locked set have one
//! common motion in every motion of what they are part of. Sound: a core is locked by its rows as written, and
//! [`Firm::Holds`] only where that is shown to survive what the files' digits leave open. Complete but for cores that
//! hang on less than `split::SAME_MOTION`, and those said to be undecided or not asked.

mod contacts;
mod least;
mod split;

pub use contacts::{Contacts, MOST_UNKNOWNS};
pub use least::least;
pub use split::{Guard, largest};

use crate::assembly::PartIx;
use crate::contact::Touching;
use crate::locking::Stress;
use crate::locking::digits::Within;
use std::collections::BTreeSet;

/// A set of parts, in order.
pub type Set = BTreeSet<PartIx>;

/// A sub-assembly that is locked by itself: all others away, its held parts (or its first part) still.
#[derive(Clone, Debug)]
pub struct Core {
    pub parts: Set,
    pub still: Set,
    pub stress: Stress,
    pub firm: Firm,
}

/// Whether a lock is shown to survive what is not known of its contacts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Firm {
    /// The contacts are exact, or the lock survives every change within what the files' digits leave open.
    Holds,
    /// Locked as written; not shown for contacts within the digits.
    Unproven,
}

/// What was found in a set of parts.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Apart from one another, in order of their first part.
    pub largest: Vec<Core>,
    /// Their numbers carry neither proof, or the files' digits leave them open.
    pub undecided: Vec<Set>,
    /// More than [`MOST_UNKNOWNS`] unknowns.
    pub not_asked: Vec<Set>,
}

/// Parts that stand still together: the held ones, if there are two or more.
pub fn tied(touching: Touching) -> Set {
    let held: Set = touching.assembly.held().collect();
    if held.len() > 1 { held } else { Set::new() }
}

/// What stands still when a set is looked at alone.
fn still(set: &Set, tied: &Set) -> Set {
    let held: Set = set.intersection(tied).copied().collect();
    if held.is_empty() { set.iter().take(1).copied().collect() } else { held }
}

/// The set as a core, if it is locked by itself; whether within the digits is left to [`firm`].
pub fn locked(contacts: &Contacts, parts: &Set) -> Option<Core> {
    let still = still(parts, &tied(contacts.touching));
    let moving: Set = parts.difference(&still).copied().collect();
    let verdict = (!moving.is_empty()).then(|| contacts.by_rows(&moving, parts))??;
    let crate::locking::Verdict::Locked(stress) = verdict else { return None };
    Some(Core { parts: parts.clone(), still, stress, firm: Firm::Unproven })
}

/// The core with what is shown of it within the files' digits; none where they leave a motion open.
pub fn firm(contacts: &Contacts, core: Core) -> Option<Core> {
    let moving: Set = core.parts.difference(&core.still).copied().collect();
    match contacts.within(&moving, &core.parts, &core.stress) {
        Within::Survives => Some(Core { firm: Firm::Holds, ..core }),
        Within::Unproven => Some(Core { firm: Firm::Unproven, ..core }),
        Within::Open(_) => None,
    }
}
