//! Takes a mesh in mm; gives binary STL, and reads it back.
//!
//! STL keeps f32 and repeats each corner: vertices are snapped first, and corners are one vertex again where their bits
//! are equal. It has no unit, so the name says `mm`.

use crate::bvh::Bvh;
use crate::cross;
use crate::mesh::{Closure, Mesh};
use crate::solid::Solid;
use glam::DVec3;
use std::collections::BTreeMap;
use std::io::{self, Read, Seek, Write};

/// How far a vertex can move when its coordinates become f32, in mm, for coordinates up to `largest` mm: half a step of
/// 2^-23 in each of three.
pub fn snap_distance(largest: f64) -> f64 {
    largest * 2f64.powi(-24) * 3f64.sqrt()
}

/// The mesh as STL can hold it: coordinates in f32, equal vertices united, triangles that vanish by it left out.
pub fn snapped(mesh: &Mesh) -> Mesh {
    let snap = |v: &DVec3| v.to_array().map(|x| x as f32 + 0.0);
    united(mesh.vertices.iter().map(snap).collect(), mesh.triangles.iter().copied())
}

/// The mesh as STL can hold it, and closed where the mesh is: where rounding opens it, detail that f32 can not hold apart
/// is united first.
pub fn snapped_closed(mesh: &Mesh) -> Mesh {
    let plain = snapped(mesh);
    if plain.closure() == Closure::Closed || mesh.closure() != Closure::Closed {
        return plain;
    }
    let united = Solid::of(mesh).ok().and_then(|s| settled(&s));
    united.map_or(plain, |(m, _)| m)
}

/// Step of the grid on which solids of molds stand, mm: four steps of the grid (2^-20 mm) on which OpenSCAD puts every
/// corner that it reads, uniting those in neighbouring places. Corners on this one it leaves as they are, so that what was
/// checked here is what it works with. 4 nm; f32 holds it up to 64 mm, and beyond has a coarser grid of its own within it.
pub const GRID: f64 = 1.0 / 262_144.0;

/// How far a vertex can move when it is put on the grid and in f32, in mm, for coordinates up to `largest` mm.
pub fn grid_distance(largest: f64) -> f64 {
    snap_distance(largest).max(GRID / 2.0 * 3f64.sqrt())
}

/// The mesh as STL can hold it, on `GRID`: equal vertices united, triangles that vanish by it left out.
pub fn on_grid(mesh: &Mesh) -> Mesh {
    snapped(&mesh.map(|v| (v / GRID).round() * GRID))
}

/// The solid as STL can hold it on `GRID`, of the same shape, closed and without triangles that cross or have no area: detail that
/// f32 can not hold apart is united, beginning at `FINEST` snaps and doubling until the file is so; and the size of that
/// detail in mm. Where none up to `COARSEST` does, the first that is closed, though other kernels may refuse it; else
/// `None`.
pub fn settled(solid: &Solid) -> Option<(Mesh, f64)> {
    let mut closed = None;
    for (mesh, size) in closed_on_grid(solid) {
        if is_plain(&mesh) && same(solid, &mesh, size) {
            return Some((mesh, size));
        }
        closed.get_or_insert((mesh, size));
    }
    closed
}

/// The solid as `settled`, or nothing where triangles would cross: what further booleans can rest on.
pub fn uncrossed(solid: &Solid) -> Option<Solid> {
    let found = closed_on_grid(solid).find(|(mesh, size)| is_plain(mesh) && same(solid, mesh, *size));
    found.and_then(|(mesh, _)| Solid::of(&mesh).ok())
}

/// Closed meshes of the solid on `GRID` with more and more detail united, and the size of that detail.
fn closed_on_grid(solid: &Solid) -> impl Iterator<Item = (Mesh, f64)> {
    let whole = solid.mesh();
    let finest = details(&whole).next().unwrap_or(COARSEST);
    let sizes = details(&whole);
    let as_it_is = std::iter::once_with(move || (mended(on_grid(&whole), finest), finest));
    let united = sizes.map(|size| (mended(on_grid(&solid.plain(size).mesh()), size), size));
    as_it_is.chain(united).filter(|(mesh, _)| mesh.closure() == Closure::Closed)
}

