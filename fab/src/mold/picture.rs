//! Takes coloured meshes; gives a PNG of them seen from above at a slant, nearer things before farther ones.
//!
//! Not promised: anything to measure by; orthographic, one light, no shadows.

use crate::mesh::Mesh;
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

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

/// Rows of pixels that are painted together: what is painted then stays in the processor's cache. A divisor of `HIGH`.
const BAND: usize = 25;

/// A triangle on the canvas: x to the right and y down in fine pixels, z toward the eye; and the number of its colour.
struct Face {
    corners: [DVec3; 3],
    colour: u32,
}

/// Some rows of the picture.
struct Band {
    first: usize,
    /// For each fine pixel the number of its colour; 0 is the paper.
    colour: Vec<u32>,
    depth: Vec<f64>,
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
    let size = DVec2::new((WIDE * FINE) as f64, (HIGH * FINE) as f64);
    let room = size * (1.0 - 2.0 * BORDER);
    let scale = (room / (hi - lo).truncate().max(DVec2::splat(f64::MIN_POSITIVE))).min_element();
    let middle = (lo + hi) / 2.0;
    let place = |p: DVec3| {
        let d = (p - middle) * scale;
        DVec3::new(size.x / 2.0 + d.x, size.y / 2.0 - d.y, p.z)
    };
    let (mut faces, mut colours) = (Vec::with_capacity(all.len() / 3), vec![[255.0; 3]]);
    for body in bodies {
        for t in 0..body.mesh.triangles.len() {
            let c = body.mesh.corners(t).map(|v| eye * (v + body.shift));
            let colour = body.colours.get(t).or(body.colours.first()).copied().unwrap_or([200; 3]);
            faces.push(Face { corners: c.map(place), colour: colours.len() as u32 });
            colours.push(shaded(c, colour));
        }
    }
    let band = |k: usize| Band::painted(k * BAND, &faces).pixels(&colours);
    encoded(&(0..HIGH / BAND).into_par_iter().flat_map_iter(band).collect::<Vec<u8>>())
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

/// The pixels of a row that a triangle can cover: where its edges cross the row, and a pixel more on each side.
fn row(c: &[DVec3; 3], y: f64) -> (f64, f64) {
    let crossing = |k: usize| {
        let (a, b) = (c[k], c[(k + 1) % 3]);
        let spans = a.y.min(b.y) - 1.0 <= y && y <= a.y.max(b.y) + 1.0;
        let t = if a.y == b.y { 0.0 } else { ((y - a.y) / (b.y - a.y)).clamp(0.0, 1.0) };
        spans.then_some([a.x + (b.x - a.x) * t, if a.y == b.y { b.x } else { a.x + (b.x - a.x) * t }])
    };
    let all = (0..3).filter_map(crossing).flatten();
    let (lo, hi) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    (lo.floor() - 1.0, hi.ceil() + 1.0)
}

impl Band {
    fn painted(first: usize, faces: &[Face]) -> Band {
        let fine = WIDE * FINE * BAND * FINE;
        let mut band = Band { first, colour: vec![0; fine], depth: vec![f64::NEG_INFINITY; fine] };
        faces.iter().for_each(|f| band.paint(f));
        band
    }

    fn paint(&mut self, Face { corners: c, colour }: &Face) {
        let cross = |a: DVec3, b: DVec3, x: f64, y: f64| (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
        let whole = cross(c[0], c[1], c[2].x, c[2].y);
        if whole == 0.0 {
            return;
        }
        let (low, high) = c.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.y), h.max(p.y)));
        let (from, to) = (self.first * FINE, (self.first + BAND) * FINE);
        for y in from.max(low.floor().max(0.0) as usize)..to.min(high.ceil().max(0.0) as usize) {
            let (left, right) = row(c, y as f64 + 0.5);
            for x in left.max(0.0) as usize..(right.max(0.0) as usize).min(WIDE * FINE) {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let w = [cross(c[1], c[2], px, py), cross(c[2], c[0], px, py), cross(c[0], c[1], px, py)];
                if !w.iter().all(|v| v * whole.signum() >= 0.0) {
                    continue;
                }
                let z = (w[0] * c[0].z + w[1] * c[1].z + w[2] * c[2].z) / whole;
                let here = (y - from) * WIDE * FINE + x;
                if z > self.depth[here] {
                    self.depth[here] = z;
                    self.colour[here] = *colour;
                }
            }
        }
    }

    /// Red, green and blue of each pixel, row by row.
    fn pixels(&self, colours: &[[f64; 3]]) -> Vec<u8> {
        let pixel = |p: usize| {
            let (x, y) = (p % WIDE * FINE, p / WIDE * FINE);
            let of = |i: usize| self.colour[(y + i / FINE) * WIDE * FINE + x + i % FINE];
            let all: [u32; FINE * FINE] = std::array::from_fn(of);
            if all.iter().all(|n| *n == all[0]) {
                return colours[all[0] as usize].map(|c| c.round() as u8);
            }
            let mean = |k: usize| all.iter().map(|n| colours[*n as usize][k]).sum::<f64>() / all.len() as f64;
            [0, 1, 2].map(|k| mean(k).round() as u8)
        };
        (0..WIDE * BAND).flat_map(pixel).collect()
    }
}

fn encoded(pixels: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, WIDE as u32, HIGH as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // Writing into memory does not fail; were it to, the picture would be empty and be seen to be.
    let _ = encoder.write_header().and_then(|mut w| w.write_image_data(pixels));
    out
}
