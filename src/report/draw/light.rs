//! Takes the solid items of a scene, gives the light that reaches a point: a sky, a ground, one broad key light.
//!
//! Every direction of light has its own depth map, so shadows and the darkening of crevices come from the same count.
//! Not promised: more than a map's texel of detail, light that bounces, or shadows of ghosts.

use super::camera::{Frame, View};
use super::layer::spans;
use super::scene::{Opacity, Scene, Shadow};
use glam::DVec3;
use rayon::prelude::*;

/// Directions of the sky and ground, spread evenly over the sphere.
const SKY: usize = 80;
/// Directions inside the key light, which give its shadow a soft edge.
const KEY: usize = 12;
/// Radius of the key light seen from the scene, in radians: about 7 degrees, a window across a room.
const KEY_RADIUS: f64 = 0.12;
/// Texels along one side of a depth map: two to a pixel of a picture 200 pixels high; soft light shows no more.
const MAP: usize = 400;
/// How far off the surface a point is looked up, in texels: one diagonal of the 2 x 2 that are blended.
const LIFT: f64 = 2.0;

/// Light of the upper and lower half sphere and of the key on a face turned to it, linear.
const SKY_LIGHT: [f64; 3] = [0.58, 0.60, 0.64];
const GROUND_LIGHT: [f64; 3] = [0.40, 0.38, 0.36];
const KEY_LIGHT: [f64; 3] = [0.52, 0.49, 0.44];

struct Lamp {
    toward: DVec3,
    colour: [f64; 3],
    /// None where nothing casts a shadow.
    map: Option<DepthMap>,
}

pub(super) struct Light {
    lamps: Vec<Lamp>,
}

impl Light {
    pub fn of(scene: &Scene, view: &View) -> Light {
        let solid: Vec<[DVec3; 3]> = solid_triangles(scene);
        let lamps = directions(view);
        let lamps = lamps
            .into_par_iter()
            .map(|(toward, colour)| Lamp { toward, colour, map: DepthMap::of(&solid, toward) })
            .collect();
        Light { lamps }
    }

    /// Linear light that leaves a white matte surface at `p` with unit normal `n`.
    pub fn at(&self, p: DVec3, n: DVec3) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for lamp in &self.lamps {
            let facing = n.dot(lamp.toward);
            if facing > 0.0 {
                let seen = facing * lamp.map.as_ref().map_or(1.0, |m| m.open(p, n));
                (0..3).for_each(|k| sum[k] += lamp.colour[k] * seen);
            }
        }
        sum
    }
}

fn solid_triangles(scene: &Scene) -> Vec<[DVec3; 3]> {
    let solid = scene.items.iter().filter(|i| i.opacity == Opacity::Solid && i.shadow == Shadow::Cast);
    solid
        .flat_map(|item| {
            let placed: Vec<DVec3> = item.points().collect();
            item.mesh.triangles.iter().map(move |t| t.corners.map(|c| placed[c as usize]))
        })
        .collect()
}

/// Directions toward the lamps with the light of each. The key stands over the viewer's left shoulder.
fn directions(view: &View) -> Vec<(DVec3, [f64; 3])> {
    // Lambert: a half sphere of radiance L gives pi L, its mean cosine is 1/2, so N lamps share twice the light.
    let sky = (0..SKY).map(|k| {
        let z = 1.0 - (2 * k + 1) as f64 / SKY as f64;
        let up = 0.5 + 0.5 * z;
        let colour =
            [0, 1, 2].map(|c| (GROUND_LIGHT[c] + up * (SKY_LIGHT[c] - GROUND_LIGHT[c])) * 4.0 / SKY as f64);
        (on_sphere(z, k as f64 * GOLDEN), colour)
    });
    let front = View { elevation: 30.0, ..*view };
    let frame = Frame::of(&front);
    let key = frame.placed(DVec3::new(-0.75, 0.95, 0.75)).normalize();
    let (u, v) = key.any_orthonormal_pair();
    let keys = (0..KEY).map(|k| {
        let r = KEY_RADIUS * ((k as f64 + 0.5) / KEY as f64).sqrt();
        let (s, c) = (k as f64 * GOLDEN).sin_cos();
        ((key + (u * c + v * s) * r).normalize(), KEY_LIGHT.map(|l| l / KEY as f64))
    });
    sky.chain(keys).collect()
}

