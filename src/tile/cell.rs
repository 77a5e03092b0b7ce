//! Takes one site and its neighbours in order of distance; gives its Voronoi cell, a simple convex polytope.
//!
//! Exact: the combinatorics are those of the sites infinitesimally perturbed (see `exact`), so cells computed apart
//! agree. Not promised: facets of positive area; where sites are co-spherical some corners coincide, and the caller
//! merges them.

use super::exact::{Corner, Grid, Neighbour, REACH};

/// A cell under construction: its corners, and the neighbours seen so far (the first six bound the search).
pub struct Cell {
    rank: Grid,
    neighbours: Vec<Neighbour>,
    corners: Vec<Corner>,
    /// Largest squared distance of a corner from the site, in grid units; rounded up.
    reach_squared: f64,
}

/// A facet of a cell: which neighbour it faces, and its corners, counter-clockwise from outside.
pub struct Face {
    pub neighbour: u32,
    pub corners: Vec<u32>,
}

/// The six walls of the search box stand half of this from the site; no finished cell keeps one.
const WALL: i64 = REACH;
pub const WALLS: usize = 6;

impl Cell {
    /// The search box around a site at `rank` (its absolute position).
    pub fn new(rank: Grid) -> Cell {
        let neighbours = (0..WALLS).map(|k| wall(rank, k)).collect();
        let mut cell = Cell { rank, neighbours, corners: Vec::new(), reach_squared: 0.0 };
        for k in 0..8_u32 {
            let planes = [k & 1, 2 + (k >> 1 & 1), 4 + (k >> 2)];
            cell.corners.extend(cell.corner(planes));
        }
        cell.measure();
        cell
    }

    fn corner(&self, planes: [u32; 3]) -> Option<Corner> {
        Corner::new(planes, planes.map(|p| self.neighbours[p as usize].at))
    }

    fn measure(&mut self) {
        let far = self.corners.iter().map(|c| c.near.length_squared()).fold(0.0, f64::max);
        self.reach_squared = far * (1.0 + 1e-12);
    }

    /// Squared distance within which a site can still cut the cell: twice the farthest corner's.
    pub fn search_squared(&self) -> f64 {
        4.0 * self.reach_squared
    }

    /// Takes away what is nearer to `t`; whether that was anything. Only then `t` gets the next number.
    pub fn clip(&mut self, t: Neighbour) -> bool {
        let of = |k: u32| self.neighbours[k as usize];
        let cut: Vec<bool> = self.corners.iter().map(|c| c.is_cut_by(&t, self.rank, of)).collect();
        if !cut.contains(&true) {
            return false;
        }
        let new = self.neighbours.len() as u32;
        let edges = open_edges(self.corners.iter().zip(&cut).filter(|c| *c.1).map(|c| c.0.planes));
        self.neighbours.push(t);
        let fresh: Vec<Corner> = edges.iter().filter_map(|&[p, q]| self.corner([p, q, new])).collect();
        debug_assert_eq!(fresh.len(), edges.len(), "an edge that is cut meets the plane that cuts it");
        let mut keep = cut.iter().map(|c| !c);
        self.corners.retain(|_| keep.next() == Some(true));
        self.corners.extend(fresh);
        self.measure();
        true
    }

    /// From the cell's site to a neighbour, in grid units.
    pub fn step(&self, neighbour: u32) -> Grid {
        self.neighbours[neighbour as usize].at
    }

    pub fn corners(&self) -> &[Corner] {
        &self.corners
    }

    /// The facets by rising neighbour index. Walks: at a corner (a, p, q) of positive determinant the boundary of
    /// facet a, counter-clockwise from outside, leaves along the edge shared with q.
    pub fn faces(&self) -> Vec<Face> {
        let mut names: Vec<u32> = self.corners.iter().flat_map(|c| c.planes).collect();
        names.sort_unstable();
        names.dedup();
        names.into_iter().map(|a| Face { neighbour: a, corners: self.walk(a) }).collect()
    }

    fn walk(&self, a: u32) -> Vec<u32> {
        let mut on: Vec<(u32, u32, u32)> = Vec::new();
        for (k, c) in self.corners.iter().enumerate() {
            if let Some(at) = c.planes.iter().position(|&p| p == a) {
                on.push((c.planes[(at + 1) % 3], c.planes[(at + 2) % 3], k as u32));
            }
        }
        let mut order = Vec::with_capacity(on.len());
        let mut here = on[0];
        for _ in 0..on.len() {
            order.push(here.2);
            // The next corner has, after a, first the plane that we leave along.
            match on.iter().find(|n| n.0 == here.1) {
                Some(&next) => here = next,
                None => break,
            }
        }
        order
    }
}

/// The pairs of planes that occur once among the cut corners: edges with one end cut and one kept.
fn open_edges(cut: impl Iterator<Item = [u32; 3]>) -> Vec<[u32; 2]> {
    let mut pairs: Vec<[u32; 2]> = cut.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
    pairs.iter_mut().for_each(|p| p.sort_unstable());
    pairs.sort_unstable();
    pairs.chunk_by(|a, b| a == b).filter(|g| g.len() == 1).map(|g| g[0]).collect()
}

fn wall(rank: Grid, k: usize) -> Neighbour {
    let mut at = [0; 3];
    at[k / 2] = if k.is_multiple_of(2) { WALL } else { -WALL };
    Neighbour { at, rank: [0, 1, 2].map(|d| rank[d] + at[d]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lattice_cell_is_a_cube_with_every_face_closed() {
        let one = 1 << 10;
        let mut cell = Cell::new([0; 3]);
        for k in 0..125 {
            let at = [k % 5 - 2, k / 5 % 5 - 2, k / 25 - 2].map(|c| c * one);
            if at != [0; 3] {
                cell.clip(Neighbour { at, rank: at });
            }
        }
        let faces = cell.faces();
        assert!(faces.iter().all(|f| f.neighbour >= WALLS as u32 && f.corners.len() >= 3));
        // Simple polytope: V - E + F = 2 with 3 V = 2 E.
        assert_eq!(cell.corners().len() + 4, 2 * faces.len());
        assert!(cell.corners().iter().all(|c| c.near.abs() == glam::DVec3::splat(512.0)));
    }
}
