//! Takes two shapes; gives the isometries that carry one to the other.
//!
//! Complete up to round-off: an isometry carries the centroid to the centroid and two chosen corners to vertices at the
//! same distances, and all such pairs are tried, so no principal axes are needed and equal moments do no harm. Sound: one
//! counts only when all points meet and every part's faces do. What meets in its corners alone is told as such.

use super::moment;
use super::shape::{Body, Shape, sorted};
use glam::{DAffine3, DMat3, DVec3};

/// An isometry that was checked on the shapes.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    pub map: DAffine3,
    /// Farthest distance of a point's image from its partner.
    pub residual: f64,
}

impl Found {
    pub fn is_proper(&self) -> bool {
        self.map.matrix3.determinant() > 0.0
    }
}

/// What the search found.
#[derive(Clone, Debug, Default)]
pub struct Search {
    pub found: Vec<Found>,
    /// Isometries on which all corners meet though the faces could not be matched: no proof either way.
    pub loose: Vec<Found>,
    /// Isometries that were tried.
    pub tried: usize,
    /// Residual up to which points count as met.
    pub within: f64,
}

/// A corner used to place the shape: where it is from the centroid, and the points of the other shape as far out.
struct Anchor {
    at: DVec3,
    partners: Vec<DVec3>,
}

/// All isometries from `a` to `b`; none where `a` has too few clear corners to tell. `rounding`: how far a vertex may be
/// off, in model units.
pub fn search(a: &Shape, b: &Shape, rounding: f64) -> Option<Search> {
    let centres = [a, b].map(|s| moment::centroid(&s.triangles).1);
    let (p, q, within) = anchors(a, b, centres, rounding)?;
    let mut search = Search { within, ..Search::default() };
    let own = frame(p.at, q.at);
    // Two points and the centroid are each off by the rounding at most, in either shape.
    let alike = |s: f64, t: f64| (s - t).abs() <= 4.0 * rounding;
    for &p2 in &p.partners {
        for &q2 in q.partners.iter().filter(|q2| alike(q2.distance(p2), q.at.distance(p.at))) {
            for side in [1.0, -1.0] {
                let turn = frame(p2, q2) * DMat3::from_diagonal(DVec3::new(1.0, 1.0, side)) * own.transpose();
                let map = DAffine3::from_mat3_translation(turn, centres[1] - turn * centres[0]);
                search.tried += 1;
                try_map(a, b, map, &mut search);
            }
        }
    }
    Some(search)
}

fn try_map(a: &Shape, b: &Shape, map: DAffine3, search: &mut Search) {
    let Some(corners) = corner_residual(a, b, &map, search.within) else { return };
    match meets(a, b, &map, search.within) {
        Some(residual) => search.found.push(Found { map, residual }),
        // Corners belong to the shape however its faces are divided: parts whose corners go to no one part differ.
        None if a.parts.len() > 1 && !parts_meet(a, b, &map, search.within) => {}
        None => search.loose.push(Found { map, residual: corners }),
    }
}

/// Right-handed orthonormal axes: along p, then in the plane of p and q.
fn frame(p: DVec3, q: DVec3) -> DMat3 {
    let x = p.normalize();
    let y = (q - x * x.dot(q)).normalize();
    DMat3::from_cols(x, y, x.cross(y))
}

/// Two corners of `a` far from its centroid and from one line with it, chosen for few partners in `b`; and how far
/// points may miss when the shape is placed by them.
fn anchors(a: &Shape, b: &Shape, centres: [DVec3; 2], rounding: f64) -> Option<(Anchor, Anchor, f64)> {
    let own: Vec<DVec3> = a.corners.iter().map(|&k| a.point(k) - centres[0]).collect();
    let mut others: Vec<DVec3> = b.surface.iter().map(|&k| b.point(k) - centres[1]).collect();
    others.sort_by(|s, t| s.length().total_cmp(&t.length()));
    let partners = |p: DVec3| {
        let from = others.partition_point(|o| o.length() < p.length() - 4.0 * rounding);
        let to = others.partition_point(|o| o.length() <= p.length() + 4.0 * rounding);
        &others[from..to]
    };
    let pick = |lever: &dyn Fn(DVec3) -> f64| {
        let most = own.iter().map(|&p| lever(p)).fold(0.0, f64::max);
        let far = own.iter().filter(|&&p| most > 0.0 && 2.0 * lever(p) >= most);
        let rarest = far.min_by_key(|&&p| partners(p).len())?;
        Some(Anchor { at: *rarest, partners: partners(*rarest).to_vec() })
    };
    let p = pick(&|v| v.length())?;
    let q = pick(&|v| v.reject_from(p.at).length())?;
    // A point at radius r turns with the errors of both anchors: 2 roundings each (its own and the centroid's, in both
    // shapes 4) over their levers; its own partner and the centroids are off by as much again.
    let radius = a.cloud.points.iter().map(|v| v.distance(centres[0])).fold(0.0, f64::max);
    let lever = 1.0 + radius / p.at.length() + radius / q.at.reject_from(p.at).length();
    Some((p, q, 4.0 * rounding * lever))
}

/// Farthest distance of a corner, of either shape, from where the other has a point; none beyond `within`.
pub fn corner_residual(a: &Shape, b: &Shape, map: &DAffine3, within: f64) -> Option<f64> {
    let one = |from: &Shape, to: &Shape, map: &DAffine3| {
        from.corners.iter().try_fold(0.0, |worst: f64, &k| {
            let image = map.transform_point3(from.point(k));
            to.cloud.nearest(image, within).map(|(_, d)| worst.max(d))
        })
    };
    Some(one(a, b, map)?.max(one(b, a, &map.inverse())?))
}

/// Whether the corners of every part go to points of one part, and that one's corners back.
fn parts_meet(a: &Shape, b: &Shape, map: &DAffine3, within: f64) -> bool {
    let back = map.inverse();
    let inside = |from: &Shape, corners: &[u32], map: &DAffine3, to: &Shape, points: &[u32]| {
        corners.iter().all(|&k| {
            let image = map.transform_point3(from.point(k));
            points.iter().any(|&id| to.point(id).distance(image) <= within)
        })
    };
    a.members.iter().all(|[corners, points]| {
        b.members
            .iter()
            .any(|[others, theirs]| inside(a, corners, map, b, theirs) && inside(b, others, &back, a, points))
    })
}

/// Farthest distance of any point from its partner, when all have one and the parts of `a` become the parts of `b`.
fn meets(a: &Shape, b: &Shape, map: &DAffine3, within: f64) -> Option<f64> {
    let mut worst: f64 = 0.0;
    let mut partner = Vec::with_capacity(a.cloud.points.len());
    for &p in &a.cloud.points {
        let (id, d) = b.cloud.nearest(map.transform_point3(p), within)?;
        worst = worst.max(d);
        partner.push(id);
    }
    let image = |part: &Vec<Body>| {
        sorted(part.iter().map(|b| b.iter().map(|e| e.map(|k| partner[k as usize])).collect()).collect())
    };
    let mut images: Vec<Vec<Body>> = a.parts.iter().map(image).collect();
    images.sort_unstable();
    (images == b.parts).then_some(worst)
}
