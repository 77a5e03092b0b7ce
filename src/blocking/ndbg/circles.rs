//! Takes normals of planes through the origin, gives great circles by number: normals that agree up to sign and
//! the [`Resolution`] name the same circle, so that later stages compare numbers and not angles.
//!
//! Not promised: an order free choice among chains of normals, each within the resolution of the next; the first one met
//! stands for those near it.

use crate::blocking::SAME_ANGLE;
use crate::contact::Slack;
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Number of a great circle.
pub type Circle = usize;

/// How near to one another critical directions must be to count as one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    plane: f64,
}

impl Resolution {
    /// What round-off leaves of a normal, radians: coordinates are known to about 2^-40 of a crossing and facets are
    /// 2^-12 and more across, so 2^-28.
    pub const FINEST: Resolution = Resolution { plane: 1.0 / (1u64 << 28) as f64 };

    /// [`SAME_ANGLE`]: what is nearer than that ends less than the touch away (see `blocking`).
    pub const COARSEST: Resolution = Resolution { plane: SAME_ANGLE };

    /// Twice what the digits of the file leave open of the normals (two of them are compared), between the finest and
    /// the coarsest; contacts too small to tell a normal do not count.
    pub fn of(slack: &[Slack]) -> Resolution {
        let told =
            slack.iter().map(|s| s.angle).filter(|&a| a < FRAC_PI_2).map(|a| (2.0 * a).min(SAME_ANGLE));
        Resolution { plane: told.fold(Resolution::FINEST.plane, f64::max) }
    }

    /// Radians between two planes that count as one.
    pub fn plane(self) -> f64 {
        self.plane
    }

    /// Radians between two directions that count as one: each lies within [`Resolution::plane`] of two planes, so
    /// within four times that of where they cross, unless they are nearly parallel.
    pub fn near(self) -> f64 {
        4.0 * self.plane
    }
}

/// Numbers points of the unit sphere, those within `near` of one that is known by its number.
#[derive(Clone, Debug)]
pub struct Points {
    near: f64,
    known: Vec<DVec3>,
    boxes: BTreeMap<[i64; 3], Vec<usize>>,
    /// The farthest that a point was from the one that it was counted as, radians.
    widest: f64,
}

impl Points {
    pub fn new(near: f64) -> Points {
        Points { near, known: Vec::new(), boxes: BTreeMap::new(), widest: 0.0 }
    }

    pub fn all(&self) -> &[DVec3] {
        &self.known
    }

    /// The nearest known point within reach, the first among equals.
    pub fn find(&self, p: DVec3) -> Option<usize> {
        let home = self.home(p);
        let around = (0..27).map(|k| [home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1]);
        let near = around.filter_map(|b| self.boxes.get(&b)).flatten().copied();
        near.map(|k| (self.known[k].distance(p), k))
            .filter(|(r, _)| *r <= self.near)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .map(|(_, k)| k)
    }

    pub fn number(&mut self, p: DVec3) -> usize {
        if let Some(k) = self.find(p) {
            self.widest = self.widest.max(self.known[k].distance(p));
            return k;
        }
        let home = self.home(p);
        self.known.push(p);
        self.boxes.entry(home).or_default().push(self.known.len() - 1);
        self.known.len() - 1
    }

    pub fn widest(&self) -> f64 {
        self.widest
    }

    pub fn add(&mut self, p: DVec3) {
        let _ = self.number(p);
    }

    /// Boxes as wide as the reach: whatever is near lies in one of the 27 around.
    fn home(&self, p: DVec3) -> [i64; 3] {
        (p / self.near).floor().to_array().map(|c| c as i64)
    }
}

/// Great circles by number.
#[derive(Clone, Debug)]
pub struct Circles(Points, Resolution);

impl Circles {
    pub fn new(resolution: Resolution) -> Circles {
        Circles(Points::new(resolution.plane()), resolution)
    }

    pub fn resolution(&self) -> Resolution {
        self.1
    }

    pub fn count(&self) -> usize {
        self.0.known.len()
    }

