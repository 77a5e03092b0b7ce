//! Takes a puzzle with a solution; gives its pieces in place, one solid for each shape, or where they do not fit.
//!
//! Promised: pieces share no voxel, lie in the shape that they are to fill, and fill all of it that must be filled;
//! solids close, their convex cells are boxes on whole numbers. The unit is the edge of a voxel. Not promised: that the
//! pieces can be put together.

pub mod boxes;
pub mod cover;
mod fit;
mod solid;

pub use fit::{Misfit, Placed, placed};

use super::{Assembly, Mobility, Part};
use crate::spec::puzzle::turn::{Matrix, apply};
use crate::spec::puzzle::{Puzzle, Shape, Solution};
use glam::{DAffine3, DMat3, DVec3};
use std::collections::BTreeMap;

/// The assembly of a solution.
///
/// # Errors
/// All places where pieces overlap, stand out, or leave a hole.
pub fn assembly(
    name: &str,
    puzzle: &Puzzle,
    solution: &Solution,
    mm_per_unit: f64,
) -> Result<Assembly, Vec<Misfit>> {
    let placed = placed(puzzle, solution)?;
    let mut first: BTreeMap<usize, usize> = BTreeMap::new();
    let mut solids = Vec::new();
    for p in &placed {
        first.entry(p.shape).or_insert_with(|| {
            solids.push(solid::solid(&puzzle.shapes[p.shape]));
            solids.len() - 1
        });
    }
    let part = |p: &Placed| Part {
        id: p.id.clone(),
        solid: first[&p.shape],
        pose: pose(&puzzle.shapes[p.shape], p.turn, p.at),
        mobility: Mobility::Free,
    };
    let parts = placed.iter().map(part).collect();
    Ok(Assembly { name: name.to_string(), solids, parts, mm_per_unit })
}

/// From the shape's frame: voxel v goes to `turn` (v - hot spot) + `at`, its middle half a voxel beyond.
fn pose(shape: &Shape, turn: Matrix, at: [i32; 3]) -> DAffine3 {
    let column = |k: usize| DVec3::from_array(turn.map(|row| f64::from(row[k])));
    let linear = DMat3::from_cols(column(0), column(1), column(2));
    let whole = |v: [i32; 3]| DVec3::from_array(v.map(f64::from));
    let half = DVec3::splat(0.5);
    // Halves turn into halves: the sum is whole, and exact.
    DAffine3::from_mat3_translation(linear, whole(at) - whole(apply(turn, shape.hot)) + half - linear * half)
}
