//! Takes a woven assembly and its patches; gives how far each facet is from the true surface, and contacts on that.
//!
//! The true surface between two strands is where the distances to their centrelines are equal (paper, section 3); a
//! facet is the plane between two sites of theirs. Errors are the largest over a facet's middle and points just short of
//! its corners (at corners the true surface may have a ridge, and two normals): measured there, not bounded between. Contacts on the true surface are few of many: safe for locked, silent about free.

use super::Patch;
use super::curve::Curves;
use crate::assembly::PartIx;
use crate::assembly::woven::Woven;
use crate::spec::Bounds;
use crate::tile::Piece;
use glam::DVec3;
use rayon::prelude::*;

/// How far a facet is from the true surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChordError {
    /// Between the facet's normal and the true one, radians; pi where there is no true surface near it.
    pub angle: f64,
    /// From the facet to the true surface, crossings.
    pub distance: f64,
}

const NONE: ChordError = ChordError { angle: 0.0, distance: 0.0 };
const UNKNOWN: ChordError = ChordError { angle: std::f64::consts::PI, distance: f64::INFINITY };

/// How far a facet on a cut may be from it, as a distance and an angle: sites are rounded by up to 2^-20 of a crossing,
/// and the two beside a cut may be a 64th apart. What it is off by counts as its error.
const ON_A_CUT: f64 = 1.3e-4;

/// Errors below this are round-off: of Newton's method, and of normals.
const ROUND_OFF: f64 = 1e-11;

/// Steps of Newton's method onto the true surface; its gradient is known, and points start near.
const STEPS: usize = 8;

/// Where Newton's method has arrived: a few units of round-off at coordinates of up to a thousand crossings.
const ARRIVED: f64 = 1e-12;

/// What must lie between a contact on the true surface and the next thing that could own it: far above `ARRIVED`.
const CLEAR_OF_OTHERS: f64 = 1e-6;

/// From a facet's middle to its corners: corners belong to other parts too, points short of them do not.
const SHORT_OF_CORNERS: f64 = 15.0 / 16.0;

/// A point on the true surface between two parts and the unit normal there, from the first to the second.
struct True {
    at: DVec3,
    normal: DVec3,
    /// Distance to either centreline.
    distance: f64,
}

/// The chord error of each patch, in their order.
pub fn errors(woven: &Woven, patches: &[Patch]) -> Vec<ChordError> {
    let curves = Curves::new(&woven.weave, &woven.profile);
    patches.par_iter().map(|q| error(woven, &curves, q)).collect()
}

/// The largest angle and the largest distance.
pub fn largest(errors: &[ChordError]) -> ChordError {
    let most = |a: ChordError, b: &ChordError| ChordError {
        angle: a.angle.max(b.angle),
        distance: a.distance.max(b.distance),
    };
    errors.iter().fold(NONE, most)
}

fn error(woven: &Woven, curves: &Curves, patch: &Patch) -> ChordError {
    let pieces = pieces(woven, patch);
    if let Some(error) = on_the_cut(curves, pieces, patch) {
        return error;
    }
    let of = |p: DVec3| {
        let Some(t) = surface(curves, pieces, p) else { return UNKNOWN };
        let told = |v: f64| if v > ROUND_OFF { v } else { 0.0 };
        ChordError { angle: told(t.normal.angle_between(patch.normal)), distance: told(t.at.distance(p)) }
    };
    let all: Vec<ChordError> = inner(patch).map(of).collect();
    largest(&all)
}

/// The middle, and points short of the corners.
fn inner(patch: &Patch) -> impl Iterator<Item = DVec3> + '_ {
    let middle = middle(patch);
    patch.corners.iter().map(move |c| middle + (c - middle) * SHORT_OF_CORNERS).chain([middle])
}

fn pieces<'w>(woven: &'w Woven, patch: &Patch) -> [&'w Piece; 2] {
    [patch.a, patch.b].map(|p: PartIx| &woven.pieces[p.at()])
}

fn middle(patch: &Patch) -> DVec3 {
    patch.corners.iter().sum::<DVec3>() / patch.corners.len().max(1) as f64
}

/// The error of a facet that lies across a strand at the cut between these pieces; none where it does not.
fn on_the_cut(curves: &Curves, [a, b]: [&Piece; 2], patch: &Patch) -> Option<ChordError> {
    if a.strand != b.strand {
        return None;
    }
    let at = if a.to == b.from { a.to } else { a.from };
    let (cut, along) = curves.cut(a.strand, at);
    let angle = along.cross(patch.normal).length();
    let distance = patch.corners.iter().map(|c| (c - cut).dot(patch.normal).abs()).fold(0.0, f64::max);
    (angle < ON_A_CUT && distance < ON_A_CUT).then(|| ChordError { angle: angle.min(1.0).asin(), distance })
}

/// The point of the true surface nearest to p, as good as; none where the centrelines are not told apart.
fn surface(curves: &Curves, [a, b]: [&Piece; 2], p: DVec3) -> Option<True> {
    let mut at = p;
    for _ in 0..STEPS {
        let [f, g] = [a, b].map(|s| curves.nearest(s.strand, (s.from, s.to), at));
        let (f, g) = (f?, g?);
        // The gradient of the first distance less the second: it grows towards b.
        let gradient = (at - f.at) / f.distance - (at - g.at) / g.distance;
        let (off, steep) = (f.distance - g.distance, gradient.length());
        if !steep.is_normal() || !off.is_finite() {
            return None;
        }
        let normal = gradient / steep;
        if off.abs() < ARRIVED {
            return Some(True { at, normal, distance: f.distance });
        }
        at -= normal * (off / steep);
    }
    None
}

