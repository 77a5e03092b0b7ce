//! Takes a mesh, or two; gives a pair of triangles that cross, and where.
//!
//! Exact for the coordinates it is given (adaptive predicates); touching counts as crossing. Not promised: which pair
//! is found first means anything, beyond being the same for the same mesh.

use crate::bvh::{Aabb, Bvh, Node};
use crate::mesh::Mesh;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Two triangles that cross or touch without sharing that point as a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    pub triangles: (u32, u32),
    pub at: DVec3,
}

/// Pairs of triangles in each other's boxes that are looked at: a hundred for each triangle of a mesh of a million. A fan
/// of 14,000 triangles around one corner has as many.
const MOST_PAIRS: usize = 100_000_000;

/// Pairs that are looked at together, on all threads.
const BATCH: usize = 1 << 20;

/// So many triangles stand in each other's boxes that they are not looked through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "over {MOST_PAIRS} pairs of its triangles are so near each other that they were not looked through for crossings"
)]
pub struct Crowded;

/// Triangles of one mesh that cross one another.
pub fn within(mesh: &Mesh, tree: &Bvh) -> Result<Vec<Crossing>, Crowded> {
    let boxes: Vec<Aabb> = (0..mesh.triangles.len()).map(|t| Aabb::of(mesh.corners(t))).collect();
    let at = |s: u32| mesh.corners(s as usize).iter().sum::<DVec3>() / 3.0;
    let crossed =
        |&(s, t): &(u32, u32)| cross_in_mesh(mesh, s, t).then(|| Crossing { triangles: (s, t), at: at(s) });
    let (mut found, mut batch, mut seen) = (Vec::new(), Vec::with_capacity(BATCH), 0);
    let mut todo = if tree.nodes.is_empty() { vec![] } else { vec![(0, 0)] };
    while let Some((i, j)) = todo.pop() {
        below(tree, (i, j), &mut todo, |s, t| {
            if boxes[s as usize].distance_squared(&boxes[t as usize]) == 0.0 {
                batch.push((s.min(t), s.max(t)));
            }
        });
        if batch.len() >= BATCH || todo.is_empty() {
            seen += batch.len();
            if seen > MOST_PAIRS {
                return Err(Crowded);
            }
            found.par_extend(batch.par_iter().filter_map(crossed));
            batch.clear();
        }
    }
    found.sort_by_key(|c| c.triangles);
    Ok(found)
}

/// One step of a walk over pairs of triangles whose nodes' boxes meet, each pair once.
fn below(tree: &Bvh, (i, j): (usize, usize), todo: &mut Vec<(usize, usize)>, mut f: impl FnMut(u32, u32)) {
    if i != j && tree.boxes[i].distance_squared(&tree.boxes[j]) > 0.0 {
        return;
    }
    let Some((own, other)) = tree.open((i, j), todo) else { return };
    for (k, &s) in own.iter().enumerate() {
        let rest = if i == j { &own[k + 1..] } else { other };
        rest.iter().for_each(|&t| f(s, t));
    }
}

/// Triangles of `a` that cross or touch triangles of `b`.
pub fn between(a: (&Mesh, &Bvh), b: (&Mesh, &Bvh)) -> Vec<Crossing> {
    let mut found = Vec::new();
    pairs(a, b, &mut |s, t| {
        if disjoint_ids_cross(a.0.corners(s as usize), b.0.corners(t as usize)) {
            let at = a.0.corners(s as usize).iter().sum::<DVec3>() / 3.0;
            found.push(Crossing { triangles: (s, t), at });
        }
    });
    found.sort_by_key(|c| c.triangles);
    found
}

/// Whether `p` is inside the closed mesh, by its winding number.
pub fn encloses(mesh: &Mesh, p: DVec3) -> bool {
    let solid_angle = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(|v| v - p);
        let (x, y, z) = (a.length(), b.length(), c.length());
        let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    let turns = (0..mesh.triangles.len()).map(solid_angle).sum::<f64>() / (4.0 * std::f64::consts::PI);
    turns.abs() > 0.5
}

pub(crate) fn pairs(a: (&Mesh, &Bvh), b: (&Mesh, &Bvh), f: &mut impl FnMut(u32, u32)) {
    let mut todo = if a.1.nodes.is_empty() || b.1.nodes.is_empty() { vec![] } else { vec![(0, 0)] };
    while let Some((i, j)) = todo.pop() {
        if a.1.boxes[i].distance_squared(&b.1.boxes[j]) > 0.0 {
            continue;
        }
        match (a.1.nodes[i], b.1.nodes[j]) {
            (Node::Branch { left, right }, _) => todo.extend([(left, j), (right, j)]),
            (_, Node::Branch { left, right }) => todo.extend([(i, left), (i, right)]),
            (Node::Leaf { first, count }, Node::Leaf { first: g, count: m }) => {
                for &s in a.1.leaf(first, count) {
                    b.1.leaf(g, m).iter().for_each(|&t| f(s, t));
                }
            }
        }
    }
}

