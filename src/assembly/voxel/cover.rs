//! Takes a puzzle; gives the ways in which its pieces fill its result, one after the other (exact cover by backtracking:
//! the voxel or piece with the fewest ways left goes first).
//!
//! Complete up to turns of the whole where one piece is there just once: its placements that a symmetry of the result
//! turns into an earlier one are left out. Work is counted, not timed. Not promised: that a way can be put together; nor
//! all ways where a shape may be used a varying number of times (each set of voxels' owners is given once).

use super::fit::voxels;
use crate::spec::puzzle::turn::{Matrix, TURNS, apply, matrix};
use crate::spec::puzzle::{Fill, Placement, Puzzle, Solution};
use crate::watch::Watch;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;

/// Voxels of the result, one bit each.
type Bits = Vec<u64>;

/// Placements of all shapes; more are refused (they would take a gigabyte).
const MOST_PLACEMENTS: usize = 1_000_000;

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

struct Way {
    /// Index into the problem's list of pieces.
    entry: usize,
    placement: Placement,
    bits: Bits,
    cells: Vec<usize>,
}

struct Search<'p, F> {
    puzzle: &'p Puzzle,
    ways: Vec<Way>,
    fixed: Bits,
    count: usize,
    work: usize,
    watch: &'p Watch,
    take: F,
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
    let ways = board.without_turned(puzzle, ways);
    let all: Vec<usize> = (0..ways.len()).collect();
    let mut left: Vec<(usize, usize)> = puzzle.problem.pieces.iter().map(|p| (p.least, p.most)).collect();
    let (fixed, count) = (board.fixed, board.at.len());
    let mut search = Search { puzzle, ways, fixed, count, work: most_work, watch, take };
    let open = search.fixed.clone();
    match search.fill(&all, &open, &mut left, &mut Vec::new()) {
        ControlFlow::Continue(()) => Covered::All,
        ControlFlow::Break(why) => why,
    }
}

/// Gives ways to `take` until it breaks or `most_work` placements were tried.
pub fn assemblies(
    puzzle: &Puzzle,
    most_work: usize,
    take: impl FnMut(Solution) -> ControlFlow<()>,
) -> Covered {
    assemblies_watched(puzzle, most_work, &Watch::default(), take)
}

/// The result's voxels, numbered.
struct Board {
    at: BTreeMap<[i32; 3], usize>,
    colours: Vec<u32>,
    fixed: Bits,
    size: [i32; 3],
}

fn bit(bits: &mut Bits, k: usize) {
    bits[k / 64] |= 1 << (k % 64);
}

fn has(bits: &Bits, k: usize) -> bool {
    bits[k / 64] >> (k % 64) & 1 == 1
}

fn meet(a: &Bits, b: &Bits) -> bool {
    a.iter().zip(b).any(|(x, y)| x & y != 0)
}

impl Board {
    fn of(puzzle: &Puzzle) -> Option<Board> {
        let result = &puzzle.shapes[puzzle.problem.result];
        let at: BTreeMap<[i32; 3], usize> =
            result.voxels.iter().enumerate().map(|(k, v)| (v.at, k)).collect();
        let mut fixed = vec![0; at.len().div_ceil(64)];
        let fixed_ones = result.voxels.iter().enumerate().filter(|(_, v)| v.fill == Fill::Fixed);
        fixed_ones.for_each(|(k, _)| bit(&mut fixed, k));
        let colours = result.voxels.iter().map(|v| v.colour).collect();
        (!at.is_empty()).then_some(Board { at, colours, fixed, size: result.size })
    }

