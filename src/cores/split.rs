//! Takes contacts and a set of parts; gives the largest sub-assemblies in it that are locked by themselves.
//!
//! Parts of a core have one common motion in every motion of what they are part of. So any motion parts the assembly in
//! classes that keep every core whole; each class is asked alone, until it is locked or a single part.

use super::{Contacts, Core, Firm, Found, Set, still, tied};
use crate::assembly::PartIx;
use crate::locking::digits::Within;
use crate::locking::{Motion, Twist, Verdict};
use glam::DVec3;
use std::collections::BTreeMap;

/// Two parts move alike when their velocities differ by no more than this share of the top speed. Motions keep their
/// rows to 1e-10, which leaves four digits for how softly a core may hold.
pub const SAME_MOTION: f64 = 1e-6;

/// Whether locks are held against what the files' digits leave open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guard {
    /// What they leave open is parted further, by the motion that they let pass.
    With,
    /// Locks are those of the rows as written, and unproven.
    Without,
}

/// The largest locked sets among these parts.
pub fn largest(contacts: &Contacts, all: &Set, guard: Guard) -> Found {
    let mut split = Split { contacts, tied: tied(contacts.touching), guard, found: Found::default() };
    split.split(all.clone());
    let mut found = split.found;
    found.largest.sort_by(|a, b| a.parts.cmp(&b.parts));
    found
}

struct Split<'c, 'a> {
    contacts: &'c Contacts<'a>,
    tied: Set,
    guard: Guard,
    found: Found,
}

impl Split<'_, '_> {
    fn split(&mut self, all: Set) {
        let mut open = vec![all];
        while let Some(set) = open.pop() {
            for piece in connected(self.contacts, &self.tied, set) {
                let piece_size = piece.len();
                let left = peeled(self.contacts, &self.tied, piece);
                if left.len() < 2 || left.is_subset(&self.tied) {
                    continue;
                }
                if left.len() < piece_size {
                    open.push(left);
                } else {
                    open.extend(self.judged(left));
                }
            }
        }
    }

    /// Notes what is locked, undecided or too large; classes of parts that move alike otherwise.
    fn judged(&mut self, parts: Set) -> Vec<Set> {
        let still = still(&parts, &self.tied);
        let moving: Set = parts.difference(&still).copied().collect();
        let motion = match self.contacts.by_rows(&moving, &parts) {
            Some(Verdict::Locked(stress)) => {
                let within = match self.guard {
                    Guard::With => self.contacts.within(&moving, &parts, &stress),
                    Guard::Without => Within::Unproven,
                };
                let firm = if matches!(within, Within::Survives) { Firm::Holds } else { Firm::Unproven };
                match within {
                    Within::Open(motion) => motion,
                    _ => return self.keep(Core { parts, still, stress, firm }),
                }
            }
            Some(Verdict::Free(motion)) => motion,
            Some(Verdict::Undecided(_)) => {
                self.found.undecided.push(parts);
                return Vec::new();
            }
            None => {
                self.found.not_asked.push(parts);
                return Vec::new();
            }
        };
        let classes = classes(self.contacts, &parts, &motion);
        if classes.len() < 2 {
            self.found.undecided.push(parts);
            return Vec::new();
        }
        classes
    }

    fn keep(&mut self, core: Core) -> Vec<Set> {
        self.found.largest.push(core);
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
        if set.len() > 1 && matches!(contacts.by_rows(&Set::from([p]), &set), Some(Verdict::Free(_))) {
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
