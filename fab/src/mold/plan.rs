//! Takes nothing; gives where keys, channels and screws of a mold stand, for geometry and OpenSCAD alike.

use glam::{DVec2, DVec3};
use serde::Serialize;

/// An upright channel: a frustum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Channel {
    pub foot: DVec3,
    pub height: f64,
    /// Diameters, mm.
    pub below: f64,
    pub above: f64,
}

/// A cone that stands on the parting surface, and the socket around it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Key {
    pub at: DVec3,
}

/// What a mold is made of besides the part.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Plan {
    pub low: DVec3,
    pub high: DVec3,
    pub parting: f64,
    pub keys: Vec<Key>,
    pub sprues: Vec<Channel>,
    pub vents: Vec<Channel>,
    pub bolts: Vec<DVec2>,
    /// Boxes, low and high corner.
    pub slots: Vec<(DVec3, DVec3)>,
}
