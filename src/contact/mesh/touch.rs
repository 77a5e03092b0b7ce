//! Takes two shapes and the faces on which they lie flat, gives the contacts that are smaller than a face:
//! edges along faces and grooves, vertices, crossing edges.
//!
//! A row is given where first-order motion must obey it: a point of one part against a flat or reflex place
//! of the other (its free space is convex there: one row for each face), or two convex corners with one
//! separating plane. All else gets no row and is listed. Not promised: at a saddle that a given patch
//! touches, nothing more is said.

use super::cone::{Separation, separation};
use super::flush::Flush;
use super::local::{Form, Local, locate};
use super::overlap::segment_distance;
use super::polygon;
use super::shape::{Shape, around};
use glam::{DVec2, DVec3};
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use std::collections::BTreeMap;

/// A contact of one corner or two, with its unit normal from the first shape to the second.
#[derive(Clone, Debug)]
pub(super) struct Touch {
    pub normal: DVec3,
    pub corners: Vec<DVec3>,
    /// By how much the normal may be off, in radians.
    pub known: f64,
}

/// Why a contact got no row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// Many planes separate the two convex corners (parallel edges, two vertices, a vertex on an edge).
    ManyNormals,
    /// No plane separates them within round-off, although they reach into each other by less than the
    /// tolerance.
    NoNormal,
    /// One of them is a saddle, or a place where the part touches itself.
    Saddle,
    /// More faces meet there than are looked at.
    ManyFaces,
}

/// A contact that got no row: one point, or the two ends of a stretch.
#[derive(Clone, Debug)]
pub(super) struct Passed {
    pub corners: Vec<DVec3>,
    pub why: Why,
    /// The admissible normals are combinations of these; none where they are not known.
    pub normals: Vec<DVec3>,
}

impl Passed {
    fn alike(&self, other: &Passed) -> bool {
        self.why == other.why && self.normals == other.normals
    }
}

#[derive(Default)]
pub(super) struct Touches {
    pub rows: Vec<Touch>,
    pub passed: Vec<Passed>,
}

/// All contacts smaller than a face that the given faces do not say already.
pub(super) fn touches(a: &Shape, b: &Shape, faces: &[Flush], tolerance: f64) -> Touches {
    let mut all = Touches::default();
    let given = Given::new(faces, 2.0 * tolerance);
    let places = along_faces(a, b, tolerance)
        .into_iter()
        .chain(along_faces(b, a, tolerance).into_iter().map(Place::turned))
        .chain(edge_pairs(a, b, tolerance, Pairing::Along))
        .chain(vertices(a, b, tolerance))
        .chain(vertices(b, a, tolerance).into_iter().map(Place::turned))
        .chain(edge_pairs(a, b, tolerance, Pairing::Across));
    for place in places {
        add(&mut all, &place, &given);
    }
    all
}

/// Where the shapes touch, and what each looks like there.
struct Place<'a> {
    corners: Vec<DVec3>,
    a: &'a Local,
    b: &'a Local,
}

impl Place<'_> {
    fn turned(self) -> Self {
        Place { a: self.b, b: self.a, ..self }
    }
}

/// The faces on which the shapes lie flat, with a search tree over them.
struct Given<'a> {
    faces: &'a [Flush],
    tree: Bvh,
    /// How near is there, in model units.
    reach: f64,
}

impl Given<'_> {
    fn new(faces: &[Flush], reach: f64) -> Given<'_> {
        let boxes: Vec<Aabb> =
            faces.iter().map(|f| around(f.corners.iter().copied()).loosened(reach)).collect();
        Given { faces, tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes), reach }
    }

    /// The faces on which p stands.
    fn at(&self, p: DVec3) -> impl Iterator<Item = &Flush> {
        let point = around(std::iter::once(p));
        let near = self.tree.intersect_aabb(&point).map(|k| &self.faces[k as usize]).collect::<Vec<_>>();
        near.into_iter().filter(move |f| on_polygon(f, p, self.reach))
    }
}

