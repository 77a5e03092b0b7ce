//! Takes a puzzle; gives the ways in which its pieces fill its result, one after the other (exact cover by backtracking:
//! the voxel or piece with the fewest ways left goes first; voxels that nothing reaches any more count as holes, and what
//! leaves more of them than the pieces' volumes allow is given up).
//!
//! Complete up to turns of the whole where one piece is there just once: its placements that a symmetry of the result
//! turns into an earlier one are left out. Work is counted, not timed. Not promised: that a way can be put together; nor
//! that further pieces are put into holes where a shape may be used a varying number of times and the result is filled.

mod board;
mod ways;

use crate::spec::puzzle::{Puzzle, Solution};
use crate::watch::Watch;
use board::{Bits, Board, has, meet};
use std::ops::ControlFlow;
use ways::Ways;

/// How an enumeration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Covered {
    /// All ways were given.
    All,
    /// The taker had enough, or someone stopped it.
    Stopped,
    /// The bound was reached.
    OutOfWork,
}

/// What still fits, and how often each voxel and each list of pieces is met by it.
#[derive(Default)]
struct Level {
    active: Vec<u32>,
    voxels: Vec<u32>,
    entries: Vec<u32>,
}

struct Search<'p, F> {
    puzzle: &'p Puzzle,
    ways: Ways,
    fixed: Bits,
    count: usize,
    /// Voxels that may stay empty.
    holes: usize,
    /// Used again from branch to branch.
    levels: Vec<Level>,
    work: usize,
    watch: &'p Watch,
    take: F,
}

/// Where a search stands: voxels that are full; for each list of pieces how many at least and at most are still to be
/// placed; what was placed.
struct Stand {
    full: Bits,
    left: Vec<(usize, usize)>,
    chosen: Vec<u32>,
}

/// The same, watched: when it is stopped the taker is as if he had enough.
pub fn assemblies_watched(
    puzzle: &Puzzle,
    most_work: usize,
    watch: &Watch,
    take: impl FnMut(Solution) -> ControlFlow<()>,
) -> Covered {
    let Some(board) = Board::of(puzzle) else { return Covered::OutOfWork };
    let Some(ways) = board.ways(puzzle) else { return Covered::OutOfWork };
    let ways = Ways::new(&board.without_turned(puzzle, ways));
    let left: Vec<(usize, usize)> = puzzle.problem.pieces.iter().map(|p| (p.least, p.most)).collect();
    let Some(holes) = holes(puzzle, board.at.len()) else { return Covered::All };
    let (fixed, count) = (board.fixed, board.at.len());
    let stand = Stand { full: vec![0; fixed.len()], left, chosen: Vec::new() };
    let mut search =
        Search { puzzle, ways, fixed, count, holes, levels: vec![], work: most_work, watch, take };
    let all = 0..search.ways.count() as u32;
    let first = search.counted(Level { active: all.collect(), ..Level::default() });
    match search.fill(first, stand).0 {
        ControlFlow::Continue(()) => Covered::All,
        ControlFlow::Break(why) => why,
    }
}

/// Gives ways to `take` until it breaks or `most_work` placements were looked at, each as often as it was.
pub fn assemblies(
    puzzle: &Puzzle,
    most_work: usize,
    take: impl FnMut(Solution) -> ControlFlow<()>,
) -> Covered {
    assemblies_watched(puzzle, most_work, &Watch::default(), take)
}

/// Voxels of `count` that stay empty at most; None where the pieces that must be used are too large.
fn holes(puzzle: &Puzzle, count: usize) -> Option<usize> {
    let volume = |p: &crate::spec::puzzle::Pieces| p.least * puzzle.shapes[p.shape].voxels.len();
    let empty = count.checked_sub(puzzle.problem.pieces.iter().map(volume).sum())?;
    Some(puzzle.problem.most_holes.map_or(empty, |most| most.min(empty)))
}

/// What is to be settled next.
enum Next {
    Voxel(usize),
    Entry(usize),
    /// The result is filled, but for more voxels than may stay empty.
    Any,
    Done,
    /// Nothing fits where something must.
    Stuck,
}

