//! Takes two shapes, tells how deep one reaches into the other.
//!
//! Sound: a depth that is given is really reached, at the point that is given. Complete for shapes whose
//! convex cells are known, up to overlaps so thin that they hold no ball as wide as the tolerance. Without
//! cells it looks at every stretch of every edge between the faces that it pierces, the middle of every
//! facet, and the space under faces that lie flush the same way; an overlap that shows at none of these is
//! not seen.

use super::flush::{Facing, regions};
use super::shape::{Shape, around};
use crate::assembly::mesh::solid_angle;
use crate::assembly::mesh::{halves, height};
use crate::solid::Cell;
use glam::DVec3;
use parry3d_f64::bounding_volume::BoundingVolume;

/// How deep, in model units: either `at` is on one surface and that far below the other, or a ball of that
/// diameter around it is in both shapes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Depth {
    pub at: DVec3,
    pub depth: f64,
}

/// The deepest point that was found deeper than the tolerance.
pub(super) fn overlap(a: &Shape, b: &Shape, tolerance: f64) -> Option<Depth> {
    let reaching = |a: &Shape, b: &Shape| {
        let points = edge_middles(a, b, tolerance).chain(facet_middles(a));
        deepest(points.collect::<Vec<_>>(), b, tolerance)
    };
    let under = deepest(under_flush(a, b, tolerance), b, tolerance);
    let found = [reaching(a, b), reaching(b, a), under].into_iter().flatten();
    found.reduce(|x, y| if y.depth > x.depth { y } else { x }).or_else(|| by_cells(a, b, tolerance))
}

/// The roundest space that two cells share.
fn by_cells(a: &Shape, b: &Shape, tolerance: f64) -> Option<Depth> {
    let pairs = a.cells.iter().flat_map(|x| b.cells.iter().map(move |y| (x, y)));
    let near = pairs
        .filter(|((_, p), (_, q))| p.tightened(tolerance / 2.0).intersects(&q.tightened(tolerance / 2.0)));
    let shared = near.filter_map(|((x, _), (y, _))| shared(x, y, tolerance / 2.0));
    let measured = shared.map(|p| Depth { at: p, depth: 2.0 * distance(a, p).min(distance(b, p)) });
    measured.filter(|d| d.depth > tolerance).reduce(|x, y| if y.depth > x.depth { y } else { x })
}

/// A point of both cells farther than `inset` from the planes of either.
fn shared(x: &Cell, y: &Cell, inset: f64) -> Option<DVec3> {
    let inner = |&(n, d): &(DVec3, f64)| (n, d - inset);
    let misses = |c: &Cell, other: &Cell| {
        c.planes.iter().map(inner).any(|p| other.vertices.iter().all(|&v| height(p, v) >= 0.0))
    };
    if misses(x, y) || misses(y, x) {
        return None;
    }
    // Thinner remainders are round-off of the cuts.
    let thin = inset / 1000.0;
    let planes = x.planes.iter().chain(&y.planes).map(inner);
    let rest = planes.into_iter().try_fold(x.clone(), |c, p| {
        halves(&c, p, thin).0.filter(|c| c.vertices.iter().any(|&v| height(p, v) < -thin))
    })?;
    Some(rest.vertices.iter().sum::<DVec3>() / rest.vertices.len() as f64)
}

fn deepest(points: Vec<DVec3>, b: &Shape, tolerance: f64) -> Option<Depth> {
    let core = b.bounds.loosened(0.0);
    let inside = points.into_iter().filter(|&p| core.contains_local_point(p));
    let deep = inside.filter(|&p| !is_near(b, p, tolerance)).filter(|&p| winding(b, p) > 0.5);
    let measured = deep.map(|p| Depth { at: p, depth: distance(b, p) });
    measured.filter(|d| d.depth > tolerance).reduce(|x, y| if y.depth > x.depth { y } else { x })
}

