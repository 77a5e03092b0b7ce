//! Takes an assembly and some of its parts; gives the bytes of a mesh file with them in place, in mm.
//!
//! Exact up to the format: OBJ and PLY carry f64, STL and 3MF f32. Touching parts stay touching: no clearance is built
//! in.

pub mod glb;
pub mod ply;
pub mod step;
pub mod tables;

use crate::assembly::{Assembly, PartIx};
use glam::DVec3;
use ply::Ply;
use std::fmt::Write;
use std::io;
use weavelock_fab::files::stl;
use weavelock_fab::mesh::Mesh;
use weavelock_fab::pinch;
use weavelock_fab::shape::{self, Shape};
use weavelock_fab::threemf::{self, Build, Model, Object};

/// The part's vertices in mm, in place.
fn placed(asm: &Assembly, part: PartIx) -> Vec<DVec3> {
    asm.vertices(part).map(|v| v * asm.mm_per_unit).collect()
}

/// Wavefront OBJ, an object and a group for each part; facets as polygons.
pub fn obj(asm: &Assembly, parts: &[PartIx]) -> Vec<u8> {
    let mut text = String::from("# unit: mm\n");
    let mut first = 1;
    for &part in parts {
        let points = placed(asm, part);
        let id = asm.part(part).id.replace(char::is_whitespace, "_");
        let _ = writeln!(text, "o {id}\ng {id}");
        for p in &points {
            let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
        }
        for facet in &asm.solid(part).facets {
            let corners: Vec<String> = facet.corners.iter().map(|&c| (first + c).to_string()).collect();
            let _ = writeln!(text, "f {}", corners.join(" "));
        }
        first += points.len() as u32;
    }
    text.into_bytes()
}

/// Binary STL, the facets as triangle fans, as f32 can hold them.
pub fn stl(asm: &Assembly, parts: &[PartIx]) -> Vec<u8> {
    let mut whole = Mesh::default();
    for &part in parts {
        let first = whole.vertices.len() as u32;
        whole.vertices.extend(placed(asm, part));
        whole.triangles.extend(asm.solid(part).triangles().map(|t| t.map(|k| first + k)));
    }
    let mut bytes = Vec::new();
    // Writing to memory does not fail.
    let _ = stl::write(&stl::snapped(&whole), &mut bytes);
    bytes
}

/// PLY with the number of its part on each face.
pub fn ply(asm: &Assembly, parts: &[PartIx]) -> Vec<u8> {
    let mut whole = Ply::default();
    for (k, &part) in parts.iter().enumerate() {
        let first = whole.vertices.len() as u32;
        whole.parts.push(asm.part(part).id.clone());
        whole.vertices.extend(placed(asm, part).iter().map(|v| v.to_array()));
        let facets = asm.solid(part).facets.iter();
        whole.faces.extend(facets.map(|f| (f.corners.iter().map(|c| first + c).collect(), k as u32)));
    }
    ply::write(&whole)
}

/// The same mesh, but where it touches itself along an edge: there each wedge of material has the edge's ends for itself.
fn two_to_an_edge(mesh: &Mesh) -> Mesh {
    let facet = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        shape::Facet { corners: mesh.triangles[t].to_vec(), normal }
    };
    let facets = (0..mesh.triangles.len()).map(facet).collect();
    let parted = pinch::parted(&Shape { vertices: mesh.vertices.clone(), facets });
    let corners = |f: &shape::Facet| [f.corners[0], f.corners[1], f.corners[2]];
    Mesh { triangles: parted.facets.iter().map(corners).collect(), vertices: parted.vertices }
}

/// 3MF by the core specification: an object for each part, shifted together so that all coordinates are positive.
pub fn threemf(asm: &Assembly, parts: &[PartIx]) -> io::Result<Vec<u8>> {
    let low = parts.iter().flat_map(|&p| placed(asm, p)).fold(DVec3::INFINITY, DVec3::min);
    let object = |&part: &PartIx| {
        let triangles = asm.solid(part).triangles().collect();
        let vertices = placed(asm, part).iter().map(|v| *v - low).collect();
        let written = stl::snapped(&Mesh { vertices, triangles });
        Object { name: asm.part(part).id.clone(), mesh: two_to_an_edge(&written) }
    };
    let items = |(k, &p): (usize, &PartIx)| (k, DVec3::ZERO, asm.part(p).id.clone());
    threemf::write(&Model {
        title: asm.name.clone(),
        description: "parts as they touch, in place".into(),
        objects: parts.iter().map(object).collect(),
        build: Build::Items(parts.iter().enumerate().map(items).collect()),
    })
}
