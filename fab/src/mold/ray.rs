//! Takes a mesh with its tree; gives where a ray meets it.
//!
//! Not promised: a decision on rays that graze an edge; whoever needs one that is exact asks `shadow`.

use crate::bvh::{Aabb, Bvh, Node};
use crate::mesh::Mesh;
use glam::DVec3;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    pub triangle: u32,
    /// In lengths of the ray's direction.
    pub at: f64,
}

/// The nearest hit beyond `from` lengths.
pub fn first(target: (&Mesh, &Bvh), origin: DVec3, along: DVec3, from: f64) -> Option<Hit> {
    let mut best: Option<Hit> = None;
    visit(target, origin, along, &mut |hit| {
        if hit.at > from && best.is_none_or(|b| hit.at < b.at) {
            best = Some(hit);
        }
        best.map_or(f64::INFINITY, |b| b.at)
    });
    best
}

/// Whether anything is hit beyond `from` lengths.
pub fn any(target: (&Mesh, &Bvh), origin: DVec3, along: DVec3, from: f64) -> bool {
    let mut found = false;
    visit(target, origin, along, &mut |hit| {
        found |= hit.at > from;
        if found { f64::NEG_INFINITY } else { f64::INFINITY }
    });
    found
}

/// How much matter lies right behind a point of the surface along a unit vector, mm; 0 at a sharp rim.
pub fn matter((mesh, tree): (&Mesh, &Bvh), from: DVec3, along: DVec3) -> f64 {
    let (lo, hi) = mesh.bounds();
    let hit = first((mesh, tree), from, along, (hi - lo).length() * OFF_SURFACE);
    let leaves = |h: &Hit| {
        let [a, b, c] = mesh.corners(h.triangle as usize);
        (b - a).cross(c - a).dot(along) > 0.0
    };
    hit.filter(leaves).map_or(0.0, |h| h.at)
}

/// Hits nearer than this share of the size are the surface that the ray starts from.
const OFF_SURFACE: f64 = 1e-7;

/// Calls `f` with hits; it gives how far to look on.
fn visit((mesh, tree): (&Mesh, &Bvh), origin: DVec3, along: DVec3, f: &mut impl FnMut(Hit) -> f64) {
    let mut todo = if tree.nodes.is_empty() { vec![] } else { vec![0] };
    let (inverse, mut far) = (along.recip(), f64::INFINITY);
    while let Some(n) = todo.pop() {
        if !meets_box(&tree.boxes[n], origin, inverse, far) {
            continue;
        }
        match tree.nodes[n] {
            Node::Branch { left, right } => todo.extend([right, left]),
            Node::Leaf { first, count } => {
                for &t in tree.leaf(first, count) {
                    if let Some(at) = meets(mesh.corners(t as usize), origin, along) {
                        far = f(Hit { triangle: t, at });
                    }
                }
            }
        }
    }
}

fn meets_box(b: &Aabb, origin: DVec3, inverse: DVec3, far: f64) -> bool {
    let (mut enter, mut leave) = (0.0f64, far);
    for k in 0..3 {
        let (s, t) = ((b.lo[k] - origin[k]) * inverse[k], (b.hi[k] - origin[k]) * inverse[k]);
        // 0 * infinity: the origin lies in a face of the box along the ray, which decides nothing.
        if !s.is_nan() && !t.is_nan() {
            enter = enter.max(s.min(t));
            leave = leave.min(s.max(t));
        }
    }
    enter <= leave
}

fn meets([a, b, c]: [DVec3; 3], origin: DVec3, along: DVec3) -> Option<f64> {
    let (u, v) = (b - a, c - a);
    let p = along.cross(v);
    let det = u.dot(p);
    if det == 0.0 {
        return None;
    }
    let s = origin - a;
    let x = s.dot(p) / det;
    let q = s.cross(u);
    let y = along.dot(q) / det;
    (x >= 0.0 && y >= 0.0 && x + y <= 1.0).then(|| v.dot(q) / det)
}
