//! Takes the sites of a weave and one of them; gives its cell with integer vertices, relative to its unit square.
//!
//! A cell depends on nothing but the sites around it, so congruent places give bit-identical cells. Exact up to the
//! one rounding of each vertex; where that (or co-sphericity) makes corners coincide they are one vertex.

use super::cell::{Cell, WALLS};
use super::exact::{Grid, Neighbour, REACH, SITE_BITS, VERTEX_BITS};
use crate::sites::{Faces, Side, Site, Sites};

/// What lies on the other side of a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Across {
    Site(Site),
    /// The flat end of the prism.
    Face(Side),
}

/// Vertex in units of 2^-[`VERTEX_BITS`] crossing.
pub type Vertex = [i64; 3];

/// A Voronoi cell. Sites across and vertices are relative to the unit square of the cell's own site.
#[derive(Clone, Debug)]
pub struct Voronoi {
    pub vertices: Vec<Vertex>,
    pub faces: Vec<Face>,
}

#[derive(Clone, Debug)]
pub struct Face {
    pub across: Across,
    /// Indices into [`Voronoi::vertices`], counter-clockwise from outside; at least three.
    pub corners: Vec<u32>,
    /// From the site to its partner, and the point halfway, in grid units relative to the unit square, doubled.
    pub step: Grid,
    pub twice_middle: Grid,
}

/// A cell that reaches farther than the exact arithmetic: the weave leaves too much room there.
#[derive(Debug, thiserror::Error)]
#[error(
    "the tile at crossing ({x}, {y}) reaches farther than {reach} crossings; bring the planes or strands nearer"
)]
pub struct Unbounded {
    pub x: i32,
    pub y: i32,
    pub reach: i64,
}

/// The cell of `site`.
pub fn cell(sites: &Sites, site: Site) -> Result<Voronoi, Unbounded> {
    let own = sites.at(site);
    let mut cell = Cell::new(own);
    let mut names = Vec::new();
    if let Faces::Flat { below, above } = sites.faces {
        for (side, z) in [(Side::Below, below), (Side::Above, above)] {
            if cell.clip(Neighbour { at: [0, 0, 2 * (z - own[2])], rank: own }) {
                names.push(Across::Face(side));
            }
        }
    }
    let far = || Unbounded { x: site.x, y: site.y, reach: REACH >> SITE_BITS };
    for ring in 0.. {
        let ring_at_least = i64::from(ring - 1).max(0) << SITE_BITS;
        if ring_at_least as f64 * ring_at_least as f64 > cell.search_squared() {
            break;
        }
        // Sites of this ring may be farther than the exact arithmetic reaches.
        if ring_at_least + (3 << SITE_BITS) > REACH {
            return Err(far());
        }
        clip_ring(sites, site, ring, &mut cell, &mut names);
    }
    Ok(finish(own, site, &cell, &names))
}

/// Clips by the sites of the unit squares at Chebyshev distance `ring`, nearest first.
fn clip_ring(sites: &Sites, site: Site, ring: i32, cell: &mut Cell, names: &mut Vec<Across>) {
    let own = sites.at(site);
    let within = cell.search_squared();
    let mut found: Vec<(i64, Site, Grid)> = Vec::new();
    for (dx, dy) in square_ring(ring) {
        for other in sites.in_square(site.x + dx, site.y + dy) {
            let p = sites.at(other);
            let at = [p[0] - own[0], p[1] - own[1], p[2] - own[2]];
            let square = at.iter().map(|c| c * c).sum::<i64>();
            if square as f64 <= within && other != site {
                found.push((square, other, at));
            }
        }
    }
    found.sort_unstable_by_key(|f| (f.0, f.1));
    for (square, other, at) in found {
        if square as f64 > cell.search_squared() {
            break;
        }
        if cell.clip(Neighbour { at, rank: sites.at(other) }) {
            names.push(Across::Site(Site { x: other.x - site.x, y: other.y - site.y, ..other }));
        }
    }
}

fn square_ring(r: i32) -> impl Iterator<Item = (i32, i32)> {
    (-r..=r).flat_map(move |y| (-r..=r).map(move |x| (x, y))).filter(move |(x, y)| x.abs().max(y.abs()) == r)
}

fn finish(own: Grid, site: Site, cell: &Cell, names: &[Across]) -> Voronoi {
    let corner = [i64::from(site.x) << SITE_BITS, i64::from(site.y) << SITE_BITS, 0];
    let local = [0, 1, 2].map(|d| own[d] - corner[d]);
    let places: Vec<Vertex> = cell.corners().iter().map(|c| c.rounded(local)).collect();
    let mut vertices = places.clone();
    vertices.sort_unstable();
    vertices.dedup();
    let index: Vec<u32> = places.iter().map(|p| vertices.binary_search(p).unwrap_or(0) as u32).collect();
    let faces = cell.faces().into_iter().filter_map(|f| {
        let corners = merged(f.corners.iter().map(|&k| index[k as usize]));
        let step = cell.step(f.neighbour);
        let twice_middle = [0, 1, 2].map(|d| 2 * local[d] + step[d]);
        let across = names[f.neighbour as usize - WALLS];
        (corners.len() >= 3).then_some(Face { across, corners, step, twice_middle })
    });
    Voronoi { faces: faces.collect(), vertices }
}

/// A loop without repeats of the same vertex in a row.
fn merged(corners: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut kept: Vec<u32> = corners.collect();
    kept.dedup();
    while kept.len() > 1 && kept.first() == kept.last() {
        kept.pop();
    }
    kept
}

/// A vertex as f64, in crossings; exact within 4,096 crossings of the origin.
pub fn place(v: Vertex) -> glam::DVec3 {
    glam::DVec3::from_array(v.map(|c| c as f64 / (1_i64 << VERTEX_BITS) as f64))
}
