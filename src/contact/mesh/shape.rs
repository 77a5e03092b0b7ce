//! Takes a part in place, gives its facets about a common origin with a search tree over them.
//!
//! Not promised: that facets are planar beyond what their solid promises.

use super::direction::Direction;
use super::local::{Features, Form, Local};
use crate::assembly::{Assembly, PartIx};
use crate::solid::Cell;
use glam::DVec3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};

/// A facet in place: corners and outward unit normal.
pub(super) struct Face {
    pub corners: Vec<u32>,
    pub normal: DVec3,
    /// By how much the normal may be off, in radians.
    pub known: f64,
    /// The face's own form: flat, with its normal.
    pub local: Local,
}

/// A part in place; `points` are relative to the common origin so that nothing cancels far from the world's.
pub(super) struct Shape {
    pub part: PartIx,
    pub points: Vec<DVec3>,
    pub faces: Vec<Face>,
    pub bounds: Aabb,
    pub features: Features,
    /// Convex cells about the common origin with their boxes; empty where none are known.
    pub cells: Vec<(Cell, Aabb)>,
    tree: Bvh,
}

impl Shape {
    /// `normals`: of each facet, in place.
    pub fn new(assembly: &Assembly, part: PartIx, origin: DVec3, normals: &[Direction]) -> Shape {
        let solid = assembly.solid(part);
        let points: Vec<DVec3> = assembly.vertices(part).map(|p| p - origin).collect();
        let place = |(f, d): (&crate::solid::Facet, &Direction)| Face {
            corners: f.corners.clone(),
            normal: d.n,
            known: d.known,
            local: Local { form: Form::Flat, normals: vec![d.n], known: d.known },
        };
        let faces: Vec<Face> = solid.facets.iter().zip(normals).map(place).collect();
        let boxes: Vec<Aabb> =
            faces.iter().map(|f| around(f.corners.iter().map(|&i| points[i as usize]))).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        let bounds = around(points.iter().copied());
        let features = Features::of(&points, &faces);
        let cells = assembly.cells(part).into_iter().map(|c| about(c, origin)).collect();
        Shape { part, points, faces, bounds, features, cells, tree }
    }

    pub fn at(&self, i: u32) -> DVec3 {
        self.points[i as usize]
    }

    pub fn ring(&self, f: usize) -> impl ExactSizeIterator<Item = DVec3> + Clone + '_ {
        self.faces[f].corners.iter().map(|&i| self.at(i))
    }

    /// Length of the longest edge of facet f.
    pub fn longest(&self, f: usize) -> f64 {
        let next = self.ring(f).cycle().skip(1);
        self.ring(f).zip(next).map(|(p, q)| p.distance(q)).fold(0.0, f64::max)
    }

    pub fn face_bounds(&self, f: usize) -> Aabb {
        around(self.ring(f))
    }

    /// Faces whose boxes come within `reach` of the given box, in order.
    pub fn faces_near(&self, bounds: &Aabb, reach: f64) -> Vec<usize> {
        let wide = bounds.loosened(reach);
        let mut found: Vec<usize> = self.tree.intersect_aabb(&wide).map(|k| k as usize).collect();
        found.sort_unstable();
        found
    }

    pub fn triangles(&self) -> impl Iterator<Item = [DVec3; 3]> + '_ {
        self.faces.iter().flat_map(|f| {
            (1..f.corners.len() - 1)
                .map(|k| [f.corners[0], f.corners[k], f.corners[k + 1]].map(|i| self.at(i)))
        })
    }
}

impl Shape {
    /// Each edge once, as its two ends.
    pub fn edges(&self) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
        self.features.edges.iter().map(|e| (self.at(e.ends[0]), self.at(e.ends[1])))
    }
}

/// The cell about the common origin, and its box.
fn about(mut cell: Cell, origin: DVec3) -> (Cell, Aabb) {
    cell.vertices.iter_mut().for_each(|p| *p -= origin);
    for (plane, facet) in cell.planes.iter_mut().zip(&cell.facets) {
        // From its corners: the offset of a far plane has lost the digits that count.
        let sum: f64 = facet.iter().map(|&i| plane.0.dot(cell.vertices[i as usize])).sum();
        plane.1 = sum / facet.len() as f64;
    }
    let bounds = around(cell.vertices.iter().copied());
    (cell, bounds)
}

/// The smallest box around points; an inverted one around none.
pub(super) fn around(points: impl Iterator<Item = DVec3>) -> Aabb {
    let (lo, hi) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)));
    Aabb::new(lo, hi)
}
