//! Takes a set of parts proven locked, gives the part that could be the flexible one: how deep it must give way on the
//! straight way out that asks least of it, past whom, and the strain that this means for silicone.
//!
//! An estimate for choosing, no proof: ways are sampled, and the depth is how far the part, or what it passes, would
//! have to shift sideways as a whole to pass (enough, so an upper bound for its way; a part that bends needs no more).
//! Strain is depth over the width of the cells that must give, across the way and in the direction of giving: the mean
//! strain if the part alone is squeezed by the depth, not a finite element result.

use super::field::{Field, Set};
use super::{Motions, Outcome, plan_watched};
use crate::assembly::PartIx;
use crate::blocking::shadow::{Outline, View};
use crate::blocking::sweep::meetings;
use crate::watch::All;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Ways out that are tried for each part, spread evenly over the sphere (spiral of the golden angle).
const WAYS: usize = 200;

/// Pairs of cells that are looked at over all ways, about two seconds: large sets are tried along fewer ways, and not at
/// all where there are too many for the contacts' own.
const MOST_LOOKS: usize = 100_000_000;

/// Directions across a way in which a part may give, evenly around.
const ACROSS: usize = 32;

/// Parts of a set, beyond which nothing is estimated: each is tried against each other on every way.
const MOST_PARTS: usize = 24;

/// Parts, those of the least strain first, without which the rest is planned: each plan takes as long as that of the set.
const MOST_RESTS: usize = 3;

/// What a part would have to do.
#[derive(Clone, Debug)]
pub struct Giving {
    pub part: PartIx,
    /// Unit vector of the way out.
    pub along: DVec3,
    /// Past whom, and how deep, model units.
    pub past: Vec<(PartIx, f64)>,
    /// Depth over width at the worst place.
    pub strain: f64,
    /// What a straight plan makes of the set without the part.
    pub rest: Outcome,
}

/// Of the few parts of the least strain the first without which the set comes apart; else the one of the least strain.
pub fn give(field: &Field, set: &Set) -> Option<Giving> {
    if set.len() > MOST_PARTS {
        return None;
    }
    let free: Vec<PartIx> = set.iter().copied().filter(|&p| !field.is_held(p)).collect();
    let _stage = field.watch.stage("which part could give", "", All::Open);
    let views: Vec<View> = ways(field, set).into_iter().map(|d| View::new(&field.shapes, d)).collect();
    let best = |&p: &PartIx| {
        let all = views.iter().filter_map(|view| giving(field, view, p, set));
        all.reduce(|a, b| if b.strain < a.strain { b } else { a })
    };
    let mut all: Vec<Giving> = free.par_iter().filter_map(best).collect();
    all.sort_by(|a, b| a.strain.total_cmp(&b.strain).then(a.part.cmp(&b.part)));
    for g in all.iter_mut().take(MOST_RESTS) {
        let watch = field.watch.unseen();
        let rest: Vec<PartIx> = set.iter().copied().filter(|q| *q != g.part).collect();
        g.rest = plan_watched(field.asm, &rest, field.patches, Motions::Straight, &watch, |_| None::<()>)
            .map_or(Outcome::NotFound, |p| p.outcome);
        if g.rest == Outcome::Assembled {
            return Some(g.clone());
        }
    }
    all.into_iter().next()
}

/// The normals of the set's contacts, what slides along two of them, and a spiral over the sphere.
fn ways(field: &Field, set: &Set) -> Vec<DVec3> {
    let golden = std::f64::consts::PI * (3.0 - 5.0f64.sqrt());
    let spiral = (0..WAYS).map(|k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / WAYS as f64;
        let (sin, cos) = (golden * k as f64).sin_cos();
        DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z)
    });
    let first: Vec<DVec3> = super::journey::frame(field.patches, set)
        .into_iter()
        .chain(DVec3::AXES)
        .chain(DVec3::AXES.map(|d| -d))
        .collect();
    let most = MOST_LOOKS / looks(field, set).max(1);
    if most < first.len() {
        return Vec::new();
    }
    // Every so many of the spiral, so that few are spread as evenly as all.
    let every = WAYS.div_ceil((most - first.len()).max(1));
    first.into_iter().chain(spiral.step_by(every)).take(most).collect()
}

/// Pairs of cells of different parts of the set.
fn looks(field: &Field, set: &Set) -> usize {
    let cells: Vec<usize> = set.iter().map(|&p| field.asm.solid(p).cells.len()).collect();
    let all: usize = cells.iter().sum();
    cells.iter().map(|c| c * (all - c)).sum()
}

fn giving(field: &Field, view: &View, p: PartIx, set: &Set) -> Option<Giving> {
    let (mut past, mut strain) = (Vec::new(), 0.0f64);
    for &j in set.iter().filter(|j| **j != p) {
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        let _ = meetings(view, p, j, field.touch, |m| {
            pairs.push((m.a, m.b));
            None::<()>
        });
        if let Some((depth, width)) = least_depth(view, (p, j), &pairs) {
            past.push((j, depth));
            strain = strain.max(depth / width);
        }
    }
    // Nothing in the way would be a straight move, which a locked set has not.
    (!past.is_empty()).then_some(Giving { part: p, along: view.d, past, strain, rest: Outcome::NotFound })
}

/// The least shift across the way that lets all pairs of cells pass, and the least width, that way, of the moving cells
/// that must give.
fn least_depth(view: &View, (p, j): (PartIx, PartIx), pairs: &[(usize, usize)]) -> Option<(f64, f64)> {
    let at = (view.part(j).1 - view.part(p).1).truncate();
    let span = |o: &Outline, e: DVec2| {
        o.corners
            .iter()
            .map(|c| e.dot(*c))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)))
    };
    let toward = |k: usize| {
        let e = DVec2::from_angle(std::f64::consts::TAU * k as f64 / ACROSS as f64);
        pairs.iter().fold((0.0f64, f64::INFINITY), |(depth, width), &(a, b)| {
            let ((lo, hi), (other, _)) = (span(view.outline(p, a), e), span(view.outline(j, b), e));
            (depth.max(hi - other - e.dot(at)), width.min(hi - lo))
        })
    };
    let best = (0..ACROSS).map(toward).min_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
    best.filter(|_| !pairs.is_empty())
}
