//! Takes solids in place; gives them as an isometry sees them: points, true corners, each part's cells or flat faces.
//!
//! Promised: two shapes with the same points and the same cells or faces are the same, up to the distance within which
//! points were matched. Not promised: that equal shapes have equal faces; an extra point on a straight edge makes a face
//! another one, and then equality stays unproven.

use crate::solid::Solid;
use glam::{DAffine3, DVec3};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Distances that mean something for a shape, in model units.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// How far two points that mirror each other may miss, from the rounding of vertices (meshes: the user's tolerance).
    pub rounding: f64,
    /// How far a corner may miss its mirror image since the sites under it are rounded (meshes: the same tolerance).
    pub resolution: f64,
}

/// A corner counts where three of its facets have unit normals with at least this determinant (the corner of a cube has
/// 1): then a shift of the planes by s moves it by no more than 3 s / SPREAD. Any value is sound; a smaller one uses more
/// corners.
pub const SPREAD: f64 = 0.125;

/// A convex cell as its points, each as a pair with itself, or a flat face as the edges of its outline; sorted.
pub type Body = Vec<[u32; 2]>;

/// Parts in place.
pub struct Shape {
    pub cloud: Cloud,
    /// Boundary vertices, as points of the cloud.
    pub surface: Vec<u32>,
    /// Where at least three facets of a part meet at clear angles; every isometric shape has vertices there.
    pub corners: Vec<u32>,
    /// For each part its corners and the points of its boundary, both sorted.
    pub members: Vec<[Vec<u32>; 2]>,
    /// Each part's convex cells or, where it has none, its flat faces; sorted.
    pub parts: Vec<Vec<Body>>,
    pub triangles: Vec<[DVec3; 3]>,
}

impl Shape {
    pub fn new<'a>(parts: impl IntoIterator<Item = (&'a Solid, DAffine3)>, scale: Scale) -> Shape {
        let mut shape = Shape {
            cloud: Cloud::new(scale),
            surface: Vec::new(),
            corners: Vec::new(),
            members: Vec::new(),
            parts: Vec::new(),
            triangles: Vec::new(),
        };
        for (solid, pose) in parts {
            shape.add(solid, &pose);
        }
        for list in [&mut shape.surface, &mut shape.corners] {
            list.sort_unstable();
            list.dedup();
        }
        shape.parts.sort_unstable();
        shape
    }

    fn add(&mut self, solid: &Solid, pose: &DAffine3) {
        let placed: Vec<DVec3> = solid.vertices.iter().map(|&v| pose.transform_point3(v)).collect();
        let ids: Vec<u32> = placed.iter().map(|&p| self.cloud.insert(p)).collect();
        self.triangles.extend(solid.triangles().map(|t| t.map(|k| placed[k as usize])));
        let mut surface: Vec<u32> =
            solid.facets.iter().flat_map(|f| &f.corners).map(|&k| ids[k as usize]).collect();
        let mut corners: Vec<u32> = corners(solid).into_iter().map(|k| ids[k as usize]).collect();
        for list in [&mut surface, &mut corners] {
            list.sort_unstable();
            list.dedup();
        }
        self.surface.extend(&surface);
        self.corners.extend(&corners);
        self.members.push([corners, surface]);
        let bodies = if solid.cells.is_empty() { faces(solid, &ids) } else { self.cells(solid, pose) };
        self.parts.push(sorted(bodies));
    }

    fn cells(&mut self, solid: &Solid, pose: &DAffine3) -> Vec<Body> {
        let mut point = |&v: &DVec3| [self.cloud.insert(pose.transform_point3(v)); 2];
        solid.cells.iter().map(|c| c.vertices.iter().map(&mut point).collect()).collect()
    }

    pub fn point(&self, id: u32) -> DVec3 {
        self.cloud.points[id as usize]
    }
}

