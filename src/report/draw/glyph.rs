//! Takes a motion or a force, gives a solid that shows it: an arrow, a turning arrow.
//!
//! Not promised: that lengths are to scale with anything; the caller chooses them. Glyphs are drawn, never analysed.

use crate::solid::{Facet, Solid};
use glam::DVec3;
use std::f64::consts::TAU;

/// Corners of a round section: 15 degrees from face to face, below the crease angle.
const ROUND: usize = 24;
/// Steps of a full turn of a bent shaft: 7.5 degrees each.
const BEND: f64 = 48.0;
/// Length and radius of the head, in radii of the shaft.
const HEAD_LENGTH: f64 = 5.0;
const HEAD_RADIUS: f64 = 2.4;

/// A straight arrow with its tail at `from` and its point at `to`; `None` where they coincide or `radius` is no length.
pub fn arrow(from: DVec3, to: DVec3, radius: f64) -> Option<Solid> {
    let along = (to - from).try_normalize()?;
    let head = (radius * HEAD_LENGTH).min((to - from).length() * 0.6);
    let neck = to - along * head;
    (radius > 0.0).then(|| lathe(&[from, neck], &[along; 2], radius, (to, along)))
}

/// An arrow bent about the axis through `centre`: it turns by `angle` radians (by its sign, right-handed about `axis`),
/// at most once around, on a circle of radius `bow`. `None` where axis, bow, angle or shaft have no size.
pub fn turning_arrow(centre: DVec3, axis: DVec3, bow: f64, angle: f64, radius: f64) -> Option<Solid> {
    if !angle.is_finite() {
        return None;
    }
    let axis = axis.try_normalize()? * angle.signum();
    let (u, v) = axis.any_orthonormal_pair();
    let angle = angle.abs().min(TAU * 0.9);
    let head = radius * HEAD_LENGTH / bow;
    let shaft = angle - head;
    let sizes = [bow, radius, shaft];
    if !sizes.iter().all(|s| s.is_finite() && *s > 0.0) {
        return None;
    }
    let at = |t: f64| centre + (u * t.cos() + v * t.sin()) * bow;
    let way = |t: f64| v * t.cos() - u * t.sin();
    let steps = ((shaft / TAU * BEND).ceil() as usize).max(1);
    let turns: Vec<f64> = (0..=steps).map(|k| shaft * k as f64 / steps as f64).collect();
    let middles: Vec<DVec3> = turns.iter().map(|&t| at(t)).collect();
    let ways: Vec<DVec3> = turns.iter().map(|&t| way(t)).collect();
    let tip = at(shaft) + way(shaft + head / 2.0) * radius * HEAD_LENGTH;
    Some(lathe(&middles, &ways, radius, (tip, way(shaft + head / 2.0))))
}

/// The signs of a velocity `translation + rotation x (p - at)`: a straight arrow and a turning one, together as long as
/// `length` for the faster part of the motion; a part of it too small to see gets no sign.
pub fn motion(at: DVec3, translation: DVec3, rotation: DVec3, length: f64) -> Vec<Solid> {
    // A turn is as fast as it moves points half a length away.
    let (go, turn) = (translation.length(), rotation.length() * length / 2.0);
    let most = go.max(turn);
    let share = |speed: f64| if speed > most * LEAST_SHOWN { speed / most } else { 0.0 };
    let radius = length * SHAFT;
    let straight = arrow(at, at + translation.normalize_or_zero() * length * share(go), radius);
    let bent = turning_arrow(at, rotation, length * BOW, share(turn) * LARGEST_TURN, radius);
    straight.into_iter().chain(bent).collect()
}

/// Share of the faster of two speeds below which the slower is not shown.
const LEAST_SHOWN: f64 = 0.05;
/// Radii of shaft and bow in lengths of the sign, and the turn, in radians, that the fastest rotation is drawn with.
const SHAFT: f64 = 0.03;
const BOW: f64 = 0.35;
const LARGEST_TURN: f64 = 4.5;

/// A tube through `middles`, square to `ways`, with a flat tail and a conical head that ends in `tip`.
fn lathe(middles: &[DVec3], ways: &[DVec3], radius: f64, (tip, head): (DVec3, DVec3)) -> Solid {
    let mut rings: Vec<Vec<DVec3>> =
        middles.iter().zip(ways).map(|(&m, &w)| ring(m, w, ways[0], radius)).collect();
    let neck = middles[middles.len() - 1];
    rings.push(ring(neck, head, ways[0], radius * HEAD_RADIUS));
    let mut vertices = rings.concat();
    vertices.push(tip);
    let (last, top) = (rings.len() - 1, (rings.len() * ROUND) as u32);
    let at = |r: usize, k: usize| (r * ROUND + k % ROUND) as u32;
    let mut faces: Vec<Vec<u32>> = vec![(0..ROUND).rev().map(|k| at(0, k)).collect()];
    for k in 0..ROUND {
        for r in 0..last {
            faces.push(vec![at(r, k), at(r, k + 1), at(r + 1, k + 1)]);
            faces.push(vec![at(r, k), at(r + 1, k + 1), at(r + 1, k)]);
        }
        faces.push(vec![at(last, k), at(last, k + 1), top]);
    }
    let facets = faces.into_iter().filter_map(|f| facet(&vertices, f)).collect();
    Solid { vertices, facets, ..Solid::default() }
}

/// Points around `way`, all rings starting on the side that `first` fixes.
fn ring(middle: DVec3, way: DVec3, first: DVec3, radius: f64) -> Vec<DVec3> {
    let u = first.any_orthonormal_vector();
    let v = way.cross(u).normalize_or(first.cross(u));
    let u = v.cross(way);
    (0..ROUND)
        .map(|k| {
            let (s, c) = (TAU * k as f64 / ROUND as f64).sin_cos();
            middle + (u * c + v * s) * radius
        })
        .collect()
}

fn facet(vertices: &[DVec3], corners: Vec<u32>) -> Option<Facet> {
    let at = |k: usize| vertices[corners[k] as usize];
    let normal = (at(1) - at(0)).cross(at(2) - at(0)).try_normalize()?;
    Some(Facet { corners, normal })
}
