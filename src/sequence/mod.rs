//! Takes an assembly with its contact patches, gives a plan: motions of single parts and groups that take it apart, or
//! the sets that stayed together, with a proof that they are locked where the caller has one.
//!
//! Sound: every move is swept along its whole way, up to the stated touching depth. Complete only for sets that leave by
//! *one* straight move to infinity while the rest stands still. Where that fails, [`Motions::Any`] searches straight
//! moves that stop half way, turns and joint motions, with counted work; what is not found then is `not-found`, never
//! "there is none".
//!
//! A stop ends the search between two directions: sets that were not looked at by then are stuck, with nothing known of
//! them.
//!
//! Once a set is clear it is taken off the table: later moves are checked against the parts that it was planned with,
//! not against those that left before.

mod answer;
pub mod clearance;
pub mod field;
mod gap;
mod give;
pub mod group;
mod journey;
pub mod lattice;
pub mod leave;
mod motion;
mod singles;
pub mod wanted;

pub use answer::{Gives, Order, Outcome, Past, Plan, Reached, Searched, Step, Straight, Stuck};
pub use motion::{Ends, Motion, Mover, Rigid, Screw, Shift};

use crate::assembly::{Assembly, PartIx};
use crate::blocking::Touch;
use crate::contact::Patch;
use crate::watch::{All, Stage, Watch};
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

/// A plan by straight moves for some of the parts; the others are not there.
pub fn plan_of<C>(
    asm: &Assembly,
    parts: &[PartIx],
    patches: &[Patch],
    locked: impl Fn(&[PartIx]) -> Option<C>,
) -> Result<Plan<C>, Fault> {
    plan_by(asm, parts, patches, Motions::Straight, locked)
}

/// Which motions a plan may use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motions {
    /// One straight move for each set that leaves.
    Straight,
    /// Where those fail also straight moves that stop half way, turns, and several parts at once.
    Any,
}

/// A plan for some of the parts by these motions; the others are not there.
pub fn plan_by<C>(
    asm: &Assembly,
    parts: &[PartIx],
    patches: &[Patch],
    motions: Motions,
    locked: impl Fn(&[PartIx]) -> Option<C>,
) -> Result<Plan<C>, Fault> {
    plan_watched(asm, parts, patches, motions, &Watch::default(), locked)
}

/// The same, watched: it tells how far it is, and ends with what it has when it is stopped.
pub fn plan_watched<C>(
    asm: &Assembly,
    parts: &[PartIx],
    patches: &[Patch],
    motions: Motions,
    watch: &Watch,
    locked: impl Fn(&[PartIx]) -> Option<C>,
) -> Result<Plan<C>, Fault> {
    sane(asm, parts)?;
    let most = All::AtMost(parts.len().saturating_sub(1) as u64);
    let stage = watch.stage("taking it apart", "partings", most);
    let mut found = Told { steps: vec![], stuck: vec![], searched: Searched::default(), watch, stage };
    solve(asm, parts.iter().copied().collect(), patches, motions, &locked, &mut found);
    let Told { steps, stuck, searched, .. } = found;
    let outcome = match () {
        _ if stuck.is_empty() => Outcome::Assembled,
        _ if stuck.iter().any(|s| s.lock.is_some()) => Outcome::NeedsFlexible,
        _ => Outcome::NotFound,
    };
    let touch = Touch::of(asm).depth();
    let stopped = watch.is_stopped() && outcome != Outcome::Assembled;
    Ok(Plan { outcome, order: Order::Disassembly, steps, stuck, searched, touch, counted: None, stopped })
}

/// A plan in the making.
struct Told<'w, C> {
    steps: Vec<Step>,
    stuck: Vec<Stuck<C>>,
    searched: Searched,
    watch: &'w Watch,
    stage: Stage,
}

/// Takes a set apart by straight moves, and each set that stays together by a way out, as it then stands.
fn solve<C>(
    asm: &Assembly,
    set: Set,
    patches: &[Patch],
    motions: Motions,
    locked: &dyn Fn(&[PartIx]) -> Option<C>,
    told: &mut Told<'_, C>,
) {
    let field = Field::new(asm, patches, told.watch);
    let mut work = Work::new(&field);
    let mut sets = vec![set];
    while let Some(set) = sets.pop() {
        sets.extend(work.take_apart(set));
        told.stage.add(work.moves.len());
        told.steps.extend(work.moves.drain(..).map(|m| answer::step(&field, &m)));
        for (set, straight) in std::mem::take(&mut work.stuck) {
            way_out(&field, (set, straight), motions, locked, told);
        }
    }
    told.searched.add(work.searched);
}

/// A set that stays together: proven locked, led out by other motions, or stuck.
fn way_out<C>(
    field: &Field,
    (set, straight): (Set, Straight),
    motions: Motions,
    locked: &dyn Fn(&[PartIx]) -> Option<C>,
    told: &mut Told<'_, C>,
) {
    if told.watch.is_stopped() {
        told.stuck.push(answer::stuck(field, (set, Straight::Unknown), None, &[]));
        return;
    }
    let parts: Vec<PartIx> = set.iter().copied().collect();
    let lock = {
        let _stage = told.watch.stage(format!("are these {} parts locked", parts.len()), "", All::Open);
        locked(&parts)
    };
    if lock.is_some() || motions == Motions::Straight {
        let ask = lock.is_some() && motions == Motions::Any;
        let gives = if ask { give::give(field, &set) } else { None };
        told.stuck.push(Stuck {
            gives: gives.map(|g| answer::gives(field, &g)),
            ..answer::stuck(field, (set, straight), lock, &[])
        });
        return;
    }
    let found = journey::journey(field, &set);
    told.searched.states += found.work.states;
    told.searched.programs += found.work.programs;
    let Some(exit) = found.exit else {
        told.stuck.push(answer::stuck(field, (set, straight), None, &found.reached));
        return;
    };
    told.steps.extend(exit.legs.iter().map(|leg| answer::leg(field, &set, leg)));
    let stays: Set = set.difference(&exit.parts).copied().collect();
    told.stage.add(1);
    let there = Field::new(&exit.asm, &exit.patches, told.watch);
    let last = Move { parts: exit.parts.clone(), along: exit.along, stays: stays.clone() };
    told.steps.push(answer::step(&there, &last));
    for set in [exit.parts, stays] {
        // What has moved within its set has no proof of a lock about the places in the file.
        let at_home = |p: &PartIx| exit.asm.part(*p).pose == field.asm.part(*p).pose;
        let lock = |set: &[PartIx]| if set.iter().all(at_home) { locked(set) } else { None };
        solve(&exit.asm, set, &exit.patches, motions, &lock, told);
    }
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
        if self.field.watch.is_stopped() {
            self.stuck.push((set, Straight::Unknown));
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
}
