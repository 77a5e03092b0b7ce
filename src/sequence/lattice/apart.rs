//! Takes parts on a lattice; gives how they come apart: a first set, then each of the two sets in turn, and its level.
//!
//! Each count of moves is the fewest for its set from where it stands when it is set apart; the whole need not be the
//! fewest. Sets that may stay together by a puzzle's groups are not parted. A set from which nothing can be parted proves that no translations take the whole apart: other parts only
//! stand in the way. The level is written as BurrTools 0.6 writes it (Roever; `disassembly.cpp`): moves until the first
//! parting, then those of the parts that stayed, then those of the parts that left; a set that needs no more than one
//! move at a time is left out. Not promised: the fewest moves in all.

use super::moves::{Mask, Way};
use super::pairs::around;
use super::search::{End, Fewest, Looks, Scene, search};
use super::states::Shift;
use crate::spec::puzzle::groups::Groups;

/// What becomes of the parts that a move moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// They stay among the others.
    Inside,
    /// They are clear of the others, which are planned by themselves from then on.
    Apart,
}

/// These parts go along an axis while those that they are still together with stay. Indices of pieces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    pub parts: Vec<usize>,
    pub stays: Vec<usize>,
    pub axis: usize,
    /// Lattice steps, negative for back.
    pub by: i32,
    pub ends: Ends,
}

/// What is known of a set that stayed together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kept {
    /// All of its positions that single moves reach were looked at; none lets a set leave.
    Exhausted,
    /// Positions within so many moves were looked at.
    GaveUp { moves: usize },
    /// The same, and someone stopped it there.
    Stopped { moves: usize },
}

/// A set, and how it came apart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fate {
    /// One part, or only held ones.
    Done,
    /// The puzzle's groups say that it need not be parted.
    Together,
    Kept(Kept),
    Parted {
        steps: Vec<Step>,
        fewest: Fewest,
        stayed: Box<Taken>,
        left: Box<Taken>,
    },
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Taken {
    /// Indices of pieces, in order.
    pub members: Vec<usize>,
    pub fate: Fate,
}

/// How parts come apart, and how many positions were found on the way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Apart {
    pub whole: Taken,
    pub states: usize,
}

/// Takes the pieces with these indices apart, looking at `most` positions in all. `groups`: of pieces by their indices.
pub fn take_apart(
    scene: &Scene,
    members: &[usize],
    most: usize,
    groups: Option<&Groups>,
    looks: &Looks,
) -> Apart {
    let mut work = Work { scene, groups, left: most, states: 0, looks };
    let start = vec![0; 3 * members.len().saturating_sub(1)];
    let mut whole = work.take(members, &start);
    let kept = whole.kept();
    let exhausted = kept.iter().all(|k| k.1 == Kept::Exhausted && k.0.len() < members.len());
    let sets: Vec<Vec<usize>> = kept.into_iter().map(|k| k.0.to_vec()).collect();
    if exhausted && groups.is_some_and(|g| g.allow(&sets)) {
        whole.excuse();
    }
    Apart { whole, states: work.states }
}

struct Work<'s> {
    scene: &'s Scene,
    groups: Option<&'s Groups>,
    looks: &'s Looks<'s>,
    left: usize,
    states: usize,
}

impl Work<'_> {
    fn take(&mut self, members: &[usize], start: &[Shift]) -> Taken {
        let taken = |fate| Taken { members: members.to_vec(), fate };
        if members.len() < 2 || members.iter().all(|&p| self.scene.pieces[p].held) {
            return taken(Fate::Done);
        }
        let found = search(self.scene, members, start, self.left, self.looks);
        self.states += found.states;
        self.left = self.left.saturating_sub(found.states);
        match found.end {
            End::Nothing => taken(Fate::Kept(Kept::Exhausted)),
            End::GaveUp { moves } => taken(Fate::Kept(Kept::GaveUp { moves })),
            End::Stopped { moves } => taken(Fate::Kept(Kept::Stopped { moves })),
            End::Leave { through, parts, way, fewest } => {
                let mut steps: Vec<Step> =
                    through.windows(2).map(|w| shifted(self.scene, members, &w[0], &w[1])).collect();
                let last = &through[through.len() - 1];
                let leave = leaving(self.scene, members, last, parts, way);
                let [stayed, left] =
                    [&leave.stays, &leave.parts].map(|set| Box::new(self.take_some(members, last, set)));
                steps.push(leave);
                taken(Fate::Parted { steps, fewest, stayed, left })
            }
        }
    }

    /// A set of the members, from where it stands in this state.
    fn take_some(&mut self, members: &[usize], state: &[Shift], some: &[usize]) -> Taken {
        if some.len() > 1 && self.groups.is_some_and(|g| g.is_one(some)) {
            return Taken { members: some.to_vec(), fate: Fate::Together };
        }
        match about_first(members, state, some) {
            Some(start) => self.take(some, &start),
            None => Taken { members: some.to_vec(), fate: Fate::Kept(Kept::GaveUp { moves: 0 }) },
        }
    }
}

fn shift(state: &[Shift], k: usize) -> [i32; 3] {
    std::array::from_fn(|axis| if k == 0 { 0 } else { i32::from(state[3 * (k - 1) + axis]) })
}

/// The state of some of the members, about the first of them; None where a shift is too far to be written down.
fn about_first(members: &[usize], state: &[Shift], some: &[usize]) -> Option<Vec<Shift>> {
    let at = |p: &usize| members.iter().position(|m| m == p).map(|k| shift(state, k));
    let first = at(some.first()?)?;
    let mut out = Vec::new();
    for p in &some[1..] {
        let own = at(p)?;
        for axis in 0..3 {
            out.push(Shift::try_from(own[axis] - first[axis]).ok()?);
        }
    }
    Some(out)
}

