//! Takes an assembly and some of its parts; gives the bytes of a mesh file with them in place, in mm.
//!
//! Exact up to the format: OBJ carries f64, STL f32. Touching parts stay touching: no clearance is built in.

use crate::assembly::{Assembly, PartIx};
use glam::DVec3;
use std::fmt::Write;
use weavelock_fab::files::stl;
use weavelock_fab::mesh::Mesh;

/// The part's vertices in mm, in place.
fn placed(asm: &Assembly, part: PartIx) -> Vec<DVec3> {
    asm.vertices(part).map(|v| v * asm.mm_per_unit).collect()
}

/// Wavefront OBJ, an object for each part; facets as polygons.
pub fn obj(asm: &Assembly, parts: &[PartIx]) -> Vec<u8> {
    let mut text = String::from("# unit: mm\n");
    let mut first = 1;
    for &part in parts {
        let points = placed(asm, part);
        let _ = writeln!(text, "o {}", asm.part(part).id.replace(char::is_whitespace, "_"));
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
