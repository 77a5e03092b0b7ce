//! Takes rigid motions that run from 0 to 1 and a plane fixed to one of two bodies, gives a lower bound on how far a
//! point of the other keeps from it over a stretch of the motion: no sampling.
//!
//! Exact up to round-off where the plane's body does not turn, or the other body stands still: the distance is then
//! A + B cos + C sin + D s, whose least value is at an end or where its derivative is zero. Else a bound from the second
//! derivative, which shrinks with the square of the stretch. Sound in both cases.

use glam::{DAffine3, DMat3, DVec3};

/// x goes to centre + R(axis, angle s)(x - centre) + s slide. A turning path slides along its axis only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    pub centre: DVec3,
    pub axis: DVec3,
    /// Radians over the whole motion; 0 for a straight one.
    pub angle: f64,
    /// Model units over the whole motion.
    pub slide: DVec3,
}

/// A stretch of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    pub from: f64,
    pub to: f64,
}

impl Span {
    pub fn middle(self) -> f64 {
        (self.from + self.to) / 2.0
    }

    pub fn length(self) -> f64 {
        self.to - self.from
    }
}

impl Path {
    pub const STILL: Path = Path { centre: DVec3::ZERO, axis: DVec3::Z, angle: 0.0, slide: DVec3::ZERO };

    pub fn straight(slide: DVec3) -> Path {
        Path { slide, ..Path::STILL }
    }

    pub fn turns(&self) -> bool {
        self.angle != 0.0
    }

    /// The pose at `s`.
    pub fn at(&self, s: f64) -> DAffine3 {
        let turn = DMat3::from_axis_angle(self.axis, self.angle * s);
        DAffine3::from_mat3_translation(turn, self.centre - turn * self.centre + self.slide * s)
    }

    /// The same motion seen from the moving body; only for a path that turns or stands still.
    fn inverse(&self) -> Path {
        Path { angle: -self.angle, slide: -self.slide, ..*self }
    }

    /// Distance of a point from the axis.
    pub fn arm(&self, p: DVec3) -> f64 {
        (p - self.centre).reject_from_normalized(self.axis).length()
    }

    /// Farthest that a point with this arm leaves the chord between its places at the ends of a stretch: the second
    /// derivative is at most arm * angle^2.
    pub fn sagitta(&self, arm: f64, span: Span) -> f64 {
        arm * self.angle * self.angle * span.length() * span.length() / 8.0
    }
}

/// A plane fixed to a body, by a point of it and its unit normal, both where they are at 0.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    pub point: DVec3,
    pub normal: DVec3,
}

/// The least signed distance, over the stretch, of a point `p` (where it is at 0) that goes along `path` from a plane
/// that goes along `own`; never more than the truth.
pub fn least_height(plane: Plane, own: &Path, p: DVec3, path: &Path, span: Span) -> f64 {
    if !own.turns() {
        return wave(plane, p, path, path.slide - own.slide).least(span);
    }
    if *path == Path::STILL {
        let back = own.inverse();
        return wave(plane, p, &back, back.slide).least(span);
    }
    by_curvature(plane, own, p, path, span)
}

/// A + B cos(angle s) + C sin(angle s) + D s.
#[derive(Clone, Copy, Debug)]
struct Wave {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
    angle: f64,
}

fn wave(plane: Plane, p: DVec3, path: &Path, slide: DVec3) -> Wave {
    let (n, u, r) = (plane.normal, path.axis, p - path.centre);
    if !path.turns() {
        return Wave { a: n.dot(p - plane.point), b: 0.0, c: 0.0, d: n.dot(slide), angle: 0.0 };
    }
    let along = n.dot(u) * u.dot(r);
    Wave {
        a: n.dot(path.centre - plane.point) + along,
        b: n.dot(r) - along,
        c: n.dot(u.cross(r)),
        d: n.dot(slide),
        angle: path.angle,
    }
}

impl Wave {
    fn at(&self, s: f64) -> f64 {
        let (sin, cos) = (self.angle * s).sin_cos();
        self.a + self.b * cos + self.c * sin + self.d * s
    }

