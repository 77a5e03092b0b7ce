//! Takes a shape of voxels; gives its solid: unit squares over shared corners, and boxes as convex cells.
//!
//! Where voxels touch along an edge or at a corner only, the surface touches itself there: four squares share the edge,
//! two each way, as for meshes read from files. Not promised: fewest boxes.

use super::boxes::boxes;
use crate::solid::{Cell, Facet, Solid};
use crate::spec::puzzle::Shape;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

type At = [i32; 3];

pub fn solid(shape: &Shape) -> Solid {
    let full: BTreeSet<At> = shape.voxels.iter().map(|v| v.at).collect();
    let (mut corners, mut facets): (BTreeMap<At, u32>, Vec<Facet>) = (BTreeMap::new(), Vec::new());
    let mut vertices = Vec::new();
    for &v in &full {
        for (axis, side) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut beside = v;
            beside[axis] += 2 * side - 1;
            if !full.contains(&beside) {
                let ring = square(v, axis, side).map(|at| {
                    *corners.entry(at).or_insert_with(|| {
                        vertices.push(DVec3::from_array(at.map(f64::from)));
                        vertices.len() as u32 - 1
                    })
                });
                let normal = DVec3::AXES[axis] * f64::from(2 * side - 1);
                facets.push(Facet { corners: ring.to_vec(), normal });
            }
        }
    }
    Solid { vertices, facets, cells: boxes(full).iter().map(|&(lo, hi)| cell(lo, hi)).collect(), off: 0.0 }
}

/// Corners of a voxel's face, counter-clockwise from outside; `side` 1 is the face away from the origin.
fn square(v: At, axis: usize, side: i32) -> [At; 4] {
    let (u, w) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |du: i32, dw: i32| {
        let mut at = v;
        at[axis] += side;
        at[u] += du;
        at[w] += dw;
        at
    };
    let ring = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
    if side == 1 { ring } else { [ring[0], ring[3], ring[2], ring[1]] }
}

fn cell(lo: At, hi: At) -> Cell {
    let ends = [lo, hi].map(|c| c.map(f64::from));
    let corner = |k: usize| DVec3::from_array(std::array::from_fn(|axis| ends[k >> axis & 1][axis]));
    let facets = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let plane = |(axis, side): (usize, usize)| {
        let sign = 2.0 * side as f64 - 1.0;
        (DVec3::AXES[axis] * sign, sign * ends[side][axis])
    };
    Cell {
        vertices: (0..8).map(corner).collect(),
        facets: facets.map(|f| f.to_vec()).to_vec(),
        planes: (0..6).map(|k| plane((k / 2, k % 2))).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::puzzle::{Fill, Voxel};

    fn shape(voxels: &[At]) -> Shape {
        let voxels = voxels.iter().map(|&at| Voxel { at, fill: Fill::Fixed, colour: 0 }).collect();
        Shape { size: [4; 3], voxels, hot: [0; 3], name: String::new(), weight: 1 }
    }

    #[test]
    fn solid_and_cells_hold_the_voxels() {
        let bent = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [2, 1, 1], [0, 1, 1]];
        let solid = solid(&shape(&bent));
        // Sixths are rounded: two triangles a square, each a product of three corners below 4.
        let round_off = 2.0 * solid.facets.len() as f64 * 64.0 * f64::EPSILON;
        assert!((solid.volume() - 6.0).abs() <= round_off);
        let sizes = solid.cells.iter().map(|c| (c.vertices[7] - c.vertices[0]).element_product());
        assert_eq!(sizes.sum::<f64>(), 6.0);
        let mut ends: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        for f in &solid.facets {
            for k in 0..4 {
                let (a, b) = (f.corners[k], f.corners[(k + 1) % 4]);
                *ends.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
            }
        }
        assert!(ends.values().all(|&n| n == 0), "each edge is run both ways as often");
    }
}
