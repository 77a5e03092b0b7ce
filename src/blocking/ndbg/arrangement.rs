//! Takes critical arcs and points on the sphere of directions; gives the arrangement: vertices, edges and faces, each
//! with a direction inside.
//!
//! No direction is sampled: vertices are ends and crossings of arcs, those nearer to one another than the resolution are one;
//! edges run between neighbors on a circle; faces are the loops around edges. Euler's formula is checked, and where it
//! fails (arcs that cross too near one another to be told apart) there is no arrangement. Cost: the square of the
//! circles, and of the edges.

use super::circles::{Circle, Circles, Points, Spans};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{PI, TAU};

/// Arcs of each circle that has some, and points of their own.
#[derive(Clone, Debug, Default)]
pub struct Critical {
    pub arcs: BTreeMap<Circle, Vec<Piece>>,
    /// Circles that count all around.
    pub whole: BTreeSet<Circle>,
    pub points: Vec<DVec3>,
}

/// Angles on a circle, `start` in [0, 2 pi), `end` at most a turn after it.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    pub start: f64,
    pub end: f64,
}

impl Piece {
    /// The shorter way between two directions on a circle.
    pub fn between(circles: &Circles, c: Circle, p: DVec3, q: DVec3) -> Piece {
        let (a, b) = (circles.angle(c, p), circles.angle(c, q));
        let (start, way) = if (b - a).rem_euclid(TAU) <= PI { (a, b - a) } else { (b, a - b) };
        Piece { start, end: start + way.rem_euclid(TAU) }
    }

    /// Its mirror image in the origin.
    fn opposite(self) -> Piece {
        let start = (self.start + PI).rem_euclid(TAU);
        Piece { start, end: start + self.end - self.start }
    }
}

impl Critical {
    /// What is critical one way is critical the other way.
    pub fn with_opposites(mut self) -> Critical {
        let points: Vec<DVec3> = self.points.iter().map(|&p| -p).collect();
        self.points.extend(points);
        for arcs in self.arcs.values_mut() {
            let opposite: Vec<Piece> = arcs.iter().map(|a| a.opposite()).collect();
            arcs.extend(opposite);
        }
        self
    }

    pub fn join(&mut self, other: Critical) {
        self.points.extend(other.points);
        self.whole.extend(other.whole);
        for (c, arcs) in other.arcs {
            self.arcs.entry(c).or_default().extend(arcs);
        }
    }
}

/// An edge from vertex to vertex, counter-clockwise about its circle's normal; `to` may equal `from`.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    pub circle: Circle,
    pub from: usize,
    pub to: usize,
    /// Angles on the circle; `end > start`.
    pub start: f64,
    pub end: f64,
    /// Arcs of other circles run nearer to it than the resolution and are one with it.
    pub shared: bool,
    /// Numbers of the faces on the left (toward the normal) and on the right.
    pub left: usize,
    pub right: usize,
}

#[derive(Clone, Debug)]
pub struct Face {
    pub d: DVec3,
    /// Edges around it, in order, each with whether it is run through forward; the face lies on their left.
    pub rim: Vec<(usize, bool)>,
}

#[derive(Clone, Debug)]
pub struct Arrangement {
    pub vertices: Vec<DVec3>,
    pub edges: Vec<Arc>,
    pub faces: Vec<Face>,
    /// Edges that end at each vertex.
    pub around: Vec<Vec<usize>>,
    /// The widest angle between two critical directions that were counted as one, radians: any resolution from here up
    /// to the one taken gives this same arrangement.
    pub merged: f64,
}

/// Why there is none.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoArrangement {
    #[error("more than {most} crossings of critical arcs")]
    TooMany { most: usize },
    #[error(
        "critical directions lie too near one another to be told apart (Euler's formula misses by {miss})"
    )]
    TooNear { miss: i64 },
}

/// Crossings beyond this are not made: cells and their graphs would no longer fit into memory.
pub const MOST_VERTICES: usize = 60_000;

/// The arrangement of the arcs and the equator; every separate piece gets a whole circle through it, so that all are
/// joined and each face has one rim. (What such a circle adds separates nothing and is merged away later.)
pub fn arrangement(circles: &mut Circles, mut critical: Critical) -> Result<Arrangement, NoArrangement> {
    critical.whole.insert(circles.number(DVec3::Z));
    loop {
        let net = Net::new(circles, &critical)?;
        let loose = net.one_vertex_of_each_other_piece();
        if loose.is_empty() {
            return net.faces(circles);
        }
        for d in loose {
            let circle = circles.number(d.any_orthonormal_vector());
            critical.whole.insert(circle);
        }
    }
}

/// Vertices and edges.
struct Net {
    vertices: Vec<DVec3>,
    spans: BTreeMap<Circle, Spans>,
    edges: Vec<Arc>,
    around: Vec<Vec<usize>>,
    merged: f64,
}