fn add(all: &mut Touches, place: &Place, given: &Given) {
    let reach = given.reach;
    let covered = |on: &dyn Fn(DVec3) -> bool| place.corners.iter().all(|&p| on(p));
    let by_face = covered(&|p| given.at(p).next().is_some());
    let by_row = covered(&|p| all.rows.iter().any(|t| on_stretch(&t.corners, p, reach)));
    match verdict(place) {
        // Two convex corners on a common face are kept apart by it: their one plane is the face's own.
        Ok(_) if by_face && place.a.form == Form::Convex && place.b.form == Form::Convex => {}
        Ok(normals) => {
            let says = |n: DVec3, p: DVec3| known(all, given, n, p);
            let new = normals.into_iter().filter(|&(n, _)| !covered(&|p| says(n, p)));
            let touch = |(normal, known)| Touch { normal, known, corners: place.corners.clone() };
            let new: Vec<Touch> = new.map(touch).collect();
            all.rows.extend(new);
        }
        Err(_) if by_face || by_row => {}
        Err((why, normals)) => {
            let listed = |q: &Passed| covered(&|p| on_stretch(&q.corners, p, reach));
            if !all.passed.iter().any(listed) {
                let corners = place.corners.clone();
                list(&mut all.passed, Passed { corners, why, normals }, reach);
            }
        }
    }
}

/// Adds to the list; a stretch that goes on where another one ends makes that one longer.
fn list(passed: &mut Vec<Passed>, new: Passed, reach: f64) {
    let longer =
        passed.iter().position(|q| q.alike(&new) && continued(&q.corners, &new.corners, reach).is_some());
    match longer.and_then(|k| continued(&passed[k].corners, &new.corners, reach).map(|c| (k, c))) {
        Some((k, corners)) => {
            passed.remove(k);
            list(passed, Passed { corners, ..new }, reach);
        }
        None => passed.push(new),
    }
}

/// The stretch over both, if they share an end and lie on one line within `reach`.
fn continued(p: &[DVec3], q: &[DVec3], reach: f64) -> Option<Vec<DVec3>> {
    let ([a, b], [c, d]) = (p, q) else { return None };
    let shared = |x: &DVec3, y: &DVec3| x.distance(*y) <= reach;
    let (start, middle, end) = [(a, b, c, d), (a, b, d, c), (b, a, c, d), (b, a, d, c)]
        .into_iter()
        .find_map(|(s, m, n, e)| shared(m, n).then_some((*s, *m, *e)))?;
    let straight = segment_distance(start, end, middle) <= reach && (middle - start).dot(end - middle) > 0.0;
    straight.then(|| vec![start, end])
}

/// Whether a row with this normal is there at p already. A face's normal is the mean of two that differ by
/// its tilt.
fn known(all: &Touches, given: &Given, n: DVec3, p: DVec3) -> bool {
    given.at(p).any(|f| angle(f.normal, n) <= f.tilt + SAME)
        || all.rows.iter().any(|t| on_stretch(&t.corners, p, given.reach) && angle(t.normal, n) <= SAME)
}

/// Rows whose normals differ by less (radians) say the same: round-off of unit normals.
const SAME: f64 = 1e-9;

fn angle(m: DVec3, n: DVec3) -> f64 {
    m.cross(n).length().atan2(m.dot(n))
}

/// The normals, from the first to the second, of the rows that hold at a place, and how well they are known.
fn verdict(place: &Place) -> Result<Vec<(DVec3, f64)>, (Why, Vec<DVec3>)> {
    let yields = |l: &Local| matches!(l.form, Form::Flat | Form::Reflex);
    let own = place.a.normals.iter().map(|&n| (n, place.a.known)).filter(|_| yields(place.a));
    let other = place.b.normals.iter().map(|&n| (-n, place.b.known)).filter(|_| yields(place.b));
    let rows: Vec<(DVec3, f64)> = own.chain(other).collect();
    if !rows.is_empty() {
        return Ok(rows);
    }
    if place.a.form == Form::Saddle || place.b.form == Form::Saddle {
        return Err((Why::Saddle, Vec::new()));
    }
    match separation(&place.a.normals, &place.b.normals) {
        Separation::One(n) => Ok(vec![(n, of_edges(place.a, place.b))]),
        Separation::Many(normals) => Err((Why::ManyNormals, normals)),
        Separation::None => Err((Why::NoNormal, Vec::new())),
        Separation::Undecided => Err((Why::ManyFaces, Vec::new())),
    }
}