/// Golden angle in radians: successive points of a spiral never line up.
const GOLDEN: f64 = 2.399_963_229_728_653;

fn on_sphere(z: f64, turn: f64) -> DVec3 {
    let r = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(r * turn.cos(), r * turn.sin(), z)
}

/// Height of the outermost surface along a direction, over a square grid across it.
struct DepthMap {
    u: DVec3,
    v: DVec3,
    toward: DVec3,
    low: [f64; 2],
    texel: f64,
    height: Vec<f32>,
}

impl DepthMap {
    fn of(triangles: &[[DVec3; 3]], toward: DVec3) -> Option<DepthMap> {
        let (u, v) = toward.any_orthonormal_pair();
        let flat = |p: &DVec3| DVec3::new(u.dot(*p), v.dot(*p), toward.dot(*p));
        // Of a closed solid only the faces turned to the lamp can be outermost.
        let facing = |[a, b, c]: &&[DVec3; 3]| (*b - *a).cross(*c - *a).dot(toward) > 0.0;
        let placed: Vec<[DVec3; 3]> = triangles.iter().filter(facing).map(|t| t.map(|p| flat(&p))).collect();
        let corners = || placed.iter().flatten();
        let lo = corners().fold(DVec3::INFINITY, |m, p| m.min(*p));
        let hi = corners().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
        // One texel of border on each side keeps the blended look-up inside.
        let texel = ((hi - lo).truncate().max_element() / (MAP - 4) as f64).max(f64::MIN_POSITIVE);
        let low = [lo.x - 2.0 * texel, lo.y - 2.0 * texel];
        let mut map = DepthMap { u, v, toward, low, texel, height: vec![f32::NEG_INFINITY; MAP * MAP] };
        placed.iter().for_each(|t| map.raise(t));
        (!placed.is_empty()).then_some(map)
    }

    fn raise(&mut self, [a, b, c]: &[DVec3; 3]) {
        let grid =
            |p: &DVec3| DVec3::new((p.x - self.low[0]) / self.texel, (p.y - self.low[1]) / self.texel, p.z);
        let height = &mut self.height;
        spans(&[grid(a), grid(b), grid(c)], 0..MAP, 0..MAP as i64, |y, xs, ramp| {
            for x in xs {
                let at = &mut height[y as usize * MAP + x];
                *at = at.max(ramp.at(x) as f32);
            }
        });
    }

    /// Share of the lamp seen from just above a face: 0 hidden to 1 open.
    fn open(&self, p: DVec3, face: DVec3) -> f64 {
        let p = p + (face + self.toward) * (LIFT * self.texel);
        let (x, y) = (
            (self.u.dot(p) - self.low[0]) / self.texel - 0.5,
            (self.v.dot(p) - self.low[1]) / self.texel - 0.5,
        );
        let h = self.toward.dot(p) as f32;
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let lit = |dx: i64, dy: i64| {
            let (i, j) = (x.floor() as i64 + dx, y.floor() as i64 + dy);
            let inside = (0..MAP as i64).contains(&i) && (0..MAP as i64).contains(&j);
            let hidden = inside && self.height[j as usize * MAP + i as usize] > h;
            if hidden { 0.0 } else { 1.0 }
        };
        (lit(0, 0) * (1.0 - fx) + lit(1, 0) * fx) * (1.0 - fy)
            + (lit(0, 1) * (1.0 - fx) + lit(1, 1) * fx) * fy
    }
}
