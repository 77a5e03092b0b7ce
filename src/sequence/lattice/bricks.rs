//! Takes an assembly; gives its parts as bricks on one lattice, or says why they do not lie on one.
//!
//! Sound within the touching depth: every corner of every convex cell stands within it of a point of the lattice given.
//! Not promised: the coarsest lattice there is; `MOST_DIVISIONS` bounds what is tried.

use super::moves::MOST_PARTS;
use super::pairs::{Brick, WIDEST, around, overlap};
use super::search::Piece;
use crate::assembly::{Assembly, Mobility, PartIx};
use crate::blocking::{Touch, bounds};
use glam::DVec3;

/// Divisions of the shortest distance between two faces that are tried as the lattice's step: 12 holds halves, thirds,
/// quarters and sixths.
const MOST_DIVISIONS: u32 = 12;

/// Bricks of one part, more than which its pairs cost too much to count.
const MOST_BRICKS: usize = 4096;

/// Why parts are not on a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoLattice {
    #[error("more than {MOST_PARTS} parts")]
    TooMany,
    #[error("a part has no convex cells, or too many")]
    NoCells,
    #[error("a convex cell is not a box along the axes")]
    NoBoxes,
    #[error("the boxes' faces do not lie on one lattice")]
    NoStep,
    #[error("a part is too wide for its lattice's step")]
    TooWide,
    #[error("parts overlap by a step or more")]
    Overlap,
}

/// A lattice in the assembly's frame: a corner of it, and its steps along the axes, in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    pub corner: DVec3,
    pub step: DVec3,
}

/// The parts as pieces, in their order. `step`: the lattice's where it is known, in model units. `weight`: as in
/// [`Piece`].
pub fn pieces(
    asm: &Assembly,
    parts: &[PartIx],
    step: Option<f64>,
    weight: impl Fn(PartIx) -> i32,
) -> Result<(Lattice, Vec<Piece>), NoLattice> {
    if parts.len() > MOST_PARTS {
        return Err(NoLattice::TooMany);
    }
    let touch = Touch::of(asm).depth();
    let boxes: Vec<Vec<(DVec3, DVec3)>> =
        parts.iter().map(|&p| boxes(asm, p, touch)).collect::<Result<_, _>>()?;
    let corners: Vec<DVec3> = boxes.iter().flatten().flat_map(|&(lo, hi)| [lo, hi]).collect();
    let corner = corners.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let mut steps = [0.0; 3];
    for (axis, found) in steps.iter_mut().enumerate() {
        let along: Vec<f64> = corners.iter().map(|c| c[axis] - corner[axis]).collect();
        *found = common_step(along, step, touch).ok_or(NoLattice::NoStep)?;
    }
    let lattice = Lattice { corner, step: DVec3::from_array(steps) };
    let piece = |(&p, boxes): (&PartIx, &Vec<(DVec3, DVec3)>)| {
        let held = asm.part(p).mobility == Mobility::Held;
        let bricks = boxes.iter().map(|&b| lattice.brick(b)).collect::<Option<Vec<Brick>>>()?;
        let around = around(&bricks);
        let narrow = (0..3).all(|k| around.hi[k] - around.lo[k] <= WIDEST);
        narrow.then(|| Piece { bricks, held, weight: weight(p) })
    };
    let pieces: Option<Vec<Piece>> = parts.iter().zip(&boxes).map(piece).collect();
    let pieces = pieces.ok_or(NoLattice::TooWide)?;
    let crowded = |(k, a): (usize, &Piece)| pieces[..k].iter().any(|b| overlap(&a.bricks, &b.bricks, [0; 3]));
    if pieces.iter().enumerate().any(crowded) { Err(NoLattice::Overlap) } else { Ok((lattice, pieces)) }
}

/// The part's cells as boxes.
fn boxes(asm: &Assembly, p: PartIx, touch: f64) -> Result<Vec<(DVec3, DVec3)>, NoLattice> {
    let cells = asm.cells(p);
    if cells.is_empty() || cells.len() > MOST_BRICKS {
        return Err(NoLattice::NoCells);
    }
    let one = |cell: &crate::solid::Cell| {
        let (lo, hi) = bounds(cell.vertices.iter().copied());
        let at_end = |v: &DVec3| (0..3).all(|k| (v[k] - lo[k]).min(hi[k] - v[k]) <= touch);
        let corner =
            |k: usize| DVec3::new([lo.x, hi.x][k & 1], [lo.y, hi.y][k >> 1 & 1], [lo.z, hi.z][k >> 2]);
        let near = |c: DVec3| cell.vertices.iter().any(|v| v.distance(c) <= 2.0 * touch);
        let is_box = cell.vertices.iter().all(at_end) && (0..8).all(|k| near(corner(k)));
        if is_box { Ok((lo, hi)) } else { Err(NoLattice::NoBoxes) }
    };
    cells.iter().map(one).collect()
}

/// A step of which all these lengths are multiples within `touch`.
fn common_step(mut lengths: Vec<f64>, known: Option<f64>, touch: f64) -> Option<f64> {
    lengths.sort_by(f64::total_cmp);
    let gaps = lengths.windows(2).map(|w| w[1] - w[0]).filter(|&gap| gap > 4.0 * touch);
    let least = gaps.fold(f64::INFINITY, f64::min);
    let fits = |step: f64| lengths.iter().all(|x| (x / step - (x / step).round()).abs() * step <= touch);
    match known {
        Some(step) => fits(step).then_some(step),
        None if least.is_infinite() => None,
        None => {
            let finest = (1..=MOST_DIVISIONS).map(|k| least / f64::from(k)).find(|&step| fits(step))?;
            // The gap may be off by the touching depth at both ends; the longest length knows the step best.
            let longest = lengths[lengths.len() - 1];
            Some(longest / (longest / finest).round())
        }
    }
}

impl Lattice {
    /// None where it is flat or far too large.
    fn brick(&self, (lo, hi): (DVec3, DVec3)) -> Option<Brick> {
        let at = |p: DVec3| ((p - self.corner) / self.step).round();
        let (lo, hi) = (at(lo), at(hi));
        let fits = hi.max_element() < f64::from(i32::MAX) / 4.0 && lo.cmplt(hi).all();
        fits.then(|| Brick { lo: lo.to_array().map(|x| x as i32), hi: hi.to_array().map(|x| x as i32) })
    }
}
