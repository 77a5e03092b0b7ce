//! Takes polygons over welded vertices, gives rings that close: every directed edge is met by its reverse as
//! often.
//!
//! Promised: what is handed on bounds a volume, outward; a vertex in the middle of a longer edge (a
//! T-junction) is made a corner of that edge's faces. Not promised: that the surface does not cross itself,
//! or touches itself nowhere.

use super::faults::{Found, Place, found};
use super::soup::Soup;
use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use std::collections::BTreeMap;

/// So many faults of one kind are listed one by one; the rest is counted.
pub(super) const LISTED: usize = 20;

/// Corner rings of faces, and which faces hang together.
#[derive(Clone, Debug, Default)]
pub(super) struct Closed {
    pub rings: Vec<Vec<u32>>,
    /// Outward shells: bodies that share no edge.
    pub bodies: usize,
    /// Inward shells inside a body.
    pub voids: usize,
    pub t_junctions: usize,
    pub dropped: usize,
    /// Pairs of a face and its reverse, taken out.
    pub walls: usize,
    /// Edges where more than two faces meet and still pair up: the solid touches itself along them.
    pub touching_edges: usize,
}

/// How far a point of the file may stand from a line or plane through others of its points and still be meant
/// to lie on it, in model units: each coordinate of either is known to half a unit only, in three directions.
pub(super) fn slack(resolution: f64) -> f64 {
    2.0 * 3f64.sqrt() * resolution
}

pub(super) fn close(soup: &Soup, width: f64) -> Result<Closed, Vec<Found>> {
    let all = soup.faces.iter().map(|f| without_repeats(f));
    let mut rings: Vec<Vec<u32>> =
        all.filter(|f| f.len() > 2 && !is_flat(f, &soup.vertices, width)).collect();
    let dropped = soup.faces.len() - rings.len();
    if rings.is_empty() {
        return Err(vec![found(Place::File, "no face with an area", "the file must hold one closed mesh")]);
    }
    let t_junctions = split_edges(&mut rings, &soup.vertices, width);
    let walls = cancel(&mut rings);
    if rings.is_empty() {
        let what = "walls without thickness only: each face has its reverse";
        return Err(vec![found(Place::File, what, "give the walls a thickness")]);
    }
    let mut faults = open_edges(&rings, &soup.vertices);
    faults.extend(doubled_faces(&rings, &soup.vertices));
    if !faults.is_empty() {
        return Err(faults);
    }
    let touching_edges = directed(&rings).iter().filter(|&(&(a, b), &n)| a < b && n > 1).count();
    let (bodies, voids) = super::shells::outward(&rings, &soup.vertices, width)?;
    Ok(Closed { rings, bodies, voids, t_junctions, dropped, walls, touching_edges })
}

fn without_repeats(face: &[u32]) -> Vec<u32> {
    let mut ring = face.to_vec();
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring
}

/// Twice the area vector of a ring, by Newell's sum about its first corner.
pub(super) fn area_vector(ring: &[u32], points: &[DVec3]) -> DVec3 {
    let o = points[ring[0] as usize];
    ring.windows(2).map(|w| (points[w[0] as usize] - o).cross(points[w[1] as usize] - o)).sum()
}

/// No wider than `width` anywhere: all corners on one line.
fn is_flat(ring: &[u32], points: &[DVec3], width: f64) -> bool {
    let longest = edges(ring)
        .map(|(a, b)| points[b as usize] - points[a as usize])
        .max_by(|u, v| u.length_squared().total_cmp(&v.length_squared()));
    longest.is_none_or(|e| {
        let (o, u) = (points[ring[0] as usize], e.normalize_or_zero());
        let off = |i: &u32| (points[*i as usize] - o).reject_from_normalized(u).length();
        ring.iter().map(off).fold(0.0, f64::max) <= width
    })
}

pub(super) fn edges(ring: &[u32]) -> impl Iterator<Item = (u32, u32)> + '_ {
    (0..ring.len()).map(|k| (ring[k], ring[(k + 1) % ring.len()]))
}

/// How many faces run along each directed edge.
pub(super) fn directed(rings: &[Vec<u32>]) -> BTreeMap<(u32, u32), usize> {
    let mut count = BTreeMap::new();
    for e in rings.iter().flat_map(|r| edges(r)) {
        *count.entry(e).or_insert(0) += 1;
    }
    count
}

fn unbalanced(rings: &[Vec<u32>]) -> Vec<((u32, u32), usize, usize)> {
    let count = directed(rings);
    let pair = |(&(a, b), &n): (&(u32, u32), &usize)| ((a, b), n, count.get(&(b, a)).copied().unwrap_or(0));
    count.iter().map(pair).filter(|&(_, n, m)| n > m).collect()
}

/// Puts vertices that stand on an edge between its ends into the rings of that edge, until nothing changes.
/// Returns how many were put in. Only ends of edges without their reverse are tried, and only such edges are
/// split.
fn split_edges(rings: &mut [Vec<u32>], points: &[DVec3], width: f64) -> usize {
    let mut inserted = 0;
    loop {
        let splits = splits(&unbalanced(rings), points, width);
        if splits.is_empty() {
            return inserted;
        }
        inserted += splits.values().map(Vec::len).sum::<usize>();
        for ring in rings.iter_mut() {
            if edges(ring).any(|(a, b)| splits.contains_key(&(a.min(b), a.max(b)))) {
                *ring = refined(ring, &splits);
            }
        }
    }
}

