//! Takes a part as made, its tree and the least wall of a process; gives where the part is thinner than that, and its
//! sharpest edge.
//!
//! Exact up to round-off for walls: all pairs of triangles that face away from one another within `PARALLEL` and are
//! nearer than the least wall through the material are looked at. Not promised: pins and lips that taper by more than
//! that; their sharp edge is told instead.

use crate::bvh::Bvh;
use crate::mesh::Mesh;
use crate::near::triangles;
use glam::DVec3;
use serde::Serialize;
use std::collections::BTreeMap;

/// Faces that are off parallel by no more than this are a wall, those that meet at a larger angle an edge: over the width
/// of its own thickness a wall of 30 degrees thins by half, and a slicer's line no longer fits beside another.
pub(crate) const PARALLEL: f64 = 30.0;

/// Where a part is thinnest, finished size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Thin {
    pub thickness_mm: f64,
    /// A point on each side, mm, in place.
    pub at: [DVec3; 2],
}

/// The sharpest edge of a part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sharp {
    /// Between the two faces, through the material.
    pub degrees: f64,
    pub at: DVec3,
    /// How far from the edge the part is thinner than the least wall, mm.
    pub thin_over_mm: f64,
}

/// What was found; `None` where no wall is thinner than asked, or no edge sharper than `PARALLEL`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Walls {
    pub thinnest: Option<Thin>,
    pub sharpest: Option<Sharp>,
}

/// Looks for walls thinner than `least` mm and for sharp edges.
pub fn measure(mesh: &Mesh, tree: &Bvh, least: f64) -> Walls {
    Walls { thinnest: thinnest(mesh, tree, least), sharpest: sharpest(mesh, least) }
}

fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

fn thinnest(mesh: &Mesh, tree: &Bvh, least: f64) -> Option<Thin> {
    let mut best = None;
    opposed(mesh, tree, least, |_, thin| {
        best = Some(thin);
        thin.thickness_mm
    });
    best
}

/// Calls `found` with pairs of triangles that have a wall between them thinner than the limit, which is at first `least` mm
/// and then what `found` gives.
pub(crate) fn opposed(mesh: &Mesh, tree: &Bvh, least: f64, mut found: impl FnMut((u32, u32), Thin) -> f64) {
    let normals: Vec<DVec3> = (0..mesh.triangles.len()).map(|t| normal(mesh.corners(t))).collect();
    let opposed = -PARALLEL.to_radians().cos();
    let mut limit = least;
    let mut todo = if tree.nodes.is_empty() { vec![] } else { vec![(0, 0)] };
    while let Some((i, j)) = todo.pop() {
        if tree.boxes[i].distance_squared(&tree.boxes[j]) >= limit * limit {
            continue;
        }
        let Some((own, other)) = tree.open((i, j), &mut todo) else { continue };
        let pairs = own.iter().flat_map(|&s| other.iter().map(move |&t| (s, t)));
        for (s, t) in pairs.filter(|&(s, t)| s != t) {
            if normals[s as usize].dot(normals[t as usize]) < opposed {
                let thin = across(mesh, (s, t), normals[s as usize], limit);
                limit = thin.map_or(limit, |thin| found((s, t), thin));
            }
        }
    }
}

/// The wall between two triangles, where it is thinner than `limit` and the way from one to the other is inside.
fn across(mesh: &Mesh, (s, t): (u32, u32), outward: DVec3, limit: f64) -> Option<Thin> {
    let shared = mesh.triangles[s as usize].iter().any(|v| mesh.triangles[t as usize].contains(v));
    if shared {
        return None;
    }
    let near = triangles(mesh.corners(s as usize), mesh.corners(t as usize));
    let inside = (near.b - near.a).dot(outward) < 0.0;
    (inside && near.distance < limit).then_some(Thin { thickness_mm: near.distance, at: [near.a, near.b] })
}

fn sharpest(mesh: &Mesh, least: f64) -> Option<Sharp> {
    let mut sides: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for (t, tri) in mesh.triangles.iter().enumerate() {
        sides.extend((0..3).map(|k| ((tri[k], tri[(k + 1) % 3]), t as u32)));
    }
    let angle = |(&(u, v), &t): (&(u32, u32), &u32)| {
        let other = *sides.get(&(v, u)).filter(|_| u < v)?;
        let (n, m) = (normal(mesh.corners(t as usize)), normal(mesh.corners(other as usize)));
        let (p, q) = (mesh.vertices[u as usize], mesh.vertices[v as usize]);
        let convex = n.cross(m).dot(q - p) > 0.0;
        let inside = 180.0 - n.angle_between(m).to_degrees();
        (convex && inside < PARALLEL).then_some((inside, (p + q) / 2.0))
    };
    let (degrees, at) = sides.iter().filter_map(angle).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let thin_over_mm = least / (2.0 * (degrees.to_radians() / 2.0).tan());
    Some(Sharp { degrees, at, thin_over_mm })
}
