//! Takes a shape and which facets are contact; gives a triangle mesh whose corners know the planes that they must
//! stay under, and collapses its edges without losing one of those planes.
//!
//! Law: each corner of a triangle satisfies the moved plane of that triangle's facet, before and after any collapse.
//! Not promised: that a triangle keeps its orientation (see `settle`).

use super::least::{HalfSpace, nearest};
use crate::ears::triangulate;
use crate::mesh::Mesh;
use crate::shape::{Facet, PLANE_ROUND_OFF, Shape};
use glam::{DAffine3, DVec3};

/// A facet's plane after the move.
#[derive(Clone, Copy, Debug)]
pub struct Moved {
    pub plane: HalfSpace,
    pub contact: bool,
}

#[derive(Clone, Debug)]
pub struct Corner {
    /// Where it came from, in mm; the move is the least from here.
    pub anchor: DVec3,
    /// Facets whose moved plane it must stay under, ascending.
    pub facets: Vec<u32>,
    pub at: DVec3,
    /// False where no point satisfies all planes; it then stays at its anchor.
    pub placed: bool,
}

#[derive(Clone, Debug)]
pub struct Body {
    pub moved: Vec<Moved>,
    pub corners: Vec<Corner>,
    /// Dead triangles are `None`.
    pub triangles: Vec<Option<[u32; 3]>>,
    /// The facet of each triangle.
    pub facet: Vec<u32>,
    /// Live triangles around each corner, ascending.
    pub star: Vec<Vec<u32>>,
    /// The distance by which contact facets go inward, in mm.
    pub depth: f64,
    /// How far a corner may be off a plane that it was placed on, in mm.
    pub slack: f64,
}

/// Along a flat ridge between a kept and a moved facet a corner would run away sideways; beyond this many clearances
/// the kept facet is let dip instead. 4 is a ridge within 14.5 degrees of flat (1 / sin).
pub(super) const LONGEST_RUN: f64 = 4.0;

/// Kept facets whose normals differ by less than this (radians) are one plane: above the round-off of the normals,
/// and a tilt that raises a 100 mm facet by less than a ten-thousandth of a millimetre.
const SAME_DIRECTION: f64 = 1e-6;

impl Body {
    pub fn new(shape: &Shape, contact: &[bool], depth: f64) -> Body {
        let moved: Vec<Moved> = shape
            .facets
            .iter()
            .zip(contact)
            .map(|(f, &c)| Moved { plane: moved_plane(shape, f, c, depth), contact: c })
            .collect();
        let mut triangles = Vec::new();
        let mut facet = Vec::new();
        for (k, f) in shape.facets.iter().enumerate() {
            for t in triangulate(&shape.vertices, f) {
                triangles.push(Some(t));
                facet.push(k as u32);
            }
        }
        let mut corners: Vec<Corner> = shape
            .vertices
            .iter()
            .map(|&v| Corner { anchor: v, facets: vec![], at: v, placed: true })
            .collect();
        for (k, f) in shape.facets.iter().enumerate() {
            f.corners.iter().for_each(|&c| corners[c as usize].facets.push(k as u32));
        }
        let mut star = vec![Vec::new(); corners.len()];
        for (t, tri) in triangles.iter().enumerate() {
            tri.iter().flatten().for_each(|&c| star[c as usize].push(t as u32));
        }
        let slack = PLANE_ROUND_OFF * shape.size();
        let mut body = Body { moved, corners, triangles, facet, star, depth, slack };
        for c in 0..body.corners.len() {
            let place = body.place(&body.corners[c].facets, body.corners[c].anchor);
            let corner = &mut body.corners[c];
            (corner.at, corner.placed) = (place.unwrap_or(corner.anchor), place.is_some());
        }
        body
    }

    /// Every corner back where it came from, bound only by the planes that pass there: a sliver's normal is round-off, and its
    /// plane may pass millimetres below its own corners.
    pub fn as_it_came(mut self) -> Body {
        for c in &mut self.corners {
            (c.at, c.placed) = (c.anchor, true);
            c.facets.retain(|&f| self.moved[f as usize].plane.excess(c.anchor) <= self.slack);
        }
        self
    }

    /// The point nearest to `anchor` under the moved planes of `facets`. Kept facets stay planes where they leave room.
    pub fn place(&self, facets: &[u32], anchor: DVec3) -> Option<DVec3> {
        let planes = |contact: bool| {
            facets
                .iter()
                .map(|&f| self.moved[f as usize])
                .filter(move |m| m.contact == contact)
                .map(|m| m.plane)
        };
        let contacts: Vec<HalfSpace> = planes(true).collect();
        let kept = distinct(planes(false));
        if kept.len() <= 2 {
            let run = (LONGEST_RUN * self.depth).max(self.slack);
            let x = nearest(anchor, &kept, &contacts, self.slack).filter(|x| x.distance(anchor) <= run);
            if x.is_some() {
                return x;
            }
        }
        let all: Vec<HalfSpace> = contacts.into_iter().chain(planes(false)).collect();
        nearest(anchor, &[], &all, self.slack)
    }

    pub fn points(&self, t: [u32; 3]) -> [DVec3; 3] {
        t.map(|c| self.corners[c as usize].at)
    }

    /// Neighbours of a corner, ascending.
    pub fn ring(&self, c: u32) -> Vec<u32> {
        let around = |&t: &u32| self.triangles[t as usize].into_iter().flatten();
        let mut ring: Vec<u32> = self.star[c as usize].iter().flat_map(around).filter(|&x| x != c).collect();
        ring.sort_unstable();
        ring.dedup();
        ring
    }

