//! Takes a scene and a size, gives the image: visibility, light and ink of every sample, averaged to pixels.
//!
//! Promised: the same bytes with any number of threads (bands are joined in order). Ghosts are blended from the
//! farthest to the nearest by their middle, which is only an order of whole items.

use super::camera::Camera;
use super::image::{Image, Size};
use super::ink::{Line, Look, Pens, plane};
use super::layer::{Facing, Layer, NOTHING, Stage};
use super::light::Light;
use super::palette::{self, Colour, encode};
use super::scene::{Background, Opacity, Scene};
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// Samples along each side of a pixel: nine, so an edge has ten steps of grey.
const SAMPLES: usize = 3;
/// Rows of pixels that are painted together: enough to make their shared border small.
const BAND: usize = 24;
/// How much of the surface a crease's ink covers; outlines cover all.
const CREASE_INK: f64 = 0.6;

/// Whether outlines and creases are drawn into the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pen {
    Lines,
    /// Shading alone: lines are to come as vectors over it.
    None,
}

struct Studio<'a> {
    look: Look<'a>,
    pen: Pen,
    light: Light,
    size: Size,
    pens: Pens,
    /// Numbers of the triangles that reach into each band; ghosts apart, one list for each, farthest first.
    solid: Bins,
    ghosts: Vec<(f64, Bins)>,
}

/// Numbers of triangles for each band.
type Bins = Vec<Vec<u32>>;

/// Draws the scene with its lines. An empty scene gives an empty picture.
pub fn render(scene: &Scene, size: Size) -> Image {
    render_with(scene, size, Pen::Lines)
}

/// The same with or without lines.
pub fn render_with(scene: &Scene, size: Size, pen: Pen) -> Image {
    let camera = Camera::fit(&scene.view, scene.items.iter().flat_map(|i| i.points()), size);
    let stage = Stage::of(scene, &camera, SAMPLES);
    let pens = Pens::of(size.width().min(size.height()), SAMPLES);
    let solid = |i: u32| scene.items[i as usize].opacity == Opacity::Solid;
    let ghost =
        |(i, alpha): (u32, f64)| (alpha, bins(&stage, stage.of_item(i), size, pens.reach(), &|_| true));
    let studio = Studio {
        solid: bins(&stage, 0..stage.triangles.len(), size, pens.reach(), &solid),
        ghosts: ghosts(scene, &camera).into_iter().map(ghost).collect(),
        light: Light::of(scene, &scene.view),
        pen,
        look: Look { scene, stage: &stage, camera: &camera, samples: SAMPLES },
        size,
        pens,
    };
    let bands = size.height().div_ceil(BAND as u32) as usize;
    let rgba: Vec<Vec<u8>> = (0..bands).into_par_iter().map(|b| studio.band(b)).collect();
    Image { size, rgba: rgba.concat() }
}

/// Items that are seen through, farthest first, with their alpha.
fn ghosts(scene: &Scene, camera: &Camera) -> Vec<(u32, f64)> {
    let nearness = |k: u32| {
        let points = || scene.items[k as usize].points();
        camera.project(points().sum::<DVec3>() / points().count().max(1) as f64).z
    };
    let mut found: Vec<(u32, f64)> = (0u32..)
        .zip(&scene.items)
        .filter_map(|(k, item)| match item.opacity {
            Opacity::Ghost { alpha } => Some((k, alpha.clamp(0.0, 1.0))),
            _ => None,
        })
        .collect();
    found.sort_by(|a, b| nearness(a.0).total_cmp(&nearness(b.0)));
    found
}

