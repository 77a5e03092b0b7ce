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
use glam::{DAffine3, DVec3};
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

/// A part in its place; its body is that of its group.
pub struct Standing {
    pub group: usize,
    pub pose: DAffine3,
    pub aim: Aim,
}

/// What the parting did to a body.
#[derive(Clone, Debug, Default)]
pub struct Relief {
    /// `None` where it was left as it was.
    pub settled: Option<Settled>,
    /// A corner of each triangle that is still nearer to another body than the shares, in the body's own frame.
    pub near: Vec<DVec3>,
}

/// Parts bodies that are nearer than the sum of their shares to the sum of their depths. Each body, by its group, lies in
/// the frame of its shape, and stands wherever a part of the group does: what one of them has to give way by, the body gives
/// way by, and so all of them.
pub fn relieve(bodies: &mut BTreeMap<usize, Body>, parts: &[Standing]) -> BTreeMap<usize, Relief> {
    let mut done: BTreeMap<usize, Relief> = bodies.keys().map(|g| (*g, Relief::default())).collect();
    let stands = |bodies: &BTreeMap<usize, Body>, p: &Standing| surface(&bodies[&p.group].posed(&p.pose));
    let mut surfaces: Vec<Surface> = parts.par_iter().map(|p| stands(bodies, p)).collect();
    let mut changed = vec![true; parts.len()];
    for round in 0..=ROUNDS {
        let pushes = of_bodies(&all_pushes(&surfaces, &changed, parts), parts);
        if pushes.is_empty() {
            break;
        }
        if round == ROUNDS {
            for (g, pushes) in &pushes {
                let near = pushes.keys().map(|&c| bodies[g].corners[c as usize].at).collect();
                done.entry(*g).or_default().near = near;
            }
            break;
        }
        changed = parts.iter().map(|p| pushes.contains_key(&p.group)).collect();
        let thinnest: BTreeMap<usize, f64> = parts.iter().map(|p| (p.group, p.aim.thinnest)).collect();
        let moved: Vec<(usize, Settled)> = bodies
            .par_iter_mut()
            .filter_map(|(g, body)| {
                let before = done[g].settled.clone().unwrap_or_default();
                Some((*g, apply(body, pushes.get(g)?, thinnest[g], before)))
            })
            .collect();
        moved.into_iter().for_each(|(g, settled)| done.entry(g).or_default().settled = Some(settled));
        let again: Vec<usize> = (0..parts.len()).filter(|&p| changed[p]).collect();
        let moved: Vec<Surface> = again.par_iter().map(|&p| stands(bodies, &parts[p])).collect();
        again.into_iter().zip(moved).for_each(|(p, s)| surfaces[p] = s);
    }
    done
}

/// For each body, the farthest push of each corner among its parts, in its own frame.
fn of_bodies(pushes: &[BTreeMap<u32, Push>], parts: &[Standing]) -> BTreeMap<usize, BTreeMap<u32, Push>> {
    let mut all: BTreeMap<usize, BTreeMap<u32, Push>> = BTreeMap::new();
    for (pushes, part) in pushes.iter().zip(parts) {
        let back = part.pose.matrix3.transpose();
        for (&corner, push) in pushes {
            keep(
                all.entry(part.group).or_default(),
                corner,
                Push { outward: back * push.outward, by: push.by },
            );
        }
    }
    all
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
fn all_pushes(surfaces: &[Surface], changed: &[bool], parts: &[Standing]) -> Vec<BTreeMap<u32, Push>> {
    let boxes: Vec<Aabb> = surfaces.iter().map(|s| Aabb::of(s.mesh.vertices.iter().copied())).collect();
    let fit = |i: usize, j: usize| parts[i].aim.share + parts[j].aim.share;
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
            let lack = (parts[i].aim.depth + parts[j].aim.depth - c.near.distance) / 2.0;
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
        keep(pushes, s.corner_of[v as usize], Push { outward: push.outward, by });
    }
}

/// The farther push of a corner; the first of equals.
fn keep(pushes: &mut BTreeMap<u32, Push>, corner: u32, push: Push) {
    if push.by > pushes.get(&corner).map_or(0.0, |p| p.by) {
        pushes.insert(corner, push);
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
