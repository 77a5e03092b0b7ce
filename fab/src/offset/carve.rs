//! Takes a shape, its contact facets and a depth; gives the shape less a block around each of them.
//!
//! The fallback where the exact move fails. Sound: whatever is nearer to a contact facet than the depth is gone, so no gap
//! is short. Not exact: along edges it takes up to 1.42 times the depth; and what is left may be several bodies, or none.

use crate::ears::triangulate;
use crate::files::stl;
use crate::mesh::Mesh;
use crate::mold::fill::prism;
use crate::mold::frame::hull;
use crate::shape::Shape;
use crate::solid::{NotSolid, Solid};
use glam::{DQuat, DVec2, DVec3};

/// Sides of what stands for a circle around a facet's corners; it lies around the circle, so that it never takes too little.
const SIDES: u32 = 8;

/// The shape without a layer below its contact facets, in its own frame; `None` where nothing that can be written is left.
pub fn carve(shape: &Shape, contact: &[bool], depth: f64) -> Result<Option<Mesh>, NotSolid> {
    let solid = Solid::of(&mesh(shape))?;
    let facets = shape.facets.iter().zip(contact).filter(|(_, c)| **c).map(|(f, _)| f);
    let triangles = facets.flat_map(|f| triangulate(&shape.vertices, f).into_iter().map(|t| (t, f.normal)));
    let block = |(t, n): ([u32; 3], DVec3)| block(t.map(|v| shape.vertices[v as usize]), n, depth);
    let blocks = triangles.map(block).map(|b| Solid::of(&b)).collect::<Result<Vec<_>, _>>()?;
    let left = solid.minus(&Solid::all(blocks));
    Ok(if left.is_empty() { None } else { stl::settled(&left).map(|(mesh, _)| mesh) })
}

fn mesh(shape: &Shape) -> Mesh {
    let triangles = shape.facets.iter().flat_map(|f| triangulate(&shape.vertices, f)).collect();
    Mesh { vertices: shape.vertices.clone(), triangles }
}

/// What is nearer to the triangle than the depth, along its normal and beside it, and a little more at corners.
fn block(corners: [DVec3; 3], normal: DVec3, depth: f64) -> Mesh {
    let turn = DQuat::from_rotation_arc(normal, DVec3::Z);
    let flat = corners.map(|c| turn * c);
    let around = (0..SIDES).map(|k| {
        let angle = std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(SIDES);
        DVec2::from_angle(angle) * depth / (std::f64::consts::PI / f64::from(SIDES)).cos()
    });
    let around: Vec<DVec2> = around.collect();
    let outline = hull(flat.iter().flat_map(|c| around.iter().map(|a| c.truncate() + *a)).collect());
    // A triangle that is not flat to round-off is covered by all its heights.
    let heights = flat.map(|c| c.z);
    let low = heights.iter().copied().fold(f64::INFINITY, f64::min) - depth;
    let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max) + depth;
    let ring = |z: f64| outline.iter().map(|p| turn.inverse() * p.extend(z)).collect();
    prism(ring(low), ring(high))
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
        let mesh = carve(&cube(), &top, 0.5).unwrap().unwrap();
        assert!((mesh.volume() - 950.0).abs() < 1e-3, "{}", mesh.volume());
        assert_eq!(carve(&cube(), &[true; 6], 5.0).unwrap(), None);
    }
}
