//! Takes a shape, which of its facets are contact, and a depth; gives the mesh with those facets moved inward.
//!
//! Sound: every triangle of the result lies at least `depth` below the plane of the facet it came from, and never above
//! the plane of a kept one. First order: where facets bend by an angle t it lies up to about depth * t * t / 2 deeper.
//! Not complete: shapes exist that it can not offset; it then says where, and the caller writes nothing.
//!
//! Designs that lost. *Planes intersected anew* (each corner is where its three planes meet): at four or more facets
//! the planes miss each other, and short edges turn over. *Uniting coplanar facets first*: not needed, equal planes
//! bind a corner like one plane, and it would give polygons with holes. *Uniting short edges first*: a length below
//! which an edge is short has no derivation; turned-over triangles say by themselves which edges have to go.

pub mod body;
pub mod least;
pub mod settle;
pub mod weld;

use crate::mesh::Mesh;
use crate::shape::Shape;
use body::Body;
use glam::DVec3;

/// A shape with its contact facets moved inward.
#[derive(Clone, Debug)]
pub struct Offset {
    pub mesh: Mesh,
    pub collapses: usize,
    /// The longest way that a corner went, in mm.
    pub longest_move: f64,
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
/// the finest step that the printers at hand can make. What it costs in clearance is found and mended by `relief`.
const REACH: f64 = 0.02;

/// Moves contact facets inward by `depth` mm. `thinnest`: least altitude of a triangle of the result, in mm.
pub fn offset(shape: &Shape, contact: &[bool], depth: f64, thinnest: f64) -> Offset {
    let mut body = Body::new(shape, contact, depth);
    weld::weld(&mut body, depth * REACH);
    let settled = settle::settle(&mut body, thinnest);
    let live = |c: usize| !body.star[c].is_empty();
    let no_room = (0..body.corners.len()).filter(|&c| live(c) && !body.corners[c].placed);
    let mut failures: Vec<Failure> =
        no_room.map(|c| Failure { at: body.corners[c].anchor, why: Why::NoRoom }).collect();
    failures.extend(settled.unsettled.iter().map(|&at| Failure { at, why: Why::TurnedOver }));
    let mesh = body.mesh();
    if mesh.volume() <= 0.0 {
        failures.push(Failure { at: shape.bounds().0.midpoint(shape.bounds().1), why: Why::Vanished });
    }
    let longest_move = (0..body.corners.len())
        .filter(|&c| live(c))
        .map(|c| body.corners[c].at.distance(body.corners[c].anchor))
        .fold(0.0, f64::max);
    Offset { mesh, collapses: settled.collapses, longest_move, failures }
}
