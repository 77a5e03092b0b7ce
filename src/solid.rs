//! Takes nothing, gives the shapes that every later stage speaks of: solids, their convex cells, rigid poses.
//!
//! Promised by whoever builds a [`Solid`]: closed, outward oriented, vertices shared by identity. Nothing here checks
//! it; `tile` and `assembly` do, each for what it makes or reads.

use glam::{DAffine3, DVec3};

/// A solid bounded by planar facets, in model units (woven tiles: crossings).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    pub vertices: Vec<DVec3>,
    pub facets: Vec<Facet>,
    /// Convex pieces with disjoint interiors whose union is the solid; empty where no decomposition is known.
    pub cells: Vec<Cell>,
    /// How far a corner may stand off the faces and the planes of cells that it belongs to, in model units: 0 where
    /// corners are exact but for round-off.
    pub off: f64,
}

/// A planar convex polygon of the boundary, counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// Indices into [`Solid::vertices`].
    pub corners: Vec<u32>,
    /// Unit normal, outward.
    pub normal: DVec3,
}

/// A convex polytope. `facets` index into `vertices`, counter-clockwise from outside; `planes` run parallel to them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    pub vertices: Vec<DVec3>,
    pub facets: Vec<Vec<u32>>,
    /// Unit outward normal `n` and offset `d` of each facet: inside is `n . x <= d`.
    pub planes: Vec<(DVec3, f64)>,
}

impl Cell {
    /// The cell moved by a rigid pose.
    pub fn moved(&self, pose: &DAffine3) -> Cell {
        Cell {
            vertices: self.vertices.iter().map(|&p| pose.transform_point3(p)).collect(),
            facets: self.facets.clone(),
            planes: self
                .planes
                .iter()
                .map(|&(n, d)| {
                    let m = pose.transform_vector3(n);
                    (m, d + m.dot(pose.translation))
                })
                .collect(),
        }
    }
}

impl Solid {
    /// Signed volume by the divergence theorem, in cubed model units; positive when facets face outward.
    pub fn volume(&self) -> f64 {
        self.triangles()
            .map(|[a, b, c]| {
                let [a, b, c] = [a, b, c].map(|i| self.vertices[i as usize]);
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    }

    /// Area of all facets, in squared model units.
    pub fn surface(&self) -> f64 {
        self.triangles()
            .map(|[a, b, c]| {
                let [a, b, c] = [a, b, c].map(|i| self.vertices[i as usize]);
                (b - a).cross(c - a).length() / 2.0
            })
            .sum()
    }

    /// The facets as triangle fans, each from its lowest-numbered corner (the same for the same solid).
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.facets.iter().flat_map(|f| {
            let start = (0..f.corners.len()).min_by_key(|&k| f.corners[k]).unwrap_or(0);
            let at = move |k: usize| f.corners[(start + k) % f.corners.len()];
            (1..f.corners.len().saturating_sub(1)).map(move |k| [at(0), at(k), at(k + 1)])
        })
    }

    /// Mean of the vertices: a point near the solid, used as reference of its twist (not the centre of mass).
    pub fn centre(&self) -> DVec3 {
        self.vertices.iter().sum::<DVec3>() / self.vertices.len().max(1) as f64
    }
}