/// Contacts on the true surface: for each patch the points near its middle and corners that are nearer to both its
/// strands than to anything else.
pub fn true_contacts(woven: &Woven, patches: &[Patch]) -> Vec<Patch> {
    let curves = Curves::new(&woven.weave, &woven.profile);
    let of = |q: &Patch| -> Vec<Patch> { inner(q).filter_map(|p| contact(woven, &curves, q, p)).collect() };
    patches.par_iter().flat_map_iter(of).collect()
}

fn contact(woven: &Woven, curves: &Curves, patch: &Patch, p: DVec3) -> Option<Patch> {
    let pieces = pieces(woven, patch);
    if pieces[0].strand == pieces[1].strand {
        // A cut's true normal runs along the strand; only cuts are looked at.
        on_the_cut(curves, pieces, patch)?;
        let at = if pieces[0].to == pieces[1].from { pieces[0].to } else { pieces[0].from };
        let (cut, along) = curves.cut(pieces[0].strand, at);
        let normal = if along.dot(patch.normal) < 0.0 { -along } else { along };
        let on = p - normal * (p - cut).dot(normal);
        return owned(woven, curves, pieces, on, None).then(|| Patch {
            normal,
            corners: vec![on],
            ..patch.clone()
        });
    }
    let t = surface(curves, pieces, p)?;
    owned(woven, curves, pieces, t.at, Some(t.distance)).then(|| Patch {
        normal: t.normal,
        corners: vec![t.at],
        ..patch.clone()
    })
}

/// Whether nothing but these pieces is as near to p: no other strand, no other stretch of theirs, no face of the slab.
/// Without a distance the pieces are of one strand, and p lies across their cut.
fn owned(woven: &Woven, curves: &Curves, pieces: [&Piece; 2], p: DVec3, distance: Option<f64>) -> bool {
    let whole = |piece: &Piece, r: i32| {
        let along = if piece.strand.kind == crate::weave::Kind::Weft { p.x } else { p.y };
        (along.floor() as i32 - r, along.floor() as i32 + r + 1)
    };
    let Some(own) = curves.nearest(pieces[0].strand, whole(pieces[0], 8), p) else { return false };
    let reach = distance.unwrap_or(own.distance) + CLEAR_OF_OTHERS;
    if reach > 6.0 || !inside(woven, p, reach) {
        return false;
    }
    if distance.is_none() {
        let at = if pieces[0].to == pieces[1].from { pieces[0].to } else { pieces[0].from };
        if own.at.distance(curves.cut(pieces[0].strand, at).0) > ROUND_OFF {
            return false;
        }
    }
    let kept = pieces.iter().all(|s| {
        let (all, part) =
            (curves.nearest(s.strand, whole(s, 8), p), curves.nearest(s.strand, (s.from, s.to), p));
        // Another stretch of the strand may only be as near where it is the same point.
        matches!((all, part), (Some(all), Some(part)) if part.distance <= all.distance + ARRIVED)
            && (distance.is_none() || !at_an_end(curves, s, p))
    });
    kept && others(pieces, p, reach).all(|s| {
        let around = (p.x.min(p.y).floor() as i32 - 8, p.x.max(p.y).floor() as i32 + 9);
        curves.nearest(s, around, p).is_none_or(|f| f.distance > reach)
    })
}

/// Whether the nearest point of the piece is one of its ends: then the surface belongs to its neighbour too.
fn at_an_end(curves: &Curves, s: &Piece, p: DVec3) -> bool {
    let foot = curves.nearest(s.strand, (s.from, s.to), p);
    let end = |c: i32| foot.is_none_or(|f| f.at.distance(curves.cut(s.strand, c).0) < CLEAR_OF_OTHERS);
    end(s.from) || end(s.to)
}

/// The strands other than these that may come within `reach` of p.
fn others(pieces: [&Piece; 2], p: DVec3, reach: f64) -> impl Iterator<Item = crate::weave::Strand> + '_ {
    use crate::weave::{Kind, Strand};
    let near = move |at: f64, kind: Kind| {
        let range = (at - reach - 0.5).floor() as i32..=(at + reach).ceil() as i32;
        range.map(move |index| Strand { kind, index })
    };
    near(p.y, Kind::Weft).chain(near(p.x, Kind::Warp)).filter(move |s| pieces.iter().all(|q| q.strand != *s))
}

/// Whether p is nearer to its strand than to the faces above and below.
fn inside(woven: &Woven, p: DVec3, reach: f64) -> bool {
    let profile = &woven.profile;
    let (low, high) = (p.z, profile.lift - p.z);
    match profile.bounds {
        Bounds::Sandwich => low + profile.cover > reach && high + profile.cover > reach,
        Bounds::Prism => low.min(high) + profile.cover / 2.0 > CLEAR_OF_OTHERS,
    }
}
