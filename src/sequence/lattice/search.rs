//! Takes parts on a lattice; gives the fewest single moves after which some of them leave the others for good.
//!
//! Breadth first over relative positions: the first set found to leave does so after the fewest moves (as `moves`
//! defines one). `Nothing` is exhaustive: every position that single moves reach was looked at. Since rounding all
//! coordinates down keeps parts on a lattice apart, no translations by other amounts would do either. Not promised:
//! that a set leaves within the bound; then it is said how far the search got.

use super::moves::{Gaps, Mask, Move, Next, Way, next};
use super::pairs::{Brick, Pair, around};
use super::states::{Shift, States};
use super::tables::Tables;
use crate::watch::{Stage, Watch};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A part on the lattice, in place.
#[derive(Clone, Debug)]
pub struct Piece {
    pub bricks: Vec<Brick>,
    /// Held parts never move against each other.
    pub held: bool,
    /// Where two sets part, the one with the heaviest part counts as the one that stays.
    pub weight: i32,
}

/// All parts with what is known of their pairs.
#[derive(Debug)]
pub struct Scene {
    pub pieces: Vec<Piece>,
    /// Least corner of each piece, and its shape's number.
    at: Vec<[i32; 3]>,
    shape: Vec<usize>,
    pairs: Vec<Arc<Pair>>,
    /// For each two pieces, row by row, which pair of shapes they are: the one with the lower number first.
    pair: Vec<usize>,
}

/// States that are looked at between two looks at the bound; they share the threads.
const BLOCK: usize = 512;

/// States fewer than these are looked at by one thread: a state takes some microseconds, as waking another thread does.
const FEW: usize = 8;

impl Scene {
    pub fn new(pieces: Vec<Piece>) -> Scene {
        Scene::with(pieces, &mut Tables::default())
    }

    /// With what is known of pairs of shapes from scenes before.
    pub fn with(pieces: Vec<Piece>, tables: &mut Tables) -> Scene {
        tables.make_room();
        let at: Vec<[i32; 3]> = pieces.iter().map(|p| around(&p.bricks).lo).collect();
        let shape: Vec<usize> =
            pieces.iter().zip(&at).map(|(p, at)| tables.shape(from_corner(&p.bricks, *at))).collect();
        let mut known: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let (mut pairs, mut pair) = (Vec::new(), Vec::new());
        for &a in &shape {
            for &b in &shape {
                let key = (a.min(b), a.max(b));
                pair.push(*known.entry(key).or_insert_with(|| {
                    pairs.push(tables.pair(key));
                    pairs.len() - 1
                }));
            }
        }
        Scene { pieces, at, shape, pairs, pair }
    }

    /// Steps between all pairs of `members`, shifted as the state says: the first not at all.
    fn gaps(&self, members: &[usize], state: &[Shift]) -> Gaps {
        let mut gaps = Gaps::new(members.len());
        let shift = |k: usize, axis: usize| if k == 0 { 0 } else { i32::from(state[3 * (k - 1) + axis]) };
        for (j, &b) in members.iter().enumerate() {
            for (i, &a) in members[..j].iter().enumerate() {
                if self.pieces[a].held && self.pieces[b].held {
                    (0..3).for_each(|axis| gaps.both(axis, (i, j), (0, 0)));
                    continue;
                }
                let pair = &self.pairs[self.pair[a * self.pieces.len() + b]];
                let offset: [i32; 3] = std::array::from_fn(|axis| {
                    self.at[b][axis] + shift(j, axis) - self.at[a][axis] - shift(i, axis)
                });
                let reach = if self.shape[a] <= self.shape[b] {
                    pair.reach(offset)
                } else {
                    pair.reach(offset.map(|x| -x)).turned()
                };
                (0..3).for_each(|axis| gaps.both(axis, (i, j), (reach.forward[axis], reach.back[axis])));
            }
        }
        gaps
    }
}