impl<F: FnMut(Solution) -> ControlFlow<()>> Search<'_, F> {
    /// With the counts of its ways.
    fn counted(&self, mut level: Level) -> Level {
        let clear = |counts: &mut Vec<u32>, n: usize| {
            counts.clear();
            counts.resize(n, 0);
        };
        clear(&mut level.voxels, self.count);
        clear(&mut level.entries, self.puzzle.problem.pieces.len());
        for &w in &level.active {
            self.ways.cells(w).iter().for_each(|&k| level.voxels[k as usize] += 1);
            level.entries[self.ways.entry(w)] += 1;
        }
        level
    }

    /// Tries all that fits, and gives the stand back.
    fn fill(&mut self, level: Level, mut stand: Stand) -> (ControlFlow<Covered>, Stand) {
        let next = self.next(&level, &stand);
        let flow = match next {
            Next::Stuck => ControlFlow::Continue(()),
            Next::Done => self.done(&stand.chosen),
            Next::Voxel(_) | Next::Entry(_) | Next::Any => {
                let flow;
                (flow, stand) = self.branch(&level, &next, stand);
                flow
            }
        };
        self.levels.push(level);
        (flow, stand)
    }

    fn branch(&mut self, level: &Level, next: &Next, mut stand: Stand) -> (ControlFlow<Covered>, Stand) {
        for w in self.branches(level, next, &stand) {
            if self.work == 0 {
                return (ControlFlow::Break(Covered::OutOfWork), stand);
            }
            if self.watch.is_stopped() {
                return (ControlFlow::Break(Covered::Stopped), stand);
            }
            self.work = self.work.saturating_sub(level.active.len());
            let entry = self.ways.entry(w);
            let before = stand.left[entry];
            stand.left[entry] = (before.0.saturating_sub(1), before.1 - 1);
            self.toggle(w, &mut stand.full);
            stand.chosen.push(w);
            let below = self.after(level, next, &stand, w);
            let flow;
            (flow, stand) = self.fill(below, stand);
            stand.chosen.pop();
            self.toggle(w, &mut stand.full);
            stand.left[entry] = before;
            if flow.is_break() {
                return (flow, stand);
            }
        }
        (ControlFlow::Continue(()), stand)
    }

    /// Of a list of pieces the first in order is branched on, so that enough must be left behind it.
    fn branches(&self, level: &Level, next: &Next, stand: &Stand) -> Vec<u32> {
        let of = |w: u32| match next {
            Next::Voxel(k) => has(self.ways.bits(w), *k),
            Next::Entry(e) => self.ways.entry(w) == *e,
            _ => true,
        };
        let mut all: Vec<u32> = level.active.iter().copied().filter(|&w| of(w)).collect();
        if let Next::Entry(e) = next {
            all.truncate((all.len() + 1).saturating_sub(stand.left[*e].0));
        }
        all
    }

    /// What fits beside `w`. Where not a voxel is settled, what comes before `w` was tried with it.
    fn after(&mut self, level: &Level, next: &Next, stand: &Stand, w: u32) -> Level {
        let mut below = self.levels.pop().unwrap_or_default();
        let bits = self.ways.bits(w);
        let is_tried = |v: u32| match next {
            Next::Entry(e) => v < w && self.ways.entry(v) == *e,
            Next::Any => v < w,
            _ => false,
        };
        let is_kept =
            |&v: &u32| stand.left[self.ways.entry(v)].1 > 0 && !is_tried(v) && !meet(self.ways.bits(v), bits);
        below.active.clear();
        below.active.extend(level.active.iter().copied().filter(is_kept));
        self.counted(below)
    }

    fn toggle(&self, w: u32, full: &mut Bits) {
        full.iter_mut().zip(self.ways.bits(w)).for_each(|(f, b)| *f ^= b);
    }

    /// The voxel or list of pieces with the fewest branches.
    fn next(&self, level: &Level, stand: &Stand) -> Next {
        let (mut best, mut fewest, mut empty) = (None, u32::MAX, 0);
        let open = (0..self.count).filter(|&k| !has(&stand.full, k));
        for k in open {
            let (met, fixed) = (level.voxels[k], has(&self.fixed, k));
            empty += usize::from(met == 0);
            if met == 0 && (fixed || empty > self.holes) {
                return Next::Stuck;
            }
            if fixed && met < fewest {
                (best, fewest) = (Some(Next::Voxel(k)), met);
            }
        }
        for (e, &(least, _)) in stand.left.iter().enumerate().filter(|(_, left)| left.0 > 0) {
            let Some(branches) = (level.entries[e] + 1).checked_sub(least as u32).filter(|&n| n > 0) else {
                return Next::Stuck;
            };
            if branches < fewest {
                (best, fewest) = (Some(Next::Entry(e)), branches);
            }
        }
        let settled =
            if self.count - self.volume(&stand.chosen) > self.holes { Next::Any } else { Next::Done };
        best.unwrap_or(settled)
    }

    fn volume(&self, chosen: &[u32]) -> usize {
        chosen.iter().map(|&w| self.ways.cells(w).len()).sum()
    }

    fn done(&mut self, chosen: &[u32]) -> ControlFlow<Covered> {
        let solution = self.solution(chosen);
        match (self.take)(solution) {
            ControlFlow::Continue(()) => ControlFlow::Continue(()),
            ControlFlow::Break(()) => ControlFlow::Break(Covered::Stopped),
        }
    }

    fn solution(&self, chosen: &[u32]) -> Solution {
        let mut placements = Vec::new();
        for (entry, pieces) in self.puzzle.problem.pieces.iter().enumerate() {
            let mut own: Vec<u32> = chosen.iter().copied().filter(|&w| self.ways.entry(w) == entry).collect();
            own.sort_unstable();
            let mut used = own.into_iter().map(|w| self.ways.placement(w));
            placements.extend((0..pieces.most).map(|_| used.next()));
        }
        Solution { placements, level: None }
    }
}
