//! Takes facets, tells where an edge of the surface pierces a facet of the same shell.
//!
//! Sound: what is reported crosses by more than `width`. Not complete: a crossing shallower than that, or one
//! along facets that only touch, is not seen. Shells that reach into each other are not reported: their union
//! is one part.

use super::close::{area_vector, edges};
use super::shells::components;
use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};

/// The edges that pierce a facet of their own shell, with a facet that each pierces.
pub(super) fn crossings(facets: &[Vec<u32>], points: &[DVec3], width: f64) -> Vec<((u32, u32), usize)> {
    let at = |i: &u32| points[*i as usize];
    let boxes: Vec<Aabb> = facets.iter().map(|f| bounds(f.iter().map(at))).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let shell = components(facets);
    let mut found = Vec::new();
    for (k, facet) in facets.iter().enumerate() {
        for (a, b) in edges(facet).filter(|(a, b)| a < b) {
            let (p, q) = (points[a as usize], points[b as usize]);
            let around = bounds([p, q].into_iter());
            let near = tree.intersect_aabb(&around).map(|f| f as usize).filter(|&f| shell[f] == shell[k]);
            let pierced = near.filter(|&f| pierces(p, q, &facets[f], points, width)).min();
            found.extend(pierced.map(|f| ((a, b), f)));
        }
    }
    found
}

fn bounds(points: impl Iterator<Item = DVec3>) -> Aabb {
    let (lo, hi) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    Aabb::new(lo, hi)
}

/// Whether the segment goes through the facet, farther than `width` from its rim, and where it enters and leaves the
/// room above and below the facet stands farther than `width` from its plane: what its own corners, off by so much,
/// could not undo. The facet's own plane, not its face's: that misses the corners that a neighbor shares with it.
fn pierces(p: DVec3, q: DVec3, facet: &[u32], points: &[DVec3], width: f64) -> bool {
    let at = |i: u32| points[i as usize];
    let (o, n) = (at(facet[0]), area_vector(facet, points).normalize_or_zero());
    let (h, g) = ((p - o).dot(n), (q - o).dot(n));
    if h.abs() <= width || g.abs() <= width || h.signum() == g.signum() {
        return false;
    }
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    let through = h / (h - g);
    for (a, b) in edges(facet) {
        let inward = n.cross(at(b) - at(a)).normalize_or_zero();
        let (s, e) = ((p - at(a)).dot(inward), (q - at(a)).dot(inward));
        if s + through * (e - s) <= width {
            return false;
        }
        if e > s {
            from = from.max(-s / (e - s));
        } else if e < s {
            to = to.min(s / (s - e));
        }
    }
    let height = |t: f64| (h + t * (g - h)).abs();
    height(from) > width && height(to) > width
}