fn cross_in_mesh(mesh: &Mesh, s: u32, t: u32) -> bool {
    let (p, q) = (mesh.triangles[s as usize], mesh.triangles[t as usize]);
    let at = |v: u32| mesh.vertices[v as usize];
    if p.iter().all(|v| !q.contains(v)) {
        return disjoint_ids_cross(p.map(at), q.map(at));
    }
    let shared: Vec<u32> = p.iter().copied().filter(|v| q.contains(v)).collect();
    let rest = |t: [u32; 3]| t.into_iter().filter(|v| !shared.contains(v)).map(at).collect::<Vec<_>>();
    match shared[..] {
        [v] => fans_cross(at(v), &rest(p), &rest(q)),
        [u, v] => folded(at(u), at(v), rest(p)[0], rest(q)[0]),
        _ => true,
    }
}

fn disjoint_ids_cross(p: [DVec3; 3], q: [DVec3; 3]) -> bool {
    // Most pairs are far from each other's planes, or beside each other in one: both are seen without exact arithmetic.
    if one_side(p, q) || one_side(q, p) || !meet_flat(p, q) {
        return false;
    }
    let sides = |t: [DVec3; 3], of: [DVec3; 3]| of.map(|x| side(t[0], t[1], t[2], x));
    let clear = |s: [f64; 3]| s == [1.0; 3] || s == [-1.0; 3];
    let of_p = sides(q, p);
    if clear(of_p) {
        return false;
    }
    let of_q = sides(p, q);
    if clear(of_q) {
        return false;
    }
    if of_p == [0.0; 3] && of_q == [0.0; 3] {
        return true;
    }
    let edge = |t: [DVec3; 3], s: [f64; 3], k: usize| ([t[k], t[(k + 1) % 3]], (s[k], s[(k + 1) % 3]));
    let meets = |(e, s), t| edge_meets(e, s, t);
    (0..3).any(|k| meets(edge(p, of_p, k), q) || meets(edge(q, of_q, k), p))
}

/// Whether all of `other` is on one side of the plane of `t` beyond round-off: at most eight roundings of 2^-53 in each of six
/// products of a coordinate of each of three edges, 48, which 64 bound with those of the bound itself.
fn one_side(t: [DVec3; 3], other: [DVec3; 3]) -> bool {
    let (u, v) = (t[1] - t[0], t[2] - t[0]);
    let (normal, off) = (u.cross(v), 64.0 / 9_007_199_254_740_992.0 * largest(u) * largest(v));
    let beyond = |x: DVec3| {
        let (side, slack) = (normal.dot(x - t[0]), off * largest(x - t[0]));
        i32::from(side > slack) - i32::from(side < -slack)
    };
    other.map(beyond).iter().sum::<i32>().abs() == 3
}

fn largest(v: DVec3) -> f64 {
    v.abs().max_element()
}

/// Whether closed triangles meet in projection along an axis in which they have area: else an edge of one has the other
/// strictly beyond it, and they do not meet in space either. One without area counts as meeting what only a line square to it
/// would part from it.
fn meet_flat(p: [DVec3; 3], q: [DVec3; 3]) -> bool {
    !parted(flattest(p, q), &p, &q)
}

/// Whether an edge of one of two segments or triangles has the other strictly beyond it, in projection along an axis.
fn parted(drop: usize, p: &[DVec3], q: &[DVec3]) -> bool {
    let beyond = |t: &[DVec3], other: &[DVec3], k: usize| {
        let (a, b) = (t[k], t[(k + 1) % t.len()]);
        let own = if t.len() > 2 { side2(drop, a, b, t[(k + 2) % t.len()]) } else { 0.0 };
        let first = side2(drop, a, b, other[0]);
        first != 0.0 && first != own && other[1..].iter().all(|x| side2(drop, a, b, *x) == first)
    };
    (0..p.len()).any(|k| beyond(p, q, k)) || (0..q.len()).any(|k| beyond(q, p, k))
}

