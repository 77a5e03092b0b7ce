//! Takes a view and points, gives the camera that shows all of them as large as the picture allows.
//!
//! Promised: every point falls inside the margin, exactly touching it in one axis; with perspective the distance is
//! the least that does so, in closed form. Not promised: a view from inside.

use super::image::Size;
use glam::{DVec2, DVec3};

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    Orthographic,
    /// Opening angle over the picture's height, in degrees.
    Perspective {
        degrees: f64,
    },
}

/// Where the viewer stands, seen from the scene. z is up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Degrees from the x axis, counter-clockwise.
    pub azimuth: f64,
    /// Degrees above the horizon; 90 looks straight down, with y up in the picture at azimuth -90.
    pub elevation: f64,
    pub projection: Projection,
}

impl Default for View {
    fn default() -> Self {
        View { azimuth: -62.0, elevation: 38.0, projection: Projection::Perspective { degrees: 24.0 } }
    }
}

impl View {
    /// From straight above, x to the right and y up, as a draft is drawn.
    pub const PLAN: View = View { azimuth: -90.0, elevation: 90.0, projection: Projection::Orthographic };
}

/// Share of the picture left free on each side.
const MARGIN: f64 = 0.03;

/// Right, up and toward the viewer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub right: DVec3,
    pub up: DVec3,
    pub back: DVec3,
}

impl Frame {
    pub fn of(view: &View) -> Frame {
        let (sa, ca) = view.azimuth.to_radians().sin_cos();
        let (se, ce) = view.elevation.to_radians().sin_cos();
        Frame {
            right: DVec3::new(-sa, ca, 0.0),
            up: DVec3::new(-se * ca, -se * sa, ce),
            back: DVec3::new(ce * ca, ce * sa, se),
        }
    }

    pub fn seen(&self, p: DVec3) -> DVec3 {
        DVec3::new(self.right.dot(p), self.up.dot(p), self.back.dot(p))
    }

    pub fn placed(&self, p: DVec3) -> DVec3 {
        self.right * p.x + self.up * p.y + self.back * p.z
    }
}

#[derive(Clone, Copy, Debug)]
enum Lens {
    /// Pixels to a unit.
    Parallel { scale: f64 },
    /// Pixels to a unit at distance one; the eye's height along the axis toward the viewer.
    Central { focal: f64, eye: f64 },
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    pub frame: Frame,
    /// Point of the frame's plane that falls on the picture's middle.
    middle: DVec2,
    half: DVec2,
    lens: Lens,
}

impl Camera {
    pub fn fit(view: &View, points: impl Iterator<Item = DVec3>, size: Size) -> Camera {
        let frame = Frame::of(view);
        let half = DVec2::new(f64::from(size.width()), f64::from(size.height())) / 2.0;
        let room = half * (1.0 - 2.0 * MARGIN);
        let seen: Vec<DVec3> = points.map(|p| frame.seen(p)).collect();
        match view.projection {
            Projection::Orthographic => parallel(frame, half, room, &seen),
            Projection::Perspective { degrees } => {
                let focal = half.y / (degrees.clamp(NARROWEST, WIDEST).to_radians() / 2.0).tan();
                central(frame, half, room, focal, &seen)
            }
        }
    }

    /// Pixel coordinates from the upper left corner, and a nearness that is linear over the picture on every plane
    /// and grows toward the viewer.
    pub fn project(&self, p: DVec3) -> DVec3 {
        let q = self.frame.seen(p);
        let scale = self.scale(q.z);
        let (x, y) =
            (self.half.x + scale * (q.x - self.middle.x), self.half.y - scale * (q.y - self.middle.y));
        let near = match self.lens {
            Lens::Parallel { .. } => q.z,
            Lens::Central { eye, .. } => 1.0 / (eye - q.z),
        };
        DVec3::new(x, y, near)
    }

    /// Start and direction, in the scene, of the ray through a point of the picture.
    pub fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let (x, y) = (x - self.half.x, self.half.y - y);
        let m = self.middle;
        match self.lens {
            Lens::Parallel { scale } => {
                (self.frame.placed(DVec3::new(m.x + x / scale, m.y + y / scale, 0.0)), -self.frame.back)
            }
            Lens::Central { focal, eye } => (
                self.frame.placed(DVec3::new(m.x, m.y, eye)),
                self.frame.placed(DVec3::new(x / focal, y / focal, -1.0)),
            ),
        }
    }

    /// Width of a pixel at a point, in the scene's units.
    pub fn footprint(&self, p: DVec3) -> f64 {
        1.0 / self.scale(self.frame.back.dot(p))
    }

    fn scale(&self, z: f64) -> f64 {
        match self.lens {
            Lens::Parallel { scale } => scale,
            Lens::Central { focal, eye } => focal / (eye - z),
        }
    }
}

/// Opening angles, in degrees, between which a perspective is still one: below it is parallel, above it distorts.
const NARROWEST: f64 = 1.0;
const WIDEST: f64 = 120.0;

/// Largest of `f` over the points; zero where there are none.
fn most(points: &[DVec3], f: impl Fn(&DVec3) -> f64) -> f64 {
    points.iter().map(f).reduce(f64::max).unwrap_or(0.0)
}

fn parallel(frame: Frame, half: DVec2, room: DVec2, seen: &[DVec3]) -> Camera {
    let hi = DVec2::new(most(seen, |p| p.x), most(seen, |p| p.y));
    let lo = -DVec2::new(most(seen, |p| -p.x), most(seen, |p| -p.y));
    let scale = (room * 2.0 / (hi - lo)).min_element();
    let scale = if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
    Camera { frame, middle: (lo + hi) / 2.0, half, lens: Lens::Parallel { scale } }
}

/// |x - m| <= (eye - z) t bounds the eye from below by two planes for each axis; their sum does not contain m.
fn central(frame: Frame, half: DVec2, room: DVec2, focal: f64, seen: &[DVec3]) -> Camera {
    let t = room / focal;
    let a = DVec2::new(most(seen, |p| p.x + p.z * t.x), most(seen, |p| p.y + p.z * t.y));
    let b = DVec2::new(most(seen, |p| -p.x + p.z * t.x), most(seen, |p| -p.y + p.z * t.y));
    let needed = ((a + b) / (t * 2.0)).max_element();
    let nearest = most(seen, |p| p.z);
    // A single point needs no distance at all; one unit keeps the division defined.
    let eye = if needed > nearest { needed } else { nearest + 1.0 };
    Camera { frame, middle: (a - b) / 2.0, half, lens: Lens::Central { focal, eye } }
}
