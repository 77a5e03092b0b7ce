//! Takes contacts; gives the largest sub-assemblies that are locked by themselves, and a smallest one inside each.
//!
//! Parts of a core have one common motion in every motion of what they are part of. So any motion parts the assembly in
//! classes that keep every core whole; each class is asked alone, until it is locked or a single part.

use super::contacts::Contacts;
use super::{MOST_UNKNOWNS, Set};
use crate::assembly::PartIx;
use crate::locking::{Check, Freedom, Motion, Stress, Twist, Verdict};
use glam::DVec3;
use std::collections::BTreeMap;

/// Two parts move alike when their velocities differ by no more than this share of the top speed. Motions keep their
/// rows to 1e-10, which leaves four digits for how softly a core may hold.
pub const SAME_MOTION: f64 = 1e-6;

/// No smaller core is looked for inside one of more parts than this: each costs as many verdicts.
pub const MOST_SHRUNK: usize = 12;

/// A sub-assembly that is locked by itself: all others away, its held parts (or its first part) still.
#[derive(Clone, Debug)]
pub struct Core {
    pub parts: Set,
    pub still: Set,
    pub stress: Stress,
}

#[derive(Clone, Debug, Default)]
pub struct Cores {
    /// Apart from one another.
    pub largest: Vec<Core>,
    /// Inside the largest, where one is smaller: no part of it can be left out.
    pub smallest: Vec<Core>,
    pub undecided: Vec<Set>,
    /// More than [`MOST_UNKNOWNS`] unknowns.
    pub not_asked: Vec<Set>,
}

/// `tied` parts (two or more held) are one body. `check` is about the whole.
pub fn cores(contacts: &Contacts, all: &Set, tied: &Set, check: &Check) -> Cores {
    let mut cores = Cores::default();
    if let Verdict::Locked(stress) = &check.rigid {
        if all.len() > 1 && all != tied {
            let still = check.held.iter().copied().chain(check.fixed).collect();
            cores.largest.push(Core { parts: all.clone(), still, stress: stress.clone() });
        }
    } else {
        cores.split(contacts, tied, all.clone());
    }
    cores.largest.sort_by(|a, b| a.parts.cmp(&b.parts));
    let smaller = cores.largest.iter().filter_map(|c| shrunk(contacts, tied, c));
    cores.smallest = smaller.collect();
    cores
}

/// What stands still when a set is looked at alone.
fn still(set: &Set, tied: &Set) -> Set {
    let held: Set = set.intersection(tied).copied().collect();
    if held.is_empty() { set.iter().take(1).copied().collect() } else { held }
}

impl Cores {
    fn split(&mut self, contacts: &Contacts, tied: &Set, all: Set) {
        let mut open = vec![all];
        while let Some(set) = open.pop() {
            for piece in connected(contacts, tied, set) {
                let piece_size = piece.len();
                let left = peeled(contacts, tied, piece);
                if left.len() < 2 || left.is_subset(tied) {
                    continue;
                }
                if left.len() < piece_size {
                    open.push(left);
                } else {
                    open.extend(self.judged(contacts, tied, left));
                }
            }
        }
    }

    /// Notes what is locked, undecided or too large; classes of parts that move alike otherwise.
    fn judged(&mut self, contacts: &Contacts, tied: &Set, parts: Set) -> Vec<Set> {
        let still = still(&parts, tied);
        let moving: Set = parts.difference(&still).copied().collect();
        match contacts.verdict(&moving, &parts) {
            Some(Verdict::Locked(stress)) => self.largest.push(Core { parts, still, stress }),
            Some(Verdict::Free(motion)) => {
                let classes = classes(contacts, &parts, &motion);
                if classes.len() > 1 {
                    return classes;
                }
                self.undecided.push(parts);
            }
            Some(Verdict::Undecided(_)) => self.undecided.push(parts),
            None => self.not_asked.push(parts),
        }
        Vec::new()
    }
}

/// Pieces of a set that touch; tied parts count as touching.
fn connected(contacts: &Contacts, tied: &Set, mut set: Set) -> Vec<Set> {
    let mut pieces = Vec::new();
    while let Some(first) = set.pop_first() {
        let (mut piece, mut open) = (Set::from([first]), vec![first]);
        while let Some(p) = open.pop() {
            let bound = tied.iter().copied().filter(|_| tied.contains(&p));
            for q in contacts.beside(p).chain(bound) {
                if set.remove(&q) {
                    piece.insert(q);
                    open.push(q);
                }
            }
        }
        pieces.push(piece);
    }
    pieces
}

/// Takes away parts that can move alone, which no core holds, until none is left; one that goes frees its neighbors.
fn peeled(contacts: &Contacts, tied: &Set, mut set: Set) -> Set {
    let mut ask: Set = set.difference(tied).copied().collect();
    while let Some(p) = ask.pop_first() {
        if set.len() > 1 && matches!(contacts.verdict(&Set::from([p]), &set), Some(Verdict::Free(_))) {
            set.remove(&p);
            ask.extend(contacts.beside(p).filter(|q| set.contains(q) && !tied.contains(q)));
        }
    }
    set
}

/// Parts by their common motion.
fn classes(contacts: &Contacts, parts: &Set, motion: &Motion) -> Vec<Set> {
    let twists: BTreeMap<PartIx, Twist> = motion.twists.iter().copied().collect();
    let origin = parts.iter().map(|&p| contacts.centre(p)).sum::<DVec3>() / parts.len() as f64;
    // A twist as the velocity at one common point, and the speed of turning at a lever's length.
    let told = |p: &PartIx| {
        twists.get(p).map_or((DVec3::ZERO, DVec3::ZERO), |t| {
            (t.translation + t.rotation.cross(origin - t.centre), t.rotation * contacts.lever())
        })
    };
    let told: Vec<(PartIx, (DVec3, DVec3))> = parts.iter().map(|p| (*p, told(p))).collect();
    let top = told.iter().map(|(_, (v, w))| v.length().max(w.length())).fold(0.0, f64::max);
    let alike = |x: (DVec3, DVec3), y: (DVec3, DVec3)| {
        (x.0 - y.0).length().max((x.1 - y.1).length()) <= SAME_MOTION * top
    };
    let mut classes: Vec<((DVec3, DVec3), Set)> = Vec::new();
    for (p, twist) in told {
        match classes.iter_mut().find(|c| alike(c.0, twist)) {
            Some(class) => drop(class.1.insert(p)),
            None => classes.push((twist, Set::from([p]))),
        }
    }
    classes.into_iter().map(|c| c.1).collect()
}

/// Leaves out parts while what remains is still locked.
fn shrunk(contacts: &Contacts, tied: &Set, core: &Core) -> Option<Core> {
    let most = MOST_UNKNOWNS / Freedom::Rigid.unknowns();
    if core.parts.len() > MOST_SHRUNK.min(most) {
        return None;
    }
    let mut best: Option<Core> = None;
    let mut parts = core.parts.clone();
    for p in core.parts.iter() {
        let less: Set = parts.iter().copied().filter(|q| q != p).collect();
        let still = still(&less, tied);
        let moving: Set = less.difference(&still).copied().collect();
        if moving.is_empty() {
            continue;
        }
        if let Some(Verdict::Locked(stress)) = contacts.verdict(&moving, &less) {
            best = Some(Core { parts: less.clone(), still, stress });
            parts = less;
        }
    }
    best
}