    fn ways(&self, puzzle: &Puzzle) -> Option<Vec<Way>> {
        let mut ways = Vec::new();
        for (entry, pieces) in puzzle.problem.pieces.iter().enumerate().filter(|(_, p)| p.most > 0) {
            let shape = &puzzle.shapes[pieces.shape];
            let mut seen: BTreeSet<Vec<[i32; 3]>> = BTreeSet::new();
            for turn in 0..TURNS {
                let here = voxels(shape, matrix(turn), [0; 3]);
                let least: [i32; 3] = std::array::from_fn(|k| here.iter().map(|v| v[k]).min().unwrap_or(0));
                let mut drawn: Vec<[i32; 3]> =
                    here.iter().map(|v| std::array::from_fn(|k| v[k] - least[k])).collect();
                drawn.sort_unstable();
                if seen.insert(drawn.clone()) {
                    let extent: [i32; 3] =
                        std::array::from_fn(|k| drawn.iter().map(|v| v[k]).max().unwrap_or(0));
                    for to in corners(self.size, extent) {
                        let at = std::array::from_fn(|k| to[k] - least[k]);
                        let placement = Placement { at, turn };
                        ways.extend(self.way(puzzle, entry, placement));
                    }
                }
                if ways.len() > MOST_PLACEMENTS {
                    return None;
                }
            }
        }
        Some(ways)
    }

    /// The placement where all of its voxels are in the result and their colours may meet.
    fn way(&self, puzzle: &Puzzle, entry: usize, placement: Placement) -> Option<Way> {
        let shape = &puzzle.shapes[puzzle.problem.pieces[entry].shape];
        let mut bits = vec![0; self.fixed.len()];
        let mut cells = Vec::new();
        for (v, at) in shape.voxels.iter().zip(voxels(shape, matrix(placement.turn), placement.at)) {
            let &k = self.at.get(&at)?;
            let pair = (v.colour, self.colours[k]);
            if pair.0 > 0 && pair.1 > 0 && puzzle.colours > 0 && !puzzle.problem.allowed.contains(&pair) {
                return None;
            }
            bit(&mut bits, k);
            cells.push(k);
        }
        Some(Way { entry, placement, bits, cells })
    }

    /// Symmetries of the result as permutations of its voxels, but for the one that does nothing.
    fn symmetries(&self, puzzle: &Puzzle) -> Vec<Vec<usize>> {
        let result = &puzzle.shapes[puzzle.problem.result];
        let of = |turn: Matrix| -> Option<Vec<usize>> {
            let turned: Vec<[i32; 3]> = result.voxels.iter().map(|v| apply(turn, v.at)).collect();
            let least = |all: &[[i32; 3]]| -> [i32; 3] {
                std::array::from_fn(|k| all.iter().map(|v| v[k]).min().unwrap_or(0))
            };
            let here = least(&result.voxels.iter().map(|v| v.at).collect::<Vec<_>>());
            let there = least(&turned);
            let image = |(v, k): (&[i32; 3], usize)| {
                let at: [i32; 3] = std::array::from_fn(|a| v[a] - there[a] + here[a]);
                let &to = self.at.get(&at)?;
                let same =
                    (result.voxels[k].fill, self.colours[k]) == (result.voxels[to].fill, self.colours[to]);
                same.then_some(to)
            };
            turned.iter().zip(0..).map(image).collect()
        };
        (1..TURNS).filter_map(|k| of(matrix(k))).collect()
    }

    /// Without placements of one piece that a symmetry turns into an earlier one.
    fn without_turned(&self, puzzle: &Puzzle, ways: Vec<Way>) -> Vec<Way> {
        let once = puzzle.problem.pieces.iter().enumerate().filter(|(_, p)| p.least == 1 && p.most == 1);
        let count = |entry: usize| ways.iter().filter(|w| w.entry == entry).count();
        let Some(pivot) = once.map(|(entry, _)| entry).max_by_key(|&e| (count(e), std::cmp::Reverse(e)))
        else {
            return ways;
        };
        let symmetries = self.symmetries(puzzle);
        let image = |way: &Way, map: &[usize]| {
            let mut bits = vec![0; way.bits.len()];
            way.cells.iter().for_each(|&k| bit(&mut bits, map[k]));
            bits
        };
        let first = |way: &Way| symmetries.iter().all(|map| way.bits <= image(way, map));
        ways.into_iter().filter(|w| w.entry != pivot || first(w)).collect()
    }
}

/// Least corners at which something of this extent lies in a box of this size.
fn corners(size: [i32; 3], extent: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    let range = move |k: usize| 0..size[k] - extent[k];
    range(0).flat_map(move |x| range(1).flat_map(move |y| range(2).map(move |z| [x, y, z])))
}

