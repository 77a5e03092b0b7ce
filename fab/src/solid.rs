//! Takes closed meshes; gives unions, differences, intersections and cuts of them, and a few plain shapes.
//!
//! The kernel (`manifold-rust`) is named in this file alone. Promised: what comes out is closed. Not promised: exact
//! coordinates; new vertices carry f64 round-off, and edges shorter than the kernel's own 1e-12 of the size are united.

use crate::mesh::Mesh;
use glam::{DVec2, DVec3};
use manifold_rust::cross_section::CrossSection;
use manifold_rust::linalg::{Vec2, Vec3};
use manifold_rust::manifold::Manifold;
use manifold_rust::types::{Error, MeshGL64, PolyVert};
use rayon::prelude::*;

/// A closed solid inside the kernel.
#[derive(Clone)]
pub struct Solid(Manifold);

/// Why a mesh is not a solid, in words for a user.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NotSolid(pub String);

impl Solid {
    pub fn of(mesh: &Mesh) -> Result<Solid, NotSolid> {
        let solid = Solid::or_nothing(mesh)?;
        if solid.is_empty() { Err(NotSolid("the mesh has no volume".into())) } else { Ok(solid) }
    }

    /// The same, or nothing where the mesh is flat but for round-off.
    pub fn or_nothing(mesh: &Mesh) -> Result<Solid, NotSolid> {
        let raw = MeshGL64 {
            num_prop: 3,
            vert_properties: mesh.vertices.iter().flat_map(|v| v.to_array()).collect(),
            tri_verts: mesh.triangles.iter().flatten().map(|&v| u64::from(v)).collect(),
            ..MeshGL64::default()
        };
        let solid = Manifold::from_mesh_gl64(&raw);
        let no = |why: &str| Err(NotSolid(why.to_string()));
        match solid.status() {
            Error::NoError => Ok(Solid(solid)),
            Error::NonFiniteVertex => no("a corner is not a finite number"),
            Error::NotManifold => no("the mesh is not closed: an edge is not between two opposite triangles"),
            Error::VertexOutOfBounds => no("a triangle names a corner that is not there"),
            _ => no("the mesh is not a solid"),
        }
    }

    pub fn mesh(&self) -> Mesh {
        let raw = self.0.get_mesh_gl64(-1);
        let stride = raw.num_prop.max(1) as usize;
        let vertices =
            raw.vert_properties.chunks_exact(stride).map(|c| DVec3::new(c[0], c[1], c[2])).collect();
        let triangles =
            raw.tri_verts.chunks_exact(3).map(|t| [t[0] as u32, t[1] as u32, t[2] as u32]).collect();
        in_order(&Mesh { vertices, triangles })
    }