/// How well the common perpendicular of two edges is known: each edge is the line of two faces, and errors grow with
/// the inverse of the sine between what is crossed. Corners of more faces are taken for their sharpest edge.
fn of_edges(a: &Local, b: &Local) -> f64 {
    let edge = |l: &Local| {
        let pairs =
            l.normals.iter().enumerate().flat_map(|(k, m)| l.normals[..k].iter().map(|n| m.cross(*n)));
        pairs.max_by(|x, y| x.length_squared().total_cmp(&y.length_squared())).unwrap_or(DVec3::ZERO)
    };
    let (d, e) = (edge(a), edge(b));
    let sine = d.normalize_or_zero().cross(e.normalize_or_zero()).length();
    2.0 * (a.known / d.length() + b.known / e.length()) / sine
}

fn on_polygon(f: &Flush, p: DVec3, reach: f64) -> bool {
    let (u, v) = f.normal.any_orthonormal_pair();
    let flat = |q: DVec3| DVec2::new((q - p).dot(u), (q - p).dot(v));
    let ring: Vec<DVec2> = f.corners.iter().map(|&q| flat(q)).collect();
    (f.corners[0] - p).dot(f.normal).abs() <= reach && polygon::distance(&ring, DVec2::ZERO) <= reach
}

fn on_stretch(ends: &[DVec3], p: DVec3, reach: f64) -> bool {
    segment_distance(ends[0], ends[ends.len() - 1], p) <= reach
}

/// Vertices of a on the surface of b.
fn vertices<'a>(a: &'a Shape, b: &'a Shape, tolerance: f64) -> Vec<Place<'a>> {
    let near = b.bounds;
    let all = a.features.vertices.iter().zip(&a.points).filter_map(|(l, &p)| l.as_ref().map(|l| (l, p)));
    let cornered = all.filter(|(l, _)| l.form != Form::Flat);
    let inside = cornered
        .filter(|(_, p)| (near.mins - tolerance).cmple(*p).all() && p.cmple(near.maxs + tolerance).all());
    inside
        .filter_map(|(l, p)| locate(b, p, tolerance).map(|m| Place { corners: vec![p], a: l, b: m }))
        .collect()
}

/// Stretches of edges of a that run in faces of b, joined where they meet.
fn along_faces<'a>(a: &'a Shape, b: &'a Shape, tolerance: f64) -> Vec<Place<'a>> {
    let edges = a.features.edges_near(&b.bounds, tolerance);
    edges.into_iter().flat_map(|e| along_one(a, b, e, tolerance)).collect()
}

fn along_one<'a>(a: &'a Shape, b: &'a Shape, e: usize, tolerance: f64) -> Vec<Place<'a>> {
    let edge = &a.features.edges[e];
    let [p, q] = edge.ends.map(|i| a.at(i));
    let mut by_normal: BTreeMap<[u64; 3], (usize, Vec<[f64; 2]>)> = BTreeMap::new();
    for f in b.faces_near(&around([p, q].into_iter()), tolerance) {
        let Some(span) = within_face(b, f, p, q, tolerance) else { continue };
        let middle = p.lerp(q, (span[0] + span[1]) / 2.0);
        if locate(b, middle, tolerance).is_some_and(|l| l.form == Form::Flat) {
            let key = b.faces[f].normal.to_array().map(f64::to_bits);
            by_normal.entry(key).or_insert((f, Vec::new())).1.push(span);
        }
    }
    let gap = tolerance / p.distance(q);
    let stretches = by_normal.into_values().flat_map(|(f, spans)| {
        let place = move |s: [f64; 2]| Place {
            corners: s.map(|t| p.lerp(q, t)).to_vec(),
            a: &edge.local,
            b: &b.faces[f].local,
        };
        joined(spans, gap).into_iter().map(place)
    });
    stretches.collect()
}

/// Spans closer than `gap` made one.
fn joined(mut spans: Vec<[f64; 2]>, gap: f64) -> Vec<[f64; 2]> {
    spans.sort_by(|x, y| x[0].total_cmp(&y[0]));
    spans.into_iter().fold(Vec::new(), |mut out: Vec<[f64; 2]>, s| {
        match out.last_mut() {
            Some(last) if s[0] - last[1] <= gap => last[1] = last[1].max(s[1]),
            _ => out.push(s),
        }
        out
    })
}

