//! Takes bodies in place; pushes corners apart wherever two bodies are nearer than the fit, until none are.
//!
//! The move of `body` leaves the fit between facets that share a patch. It can not know of parts that meet only in an
//! edge or a corner, of facets that come near one another across a narrow third, or of what a collapse dropped; here
//! the distances themselves say so. Not complete: it stops after a fixed number of rounds and says where bodies are still
//! nearer; the gap that is measured on the files decides.

use super::Aim;
use super::body::Body;
use super::least::HalfSpace;
use super::settle::{Settled, settle};
use crate::bvh::{Aabb, Bvh};
use crate::mesh::Mesh;
use crate::near::{Close, closer_than};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A round mends what the last one measured; what is left shrinks to second order, so few are needed. Twenty bound the
/// time where bodies can not be parted at all.
const ROUNDS: usize = 20;

/// Points nearer than this, in mm, have no direction between them that is more than round-off: ten thousand times the
/// step of f64 at a metre.
const TOUCHING: f64 = 1e-9;

/// How far one corner has to go back, and in which direction.
#[derive(Clone, Copy)]
struct Push {
    outward: DVec3,
    by: f64,
}

struct Surface {
    mesh: Mesh,
    corner_of: Vec<u32>,
    tree: Bvh,
}

/// What the parting did to a body.
#[derive(Clone, Debug, Default)]
pub struct Relief {
    /// `None` where it was left as it was.
    pub settled: Option<Settled>,
    /// A corner of each triangle that is still nearer to another body than the shares.
    pub near: Vec<DVec3>,
}

/// Parts bodies that are nearer than the sum of their shares to the sum of their depths.
pub fn relieve(bodies: &mut [Body], aims: &[Aim]) -> Vec<Relief> {
    let mut done: Vec<Relief> = vec![Relief::default(); bodies.len()];
    let mut surfaces: Vec<Surface> = bodies.par_iter().map(surface).collect();
    let mut changed = vec![true; bodies.len()];
    for round in 0..=ROUNDS {
        let pushes = all_pushes(&surfaces, &changed, aims);
        changed = pushes.iter().map(|p| !p.is_empty()).collect();
        if !changed.contains(&true) {
            break;
        }
        if round == ROUNDS {
            let corners =
                |(b, p): (&Body, &BTreeMap<u32, Push>)| p.keys().map(|&c| b.corners[c as usize].at).collect();
            done.iter_mut().zip(bodies.iter().zip(&pushes)).for_each(|(d, bp)| d.near = corners(bp));
            break;
        }
        bodies.par_iter_mut().zip(&mut surfaces).zip(&mut done).zip(&pushes).zip(aims).for_each(
            |((((b, s), d), pushes), aim)| {
                if !pushes.is_empty() {
                    d.settled = Some(apply(b, pushes, aim.thinnest, d.settled.take().unwrap_or_default()));
                    *s = surface(b);
                }
            },
        );
    }
    done
}

fn surface(body: &Body) -> Surface {
    let (mesh, corner_of) = body.mesh();
    let tree = Bvh::new(&mesh);
    Surface { mesh, corner_of, tree }
}

fn apply(body: &mut Body, pushes: &BTreeMap<u32, Push>, thinnest: f64, before: Settled) -> Settled {
    for (&c, p) in pushes {
        let offset = p.outward.dot(body.corners[c as usize].at) - p.by;
        body.push(c, HalfSpace { normal: p.outward, offset });
    }
    let now = settle(body, thinnest);
    Settled { collapses: before.collapses + now.collapses, unsettled: now.unsettled }
}

/// For each body, the farthest push that each of its corners needs; pairs of which none has changed need none.
fn all_pushes(surfaces: &[Surface], changed: &[bool], aims: &[Aim]) -> Vec<BTreeMap<u32, Push>> {
    let boxes: Vec<Aabb> = surfaces.iter().map(|s| Aabb::of(s.mesh.vertices.iter().copied())).collect();
    let fit = |i: usize, j: usize| aims[i].share + aims[j].share;
    let near = |i: usize, j: usize| {
        (changed[i] || changed[j]) && boxes[i].distance_squared(&boxes[j]) < fit(i, j).powi(2)
    };
    let pairs: Vec<(usize, usize)> =
        (0..surfaces.len()).flat_map(|j| (0..j).filter(move |&i| near(i, j)).map(move |i| (i, j))).collect();
    let close: Vec<Vec<Close>> = pairs
        .par_iter()
        .map(|&(i, j)| {
            let [a, b] = [i, j].map(|k| (&surfaces[k].mesh, &surfaces[k].tree));
            closer_than(a, b, fit(i, j))
        })
        .collect();
    let mut pushes = vec![BTreeMap::new(); surfaces.len()];
    for (&(i, j), close) in pairs.iter().zip(&close) {
        for c in close {
            let lack = (aims[i].depth + aims[j].depth - c.near.distance) / 2.0;
            let Some(towards_b) = direction(&surfaces[i], &surfaces[j], c) else { continue };
            share(
                &surfaces[i],
                c.triangles.0,
                c.near.a,
                Push { outward: towards_b, by: lack },
                &mut pushes[i],
            );
            share(
                &surfaces[j],
                c.triangles.1,
                c.near.b,
                Push { outward: -towards_b, by: lack },
                &mut pushes[j],
            );
        }
    }
    pushes
}

/// From `a` to `b`: between the nearest points, or where these touch, the way that the two triangles face.
fn direction(a: &Surface, b: &Surface, c: &Close) -> Option<DVec3> {
    let facing = |s: &Surface, t: u32| {
        let [p, q, r] = s.mesh.corners(t as usize);
        (q - p).cross(r - p).normalize_or_zero()
    };
    let way = if c.near.distance > TOUCHING {
        c.near.b - c.near.a
    } else {
        facing(a, c.triangles.0) - facing(b, c.triangles.1)
    };
    way.try_normalize()
}

/// Spreads a push at a point of a triangle over its corners, so that the point goes back by just that much.
fn share(s: &Surface, triangle: u32, at: DVec3, push: Push, pushes: &mut BTreeMap<u32, Push>) {
    let weights = weights(s.mesh.corners(triangle as usize), at);
    let square = weights.length_squared();
    for (k, &v) in s.mesh.triangles[triangle as usize].iter().enumerate() {
        let by = push.by * weights[k] / square;
        let old = pushes.get(&s.corner_of[v as usize]).map_or(0.0, |p| p.by);
        if by > old {
            pushes.insert(s.corner_of[v as usize], Push { outward: push.outward, by });
        }
    }
}

/// Barycentric weights of a point of a triangle, none negative, sum 1.
fn weights([a, b, c]: [DVec3; 3], x: DVec3) -> DVec3 {
    let n = (b - a).cross(c - a);
    let part = |p: DVec3, q: DVec3| ((p - x).cross(q - x).dot(n)).max(0.0);
    let w = DVec3::new(part(b, c), part(c, a), part(a, b));
    let sum = w.element_sum();
    if sum > 0.0 { w / sum } else { DVec3::splat(1.0 / 3.0) }
}
