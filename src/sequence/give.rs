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
use crate::blocking::Touch;
use crate::blocking::shadow::{Outline, View};
use crate::blocking::sweep::{meetings, near};
use crate::watch::All;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Ways out that are tried for each part, spread evenly over the sphere (spiral of the golden angle).
const WAYS: usize = 200;

/// Of the order in which they are tried: about their number over the golden ratio, with no common divisor.
const STRIDE: usize = 123;

/// The contacts' own and the axes' among them.
const FIRST_WAYS: usize = 12;

/// Pairs of cells, of parts whose boxes meet along a way, that are looked at over all ways, some seconds: ways of large
/// sets on which there are too many are left out.
const MOST_LOOKS: usize = 100_000_000;

/// Directions across a way in which a part may give, evenly around.
const ACROSS: usize = 32;

/// Parts that are tried along the spiral: those of the least strain along the first ways.
const MOST_ASKED: usize = 24;

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
    let free: Vec<PartIx> = set.iter().copied().filter(|&p| !field.is_held(p)).collect();
    let _stage = field.watch.stage("which part could give", "", All::Open);
    let views = ways(field, set);
    let (first, more) = views.split_at(views.len().min(FIRST_WAYS));
    let of = |p: &PartIx| (*p, nearest_first(field, *p, set), None);
    let mut found: Vec<Asked> = free.par_iter().map(of).map(|o| better(field, first, o)).collect();
    found.sort_by(|(p, _, a), (q, _, b)| strain(a).total_cmp(&strain(b)).then(p.cmp(q)));
    found.truncate(MOST_ASKED);
    let mut all: Vec<Giving> = found.into_par_iter().filter_map(|o| better(field, more, o).2).collect();
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

/// The normals of the set's contacts, what slides along two of them, the axes, and a spiral over the sphere, in an order in
/// which the first so many of it are spread about evenly; without those that there is no work left for.
fn ways<'f>(field: &'f Field, set: &Set) -> Vec<View<'f>> {
    let golden = std::f64::consts::PI * (3.0 - 5.0f64.sqrt());
    let spiral = |k: usize| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / WAYS as f64;
        let (sin, cos) = (golden * k as f64).sin_cos();
        DVec3::new(cos * (1.0 - z * z).sqrt(), sin * (1.0 - z * z).sqrt(), z)
    };
    let frame = super::journey::frame(field.patches, set).into_iter();
    let axes = DVec3::AXES.into_iter().chain(DVec3::AXES.map(|d| -d));
    let all: Vec<DVec3> = frame.chain(axes).chain((0..WAYS).map(|k| spiral(k * STRIDE % WAYS))).collect();
    let seen = |d: &DVec3| {
        let view = View::new(&field.shapes, *d);
        (looks(&view, set, field.touch), view)
    };
    let mut left = MOST_LOOKS;
    let fits = |(looks, view): (usize, View<'f>)| {
        left = left.checked_sub(looks)?;
        Some(view)
    };
    let seen: Vec<_> = all.par_iter().map(seen).collect();
    seen.into_iter().filter_map(fits).collect()
}

/// Pairs of cells of different parts of the set whose boxes meet when either moves along the view.
fn looks(view: &View, set: &Set, touch: Touch) -> usize {
    let cells = |p: PartIx| view.part(p).0.spans.len();
    let pairs = set.iter().flat_map(|&i| set.iter().map(move |&j| (i, j)));
    let meet = pairs.filter(|&(i, j)| i != j && near(view, i, j, touch));
    meet.map(|(i, j)| cells(i) * cells(j)).sum()
}

/// A part, the others of its set, and the least that it was found to do.
type Asked = (PartIx, Vec<PartIx>, Option<Giving>);

fn strain(least: &Option<Giving>) -> f64 {
    least.as_ref().map_or(f64::INFINITY, |g| g.strain)
}

/// The same after these ways, too.
fn better(field: &Field, views: &[View], (p, others, least): Asked) -> Asked {
    let one =
        |least: Option<Giving>, view: &View| giving(field, view, (p, &others), strain(&least)).or(least);
    let least = views.iter().fold(least, one);
    (p, others, least)
}

/// The others of the set: what is near is most in the way.
fn nearest_first(field: &Field, p: PartIx, set: &Set) -> Vec<PartIx> {
    let centre = |p| field.asm.centre(p);
    let mut others: Vec<PartIx> = set.iter().copied().filter(|j| *j != p).collect();
    let far = |j: PartIx| centre(j).distance_squared(centre(p));
    others.sort_by(|&a, &b| far(a).total_cmp(&far(b)).then(a.cmp(&b)));
    others
}

/// What the part would have to do on this way; None where that is no less strain than the bound.
fn giving(field: &Field, view: &View, (p, others): (PartIx, &[PartIx]), bound: f64) -> Option<Giving> {
    let (mut past, mut strain) = (Vec::new(), 0.0f64);
    for &j in others {
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        let _ = meetings(view, p, j, field.touch, |m| {
            pairs.push((m.a, m.b));
            None::<()>
        });
        if let Some((depth, width)) = least_depth(view, (p, j), &pairs) {
            past.push((j, depth));
            strain = strain.max(depth / width);
            if strain >= bound {
                return None;
            }
        }
    }
    past.sort_by_key(|(j, _)| *j);
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
