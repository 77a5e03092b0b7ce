//! Takes a layer, gives how dark the ink of its lines lies on each sample: outlines, steps in depth, creases.
//!
//! Promised: lines stop where the surface that carries them is hidden. Not promised: lines finer than a sample.

use super::camera::Camera;
use super::layer::{Facing, Layer, NOTHING, Stage};
use super::scene::Scene;
use glam::DVec3;

/// Two surfaces less than this many pixels apart in depth get no line between them: there is no room for one.
const STEP_PIXELS: f64 = 3.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Line {
    None,
    Crease,
    Outline,
}

/// Radius of each kind of line, in samples.
#[derive(Clone, Copy)]
pub(super) struct Pens {
    pub crease: f64,
    pub outline: f64,
}

impl Pens {
    /// Widths in pixels, for a picture whose shorter side is `short` pixels: the look of a 0.35 mm and a 0.18 mm pen on
    /// a drawing 140 mm high, never thinner than what a pixel shows.
    pub fn of(short: u32, samples: usize) -> Pens {
        let radius = |mm: f64| (f64::from(short) * mm / 140.0).max(mm / 0.35) * samples as f64 / 2.0;
        Pens { crease: radius(0.18), outline: radius(0.35) }
    }

    pub fn reach(&self) -> i64 {
        self.outline.ceil() as i64 + 1
    }
}

pub(super) struct Look<'a> {
    pub scene: &'a Scene,
    pub stage: &'a Stage,
    pub camera: &'a Camera,
    /// Along a pixel's side.
    pub samples: usize,
}

impl Look<'_> {
    /// The ink on every sample of the layer.
    pub fn lines(&self, layer: &Layer, pens: &Pens) -> Vec<Line> {
        let mut ink = vec![Line::None; layer.nearest.len()];
        let stamps = [stamp(pens.crease), stamp(pens.outline)];
        for y in 0..layer.rows {
            for x in 0..layer.width {
                let at = y * layer.width + x;
                let right = (x + 1 < layer.width).then(|| at + 1);
                let below = (y + 1 < layer.rows).then(|| at + layer.width);
                let line = right.into_iter().chain(below).map(|n| self.between(layer, at, n)).max();
                match line {
                    Some(Line::Crease) => press(&mut ink, layer, x, y, &stamps[0], Line::Crease),
                    Some(Line::Outline) => press(&mut ink, layer, x, y, &stamps[1], Line::Outline),
                    _ => (),
                }
            }
        }
        ink
    }

    fn between(&self, layer: &Layer, a: usize, b: usize) -> Line {
        let (s, t) = (layer.nearest[a], layer.nearest[b]);
        if s == t {
            return Line::None;
        }
        if s == NOTHING || t == NOTHING {
            return Line::Outline;
        }
        let (f, g) = (&self.stage.triangles[s as usize], &self.stage.triangles[t as usize]);
        if f.item != g.item || self.step(layer, (f, a), (g, b)) {
            return Line::Outline;
        }
        let mesh = &self.scene.items[f.item as usize].mesh;
        let [f, g] = [f, g].map(|s| mesh.triangles[s.triangle as usize].facet);
        let creased = mesh.surface[f as usize] != mesh.surface[g as usize]
            || mesh.creased.contains(&(f.min(g), f.max(g)));
        if creased { Line::Crease } else { Line::None }
    }

    /// Whether each sample's point lies well off the other's plane: one surface ends in front of another.
    fn step(&self, layer: &Layer, (f, a): (&Facing, usize), (g, b): (&Facing, usize)) -> bool {
        let samples = self.samples as f64;
        let point = |s: &Facing, k: usize| {
            let (x, y) = layer.place(k);
            self.hit(s, (x as f64 + 0.5) / samples, (y as f64 + 0.5) / samples)
        };
        let (p, q) = (point(f, a), point(g, b));
        let off = |s: &Facing, p: DVec3| plane(s).dot(p - s.corners[0]).abs();
        off(g, p).min(off(f, q)) > STEP_PIXELS * self.camera.footprint(p)
    }

    /// The point of a triangle's plane that a point of the picture (in pixels) shows.
    pub fn hit(&self, s: &Facing, x: f64, y: f64) -> DVec3 {
        let (from, along) = self.camera.ray(x, y);
        let n = plane(s);
        from + along * (n.dot(s.corners[0] - from) / n.dot(along))
    }
}

/// Unit normal of a triangle, from its corners.
pub(super) fn plane(s: &Facing) -> DVec3 {
    let [a, b, c] = s.corners;
    (b - a).cross(c - a).normalize_or_zero()
}

/// Offsets of the samples under a round pen.
fn stamp(radius: f64) -> Vec<(i64, i64)> {
    let r = radius.ceil() as i64;
    let inside = |&(x, y): &(i64, i64)| {
        // The line runs between this sample and the next: its middle is half a sample off.
        let (x, y) = (x as f64 - 0.5, y as f64 - 0.5);
        x * x + y * y <= radius * radius
    };
    (-r..=r + 1).flat_map(|y| (-r..=r + 1).map(move |x| (x, y))).filter(inside).collect()
}

fn press(ink: &mut [Line], layer: &Layer, x: usize, y: usize, stamp: &[(i64, i64)], line: Line) {
    for (dx, dy) in stamp {
        let (x, y) = (x as i64 + dx, y as i64 + dy);
        if (0..layer.width as i64).contains(&x) && (0..layer.rows as i64).contains(&y) {
            let at = &mut ink[y as usize * layer.width + x as usize];
            *at = (*at).max(line);
        }
    }
}
