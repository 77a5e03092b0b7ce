//! Takes two poses of every part of a set, gives the screws that lead from one to the other, and says whether the parts
//! pass each other on them.
//!
//! Sound: each stretch is kept by one plane, fixed to one of two cells, with a bound from its speed and its second
//! derivative at the middle; where that fails the stretch is halved. `Passes::No` is no proof of an overlap.

use super::bodies::{Bodies, Body, Poses, between};
use crate::sequence::motion::{Rigid, Screw, Shift};
use glam::{DAffine3, DMat3, DQuat, DVec3};

/// Radians below which a turn is none: a part of 1 is off by less than round-off of 2^-40.
const NO_TURN: f64 = 1e-12;

/// Halvings of a motion before it is given up.
const MOST_HALVINGS: u32 = 11;

/// A screw from a pose: x goes to centre + R(axis, angle s)(x - centre) + s slide.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    from: DAffine3,
    centre: DVec3,
    axis: DVec3,
    angle: f64,
    slide: DVec3,
}

impl Path {
    /// The screw between two poses, the shorter way around.
    pub fn between(from: DAffine3, to: DAffine3) -> Path {
        if from == to {
            return Path { from, centre: DVec3::ZERO, axis: DVec3::Z, angle: 0.0, slide: DVec3::ZERO };
        }
        let by = to * from.inverse();
        let (axis, angle) = DQuat::from_mat3(&by.matrix3).normalize().to_axis_angle();
        let (axis, angle) =
            if angle > std::f64::consts::PI { (-axis, std::f64::consts::TAU - angle) } else { (axis, angle) };
        if angle.abs() < NO_TURN {
            return Path { from, centre: DVec3::ZERO, axis: DVec3::Z, angle: 0.0, slide: by.translation };
        }
        let slide = axis * by.translation.dot(axis);
        let across = by.translation - slide;
        // The fixed point of x -> R x + across in the plane through the origin across the axis.
        let centre = (across + axis.cross(across) / (angle / 2.0).tan()) / 2.0;
        Path { from, centre, axis, angle, slide }
    }

    pub fn at(&self, s: f64) -> DAffine3 {
        let turn = DMat3::from_axis_angle(self.axis, self.angle * s);
        DAffine3::from_mat3_translation(turn, self.centre - turn * self.centre + self.slide * s) * self.from
    }

    pub fn stands(&self) -> bool {
        self.angle == 0.0 && self.slide == DVec3::ZERO
    }

    /// As it is written; None where nothing moves.
    pub fn rigid(&self, mm_per_unit: f64) -> Option<Rigid> {
        if self.angle == 0.0 {
            let d = self.slide.try_normalize()?;
            return Some(Rigid::Translation(Shift::new(d, self.slide.length(), mm_per_unit)));
        }
        let advance = self.slide.dot(self.axis);
        Some(Rigid::Screw(Screw {
            point: self.centre.to_array(),
            axis: self.axis.to_array(),
            angle: self.angle,
            advance,
            advance_mm: advance * mm_per_unit,
        }))
    }

    fn spin(&self) -> DVec3 {
        self.axis * self.angle
    }

    /// Velocity of a point that is now at `p`.
    fn speed(&self, s: f64, p: DVec3) -> DVec3 {
        self.spin().cross(p - self.centre - self.slide * s) + self.slide
    }

    fn arm(&self, s: f64, p: DVec3) -> f64 {
        (p - self.centre - self.slide * s).reject_from_normalized(self.axis).length()
    }

    /// Most that any point within `radius` of `p` moves over the whole path.
    fn reach(&self, p: DVec3, radius: f64) -> f64 {
        self.angle.abs() * (self.arm(0.0, p) + radius) + self.slide.length()
    }
}

/// The screws from one state to another.
pub fn paths(from: &Poses, to: &Poses) -> Vec<Path> {
    from.iter().zip(to).map(|(a, b)| Path::between(*a, *b)).collect()
}

