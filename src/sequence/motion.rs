//! The motion of a step as it is written down, and where it takes a part after a share of it. Nothing here decides
//! anything: lengths are in model units, points and directions in world coordinates, angles in radians.
//!
//! A motion runs from 0 to 1 in one parameter that drives all that moves; shifts, angles and advances are in proportion
//! to it.

use glam::{DAffine3, DMat3, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the parts of a step do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Motion {
    /// All along one straight line.
    Translation(Shift),
    /// All about one axis, advancing along it.
    Screw(Screw),
    /// Several motions at once, each of its own parts.
    Several {
        /// Their parts are disjoint and, together, those of the step.
        motions: Vec<Mover>,
    },
}

/// A straight move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Shift {
    /// Unit vector.
    pub direction: [f64; 3],
    /// Model units.
    pub distance: f64,
    pub distance_mm: f64,
}

/// A turn about an axis with an advance along it; both may be negative, not both zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Screw {
    /// A point of the axis.
    pub point: [f64; 3],
    /// Unit vector along the axis.
    pub axis: [f64; 3],
    /// Radians, right-handed about the axis; may exceed a full turn.
    pub angle: f64,
    /// Model units along the axis.
    pub advance: f64,
    pub advance_mm: f64,
}

/// One of several motions at once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Mover {
    /// Ids of the parts that move so.
    pub parts: Vec<String>,
    #[serde(flatten)]
    pub motion: Rigid,
}

/// The motion of parts that move as one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Rigid {
    Translation(Shift),
    Screw(Screw),
}

/// How a step ends. Places are told as follows: after `inside` the parts are where the motion took them; after `apart` all
/// that is told later is told as from before that step, as if the sets had been taken apart in place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Ends {
    /// What moved is clear of what stayed (of several motions, each also of the others): from here on they are sets
    /// of their own, planned in turn.
    #[default]
    Apart,
    /// What moved is still in its set: later steps start from where it is now.
    Inside,
}

impl Shift {
    pub fn new(direction: DVec3, distance: f64, mm_per_unit: f64) -> Shift {
        Shift { direction: direction.to_array(), distance, distance_mm: distance * mm_per_unit }
    }

    /// The whole way, model units.
    pub fn way(&self) -> DVec3 {
        DVec3::from_array(self.direction) * self.distance
    }
}

impl Screw {
    /// The pose after a share `s` of the motion.
    pub fn at(&self, s: f64) -> DAffine3 {
        let (point, axis) = (DVec3::from_array(self.point), DVec3::from_array(self.axis));
        let turn = DMat3::from_axis_angle(axis, self.angle * s);
        DAffine3::from_mat3_translation(turn, point - turn * point + axis * (self.advance * s))
    }
}

impl Rigid {
    /// The pose after a share `s` of the motion.
    pub fn at(&self, s: f64) -> DAffine3 {
        match self {
            Rigid::Translation(shift) => DAffine3::from_translation(shift.way() * s),
            Rigid::Screw(screw) => screw.at(s),
        }
    }
}

impl Motion {
    /// Who moves how: the parts of each motion (`parts` for a single one).
    pub fn movers<'s>(&'s self, parts: &'s [String]) -> Vec<(&'s [String], Rigid)> {
        match self {
            Motion::Translation(shift) => vec![(parts, Rigid::Translation(*shift))],
            Motion::Screw(screw) => vec![(parts, Rigid::Screw(*screw))],
            Motion::Several { motions } => motions.iter().map(|m| (m.parts.as_slice(), m.motion)).collect(),
        }
    }

    /// The straight move, if it is one.
    pub fn straight(&self) -> Option<&Shift> {
        match self {
            Motion::Translation(shift) => Some(shift),
            _ => None,
        }
    }
}
