//! Moves counted by a plain search over voxels, against the planner's: all sets of pieces, one unit step after the other.

use super::{burr, puzzle};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::ControlFlow;
use weavelock::assembly::voxel::{cover, placed};
use weavelock::sequence::lattice::apart::{Fate, take_apart};
use weavelock::sequence::lattice::pairs::Brick;
use weavelock::sequence::lattice::search::{Looks, Piece, Scene};
use weavelock::watch::{All, Watch};

type At = [i32; 3];

/// Moves until the first parting, and None where there is none.
fn plain(pieces: &[BTreeSet<At>], far: i32) -> Option<usize> {
    let n = pieces.len();
    let start = vec![[0; 3]; n];
    let mut moves: BTreeMap<Vec<At>, usize> = BTreeMap::from([(start.clone(), 0)]);
    let mut layer = vec![start];
    for count in 1.. {
        let mut next = Vec::new();
        for state in &layer {
            for (set, axis, sign) in
                (1..(1 << n) - 1).flat_map(|s| (0..3).flat_map(move |a| [1, -1].map(|g| (s, a, g))))
            {
                let mut there = state.clone();
                for step in 1.. {
                    (0..n).filter(|k| set >> k & 1 == 1).for_each(|k| there[k][axis] += sign);
                    if overlaps(pieces, &there) {
                        break;
                    }
                    if step > far {
                        return Some(count);
                    }
                    let first = there[0];
                    let about: Vec<At> =
                        there.iter().map(|v| std::array::from_fn(|k| v[k] - first[k])).collect();
                    if !moves.contains_key(&about) {
                        moves.insert(about.clone(), count);
                        next.push(about);
                    }
                }
            }
        }
        if next.is_empty() {
            return None;
        }
        layer = next;
    }
    None
}

fn overlaps(pieces: &[BTreeSet<At>], at: &[At]) -> bool {
    let mut seen = BTreeSet::new();
    let moved =
        pieces.iter().zip(at).flat_map(|(p, s)| p.iter().map(|v| [v[0] + s[0], v[1] + s[1], v[2] + s[2]]));
    moved.into_iter().any(|v| !seen.insert(v))
}

/// As the planner counts, with the positions that it found.
fn planned(pieces: &[BTreeSet<At>]) -> (Option<usize>, usize) {
    let bricks = |p: &BTreeSet<At>| p.iter().map(|&lo| Brick { lo, hi: lo.map(|x| x + 1) }).collect();
    let pieces: Vec<Piece> =
        pieces.iter().map(|p| Piece { bricks: bricks(p), held: false, weight: 1 }).collect();
    let all: Vec<usize> = (0..pieces.len()).collect();
    let watch = Watch::default();
    let stage = watch.stage("", "", All::Open);
    let looks = Looks { watch: &watch, stage: &stage };
    let apart = take_apart(&Scene::new(pieces), &all, 1_000_000, None, &looks);
    match apart.whole.fate {
        Fate::Parted { steps, .. } => (Some(steps.len()), apart.states),
        Fate::Done | Fate::Together | Fate::Kept(_) => (None, apart.states),
    }
}

/// Positions of one way that the plain search is left with.
const MOST: usize = 120;

#[test]
fn a_plain_search_counts_the_same_moves() {
    let mut seen: BTreeMap<Option<usize>, usize> = BTreeMap::new();
    let sets = [
        [120, 160, 256, 512, 880, 960],
        [412, 480, 512, 704, 704, 960],
        [88, 512, 768, 922, 1008, 1008],
        [624, 702, 768, 883, 1015, 1024],
        [463, 564, 760, 909, 927, 1016],
    ];
    for numbers in sets {
        let puzzle = puzzle(&burr(numbers, 6));
        cover::assemblies(&puzzle, 100_000_000, |solution| {
            let lying = placed(&puzzle, &solution).expect("it fits");
            let pieces: Vec<BTreeSet<At>> =
                lying.iter().map(|p| p.voxels.iter().copied().collect()).collect();
            let (found, positions) = planned(&pieces);
            if positions <= MOST {
                assert_eq!(plain(&pieces, 12), found, "{numbers:?}: {solution:?}");
                *seen.entry(found).or_default() += 1;
            }
            ControlFlow::Continue(())
        });
    }
    assert!(seen.contains_key(&None) && seen.keys().any(|k| *k >= Some(5)), "too tame: {seen:?}");
}
