//! Takes two meshes; gives the least distance between their surfaces and the two points that have it.
//!
//! Never under-states: the distance is that of two points on the surfaces. Exact up to round-off where the surfaces do
//! not cross; crossing surfaces are told by `cross`, and here give a distance near 0 only where an edge is near.

use crate::bvh::{Bvh, Node};
use crate::mesh::Mesh;
use glam::DVec3;

/// Two points, one on each surface, and their distance in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    pub distance: f64,
    pub a: DVec3,
    pub b: DVec3,
}

const FAR: Near = Near { distance: f64::INFINITY, a: DVec3::NAN, b: DVec3::NAN };

/// The nearest points of two meshes; infinitely far where one is empty.
pub fn nearest(a: (&Mesh, &Bvh), b: (&Mesh, &Bvh)) -> Near {
    let mut best = FAR;
    if !a.1.nodes.is_empty() && !b.1.nodes.is_empty() {
        descend(a, b, 0, 0, &mut best);
    }
    best
}

/// Two triangles, one of each mesh, and their nearest points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Close {
    pub triangles: (u32, u32),
    pub near: Near,
}

/// All pairs of triangles nearer than `limit` mm, by index.
pub fn closer_than(a: (&Mesh, &Bvh), b: (&Mesh, &Bvh), limit: f64) -> Vec<Close> {
    let mut found = Vec::new();
    let mut todo = if a.1.nodes.is_empty() || b.1.nodes.is_empty() { vec![] } else { vec![(0, 0)] };
    while let Some((i, j)) = todo.pop() {
        if a.1.boxes[i].distance_squared(&b.1.boxes[j]).sqrt() >= limit {
            continue;
        }
        match leaves_or_children(a.1, b.1, i, j) {
            Err(children) => todo.extend(children),
            Ok((s, t)) => each_pair(a.0, b.0, s, t, limit, |triangles, near| {
                found.push(Close { triangles, near });
                limit
            }),
        }
    }
    found.sort_by_key(|c| c.triangles);
    found
}

fn descend(a: (&Mesh, &Bvh), b: (&Mesh, &Bvh), i: usize, j: usize, best: &mut Near) {
    let apart = |i: usize, j: usize| a.1.boxes[i].distance_squared(&b.1.boxes[j]).sqrt();
    if apart(i, j) >= best.distance {
        return;
    }
    match leaves_or_children(a.1, b.1, i, j) {
        Ok((s, t)) => each_pair(a.0, b.0, s, t, best.distance, |_, near| {
            *best = near;
            near.distance
        }),
        Err(mut children) => {
            children.sort_by(|x, y| apart(x.0, x.1).total_cmp(&apart(y.0, y.1)).then(x.cmp(y)));
            children.into_iter().for_each(|(i, j)| descend(a, b, i, j, best));
        }
    }
}

/// The triangles of two leaves, or the pairs of nodes below.
type Below<'a> = Result<(&'a [u32], &'a [u32]), Vec<(usize, usize)>>;

fn leaves_or_children<'a>(a: &'a Bvh, b: &'a Bvh, i: usize, j: usize) -> Below<'a> {
    match (a.nodes[i], b.nodes[j]) {
        (Node::Leaf { first, count }, Node::Leaf { first: f, count: c }) => {
            Ok((a.leaf(first, count), b.leaf(f, c)))
        }
        (Node::Branch { left, right }, Node::Leaf { .. }) => Err(vec![(left, j), (right, j)]),
        (Node::Leaf { .. }, Node::Branch { left, right }) => Err(vec![(i, left), (i, right)]),
        (Node::Branch { left, right }, Node::Branch { left: l, right: r }) => {
            Err(vec![(left, l), (left, r), (right, l), (right, r)])
        }
    }
}

/// Calls `f` with each pair of triangles nearer than `limit`; `f` gives the limit for the next.
fn each_pair(
    a: &Mesh,
    b: &Mesh,
    of_a: &[u32],
    of_b: &[u32],
    mut limit: f64,
    mut f: impl FnMut((u32, u32), Near) -> f64,
) {
    for &s in of_a {
        let p = a.corners(s as usize);
        for &t in of_b {
            let q = b.corners(t as usize);
            if apart_by_plane(p, q, limit) || apart_by_plane(q, p, limit) {
                continue;
            }
            let near = triangles(p, q);
            if near.distance < limit {
                limit = f((s, t), near);
            }
        }
    }
}

/// Whether `q` lies on one side of the plane of `p`, at least `limit` away: the usual case for parted surfaces.
fn apart_by_plane([a, b, c]: [DVec3; 3], q: [DVec3; 3], limit: f64) -> bool {
    let n = (b - a).cross(c - a);
    let far = limit * n.length();
    let heights = q.map(|x| n.dot(x - a));
    far > 0.0 && (heights.iter().all(|h| *h >= far) || heights.iter().all(|h| *h <= -far))
}

/// Nearest points of two triangles that do not cross: at a corner of one or on an edge of each.
pub fn triangles(p: [DVec3; 3], q: [DVec3; 3]) -> Near {
    let mut best = FAR;
    let mut offer = |a: DVec3, b: DVec3| {
        let distance = a.distance(b);
        if distance < best.distance {
            best = Near { distance, a, b };
        }
    };
    for k in 0..3 {
        offer(p[k], on_triangle(p[k], q));
        offer(on_triangle(q[k], p), q[k]);
        for l in 0..3 {
            let (a, b) = segments([p[k], p[(k + 1) % 3]], [q[l], q[(l + 1) % 3]]);
            offer(a, b);
        }
    }
    best
}

/// The point of a triangle nearest to `x`: the foot on its plane where that is inside, else on an edge.
pub fn on_triangle(x: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let n = (b - a).cross(c - a);
    let inside = |p: DVec3, q: DVec3| (q - p).cross(x - p).dot(n) >= 0.0;
    if n != DVec3::ZERO && inside(a, b) && inside(b, c) && inside(c, a) {
        return x - n * ((x - a).dot(n) / n.length_squared());
    }
    let feet = [[a, b], [b, c], [c, a]].map(|s| on_segment(x, s));
    feet.into_iter().min_by(|p, q| p.distance_squared(x).total_cmp(&q.distance_squared(x))).unwrap_or(a)
}

fn on_segment(x: DVec3, [a, b]: [DVec3; 2]) -> DVec3 {
    let d = b - a;
    let t = if d == DVec3::ZERO { 0.0 } else { ((x - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) };
    a + d * t
}

/// Nearest points of two segments: the free minimum where both its feet are inside, else from an end.
fn segments(s: [DVec3; 2], t: [DVec3; 2]) -> (DVec3, DVec3) {
    let (u, v, w) = (s[1] - s[0], t[1] - t[0], s[0] - t[0]);
    let n = u.cross(v);
    if n.length_squared() > 0.0 {
        let at = w.cross(v).dot(n) / -n.length_squared();
        let bt = w.cross(u).dot(n) / -n.length_squared();
        if (0.0..=1.0).contains(&at) && (0.0..=1.0).contains(&bt) {
            return (s[0] + u * at, t[0] + v * bt);
        }
    }
    let ends = [
        (s[0], on_segment(s[0], t)),
        (s[1], on_segment(s[1], t)),
        (on_segment(t[0], s), t[0]),
        (on_segment(t[1], s), t[1]),
    ];
    let by_distance = |x: &(DVec3, DVec3), y: &(DVec3, DVec3)| {
        x.0.distance_squared(x.1).total_cmp(&y.0.distance_squared(y.1))
    };
    ends.into_iter().min_by(by_distance).unwrap_or((s[0], t[0]))
}
