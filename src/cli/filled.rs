//! Takes a puzzle without a stated solution; gives a way to fill its result, one that comes apart where there is one.
//!
//! Ways are tried in the order in which they are found, [`BATCH`] at a time side by side; the answer does not depend on
//! the threads. Not promised: that there is none where none was found within the bounds on counted work.

use crate::assembly::voxel::boxes::boxes;
use crate::assembly::voxel::cover::{Covered, assemblies_watched};
use crate::assembly::voxel::placed;
use crate::sequence::lattice::pairs::Brick;
use crate::sequence::lattice::tries::{Lying, Tries};
use crate::spec::puzzle::groups::Groups;
use crate::spec::puzzle::{Puzzle, Solution};
use crate::watch::{All, Watch};
use std::ops::ControlFlow;

/// Placements that are looked at to fill a result, each as often as it is: about a minute's work at twenty nanoseconds.
const MOST_WORK: usize = 3_000_000_000;

/// Ways to fill the result that are taken apart before the first one is taken.
const MOST_TRIED: usize = 1_000_000;

/// Positions looked at for each of them.
const MOST_STATES: usize = 1_000_000;

/// Positions looked at for all of them: about a minute's work.
const MOST_STATES_IN_ALL: usize = 20_000_000;

/// Ways that are tried side by side, enough to keep the threads busy.
const BATCH: usize = 64;

/// What was found so far.
struct Filling<'p> {
    puzzle: &'p Puzzle,
    watch: &'p Watch,
    tries: Tries,
    waiting: Vec<Solution>,
    /// The first that does not come apart.
    first: Option<Solution>,
    good: Option<Solution>,
    /// Ways tried, up to the good one, and how many of them come apart.
    tried: usize,
    apart: usize,
    wanted: usize,
    positions: usize,
}

/// A way to fill the result, and in words how it was found; or a fault and its hint.
pub fn found(puzzle: &Puzzle, watch: &Watch) -> Result<(Solution, String), (String, String)> {
    let stage = watch.stage("filling the result", "ways tried", All::AtMost(MOST_TRIED as u64));
    let mut filling = Filling {
        puzzle,
        watch,
        tries: Tries::default(),
        waiting: Vec::new(),
        first: None,
        good: None,
        tried: 0,
        apart: 0,
        wanted: puzzle.chosen.0.max(1),
        positions: 0,
    };
    let end = assemblies_watched(puzzle, MOST_WORK, watch, |solution| {
        filling.waiting.push(solution);
        if filling.waiting.len() < BATCH {
            return ControlFlow::Continue(());
        }
        filling.settle();
        stage.reach(filling.tried);
        if filling.has_enough() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    filling.settle();
    filling.told(end)
}

impl Filling<'_> {
    fn has_enough(&self) -> bool {
        self.good.is_some()
            || self.tried >= MOST_TRIED
            || self.positions >= MOST_STATES_IN_ALL
            || self.watch.is_stopped()
    }

    /// Tries what waits.
    fn settle(&mut self) {
        let ways: Vec<Solution> = std::mem::take(&mut self.waiting);
        if self.has_enough() {
            return;
        }
        let lying: Vec<(Lying, Option<Groups>)> =
            ways.iter().map(|s| (lying(self.puzzle, s), Groups::placed(self.puzzle, s))).collect();
        let tried = self.tries.come_apart(&lying, MOST_STATES, self.watch);
        for (solution, tried) in ways.into_iter().zip(tried) {
            self.tried += 1;
            self.positions += tried.positions;
            if tried.comes_apart {
                self.apart += 1;
                if self.apart == self.wanted {
                    self.good = Some(solution);
                    return;
                }
            } else if self.first.is_none() {
                self.first = Some(solution);
            }
        }
    }

    fn told(self, end: Covered) -> Result<(Solution, String), (String, String)> {
        let Filling { first, good, tried, apart, wanted, watch, .. } = self;
        if let Some(solution) = good {
            let how = format!(
                "no solution is stated: found here, way {tried} to fill the result, the {wanted}. that comes apart"
            );
            return Ok((solution, how));
        }
        let all = match end {
            Covered::All => "all",
            _ if watch.is_stopped() => "those until the user stopped it,",
            _ => "the first",
        };
        match first {
            Some(solution) if wanted == 1 => Ok((
                solution,
                format!(
                    "no solution is stated: of {all} {tried} ways to fill the result none was found to come apart; this is the first"
                ),
            )),
            None if end == Covered::All && tried == 0 => Err((
                "its pieces do not fill the result in any way".into(),
                "no solution is stated, and there is none".into(),
            )),
            _ => Err((
                format!(
                    "no solution is stated, and {apart} that come apart were found here among {all} {tried} ways to fill the result"
                ),
                "solve the puzzle with BurrTools and save it, or ask for another --solution".into(),
            )),
        }
    }
}

/// The boxes of each piece; none where the pieces do not fit.
fn lying(puzzle: &Puzzle, solution: &Solution) -> Lying {
    let bricks = |voxels: &Vec<[i32; 3]>| {
        boxes(voxels.iter().copied().collect()).into_iter().map(|(lo, hi)| Brick { lo, hi }).collect()
    };
    placed(puzzle, solution)
        .map_or_else(|_| Vec::new(), |all| all.iter().map(|p| bricks(&p.voxels)).collect())
}
