//! Takes what was found on a lattice; gives it as a plan is written down: steps in model units, and how many moves.
//!
//! Not promised: anything that the search did not find.

use super::apart::{Ends, Kept, Step as Found, Taken, written};
use super::bricks::Lattice;
use super::pairs::Brick;
use super::search::{Fewest, Piece};
use super::{NoLattice, OnLattice, on_lattice_watched};
use crate::assembly::{Assembly, PartIx};
use crate::blocking::Touch;
use crate::sequence::answer::{Order, Outcome, Plan, Searched, Step, Straight, Stuck};
use crate::sequence::motion::{self, Motion, Shift};
use crate::spec::puzzle::groups::Groups;
use crate::watch::Watch;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Moves along the axes of a lattice, as puzzlers count them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Counted {
    /// Moves until the first parting, then of what stayed, then of what left, with dots between: sets that need no more
    /// than one move at a time are left out. Null where a set stayed together.
    pub level: Option<String>,
    /// The same as numbers.
    pub levels: Option<Vec<usize>>,
    /// All moves of the plan.
    pub moves: usize,
    /// Whether each set was parted in the fewest moves that there are from where it stood (of sets shifted along one
    /// axis by one whole number of lattice steps, the rest standing still); the whole may need fewer.
    pub fewest: Word,
    /// Positions of parts that were found.
    pub positions: usize,
    /// The lattice's steps along the axes, model units.
    pub lattice_steps: [f64; 3],
    /// Sets that stay together because the puzzle's groups say that they need not be parted; each is taken as one body.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub together: Vec<Vec<String>>,
    /// What is known of sets that stayed together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub kept: Vec<KeptAnswer>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Word {
    Proven,
    NotProven,
}

/// A set that stayed together on the lattice.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct KeptAnswer {
    pub parts: Vec<String>,
    /// `all-positions`: every position that moves reach was looked at, so no translations part the set; `bound`: the
    /// search gave up; `stopped`: the user stopped it.
    pub looked_at: String,
    /// All positions within so many moves were looked at, where the search gave up.
    pub within_moves: Option<usize>,
}

/// Parts as asked, with what is known of their lattice.
pub struct Asked<'a, W> {
    pub asm: &'a Assembly,
    pub parts: &'a [PartIx],
    /// The lattice's step where it is known, in model units.
    pub step: Option<f64>,
    /// As in [`Piece`].
    pub weight: W,
    /// Positions looked at in all; by default as many as memory holds.
    pub most: Option<usize>,
    /// Of the parts, in their order.
    pub groups: Option<Groups>,
    pub watch: &'a Watch,
}

/// The plan on the lattice. `locked` proves a set of parts locked to first order, or gives None.
pub fn plan<C>(
    asked: &Asked<impl Fn(PartIx) -> i32>,
    locked: impl Fn(&[PartIx]) -> Option<C>,
) -> Result<Plan<C>, NoLattice> {
    let Asked { asm, parts, step, weight, most, groups, watch } = asked;
    let found = on_lattice_watched(asm, parts, *step, weight, *most, groups.as_ref(), watch)?;
    let stuck: Vec<Stuck<C>> =
        found.apart.whole.kept().into_iter().map(|k| stuck(asked, k, &locked)).collect();
    let outcome = match () {
        _ if stuck.is_empty() => Outcome::Assembled,
        _ if stuck.iter().any(|s| s.lock.is_some()) => Outcome::NeedsFlexible,
        _ => Outcome::NotFound,
    };
    Ok(Plan {
        outcome,
        order: Order::Disassembly,
        steps: steps(asked.asm, asked.parts, &found),
        stuck,
        searched: Searched { sets: found.apart.whole.sets(), directions: AXES, ..Searched::default() },
        touch: Touch::of(asked.asm).depth(),
        counted: Some(counted(asked, &found)),
        stopped: asked.watch.is_stopped() && outcome != Outcome::Assembled,
    })
}

/// Directions along the axes.
const AXES: usize = 6;

fn counted(asked: &Asked<impl Fn(PartIx) -> i32>, found: &OnLattice) -> Counted {
    let whole = &found.apart.whole;
    let kept = |(set, kept): (&[usize], Kept)| {
        let (looked_at, within_moves) = match kept {
            Kept::Exhausted => ("all-positions", None),
            Kept::GaveUp { moves } => ("bound", Some(moves)),
            Kept::Stopped { moves } => ("stopped", Some(moves)),
        };
        KeptAnswer { parts: ids(asked, set), looked_at: looked_at.into(), within_moves }
    };
    Counted {
        level: whole.level().map(|l| written(&l)),
        levels: whole.level(),
        moves: whole.steps().len(),
        fewest: if whole.fewest() == Fewest::Proven { Word::Proven } else { Word::NotProven },
        positions: found.apart.states,
        lattice_steps: found.lattice.step.to_array(),
        together: whole.together().into_iter().map(|set| ids(asked, set)).collect(),
        kept: whole.kept().into_iter().map(kept).collect(),
    }
}