impl Net {
    fn new(circles: &Circles, critical: &Critical) -> Result<Net, NoArrangement> {
        let near = circles.resolution().near();
        let mut spans: BTreeMap<Circle, Spans> = BTreeMap::new();
        for (&c, arcs) in &critical.arcs {
            spans.insert(c, Spans::of(arcs.iter().map(|a| (a.start, a.end)), near));
        }
        spans.extend(critical.whole.iter().map(|&c| (c, Spans::full())));
        let points = vertices(circles, critical, &spans)?;
        let (vertices, merged) = (points.all().to_vec(), points.widest().max(circles.widest()));
        let around = vec![Vec::new(); vertices.len()];
        let mut net = Net { vertices, spans, edges: Vec::new(), around, merged };
        net.lay_edges(circles);
        Ok(net)
    }

    fn lay_edges(&mut self, circles: &Circles) {
        let near = circles.resolution().near();
        let on_circle = |(&c, spans): (&Circle, &Spans)| -> (Vec<Arc>, f64) {
            let n = circles.normal(c);
            let on = self.vertices.iter().enumerate().filter(|(_, v)| n.dot(**v).abs() <= near);
            let mut at: Vec<(f64, usize)> = on.map(|(k, &v)| (circles.angle(c, v), k)).collect();
            at.retain(|&(angle, _)| spans.holds(angle, near));
            let off = at.iter().map(|&(_, k)| n.dot(self.vertices[k]).abs()).fold(0.0, f64::max);
            at.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
            let next = |k: usize| if k + 1 < at.len() { at[k + 1] } else { (at[0].0 + TAU, at[0].1) };
            let arc = |k: usize| {
                let ((start, from), (end, to)) = (at[k], next(k));
                Arc { circle: c, from, to, start, end, shared: false, left: 0, right: 0 }
            };
            let inside = |a: &Arc| spans.holds(((a.start + a.end) / 2.0).rem_euclid(TAU), 0.0);
            ((0..at.len()).map(arc).filter(inside).collect(), off)
        };
        let all: Vec<_> = self.spans.iter().collect();
        let (found, off): (Vec<Vec<Arc>>, Vec<f64>) = all.into_par_iter().map(on_circle).unzip();
        let (edges, apart) = without_twins(circles, found.concat());
        self.edges = edges;
        self.merged = off.into_iter().chain([self.merged, apart]).fold(0.0, f64::max);
        for (k, e) in self.edges.iter().enumerate() {
            self.around[e.from].push(k);
            if e.to != e.from {
                self.around[e.to].push(k);
            }
        }
    }

    /// A vertex for each connected piece but the first.
    fn one_vertex_of_each_other_piece(&self) -> Vec<DVec3> {
        let mut seen = vec![false; self.vertices.len()];
        let mut first = Vec::new();
        for v in 0..self.vertices.len() {
            if seen[v] {
                continue;
            }
            first.push(self.vertices[v]);
            let mut open = vec![v];
            seen[v] = true;
            while let Some(v) = open.pop() {
                for e in self.around[v].iter().map(|&e| &self.edges[e]) {
                    open.extend(
                        [e.from, e.to].into_iter().filter(|&w| !std::mem::replace(&mut seen[w], true)),
                    );
                }
            }
        }
        first.split_off(1.min(first.len()))
    }

    /// Walks around every face; half edge 2k runs along edge k, 2k + 1 against it.
    fn faces(mut self, circles: &Circles) -> Result<Arrangement, NoArrangement> {
        let next = self.next_around(circles);
        let mut face_of = vec![usize::MAX; next.len()];
        let mut rims: Vec<Vec<(usize, bool)>> = Vec::new();
        for start in 0..next.len() {
            if face_of[start] != usize::MAX {
                continue;
            }
            let (mut h, mut rim) = (start, Vec::new());
            while face_of[h] == usize::MAX {
                face_of[h] = rims.len();
                rim.push((h / 2, h % 2 == 0));
                h = next[h];
            }
            rims.push(rim);
        }
        let miss = self.vertices.len() as i64 - self.edges.len() as i64 + rims.len() as i64 - 2;
        if miss != 0 {
            return Err(NoArrangement::TooNear { miss });
        }
        for (k, e) in self.edges.iter_mut().enumerate() {
            (e.left, e.right) = (face_of[2 * k], face_of[2 * k + 1]);
        }
        let faces = rims.into_par_iter().map(|rim| Face { d: self.inside(circles, &rim), rim }).collect();
        let (vertices, edges, around) = (self.vertices, self.edges, self.around);
        Ok(Arrangement { vertices, edges, faces, around, merged: self.merged })
    }

