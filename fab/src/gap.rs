//! Takes part meshes as they were read back, each computed back to its finished size, and the promised fits; gives the
//! least gap of each pair, and whether it keeps the promise.
//!
//! Independent of how the clearance was made, and of the routes: it looks at triangles alone. Exact up to round-off for
//! parts that do not cross; parts that cross or enclose one another are told as that.

use crate::bvh::{Aabb, Bvh};
use crate::cross;
use crate::mesh::Mesh;
use crate::near::nearest;
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;

/// How far the least gap of neighbours may be from the promised fit, relative.
pub const FIT_TOLERANCE: f64 = 0.01;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The promised fit, within tolerance.
    Kept,
    /// Less than promised.
    Short,
    /// Neighbours that come nowhere as near as promised.
    Wide,
    /// The parts cross, or one is inside the other.
    Crossing,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Relation {
    /// They share a contact facet.
    Neighbours,
    /// They only come near each other, as in a common edge or corner.
    Near,
}

/// The least gap between two parts, at finished size.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Gap {
    pub a: String,
    pub b: String,
    pub relation: Relation,
    pub promised_mm: f64,
    pub least_mm: f64,
    /// Where: a point on `a` and a point on `b`, mm, in place.
    pub at: [DVec3; 2],
    pub verdict: Verdict,
}

/// A part's mesh at finished size, with its tree.
pub struct Made {
    pub id: String,
    pub mesh: Mesh,
    pub tree: Bvh,
}

/// What gaps are held against.
pub struct Promise<'a> {
    /// Of each part, for each face, mm, in the finished assembly; a fit is the sum of two.
    pub clearances: &'a [f64],
    /// How far writing in f32 can change a distance, mm.
    pub round_off: f64,
    /// Pairs that share a contact facet, ascending.
    pub neighbours: &'a [(usize, usize)],
}

impl Promise<'_> {
    fn fit(&self, (i, j): (usize, usize)) -> f64 {
        self.clearances[i] + self.clearances[j]
    }
}

/// Gaps of all neighbours, and of all other pairs that come nearer than the fit would allow by their boxes.
pub fn gaps(made: &[Option<Made>], promise: &Promise) -> Vec<Gap> {
    let boxes: Vec<Aabb> =
        made.iter().map(|m| Aabb::of(m.iter().flat_map(|m| m.mesh.vertices.iter().copied()))).collect();
    let wanted = |i: usize, j: usize| {
        promise.neighbours.binary_search(&(i, j)).is_ok()
            || boxes[i].distance_squared(&boxes[j]) < promise.fit((i, j)).powi(2)
    };
    let pairs: Vec<(usize, usize)> = (0..made.len())
        .flat_map(|i| (i + 1..made.len()).map(move |j| (i, j)))
        .filter(|&(i, j)| wanted(i, j))
        .collect();
    pairs
        .par_iter()
        .filter_map(|&(i, j)| Some(gap(made[i].as_ref()?, made[j].as_ref()?, (i, j), promise)))
        .collect()
}

fn gap(a: &Made, b: &Made, pair: (usize, usize), promise: &Promise) -> Gap {
    let relation =
        if promise.neighbours.binary_search(&pair).is_ok() { Relation::Neighbours } else { Relation::Near };
    let crossing = cross::between((&a.mesh, &a.tree), (&b.mesh, &b.tree)).first().map(|c| c.at);
    let inside = || {
        let corner = |m: &Made| m.mesh.vertices.first().copied();
        corner(b)
            .filter(|p| cross::encloses(&a.mesh, *p))
            .or(corner(a).filter(|p| cross::encloses(&b.mesh, *p)))
    };
    let (least_mm, at) = match crossing.or_else(inside) {
        Some(p) => (0.0, [p, p]),
        None => {
            let near = nearest((&a.mesh, &a.tree), (&b.mesh, &b.tree));
            (near.distance, [near.a, near.b])
        }
    };
    let verdict = if crossing.is_some() || least_mm == 0.0 {
        Verdict::Crossing
    } else {
        judge(least_mm, relation, promise.fit(pair), promise.round_off)
    };
    let promised_mm = promise.fit(pair);
    Gap { a: a.id.clone(), b: b.id.clone(), relation, promised_mm, least_mm, at, verdict }
}

fn judge(least: f64, relation: Relation, fit: f64, round_off: f64) -> Verdict {
    let above = (fit * FIT_TOLERANCE).max(round_off);
    if least < fit {
        Verdict::Short
    } else if relation == Relation::Neighbours && least > fit + above {
        Verdict::Wide
    } else {
        Verdict::Kept
    }
}
