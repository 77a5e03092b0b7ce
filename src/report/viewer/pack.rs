//! Takes meshes and poses; gives them as little-endian buffers in base64, the way a graphics card takes them.
//!
//! Positions are f32 about a centre that is taken off in f64 first, so that a part far from the origin keeps its shape.
//! Not promised: more than f32's 24 bits of that.

use super::base64;
use crate::report::draw::Mesh;
use crate::report::draw::mesh::EdgeKind;
use glam::{DAffine3, DVec3};
use serde::Serialize;
use std::collections::BTreeMap;

/// A mesh about its own centre.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shape {
    /// What was taken off, model units.
    pub centre: DVec3,
    /// Largest distance of a corner from the centre.
    pub radius: f64,
    pub triangles: usize,
    /// f32: corners of triangles, x y z.
    positions: String,
    /// f32: unit normals of those corners.
    normals: String,
    /// u32: three corners to a triangle.
    corners: String,
    /// f32: both ends of each crease, x y z.
    creases: String,
}

pub fn shape(mesh: &Mesh) -> Shape {
    let lo = mesh.vertices.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let hi = mesh.vertices.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let centre = if mesh.vertices.is_empty() { DVec3::ZERO } else { (lo + hi) / 2.0 };
    let mut index: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let (mut positions, mut normals, mut corners) = (Vec::new(), Vec::new(), Vec::new());
    for t in &mesh.triangles {
        for (&v, &n) in t.corners.iter().zip(&t.normals) {
            let next = index.len() as u32;
            let k = *index.entry((v, n)).or_insert_with(|| {
                positions.push(mesh.vertices[v as usize] - centre);
                normals.push(mesh.normals[n as usize]);
                next
            });
            corners.push(k);
        }
    }
    let creases = mesh.edges.iter().filter(|e| e.kind == EdgeKind::Crease);
    let ends: Vec<DVec3> = creases.flat_map(|e| e.ends.map(|v| mesh.vertices[v as usize] - centre)).collect();
    Shape {
        centre,
        radius: mesh.vertices.iter().map(|v| (*v - centre).length()).fold(0.0, f64::max),
        triangles: mesh.triangles.len(),
        positions: floats(positions.iter().flat_map(|p| p.to_array())),
        normals: floats(normals.iter().flat_map(|n| n.to_array())),
        corners: whole(corners),
        creases: floats(ends.iter().flat_map(|p| p.to_array())),
    }
}

/// Each pose as 12 f64, the three columns of its turn and its shift, for a shape about `centre` in a scene about
/// `middle`.
pub fn pose(pose: &DAffine3, centre: DVec3, middle: DVec3) -> [f64; 12] {
    let shift = pose.transform_point3(centre) - middle;
    DAffine3::from_mat3_translation(pose.matrix3, shift).to_cols_array()
}

pub fn floats(numbers: impl IntoIterator<Item = f64>) -> String {
    base64(&numbers.into_iter().flat_map(|x| (x as f32).to_le_bytes()).collect::<Vec<u8>>())
}

pub fn doubles(numbers: impl IntoIterator<Item = f64>) -> String {
    base64(&numbers.into_iter().flat_map(f64::to_le_bytes).collect::<Vec<u8>>())
}

pub fn whole(numbers: impl IntoIterator<Item = u32>) -> String {
    base64(&numbers.into_iter().flat_map(u32::to_le_bytes).collect::<Vec<u8>>())
}