fn ids(asked: &Asked<impl Fn(PartIx) -> i32>, set: &[usize]) -> Vec<String> {
    set.iter().map(|&k| asked.asm.part(asked.parts[k]).id.clone()).collect()
}

fn stuck<C>(
    asked: &Asked<impl Fn(PartIx) -> i32>,
    (set, kept): (&[usize], Kept),
    locked: impl Fn(&[PartIx]) -> Option<C>,
) -> Stuck<C> {
    let parts: Vec<PartIx> = set.iter().map(|&k| asked.parts[k]).collect();
    let locked = |parts: &[PartIx]| if asked.watch.is_stopped() { None } else { locked(parts) };
    let straight_moves = if kept == Kept::Exhausted { Straight::None } else { Straight::Unknown };
    Stuck { parts: ids(asked, set), straight_moves, lock: locked(&parts), reached: vec![], gives: None }
}

/// Where pieces stand while a plan is told: after a parting all goes on from before it.
struct Stand<'a> {
    asm: &'a Assembly,
    parts: &'a [PartIx],
    lattice: Lattice,
    pieces: &'a [Piece],
    shifts: Vec<[i32; 3]>,
}

fn steps(asm: &Assembly, parts: &[PartIx], found: &OnLattice) -> Vec<Step> {
    let shifts = vec![[0; 3]; parts.len()];
    let mut stand = Stand { asm, parts, lattice: found.lattice, pieces: &found.pieces, shifts };
    found.apart.whole.steps().into_iter().map(|s| stand.told(s)).collect()
}

impl Stand<'_> {
    fn told(&mut self, step: &Found) -> Step {
        let unit = self.lattice.step[step.axis];
        let direction = DVec3::AXES[step.axis] * f64::from(step.by.signum());
        let distance = f64::from(step.by.abs()) * unit;
        let clear = self.clear(step);
        let ids = |set: &[usize]| set.iter().map(|&k| self.asm.part(self.parts[k]).id.clone()).collect();
        let told = Step {
            parts: ids(&step.parts),
            motion: Motion::Translation(Shift::new(direction, distance, self.asm.mm_per_unit)),
            clear,
            ends: match step.ends {
                Ends::Inside => motion::Ends::Inside,
                Ends::Apart => motion::Ends::Apart,
            },
            stays: ids(&step.stays),
        };
        if step.ends == Ends::Inside {
            step.parts.iter().for_each(|&k| self.shifts[k][step.axis] += step.by);
        }
        told
    }

    /// Least distance between what moves and what stays on the way, model units.
    fn clear(&self, step: &Found) -> f64 {
        let bricks = |set: &[usize]| -> Vec<Brick> {
            let moved = |k: usize| {
                let shift = self.shifts[k];
                let at = move |corner: [i32; 3]| std::array::from_fn(|a| corner[a] + shift[a]);
                self.pieces[k].bricks.iter().map(move |b| Brick { lo: at(b.lo), hi: at(b.hi) })
            };
            set.iter().flat_map(|&k| moved(k)).collect()
        };
        let mut swept = bricks(&step.parts);
        for b in &mut swept {
            let end = if step.by < 0 { &mut b.lo } else { &mut b.hi };
            end[step.axis] += step.by;
        }
        let still = bricks(&step.stays);
        let apart = |a: &Brick, b: &Brick| {
            let gap = |k: usize| {
                f64::from((b.lo[k] - a.hi[k]).max(a.lo[k] - b.hi[k]).max(0)) * self.lattice.step[k]
            };
            DVec3::new(gap(0), gap(1), gap(2)).length()
        };
        swept.iter().flat_map(|a| still.iter().map(move |b| apart(a, b))).fold(f64::INFINITY, f64::min)
    }
}

impl Taken {
    /// Sets that were searched.
    fn sets(&self) -> usize {
        use super::apart::Fate;
        match &self.fate {
            Fate::Done | Fate::Together => 0,
            Fate::Kept(_) => 1,
            Fate::Parted { stayed, left, .. } => 1 + stayed.sets() + left.sets(),
        }
    }
}
