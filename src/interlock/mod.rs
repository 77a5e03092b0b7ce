//! Takes an assembly, its contacts and its verdict; gives whether it is interlocked, which parts and groups are keys,
//! and which sub-assemblies are locked by themselves.
//!
//! *Interlocked*: locked whichever one part is held. Contacts see relative motion alone, so that is one question: does
//! the assembly lock with its held set ignored and any one part fixed? *Key*: a smallest group of which all parts move
//! while every other part stands still. *Core*: a largest sub-assembly that is locked by itself; two cores that share a
//! part would be one, so cores are apart. Two or more held parts keep their places to one another in keys and cores; a
//! single held part is only a place to look from.
//!
//! First order, sound up to round-off; of meshes a lock that their files' digits leave open is undecided. Keys are complete
//! up to the stated number of parts, cores as `cores` says.

pub mod keys;

pub use keys::Key;

use crate::assembly::PartIx;
use crate::contact::Touching;
use crate::cores::{self, Contacts, Core, Firm, Found, Guard, MOST_UNKNOWNS, Set};
use crate::locking::{Check, Stress, Verdict};

/// No smaller core is looked for inside one of more parts than this: each costs as many verdicts.
pub const MOST_SHRUNK: usize = 24;

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
    pub cores: Cores,
}

#[derive(Clone, Debug, Default)]
pub struct Cores {
    pub found: Found,
    /// Inside the largest, where one is smaller: no part of it can be left out.
    pub smallest: Vec<Core>,
}

/// Asks about keys and cores what the verdict leaves open. A locked assembly has no key and is one core.
pub fn interlock(touching: Touching, check: &Check) -> Interlock {
    let contacts = Contacts::new(touching);
    let tied = cores::tied(touching);
    let all: Set = touching.assembly.ids().collect();
    Interlock {
        whole: whole(&contacts, &all, &tied),
        keys: keys::keys(&contacts, &all, &tied, &check.rigid),
        cores: found(&contacts, &all, check),
    }
}

fn found(contacts: &Contacts, all: &Set, check: &Check) -> Cores {
    let found = match &check.rigid {
        Verdict::Locked(stress) => {
            Found { largest: whole_as_core(contacts, all, check, stress), ..Found::default() }
        }
        _ => cores::largest(contacts, all, Guard::With),
    };
    let small = found.largest.iter().filter(|c| c.parts.len() <= MOST_SHRUNK);
    let least = small.filter_map(|c| {
        let least = cores::least(contacts, c.clone());
        (least.parts.len() < c.parts.len()).then(|| cores::firm(contacts, least))?
    });
    Cores { smallest: least.collect(), found }
}

/// The whole assembly; nothing is said of parts that are all held.
fn whole_as_core(contacts: &Contacts, all: &Set, check: &Check, stress: &Stress) -> Vec<Core> {
    let still: Set = check.held.iter().copied().chain(check.fixed).collect();
    let core = Core { parts: all.clone(), still, stress: stress.clone(), firm: Firm::Unproven };
    let moves = all.len() > 1 && core.still.len() < all.len();
    moves.then(|| cores::firm(contacts, core)).flatten().into_iter().collect()
}

fn whole(contacts: &Contacts, all: &Set, tied: &Set) -> Whole {
    let Some(&first) = all.first().filter(|_| !tied.is_empty()) else { return Whole::AsChecked };
    let moving: Set = all.iter().copied().filter(|&p| p != first).collect();
    match contacts.verdict(&moving, all) {
        Some(verdict) => Whole::Fixing(first, verdict),
        None => Whole::NotRun { why: format!("more than {MOST_UNKNOWNS} unknowns") },
    }
}
