//! Takes an assembly and its contacts; gives the fewest parts that must be flexible, all such sets, and the bound's proof.
//!
//! The bound is proven: disjoint or not, each core is locked by itself, so a flexible part must lie in it. The upper
//! side is as good as the planner: where a set stays together without being locked, the two need not meet, and the gap
//! is stated.

use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::locking::{self, Stress, Verdict};
use crate::sequence::{self, Fault};
use std::collections::BTreeSet;

type Set = BTreeSet<PartIx>;

/// A sub-assembly that is locked by itself.
#[derive(Clone, Debug)]
pub struct Core {
    pub parts: Set,
    pub stress: Stress,
}

/// The answer. `minimum` is none where the bounds do not meet.
#[derive(Clone, Debug)]
pub struct Flex {
    pub lower: usize,
    /// Size of the smallest set that was shown to be enough.
    pub upper: usize,
    /// All sets of size `upper` that are enough; the first few where `cut_short`.
    pub sets: Vec<Set>,
    pub cores: Vec<Core>,
    /// Sets that no plan took apart although they are not locked.
    pub unproven: Vec<Set>,
    pub list: Listing,
}

/// Whether `sets` names all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Listing {
    Complete,
    CutShort,
}

impl Flex {
    pub fn minimum(&self) -> Option<usize> {
        (self.lower == self.upper).then_some(self.upper)
    }
}

/// Candidate sets tested beyond the first; more would take longer than they tell.
const MOST_CANDIDATES: usize = 4096;

/// Finds locked cores one by one until a smallest set that meets them all is enough (implicit hitting set).
pub fn flex(asm: &Assembly, patches: &[Patch]) -> Result<Flex, Fault> {
    let mut search = Search { asm, patches, cores: Vec::new(), unproven: Vec::new() };
    let first = loop {
        let all: Vec<&Set> = search.cores.iter().map(|c| &c.parts).chain(&search.unproven).collect();
        let candidate = smallest(&all);
        if search.is_enough(&candidate)? {
            break candidate;
        }
    };
    let upper = first.len();
    let (sets, list) = search.all_of_size(upper)?;
    let lower = smallest(&search.cores.iter().map(|c| &c.parts).collect::<Vec<_>>()).len();
    let list = if lower == upper { list } else { Listing::CutShort };
    Ok(Flex { lower, upper, sets, cores: search.cores, unproven: search.unproven, list })
}

struct Search<'a> {
    asm: &'a Assembly,
    patches: &'a [Patch],
    cores: Vec<Core>,
    unproven: Vec<Set>,
}

impl Search<'_> {
    /// Whether the parts outside the set come apart; if not, what stayed together joins the cores.
    fn is_enough(&mut self, flexible: &Set) -> Result<bool, Fault> {
        let rigid: Vec<PartIx> = self.asm.ids().filter(|p| !flexible.contains(p)).collect();
        let plan = sequence::plan_of(self.asm, &rigid, self.patches, |set| Some(set.to_vec()))?;
        for stuck in &plan.stuck {
            let set: Set = stuck.lock.iter().flatten().copied().collect();
            match self.locked(&set) {
                Some(_) => self.learn(set),
                None => self.unproven.push(set),
            }
        }
        Ok(plan.stuck.is_empty())
    }

    fn locked(&self, set: &Set) -> Option<Stress> {
        let parts: Vec<PartIx> = set.iter().copied().collect();
        match locking::check_some(self.asm, self.patches, &parts) {
            Verdict::Locked(stress) => Some(stress),
            _ => None,
        }
    }

    /// Leaves out parts while what remains is still locked: a smaller core says more.
    fn learn(&mut self, mut set: Set) {
        for part in set.clone() {
            let mut less = set.clone();
            less.remove(&part);
            if less.len() > 1 && self.locked(&less).is_some() {
                set = less;
            }
        }
        if let Some(stress) = self.locked(&set) {
            self.cores.push(Core { parts: set, stress });
        }
    }

    /// Every set of this size that meets all cores and is enough.
    fn all_of_size(&mut self, size: usize) -> Result<(Vec<Set>, Listing), Fault> {
        let mut enough = Vec::new();
        let mut tested = BTreeSet::new();
        loop {
            let met: Vec<&Set> = self.cores.iter().map(|c| &c.parts).collect();
            let all = hitting(&met, size, MOST_CANDIDATES + 1);
            let cut = all.len() > MOST_CANDIDATES;
            let Some(next) = all.into_iter().find(|s| !tested.contains(s)) else {
                return Ok((enough, Listing::Complete));
            };
            if cut || tested.len() >= MOST_CANDIDATES {
                return Ok((enough, Listing::CutShort));
            }
            // A set of fewer than `size` parts can not be: it would have been the smallest.
            if next.len() == size && self.is_enough(&next)? {
                enough.push(next.clone());
            }
            tested.insert(next);
        }
    }
}

/// A smallest set that meets every one of these; the first in order among equals.
fn smallest(sets: &[&Set]) -> Set {
    (0..).find_map(|size| hitting(sets, size, 1).into_iter().next()).unwrap_or_default()
}

/// Up to `most` sets of at most `size` parts that meet all of these, by branching on the first set not yet met.
fn hitting(sets: &[&Set], size: usize, most: usize) -> Vec<Set> {
    let mut found = BTreeSet::new();
    branch(sets, size, most, &mut Set::new(), &mut found);
    found.into_iter().collect()
}

fn branch(sets: &[&Set], size: usize, most: usize, chosen: &mut Set, found: &mut BTreeSet<Set>) {
    if found.len() >= most {
        return;
    }
    let Some(open) = sets.iter().find(|s| s.is_disjoint(chosen)) else {
        found.insert(chosen.clone());
        return;
    };
    if chosen.len() == size {
        return;
    }
    for &part in open.iter() {
        if chosen.insert(part) {
            branch(sets, size, most, chosen, found);
            chosen.remove(&part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smallest_hitting_sets_are_exact() {
        let set = |v: &[u32]| v.iter().map(|&k| PartIx(k)).collect::<Set>();
        let sets = [set(&[0, 1]), set(&[1, 2]), set(&[3, 4]), set(&[0, 4])];
        let refs: Vec<&Set> = sets.iter().collect();
        assert_eq!(smallest(&refs).len(), 2);
        assert_eq!(hitting(&refs, 2, 100), [set(&[1, 4])]);
        assert_eq!(smallest(&[]), Set::new());
    }
}
