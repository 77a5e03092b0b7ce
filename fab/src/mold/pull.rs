//! Takes a part; gives pull directions for a mold in two halves, best first: least undercut area, then least depth.
//!
//! Looked at: normals of the largest facets, their cross products (where the great circles of directions that lie in a
//! facet meet: there the set of facets seen changes), the axes, and a spread of the sphere; the best are then varied. An
//! undercut of 0 is proven by `shadow` for the direction given; that no direction between those looked at has less is
//! not.

use crate::bvh::Bvh;
use crate::files::stl;
use crate::mesh::{Mesh, area};
use crate::mold::frame::upright;
use crate::mold::ray;
use crate::mold::shadow::{self, Blocked, Side};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// A direction with what it leaves.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Unit; its opposite is as good.
    pub direction: DVec3,
    /// Area that neither half reaches straight, mm2; 0 where it is round-off.
    pub undercut: f64,
    /// The same in steps of `SAME_UNDERCUT`, by which directions are compared.
    pub level: u64,
    /// Extent along the direction, mm.
    pub depth: f64,
}

/// What came of the search.
#[derive(Clone, Debug)]
pub struct Search {
    /// Measured exactly, best first; never empty for a part with facets.
    pub best: Vec<Candidate>,
    pub looked_at: usize,
}

/// Distinct facet normals that make candidates, largest area first.
const NORMALS: usize = 24;

/// Directions spread over the half sphere: about 11 degrees apart.
const SPREAD: usize = 160;

/// Points on the surface at which candidates are first compared.
const SAMPLES: usize = 256;

/// Triangles that the exact comparison of the best candidates may go through in all.
const EXACT_TRIANGLES: usize = 60_000;

/// How often, and how wide, the best direction is varied where it leaves an undercut: from 6 degrees down to 0.1.
const ROUNDS: usize = 6;
const FIRST_TILT: f64 = 0.1;

/// Normals nearer to each other than this, or to opposite, are one candidate: a tenth of a degree.
const SAME_DIRECTION: f64 = 1.75e-3;

/// Undercuts that differ by less than this share of the surface count as the same: the share of its volume by which a
/// cavity may be off.
const SAME_UNDERCUT: f64 = 1e-4;

pub fn search(part: &Mesh) -> Search {
    let (tree, samples) = (Bvh::new(part), spread_over(part, SAMPLES));
    let mut looked_at = candidates(part);
    let rough = |d: &DVec3| (hidden(part, &tree, &samples, *d), depth(part, *d), *d);
    let mut rated: Vec<(usize, f64, DVec3)> = looked_at.par_iter().map(rough).collect();
    rated.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    if rated.first().is_some_and(|r| r.0 > 0) {
        for round in 0..ROUNDS {
            let tilted = tilted(rated[0].2, FIRST_TILT / f64::from(1 << round));
            rated.extend(tilted.par_iter().map(rough).collect::<Vec<_>>());
            rated.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
            looked_at.extend(tilted);
        }
    }
    let finalists = (EXACT_TRIANGLES / part.triangles.len().max(1)).clamp(4, 24);
    let mut best: Vec<Candidate> = rated.par_iter().take(finalists).map(|r| measured(part, r.2)).collect();
    best.sort_by(|a, b| a.level.cmp(&b.level).then(a.depth.total_cmp(&b.depth)));
    Search { best, looked_at: looked_at.len() }
}

/// The exact undercut of a direction.
pub fn measured(part: &Mesh, direction: DVec3) -> Candidate {
    let turned = part.map(|v| upright(direction) * v);
    let snap = snap_of(part);
    let blocked = undercut(&turned, snap);
    let undercut = if blocked.is_real() { real_area(&turned, &blocked).iter().sum() } else { 0.0 };
    let level = (undercut / (part.area() * SAME_UNDERCUT)) as u64;
    Candidate { direction, undercut, level, depth: depth(part, direction) }
}

/// How far f32 may move a corner of the part once its middle is at the origin, mm.
pub fn snap_of(part: &Mesh) -> f64 {
    let (lo, hi) = part.bounds();
    stl::snap_distance((hi - lo).max_element())
}

/// Where the part shadows itself along z: facets that look up below facets that look down.
pub fn undercut(turned: &Mesh, snap: f64) -> Blocked {
    shadow::blocked(&Side::of(turned, 1.0), &Side::of(turned, -1.0), snap)
}

/// Undercut area of each facet, mm2 on the facet itself, at most its area.
pub fn real_area(turned: &Mesh, blocked: &Blocked) -> Vec<f64> {
    let mut hidden = vec![0.0; turned.triangles.len()];
    for o in &blocked.overlaps {
        for t in [o.lower, o.upper] {
            hidden[t as usize] += o.area / slope(turned, t).max(f64::MIN_POSITIVE);
        }
    }
    let cap = |(t, a): (usize, f64)| a.min(area(turned.corners(t)));
    hidden.into_iter().enumerate().map(cap).collect()
}

/// Projected area of a facet over its own.
fn slope(mesh: &Mesh, t: u32) -> f64 {
    let c = mesh.corners(t as usize);
    (c[1] - c[0]).cross(c[2] - c[0]).normalize_or_zero().z.abs()
}

fn depth(part: &Mesh, d: DVec3) -> f64 {
    let along = part.vertices.iter().map(|v| v.dot(d));
    let (lo, hi) = along.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
    hi - lo
}

