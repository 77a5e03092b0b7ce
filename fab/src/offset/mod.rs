//! Takes shapes in place, which facets are contact, and a depth; gives meshes with those facets moved inward.
//!
//! Sound: every triangle of a facet lies at least the depth below that facet's plane, and never above the plane of a
//! kept one. First order: where facets bend by an angle t it lies up to about depth * t * t / 2 deeper. Not complete:
//! shapes exist that it can not offset; it then says where, and the caller writes nothing.
//!
//! Where the whole of it fails, `carve` is the fallback of the caller.
//!
//! The steps: `body` moves corners, `weld` takes out edges too short to matter, `split` parts corners that have no one
//! place, `settle` collapses what turned over, `relief` parts bodies that are still nearer than the fit.
//!
//! Designs that lost. *Planes intersected anew* (each corner where its three planes meet): at four or more facets the
//! planes miss each other, and short edges turn over. *Uniting coplanar facets first*: not needed, equal planes bind a
//! corner like one plane, and it would give polygons with holes. *Collapsing only what turned over, keeping the planes
//! of vanished facets*: facets of a micrometre point anywhere, and their planes pushed corners by up to 6.5 mm.
//! *Choosing the collapse that leaves the fewest turned triangles*: it likes long edges, and lost whole ridges.

pub mod body;
pub mod carve;
pub mod least;
pub mod relief;
pub mod settle;
pub mod split;
pub mod weld;

use crate::mesh::Mesh;
use crate::shape::{Job, Role};
use body::Body;
use glam::DVec3;
use rayon::prelude::*;
use settle::Settled;
use std::collections::BTreeMap;

/// What the move of a part is to reach, all in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// How far contact facets go inward.
    pub depth: f64,
    /// The part's share of the fit: bodies nearer than the sum of theirs are parted to the sum of their depths; a
    /// little less than those, or round-off would be chased.
    pub share: f64,
    /// Least altitude of a triangle of the result.
    pub thinnest: f64,
    /// Edges shorter than this are united before the move.
    pub weld: f64,
}

/// A part with its contact facets moved inward, in place.
#[derive(Clone, Debug)]
pub struct Offset {
    pub mesh: Mesh,
    pub collapses: usize,
    /// The longest way that a corner went, in mm.
    pub longest_move: f64,
    /// The first part of the job with the same solid, up to its pose; itself where there is none before it.
    pub same_as: usize,
    /// Places where the move failed; empty for a usable mesh.
    pub failures: Vec<Failure>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    pub at: DVec3,
    pub why: Why,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// No point lies deep enough under all facets that meet here: they face each other.
    NoRoom,
    /// A triangle stays turned over.
    TurnedOver,
    /// Nothing is left of the solid.
    Vanished,
}

/// Edges shorter than this part of the depth are united before the move: for 0.2 mm that is 4 micrometres, a tenth of
/// the finest step that the printers at hand can make. What it costs in clearance, `relief` finds and mends.
pub const REACH: f64 = 0.02;

/// Moves the contact facets of every part inward and parts the bodies to their fits. Parts with the same shape, contact
/// facets and aim are moved once.
pub fn offset(job: &Job, aims: &[Aim]) -> Vec<Offset> {
    let key = |p: usize| {
        let contact: Vec<bool> = job.parts[p].roles.iter().map(|r| *r != Role::Outer).collect();
        (job.parts[p].shape, contact, [aims[p].depth, aims[p].weld].map(f64::to_bits))
    };
    let mut first: BTreeMap<_, usize> = BTreeMap::new();
    let same_as: Vec<usize> = (0..job.parts.len()).map(|p| *first.entry(key(p)).or_insert(p)).collect();
    let moved: BTreeMap<usize, (Body, Settled)> =
        first.par_iter().map(|((s, c, _), &p)| (p, moved_body(job, *s, c, &aims[p]))).collect();
    let mut bodies: Vec<Body> =
        same_as.iter().zip(&job.parts).map(|(first, part)| moved[first].0.posed(&part.pose)).collect();
    let relieved = relief::relieve(&mut bodies, aims);
    let result = |p: usize| {
        let shared = if relieved[p].is_none() && relieved[same_as[p]].is_none() { same_as[p] } else { p };
        finish(&bodies[p], &moved[&same_as[p]].1, relieved[p].as_ref(), shared)
    };
    (0..job.parts.len()).into_par_iter().map(result).collect()
}

fn moved_body(job: &Job, shape: usize, contact: &[bool], aim: &Aim) -> (Body, Settled) {
    let mut body = Body::new(&job.shapes[shape], contact, aim.depth);
    weld::weld(&mut body, aim.weld);
    split::split(&mut body);
    let settled = settle::settle(&mut body, aim.thinnest);
    (body, settled)
}

fn finish(body: &Body, settled: &Settled, relieved: Option<&Settled>, same_as: usize) -> Offset {
    let last = relieved.unwrap_or(settled);
    let live: Vec<&body::Corner> =
        body.corners.iter().zip(&body.star).filter(|(_, s)| !s.is_empty()).map(|(c, _)| c).collect();
    let no_room = live.iter().filter(|c| !c.placed).map(|c| Failure { at: c.anchor, why: Why::NoRoom });
    let turned = last.unsettled.iter().map(|&at| Failure { at, why: Why::TurnedOver });
    let mut failures: Vec<Failure> = no_room.chain(turned).collect();
    let (mesh, _) = body.mesh();
    if mesh.volume() <= 0.0 {
        let at = live.iter().map(|c| c.anchor).sum::<DVec3>() / live.len().max(1) as f64;
        failures.push(Failure { at, why: Why::Vanished });
    }
    let longest_move = live.iter().map(|c| c.at.distance(c.anchor)).fold(0.0, f64::max);
    let collapses = settled.collapses + relieved.map_or(0, |r| r.collapses);
    Offset { mesh, collapses, longest_move, same_as, failures }
}