/// Whether all parts pass each other on the way, overlapping by no more than `touch`.
pub fn passes(bodies: &Bodies, paths: &[Path], touch: f64) -> Passes {
    let placed: Vec<Vec<Body>> = paths.iter().enumerate().map(|(k, p)| bodies.placed(k, &p.from)).collect();
    for a in 0..paths.len() {
        for b in a + 1..paths.len() {
            if paths[a].stands() && paths[b].stands() {
                continue;
            }
            let near = |x: &Body, y: &Body| {
                let reach = paths[a].reach(x.centre, x.radius) + paths[b].reach(y.centre, y.radius);
                x.centre.distance(y.centre) <= x.radius + y.radius + reach + (-touch).max(0.0)
            };
            for x in &placed[a] {
                for y in placed[b].iter().filter(|y| near(x, y)) {
                    if !pair_passes(
                        Going { cell: x, path: &paths[a] },
                        Going { cell: y, path: &paths[b] },
                        touch,
                    ) {
                        return Passes::No;
                    }
                }
            }
        }
    }
    Passes::Yes
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passes {
    Yes,
    /// Not shown.
    No,
}

/// A distance that all parts keep on the way, model units: a lower bound, right to a factor of two where they come no
/// nearer than at the ends; 0 where they touch.
pub fn kept(bodies: &Bodies, paths: &[Path], touch: f64) -> f64 {
    /// Halvings of what the ends keep, before it counts as nothing.
    const MOST_TRIES: i32 = 6;
    let ends = least_gap(bodies, paths, 0.0).min(least_gap(bodies, paths, 1.0));
    let mut tries = (1..=MOST_TRIES).map(|k| ends / 2f64.powi(k)).filter(|d| *d > touch && d.is_finite());
    tries.find(|d| passes(bodies, paths, -d) == Passes::Yes).unwrap_or(0.0)
}

/// The least distance between planes of cells of parts of which one moves, at one time.
fn least_gap(bodies: &Bodies, paths: &[Path], s: f64) -> f64 {
    let placed: Vec<Vec<Body>> = paths.iter().enumerate().map(|(k, p)| bodies.placed(k, &p.at(s))).collect();
    let mut least = f64::INFINITY;
    for a in 0..paths.len() {
        for b in (a + 1..paths.len()).filter(|&b| !(paths[a].stands() && paths[b].stands())) {
            for x in &placed[a] {
                for y in &placed[b] {
                    if x.centre.distance(y.centre) - x.radius - y.radius < least {
                        least = least.min(between(x, y, 0.0).gap);
                    }
                }
            }
        }
    }
    least
}

/// A cell where its path starts.
#[derive(Clone, Copy)]
struct Going<'a> {
    cell: &'a Body,
    path: &'a Path,
}

impl Going<'_> {
    fn at(&self, s: f64) -> Body {
        self.cell.moved(&(self.path.at(s) * self.path.from.inverse()))
    }
}

fn pair_passes(x: Going, y: Going, touch: f64) -> bool {
    let mut open = vec![(0.0, 1.0, 0)];
    while let Some((from, to, depth)) = open.pop() {
        let s = (from + to) / 2.0;
        let (a, b) = (x.at(s), y.at(s));
        let plane = between(&a, &b, touch);
        if plane.gap < -touch {
            return false;
        }
        let half = (to - from) / 2.0;
        let kept = fixed_keeps((&a, x.path), (&b, y.path), plane.normal, (s, half), touch)
            || fixed_keeps((&b, y.path), (&a, x.path), -plane.normal, (s, half), touch);
        if !kept {
            if depth >= MOST_HALVINGS {
                return false;
            }
            open.extend([(s, to, depth + 1), (from, s, depth + 1)]);
        }
    }
    true
}

/// Whether the plane across `n`, through the farthest corner of `own` and fixed to it, keeps the other within
/// `half` of `s` on each side.
fn fixed_keeps(
    own: (&Body, &Path),
    other: (&Body, &Path),
    n: DVec3,
    (s, half): (f64, f64),
    touch: f64,
) -> bool {
    let ((own, p), (other, q)) = (own, other);
    let base = own.far(n);
    let (base_speed, n_speed) = (p.speed(s, base), p.spin().cross(n));
    let (wp, wq) = (p.angle.abs(), q.angle.abs());
    other.vertices.iter().all(|&v| {
        let height = n.dot(v - base);
        let rate = n_speed.dot(v - base) + n.dot(q.speed(s, v) - base_speed);
        let bend = match () {
            _ if wp == 0.0 => n.reject_from_normalized(q.axis).length() * q.arm(s, v) * wq * wq,
            _ if q.stands() => n.reject_from_normalized(p.axis).length() * p.arm(s, v) * wp * wp,
            _ => {
                let fast = wq * q.arm(s, v) + q.slide.length() + wp * p.arm(s, base) + p.slide.length();
                let far = v.distance(base) + fast * half;
                wp * wp * (far + p.arm(s, base)) + 2.0 * wp * fast + wq * wq * q.arm(s, v)
            }
        };
        height - rate.abs() * half - bend * half * half / 2.0 >= -touch
    })
}