    /// The half edge that follows each one around the face on its left: at its end, the next clockwise from its own way
    /// back.
    fn next_around(&self, circles: &Circles) -> Vec<usize> {
        let mut out: Vec<Vec<(f64, usize)>> = vec![Vec::new(); self.vertices.len()];
        for (k, e) in self.edges.iter().enumerate() {
            let n = circles.normal(e.circle);
            let middle = circles.at(e.circle, (e.start + e.end) / 2.0);
            for (v, half, sign) in [(e.from, 2 * k, 1.0), (e.to, 2 * k + 1, -1.0)] {
                let at = self.vertices[v];
                let (x, y) = at.any_orthonormal_pair();
                // A vertex may lie beside the circle by as much as short edges are long: look at where the edge goes.
                let way = if e.end - e.start < 1.0 { middle - at } else { n.cross(at) * sign };
                out[v].push((way.dot(y).atan2(way.dot(x)), half));
            }
        }
        let mut next = vec![0; 2 * self.edges.len()];
        for leaving in &mut out {
            leaving.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for (k, &(_, half)) in leaving.iter().enumerate() {
                let clockwise = leaving[(k + leaving.len() - 1) % leaving.len()].1;
                next[half ^ 1] = clockwise;
            }
        }
        next
    }

    /// A direction inside the face: from the middle of its longest edge, half the way to the next arc across.
    fn inside(&self, circles: &Circles, rim: &[(usize, bool)]) -> DVec3 {
        let near = circles.resolution().near();
        let length = |e: usize| self.edges[e].end - self.edges[e].start;
        let widest =
            rim.iter().copied().max_by(|x, y| length(x.0).total_cmp(&length(y.0)).then(y.0.cmp(&x.0)));
        let Some((e, forward)) = widest else { return DVec3::Z };
        let e = &self.edges[e];
        let m = circles.at(e.circle, (e.start + e.end) / 2.0);
        let n = circles.normal(e.circle) * if forward { 1.0 } else { -1.0 };
        let hit = |(&c, spans): (&Circle, &Spans)| {
            let k = circles.normal(c);
            let t = (-k.dot(m)).atan2(k.dot(n)).rem_euclid(PI);
            let d = m * t.cos() + n * t.sin();
            spans.holds(circles.angle(c, d), near).then_some(t)
        };
        let others = self.spans.iter().filter(|(c, _)| **c != e.circle);
        // Its own circle comes again after half a turn.
        let t = others.filter_map(hit).filter(|&t| t > 0.0).fold(PI, f64::min) / 2.0;
        (m * t.cos() + n * t.sin()).normalize()
    }
}

/// Arcs between the same vertices whose middles lie within twice the resolution are one: what is left of snapping vertices. And how far
/// apart such twins are at most.
fn without_twins(circles: &Circles, all: Vec<Arc>) -> (Vec<Arc>, f64) {
    let near = circles.resolution().near();
    let mut widest: f64 = 0.0;
    let mut by_ends: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    let mut kept: Vec<Arc> = Vec::new();
    for arc in all {
        let middle = |a: &Arc| circles.at(a.circle, (a.start + a.end) / 2.0);
        let beside = by_ends.entry((arc.from.min(arc.to), arc.from.max(arc.to))).or_default();
        let apart = |k: usize| middle(&kept[k]).distance(middle(&arc));
        match beside.iter().copied().find(|&k| apart(k) <= 2.0 * near) {
            Some(k) => {
                widest = widest.max(apart(k));
                kept[k].shared = true;
            }
            None => {
                beside.push(kept.len());
                kept.push(arc);
            }
        }
    }
    (kept, widest)
}

/// Points, ends of arcs, and crossings that lie on arcs of both circles.
fn vertices(
    circles: &Circles,
    critical: &Critical,
    spans: &BTreeMap<Circle, Spans>,
) -> Result<Points, NoArrangement> {
    let mut points = Points::new(circles.resolution().near());
    let ends =
        critical.arcs.iter().flat_map(|(&c, arcs)| arcs.iter().flat_map(move |a| [(c, a.start), (c, a.end)]));
    let ends = ends.map(|(c, angle)| circles.at(c, angle));
    ends.chain(critical.points.iter().copied()).for_each(|p| points.add(p));
    // A circle without an end or a crossing still needs a vertex.
    critical.whole.iter().for_each(|&c| points.add(circles.at(c, 0.0)));
    let used: Vec<(Circle, &Spans)> = spans.iter().map(|(&c, s)| (c, s)).collect();
    for (k, &(c, on_c)) in used.iter().enumerate() {
        let with = used[k + 1..].iter().flat_map(|&(e, on_e)| crossings(circles, (c, on_c), (e, on_e)));
        with.for_each(|v| points.add(v));
        if points.all().len() > MOST_VERTICES {
            return Err(NoArrangement::TooMany { most: MOST_VERTICES });
        }
    }
    Ok(points)
}

fn crossings(circles: &Circles, c: (Circle, &Spans), e: (Circle, &Spans)) -> Vec<DVec3> {
    let Some(v) = circles.normal(c.0).cross(circles.normal(e.0)).try_normalize() else { return Vec::new() };
    let near = circles.resolution().near();
    let on = |d: DVec3| [c, e].iter().all(|&(k, spans)| spans.holds(circles.angle(k, d), near));
    [v, -v].into_iter().filter(|&d| on(d)).collect()
}
