//! Takes a puzzle with a solution; gives which sets of its pieces need not be parted.
//!
//! The rule is that of BurrTools 0.6 (Roever; `grouping.cpp`): pieces of one and the same single group may stay together;
//! beyond that a set may that is given one group, where no group is asked for more pieces of a shape than it has. Not
//! promised: that such a set can not be parted, or that it can be put together.

use super::{Puzzle, Solution};
use std::collections::BTreeMap;

/// Groups of the pieces that a solution uses, in their order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Groups {
    /// For each piece its line in the problem's list.
    line: Vec<usize>,
    /// For each line its groups, and how many of its pieces each has.
    of: Vec<BTreeMap<u32, usize>>,
}

impl Groups {
    /// None where there are none.
    pub fn of(puzzle: &Puzzle) -> Option<Groups> {
        Groups::placed(puzzle, puzzle.solution.as_ref()?)
    }

    /// The same for another solution.
    pub fn placed(puzzle: &Puzzle, solution: &Solution) -> Option<Groups> {
        let pieces = &puzzle.problem.pieces;
        let all = pieces.iter().enumerate().flat_map(|(k, p)| std::iter::repeat_n(k, p.most));
        let line: Vec<usize> =
            all.zip(&solution.placements).filter(|(_, at)| at.is_some()).map(|(k, _)| k).collect();
        let of: Vec<BTreeMap<u32, usize>> =
            pieces.iter().map(|p| p.groups.iter().copied().filter(|g| g.0 > 0).collect()).collect();
        of.iter().any(|g| !g.is_empty()).then_some(Groups { line, of })
    }

    /// The same for some of the pieces, in this order.
    pub fn among(&self, some: &[usize]) -> Groups {
        let line = some.iter().filter_map(|&k| self.line.get(k).copied()).collect();
        Groups { line, of: self.of.clone() }
    }

    /// Whether all pieces are of one group and of no other.
    pub fn is_one(&self, set: &[usize]) -> bool {
        let mut single = set.iter().map(|&k| {
            let groups = &self.of[self.line[k]];
            groups.keys().next().copied().filter(|_| groups.len() == 1)
        });
        let first = single.next().flatten();
        first.is_some() && single.all(|g| g == first)
    }

    /// Whether all of these sets may stay together.
    pub fn allow(&self, sets: &[Vec<usize>]) -> bool {
        let asked: Vec<&Vec<usize>> = sets.iter().filter(|s| !self.is_one(s)).collect();
        self.fits(&asked, &mut BTreeMap::new())
    }

    /// Gives each set a group; `used`: pieces by line and group that earlier sets have.
    fn fits(&self, sets: &[&Vec<usize>], used: &mut BTreeMap<(usize, u32), usize>) -> bool {
        let Some((set, rest)) = sets.split_first() else { return true };
        let groups = set.first().map(|&k| self.of[self.line[k]].keys().copied().collect::<Vec<u32>>());
        groups.into_iter().flatten().any(|group| {
            let mut with = used.clone();
            set.iter().for_each(|&k| *with.entry((self.line[k], group)).or_insert(0) += 1);
            let has = |line: usize| self.of[line].get(&group).copied().unwrap_or(0);
            with.iter().all(|(&(line, g), &n)| g != group || n <= has(line)) && self.fits(rest, &mut with)
        })
    }
}
