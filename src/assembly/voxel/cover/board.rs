//! Takes a puzzle; gives the voxels of its result by number, and every placement of its pieces in them.
//!
//! Complete: each piece in each of 24 turns at each place, once where turns look alike. Not promised: more placements than
//! [`MOST_PLACEMENTS`].

use super::super::fit::voxels;
use crate::spec::puzzle::turn::{Matrix, TURNS, apply, matrix};
use crate::spec::puzzle::{Fill, Placement, Puzzle};
use std::collections::{BTreeMap, BTreeSet};

/// Voxels of the result, one bit each.
pub type Bits = Vec<u64>;

/// Placements of all shapes; more are refused (they would take a gigabyte).
const MOST_PLACEMENTS: usize = 1_000_000;

/// A piece set down in the result.
pub struct Way {
    /// Index into the problem's list of pieces.
    pub entry: usize,
    pub placement: Placement,
    pub bits: Bits,
    /// The same voxels as numbers.
    pub cells: Vec<u32>,
}

/// The result's voxels, numbered.
pub struct Board {
    pub at: BTreeMap<[i32; 3], usize>,
    colours: Vec<u32>,
    pub fixed: Bits,
    size: [i32; 3],
}

pub fn bit(bits: &mut [u64], k: usize) {
    bits[k / 64] |= 1 << (k % 64);
}

pub fn has(bits: &[u64], k: usize) -> bool {
    bits[k / 64] >> (k % 64) & 1 == 1
}

pub fn meet(a: &[u64], b: &[u64]) -> bool {
    a.iter().zip(b).any(|(x, y)| x & y != 0)
}

impl Board {
    pub fn of(puzzle: &Puzzle) -> Option<Board> {
        let result = &puzzle.shapes[puzzle.problem.result];
        let at: BTreeMap<[i32; 3], usize> =
            result.voxels.iter().enumerate().map(|(k, v)| (v.at, k)).collect();
        let mut fixed = vec![0; at.len().div_ceil(64)];
        let fixed_ones = result.voxels.iter().enumerate().filter(|(_, v)| v.fill == Fill::Fixed);
        fixed_ones.for_each(|(k, _)| bit(&mut fixed, k));
        let colours = result.voxels.iter().map(|v| v.colour).collect();
        (!at.is_empty()).then_some(Board { at, colours, fixed, size: result.size })
    }

    /// All placements in the result; None where there are too many.
    pub fn ways(&self, puzzle: &Puzzle) -> Option<Vec<Way>> {
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
            cells.push(k as u32);
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
    pub fn without_turned(&self, puzzle: &Puzzle, ways: Vec<Way>) -> Vec<Way> {
        let once = puzzle.problem.pieces.iter().enumerate().filter(|(_, p)| p.least == 1 && p.most == 1);
        let count = |entry: usize| ways.iter().filter(|w| w.entry == entry).count();
        let Some(pivot) = once.map(|(entry, _)| entry).max_by_key(|&e| (count(e), std::cmp::Reverse(e)))
        else {
            return ways;
        };
        let symmetries = self.symmetries(puzzle);
        let image = |way: &Way, map: &[usize]| {
            let mut bits = vec![0; way.bits.len()];
            way.cells.iter().for_each(|&k| bit(&mut bits, map[k as usize]));
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
