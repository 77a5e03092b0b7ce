//! Takes meshes as made; gives the pictures of a package as PNG: together, apart, each plate, the coupon.
//!
//! Not promised: scale; the sheets have the sizes.

use crate::report::draw::mesh::CreaseAngle;
use crate::report::draw::{Background, Colour, Item, Mesh, Scene, Size, View, palette, render};
use crate::solid::{Facet, Solid};
use glam::DVec3;
use std::sync::Arc;
use weavelock_fab::mesh;
use weavelock_fab::package::{Attachment, Shown, ShownPlate};

/// Pixels: wide enough for a sheet on a screen or half a page of paper.
const SIZE: (u32, u32) = (960, 720);

/// How far parts move apart, in their distance from the middle.
const APART: DVec3 = DVec3::new(1.3, 1.3, 0.6);

/// Paper: a picture is looked at beside black text.
const PAPER: [u8; 3] = [255, 255, 255];
const BED: [u8; 3] = [214, 214, 208];
/// Of the plate that is drawn below the parts, mm.
const BED_THICKNESS: f64 = 2.0;

/// The pictures of a package, in the order in which they are looked at.
pub fn draw(shown: &Shown) -> Result<Vec<Attachment>, String> {
    let parts = scene(items(&shown.parts));
    let mut all = vec![
        ("pictures/assembly.png".to_string(), parts.clone()),
        ("pictures/apart.png".into(), parts.exploded(APART)),
    ];
    for ShownPlate { file, bed, stands } in &shown.plates {
        let stem = file.trim_start_matches("print/").trim_end_matches(".mm.3mf");
        let mut items = items(stands);
        items.insert(0, plate(*bed));
        all.push((format!("pictures/{stem}.png"), scene(items)));
    }
    all.push(("pictures/coupon.png".into(), scene(items(&shown.coupon))));
    all.retain(|(_, scene)| !scene.items.is_empty());
    all.into_iter().map(|(name, scene)| Ok(Attachment { name, bytes: png(&scene)? })).collect()
}

fn png(scene: &Scene) -> Result<Vec<u8>, String> {
    let size = Size::new(SIZE.0, SIZE.1).map_err(|e| e.to_string())?;
    render(scene, size).png().map_err(|e| e.to_string())
}

fn scene(items: Vec<Item>) -> Scene {
    Scene { items, view: View::default(), background: Background::Plain(Colour::srgb(PAPER)) }
}

fn items(meshes: &[(String, mesh::Mesh)]) -> Vec<Item> {
    let item = |(k, (id, mesh)): (usize, &(String, mesh::Mesh))| {
        Item::new(Arc::new(Mesh::of(&solid(mesh), CreaseAngle::default())), palette::of_part(id, k))
    };
    meshes.iter().enumerate().map(item).collect()
}

pub(super) fn solid(mesh: &mesh::Mesh) -> Solid {
    let facet = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        Facet { corners: mesh.triangles[t].to_vec(), normal: (b - a).cross(c - a).normalize_or_zero() }
    };
    let facets = (0..mesh.triangles.len()).map(facet).collect();
    Solid { vertices: mesh.vertices.clone(), facets, ..Solid::default() }
}

fn plate([x, y, _]: [f64; 3]) -> Item {
    let corner = |k: usize| {
        let pick = |bit: usize, high: f64| if k >> bit & 1 == 1 { high } else { 0.0 };
        DVec3::new(pick(0, x), pick(1, y), pick(2, BED_THICKNESS) - BED_THICKNESS)
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
    let mesh = mesh::Mesh { vertices: (0..8).map(corner).collect(), triangles };
    Item::new(Arc::new(Mesh::of(&solid(&mesh), CreaseAngle::default())), Colour::srgb(BED))
}