    pub fn normal(&self, c: Circle) -> DVec3 {
        self.0.known[c]
    }

    /// The number of the circle across the unit vector `n`.
    pub fn number(&mut self, n: DVec3) -> Circle {
        match self.0.find(-n) {
            Some(_) if self.0.find(n).is_none() => self.0.number(-n),
            _ => self.0.number(n),
        }
    }

    /// The widest angle between two planes that were counted as one, radians.
    pub fn widest(&self) -> f64 {
        self.0.widest()
    }

    pub fn find(&self, n: DVec3) -> Option<Circle> {
        self.0.find(n).or_else(|| self.0.find(-n))
    }

    /// Where angles are counted from, and the quarter turn after it, counter-clockwise seen from the normal's tip.
    pub fn frame(&self, c: Circle) -> (DVec3, DVec3) {
        let n = self.normal(c);
        let u = n.any_orthonormal_vector();
        (u, n.cross(u))
    }

    /// In [0, 2 pi).
    pub fn angle(&self, c: Circle, d: DVec3) -> f64 {
        let (u, v) = self.frame(c);
        let a = d.dot(v).atan2(d.dot(u)).rem_euclid(TAU);
        if a < TAU { a } else { 0.0 }
    }

    pub fn at(&self, c: Circle, angle: f64) -> DVec3 {
        let (u, v) = self.frame(c);
        u * angle.cos() + v * angle.sin()
    }
}

/// Closed intervals of angles on a circle, apart from one another, in [0, 2 pi], rising.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spans(Vec<(f64, f64)>);

impl Spans {
    pub fn full() -> Spans {
        Spans(vec![(0.0, TAU)])
    }

    /// From pieces `(from, to)`, `from` in [0, 2 pi), `to` at most a turn after it.
    pub fn of(pieces: impl IntoIterator<Item = (f64, f64)>, near: f64) -> Spans {
        let parts = pieces
            .into_iter()
            .flat_map(|(a, b)| if b <= TAU { vec![(a, b)] } else { vec![(a, TAU), (0.0, b - TAU)] });
        let mut parts: Vec<(f64, f64)> = parts.collect();
        parts.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.total_cmp(&y.1)));
        let mut out: Vec<(f64, f64)> = Vec::new();
        for (a, b) in parts {
            match out.last_mut() {
                Some(last) if a <= last.1 + near => last.1 = last.1.max(b),
                _ => out.push((a, b)),
            }
        }
        Spans(out)
    }

    pub fn all(&self) -> &[(f64, f64)] {
        &self.0
    }

    /// Whether an angle in [0, 2 pi) lies in one of them, or no farther than `near` beside.
    pub fn holds(&self, angle: f64, near: f64) -> bool {
        let inside = |t: f64| self.0.iter().any(|&(a, b)| a - near <= t && t <= b + near);
        inside(angle) || inside(angle + TAU) || inside(angle - TAU)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_number_for_a_plane_whichever_way_it_faces() {
        let mut circles = Circles::new(Resolution::COARSEST);
        let n = DVec3::new(0.6, 0.0, 0.8);
        let first = circles.number(n);
        assert_eq!(circles.number(-n), first);
        assert_eq!(circles.number((n + DVec3::Y * 1e-9).normalize()), first);
        assert_ne!(circles.number((n + DVec3::Y * 1e-3).normalize()), first);
        let d = circles.at(first, 1.25);
        assert!(d.dot(n).abs() < 1e-15 && (circles.angle(first, d) - 1.25).abs() < 1e-15);
    }

    #[test]
    fn spans_join_where_they_touch_and_pass_the_angle_zero() {
        let spans = Spans::of([(6.0, TAU + 0.5), (0.5, 1.0), (2.0, 3.0)], 1e-9);
        assert_eq!(spans.all(), [(0.0, 1.0), (2.0, 3.0), (6.0, TAU)]);
        assert!(spans.holds(6.2, 0.0) && spans.holds(0.0, 0.0) && !spans.holds(1.5, 0.0));
    }
}
