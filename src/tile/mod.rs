//! Takes sites; gives one closed solid for each orbit of pieces, with its convex cells and the two sites of each facet.
//!
//! Promised, and checked for every tile: a closed, oriented 2-manifold of genus 0; vertices shared by identity (one
//! integer triple, found alike from every cell). Not promised: more than the cells of the sampled sites; the chord
//! error against the curved bisectors is the samples'.

mod cell;
pub mod exact;
mod lattice;
mod manifold;
mod voronoi;

pub use lattice::Lattice;
pub use manifold::NotASolid;
pub use voronoi::{Across, Unbounded};

use crate::sites::{Owner, Site, Sites};
use crate::solid::{Cell, Facet, Solid};
use crate::weave::{Kind, Strand};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap};
use voronoi::{Vertex, Voronoi};

/// A stretch of one strand: crossings `from` up to but not including `to`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Piece {
    pub strand: Strand,
    pub from: i32,
    pub to: i32,
}

impl Piece {
    pub fn holds(&self, owner: Owner) -> bool {
        matches!(owner, Owner::Strand { strand, crossing }
            if strand == self.strand && (self.from..self.to).contains(&crossing))
    }

    /// The piece moved by whole crossings.
    pub fn moved(&self, (dx, dy): (i32, i32)) -> Piece {
        let (along, across) = match self.strand.kind {
            Kind::Weft => (dx, dy),
            Kind::Warp => (dy, dx),
        };
        let strand = Strand { index: self.strand.index + across, ..self.strand };
        Piece { strand, from: self.from + along, to: self.to + along }
    }

    /// Unit square of the first crossing.
    pub fn start(&self) -> (i32, i32) {
        match self.strand.kind {
            Kind::Weft => (self.from, self.strand.index),
            Kind::Warp => (self.strand.index, self.from),
        }
    }
}

/// The solid of a piece, in crossings.
#[derive(Clone, Debug)]
pub struct Tile {
    pub piece: Piece,
    pub solid: Solid,
    /// For each facet of the solid: its own site, and what it faces.
    pub across: Vec<(Site, Across)>,
}

#[derive(Debug, thiserror::Error)]
pub enum TileError {
    #[error(transparent)]
    Unbounded(#[from] Unbounded),
    #[error("the tile of {} from {} to {}: {fault}", .piece.strand, .piece.from, .piece.to)]
    NotASolid { piece: Piece, fault: NotASolid },
}

/// The tiles of these pieces, in their order. Each site is cut out once for each orbit under the lattice, in parallel.
pub fn tiles(sites: &Sites, lattice: &Lattice, pieces: &[Piece]) -> Result<Vec<Tile>, TileError> {
    let cells = cells(sites, lattice, pieces)?;
    pieces.par_iter().map(|&piece| tile(sites, lattice, &cells, piece)).collect()
}

/// Cells by canonical site.
type Cells = HashMap<Site, Voronoi>;

fn cells(sites: &Sites, lattice: &Lattice, pieces: &[Piece]) -> Result<Cells, Unbounded> {
    let own = pieces.iter().flat_map(|p| of_piece(sites, *p)).map(|s| canonical(lattice, s).0);
    let mut wanted: Vec<Site> = own.collect();
    wanted.sort_unstable();
    wanted.dedup();
    wanted.into_par_iter().map(|s| Ok((s, voronoi::cell(sites, s)?))).collect()
}

/// A piece's own sites, along its strand.
pub fn of_piece(sites: &Sites, piece: Piece) -> impl Iterator<Item = Site> + '_ {
    (piece.from..piece.to).flat_map(move |c| sites.of_strand(piece.strand, c))
}

/// The site's representative under the lattice, and the shift of whole crossings that leads from there to the site.
fn canonical(lattice: &Lattice, site: Site) -> (Site, (i32, i32)) {
    let ((x, y), shift) = lattice.canonical((site.x, site.y));
    (Site { x, y, ..site }, shift)
}

fn tile(sites: &Sites, lattice: &Lattice, cells: &Cells, piece: Piece) -> Result<Tile, TileError> {
    let mut union = Union::default();
    for site in of_piece(sites, piece) {
        union.add(sites, piece, site, &cells[&canonical(lattice, site).0]);
    }
    let solid = Solid { vertices: union.vertices, facets: union.facets, cells: union.cells, off: 0.0 };
    manifold::check(&solid).map_err(|fault| TileError::NotASolid { piece, fault })?;
    Ok(Tile { piece, solid, across: union.across })
}

/// The union of a piece's cells as it grows: facets between two cells of the piece are dropped.
#[derive(Default)]
struct Union {
    index: BTreeMap<Vertex, u32>,
    vertices: Vec<DVec3>,
    facets: Vec<Facet>,
    across: Vec<(Site, Across)>,
    cells: Vec<Cell>,
}

impl Union {
    fn add(&mut self, sites: &Sites, piece: Piece, site: Site, cell: &Voronoi) {
        let shift = [i64::from(site.x), i64::from(site.y), 0].map(|c| c << exact::VERTEX_BITS);
        let at = |k: u32| [0, 1, 2].map(|d| cell.vertices[k as usize][d] + shift[d]);
        let corner = DVec3::new(f64::from(site.x), f64::from(site.y), 0.0);
        let mut planes = Vec::with_capacity(cell.faces.len());
        for face in &cell.faces {
            let normal = vector(face.step).normalize();
            planes.push((normal, normal.dot(vector(face.twice_middle) / 2.0 + corner)));
            let across = absolute(face.across, site);
            if !matches!(across, Across::Site(other) if piece.holds(sites.owner(other))) {
                let corners = face.corners.iter().map(|&k| self.vertex(at(k))).collect();
                self.facets.push(Facet { corners, normal });
                self.across.push((site, across));
            }
        }
        let vertices = (0..cell.vertices.len() as u32).map(|k| voronoi::place(at(k))).collect();
        let facets = cell.faces.iter().map(|f| f.corners.clone()).collect();
        self.cells.push(Cell { vertices, facets, planes });
    }

    fn vertex(&mut self, at: Vertex) -> u32 {
        let next = self.vertices.len() as u32;
        let index = *self.index.entry(at).or_insert(next);
        if index == next {
            self.vertices.push(voronoi::place(at));
        }
        index
    }
}

/// A grid vector in crossings.
fn vector(g: exact::Grid) -> DVec3 {
    DVec3::from_array(g.map(|c| c as f64 / f64::from(1 << exact::SITE_BITS)))
}

fn absolute(across: Across, from: Site) -> Across {
    match across {
        Across::Site(s) => Across::Site(Site { x: s.x + from.x, y: s.y + from.y, ..s }),
        face => face,
    }
}
