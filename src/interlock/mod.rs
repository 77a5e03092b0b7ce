//! Takes an assembly, its contacts and its verdict; gives whether it is interlocked, which parts and groups are keys,
//! and which sub-assemblies are locked by themselves.
//!
//! *Interlocked*: locked whichever one part is held. Contacts see relative motion alone, so that is one question: does
//! the assembly lock with its held set ignored and any one part fixed? *Key*: a smallest group of which all parts move
//! while every other part stands still. *Core*: a largest sub-assembly that is locked by itself; two cores that share a
//! part would be one, so cores are apart. Two or more held parts keep their places to one another in keys and cores; a
//! single held part is only a place to look from.
//!
//! First order, sound up to round-off. Keys are complete up to the stated number of parts. Cores are complete but for
//! those whose lock hangs on less than [`cores::SAME_MOTION`], and those said to be undecided or not asked.

mod contacts;
pub mod cores;
pub mod keys;

pub use cores::Core;
pub use keys::Key;

use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::locking::{Check, Verdict};
use contacts::Contacts;
use std::collections::BTreeSet;

/// A set of parts, in order.
pub type Set = BTreeSet<PartIx>;

/// More unknowns than this are not asked about together: memory grows with their square, time with their cube.
pub const MOST_UNKNOWNS: usize = 1536;

/// The verdict with the held set ignored.
#[derive(Clone, Debug)]
pub enum Whole {
    /// At most one part is held: the verdict of the check itself.
    AsChecked,
    /// With this part fixed.
    Fixing(PartIx, Verdict),
    NotRun {
        why: String,
    },
}

#[derive(Clone, Debug)]
pub struct Interlock {
    pub whole: Whole,
    pub keys: keys::Keys,
    pub cores: cores::Cores,
}

/// Asks about keys and cores what the verdict leaves open. A locked assembly has no key and is one core.
pub fn interlock(asm: &Assembly, patches: &[Patch], check: &Check) -> Interlock {
    let contacts = Contacts::new(asm, patches);
    let held: Set = check.held.iter().copied().collect();
    let tied = if held.len() > 1 { held.clone() } else { Set::new() };
    let all: Set = asm.ids().collect();
    Interlock {
        whole: whole(&contacts, &all, &tied),
        keys: keys::keys(&contacts, &all, &tied, &check.rigid),
        cores: cores::cores(&contacts, &all, &tied, check),
    }
}

fn whole(contacts: &Contacts, all: &Set, tied: &Set) -> Whole {
    let Some(&first) = all.first().filter(|_| !tied.is_empty()) else { return Whole::AsChecked };
    let moving: Set = all.iter().copied().filter(|&p| p != first).collect();
    match contacts.verdict(&moving, all) {
        Some(verdict) => Whole::Fixing(first, verdict),
        None => Whole::NotRun { why: format!("more than {MOST_UNKNOWNS} unknowns") },
    }
}
