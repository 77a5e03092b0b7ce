//! Takes a closed solid, gives convex cells with disjoint interiors whose union it is.
//!
//! Space is cut along the planes of the solid's own facets until no facet is left inside a piece; a piece is
//! then all in or all out. A convex solid is its own one cell. Cost: cells grow with the square of the reflex
//! faces at worst; beyond [`MOST`] pieces or [`WORK`] it is given up. Promised: the cells' volumes add up to the solid's
//! (checked). Not promised: fewest cells.

pub(crate) mod polytope;
mod reach;

use super::shells::solid_angle;
use crate::solid::{Cell, Facet, Solid};
use glam::{DVec2, DVec3};
use polytope::{Plane, cuboid, halves, height, hull, measure};
use reach::Reach;
use std::collections::BTreeMap;

/// More pieces than this, in or out, are not made: the planner pairs the cells of two parts.
const MOST: usize = 4096;

/// Facets that all pieces may hold together while they are cut, counted anew in each piece: as if each of [`MOST`] held
/// two thousand. A surface of a million facets may so be cut eight times over before it is known not to fall into few pieces.
const WORK: usize = 2000 * MOST;

/// So many facets of a piece are tried as its next cut.
const TRIED: usize = 24;

/// Why a solid has no cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoCells {
    #[error("more than {MOST} pieces would be needed")]
    TooMany,
    #[error("too many facets for cutting it into {MOST} pieces at most")]
    TooFine,
    #[error("the pieces' volumes do not add up to the solid's within its resolution")]
    DoNotAddUp,
}

/// Convex cells of a solid; `width` is how far a corner may be off its face, in model units.
pub(super) fn cells(solid: &Solid, width: f64) -> Result<Vec<Cell>, NoCells> {
    let planes = planes(solid);
    let found = match whole(solid, &planes, width) {
        Some(cell) => vec![cell],
        None => pieces(solid, &planes, width)?,
    };
    let total: f64 = found.iter().map(|c| measure(c).0).sum();
    let surface: f64 = found.iter().map(|c| measure(c).1).sum();
    let exact = volume(solid);
    if (total - exact).abs() <= width * surface + f64::EPSILON * exact * found.len() as f64 {
        Ok(found)
    } else {
        Err(NoCells::DoNotAddUp)
    }
}

/// How far a corner of the cell stands off a facet of its own, or outside any plane.
pub(super) fn off(cell: &Cell) -> f64 {
    let reach = Reach::of(&cell.vertices);
    let of = |(&plane, facet): (&Plane, &Vec<u32>)| {
        let on = facet.iter().map(|&i| height(plane, cell.vertices[i as usize]).abs()).fold(0.0, f64::max);
        reach.above(plane).max(on)
    };
    cell.planes.iter().zip(&cell.facets).map(of).fold(0.0, f64::max)
}

/// Signed volume about a corner of the solid: nothing cancels far from the origin.
fn volume(solid: &Solid) -> f64 {
    let o = solid.vertices[0];
    let at = |i: u32| solid.vertices[i as usize] - o;
    solid.triangles().map(|[a, b, c]| at(a).dot(at(b).cross(at(c))) / 6.0).sum()
}

/// The plane of each facet: its face's normal, through the middle of its corners.
fn planes(solid: &Solid) -> Vec<Plane> {
    let plane = |f: &Facet| {
        let middle =
            f.corners.iter().map(|&i| solid.vertices[i as usize]).sum::<DVec3>() / f.corners.len() as f64;
        (f.normal, f.normal.dot(middle))
    };
    solid.facets.iter().map(plane).collect()
}

/// The solid as one cell, if every corner lies behind every facet.
fn whole(solid: &Solid, planes: &[Plane], width: f64) -> Option<Cell> {
    let reach = Reach::of(&solid.vertices);
    if planes.iter().any(|&p| reach.beyond(p, width)) {
        return None;
    }
    let mut faces: BTreeMap<[u64; 3], (Plane, Vec<u32>)> = BTreeMap::new();
    for (f, p) in solid.facets.iter().zip(planes) {
        let key = f.normal.to_array().map(f64::to_bits);
        faces.entry(key).or_insert((*p, Vec::new())).1.extend(&f.corners);
    }
    let mut cell = Cell { vertices: solid.vertices.clone(), ..Cell::default() };
    for (plane, corners) in faces.into_values() {
        cell.facets.push(rim(&solid.vertices, corners, plane.0, width));
        cell.planes.push(plane);
    }
    Some(polytope::used_only(cell))
}

/// The corners of a convex face cut into facets, without those inside it or on its sides.
fn rim(points: &[DVec3], mut corners: Vec<u32>, normal: DVec3, width: f64) -> Vec<u32> {
    corners.sort_unstable();
    corners.dedup();
    let (u, v) = normal.any_orthonormal_pair();
    let o = points[corners[0] as usize];
    let flat = |&i: &u32| DVec2::new((points[i as usize] - o).dot(u), (points[i as usize] - o).dot(v));
    let hull = hull(&corners.iter().map(flat).collect::<Vec<_>>(), width);
    hull.into_iter().map(|k| corners[k]).collect()
}

