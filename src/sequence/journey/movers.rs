//! Takes a set of parts, gives the searches to be made for a way out: who may move in each, and the work that it may take.
//!
//! A small set is one search in which all move. Of a large one single parts move, then each together with the parts that it
//! touches, as far as first order lets something start while all others stand still. Not complete: a motion that needs
//! more parts of a large set at once is not looked for.

use super::bodies::Bodies;
use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::locking::{Freedom, Unknowns, Verdict, decide, rows};
use std::collections::BTreeSet;

/// Parts that move in one search: with more, some stand still.
const MOST_PARTS: usize = 24;

/// Work of one search in which all of a small set move, in products of rows and unknowns of its programs, and pairs of cells.
const MOST_SPENT: usize = 20_000_000;

/// Who may move, and the most work that a search may take.
pub struct Movers {
    pub bodies: Bodies,
    pub most: usize,
}

type Places = BTreeSet<usize>;

pub fn searches(asm: &Assembly, patches: &[Patch], bodies: Bodies) -> Vec<Movers> {
    if bodies.parts.len() <= MOST_PARTS {
        return vec![Movers { bodies, most: MOST_SPENT }];
    }
    let free = |moving: &Places| starts(asm, patches, &bodies, moving);
    // A single part gets what one of the largest small set has.
    let alone = bodies.movable().map(|k| Places::from([k])).filter(free);
    let with = |moving: Places, most| Movers { bodies: bodies.moving(&moving), most };
    let mut all: Vec<Movers> = alone.map(|m| with(m, MOST_SPENT / MOST_PARTS)).collect();
    let around: BTreeSet<Places> = bodies.movable().map(|k| touching(patches, &bodies, k)).collect();
    let around: Vec<Places> =
        around.into_iter().filter(|m| (2..=MOST_PARTS).contains(&m.len()) && free(m)).collect();
    let share = MOST_SPENT / around.len().max(1);
    all.extend(around.into_iter().map(|m| with(m, share)));
    all
}

/// A part and those that it touches, without those that may not move.
fn touching(patches: &[Patch], bodies: &Bodies, k: usize) -> Places {
    let p = bodies.parts[k];
    let other = |c: &Patch| match (c.a == p, c.b == p) {
        (true, _) => Some(c.b),
        (_, true) => Some(c.a),
        _ => None,
    };
    let touched: BTreeSet<PartIx> = patches.iter().filter_map(other).chain([p]).collect();
    bodies.movable().filter(|j| touched.contains(&bodies.parts[*j])).collect()
}

/// False where first order proves that nothing of these starts while all others stand still.
fn starts(asm: &Assembly, patches: &[Patch], bodies: &Bodies, moving: &Places) -> bool {
    let movers: BTreeSet<PartIx> = moving.iter().map(|&k| bodies.parts[k]).collect();
    let set: BTreeSet<PartIx> = bodies.parts.iter().copied().collect();
    let bears = |c: &&Patch| {
        set.contains(&c.a) && set.contains(&c.b) && (movers.contains(&c.a) || movers.contains(&c.b))
    };
    let near: Vec<Patch> = patches.iter().filter(bears).cloned().collect();
    let rows = rows(&near, Freedom::Rigid);
    let still: Vec<PartIx> = asm.ids().filter(|p| !movers.contains(p)).collect();
    !matches!(decide(&rows, &Unknowns::new(asm, &rows, &still, Freedom::Rigid)), Verdict::Locked(_))
}