/// The triangles among these whose item is kept, by the bands that they reach into.
fn bins(stage: &Stage, among: Range<usize>, size: Size, reach: i64, keep: &dyn Fn(u32) -> bool) -> Bins {
    let bands = size.height().div_ceil(BAND as u32) as usize;
    let mut bins = vec![Vec::new(); bands];
    let tall = (BAND * SAMPLES) as f64;
    for (k, f) in among.clone().zip(&stage.triangles[among]).filter(|(_, f)| keep(f.item)) {
        let ys = f.seen.map(|p| p.y);
        let lo = ys.iter().copied().fold(f64::INFINITY, f64::min) - reach as f64 - 1.0;
        let hi = ys.iter().copied().fold(f64::NEG_INFINITY, f64::max) + reach as f64 + 1.0;
        let first = (lo / tall).floor().max(0.0) as usize;
        let last = ((hi / tall).floor().max(0.0) as usize + 1).min(bands);
        bins[first.min(last)..last].iter_mut().for_each(|b| b.push(k as u32));
    }
    bins
}

/// A layer with the ink on it and the share of light that it keeps.
struct Sheet {
    layer: Layer,
    ink: Vec<Line>,
    alpha: f64,
}

impl Studio<'_> {
    /// The bytes of one band of rows.
    fn band(&self, band: usize) -> Vec<u8> {
        let top = band * BAND;
        let rows = BAND.min(self.size.height() as usize - top);
        let width = self.size.width() as usize * SAMPLES;
        let reach = self.pens.reach();
        let span = (top * SAMPLES) as i64 - reach..((top + rows) * SAMPLES) as i64 + reach;
        let solid = self.draw(&self.solid[band], 0..width, span.clone());
        let mut sheets = Vec::new();
        // A ghost is drawn in a window of its own: where many are, each covers little of the picture.
        for (alpha, bins) in self.ghosts.iter().filter(|(_, bins)| !bins[band].is_empty()) {
            let columns = self.columns(&bins[band], width);
            let mut layer = self.draw(&bins[band], columns, span.clone());
            layer.hide_behind(&solid);
            sheets.push(self.inked(layer, *alpha));
        }
        sheets.insert(0, self.inked(solid, 1.0));
        let mut bytes = Vec::with_capacity(rows * self.size.width() as usize * 4);
        let mut known = Vec::new();
        // Of many ghosts few lie over one column of pixels.
        let over: Vec<Vec<&Sheet>> =
            (0..self.size.width() as usize).map(|x| over_column(&sheets, x)).collect();
        for y in 0..rows {
            for (x, sheets) in over.iter().enumerate() {
                known.clear();
                bytes.extend(self.pixel(sheets, x, top + y, &mut known));
            }
        }
        bytes
    }

    /// The columns of samples that some triangles and the ink about them can touch.
    fn columns(&self, numbers: &[u32], width: usize) -> Range<usize> {
        let xs = numbers.iter().flat_map(|&k| self.look.stage.triangles[k as usize].seen.map(|p| p.x));
        let (lo, hi) = xs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let reach = self.pens.reach() as f64 + 1.0;
        // Casts of what is not a number or far out saturate.
        let first = ((lo - reach).max(0.0) as usize).min(width);
        first..((hi + reach).max(0.0) as usize + 1).clamp(first, width)
    }

    fn draw(&self, numbers: &[u32], columns: Range<usize>, rows: Range<i64>) -> Layer {
        let mut layer = Layer::empty(columns, rows, self.look.stage.tie);
        numbers.iter().for_each(|&k| layer.draw(k, &self.look.stage.triangles[k as usize].seen));
        layer
    }

    fn inked(&self, layer: Layer, alpha: f64) -> Sheet {
        let ink = match self.pen {
            Pen::Lines => self.look.lines(&layer, &self.pens),
            Pen::None => vec![Line::None; layer.nearest.len()],
        };
        Sheet { layer, ink, alpha }
    }

    /// Mean of the pixel's samples as bytes.
    fn pixel(&self, sheets: &[&Sheet], x: usize, y: usize, known: &mut Known) -> [u8; 4] {
        let mut sum = [0.0; 4];
        for sy in 0..SAMPLES {
            for sx in 0..SAMPLES {
                let c = self.sample(sheets, x * SAMPLES + sx, y * SAMPLES + sy, known);
                (0..4).for_each(|k| sum[k] += c[k]);
            }
        }
        bytes(sum.map(|s| s / (SAMPLES * SAMPLES) as f64))
    }

    /// Premultiplied linear colour of one sample.
    fn sample(&self, sheets: &[&Sheet], x: usize, y: usize, known: &mut Known) -> [f64; 4] {
        let mut colour = match self.look.scene.background {
            Background::Transparent => [0.0; 4],
            Background::Plain(Colour(c)) => [c[0], c[1], c[2], 1.0],
        };
        for sheet in sheets {
            let Some(at) = sheet.layer.at(x, y as i64) else { continue };
            let seen = sheet.layer.nearest[at];
            if seen != NOTHING {
                colour = over(self.shade(seen, x, y, known), sheet.alpha, colour);
            }
            // A ghost's outline stays readable where its faces nearly vanish.
            let strength = sheet.alpha.sqrt();
            match sheet.ink[at] {
                Line::Outline => colour = over(Colour::srgb(palette::INK).0, strength, colour),
                Line::Crease => colour = over(Colour::srgb(palette::INK).0, CREASE_INK * strength, colour),
                Line::None => (),
            }
        }
        colour
    }

    /// Light is looked up once for each smooth surface in a pixel: it hardly changes inside one.
    fn shade(&self, seen: u32, x: usize, y: usize, known: &mut Known) -> [f64; 3] {
        let f = &self.look.stage.triangles[seen as usize];
        let item = &self.look.scene.items[f.item as usize];
        let facet = item.mesh.triangles[f.triangle as usize].facet;
        let surface = (f.item, item.mesh.surface[facet as usize]);
        if let Some((_, c)) = known.iter().find(|(s, _)| *s == surface) {
            return *c;
        }
        let fine = SAMPLES as f64;
        let p = self.look.hit(f, (x as f64 + 0.5) / fine, (y as f64 + 0.5) / fine);
        let c = item.colour.scaled(self.light.at(p, self.normal(f, p)));
        known.push((surface, c));
        c
    }

    /// The normals of the corners blended at a point of the triangle, in the scene.
    fn normal(&self, f: &Facing, p: DVec3) -> DVec3 {
        let item = &self.look.scene.items[f.item as usize];
        let t = &item.mesh.triangles[f.triangle as usize];
        let n = plane(f);
        let weight = |k: usize| {
            let (a, b) = (f.corners[(k + 1) % 3], f.corners[(k + 2) % 3]);
            // A sample of a sliver may lie beside it: never weigh a corner the wrong way.
            (b - a).cross(p - a).dot(n).max(0.0)
        };
        let blend: DVec3 = (0..3).map(|k| item.mesh.normals[t.normals[k] as usize] * weight(k)).sum();
        item.pose.transform_vector3(blend).try_normalize().unwrap_or(n)
    }
}

/// The sheets with samples in a column of pixels, in their order.
fn over_column(sheets: &[Sheet], x: usize) -> Vec<&Sheet> {
    let samples = x * SAMPLES..(x + 1) * SAMPLES;
    let over = |s: &&Sheet| {
        s.layer.first_column < samples.end && samples.start < s.layer.first_column + s.layer.width
    };
    sheets.iter().filter(over).collect()
}

/// Item and smooth surface.
type Surface = (u32, u32);

/// The light already looked up in this pixel.
type Known = Vec<(Surface, [f64; 3])>;

fn over(c: [f64; 3], alpha: f64, below: [f64; 4]) -> [f64; 4] {
    let keep = 1.0 - alpha;
    let mix = |k: usize| c[k] * alpha + below[k] * keep;
    [mix(0), mix(1), mix(2), alpha + below[3] * keep]
}

fn bytes([r, g, b, a]: [f64; 4]) -> [u8; 4] {
    if a <= 0.0 {
        return [0; 4];
    }
    [encode(r / a), encode(g / a), encode(b / a), (a.clamp(0.0, 1.0) * 255.0).round() as u8]
}
