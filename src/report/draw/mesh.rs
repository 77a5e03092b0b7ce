//! Takes a solid, gives triangles that know their facet, a normal for each corner, and the edges worth a line.
//!
//! Promised: facets that meet at less than the crease angle look like one smooth surface. Not promised: repair; an edge
//! without exactly two facets is drawn as a crease.

use crate::solid::Solid;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Least angle between the normals of two neighbouring facets, in radians, that is drawn as a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CreaseAngle(pub f64);

impl Default for CreaseAngle {
    /// 35 degrees: between the 22.5 that a smooth surface turns from facet to facet at 4 samples (90 / 4, the coarsest in
    /// use, about a centreline at 45 degrees) and the 45 of a bevel, the flattest edge that is meant as one.
    fn default() -> Self {
        CreaseAngle(35_f64.to_radians())
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Indices into [`Mesh::vertices`], counter-clockwise from outside.
    pub corners: [u32; 3],
    /// Indices into [`Mesh::normals`], one for each corner.
    pub normals: [u32; 3],
    pub facet: u32,
}

/// An edge of the solid with the facets on its two sides (twice the same one at a border).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    pub ends: [u32; 2],
    pub facets: [u32; 2],
    pub kind: EdgeKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeKind {
    Crease,
    Smooth,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub vertices: Vec<DVec3>,
    /// Unit normals of the corners; entries that no triangle names are zero.
    pub normals: Vec<DVec3>,
    pub triangles: Vec<Triangle>,
    /// Outward unit normal of each facet.
    pub facets: Vec<DVec3>,
    /// Smooth surface that each facet belongs to: the lowest-numbered facet reached without crossing a crease.
    pub surface: Vec<u32>,
    pub edges: Vec<Edge>,
    /// Pairs of facets (lower first) with a crease between them.
    pub(super) creased: BTreeSet<(u32, u32)>,
}

impl Mesh {
    /// Facets with a corner that does not exist, or fewer than three corners, are left out.
    pub fn of(solid: &Solid, crease: CreaseAngle) -> Mesh {
        let edges = edges(solid, crease);
        let smooth = edges.iter().filter(|e| e.kind == EdgeKind::Smooth);
        let surface = groups(solid.facets.len(), smooth.map(|e| e.facets));
        let creased = (edges.iter())
            .filter(|e| e.kind == EdgeKind::Crease)
            .map(|e| (e.facets[0].min(e.facets[1]), e.facets[0].max(e.facets[1])))
            .collect();
        let mut mesh = Mesh {
            vertices: solid.vertices.clone(),
            facets: solid.facets.iter().map(|f| f.normal).collect(),
            surface,
            edges,
            creased,
            ..Mesh::default()
        };
        mesh.fan(solid);
        mesh
    }

    /// Cuts the facets into fans; around a vertex, all facets between two creases share one normal.
    fn fan(&mut self, solid: &Solid) {
        let corners: Vec<(u32, u32)> =
            drawable(solid).flat_map(|(f, cs)| cs.iter().map(move |&v| (v, f as u32))).collect();
        let index: BTreeMap<(u32, u32), u32> = corners.iter().copied().zip(0..).collect();
        let smooth = self.edges.iter().filter(|e| e.kind == EdgeKind::Smooth);
        let joined = smooth.flat_map(|e| e.ends.map(|v| e.facets.map(|f| index[&(v, f)])));
        let fan = groups(corners.len(), joined);
        self.normals = vec![DVec3::ZERO; corners.len()];
        for (f, cs) in drawable(solid) {
            let n = cs.len();
            let normal = |k: usize| fan[index[&(cs[k], f as u32)] as usize];
            for k in 0..n {
                let [b, h, a] =
                    [cs[(k + n - 1) % n], cs[k], cs[(k + 1) % n]].map(|i| self.vertices[i as usize]);
                self.normals[normal(k) as usize] += self.facets[f] * angle_at(b, h, a);
            }
            self.triangles.extend((1..n - 1).map(|k| Triangle {
                corners: [cs[0], cs[k], cs[k + 1]],
                normals: [normal(0), normal(k), normal(k + 1)],
                facet: f as u32,
            }));
        }
        self.normals.iter_mut().for_each(|n| *n = n.normalize_or_zero());
    }
}

/// Facets that can be drawn, with their corners.
fn drawable(solid: &Solid) -> impl Iterator<Item = (usize, &[u32])> {
    let count = solid.vertices.len();
    (solid.facets.iter().enumerate())
        .filter(move |(_, f)| f.corners.len() > 2 && f.corners.iter().all(|&i| (i as usize) < count))
        .map(|(k, f)| (k, f.corners.as_slice()))
}

/// Interior angle at `h` of a facet, in radians: the weight of its normal there, which does not change when the facet
/// is cut into triangles differently.
fn angle_at(b: DVec3, h: DVec3, a: DVec3) -> f64 {
    let (u, v) = (b - h, a - h);
    u.cross(v).length().atan2(u.dot(v))
}

fn edges(solid: &Solid, crease: CreaseAngle) -> Vec<Edge> {
    let mut sides: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
    for (f, corners) in drawable(solid) {
        for k in 0..corners.len() {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            sides.entry([a.min(b), a.max(b)]).or_default().push(f as u32);
        }
    }
    let turn_limit = crease.0.cos();
    let normal = |f: u32| solid.facets[f as usize].normal;
    sides
        .into_iter()
        .map(|(ends, facets)| match facets[..] {
            [f, g] if normal(f).dot(normal(g)) >= turn_limit => {
                Edge { ends, facets: [f, g], kind: EdgeKind::Smooth }
            }
            [f, g] => Edge { ends, facets: [f, g], kind: EdgeKind::Crease },
            _ => Edge { ends, facets: [facets[0]; 2], kind: EdgeKind::Crease },
        })
        .collect()
}

/// The lowest member of each group, for every member.
fn groups(count: usize, joined: impl Iterator<Item = [u32; 2]>) -> Vec<u32> {
    let mut parent: Vec<u32> = (0..count as u32).collect();
    for pair in joined {
        let [a, b] = pair.map(|m| root(&mut parent, m));
        parent[a.max(b) as usize] = a.min(b);
    }
    (0..count as u32).map(|m| root(&mut parent, m)).collect()
}

fn root(parent: &mut [u32], mut m: u32) -> u32 {
    while parent[m as usize] != m {
        parent[m as usize] = parent[parent[m as usize] as usize];
        m = parent[m as usize];
    }
    m
}