/// Points spread over the surface by area, with their normals; the same for the same mesh.
pub fn spread_over(part: &Mesh, count: usize) -> Vec<(DVec3, DVec3)> {
    let areas: Vec<f64> = (0..part.triangles.len()).map(|t| area(part.corners(t))).collect();
    let step = areas.iter().sum::<f64>() / count as f64;
    let (mut found, mut passed) = (Vec::with_capacity(count), 0.0);
    for (t, a) in areas.iter().enumerate() {
        passed += a;
        while found.len() < count && (found.len() as f64 + 0.5) * step < passed {
            found.push(within(part.corners(t), found.len()));
        }
    }
    found
}

/// A point of a triangle, by the plastic-number sequence, and the normal.
fn within([a, b, c]: [DVec3; 3], k: usize) -> (DVec3, DVec3) {
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let (mut u, mut v) = ((k as f64 / PLASTIC).fract(), (k as f64 / (PLASTIC * PLASTIC)).fract());
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    (a + (b - a) * u + (c - a) * v, (b - a).cross(c - a).normalize_or_zero())
}

/// Samples that see neither end of a direction. Those on walls along it are judged by both ends.
fn hidden(part: &Mesh, tree: &Bvh, samples: &[(DVec3, DVec3)], d: DVec3) -> usize {
    let (lo, hi) = part.bounds();
    let off = (hi - lo).length() * OFF_SURFACE;
    let seen = |p: DVec3, d: DVec3| !ray::any((part, tree), p, d, 0.0);
    let hidden = |&&(p, n): &&(DVec3, DVec3)| {
        let (cos, p) = (n.dot(d), p + n * off);
        match cos {
            c if c > LEVEL => !seen(p, d),
            c if c < -LEVEL => !seen(p, -d),
            _ => !seen(p, d) && !seen(p, -d),
        }
    };
    samples.iter().filter(hidden).count()
}

/// Rays start this share of the part's size off the surface, so that they do not meet the facet they start from.
const OFF_SURFACE: f64 = 1e-7;

/// A normal within this sine of square to the pull is a wall along it.
const LEVEL: f64 = 1e-6;

/// Directions worth looking at, each for both of its ends.
pub fn candidates(part: &Mesh) -> Vec<DVec3> {
    let normals = large_normals(part);
    let mut all = DVec3::AXES.to_vec();
    all.extend(&normals);
    for (k, a) in normals.iter().enumerate() {
        all.extend(normals[k + 1..].iter().filter_map(|b| a.cross(*b).try_normalize()));
    }
    all.extend(spread());
    distinct(all)
}

/// Distinct normals, up to sign, by the area that has them, largest first.
pub fn large_normals(part: &Mesh) -> Vec<DVec3> {
    let mut normals: Vec<(DVec3, f64)> = Vec::new();
    let mut facets: Vec<(f64, DVec3)> = (0..part.triangles.len())
        .map(|t| part.corners(t))
        .map(|c| (area(c), (c[1] - c[0]).cross(c[2] - c[0]).normalize_or_zero()))
        .filter(|f| f.1 != DVec3::ZERO)
        .collect();
    facets.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (area, n) in facets {
        match normals.iter().position(|(m, _)| same(*m, n)) {
            Some(k) => normals[k].1 += area,
            None if normals.len() < 8 * NORMALS => normals.push((n, area)),
            None => {}
        }
    }
    normals.sort_by(|a, b| b.1.total_cmp(&a.1));
    normals.into_iter().take(NORMALS).map(|n| n.0).collect()
}

fn same(a: DVec3, b: DVec3) -> bool {
    a.cross(b).length() < SAME_DIRECTION
}

/// Points of a spiral over the half sphere.
fn spread() -> impl Iterator<Item = DVec3> {
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    (0..SPREAD).map(move |k| {
        let z = 1.0 - (k as f64 + 0.5) / SPREAD as f64;
        let (sin, cos) = (golden * k as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * cos, r * sin, z)
    })
}

fn distinct(all: Vec<DVec3>) -> Vec<DVec3> {
    let mut kept: Vec<DVec3> = Vec::new();
    for d in all {
        if !kept.iter().any(|k| same(*k, d)) {
            kept.push(d);
        }
    }
    kept
}

fn tilted(d: DVec3, by: f64) -> Vec<DVec3> {
    let frame: DMat3 = upright(d).transpose();
    let around = |k: u32| {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 8.0).sin_cos();
        (d + (frame.x_axis * cos + frame.y_axis * sin) * by).normalize()
    };
    (0..8).map(around).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::{Solid, cuboid, frustum};

    fn drilled() -> Mesh {
        let block = Solid::of(&cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 50.0))).unwrap();
        let drill = Solid::of(&frustum(DVec3::new(20.0, 15.0, -1.0), 52.0, 5.0, 5.0)).unwrap();
        block.minus(&drill).mesh()
    }

    #[test]
    fn a_drilled_block_is_pulled_along_its_hole_though_that_is_its_longest_way() {
        let best = &search(&drilled()).best[0];
        assert_eq!((best.undercut, best.direction.abs()), (0.0, DVec3::Z));
    }

    #[test]
    fn across_the_hole_its_wall_is_the_undercut() {
        let side = measured(&drilled(), DVec3::X);
        let wall = std::f64::consts::TAU * 5.0 * 50.0;
        assert!((side.undercut - wall).abs() < wall * 0.01, "{} {wall}", side.undercut);
    }

    #[test]
    fn a_plate_is_pulled_through_its_least_extent() {
        let best = &search(&cuboid(DVec3::ZERO, DVec3::new(40.0, 5.0, 60.0))).best[0];
        assert_eq!((best.undercut, best.depth), (0.0, 5.0));
    }
}