/// Each body sorted without repeats, its edges without direction, and the bodies sorted.
pub fn sorted(mut bodies: Vec<Body>) -> Vec<Body> {
    for body in &mut bodies {
        body.iter_mut().for_each(|pair| pair.sort_unstable());
        body.sort_unstable();
        body.dedup();
    }
    bodies.sort_unstable();
    bodies
}

/// The vertices where three facets meet at clear angles.
fn corners(solid: &Solid) -> Vec<u32> {
    let mut around: BTreeMap<u32, Vec<DVec3>> = BTreeMap::new();
    for f in &solid.facets {
        f.corners.iter().for_each(|&k| around.entry(k).or_default().push(f.normal));
    }
    around.into_iter().filter(|(_, normals)| spread(normals)).map(|(k, _)| k).collect()
}

fn spread(normals: &[DVec3]) -> bool {
    let pair = |k: usize| normals[..k].iter().map(move |&m| (k, normals[k].cross(m)));
    (0..normals.len()).flat_map(pair).any(|(k, c)| normals[k + 1..].iter().any(|n| n.dot(c).abs() >= SPREAD))
}

/// Flat faces of a mesh, each as its outline: facets that share an edge and have one normal (a mesh's facets do where
/// they lie in one face) are one face, however it was cut into facets.
fn faces(solid: &Solid, ids: &[u32]) -> Vec<Body> {
    let mut beside: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (k, f) in solid.facets.iter().enumerate() {
        beside.extend(edges(&f.corners).map(|e| (e, k)));
    }
    let flat = |k: usize, (a, b): (u32, u32)| {
        let other = beside.get(&(b, a)).copied();
        other.filter(|&o| solid.facets[o].normal == solid.facets[k].normal)
    };
    let mut seen = BTreeSet::new();
    let mut face = |start: usize| {
        let (mut stack, mut outline) = (vec![start], Vec::new());
        while let Some(k) = stack.pop() {
            if seen.insert(k) {
                for (a, b) in edges(&solid.facets[k].corners) {
                    let edge = [ids[a as usize], ids[b as usize]];
                    flat(k, (a, b)).map_or_else(|| outline.push(edge), |o| stack.push(o));
                }
            }
        }
        outline
    };
    let faces = (0..solid.facets.len()).map(&mut face);
    faces.filter(|outline| !outline.is_empty()).collect()
}

fn edges(corners: &[u32]) -> impl Iterator<Item = (u32, u32)> + '_ {
    (0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()]))
}

/// Points, found by place.
pub struct Cloud {
    pub points: Vec<DVec3>,
    scale: Scale,
    boxes: HashMap<[i64; 3], Vec<u32>>,
}

impl Cloud {
    fn new(scale: Scale) -> Cloud {
        Cloud { points: Vec::new(), scale, boxes: HashMap::new() }
    }

    /// The point's number; a point nearer than the rounding to one that is there already is that one.
    fn insert(&mut self, p: DVec3) -> u32 {
        if let Some((id, _)) = self.nearest(p, self.scale.rounding) {
            return id;
        }
        let id = self.points.len() as u32;
        self.points.push(p);
        self.boxes.entry(self.cube(p)).or_default().push(id);
        id
    }

    /// Cubes twice as wide as the distances mostly asked for.
    fn cube(&self, p: DVec3) -> [i64; 3] {
        (p / (2.0 * self.scale.resolution)).to_array().map(|c| c.floor() as i64)
    }

    /// The nearest point within `radius`, and its distance; of equals the first.
    pub fn nearest(&self, p: DVec3, radius: f64) -> Option<(u32, f64)> {
        let (lo, hi) = (self.cube(p - radius), self.cube(p + radius));
        let mut best: Option<(u32, f64)> = None;
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                for z in lo[2]..=hi[2] {
                    for &id in self.boxes.get(&[x, y, z]).into_iter().flatten() {
                        let d = self.points[id as usize].distance(p);
                        if d <= radius && best.is_none_or(|(k, least)| (d, id) < (least, k)) {
                            best = Some((id, d));
                        }
                    }
                }
            }
        }
        best
    }
}