    /// Of what its surface encloses, never negative: also for a hollow taken for itself.
    pub fn volume(&self) -> f64 {
        self.0.volume()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn minus(&self, other: &Solid) -> Solid {
        Solid(self.0.difference(&other.0))
    }

    pub fn with(&self, other: &Solid) -> Solid {
        Solid(self.0.union(&other.0))
    }

    pub fn common(&self, other: &Solid) -> Solid {
        Solid(self.0.intersection(&other.0))
    }

    pub fn nothing() -> Solid {
        Solid(Manifold::empty())
    }

    /// The union of all, taken two by two so that no solid is gone through more than log n times; on all threads.
    pub fn all(mut solids: Vec<Solid>) -> Solid {
        while solids.len() > 1 {
            solids = solids
                .par_chunks(2)
                .map(|p| if p.len() == 2 { p[0].with(&p[1]) } else { p[0].clone() })
                .collect();
        }
        solids.pop().unwrap_or_else(Solid::nothing)
    }

    /// The same with its hollows filled.
    pub fn without_hollows(&self) -> Solid {
        let (bodies, outer) = (self.bodies(), |b: &Solid| b.mesh().volume() > 0.0);
        if bodies.iter().all(outer) {
            return self.clone();
        }
        Solid::all(bodies.into_iter().filter(outer).collect())
    }

    /// Its separate surfaces: of each body the outer one, and those of hollows, inside out.
    pub fn bodies(&self) -> Vec<Solid> {
        self.0.decompose().into_iter().map(Solid).collect()
    }

    /// The convex hull of points.
    pub fn hull(points: &[DVec3]) -> Solid {
        Solid(Manifold::hull(&points.iter().map(|p| Vec3::new(p.x, p.y, p.z)).collect::<Vec<_>>()))
    }

    pub fn moved(&self, by: DVec3) -> Solid {
        Solid(self.0.translate(Vec3::new(by.x, by.y, by.z)))
    }

    /// The same with detail below `size` mm gone: shorter edges united, and bodies thinner than that left out.
    pub fn plain(&self, size: f64) -> Solid {
        Solid(self.0.simplify(size)).thick(size)
    }

    /// The same without bodies that are thinner than `size` mm all over: what round-off of a difference leaves.
    pub fn thick(&self, size: f64) -> Solid {
        let thick = |b: &Solid| b.volume().abs() > size * b.0.surface_area();
        let bodies = self.bodies();
        if bodies.iter().all(thick) {
            return self.clone();
        }
        Solid(Manifold::compose(&bodies.into_iter().filter(thick).map(|b| b.0).collect::<Vec<_>>()))
    }

    /// Its union with copies moved in these ways, mm.
    pub fn with_copies(&self, ways: impl IntoIterator<Item = DVec3>) -> Solid {
        Solid::all(std::iter::once(self.clone()).chain(ways.into_iter().map(|w| self.moved(w))).collect())
    }

    /// Its union with four copies, each moved by `by` mm along all three axes: thinner gaps are filled.
    pub fn widened(&self, by: f64) -> Solid {
        self.with_copies(TETRAHEDRON.map(|c| c * by))
    }

    /// What it has in common with the same four copies: thinner walls vanish, and every face goes in by 0.57 to 1.74 times that.
    pub fn narrowed(&self, by: f64) -> Solid {
        TETRAHEDRON.iter().fold(self.clone(), |all, &c| all.common(&self.moved(c * by)))
    }

    /// Whether triangles of its surface cross: then no volume of it means anything.
    pub fn crosses_itself(&self) -> bool {
        self.0.has_self_intersections()
    }

    /// The outlines of its section at a height: counter-clockwise around matter, clockwise around holes.
    pub fn section(&self, z: f64) -> Vec<Vec<DVec2>> {
        let loops = self.0.slice(z).to_polygons();
        loops.into_iter().map(|l| l.into_iter().map(|p| DVec2::new(p.x, p.y)).collect()).collect()
    }
}

/// Corners of a tetrahedron: of every direction one of them is within 55 degrees, forwards or back.
const TETRAHEDRON: [DVec3; 4] = [
    DVec3::new(1.0, 1.0, 1.0),
    DVec3::new(1.0, -1.0, -1.0),
    DVec3::new(-1.0, 1.0, -1.0),
    DVec3::new(-1.0, -1.0, 1.0),
];

/// The mesh with its triangles in the order of their corners' coordinates, and vertices in the order of their first use: the
/// kernel's own order is that in which its solids were made, and those are made on all threads.
fn in_order(mesh: &Mesh) -> Mesh {
    let key = |t: [u32; 3]| t.map(|v| mesh.vertices[v as usize].to_array());
    let less = |a: &[f64], b: &[f64]| {
        let differ = a.iter().zip(b).map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne());
        differ.unwrap_or(std::cmp::Ordering::Equal)
    };
    let mut ordered: Vec<([u32; 3], [[f64; 3]; 3])> = mesh
        .triangles
        .iter()
        .map(|&t| {
            let k = key(t);
            let first = (0..3).min_by(|&i, &j| less(&k[i], &k[j])).unwrap_or(0);
            let turned = std::array::from_fn(|i| t[(first + i) % 3]);
            (turned, key(turned))
        })
        .collect();
    ordered.sort_by(|a, b| less(a.1.as_flattened(), b.1.as_flattened()));
    let mut number = vec![u32::MAX; mesh.vertices.len()];
    let mut vertices = Vec::with_capacity(mesh.vertices.len());
    let mut of = |v: u32| {
        let n = &mut number[v as usize];
        if *n == u32::MAX {
            *n = vertices.len() as u32;
            vertices.push(mesh.vertices[v as usize]);
        }
        *n
    };
    let triangles = ordered.into_iter().map(|(t, _)| t.map(&mut of)).collect();
    Mesh { vertices, triangles }
}

/// Triangles over the points of closed loops (outer ones counter-clockwise, holes clockwise), numbered through all loops.
pub fn fill(loops: &[Vec<DVec2>]) -> Vec<[u32; 3]> {
    let mut next = 0;
    let mut number = |p: &DVec2| {
        next += 1;
        PolyVert { pos: Vec2::new(p.x, p.y), idx: next - 1 }
    };
    let numbered = loops.iter().map(|l| l.iter().map(&mut number).collect()).collect();
    let triangles = manifold_rust::polygon::triangulate_idx(&numbered, -1.0, false);
    triangles.into_iter().map(|t| [t.x as u32, t.y as u32, t.z as u32]).collect()
}

/// The union of polygons of a plane (counter-clockwise), and its widest local width in mm, to within `step`: the union is
/// narrowed from its border until nothing is left.
pub fn width(outlines: Vec<Vec<DVec2>>, step: f64) -> f64 {
    let loops = outlines.into_iter().map(|l| l.into_iter().map(|p| Vec2::new(p.x, p.y)).collect()).collect();
    let area = CrossSection::new(loops);
    if area.is_empty() {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, area.bounds().size().x.max(area.bounds().size().y));
    while high - low > step.max(high * WIDTH_ROUND_OFF) {
        let middle = (low + high) / 2.0;
        let left = area.offset(-middle / 2.0);
        if left.is_empty() { high = middle } else { low = middle }
    }
    high
}

