//! Takes facets, gives each the unit normal of the flat face that it is part of.
//!
//! A face is grown from its largest facet over shared edges while every corner stays on its plane as well as
//! the file knows it; so thin triangles take the normal of their face, which is known far better than their
//! own. Not promised: that a smooth surface, cut finer than the file's resolution, keeps every facet's own
//! normal.

use super::close::{area_vector, edges, slack};
use glam::DVec3;
use std::collections::BTreeMap;

/// Unit normals parallel to `facets`. `width` as in [`slack`], `tolerance` the user's, both in model units.
pub(super) fn normals(facets: &[Vec<u32>], points: &[DVec3], width: f64, tolerance: f64) -> Vec<DVec3> {
    let areas: Vec<DVec3> = facets.iter().map(|f| area_vector(f, points)).collect();
    let beside = neighbors(facets);
    let mut order: Vec<usize> = (0..facets.len()).collect();
    order.sort_by(|&a, &b| areas[b].length_squared().total_cmp(&areas[a].length_squared()).then(a.cmp(&b)));
    let mut normals = vec![DVec3::ZERO; facets.len()];
    let mut taken = vec![false; facets.len()];
    for seed in order {
        if taken[seed] {
            continue;
        }
        let plane = Plane::through(&facets[seed], points, areas[seed], width, tolerance);
        let face = grow(seed, &beside, &mut taken, |k| {
            plane.holds(&facets[k], points) && areas[k].dot(plane.n) >= 0.0
        });
        let n = face.iter().map(|&k| areas[k]).sum::<DVec3>().normalize();
        face.iter().for_each(|&k| normals[k] = n);
    }
    normals
}

/// The plane of a seed facet and how far off it may be.
struct Plane {
    o: DVec3,
    n: DVec3,
    width: f64,
    height: f64,
    tolerance: f64,
}

impl Plane {
    fn through(facet: &[u32], points: &[DVec3], area: DVec3, width: f64, tolerance: f64) -> Plane {
        let at = |i: u32| points[i as usize];
        let o = facet.iter().map(|&i| at(i)).sum::<DVec3>() / facet.len() as f64;
        let longest = edges(facet).map(|(a, b)| at(a).distance(at(b))).fold(0.0, f64::max);
        Plane { o, n: area.normalize(), width, height: area.length() / longest, tolerance }
    }

    /// Corners off by `width` tilt a facet of height h by up to 2 `width` / h: what that makes at distance d
    /// is allowed, as far as the tolerance goes.
    fn holds(&self, facet: &[u32], points: &[DVec3]) -> bool {
        facet.iter().all(|&i| {
            let r = points[i as usize] - self.o;
            r.dot(self.n).abs() <= (self.width * (1.0 + 2.0 * r.length() / self.height)).min(self.tolerance)
        })
    }
}

fn grow(seed: usize, beside: &[Vec<usize>], taken: &mut [bool], fits: impl Fn(usize) -> bool) -> Vec<usize> {
    taken[seed] = true;
    let mut face = vec![seed];
    let mut next = 0;
    while next < face.len() {
        for &k in &beside[face[next]] {
            if !taken[k] && fits(k) {
                taken[k] = true;
                face.push(k);
            }
        }
        next += 1;
    }
    face
}

/// For each facet those that share an edge with it.
pub(crate) fn neighbors(facets: &[Vec<u32>]) -> Vec<Vec<usize>> {
    let mut at: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for (k, f) in facets.iter().enumerate() {
        edges(f).for_each(|(a, b)| at.entry((a.min(b), a.max(b))).or_default().push(k));
    }
    let beside = |(k, f): (usize, &Vec<u32>)| {
        let all = edges(f).flat_map(|(a, b)| at[&(a.min(b), a.max(b))].iter().copied());
        all.filter(|&j| j != k).collect()
    };
    facets.iter().enumerate().map(beside).collect()
}

/// The width within which corners lie on their face, in model units: the file's own resolution, never above
/// the tolerance.
pub(super) fn width(resolution: f64, tolerance: f64) -> f64 {
    slack(resolution).min(tolerance)
}