/// The span of the segment over facet f, if it is longer than twice the tolerance and stays within it of the
/// plane. The whole segment must run along the plane as well as that, or the facet's length of it: a short
/// stretch over a corner of the facet would pass at any slope.
fn within_face(s: &Shape, f: usize, p: DVec3, q: DVec3, tolerance: f64) -> Option<[f64; 2]> {
    let n = s.faces[f].normal;
    let ring: Vec<DVec3> = s.ring(f).collect();
    let side = |k: usize, x: DVec3| n.cross(ring[(k + 1) % ring.len()] - ring[k]).dot(x - ring[k]);
    let span = (0..ring.len()).try_fold([0.0, 1.0], |span, k| cut(span, side(k, p), side(k, q)))?;
    let off = span.map(|t| (p.lerp(q, t) - ring[0]).dot(n).abs());
    let length = p.distance(q);
    let slope = (q - p).dot(n).abs() / length;
    let flat = off[0] <= tolerance && off[1] <= tolerance && slope * length.min(s.longest(f)) <= tolerance;
    (flat && (span[1] - span[0]) * length > 2.0 * tolerance).then_some(span)
}

/// The part of the span where the affine function from s (at 0) to t (at 1) is not negative.
fn cut([lo, hi]: [f64; 2], s: f64, t: f64) -> Option<[f64; 2]> {
    let zero = s / (s - t);
    let span = match (s >= 0.0, t >= 0.0) {
        (true, true) => [lo, hi],
        (true, false) => [lo, hi.min(zero)],
        (false, true) => [lo.max(zero), hi],
        (false, false) => return None,
    };
    (span[0] < span[1]).then_some(span)
}

#[derive(Clone, Copy, PartialEq)]
enum Pairing {
    /// The edges stay within the tolerance over their whole common length.
    Along,
    /// They cross in a point inside both.
    Across,
}

fn edge_pairs<'a>(a: &'a Shape, b: &'a Shape, tolerance: f64, pairing: Pairing) -> Vec<Place<'a>> {
    let place = move |e: usize, f: usize| {
        let (ea, eb) = (&a.features.edges[e], &b.features.edges[f]);
        let ([p, q], [r, s]) = (ea.ends.map(|i| a.at(i)), eb.ends.map(|i| b.at(i)));
        let corners = match pairing {
            Pairing::Along => stretch(p, q, r, s, tolerance),
            Pairing::Across => crossing(p, q, r, s, tolerance).map(|x| vec![x]),
        };
        corners.map(|corners| Place { corners, a: &ea.local, b: &eb.local })
    };
    let pairs = a.features.edges_near(&b.bounds, tolerance).into_iter().flat_map(|e| {
        let bounds = around(a.features.edges[e].ends.iter().map(|&i| a.at(i)));
        b.features.edges_near(&bounds, tolerance).into_iter().map(move |f| (e, f))
    });
    pairs.filter_map(|(e, f)| place(e, f)).collect()
}

/// Sine of the angle between two segments times the shorter length: how far they part over it.
fn parting(p: DVec3, q: DVec3, r: DVec3, s: DVec3) -> f64 {
    let (d, e) = (q - p, s - r);
    d.cross(e).length() / d.length().max(e.length())
}

/// The common stretch of two edges that part by no more than the tolerance.
fn stretch(p: DVec3, q: DVec3, r: DVec3, s: DVec3, tolerance: f64) -> Option<Vec<DVec3>> {
    let d = q - p;
    let t = |x: DVec3| (x - p).dot(d) / d.length_squared();
    let (lo, hi) = (t(r).min(t(s)).max(0.0), t(r).max(t(s)).min(1.0));
    let ends = [p.lerp(q, lo), p.lerp(q, hi)];
    let long = (hi - lo) * d.length() > 2.0 * tolerance;
    let near = ends.iter().all(|&x| segment_distance(r, s, x) <= tolerance);
    (long && near && parting(p, q, r, s) <= tolerance).then(|| ends.to_vec())
}

/// Where two edges cross within the tolerance, farther than it from their ends.
fn crossing(p: DVec3, q: DVec3, r: DVec3, s: DVec3, tolerance: f64) -> Option<DVec3> {
    let (d, e, w) = (q - p, s - r, r - p);
    let n = d.cross(e);
    if parting(p, q, r, s) <= tolerance {
        return None;
    }
    let (t, u) = (w.cross(e).dot(n) / n.length_squared(), w.cross(d).dot(n) / n.length_squared());
    let (x, y) = (p + t * d, r + u * e);
    let inner = |t: f64, l: f64| t * l > tolerance && (1.0 - t) * l > tolerance;
    (inner(t, d.length()) && inner(u, e.length()) && x.distance(y) <= tolerance).then(|| (x + y) / 2.0)
}
