//! Takes coloured meshes; gives a PNG of them seen from above at a slant, nearer things before farther ones.
//!
//! Not promised: anything to measure by; orthographic, one light, no shadows.

use crate::mesh::Mesh;
use glam::{DMat3, DVec2, DVec3};

/// A mesh with one colour for each triangle (or one for all).
pub struct Painted<'a> {
    pub mesh: &'a Mesh,
    pub colours: Vec<[u8; 3]>,
    pub shift: DVec3,
}

const WIDE: usize = 1000;
const HIGH: usize = 750;

/// Each pixel is the mean of this many by this many.
const FINE: usize = 2;

/// Left free at the border, share of the picture.
const BORDER: f64 = 0.05;

struct Canvas {
    colour: Vec<[f64; 3]>,
    depth: Vec<f64>,
    wide: usize,
    high: usize,
}

/// Seen from where `turn` degrees around z and `tilt` degrees above the ground leads.
pub fn png(bodies: &[Painted], turn: f64, tilt: f64) -> Vec<u8> {
    let eye = view(turn, tilt);
    let corners = |b: &Painted| {
        b.mesh
            .triangles
            .iter()
            .flatten()
            .map(|&v| eye * (b.mesh.vertices[v as usize] + b.shift))
            .collect::<Vec<_>>()
    };
    let all: Vec<DVec3> = bodies.iter().flat_map(corners).collect();
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (lo, hi) = all.iter().fold(start, |(l, h), p| (l.min(*p), h.max(*p)));
    let mut canvas = Canvas::new(WIDE * FINE, HIGH * FINE);
    if all.is_empty() {
        return canvas.encoded();
    }
    let room = DVec2::new(canvas.wide as f64, canvas.high as f64) * (1.0 - 2.0 * BORDER);
    let scale = (room / (hi - lo).truncate().max(DVec2::splat(f64::MIN_POSITIVE))).min_element();
    let (middle, centre) = ((lo + hi) / 2.0, DVec2::new(canvas.wide as f64, canvas.high as f64) / 2.0);
    let place = |p: DVec3| {
        let d = (p - middle) * scale;
        DVec3::new(centre.x + d.x, centre.y - d.y, p.z)
    };
    for body in bodies {
        for t in 0..body.mesh.triangles.len() {
            let c = body.mesh.corners(t).map(|v| eye * (v + body.shift));
            let colour = body.colours.get(t).or(body.colours.first()).copied().unwrap_or([200; 3]);
            canvas.paint(c.map(place), shaded(c, colour));
        }
    }
    canvas.encoded()
}

/// Rows: right, up, toward the eye.
fn view(turn: f64, tilt: f64) -> DMat3 {
    let (st, ct) = turn.to_radians().sin_cos();
    let (su, cu) = tilt.to_radians().sin_cos();
    let (right, toward) = (DVec3::new(ct, st, 0.0), DVec3::new(st * cu, -ct * cu, su));
    DMat3::from_cols(right, toward.cross(right), toward).transpose()
}

fn shaded(c: [DVec3; 3], colour: [u8; 3]) -> [f64; 3] {
    let n = (c[1] - c[0]).cross(c[2] - c[0]).normalize_or_zero();
    let light = DVec3::new(-0.4, 0.5, 0.77);
    let bright = 0.35 + 0.65 * n.dot(light).max(0.0);
    colour.map(|x| f64::from(x) * bright)
}

impl Canvas {
    fn new(wide: usize, high: usize) -> Canvas {
        Canvas {
            colour: vec![[255.0; 3]; wide * high],
            depth: vec![f64::NEG_INFINITY; wide * high],
            wide,
            high,
        }
    }

    fn paint(&mut self, c: [DVec3; 3], colour: [f64; 3]) {
        let cross = |a: DVec3, b: DVec3, x: f64, y: f64| (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
        let whole = cross(c[0], c[1], c[2].x, c[2].y);
        if whole == 0.0 {
            return;
        }
        let span = |f: fn(&DVec3) -> f64, most: usize| {
            let (lo, hi) = c.iter().map(f).fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v), h.max(v)));
            (lo.floor().max(0.0) as usize, (hi.ceil().max(0.0) as usize).min(most))
        };
        let ((x0, x1), (y0, y1)) = (span(|p| p.x, self.wide), span(|p| p.y, self.high));
        for y in y0..y1 {
            for x in x0..x1 {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let w = [cross(c[1], c[2], px, py), cross(c[2], c[0], px, py), cross(c[0], c[1], px, py)];
                let inside = w.iter().all(|v| v / whole >= 0.0);
                let z = (w[0] * c[0].z + w[1] * c[1].z + w[2] * c[2].z) / whole;
                if inside && z > self.depth[y * self.wide + x] {
                    self.depth[y * self.wide + x] = z;
                    self.colour[y * self.wide + x] = colour;
                }
            }
        }
    }

    fn encoded(&self) -> Vec<u8> {
        let mean = |x: usize, y: usize, k: usize| {
            let of = |i: usize| self.colour[(y * FINE + i / FINE) * self.wide + x * FINE + i % FINE][k];
            ((0..FINE * FINE).map(of).sum::<f64>() / (FINE * FINE) as f64).round() as u8
        };
        let pixel = |p: usize| [0, 1, 2].map(|k| mean(p % WIDE, p / WIDE, k));
        let pixels: Vec<u8> = (0..WIDE * HIGH).flat_map(pixel).collect();
        let mut out = Vec::new();
        let mut encoder = png::Encoder::new(&mut out, WIDE as u32, HIGH as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        // Writing into memory does not fail; were it to, the picture would be empty and be seen to be.
        let _ = encoder.write_header().and_then(|mut w| w.write_image_data(&pixels));
        out
    }
}