type Splits = BTreeMap<(u32, u32), Vec<u32>>;

fn refined(ring: &[u32], splits: &Splits) -> Vec<u32> {
    let mut out = Vec::with_capacity(ring.len() + 2);
    for (a, b) in edges(ring) {
        out.push(a);
        if let Some(inner) = splits.get(&(a.min(b), a.max(b))) {
            let inner = inner.iter().copied().filter(|v| !ring.contains(v));
            if a < b { out.extend(inner) } else { out.extend(inner.rev()) }
        }
    }
    out
}

fn splits(open: &[((u32, u32), usize, usize)], points: &[DVec3], width: f64) -> Splits {
    let mut ends: Vec<u32> = open.iter().flat_map(|&((a, b), ..)| [a, b]).collect();
    ends.sort_unstable();
    ends.dedup();
    let boxes: Vec<Aabb> = ends.iter().map(|&v| Aabb::new(points[v as usize], points[v as usize])).collect();
    let bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let keys = open.iter().map(|&((a, b), ..)| (a.min(b), a.max(b)));
    let found = keys.map(|(a, b)| {
        let (p, q) = (points[a as usize], points[b as usize]);
        let around = Aabb::new(p.min(q) - width, p.max(q) + width);
        let mut inner: Vec<(f64, u32)> = bvh
            .intersect_aabb(&around)
            .map(|k| ends[k as usize])
            .filter(|&v| v != a && v != b)
            .filter_map(|v| along(points[v as usize], p, q, width).map(|t| (t, v)))
            .collect();
        inner.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        ((a, b), inner.into_iter().map(|(_, v)| v).collect::<Vec<_>>())
    });
    found.filter(|(_, inner)| !inner.is_empty()).collect()
}

/// Where between p and q (0 to 1, ends excluded) x stands, if it stands within `width` of their line.
fn along(x: DVec3, p: DVec3, q: DVec3, width: f64) -> Option<f64> {
    let e = q - p;
    let t = (x - p).dot(e) / e.length_squared();
    (t > 0.0 && t < 1.0 && x.distance(p + t * e) <= width).then_some(t)
}

fn open_edges(rings: &[Vec<u32>], points: &[DVec3]) -> Vec<Found> {
    let open = unbalanced(rings);
    let mut faults: Vec<Found> = open
        .iter()
        .take(LISTED)
        .map(|&((a, b), n, m)| {
            let place = Place::Edge(points[a as usize], points[b as usize]);
            match (n, m) {
                (1, 0) => found(
                    place,
                    "open: one face only",
                    "close the surface; corners must be equal to the last digit",
                ),
                (2, 0) => found(
                    place,
                    "two faces run along it the same way: one faces inward",
                    "turn one of them over",
                ),
                _ => found(
                    place,
                    format!("not a surface: {n} faces run one way along it and {m} the other"),
                    "each edge needs as many faces one way as the other",
                ),
            }
        })
        .collect();
    if open.len() > LISTED {
        let what = format!("{} more edges that do not close", open.len() - LISTED);
        faults.push(found(Place::File, what, "the first ones are listed"));
    }
    faults
}

/// A ring that starts with its least corner.
fn canonical(ring: impl Iterator<Item = u32> + Clone) -> Vec<u32> {
    let mut ring: Vec<u32> = ring.collect();
    let least = (0..ring.len()).min_by_key(|&k| ring[k]).unwrap_or(0);
    ring.rotate_left(least);
    ring
}

/// Takes out pairs of a face and its reverse: walls inside, or without thickness, bound nothing. Returns how
/// many pairs.
fn cancel(rings: &mut Vec<Vec<u32>>) -> usize {
    let mut at: BTreeMap<Vec<u32>, Vec<usize>> = BTreeMap::new();
    let mut gone = vec![false; rings.len()];
    for (k, ring) in rings.iter().enumerate() {
        let reverse = at.get_mut(&canonical(ring.iter().rev().copied())).and_then(Vec::pop);
        match reverse {
            Some(j) => (gone[j], gone[k]) = (true, true),
            None => at.entry(canonical(ring.iter().copied())).or_default().push(k),
        }
    }
    let mut gone = gone.into_iter();
    let before = rings.len();
    rings.retain(|_| !gone.next().unwrap_or(false));
    (before - rings.len()) / 2
}

/// Faces that are there twice the same way.
fn doubled_faces(rings: &[Vec<u32>], points: &[DVec3]) -> Vec<Found> {
    let mut count: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
    rings.iter().for_each(|r| *count.entry(canonical(r.iter().copied())).or_default() += 1);
    let twice = count.into_iter().filter(|&(_, n)| n > 1).take(LISTED);
    twice
        .map(|(ring, n)| {
            let place = Place::Edge(points[ring[0] as usize], points[ring[1] as usize]);
            found(place, format!("the face beside it is there {n} times"), "keep one of them")
        })
        .collect()
}
