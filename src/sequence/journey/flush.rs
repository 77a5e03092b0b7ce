//! Takes the cells of two parts in their poses, gives the polygons on which faces of both lie flush.
//!
//! Promised: within the touching depth. Not promised: contacts of an edge or a corner; a sweep finds those by itself.

use super::bodies::Body;
use crate::assembly::PartIx;
use crate::blocking::SAME_ANGLE;
use crate::blocking::shadow::hull;
use crate::contact::Patch;
use glam::{DVec2, DVec3};

/// All flush faces of two parts.
pub fn flush(a: (PartIx, &[Body]), b: (PartIx, &[Body]), touch: f64) -> Vec<Patch> {
    let mut out = Vec::new();
    for x in a.1 {
        let near = |y: &&Body| x.centre.distance(y.centre) <= x.radius + y.radius + touch;
        for y in b.1.iter().filter(near) {
            for &(normal, d) in &x.planes {
                let faces =
                    |&(m, e): &(DVec3, f64)| (m + normal).length() <= SAME_ANGLE && (d + e).abs() <= touch;
                if y.planes.iter().any(faces) {
                    let corners = common(x, y, normal, d, touch);
                    out.extend(corners.map(|corners| Patch { a: a.0, b: b.0, normal, corners }));
                }
            }
        }
    }
    out
}

/// What both cells have of a plane; None where it has no area.
fn common(x: &Body, y: &Body, normal: DVec3, d: f64, touch: f64) -> Option<Vec<DVec3>> {
    let (u, v) = normal.any_orthonormal_pair();
    let face = |c: &Body| -> Vec<DVec2> {
        let on = c.vertices.iter().filter(|p| (normal.dot(**p) - d).abs() <= touch);
        hull(on.map(|p| DVec2::new(u.dot(*p), v.dot(*p))).collect())
    };
    let (mut left, clip) = (face(x), face(y));
    if left.len() < 3 || clip.len() < 3 {
        return None;
    }
    for k in 0..clip.len() {
        let (a, b) = (clip[k], clip[(k + 1) % clip.len()]);
        let inward = (b - a).perp().normalize_or_zero();
        left = cut(&left, inward, inward.dot(a));
    }
    let &o = left.first()?;
    let area: f64 = left[1..].windows(2).map(|w| (w[0] - o).perp_dot(w[1] - o)).sum::<f64>() / 2.0;
    let around: f64 = (0..left.len()).map(|k| left[k].distance(left[(k + 1) % left.len()])).sum();
    // A strip no wider than the touching depth is an edge beside an edge.
    (area > touch * around).then(|| left.iter().map(|p| u * p.x + v * p.y + normal * d).collect())
}

/// The part of a convex polygon with `n . p >= c`.
fn cut(poly: &[DVec2], n: DVec2, c: f64) -> Vec<DVec2> {
    let mut out = Vec::new();
    for (k, &p) in poly.iter().enumerate() {
        let q = poly[(k + 1) % poly.len()];
        let (sp, sq) = (n.dot(p) - c, n.dot(q) - c);
        if sp >= 0.0 {
            out.push(p);
        }
        if sp * sq < 0.0 {
            out.push(p.lerp(q, sp / (sp - sq)));
        }
    }
    out
}