/// Below this share of itself a width means nothing: the kernel's plane works on a grid of about 1e-8.
const WIDTH_ROUND_OFF: f64 = 1e-7;

/// Sides of what stands for a circle: 48 leave a sagitta of 0.2 % of the radius; OpenSCAD is given the same number.
pub const SIDES: u32 = 48;

/// An upright turned body: rings of the given heights above `foot` and radii, mm, from below.
pub fn turned(foot: DVec3, rings: &[(f64, f64)]) -> Mesh {
    let ring = |&(z, r): &(f64, f64)| {
        (0..SIDES).map(move |k| {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(SIDES)).sin_cos();
            foot + DVec3::new(r * cos, r * sin, z)
        })
    };
    let last = (rings.len().max(1) as u32 - 1) * SIDES;
    let cap = |k: u32| [[0, k + 1, k], [last, last + k, last + k + 1]];
    let wall = |k: u32| {
        let (lap, next) = (k - k % SIDES, k - k % SIDES + (k + 1) % SIDES);
        [[k, next, lap + SIDES + (k + 1) % SIDES], [k, lap + SIDES + (k + 1) % SIDES, k + SIDES]]
    };
    Mesh {
        vertices: rings.iter().flat_map(ring).collect(),
        triangles: (1..SIDES - 1).flat_map(cap).chain((0..last).flat_map(wall)).collect(),
    }
}

/// An upright frustum on circles of the given radii, mm.
pub fn frustum(foot: DVec3, height: f64, below: f64, above: f64) -> Mesh {
    turned(foot, &[(0.0, below), (height, above)])
}

pub fn cuboid(lo: DVec3, hi: DVec3) -> Mesh {
    let corner =
        |k: usize| DVec3::from_array(std::array::from_fn(|a| if k >> a & 1 == 1 { hi[a] } else { lo[a] }));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh {
        vertices: (0..8).map(corner).collect(),
        triangles: quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_does_not_tell_in_which_order_its_solids_were_made() {
        let cube = |from: f64, to: f64| Solid::of(&cuboid(DVec3::splat(from), DVec3::splat(to))).unwrap();
        let (a, b) = (cube(0.0, 2.0), cube(1.0, 3.0));
        let first = a.with(&b).mesh();
        let (b, a) = (cube(1.0, 3.0), cube(0.0, 2.0));
        assert_eq!(a.with(&b).mesh(), first);
    }

    #[test]
    fn hollows_are_filled_and_what_stands_in_them_is_swallowed() {
        let cube = |from: f64, to: f64| Solid::of(&cuboid(DVec3::splat(from), DVec3::splat(to))).unwrap();
        let nested = cube(0.0, 9.0).minus(&cube(1.0, 8.0)).with(&cube(2.0, 3.0)).with(&cube(20.0, 21.0));
        assert_eq!(nested.bodies().len(), 4);
        let filled = nested.without_hollows();
        assert!((filled.volume() - 730.0).abs() < 1e-9 && filled.bodies().len() == 2, "{}", filled.volume());
    }

    #[test]
    fn a_box_less_a_smaller_one_keeps_the_difference() {
        let big = Solid::of(&cuboid(DVec3::ZERO, DVec3::splat(2.0))).unwrap();
        let small = Solid::of(&cuboid(DVec3::splat(0.5), DVec3::splat(1.5))).unwrap();
        assert!((big.minus(&small).volume() - 7.0).abs() < 1e-12);
        assert!((big.common(&small).volume() - 1.0).abs() < 1e-12);
        assert_eq!(big.minus(&small).bodies().len(), 2, "a shell has an inside and an outside");
    }

    #[test]
    fn a_frustum_has_the_volume_of_its_polygon() {
        let f = frustum(DVec3::ZERO, 3.0, 2.0, 1.0);
        let disc = f64::from(SIDES) / 2.0 * (std::f64::consts::TAU / f64::from(SIDES)).sin();
        assert_eq!(f.closure(), crate::mesh::Closure::Closed);
        assert!((f.volume() - disc * (4.0 + 2.0 + 1.0)).abs() < 1e-9);
    }

    #[test]
    fn what_is_open_is_not_a_solid() {
        let mut m = cuboid(DVec3::ZERO, DVec3::ONE);
        m.triangles.pop();
        assert!(Solid::of(&m).is_err());
    }

    #[test]
    fn a_ring_is_filled_around_its_hole() {
        let square = |r: f64| [(-r, -r), (r, -r), (r, r), (-r, r)].map(DVec2::from).to_vec();
        let (outer, mut inner) = (square(2.0), square(1.0));
        inner.reverse();
        let all: Vec<DVec2> = outer.iter().chain(&inner).copied().collect();
        let area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|k| all[k as usize]);
            (b - a).perp_dot(c - a) / 2.0
        };
        assert!((fill(&[outer, inner]).iter().map(area).sum::<f64>() - 12.0).abs() < 1e-12);
    }
}