/// What is to be settled next.
enum Item {
    Voxel(usize),
    Entry(usize),
}

impl<F: FnMut(Solution) -> ControlFlow<()>> Search<'_, F> {
    /// `active`: ways that still fit; `open`: voxels to be filled; `left`: for each entry how many at least and at most.
    fn fill(
        &mut self,
        active: &[usize],
        open: &Bits,
        left: &mut Vec<(usize, usize)>,
        chosen: &mut Vec<usize>,
    ) -> ControlFlow<Covered> {
        let Some(item) = self.tightest(active, open, left) else { return self.done(open, left, chosen) };
        let of = |w: usize| match item {
            Item::Voxel(k) => has(&self.ways[w].bits, k),
            Item::Entry(e) => self.ways[w].entry == e,
        };
        let branches: Vec<usize> = active.iter().copied().filter(|&w| of(w)).collect();
        let mut gone: BTreeSet<usize> = BTreeSet::new();
        for w in branches {
            if self.work == 0 {
                return ControlFlow::Break(Covered::OutOfWork);
            }
            if self.watch.is_stopped() {
                return ControlFlow::Break(Covered::Stopped);
            }
            self.work -= 1;
            let (entry, bits) = (self.ways[w].entry, self.ways[w].bits.clone());
            let before = left[entry];
            left[entry] = (before.0.saturating_sub(1), before.1 - 1);
            let fits = |&&v: &&usize| {
                left[self.ways[v].entry].1 > 0 && !gone.contains(&v) && !meet(&self.ways[v].bits, &bits)
            };
            let next: Vec<usize> = active.iter().filter(fits).copied().collect();
            let rest: Bits = open.iter().zip(&bits).map(|(o, b)| o & !b).collect();
            chosen.push(w);
            self.fill(&next, &rest, left, chosen)?;
            chosen.pop();
            left[entry] = before;
            gone.insert(w);
        }
        ControlFlow::Continue(())
    }

    /// The voxel or list of pieces with the fewest ways; None where nothing is left to settle.
    fn tightest(&self, active: &[usize], open: &Bits, left: &[(usize, usize)]) -> Option<Item> {
        let (mut voxels, mut entries) = (vec![0usize; self.count], vec![0usize; left.len()]);
        for &w in active {
            self.ways[w].cells.iter().for_each(|&k| voxels[k] += 1);
            entries[self.ways[w].entry] += 1;
        }
        let voxel = (0..self.count).filter(|&k| has(open, k)).min_by_key(|&k| voxels[k]);
        let entry = (0..left.len()).filter(|&e| left[e].0 > 0).min_by_key(|&e| entries[e]);
        match (voxel, entry) {
            (Some(k), Some(e)) if voxels[k] > entries[e] => Some(Item::Entry(e)),
            (Some(k), _) => Some(Item::Voxel(k)),
            (None, Some(e)) => Some(Item::Entry(e)),
            (None, None) => None,
        }
    }

    fn done(&mut self, open: &Bits, left: &[(usize, usize)], chosen: &[usize]) -> ControlFlow<Covered> {
        let full: usize = chosen.iter().map(|&w| self.ways[w].cells.len()).sum();
        let settled = open.iter().all(|&word| word == 0) && left.iter().all(|l| l.0 == 0);
        let most = self.puzzle.problem.most_holes.unwrap_or(usize::MAX);
        if !settled || self.count - full > most {
            return ControlFlow::Continue(());
        }
        let solution = self.solution(chosen);
        match (self.take)(solution) {
            ControlFlow::Continue(()) => ControlFlow::Continue(()),
            ControlFlow::Break(()) => ControlFlow::Break(Covered::Stopped),
        }
    }

    fn solution(&self, chosen: &[usize]) -> Solution {
        let mut placements = Vec::new();
        for (entry, pieces) in self.puzzle.problem.pieces.iter().enumerate() {
            let mut own: Vec<usize> =
                chosen.iter().copied().filter(|&w| self.ways[w].entry == entry).collect();
            own.sort_unstable();
            let mut used = own.into_iter().map(|w| self.ways[w].placement);
            placements.extend((0..pieces.most).map(|_| used.next()));
        }
        Solution { placements, level: None }
    }
}