    /// Whether uniting `u` and `w` keeps a closed 2-manifold: their only common neighbours are the two opposite corners
    /// of their common triangles, and more than a tetrahedron is left.
    pub fn may_unite(&self, u: u32, w: u32) -> bool {
        let far = self.ring(w);
        let common = self.ring(u).into_iter().filter(|x| far.binary_search(x).is_ok()).count();
        let shared = self.star[u as usize].iter().filter(|t| self.star[w as usize].contains(t)).count();
        common == 2 && shared == 2 && self.triangles.iter().flatten().take(5).count() > 4
    }

    /// Facets that bind either corner, ascending.
    pub fn united_facets(&self, u: u32, w: u32) -> Vec<u32> {
        let mut all = [&self.corners[u as usize].facets[..], &self.corners[w as usize].facets[..]].concat();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Facets that still have a triangle around `u` and `w` once these are one, ascending.
    pub fn facets_left(&self, u: u32, w: u32) -> Vec<u32> {
        let star = |c: u32| self.star[c as usize].iter();
        let lives = |t: &&u32| {
            self.triangles[**t as usize].is_some_and(|tri| !(tri.contains(&u) && tri.contains(&w)))
        };
        let mut facets: Vec<u32> =
            star(u).chain(star(w)).filter(lives).map(|&t| self.facet[t as usize]).collect();
        facets.sort_unstable();
        facets.dedup();
        facets
    }

    /// Distance between where two corners came from, in mm.
    pub fn edge_length(&self, u: u32, w: u32) -> f64 {
        self.corners[u as usize].anchor.distance(self.corners[w as usize].anchor)
    }

    /// Unites `w` into `u`, which is then at `at`.
    pub fn unite(&mut self, u: u32, w: u32, anchor: DVec3, at: DVec3) {
        let facets = self.united_facets(u, w);
        for t in std::mem::take(&mut self.star[w as usize]) {
            let Some(tri) = self.triangles[t as usize] else { continue };
            if tri.contains(&u) {
                self.triangles[t as usize] = None;
                tri.iter().filter(|&&c| c != w).for_each(|&c| self.star[c as usize].retain(|&s| s != t));
            } else {
                self.triangles[t as usize] = Some(tri.map(|c| if c == w { u } else { c }));
                self.star[u as usize].push(t);
            }
        }
        self.star[u as usize].sort_unstable();
        self.corners[u as usize] = Corner { anchor, facets, at, placed: true };
    }

    /// Adds a triangle.
    pub fn add(&mut self, tri: [u32; 3], facet: u32) {
        let t = self.triangles.len() as u32;
        self.triangles.push(Some(tri));
        self.facet.push(facet);
        tri.iter().for_each(|&c| self.star[c as usize].push(t));
    }

    /// Adds a plane of its own to one corner and moves it under it; false where there is no room.
    pub fn push(&mut self, c: u32, plane: HalfSpace) -> bool {
        let corner = &self.corners[c as usize];
        let facets = [&corner.facets[..], &[self.moved.len() as u32]].concat();
        self.moved.push(Moved { plane, contact: true });
        let Some(at) = self.place(&facets, corner.anchor) else { return false };
        let corner = &mut self.corners[c as usize];
        (corner.facets, corner.at) = (facets, at);
        true
    }

    /// The same body after a rigid motion.
    pub fn posed(&self, pose: &DAffine3) -> Body {
        let mut body = self.clone();
        for c in &mut body.corners {
            (c.anchor, c.at) = (pose.transform_point3(c.anchor), pose.transform_point3(c.at));
        }
        let shift = pose.translation;
        for m in &mut body.moved {
            let normal = pose.transform_vector3(m.plane.normal);
            m.plane = HalfSpace { normal, offset: m.plane.offset + normal.dot(shift) };
        }
        body
    }

    /// The live triangles over the corners that they use, and the corner of each vertex.
    pub fn mesh(&self) -> (Mesh, Vec<u32>) {
        let mut corner_of = Vec::new();
        let mut index = vec![u32::MAX; self.corners.len()];
        let mut mesh = Mesh::default();
        for t in self.triangles.iter().flatten() {
            let t = t.map(|c| {
                if index[c as usize] == u32::MAX {
                    index[c as usize] = mesh.vertices.len() as u32;
                    corner_of.push(c);
                    mesh.vertices.push(self.corners[c as usize].at);
                }
                index[c as usize]
            });
            mesh.triangles.push(t);
        }
        (mesh, corner_of)
    }
}

/// The facet's plane through its lowest corner (so that no corner's round-off costs clearance), moved if in contact.
fn moved_plane(shape: &Shape, f: &Facet, contact: bool, depth: f64) -> HalfSpace {
    let heights = f.corners.iter().map(|&c| f.normal.dot(shape.vertices[c as usize]));
    let lowest = heights.fold(f64::INFINITY, f64::min);
    HalfSpace { normal: f.normal, offset: if contact { lowest - depth } else { lowest } }
}

fn distinct(planes: impl Iterator<Item = HalfSpace>) -> Vec<HalfSpace> {
    let mut kept: Vec<HalfSpace> = Vec::new();
    for p in planes {
        if kept.iter().all(|k| k.normal.distance(p.normal) > SAME_DIRECTION) {
            kept.push(p);
        }
    }
    kept
}
