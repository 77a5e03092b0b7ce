//! Takes an assembly and a plan, says whether the plan holds: each move along its whole way, and the book-keeping.
//!
//! Shares no code with the stages that made the plan, only its shape as written. Sound for the solids' convex cells,
//! which are themselves checked against the solid; complete up to the tolerance: a plan that overlaps by less may be
//! accepted. Straight moves are one program each; where something turns, stretches of the motion are vouched for by planes
//! (`sweep`), and a plan that turns too closely for that is undecided. Not checked: the locks that a plan quotes for sets that stayed together (they have their own check).

mod apart;
mod book;
mod cells;
mod level;
mod lp;
mod sweep;
mod turn;
mod walk;
mod way;

pub use level::counted;
pub use way::{Ball, Gap, Way, by_faces, by_program, gap};

use crate::assembly::{Assembly, PartIx};
use crate::sequence::Plan;
use crate::solid::Cell;
use cells::cells_fill;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Radius of the largest ball that may fit into two parts at once, as a share of the smallest part's box diagonal:
/// 2^-20, far above round-off (2^-40) carried over the longest way and far below what can be made. Parts whose corners
/// are known no better than that (meshes with few digits) are checked to twice what these may be off.
pub const TOLERANCE_SHARE: f64 = 1.0 / (1u64 << 20) as f64;

/// How far a direction's length may be from 1, and a length from its value in mm, as a share: nine digits.
const WRITTEN_SHARE: f64 = 1e-9;

#[derive(Clone, Debug, PartialEq)]
pub enum Checked {
    /// `clear`: distance that all moves keep, model units, as claimed and checked; `deepest`: no larger ball fits into
    /// two parts at once anywhere (0 where they only touch).
    Valid { clear: f64, deepest: f64 },
    /// `step`: index, or the number of steps where the fault is in the whole. `t`: where along the way, in model units
    /// for straight moves, as a share of the motion where something turns.
    Invalid { step: usize, parts: Vec<String>, depth: f64, t: f64, why: String },
    /// Neither could be shown.
    Undecided { why: String },
}

/// Checks a plan for the whole assembly.
pub fn check<C>(asm: &Assembly, plan: &Plan<C>) -> Checked {
    check_of(asm, &asm.ids().collect::<Vec<_>>(), plan)
}

/// Checks a plan for some of the parts; the others are not there.
pub fn check_of<C>(asm: &Assembly, parts: &[PartIx], plan: &Plan<C>) -> Checked {
    let scene = match Scene::new(asm, parts) {
        Ok(scene) => scene,
        Err(why) => return Checked::Undecided { why },
    };
    let moves = match scene.book(plan) {
        Ok(moves) => moves,
        Err(fault) => return *fault,
    };
    let ways: Vec<Checked> = moves.par_iter().enumerate().map(|(k, m)| scene.walk(k, m)).collect();
    let (mut clear, mut deepest) = (f64::INFINITY, 0.0);
    for way in ways {
        match way {
            Checked::Valid { clear: c, deepest: d } => {
                (clear, deepest) = (f64::min(clear, c), f64::max(deepest, d))
            }
            fault => return fault,
        }
    }
    Checked::Valid { clear: if clear.is_finite() { clear } else { 0.0 }, deepest }
}

type Parts = BTreeSet<PartIx>;

#[derive(Clone, Debug)]
struct Placed {
    cell: Cell,
    lo: DVec3,
    hi: DVec3,
}

/// The parts in place, cell by cell.
struct Scene<'a> {
    asm: &'a Assembly,
    ids: BTreeMap<&'a str, PartIx>,
    cells: BTreeMap<PartIx, Vec<Placed>>,
    tolerance: f64,
}

impl<'a> Scene<'a> {
    fn new(asm: &'a Assembly, parts: &[PartIx]) -> Result<Scene<'a>, String> {
        if let Some(p) = parts.iter().find(|p| p.at() >= asm.parts.len()) {
            return Err(format!("there is no part number {}", p.0));
        }
        let ids: BTreeMap<&str, PartIx> = parts.iter().map(|&p| (asm.part(p).id.as_str(), p)).collect();
        let cells: BTreeMap<PartIx, Vec<Placed>> =
            parts.iter().map(|&p| (p, asm.cells(p).into_iter().map(placed).collect())).collect();
        let diagonal = |cells: &Vec<Placed>| {
            let (lo, hi) = box_of(cells);
            (hi - lo).length()
        };
        let share = TOLERANCE_SHARE * cells.values().map(diagonal).fold(f64::INFINITY, f64::min);
        let solids: BTreeSet<usize> = parts.iter().map(|&p| asm.part(p).solid).collect();
        // Two faces that are meant to touch overlap by what the corners of both stand off them.
        let tolerance = solids.iter().map(|&s| 2.0 * asm.solids[s].off).fold(share, f64::max);
        for s in solids {
            cells_fill(asm, s, tolerance).map_err(|why| format!("solid {s}: {why}"))?;
        }
        Ok(Scene { asm, ids, cells, tolerance })
    }
}

/// False for what is no number.
fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= WRITTEN_SHARE * expected.abs()
}

fn unsolved(step: usize) -> Checked {
    Checked::Undecided { why: format!("step {step}: a program was not solved") }
}

fn refuse(step: usize, parts: &[String], depth: f64, t: f64, why: &str) -> Checked {
    Checked::Invalid { step, parts: parts.to_vec(), depth, t, why: why.to_owned() }
}

fn placed(cell: Cell) -> Placed {
    let lo = cell.vertices.iter().fold(DVec3::INFINITY, |m, v| m.min(*v));
    let hi = cell.vertices.iter().fold(DVec3::NEG_INFINITY, |m, v| m.max(*v));
    Placed { cell, lo, hi }
}

fn box_of(cells: &[Placed]) -> (DVec3, DVec3) {
    cells.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), c| (lo.min(c.lo), hi.max(c.hi)))
}