/// Middles of the stretches into which the faces of b cut the edges of a.
fn edge_middles<'a>(a: &'a Shape, b: &'a Shape, tolerance: f64) -> impl Iterator<Item = DVec3> + 'a {
    a.edges().flat_map(move |(p, q)| {
        let bounds = around([p, q].into_iter());
        let mut cuts = vec![0.0, 1.0];
        if bounds.intersects(&b.bounds) {
            let near = b.faces_near(&bounds, tolerance);
            cuts.extend(near.into_iter().filter_map(|f| pierced(b, f, p, q)));
        } else {
            cuts.clear();
        }
        cuts.sort_by(f64::total_cmp);
        cuts.windows(2).map(|w| p.lerp(q, (w[0] + w[1]) / 2.0)).collect::<Vec<_>>()
    })
}

fn facet_middles(a: &Shape) -> impl Iterator<Item = DVec3> + '_ {
    (0..a.faces.len()).map(|f| a.ring(f).sum::<DVec3>() / a.faces[f].corners.len() as f64)
}

/// Points under faces that lie flush the same way, at doubling depths.
fn under_flush(a: &Shape, b: &Shape, tolerance: f64) -> Vec<DVec3> {
    let size = a.bounds.extents().max_element();
    let ladder =
        || std::iter::successors(Some(2.0 * tolerance), |s| Some(2.0 * s)).take_while(move |&s| s < size);
    let flush = regions(a, b, Facing::Alike, tolerance);
    let below = flush.iter().flat_map(|r| {
        let middle = r.corners.iter().sum::<DVec3>() / r.corners.len() as f64;
        ladder().map(move |s| middle - s * r.normal)
    });
    below.filter(|&p| !is_near(a, p, tolerance) && winding(a, p) > 0.5).collect()
}

/// Where on the segment (0 to 1) facet f is pierced.
fn pierced(s: &Shape, f: usize, p: DVec3, q: DVec3) -> Option<f64> {
    let n = s.faces[f].normal;
    let o = s.at(s.faces[f].corners[0]);
    let (h, k) = ((p - o).dot(n), (q - o).dot(n));
    if h.signum() == k.signum() || h == k {
        return None;
    }
    let x = p.lerp(q, h / (h - k));
    let ring: Vec<DVec3> = s.ring(f).collect();
    let left = |i: usize| {
        let (c, d) = (ring[i], ring[(i + 1) % ring.len()]);
        (d - c).cross(x - c).dot(n) >= 0.0
    };
    (0..ring.len()).all(left).then(|| h / (h - k))
}

/// How often the surface winds round p: 1 inside, 0 outside; whole numbers away from the surface.
pub(super) fn winding(s: &Shape, p: DVec3) -> f64 {
    let angle: f64 = s.triangles().map(|[a, b, c]| solid_angle(a - p, b - p, c - p)).sum();
    angle / (4.0 * std::f64::consts::PI)
}

fn is_near(s: &Shape, p: DVec3, reach: f64) -> bool {
    s.faces_near(&around(std::iter::once(p)), reach).into_iter().any(|f| face_distance(s, f, p) <= reach)
}

fn distance(s: &Shape, p: DVec3) -> f64 {
    (0..s.faces.len()).map(|f| face_distance(s, f, p)).fold(f64::INFINITY, f64::min)
}

/// Distance from p to a convex planar facet.
pub(super) fn face_distance(s: &Shape, f: usize, p: DVec3) -> f64 {
    let n = s.faces[f].normal;
    let ring: Vec<DVec3> = s.ring(f).collect();
    let edge = |i: usize| (ring[i], ring[(i + 1) % ring.len()]);
    if (0..ring.len()).all(|i| (edge(i).1 - edge(i).0).cross(p - edge(i).0).dot(n) >= 0.0) {
        return (p - ring[0]).dot(n).abs();
    }
    (0..ring.len()).map(|i| segment_distance(edge(i).0, edge(i).1, p)).fold(f64::INFINITY, f64::min)
}

pub(super) fn segment_distance(a: DVec3, b: DVec3, p: DVec3) -> f64 {
    let e = b - a;
    let t = if e == DVec3::ZERO { 0.0 } else { ((p - a).dot(e) / e.length_squared()).clamp(0.0, 1.0) };
    p.distance(a + t * e)
}
