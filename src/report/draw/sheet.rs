//! Takes flat marks (rectangles, lines, polygons, words); gives them as SVG, and as PNG with words in strokes.
//!
//! Promised: the same marks give the same bytes; no font file is needed. Not promised: that words are as wide in both
//! (a viewer brings its own font to the SVG), so nothing may depend on their end.

use super::image::{BadSize, Image, Size};
use super::strokes;
use std::fmt::Write;
use std::io;

/// Red, green, blue as style sheets have them.
pub type Rgb = [u8; 3];

/// Where a word's point lies along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// Something drawn; lengths in units of the sheet, y down.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    Fill {
        points: Vec<[f64; 2]>,
        ink: Rgb,
    },
    Line {
        points: Vec<[f64; 2]>,
        ink: Rgb,
        width: f64,
    },
    /// `at`: on the baseline; `size`: of the letters, as in CSS.
    Words {
        at: [f64; 2],
        size: f64,
        anchor: Anchor,
        ink: Rgb,
        text: String,
    },
}

/// A white sheet with marks, later ones over earlier ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    pub width: f64,
    pub height: f64,
    pub marks: Vec<Mark>,
}

/// Corners of a rectangle.
pub fn rectangle(x: f64, y: f64, width: f64, height: f64) -> Vec<[f64; 2]> {
    vec![[x, y], [x + width, y], [x + width, y + height], [x, y + height]]
}

/// Pixels in a unit: 300 dots per inch where a unit is a CSS pixel of 1/96 inch.
const SHARPNESS: f64 = 300.0 / 96.0;

impl Sheet {
    pub fn svg(&self) -> String {
        let (w, h) = (self.width, self.height);
        let marks: String = self.marks.iter().map(svg_mark).collect();
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"Helvetica, Arial, sans-serif\">\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{marks}</svg>\n"
        )
    }

    /// The PNG file; coarser than 300 dots per inch where the sheet is larger than a picture may be.
    pub fn png(&self) -> io::Result<Vec<u8>> {
        let scale = SHARPNESS.min(f64::from(Size::LONGEST) / self.width.max(self.height));
        let pixels = |length: f64| ((length * scale).ceil() as u32).clamp(1, Size::LONGEST);
        let size = Size::new(pixels(self.width), pixels(self.height))
            .map_err(|e: BadSize| io::Error::new(io::ErrorKind::InvalidInput, e.to_string()))?;
        let mut raster =
            Raster { size, scale, rgb: vec![1.0; size.width() as usize * size.height() as usize * 3] };
        self.marks.iter().for_each(|m| raster.mark(m));
        raster.image().png()
    }
}

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn svg_mark(mark: &Mark) -> String {
    match mark {
        Mark::Fill { points, ink } => format!("<path d=\"{}Z\" fill=\"{}\"/>\n", path(points), hex(*ink)),
        Mark::Line { points, ink, width } => format!(
            "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>\n",
            path(points),
            hex(*ink)
        ),
        Mark::Words { at: [x, y], size, anchor, ink, text } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
            let ink = hex(*ink);
            format!(
                "<text x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{ink}\">{text}</text>\n"
            )
        }
    }
}

fn path(points: &[[f64; 2]]) -> String {
    let mut text = String::new();
    for (k, [x, y]) in points.iter().enumerate() {
        let _ = write!(text, "{}{x:.2} {y:.2}", if k == 0 { 'M' } else { 'L' });
    }
    text
}

/// Pixels being covered, each channel in 0..=1.
struct Raster {
    size: Size,
    scale: f64,
    rgb: Vec<f32>,
}

impl Raster {
    fn mark(&mut self, mark: &Mark) {
        match mark {
            Mark::Fill { points, ink } => {
                let pixels = self.pixels(points);
                self.cover(&pixels, 1.0, *ink, |p| inside(&pixels, p));
            }
            Mark::Line { points, ink, width } => self.line(points, *ink, *width),
            Mark::Words { at, size, anchor, ink, text } => {
                let along = match anchor {
                    Anchor::Start => 0.0,
                    Anchor::Middle => 0.5,
                    Anchor::End => 1.0,
                };
                let from = [at[0] - along * strokes::width(text) * size, at[1]];
                for stroke in strokes::of(text) {
                    let placed: Vec<_> =
                        stroke.iter().map(|p| [from[0] + p[0] * size, from[1] - p[1] * size]).collect();
                    self.line(&placed, *ink, strokes::PEN * size);
                }
            }
        }
    }

    fn pixels(&self, points: &[[f64; 2]]) -> Vec<[f64; 2]> {
        points.iter().map(|p| p.map(|c| c * self.scale)).collect()
    }

    /// A line with round ends and joints.
    fn line(&mut self, points: &[[f64; 2]], ink: Rgb, width: f64) {
        let pixels = self.pixels(points);
        let radius = width * self.scale / 2.0;
        self.cover(&pixels, radius + 1.0, ink, |p| radius - distance(&pixels, p));
    }

    /// Mixes ink into the pixels around the points; `depth`: how far a pixel's middle lies inside, in pixels.
    fn cover(&mut self, points: &[[f64; 2]], margin: f64, ink: Rgb, depth: impl Fn([f64; 2]) -> f64) {
        let range = |d: usize, end: u32| {
            let least = points.iter().map(|p| p[d]).fold(f64::INFINITY, f64::min) - margin;
            let most = points.iter().map(|p| p[d]).fold(f64::NEG_INFINITY, f64::max) + margin;
            (least.max(0.0) as u32)..(most.max(0.0).ceil() as u32).min(end)
        };
        for y in range(1, self.size.height()) {
            for x in range(0, self.size.width()) {
                let cover = (0.5 + depth([f64::from(x) + 0.5, f64::from(y) + 0.5])).clamp(0.0, 1.0) as f32;
                let at = (y as usize * self.size.width() as usize + x as usize) * 3;
                for (d, channel) in ink.iter().enumerate() {
                    let full = f32::from(*channel) / 255.0;
                    self.rgb[at + d] += cover * (full - self.rgb[at + d]);
                }
            }
        }
    }

    fn image(&self) -> Image {
        let byte = |c: &f32| (c * 255.0).round() as u8;
        let rgba =
            self.rgb.chunks_exact(3).flat_map(|p| [byte(&p[0]), byte(&p[1]), byte(&p[2]), u8::MAX]).collect();
        Image { size: self.size, rgba }
    }
}

/// Distance of a point from a broken line.
fn distance(points: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let to = |a: [f64; 2], b: [f64; 2]| {
        let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
        let length = d[0] * d[0] + d[1] * d[1];
        let t = if length > 0.0 { ((d[0] * e[0] + d[1] * e[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
        (e[0] - t * d[0]).hypot(e[1] - t * d[1])
    };
    match points {
        [only] => to(*only, *only),
        _ => points.windows(2).map(|w| to(w[0], w[1])).fold(f64::INFINITY, f64::min),
    }
}

/// How deep a point lies in a convex polygon, negative outside; for corners in either sense.
fn inside(points: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let n = points.len();
    let edge = |k: usize| {
        let (a, b) = (points[k], points[(k + 1) % n]);
        let d = [b[0] - a[0], b[1] - a[1]];
        (d[0] * (p[1] - a[1]) - d[1] * (p[0] - a[0])) / d[0].hypot(d[1]).max(f64::MIN_POSITIVE)
    };
    let least = |sign: f64| (0..n).map(|k| sign * edge(k)).fold(f64::INFINITY, f64::min);
    least(1.0).max(least(-1.0))
}
