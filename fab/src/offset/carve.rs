//! Takes a shape, its contact facets and a depth; gives the shape less a slab around each plane of them.
//!
//! The fallback where the exact move fails. Sound: whatever is nearer to a contact facet than the depth is gone. Not exact:
//! beside edges it takes up to 1.42 times the depth, at corners 1.48, of faces along the axes 1.74: the diagonals of a
//! square, an octagon's prism and a cube. Not promised: that bodies which meet in an edge or a corner alone keep the fit
//! (the caller parts them), nor that what is left is one body.
//!
//! What f32 can not hold apart must not arise, so facets of one plane make one slab, in one frame with one floor and one
//! ceiling, and faces along the axes keep their coordinates to the bit: where slabs meet they meet exactly. *A block for each
//! triangle, turned by its own normal* lost: blocks of neighbours had faces round-off apart, and the slivers crossed in f32.

use crate::ears::triangulate;
use crate::mesh::Mesh;
use crate::mold::fill::prism;
use crate::mold::frame::hull;
use crate::shape::{PLANE_ROUND_OFF, Shape};
use crate::solid::{NotSolid, Solid};
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

/// Facets whose normals differ by less than this (radians) and whose heights by less than the shape's round-off are of one
/// plane: above the round-off of normals; a slab covers all heights of its facets anyway.
const SAME_DIRECTION: f64 = 1e-9;

/// Bodies thinner than this part of the depth are dust that booleans leave, as short edges are to the exact move.
const DUST: f64 = super::REACH;

/// The shape without a layer below its contact facets, in its own frame, edges shorter than `detail` mm united; `None` where
/// nothing is left.
pub fn carve(shape: &Shape, contact: &[bool], depth: f64, detail: f64) -> Result<Option<Mesh>, NotSolid> {
    let solid = Solid::of(&shape.mesh())?;
    let slabs = planes(shape, contact).into_par_iter().map(|plane| slab(shape, &plane, depth));
    let slabs: Vec<Solid> = slabs.collect::<Result<_, _>>()?;
    let left = solid.minus(&Solid::all(slabs)).thick(DUST * depth);
    let (whole, plain) = (left.mesh(), left.plain(detail).mesh());
    // Uniting edges may cost a skin of that size, no more; where it does, as where bodies touch, they are left.
    let skin = (whole.volume() - plain.volume()).abs() <= detail * whole.area();
    Ok((!left.is_empty()).then_some(if skin { plain } else { whole }))
}

/// Contact facets by their planes, in the order of the first of each.
fn planes(shape: &Shape, contact: &[bool]) -> Vec<Vec<usize>> {
    let slack = PLANE_ROUND_OFF * shape.size();
    let height = |f: usize| shape.facets[f].normal.dot(shape.vertices[shape.facets[f].corners[0] as usize]);
    let mut planes: Vec<Vec<usize>> = Vec::new();
    for f in (0..shape.facets.len()).filter(|&f| contact[f]) {
        let normal = shape.facets[f].normal;
        let same = |p: &&mut Vec<usize>| {
            shape.facets[p[0]].normal.distance(normal) < SAME_DIRECTION
                && (height(p[0]) - height(f)).abs() <= slack
        };
        match planes.iter_mut().find(same) {
            Some(plane) => plane.push(f),
            None => planes.push(vec![f]),
        }
    }
    planes
}

/// What is nearer to the facets of a plane than the depth, along its normal and beside them, and a little more at corners.
fn slab(shape: &Shape, plane: &[usize], depth: f64) -> Result<Solid, NotSolid> {
    let z = shape.facets[plane[0]].normal;
    // Along the axes it gives axes, to the bit.
    let (x, y) = z.any_orthonormal_pair();
    let frame = DMat3::from_cols(x, y, z);
    let flat = |v: u32| frame.transpose() * shape.vertices[v as usize];
    let corners = plane.iter().flat_map(|&f| shape.facets[f].corners.iter().map(|&c| flat(c)));
    let (low, high) = corners.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p.z), h.max(p.z)));
    let around = around(shape, plane, &frame, depth);
    let triangles = plane.iter().flat_map(|&f| triangulate(&shape.vertices, &shape.facets[f]));
    let block = |t: [u32; 3]| {
        let outline =
            hull(t.iter().flat_map(|&v| around.iter().map(move |a| flat(v).truncate() + *a)).collect());
        let ring = |z: f64| outline.iter().map(|p| p.extend(z)).collect();
        Solid::of(&prism(ring(low - depth), ring(high + depth)))
    };
    let blocks = triangles.map(block).collect::<Result<Vec<_>, _>>()?;
    Solid::of(&Solid::all(blocks).mesh().map(|v| frame * v))
}

/// What stands for a circle of the depth around a facet's corners, and lies around it, so that it never takes too little: a
/// square for faces along the axes with edges along the axes, which then lose just what moved planes would take; else an
/// octagon. Sides along the frame are a depth away to the bit.
fn around(shape: &Shape, plane: &[usize], frame: &DMat3, depth: f64) -> Vec<DVec2> {
    let along = |v: DVec3| v.to_array().iter().filter(|x| **x != 0.0).count() <= 1;
    let straight = |&f: &usize| {
        let c = &shape.facets[f].corners;
        let at = |k: usize| shape.vertices[c[k % c.len()] as usize];
        (0..c.len()).all(|k| along(at(k + 1) - at(k)))
    };
    let signs = [[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(DVec2::from_array);
    let short = depth * (std::f64::consts::PI / 8.0).tan();
    let square = along(frame.z_axis) && plane.iter().all(straight);
    let points = if square {
        vec![DVec2::splat(depth)]
    } else {
        vec![DVec2::new(depth, short), DVec2::new(short, depth)]
    };
    points.into_iter().flat_map(|p| signs.map(|s| s * p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Facet;

    fn cube() -> Shape {
        let corner =
            |k: usize| DVec3::from_array(std::array::from_fn(|a| if k >> a & 1 == 1 { 10.0 } else { 0.0 }));
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let normals = [DVec3::NEG_Z, DVec3::Z, DVec3::NEG_Y, DVec3::Y, DVec3::NEG_X, DVec3::X];
        let facet = |(q, n): (&[u32; 4], DVec3)| Facet { corners: q.to_vec(), normal: n };
        Shape {
            vertices: (0..8).map(corner).collect(),
            facets: quads.iter().zip(normals).map(facet).collect(),
        }
    }

    #[test]
    fn a_face_of_a_cube_goes_back_by_the_depth_and_too_deep_leaves_nothing() {
        let top = [false, true, false, false, false, false];
        let mesh = carve(&cube(), &top, 0.5, 1e-6).unwrap().unwrap();
        assert!((mesh.volume() - 950.0).abs() < 1e-3, "{}", mesh.volume());
        assert_eq!(carve(&cube(), &[true; 6], 5.0, 1e-6).unwrap(), None);
    }
}
