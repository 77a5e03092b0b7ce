//! Takes a state of some parts; gives what can be done next: a set that leaves for good, or else all single moves.
//!
//! A single move shifts a set of parts by one amount along one axis while the rest stands still. All sets that can move
//! are given: each is a union of the sets that single parts drag along, and a set of more than half of the parts moves
//! as its complement does the other way. The order is that of BurrTools 0.6 (Roever; `movementanalysator.cpp`): what
//! comes first there comes first here, so that equally short ways are chosen the same. Not promised: a bound on the
//! number of unions; [`MOST_SHIFTS`] cuts them off and says so.

use super::pairs::FREE;
use std::collections::BTreeSet;

/// Set of parts of a state, one bit for each.
pub type Mask = u128;

/// Most parts in one state.
pub const MOST_PARTS: usize = Mask::BITS as usize;

/// Moves out of one state before giving up on completeness: sixteen parts that slide side by side, each alone or with
/// any of the others, give so many.
pub const MOST_SHIFTS: usize = 1 << 16;

/// One of six ways along the axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Way {
    pub axis: usize,
    pub back: bool,
}

impl Way {
    pub const ALL: [Way; 6] = [
        Way { axis: 0, back: false },
        Way { axis: 0, back: true },
        Way { axis: 1, back: false },
        Way { axis: 1, back: true },
        Way { axis: 2, back: false },
        Way { axis: 2, back: true },
    ];

    pub fn sign(self) -> i32 {
        if self.back { -1 } else { 1 }
    }
}

/// These parts go this way by so many steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Move {
    pub parts: Mask,
    pub way: Way,
    pub steps: u16,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Next {
    /// These leave, never stopped.
    Leave { parts: Mask, way: Way },
    /// No set can leave; these are all single moves, or not all where `cut`.
    Moves { all: Vec<Move>, cut: bool },
}

/// For each axis and ordered pair of parts, steps that the first can go forward before it meets the second.
#[derive(Debug)]
pub struct Gaps {
    parts: usize,
    steps: [Vec<u16>; 3],
}

impl Gaps {
    pub fn new(parts: usize) -> Gaps {
        Gaps { parts, steps: std::array::from_fn(|_| vec![FREE; parts * parts]) }
    }

    fn put(&mut self, axis: usize, i: usize, j: usize, steps: u16) {
        self.steps[axis][i * self.parts + j] = steps;
    }

    /// Steps of `i` forward and back before it meets `j`, which goes as far the other way.
    pub fn both(&mut self, axis: usize, (i, j): (usize, usize), (forward, back): (u16, u16)) {
        self.put(axis, i, j, forward);
        self.put(axis, j, i, back);
    }

    fn get(&self, way: Way, i: usize, j: usize) -> u16 {
        let (i, j) = if way.back { (j, i) } else { (i, j) };
        self.steps[way.axis][i * self.parts + j]
    }

    /// For each part those that it meets before it has gone so many steps.
    fn met(&self, way: Way, steps: u16) -> Vec<Mask> {
        let n = self.parts;
        let met = |i: usize| (0..n).filter(move |&j| j != i && self.get(way, i, j) < steps).map(|j| 1 << j);
        (0..n).map(|i| met(i).fold(0, |all: Mask, bit: Mask| all | bit)).collect()
    }
}

/// The part with all that it drags along, or None where that is more than `most`.
pub(super) fn dragged(met: &[Mask], part: usize, most: u32) -> Option<Mask> {
    let (mut all, mut open): (Mask, Mask) = (1 << part, 1 << part);
    while open != 0 {
        let new = met[open.trailing_zeros() as usize] & !all;
        all |= new;
        open = open & (open - 1) | new;
        if all.count_ones() > most {
            return None;
        }
    }
    Some(all)
}

/// What can be done next.
pub fn next(gaps: &Gaps) -> Next {
    if let Some((parts, way)) = leaving(gaps) {
        return Next::Leave { parts, way };
    }
    let (mut all, mut cut) = (Vec::new(), false);
    for way in Way::ALL {
        cut |= !along(gaps, way, &mut all);
    }
    Next::Moves { all, cut }
}

/// Single parts first, then what drags others along; by way, then by part.
fn leaving(gaps: &Gaps) -> Option<(Mask, Way)> {
    let met = Way::ALL.map(|way| (way, gaps.met(way, FREE)));
    [1, gaps.parts as u32 / 2].into_iter().find_map(|most| {
        let mut tried = met.iter().flat_map(|(way, met)| (0..met.len()).map(move |i| (*way, met, i)));
        tried.find_map(|(way, met, i)| dragged(met, i, most).map(|parts| (parts, way)))
    })
}

/// All moves one way, added to `all`; false where they are not all.
fn along(gaps: &Gaps, way: Way, all: &mut Vec<Move>) -> bool {
    let most = gaps.parts as u32 / 2;
    let whole: Mask = if gaps.parts == MOST_PARTS { Mask::MAX } else { (1 << gaps.parts) - 1 };
    let first = all.len();
    let mut known: BTreeSet<(Mask, u16)> = BTreeSet::new();
    let mut met: Vec<Vec<Mask>> = vec![gaps.met(way, 1)];
    for part in 0..gaps.parts {
        for steps in 1..FREE {
            if met.len() < usize::from(steps) {
                met.push(gaps.met(way, steps));
            }
            let Some(parts) = dragged(&met[usize::from(steps) - 1], part, most) else { break };
            if !known.insert((parts, steps)) {
                continue;
            }
            let before = all.len();
            all.push(Move { parts, way, steps });
            // The newest first, as they were before this one came.
            for k in (first..before).rev() {
                let union = all[k].parts | parts;
                let new = union != all[k].parts && union != parts && union != whole;
                if all[k].steps == steps && new && known.insert((union, steps)) {
                    all.push(Move { parts: union, way, steps });
                }
                if all.len() - first > MOST_SHIFTS {
                    return false;
                }
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps forward along x for each ordered pair; nothing moves along the other axes.
    fn rows(x: &[&[u16]]) -> Gaps {
        let mut gaps = Gaps::new(x.len());
        for (i, row) in x.iter().enumerate() {
            for (j, &steps) in row.iter().enumerate() {
                gaps.put(0, i, j, steps);
                gaps.put(1, i, j, 0);
                gaps.put(2, i, j, 0);
            }
        }
        gaps
    }

    #[test]
    fn a_part_drags_what_it_meets_and_leaves_when_it_meets_nothing() {
        let shut = rows(&[&[0, 1, 0], &[0, 0, 0], &[0, 0, 0]]);
        assert_eq!(next(&shut), Next::Moves { all: vec![], cut: false });
        let open = rows(&[&[0, FREE, FREE], &[0, 0, 0], &[0, 0, 0]]);
        assert_eq!(next(&open), Next::Leave { parts: 1, way: Way { axis: 0, back: false } });
    }

    #[test]
    fn independent_parts_also_move_together() {
        // Parts 0 and 1 may each go one step forward against 2, 3 and 4, which hold each other.
        let free = |other: usize| if other < 2 { FREE } else { 1 };
        let row = |i: usize| (0..5).map(|j| if i < 2 { free(j) } else { 0 }).collect::<Vec<u16>>();
        let all: Vec<Vec<u16>> = (0..5).map(row).collect();
        let gaps = rows(&all.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let Next::Moves { all, cut: false } = next(&gaps) else { panic!("nothing leaves") };
        let way = Way { axis: 0, back: false };
        assert_eq!(all, [1, 2, 3].map(|parts| Move { parts, way, steps: 1 }));
    }
}
