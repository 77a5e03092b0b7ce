//! Takes two shapes, gives the convex pieces on which their faces lie flat on each other, or lie flush the
//! same way.
//!
//! Facets count as coplanar when over their whole common region they are no farther apart than the tolerance,
//! and their angle would not part them by more over the smaller facet's longest edge. Not promised: a wedge
//! cut into facets smaller than tolerance / angle reads as flat on its first few.

use super::polygon;
use super::shape::Shape;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// Two faces at a larger angle than this (radians) do not lie flat on each other, however small they are: a
/// region that stays within the tolerance at this angle is 20 tolerances wide at most, too short a lever to
/// be told from an edge.
const STEEPEST: f64 = 0.1;

/// A region on which two shapes touch face to face, or an intruding one where their faces look the same way.
#[derive(Clone, Debug)]
pub(super) struct Flush {
    /// Unit normal from the first shape to the second.
    pub normal: DVec3,
    pub corners: Vec<DVec3>,
    /// Largest distance between the two faces over the region, in model units.
    pub gap: f64,
    /// Angle between the two faces, in radians.
    pub tilt: f64,
    /// By how much the normal may be off, in radians.
    pub known: f64,
}

#[derive(Clone, Copy, PartialEq)]
pub(super) enum Facing {
    /// Outward normals opposed: contact.
    Opposed,
    /// Outward normals alike: the shapes share the space under the faces.
    Alike,
}

/// One facet on one facet, in the frame of their normal.
struct Piece {
    ring: Vec<DVec2>,
    height: f64,
    gap: f64,
}

struct Frame {
    u: DVec3,
    v: DVec3,
    n: DVec3,
}

impl Frame {
    fn of(n: DVec3) -> Frame {
        let (u, v) = n.any_orthonormal_pair();
        Frame { u, v, n }
    }

    fn flat(&self, p: DVec3) -> DVec2 {
        DVec2::new(p.dot(self.u), p.dot(self.v))
    }

    fn space(&self, p: DVec2, height: f64) -> DVec3 {
        self.u * p.x + self.v * p.y + self.n * height
    }
}

/// All such regions, wider than twice the tolerance, joined where their union is convex.
pub(super) fn regions(a: &Shape, b: &Shape, facing: Facing, tolerance: f64) -> Vec<Flush> {
    let mut groups: BTreeMap<[[u64; 3]; 2], Vec<(usize, usize)>> = BTreeMap::new();
    let bits = |n: DVec3| n.to_array().map(f64::to_bits);
    for f in a.faces_near(&b.bounds, tolerance) {
        let near = b.faces_near(&a.face_bounds(f), tolerance);
        for g in near.into_iter().filter(|&g| looks(a.faces[f].normal, b.faces[g].normal, facing)) {
            groups.entry([bits(a.faces[f].normal), bits(b.faces[g].normal)]).or_default().push((f, g));
        }
    }
    groups.into_values().flat_map(|pairs| group(a, b, &pairs, facing, tolerance)).collect()
}

fn looks(na: DVec3, nb: DVec3, facing: Facing) -> bool {
    let nb = if facing == Facing::Opposed { -nb } else { nb };
    na.dot(nb) > 0.0 && na.cross(nb).length() <= STEEPEST.sin()
}

/// Regions of facet pairs that all have the same two normals.
fn group(a: &Shape, b: &Shape, pairs: &[(usize, usize)], facing: Facing, tolerance: f64) -> Vec<Flush> {
    let (na, nb) = (a.faces[pairs[0].0].normal, b.faces[pairs[0].1].normal);
    let toward = if facing == Facing::Opposed { -nb } else { nb };
    let frame = Frame::of((na + toward).normalize());
    let tilt = na.cross(toward).length().atan2(na.dot(toward));
    let best = |s: &Shape, of: &mut dyn Iterator<Item = usize>| {
        of.map(|k| s.faces[k].known).fold(f64::INFINITY, f64::min)
    };
    let (ka, kb) = (best(a, &mut pairs.iter().map(|p| p.0)), best(b, &mut pairs.iter().map(|p| p.1)));
    let known = ((ka + kb) + tilt) / 2.0;
    let mut pieces: Vec<Piece> =
        pairs.iter().filter_map(|&(f, g)| piece(a, b, f, g, &frame, tolerance)).collect();
    pieces.sort_by(|p, q| p.height.total_cmp(&q.height));
    // Pieces of one plane are no farther from each other than the tolerance on either side; steps are.
    let levels = pieces.chunk_by(|p, q| q.height - p.height <= 2.0 * tolerance);
    levels.flat_map(|level| level_regions(level, &frame, [tilt, known], tolerance)).collect()
}

fn level_regions(level: &[Piece], frame: &Frame, [tilt, known]: [f64; 2], tolerance: f64) -> Vec<Flush> {
    let gap = level.iter().map(|p| p.gap).fold(0.0, f64::max);
    let height = level.iter().map(|p| p.height).sum::<f64>() / level.len() as f64;
    let rings = level.iter().map(|p| p.ring.clone()).collect();
    // Corners that jut out by less than a thousandth of the tolerance carry no news.
    let joined = polygon::joined(rings, tolerance, tolerance / 1000.0);
    let wide = joined.into_iter().filter(|r| polygon::width(r) > 2.0 * tolerance);
    wide.map(|r| Flush {
        normal: frame.n,
        corners: r.into_iter().map(|p| frame.space(p, height)).collect(),
        gap,
        tilt,
        known,
    })
    .collect()
}

/// Where facet f of a and facet g of b overlap, seen along the normal, if they stay within the tolerance
/// there.
fn piece(a: &Shape, b: &Shape, f: usize, g: usize, frame: &Frame, tolerance: f64) -> Option<Piece> {
    let ring = |s: &Shape, k: usize| {
        let mut r: Vec<DVec2> = s.ring(k).map(|p| frame.flat(p)).collect();
        if polygon::twice_area(&r) < 0.0 {
            r.reverse();
        }
        r
    };
    let common = polygon::clipped(ring(a, f), &ring(b, g));
    if common.len() < 3 || polygon::twice_area(&common) <= 0.0 {
        return None;
    }
    if a.faces[f].normal.cross(b.faces[g].normal).length() * a.longest(f).min(b.longest(g)) > tolerance {
        return None;
    }
    let (pa, pb) = (plane(a, f, frame), plane(b, g, frame));
    let gap = common.iter().map(|&p| (pa(p) - pb(p)).abs()).fold(0.0, f64::max);
    let height = common.iter().map(|&p| (pa(p) + pb(p)) / 2.0).sum::<f64>() / common.len() as f64;
    (gap <= tolerance).then_some(Piece { ring: common, height, gap })
}

/// Height of a facet's plane over a point of the frame.
fn plane(s: &Shape, k: usize, frame: &Frame) -> impl Fn(DVec2) -> f64 + use<> {
    let n = s.faces[k].normal;
    let o = s.ring(k).sum::<DVec3>() / s.faces[k].corners.len() as f64;
    let (slope, lift, d) = (DVec2::new(n.dot(frame.u), n.dot(frame.v)), n.dot(frame.n), n.dot(o));
    move |p| (d - slope.dot(p)) / lift
}
