//! Takes a solid with its convex cells, says whether the cells may stand for it.
//!
//! Checked: faces, corners and planes agree, no cell is too thin, volumes add up. Not checked: that cells of one solid
//! keep out of each other other than by their volumes.

use super::near;
use super::way::{Way, by_program};
use crate::assembly::Assembly;
use crate::solid::Cell;
use glam::DVec3;

/// Whether the cells may stand for the solid: faces, corners and planes agree, none is so thin that overlaps could hide
/// in it, and their volumes add up to the solid's.
pub(super) fn cells_fill(asm: &Assembly, solid: usize, tolerance: f64) -> Result<(), String> {
    /// Balls of four tolerances must fit, or a stack of slivers could hide an overlap from a test of single cells.
    const LEAST_BALL: f64 = 4.0;
    /// Share of the volume that round-off may lose: corners are known to 2^-40, cells to a fraction of the solid.
    const VOLUME_SHARE: f64 = 1e-6;
    let solid = &asm.solids[solid];
    if solid.cells.is_empty() {
        return Err("no convex cells are known".to_owned());
    }
    let mut volume = 0.0;
    for (k, cell) in solid.cells.iter().enumerate() {
        agrees(cell, tolerance).map_err(|why| format!("cell {k}: {why}"))?;
        let still = Way { direction: DVec3::Z, length: 0.0 };
        let room = by_program(cell, cell, still).map_or(0.0, |ball| ball.radius);
        if room < LEAST_BALL * tolerance {
            return Err(format!("cell {k} is thinner than the tolerance"));
        }
        volume += volume_of(cell);
    }
    let (whole, surface) = (solid.volume(), solid.surface());
    if (volume - whole).abs() <= VOLUME_SHARE * whole.abs() + solid.off * surface {
        Ok(())
    } else {
        Err(format!("the cells hold {volume}, the solid {whole}"))
    }
}

fn agrees(cell: &Cell, tolerance: f64) -> Result<(), &'static str> {
    if cell.planes.len() != cell.facets.len() {
        return Err("as many planes as facets are needed");
    }
    let off = |n: DVec3, d: f64, v: DVec3| n.dot(v) - d;
    for (&(n, d), facet) in cell.planes.iter().zip(&cell.facets) {
        let on = |&k: &u32| cell.vertices.get(k as usize).is_some_and(|&v| off(n, d, v).abs() <= tolerance);
        if !near(n.length(), 1.0) {
            return Err("a plane's normal is not a unit vector");
        }
        if !facet.iter().all(on) || !cell.vertices.iter().all(|&v| off(n, d, v) <= tolerance) {
            return Err("corners and planes do not agree");
        }
    }
    Ok(())
}

/// By the divergence theorem over the facets, as fans.
fn volume_of(cell: &Cell) -> f64 {
    let Some(&o) = cell.vertices.first() else { return 0.0 };
    let fan = |f: &Vec<u32>| -> f64 {
        let at = |k: usize| cell.vertices[f[k] as usize] - o;
        (1..f.len().saturating_sub(1)).map(|k| at(0).dot(at(k).cross(at(k + 1)))).sum()
    };
    cell.facets.iter().map(fan).sum::<f64>() / 6.0
}