/// Whether uniting detail has left the shape alone: what only one of both has is a skin of that thickness at most.
fn same(solid: &Solid, mesh: &Mesh, size: f64) -> bool {
    let apart = |other: Solid| solid.minus(&other).volume() + other.minus(solid).volume();
    Solid::of(mesh).is_ok_and(|other| apart(other) <= size * mesh.area())
}

/// Whether no triangles are known to cross; one without area counts as crossing its neighbours. A crowd that is not
/// looked through passes.
pub fn is_plain(mesh: &Mesh) -> bool {
    !matches!(cross::within(mesh, &Bvh::new(mesh)).as_deref(), Ok([_, ..]))
}

/// Sizes of detail to do without, in mm: from `FINEST` snaps of the mesh, doubling up to `COARSEST`.
pub fn details(mesh: &Mesh) -> impl Iterator<Item = f64> + use<> {
    let (lo, hi) = mesh.bounds();
    let snap = grid_distance(lo.abs().max(hi.abs()).max_element());
    std::iter::successors(Some(FINEST * snap), |s| Some(s * 2.0)).take_while(|s| *s <= COARSEST)
}

/// The mesh with both ends of each edge united that is shorter than `size` and not between two opposite triangles.
fn mended(mesh: Mesh, size: f64) -> Mesh {
    let short: Vec<(u32, u32)> = mesh
        .loose_edges()
        .into_iter()
        .filter(|&(a, b)| mesh.vertices[a as usize].distance(mesh.vertices[b as usize]) < size)
        .collect();
    if short.is_empty() {
        return mesh;
    }
    let mut vertices = mesh.vertices;
    short.iter().for_each(|&(a, b)| vertices[b as usize] = vertices[a as usize]);
    let points = vertices.iter().map(|v| v.to_array().map(|x| x as f32 + 0.0)).collect();
    united(points, mesh.triangles.into_iter())
}

/// Two corners this many snaps apart stay apart when each moves by one.
const FINEST: f64 = 4.0;

/// No detail of a mold is as small as this, mm: a tenth of the finest layer.
const COARSEST: f64 = 0.002;

pub fn write(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let triangles: Vec<stl_io::Triangle> = (0..mesh.triangles.len())
        .map(|t| {
            let c = mesh.corners(t);
            let normal = (c[1] - c[0]).cross(c[2] - c[0]).normalize_or_zero();
            stl_io::Triangle {
                normal: stl_io::Normal::new(normal.as_vec3().to_array()),
                vertices: c.map(|v| stl_io::Vertex::new(v.as_vec3().to_array())),
            }
        })
        .collect();
    let mut sized = Vec::with_capacity(84 + 50 * triangles.len());
    stl_io::write_stl(&mut sized, triangles.iter())?;
    out.write_all(&sized)
}

pub fn read(from: &mut (impl Read + Seek)) -> io::Result<Mesh> {
    let stl = stl_io::read_stl(from)?;
    let triangles = stl.faces.iter().map(|f| f.vertices.map(|v| v as u32));
    Ok(united(stl.vertices.iter().map(|v| v.0).collect(), triangles))
}

fn united(vertices: Vec<[f32; 3]>, triangles: impl Iterator<Item = [u32; 3]>) -> Mesh {
    let mut index: BTreeMap<[u32; 3], u32> = BTreeMap::new();
    let mut mesh = Mesh::default();
    for t in triangles {
        let t = t.map(|v| {
            let p = vertices[v as usize].map(|x| x + 0.0);
            *index.entry(p.map(f32::to_bits)).or_insert_with(|| {
                mesh.vertices.push(DVec3::from_array(p.map(f64::from)));
                mesh.vertices.len() as u32 - 1
            })
        });
        if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
            mesh.triangles.push(t);
        }
    }
    mesh
}