/// A stretch of the boundary inside a piece.
#[derive(Clone)]
struct Scrap {
    plane: Plane,
    ring: Vec<DVec3>,
}

fn pieces(solid: &Solid, planes: &[Plane], width: f64) -> Result<Vec<Cell>, NoCells> {
    let ring = |f: &Facet| f.corners.iter().map(|&i| solid.vertices[i as usize]).collect();
    let scraps = solid.facets.iter().zip(planes).map(|(f, &plane)| Scrap { plane, ring: ring(f) }).collect();
    let (lo, hi) = solid
        .vertices
        .iter()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    // Wide enough that no side of the box is a face of the solid.
    let room = DVec3::splat((hi - lo).max_element());
    let mut open: Vec<(Cell, Vec<Scrap>)> = vec![(cuboid(lo - room, hi + room), scraps)];
    let (mut inside, mut made, mut work) = (Vec::new(), 0, 0);
    while let Some((cell, scraps)) = open.pop() {
        (made, work) = (made + 1, work + scraps.len());
        if made > MOST {
            return Err(NoCells::TooMany);
        }
        if work > WORK {
            return Err(NoCells::TooFine);
        }
        if scraps.is_empty() {
            let (volume, surface) = measure(&cell);
            if volume > width * surface && holds(solid, &cell) {
                inside.push(cell);
            }
            continue;
        }
        let plane = best(&scraps, width);
        let (below, above) = halves(&cell, plane, width);
        let (low, high) = sorted(scraps, plane, width);
        open.extend(above.map(|c| (c, high)));
        open.extend(below.map(|c| (c, low)));
    }
    Ok(inside)
}

/// Whether the cell, which no facet crosses, is inside.
fn holds(solid: &Solid, cell: &Cell) -> bool {
    let middle = cell.vertices.iter().sum::<DVec3>() / cell.vertices.len() as f64;
    let seen = |[a, b, c]: [u32; 3]| {
        let [a, b, c] = [a, b, c].map(|i| solid.vertices[i as usize] - middle);
        solid_angle(a, b, c)
    };
    // Half way between no turn and one.
    solid.triangles().map(seen).sum::<f64>() > 2.0 * std::f64::consts::PI
}

/// The plane, of those tried, that cuts the fewest scraps; of those the one with most scraps in its own plane
/// or below.
fn best(scraps: &[Scrap], width: f64) -> Plane {
    let step = scraps.len().div_ceil(TRIED);
    let cost = |plane: Plane| {
        let sides: Vec<Side> = scraps.iter().map(|s| side(s, plane, width)).collect();
        let count = |x: Side| sides.iter().filter(|&&s| s == x).count();
        (count(Side::Across), count(Side::Above))
    };
    let tried = scraps.iter().step_by(step).map(|s| s.plane);
    tried.min_by_key(|&p| cost(p)).unwrap_or(scraps[0].plane)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    On,
    Below,
    Above,
    Across,
}

fn side(s: &Scrap, plane: Plane, width: f64) -> Side {
    let heights = s.ring.iter().map(|&p| height(plane, p));
    let (lo, hi) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), h| (lo.min(h), hi.max(h)));
    match (lo < -width, hi > width) {
        (false, false) => Side::On,
        (true, false) => Side::Below,
        (false, true) => Side::Above,
        (true, true) => Side::Across,
    }
}

/// The scraps below and above; those in the plane have done their work.
fn sorted(scraps: Vec<Scrap>, plane: Plane, width: f64) -> (Vec<Scrap>, Vec<Scrap>) {
    let (mut low, mut high) = (Vec::new(), Vec::new());
    for s in scraps {
        match side(&s, plane, width) {
            Side::On => {}
            Side::Below => low.push(s),
            Side::Above => high.push(s),
            Side::Across => {
                low.push(Scrap { plane: s.plane, ring: below(&s.ring, plane) });
                high.push(Scrap { plane: s.plane, ring: below(&s.ring, (-plane.0, -plane.1)) });
            }
        }
    }
    (low, high)
}

/// The part of a convex ring below the plane.
fn below(ring: &[DVec3], plane: Plane) -> Vec<DVec3> {
    let mut out = Vec::with_capacity(ring.len() + 1);
    for k in 0..ring.len() {
        let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
        let (h, g) = (height(plane, a), height(plane, b));
        if h <= 0.0 {
            out.push(a);
        }
        if (h < 0.0 && g > 0.0) || (h > 0.0 && g < 0.0) {
            out.push(a.lerp(b, h / (h - g)));
        }
    }
    out
}