/// The axis along which the larger of two triangles may be flattened without becoming a line.
fn flattest(p: [DVec3; 3], q: [DVec3; 3]) -> usize {
    let normal = |t: [DVec3; 3]| (t[1] - t[0]).cross(t[2] - t[0]).abs();
    let (n, m) = (normal(p), normal(q));
    if n.max_element() >= m.max_element() { n } else { m }.max_position()
}

/// Triangles that share a vertex cross when the far edge of one meets the other, or one lies in the other.
fn fans_cross(v: DVec3, p: &[DVec3], q: &[DVec3]) -> bool {
    let (s, t) = ([v, p[0], p[1]], [v, q[0], q[1]]);
    let drop = flattest(s, t);
    let meets = |far: &[DVec3], other: [DVec3; 3]| {
        !parted(drop, far, &other) && segment_meets([far[0], far[1]], other)
    };
    meets(p, t) || meets(q, s)
}

/// Triangles on both sides of an edge overlap when they are coplanar and on the same side of it.
fn folded(u: DVec3, v: DVec3, a: DVec3, b: DVec3) -> bool {
    side(u, v, a, b) == 0.0 && {
        let drop = dominant(u, v, a);
        side2(drop, u, v, a) * side2(drop, u, v, b) > 0.0
    }
}

/// Whether a closed segment meets a closed triangle.
fn segment_meets([p, q]: [DVec3; 2], t: [DVec3; 3]) -> bool {
    let [a, b, c] = t;
    edge_meets([p, q], (side(a, b, c, p), side(a, b, c, q)), t)
}

/// The same where it is known on which sides of the triangle's plane the ends are.
fn edge_meets([p, q]: [DVec3; 2], (sp, sq): (f64, f64), t: [DVec3; 3]) -> bool {
    let [a, b, c] = t;
    if sp == 0.0 && sq == 0.0 {
        return segment_meets_flat([p, q], t);
    }
    if sp * sq > 0.0 {
        return false;
    }
    let around = [side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)];
    around.iter().all(|s| *s >= 0.0) || around.iter().all(|s| *s <= 0.0)
}

/// The same in the triangle's own plane.
fn segment_meets_flat([p, q]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let drop = dominant(a, b, c);
    let inside = |x: DVec3| {
        let s = [side2(drop, a, b, x), side2(drop, b, c, x), side2(drop, c, a, x)];
        s.iter().all(|s| *s >= 0.0) || s.iter().all(|s| *s <= 0.0)
    };
    inside(p)
        || inside(q)
        || [[a, b], [b, c], [c, a]].iter().any(|&[x, y]| segments_meet_flat(drop, [p, q], [x, y]))
}

fn segments_meet_flat(drop: usize, [p, q]: [DVec3; 2], [x, y]: [DVec3; 2]) -> bool {
    let apart = |a: f64, b: f64| a * b > 0.0;
    let (px, py) = (side2(drop, p, q, x), side2(drop, p, q, y));
    let (xp, xq) = (side2(drop, x, y, p), side2(drop, x, y, q));
    if px == 0.0 && py == 0.0 {
        let (lo, hi) = (p.min(q), p.max(q));
        let (lo2, hi2) = (x.min(y), x.max(y));
        return (0..3).filter(|&k| k != drop).all(|k| lo[k] <= hi2[k] && lo2[k] <= hi[k]);
    }
    !apart(px, py) && !apart(xp, xq)
}

/// Sign of the volume of `a b c d`: which side of the plane `a b c` has `d`. Exact sign.
fn side(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(|v| Coord3D { x: v.x, y: v.y, z: v.z });
    orient3d(a, b, c, d).signum_or_zero()
}

fn side2(drop: usize, a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let [a, b, c] = [a, b, c].map(|v| flat(drop, v)).map(|v| Coord { x: v.x, y: v.y });
    orient2d(a, b, c).signum_or_zero()
}

fn flat(drop: usize, v: DVec3) -> DVec2 {
    match drop {
        0 => DVec2::new(v.y, v.z),
        1 => DVec2::new(v.z, v.x),
        _ => DVec2::new(v.x, v.y),
    }
}

/// The axis along which the triangle may be flattened without becoming a line.
fn dominant(a: DVec3, b: DVec3, c: DVec3) -> usize {
    (b - a).cross(c - a).abs().max_position()
}

trait SignumOrZero {
    fn signum_or_zero(self) -> f64;
}

impl SignumOrZero for f64 {
    /// -1, 0 or 1, so that products of signs can not underflow.
    fn signum_or_zero(self) -> f64 {
        if self == 0.0 { 0.0 } else { self.signum() }
    }
}
