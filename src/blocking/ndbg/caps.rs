//! Takes cells, cones and sides, gives caps of the sphere of directions around them, for quick refusals: what is not in
//! a cap is in nothing that the cap is around.

use crate::blocking::shadow::Convex;
use crate::blocking::{SAME_ANGLE, bounds};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// A ball around a cell.
pub struct Ball {
    middle: DVec3,
    radius: f64,
}

impl Ball {
    pub fn around(cell: &Convex) -> Ball {
        let (lo, hi) = bounds(cell.vertices.iter().copied());
        let middle = (lo + hi) / 2.0;
        let radius = cell.vertices.iter().map(|v| v.distance(middle)).fold(0.0, f64::max);
        Ball { middle, radius }
    }

    /// A cap of the sphere that holds every direction along which this ball meets the other, moved by `step`.
    pub fn toward(&self, other: &Ball, step: DVec3) -> Cap {
        let way = other.middle + step - self.middle;
        let sine = (self.radius + other.radius) / way.length();
        let angle = if sine < 1.0 { sine.asin() } else { PI };
        Cap::new(way.normalize_or(DVec3::Z), angle)
    }
}

/// The directions within an angle of a middle.
#[derive(Clone, Copy, Debug)]
pub struct Cap {
    middle: DVec3,
    /// Radians, at most pi.
    pub angle: f64,
    sine: f64,
    cosine: f64,
}

impl Cap {
    pub fn new(middle: DVec3, angle: f64) -> Cap {
        let (sine, cosine) = angle.sin_cos();
        Cap { middle, angle, sine, cosine }
    }

    /// Around a convex set of directions with these corners. Beyond a quarter turn a cap is not convex, so the whole
    /// sphere is taken.
    pub fn reaching(middle: DVec3, corners: &[DVec3]) -> Cap {
        let angle = corners.iter().map(|c| c.angle_between(middle)).fold(0.0, f64::max);
        Cap::new(middle, if angle > FRAC_PI_2 + SAME_ANGLE { PI } else { angle })
    }

    /// False only for a direction outside.
    pub fn may_hold(&self, d: DVec3) -> bool {
        self.middle.dot(d) >= self.cosine - SAME_ANGLE
    }

    /// Whether two caps may have a direction in common: never wrong when it says no.
    pub fn meets(&self, other: &Cap) -> bool {
        let cosine_of_both = self.cosine * other.cosine - self.sine * other.sine;
        let a_half_turn_together = self.cosine <= -other.cosine;
        a_half_turn_together || self.middle.dot(other.middle) >= cosine_of_both - SAME_ANGLE
    }
}
