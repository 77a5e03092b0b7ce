//! Takes an assembly, its contacts and some of its parts; gives the locked sub-assemblies among them, each with its
//! self-stress.
//!
//! Sound: every core given is proven locked by itself. Two locked sets that share a part are locked together, so the
//! largest are disjoint, and under any motion of the whole each keeps its shape: splitting a set into the parts that
//! move alike loses none, but for motions that agree to less than [`ALIKE`] and sets that are undecided.

use crate::assembly::{Assembly, Mobility, PartIx};
use crate::contact::Patch;
use crate::locking::{self, Motion, Stress, Verdict};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

pub type Set = BTreeSet<PartIx>;

/// A sub-assembly that is locked by itself.
#[derive(Clone, Debug)]
pub struct Core {
    pub parts: Set,
    pub stress: Stress,
}

/// Two parts whose velocities differ by less than this share of the fastest move alike: motions are polished to about
/// 1e-10. Too large a value only costs another split, too small a one may lose a core.
pub const ALIKE: f64 = 1e-6;

/// An assembly with the patches at hand by part, and the count of what was asked of it.
pub struct Contacts<'a> {
    pub asm: &'a Assembly,
    pub patches: &'a [Patch],
    beside: Vec<Set>,
    /// What the answers cost, the same on every machine: see [`Contacts::pay`].
    pub work: u64,
}

impl<'a> Contacts<'a> {
    pub fn new(asm: &'a Assembly, patches: &'a [Patch]) -> Contacts<'a> {
        let mut beside = vec![Set::new(); asm.parts.len()];
        for p in patches {
            beside[p.a.at()].insert(p.b);
            beside[p.b.at()].insert(p.a);
        }
        Contacts { asm, patches, beside, work: 0 }
    }

    /// Counts one lock or plan of these parts: pairs of parts, and contact patches between them.
    pub fn pay(&mut self, set: &Set) {
        let patches = self.patches.iter().filter(|p| set.contains(&p.a) && set.contains(&p.b)).count();
        self.work += (set.len() * set.len() + patches) as u64;
    }

    /// The verdict about these parts alone.
    pub fn decide(&mut self, set: &Set) -> Verdict {
        self.pay(set);
        let parts: Vec<PartIx> = set.iter().copied().collect();
        locking::check_some(self.asm, self.patches, &parts)
    }

    /// The self-stress of a set that is locked by itself. A set in which nothing could move anyway is no core.
    pub fn core(&mut self, set: &Set) -> Option<Core> {
        if !self.may_move(set) {
            return None;
        }
        match self.decide(set) {
            Verdict::Locked(stress) => Some(Core { parts: set.clone(), stress }),
            _ => None,
        }
    }

    fn may_move(&self, set: &Set) -> bool {
        set.len() > 1 && set.iter().any(|&p| self.asm.part(p).mobility == Mobility::Free)
    }

    /// The largest locked sets among these parts, in order of their first part.
    pub fn largest(&mut self, set: &Set) -> Vec<Core> {
        let mut cores = Vec::new();
        let mut left = self.connected(set);
        while let Some(set) = left.pop() {
            if !self.may_move(&set) {
                continue;
            }
            match self.decide(&set) {
                Verdict::Locked(stress) => cores.push(Core { parts: set, stress }),
                Verdict::Free(motion) => {
                    for group in self.alike(&set, &motion) {
                        left.extend(self.connected(&group));
                    }
                }
                Verdict::Undecided(_) => {}
            }
        }
        cores.sort_by(|a, b| a.parts.cmp(&b.parts));
        cores
    }

    /// A locked set none of whose parts can be left out, within a locked one: chunks of parts are left out, halved until
    /// single parts are tried.
    pub fn least(&mut self, core: Core) -> Core {
        let mut core = core;
        let mut chunk = core.parts.len().div_ceil(2);
        while chunk > 0 {
            let order = self.in_order(&core.parts);
            let smaller = order.chunks(chunk).find_map(|out| {
                let less: Set = core.parts.iter().copied().filter(|p| !out.contains(p)).collect();
                self.largest(&less).into_iter().min_by_key(|c| c.parts.len())
            });
            match smaller {
                Some(less) => {
                    core = less;
                    chunk = chunk.min(core.parts.len().div_ceil(2));
                }
                None => chunk /= 2,
            }
        }
        core
    }

    /// Groups of this set that hang together by contacts, in order.
    fn connected(&self, set: &Set) -> Vec<Set> {
        let mut left = set.clone();
        let mut groups = Vec::new();
        while let Some(first) = left.pop_first() {
            let mut group = Set::from([first]);
            let mut queue = VecDeque::from([first]);
            while let Some(p) = queue.pop_front() {
                for &q in self.beside[p.at()].iter() {
                    if left.remove(&q) {
                        group.insert(q);
                        queue.push_back(q);
                    }
                }
            }
            groups.push(group);
        }
        self.with_held_joined(groups)
    }

    /// Parts that are held stand still together though they may not touch.
    fn with_held_joined(&self, groups: Vec<Set>) -> Vec<Set> {
        let held = |s: &Set| s.iter().any(|&p| self.asm.part(p).mobility == Mobility::Held);
        let (with, mut rest): (Vec<Set>, Vec<Set>) = groups.into_iter().partition(held);
        let joined: Set = with.into_iter().flatten().collect();
        rest.extend((!joined.is_empty()).then_some(joined));
        rest
    }

    /// Breadth first through the contacts, so that what follows one another lies together.
    fn in_order(&self, set: &Set) -> Vec<PartIx> {
        let mut order = Vec::new();
        let mut seen = Set::new();
        for &first in set {
            let mut queue = VecDeque::from([first]);
            while let Some(p) = queue.pop_front() {
                if seen.insert(p) {
                    order.push(p);
                    queue.extend(self.beside[p.at()].iter().filter(|q| set.contains(q)));
                }
            }
        }
        order
    }

    /// The set split into the parts that move alike.
    fn alike(&self, set: &Set, motion: &Motion) -> Vec<Set> {
        let twists: BTreeMap<PartIx, _> = motion.twists.iter().copied().collect();
        let centre = |p: PartIx| self.asm.centre(p);
        let middle = set.iter().map(|&p| centre(p)).sum::<DVec3>() / set.len().max(1) as f64;
        let lever = set.iter().map(|&p| centre(p).distance(middle)).fold(f64::MIN_POSITIVE, f64::max);
        let at = |p: PartIx| {
            let t = twists.get(&p);
            let field = |x: DVec3| t.map_or(DVec3::ZERO, |t| t.translation + t.rotation.cross(x - t.centre));
            [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|d| field(middle + lever * d))
        };
        let fields: Vec<(PartIx, [DVec3; 4])> = set.iter().map(|&p| (p, at(p))).collect();
        let top = fields.iter().flat_map(|f| f.1).map(|v| v.length()).fold(0.0, f64::max);
        let mut groups: Vec<([DVec3; 4], Set)> = Vec::new();
        for (p, f) in fields {
            let same = |g: &[DVec3; 4]| g.iter().zip(&f).all(|(a, b)| a.distance(*b) <= ALIKE * top);
            match groups.iter_mut().find(|(g, _)| same(g)) {
                Some((_, group)) => drop(group.insert(p)),
                None => groups.push((f, Set::from([p]))),
            }
        }
        // A motion in which all parts go alike is none; nothing is split then, and nothing would be learnt again.
        if groups.len() < 2 { Vec::new() } else { groups.into_iter().map(|g| g.1).collect() }
    }
}
