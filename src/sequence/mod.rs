//! Takes an assembly with its contact patches, gives a plan: straight moves of single parts and groups that take it
//! apart, or the sets that stayed together, with a proof that they are locked where the caller has one.
//!
//! Sound: every move is swept along its whole way, up to the stated touching depth. Complete only for what it looks
//! for: a set leaves by *one* straight move to infinity while the rest stands still. A plan that needs a turn, or a move
//! that stops half way, is not found, and the answer is then `not-found`, never "there is none".
//!
//! Once a set is clear it is taken off the table: later moves are checked against the parts that it was planned with,
//! not against those that left before.

mod answer;
pub mod clearance;
pub mod field;
mod gap;
pub mod group;
pub mod lattice;
pub mod leave;
mod motion;
mod singles;

pub use answer::{Order, Outcome, Plan, Searched, Step, Straight, Stuck};
pub use motion::{Ends, Motion, Mover, Rigid, Screw, Shift};

use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use field::{Field, Set};
use glam::DVec3;
use group::Group;
use std::collections::BTreeMap;

/// Why no plan was looked for. Parts are named by id.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    #[error("no convex cells are known for {}: their way cannot be checked", .0.join(", "))]
    NoCells(Vec<String>),
    #[error("coordinates that are no numbers in {}", .0.join(", "))]
    NotFinite(Vec<String>),
    #[error("there is no part number {0}")]
    NoSuchPart(u32),
}

/// A plan for the whole assembly. `locked` proves a set of parts locked to first order, or gives None.
pub fn plan<C>(
    asm: &Assembly,
    patches: &[Patch],
    locked: impl Fn(&[PartIx]) -> Option<C>,
) -> Result<Plan<C>, Fault> {
    let all: Vec<PartIx> = asm.ids().collect();
    plan_of(asm, &all, patches, locked)
}

/// A plan for some of the parts; the others are not there.
pub fn plan_of<C>(
    asm: &Assembly,
    parts: &[PartIx],
    patches: &[Patch],
    locked: impl Fn(&[PartIx]) -> Option<C>,
) -> Result<Plan<C>, Fault> {
    sane(asm, parts)?;
    let field = Field::new(asm, patches);
    let mut work = Work::new(&field);
    let mut sets = vec![parts.iter().copied().collect::<Set>()];
    while let Some(set) = sets.pop() {
        sets.extend(work.take_apart(set));
    }
    Ok(work.answer(locked))
}

fn sane(asm: &Assembly, parts: &[PartIx]) -> Result<(), Fault> {
    if let Some(p) = parts.iter().find(|p| p.at() >= asm.parts.len()) {
        return Err(Fault::NoSuchPart(p.0));
    }
    let named = |bad: &dyn Fn(PartIx) -> bool| -> Vec<String> {
        parts.iter().filter(|&&p| bad(p)).map(|&p| asm.part(p).id.clone()).collect()
    };
    let cells = |p: PartIx| asm.solid(p).cells.iter();
    let bare = named(&|p| cells(p).next().is_none() || cells(p).any(|c| c.planes.len() < 4));
    if !bare.is_empty() {
        return Err(Fault::NoCells(bare));
    }
    let wild = named(&|p| {
        let planes = cells(p).any(|c| c.planes.iter().any(|(n, d)| !n.is_finite() || !d.is_finite()));
        planes || !asm.part(p).pose.is_finite() || cells(p).any(|c| c.vertices.iter().any(|v| !v.is_finite()))
    });
    if wild.is_empty() { Ok(()) } else { Err(Fault::NotFinite(wild)) }
}

/// A move found: these parts, this way, from among these.
#[derive(Clone, Debug)]
struct Move {
    parts: Set,
    along: DVec3,
    stays: Set,
}

/// What was found so far. Directions in `used` are preferred: a plan with few directions is easier to follow.
struct Work<'f, 'a> {
    field: &'f Field<'a>,
    moves: Vec<Move>,
    stuck: Vec<(Set, Straight)>,
    used: Vec<DVec3>,
    settled: BTreeMap<PartIx, leave::Found>,
    searched: Searched,
}

impl<'f, 'a> Work<'f, 'a> {
    fn new(field: &'f Field<'a>) -> Self {
        Work {
            field,
            moves: vec![],
            stuck: vec![],
            used: vec![],
            settled: BTreeMap::new(),
            searched: Searched::default(),
        }
    }

    /// Lets single parts go until none can, then one group; gives the sets that are to be planned in turn.
    fn take_apart(&mut self, mut set: Set) -> Vec<Set> {
        while self.singles_leave(&mut set) {}
        if self.is_done(&set) {
            return vec![];
        }
        self.searched.sets += 1;
        let search = group::group(self.field, &set, &self.used);
        self.searched.directions += search.tried;
        match search.group {
            Group::Leaves { parts, along } => {
                let stays = self.go(parts.clone(), along, &set);
                return vec![parts, stays];
            }
            Group::Never => self.stuck.push((set, Straight::None)),
            Group::GaveUp => self.stuck.push((set, Straight::Unknown)),
        }
        vec![]
    }

    /// One part, or only parts that are held.
    fn is_done(&self, set: &Set) -> bool {
        set.len() < 2 || set.iter().all(|&p| self.field.is_held(p))
    }

    fn go(&mut self, parts: Set, along: DVec3, from: &Set) -> Set {
        let stays: Set = from.difference(&parts).copied().collect();
        if !self.used.contains(&along) {
            self.used.push(along);
        }
        self.moves.push(Move { parts, along, stays: stays.clone() });
        stays
    }

    fn answer<C>(self, locked: impl Fn(&[PartIx]) -> Option<C>) -> Plan<C> {
        let field = self.field;
        let steps = self.moves.iter().map(|m| answer::step(field, m)).collect();
        let stuck: Vec<Stuck<C>> = self.stuck.into_iter().map(|s| answer::stuck(field, s, &locked)).collect();
        let outcome = match () {
            _ if stuck.is_empty() => Outcome::Assembled,
            _ if stuck.iter().any(|s| s.lock.is_some()) => Outcome::NeedsFlexible,
            _ => Outcome::NotFound,
        };
        let touch = field.touch.depth();
        Plan {
            outcome,
            order: Order::Disassembly,
            steps,
            stuck,
            searched: self.searched,
            touch,
            counted: None,
        }
    }
}