    fn least(&self, span: Span) -> f64 {
        let ends = self.at(span.from).min(self.at(span.to));
        let rate = self.b.hypot(self.c) * self.angle;
        let share = self.d / rate;
        if rate == 0.0 || share.abs() >= 1.0 {
            return ends;
        }
        // With b cos x + c sin x = r cos(x - phase), the derivative is zero where sin(x - phase) = d / (r angle); the
        // low ones are those where the cosine is negative, a full turn apart.
        let low = self.c.atan2(self.b) + std::f64::consts::PI - share.asin();
        let (x0, x1) = (self.angle * span.from, self.angle * span.to);
        let turn = std::f64::consts::TAU;
        let first = ((x0.min(x1) - low) / turn).ceil();
        let last = ((x0.max(x1) - low) / turn).floor();
        let mut least = ends;
        // The lows of a wave that falls steadily are lowest at one end.
        for k in [first, last] {
            if first <= last {
                least = least.min(self.at((low + turn * k) / self.angle));
            }
        }
        least
    }
}

/// min(f(from), f(to)) - max|f''| length^2 / 8, with f = n . (p - q): f'' = n''.(p-q) + 2 n'.(p-q)' + n.(p-q)''.
fn by_curvature(plane: Plane, own: &Path, p: DVec3, path: &Path, span: Span) -> f64 {
    let between = |s: f64| path.at(s).transform_point3(p) - own.at(s).transform_point3(plane.point);
    let height = |s: f64| own.at(s).transform_vector3(plane.normal).dot(between(s));
    let (arm, own_arm) = (path.arm(p), own.arm(plane.point));
    let (w, own_w) = (path.angle.abs(), own.angle.abs());
    let speed = w * arm + path.slide.length() + own_w * own_arm + own.slide.length();
    let far = between(span.middle()).length() + speed * span.length() / 2.0;
    let bend = own_w * own_w * far + 2.0 * own_w * speed + w * w * arm + own_w * own_w * own_arm;
    height(span.from).min(height(span.to)) - bend * span.length() * span.length() / 8.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dice(seed: &mut u64) -> f64 {
        *seed ^= *seed << 13;
        *seed ^= *seed >> 7;
        *seed ^= *seed << 17;
        (*seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    }

    /// Against ten thousand samples: never above the least of them, and at most 1e-6 below where it is exact.
    #[test]
    fn least_heights_are_below_all_samples() {
        let mut seed = 5;
        let mut vector = || DVec3::new(dice(&mut seed), dice(&mut seed), dice(&mut seed));
        for round in 0..200 {
            let plane = Plane { point: vector(), normal: vector().normalize() };
            let mut screw = |angle: f64| {
                let (axis, l) = (vector().normalize(), vector());
                Path { centre: vector(), axis, angle: angle * l.x, slide: axis * l.y }
            };
            let (a, b) = (screw(9.0), screw(3.0));
            let slides = Path::straight(vector());
            let (own, path, exact) = match round % 4 {
                0 => (Path::STILL, a, true),
                1 => (slides, a, true),
                2 => (a, Path::STILL, true),
                _ => (a, b, false),
            };
            let (p, from) = (vector(), vector().x.abs() * 0.9);
            let span = Span { from, to: from + if exact { 1.0 - from } else { 0.01 } };
            let found = least_height(plane, &own, p, &path, span);
            let seen = (0..=10_000)
                .map(|k| {
                    let s = span.from + span.length() * f64::from(k) / 1e4;
                    let (mine, its) = (own.at(s), path.at(s));
                    let q = mine.transform_point3(plane.point);
                    mine.transform_vector3(plane.normal).dot(its.transform_point3(p) - q)
                })
                .fold(f64::INFINITY, f64::min);
            let slack = if exact { 1e-5 } else { 0.05 };
            assert!(found <= seen + 1e-12 && found >= seen - slack, "round {round}: {found} {seen}");
        }
    }
}