fn from_corner(bricks: &[Brick], at: [i32; 3]) -> Vec<Brick> {
    let moved = |corner: [i32; 3]| std::array::from_fn(|k| corner[k] - at[k]);
    let mut moved: Vec<Brick> = bricks.iter().map(|b| Brick { lo: moved(b.lo), hi: moved(b.hi) }).collect();
    moved.sort_unstable();
    moved
}

/// Whether a number of moves is known to be the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fewest {
    /// All positions within fewer moves were looked at.
    Proven,
    /// Some were not.
    Unproven,
}

/// How a search ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// Positions from the first to the one where these leave, never stopped; the fewest where that is proven.
    Leave { through: Vec<Vec<Shift>>, parts: Mask, way: Way, fewest: Fewest },
    /// Every position was looked at.
    Nothing,
    /// The bound was reached, or there were more moves than are kept; positions within `moves` moves were looked at.
    GaveUp { moves: usize },
    /// Someone stopped it; positions within `moves` moves were looked at.
    Stopped { moves: usize },
}

/// The end, and how many positions were found.
#[derive(Clone, Debug)]
pub struct Search {
    pub end: End,
    pub states: usize,
}

/// Who looks on, and where it is counted.
#[derive(Debug)]
pub struct Looks<'w> {
    pub watch: &'w Watch,
    pub stage: &'w Stage,
}

/// Searches from `start` with at most `most` states. `members` are indices of pieces; a state has three coordinates for
/// each but the first.
pub fn search(scene: &Scene, members: &[usize], start: &[Shift], most: usize, looks: &Looks) -> Search {
    let mut states = States::new(start.len());
    states.add(start, 0);
    let (mut head, mut depth, mut layer, mut complete, mut counted) = (0, 0, 1, true, 0);
    while head < states.count() {
        if states.count() > most {
            return Search { end: End::GaveUp { moves: depth }, states: states.count() };
        }
        if looks.watch.is_stopped() {
            return Search { end: End::Stopped { moves: depth }, states: states.count() };
        }
        let block = head..states.count().min(head + BLOCK).min(layer.max(head + 1));
        let one = |k: usize| next(&scene.gaps(members, states.get(k)));
        let found: Vec<Next> = if block.len() < FEW {
            block.clone().map(one).collect()
        } else {
            block.clone().into_par_iter().map(one).collect()
        };
        for (k, next) in block.clone().zip(found) {
            match next {
                Next::Leave { parts, way } => {
                    let fewest = if complete { Fewest::Proven } else { Fewest::Unproven };
                    let end = End::Leave { through: path(&states, k), parts, way, fewest };
                    return Search { end, states: states.count() };
                }
                Next::Moves { all, cut } => {
                    complete &= !cut;
                    for m in all {
                        match moved(states.get(k), m, members.len()) {
                            Some(state) => states.add(&state, k),
                            None => complete = false,
                        }
                    }
                }
            }
        }
        looks.stage.add(states.count() - counted);
        counted = states.count();
        head = block.end;
        if head == layer && head < states.count() {
            (depth, layer) = (depth + 1, states.count());
        }
    }
    let end = if complete { End::Nothing } else { End::GaveUp { moves: depth } };
    Search { end, states: states.count() }
}

/// The state after a move, about the first part; None where a shift is too far to be written down.
fn moved(state: &[Shift], m: Move, parts: usize) -> Option<Vec<Shift>> {
    // Where the first part moves, all others move the other way instead.
    let (set, sign) = if m.parts & 1 == 1 { (!m.parts, -m.way.sign()) } else { (m.parts, m.way.sign()) };
    let mut out = state.to_vec();
    for k in (1..parts).filter(|k| set >> k & 1 == 1) {
        let at = &mut out[3 * (k - 1) + m.way.axis];
        *at = Shift::try_from(i32::from(*at) + sign * i32::from(m.steps)).ok()?;
    }
    Some(out)
}

fn path(states: &States, last: usize) -> Vec<Vec<Shift>> {
    let mut at = last;
    let mut out = vec![states.get(at).to_vec()];
    while at != 0 {
        at = states.from(at);
        out.push(states.get(at).to_vec());
    }
    out.reverse();
    out
}