/// The move between two states that are one move apart.
fn shifted(scene: &Scene, members: &[usize], before: &[Shift], after: &[Shift]) -> Step {
    let gone = |k: usize| -> [i32; 3] {
        let (b, a) = (shift(before, k), shift(after, k));
        std::array::from_fn(|axis| a[axis] - b[axis])
    };
    let moves = |k: &usize| gone(*k) != [0; 3];
    let (parts, stays): (Vec<usize>, Vec<usize>) = (0..members.len()).partition(moves);
    let by = gone(parts[0]);
    let axis = (0..3).find(|&a| by[a] != 0).unwrap_or(0);
    let of = |set: Vec<usize>| set.into_iter().map(|k| members[k]).collect::<Vec<_>>();
    let step = Step { parts: of(parts), stays: of(stays), axis, by: by[axis], ends: Ends::Inside };
    if prefers_other(scene, &step.parts, &step.stays) { turned(step) } else { step }
}

/// The move that parts these from the others, far enough to be clear of them by one step.
fn leaving(scene: &Scene, members: &[usize], state: &[Shift], parts: Mask, way: Way) -> Step {
    let (moved, stays): (Vec<usize>, Vec<usize>) = (0..members.len()).partition(|&k| parts >> k & 1 == 1);
    let span = |set: &[usize], high: bool| {
        let ends = set.iter().map(|&k| {
            let b = around(&scene.pieces[members[k]].bricks);
            (if high { b.hi } else { b.lo })[way.axis] + shift(state, k)[way.axis]
        });
        if high { ends.max() } else { ends.min() }.unwrap_or(0)
    };
    let clear = if way.back {
        span(&moved, true) - span(&stays, false)
    } else {
        span(&stays, true) - span(&moved, false)
    };
    let of = |set: &[usize]| set.iter().map(|&k| members[k]).collect::<Vec<_>>();
    let by = way.sign() * (clear.max(0) + 1);
    let step = Step { parts: of(&moved), stays: of(&stays), axis: way.axis, by, ends: Ends::Apart };
    let heavy = |set: &[usize]| set.iter().map(|&p| scene.pieces[p].weight).max();
    let has_held = step.parts.iter().any(|&p| scene.pieces[p].held);
    if has_held || heavy(&step.parts) > heavy(&step.stays) { turned(step) } else { step }
}

/// Held parts stay, then the set with the heaviest part, then the larger one, then the one with the first part.
fn prefers_other(scene: &Scene, parts: &[usize], stays: &[usize]) -> bool {
    let key = |set: &[usize]| {
        let held = set.iter().any(|&p| scene.pieces[p].held);
        let heavy = set.iter().map(|&p| scene.pieces[p].weight).max();
        (held, heavy, set.len(), set.first().map(|&p| std::cmp::Reverse(p)))
    };
    key(parts) > key(stays)
}

fn turned(step: Step) -> Step {
    Step { parts: step.stays, stays: step.parts, by: -step.by, ..step }
}

impl Taken {
    /// All steps, as they are to be made: a set, then what stayed of it, then what left.
    pub fn steps(&self) -> Vec<&Step> {
        match &self.fate {
            Fate::Parted { steps, stayed, left, .. } => {
                steps.iter().chain(stayed.steps()).chain(left.steps()).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Sets that stayed together.
    pub fn kept(&self) -> Vec<(&[usize], Kept)> {
        match &self.fate {
            Fate::Done | Fate::Together => Vec::new(),
            Fate::Kept(kept) => vec![(&self.members, *kept)],
            Fate::Parted { stayed, left, .. } => stayed.kept().into_iter().chain(left.kept()).collect(),
        }
    }

    /// Sets that the puzzle's groups allow to stay together.
    pub fn together(&self) -> Vec<&[usize]> {
        match &self.fate {
            Fate::Together => vec![&self.members],
            Fate::Parted { stayed, left, .. } => {
                stayed.together().into_iter().chain(left.together()).collect()
            }
            _ => Vec::new(),
        }
    }

    /// Sets that stayed together may.
    fn excuse(&mut self) {
        match &mut self.fate {
            Fate::Kept(_) => self.fate = Fate::Together,
            Fate::Parted { stayed, left, .. } => [stayed, left].into_iter().for_each(|s| s.excuse()),
            _ => {}
        }
    }

    /// Whether each set came apart in the fewest moves that it can from where it stood.
    pub fn fewest(&self) -> Fewest {
        match &self.fate {
            Fate::Parted { fewest, stayed, left, .. } => {
                let all = [*fewest, stayed.fewest(), left.fewest()];
                if all.contains(&Fewest::Unproven) { Fewest::Unproven } else { Fewest::Proven }
            }
            _ => Fewest::Proven,
        }
    }

    /// Moves of each set in turn, without sets that need no more than one at a time; None where a set stayed together.
    pub fn level(&self) -> Option<Vec<usize>> {
        self.kept().is_empty().then(|| self.counts())
    }

    fn counts(&self) -> Vec<usize> {
        let Fate::Parted { steps, stayed, left, .. } = &self.fate else { return Vec::new() };
        let some = |set: &Taken| if set.has_several() { set.counts() } else { Vec::new() };
        std::iter::once(steps.len()).chain(some(stayed)).chain(some(left)).collect()
    }

    fn has_several(&self) -> bool {
        let Fate::Parted { steps, stayed, left, .. } = &self.fate else { return false };
        steps.len() > 1 || stayed.has_several() || left.has_several()
    }
}

/// As puzzlers write it: 98.2.4.2.
pub fn written(level: &[usize]) -> String {
    level.iter().map(usize::to_string).collect::<Vec<_>>().join(".")
}
