//! Takes patterns of a part; gives the tree for lost wax: runner with a cup, patterns on gates at their thickest section,
//! flask, and what to mix, melt and burn.
//!
//! Feeding is judged by the modulus V/A alone, gates and runner as long cylinders. Not promised: a casting without
//! shrinkage; the thickest section is the widest ball found inside the part from a few hundred points of its surface.

use crate::bvh::Bvh;
use crate::mesh::{Mesh, area};
use crate::mold::figures::Figures;
use crate::mold::ray;
use crate::near::on_triangle;
use crate::solid::{NotSolid, Solid, frustum, turned};
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Where a pattern is fed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// On the surface, and the way out there.
    pub at: DVec3,
    pub out: DVec3,
    /// Diameter of the ball inside, mm.
    pub thick: f64,
}

/// A tree and its measures.
pub struct Tree {
    pub solid: Solid,
    /// Diameters, mm.
    pub runner: f64,
    pub gate: f64,
    /// The pattern, its gate along -x at the origin.
    pub lying: Mesh,
    /// The gate along x from the runner's middle, and the runner with its cup.
    pub bar: Mesh,
    pub stem: Mesh,
    /// Where gates and patterns stand, these `reach` along x from the runner's middle.
    pub places: Vec<DAffine3>,
    /// From the runner's middle to the pattern, and on into it, mm.
    pub reach: f64,
    pub into: f64,
    /// Gates from the lowest: height and how many stand there; metal fills them in this order.
    pub levels: Vec<(f64, usize)>,
    pub radius: f64,
    pub foot: f64,
    pub top: f64,
    /// Lengths V/A, mm.
    pub moduli: Moduli,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moduli {
    pub pattern: f64,
    pub gate: f64,
    pub runner: f64,
}

/// Facets whose balls are measured.
const BALLS: usize = 400;

/// Balls under evenly chosen facets, by facet.
pub fn balls(part: &Mesh) -> Vec<(usize, Section)> {
    let tree = Bvh::new(part);
    let step = part.triangles.len().div_ceil(BALLS).max(1);
    let of = |t: usize| {
        let c = part.corners(t);
        let out = (c[1] - c[0]).cross(c[2] - c[0]).normalize_or_zero();
        let at = c.iter().sum::<DVec3>() / 3.0;
        let through = ray::first((part, &tree), at, -out, 1e-6 * area(c).sqrt())?.at;
        let middle = at - out * (through / 2.0);
        let near = (0..part.triangles.len()).map(|k| on_triangle(middle, part.corners(k)).distance(middle));
        Some((t, Section { at, out, thick: 2.0 * near.fold(through / 2.0, f64::min) }))
    };
    (0..part.triangles.len()).into_par_iter().step_by(step).filter_map(of).collect()
}

/// The thickest section that a straight gate reaches from outside.
pub fn thickest(part: &Mesh, balls: &[(usize, Section)]) -> Option<Section> {
    let tree = Bvh::new(part);
    let free = |s: &&Section| !ray::any((part, &tree), s.at + s.out * 1e-6, s.out, 0.0);
    let mut all: Vec<&Section> = balls.iter().map(|b| &b.1).collect();
    all.sort_by(|a, b| b.thick.total_cmp(&a.thick));
    all.into_iter().find(free).copied()
}

/// Balls at least this many times thicker than the gate's section freeze after it: hot spots of their own.
pub fn hot_spots(balls: &[(usize, Section)], gate: &Section, step: f64) -> Vec<Section> {
    let hot = |s: &Section| s.thick > gate.thick * step;
    balls.iter().map(|b| b.1).filter(hot).collect()
}

/// Air between patterns, mm: investment thinner than this breaks.
const BETWEEN: f64 = 10.0;

/// A gate is at least as long as this share of its width, so that it can be sawn off.
const NECK: f64 = 0.5;

/// A tree of `count` patterns, or of fewer where not all fit on one.
pub fn tree(part: &Mesh, at: &Section, count: usize, f: &Figures) -> Result<Tree, NotSolid> {
    let gate = gate(part, at, f);
    let runner = runner(gate, f);
    // The way out at the gate turns to -x, toward the runner; the gate is the x axis.
    let turn = toward_runner(at.out);
    let lying = part.map(|v| turn * (v - at.at));
    let (lo, hi) = lying.bounds();
    let reach = runner / 2.0 + (BETWEEN - lo.x).max(NECK * gate);
    let near = reach + lo.x;
    let half = lo.y.abs().max(hi.y.abs()) + BETWEEN / 2.0;
    let ring = ((PI / (half / near.max(f64::MIN_POSITIVE)).atan()).floor() as usize).max(1);
    let pitch = (hi.z - lo.z) + BETWEEN;
    let count = evenly(count, ring * rows_in(f, runner, pitch));
    let rows = count.div_ceil(ring);
    let pattern = Solid::of(&lying)?;
    let into = at.thick / 2.0;
    let bar = Solid::of(&lying_gate(reach, into, gate))?;
    let (mut bodies, mut levels, mut places) = (vec![], vec![], vec![]);
    for row in 0..rows {
        let here = ring.min(count - row * ring);
        let height = BETWEEN - lo.z + pitch * row as f64;
        levels.push((height, here));
        for k in 0..here {
            let around = DMat3::from_rotation_z(2.0 * PI * k as f64 / here as f64);
            let place = DAffine3::from_mat3_translation(around, DVec3::Z * height);
            let placed = |m: &Mesh, shift: f64| {
                Solid::of(&m.map(|v| place.transform_point3(v + DVec3::new(shift, 0.0, 0.0))))
            };
            bodies.push(placed(&pattern.mesh(), reach)?);
            bodies.push(placed(&bar.mesh(), 0.0)?);
            places.push(place);
        }
    }
    let top = 2.0 * BETWEEN + pitch * rows as f64;
    let stem = turned(DVec3::ZERO, &[(0.0, runner / 2.0), (top, runner / 2.0), (top + runner, runner)]);
    bodies.push(Solid::of(&stem)?);
    let solid = Solid::all(bodies);
    let radius = solid.mesh().vertices.iter().map(|v| v.truncate().length()).fold(0.0, f64::max);
    let moduli = Moduli { pattern: part.volume() / part.area(), gate: gate / 4.0, runner: runner / 4.0 };
    let foot = solid.mesh().bounds().0.z;
    let (bar, top) = (bar.mesh(), top + runner);
    Ok(Tree { solid, runner, gate, lying, bar, stem, places, reach, into, levels, radius, foot, top, moduli })
}

/// Rows of patterns in a flask of the height of the figures, at least one; `pitch`: from row to row, mm.
fn rows_in(f: &Figures, runner: f64, pitch: f64) -> usize {
    let room = f.flask_height.value - f.flask_wall.value - 2.0 * BETWEEN - runner;
    ((room / pitch).floor() as usize).max(1)
}

/// Patterns on each of as few trees as hold all, the last with as many or fewer.
fn evenly(count: usize, most: usize) -> usize {
    count.div_ceil(count.div_ceil(most).max(1))
}

/// The gate's diameter, mm: of the area asked for, and up to the most of its range where its modulus asks for more.
fn gate(part: &Mesh, at: &Section, f: &Figures) -> f64 {
    let of_area = |percent: f64| at.thick * (percent / 100.0).sqrt();
    let feeding = 4.0 * f.modulus_step.value * part.volume() / part.area();
    feeding.clamp(of_area(f.feed_area.value), of_area(f.feed_area.high.max(f.feed_area.value)))
}

/// The runner's diameter, mm: what is asked for, or as much more as its modulus needs to exceed the gate's by a step. Its
/// cup widens to twice that, so that the modulus rises all the way to where the metal comes in.
fn runner(gate: f64, f: &Figures) -> f64 {
    f.runner.value.max(gate * f.modulus_step.value)
}

/// A rotation that takes `out` to -x and keeps z as far up as it can be.
fn toward_runner(out: DVec3) -> DMat3 {
    let x = -out.normalize();
    let up = if x.z.abs() < 0.9 { DVec3::Z } else { DVec3::X };
    let y = up.cross(x).normalize();
    DMat3::from_cols(x, y, x.cross(y)).transpose()
}

/// A bar along x from the runner's middle into the pattern.
fn lying_gate(reach: f64, into: f64, diameter: f64) -> Mesh {
    frustum(DVec3::ZERO, reach + into, diameter / 2.0, diameter / 2.0).map(|v| DVec3::new(v.z, v.y, -v.x))
}

/// The flask's inner radius and its floor and rim heights.
pub fn flask(tree: &Tree, f: &Figures) -> (f64, f64, f64) {
    (tree.radius + f.flask_wall.value, tree.foot - f.flask_wall.value, tree.top)
}
