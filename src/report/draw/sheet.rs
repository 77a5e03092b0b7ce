//! Takes flat marks (rectangles, lines, polygons, words); gives them as SVG, and as PNG with words in strokes.
//!
//! Promised: the same marks give the same bytes; no font file is needed. Not promised: that words are as wide in both
//! (a viewer brings its own font to the SVG), so nothing may depend on their end.

use super::image::{BadSize, Image, Size};
use super::strokes;
use std::collections::BTreeMap;
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
            Mark::Fill { points, ink } => self.fill(points, *ink),
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

    /// A line with round ends and joints; a pixel near several of its pieces is covered by the nearest alone.
    fn line(&mut self, points: &[[f64; 2]], ink: Rgb, width: f64) {
        let pixels = self.pixels(points);
        let radius = width * self.scale / 2.0;
        let mut cover: BTreeMap<(usize, usize), f64> = BTreeMap::new();
        for piece in pixels.windows(pixels.len().clamp(1, 2)) {
            let (a, b) = (piece[0], piece[piece.len() - 1]);
            let range = |d: usize, end: u32| {
                let (least, most) = (a[d].min(b[d]) - radius - 1.0, a[d].max(b[d]) + radius + 1.0);
                least.max(0.0) as usize..(most.max(0.0).ceil() as usize).min(end as usize)
            };
            for y in range(1, self.size.height()) {
                for x in range(0, self.size.width()) {
                    let depth = radius - distance(a, b, [x as f64 + 0.5, y as f64 + 0.5]);
                    let most = cover.entry((y, x)).or_insert(0.0);
                    *most = most.max((0.5 + depth).clamp(0.0, 1.0));
                }
            }
        }
        cover.into_iter().for_each(|((y, x), share)| self.mix(x, y, share, ink));
    }

    /// What an odd number of turns of the outline goes around: any outline, convex or not, corners repeated or not.
    fn fill(&mut self, points: &[[f64; 2]], ink: Rgb) {
        let pixels = self.pixels(points);
        let least = pixels.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min).max(0.0) as usize;
        let most = pixels.iter().map(|p| p[1]).fold(0.0, f64::max).ceil() as usize;
        let width = self.size.width() as usize;
        for y in least..most.min(self.size.height() as usize) {
            let mut cover = vec![0.0; width];
            for row in 0..ROWS {
                let height = y as f64 + (row as f64 + 0.5) / ROWS as f64;
                for ends in crossings(&pixels, height).chunks_exact(2) {
                    let (from, to) = (ends[0].max(0.0), ends[1].min(width as f64));
                    for (x, share) in
                        cover.iter_mut().enumerate().take(to.ceil() as usize).skip(from as usize)
                    {
                        *share += (to.min(x as f64 + 1.0) - from.max(x as f64)).max(0.0) / ROWS as f64;
                    }
                }
            }
            let seen = cover.into_iter().enumerate().filter(|(_, share)| *share > 0.0);
            seen.for_each(|(x, share)| self.mix(x, y, share, ink));
        }
    }

    /// Ink over a share of a pixel.
    fn mix(&mut self, x: usize, y: usize, share: f64, ink: Rgb) {
        let at = (y * self.size.width() as usize + x) * 3;
        for (d, channel) in ink.iter().enumerate() {
            self.rgb[at + d] += share as f32 * (f32::from(*channel) / 255.0 - self.rgb[at + d]);
        }
    }

    fn image(&self) -> Image {
        let byte = |c: &f32| (c * 255.0).round() as u8;
        let rgba =
            self.rgb.chunks_exact(3).flat_map(|p| [byte(&p[0]), byte(&p[1]), byte(&p[2]), u8::MAX]).collect();
        Image { size: self.size, rgba }
    }
}

/// Lines across each row of pixels along which a fill's ends are taken.
const ROWS: usize = 4;

/// Where a closed outline crosses a height, rising; an even number.
fn crossings(points: &[[f64; 2]], height: f64) -> Vec<f64> {
    let side = |k: usize| {
        let (a, b) = (points[k], points[(k + 1) % points.len()]);
        let crosses = (a[1] <= height) != (b[1] <= height);
        crosses.then(|| a[0] + (height - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
    };
    let mut found: Vec<f64> = (0..points.len()).filter_map(side).collect();
    found.sort_by(f64::total_cmp);
    found
}

/// Distance of a point from a piece of a line.
fn distance(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = d[0] * d[0] + d[1] * d[1];
    let t = if length > 0.0 { ((d[0] * e[0] + d[1] * e[1]) / length).clamp(0.0, 1.0) } else { 0.0 };
    (e[0] - t * d[0]).hypot(e[1] - t * d[1])
}
