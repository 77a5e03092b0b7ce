//! Takes a mesh in mm; gives binary STL, and reads it back.
//!
//! STL keeps f32 and repeats each corner: vertices are snapped first, and corners are one vertex again where their bits
//! are equal. It has no unit, so the name says `mm`.

use crate::bvh::Bvh;
use crate::cross::{self, Crossing};
use crate::mesh::{Closure, Mesh};
use crate::solid::Solid;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
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

/// The place of `GRID` nearest to a coordinate, mm.
pub fn grid_place(x: f64) -> f64 {
    (x / GRID).round() * GRID
}

/// The mesh as STL can hold it, on `GRID`: equal vertices united, triangles that vanish by it left out.
pub fn on_grid(mesh: &Mesh) -> Mesh {
    snapped(&mesh.map(|v| DVec3::from_array(v.to_array().map(grid_place))))
}

/// The solid as STL can hold it on `GRID`, of the same shape, closed and without triangles that cross or have no area: detail that
/// f32 can not hold apart is united, beginning at `FINEST` snaps and doubling until the file is so; and the size of that
/// detail in mm. Where none up to `COARSEST` does, the first of that shape, though other kernels may refuse it; else
/// `None`.
pub fn settled(solid: &Solid) -> Option<(Mesh, f64)> {
    let mut closed = None;
    for candidate in closed_on_grid(solid, COARSEST) {
        if let Some(plain) = plain(solid, &candidate) {
            return Some(plain);
        }
        if closed.is_none() && (candidate.by == By::Moving || same(solid, &candidate.mesh, candidate.size)) {
            closed = Some((candidate.mesh, candidate.size));
        }
    }
    closed
}

/// A closed mesh on `GRID` of some solid, and the size of detail that it cost, mm.
struct Candidate {
    mesh: Mesh,
    size: f64,
    by: By,
}

#[derive(Clone, Copy, PartialEq)]
enum By {
    /// Corners went less far than the size of detail, and nothing else was done: what only the solid or only the mesh has
    /// is where the surface went through, a skin of that thickness.
    Moving,
    /// The kernel united edges; what came of it is measured.
    Uniting,
}

/// The mesh, or that with the corners of its crossings united, if it is the solid's shape and no triangles cross.
fn plain(solid: &Solid, candidate: &Candidate) -> Option<(Mesh, f64)> {
    let found = crossings(&candidate.mesh);
    let fits = |mesh: &Mesh, size: f64| candidate.by == By::Moving || same(solid, mesh, size);
    if found.is_empty() {
        return fits(&candidate.mesh, candidate.size).then(|| (candidate.mesh.clone(), candidate.size));
    }
    let (mesh, gap) = welded(&candidate.mesh, &found);
    let size = candidate.size + gap;
    let whole = mesh.closure() == Closure::Closed && crossings(&mesh).is_empty();
    (whole && fits(&mesh, size)).then_some((mesh, size))
}

/// Corners of triangles that cross united where they are within `COARSEST` of each other, and how far one went at most: two
/// sheets so near each other, as a step beside the silhouette leaves them, become one, and what was between them vanishes.
fn welded(mesh: &Mesh, found: &[Crossing]) -> (Mesh, f64) {
    let mut vertices = mesh.vertices.clone();
    for c in found {
        let mut of: Vec<u32> = mesh.triangles[c.triangles.0 as usize].to_vec();
        of.extend(mesh.triangles[c.triangles.1 as usize]);
        of.sort_unstable();
        for (k, &a) in of.iter().enumerate() {
            for &b in &of[k + 1..] {
                let gap = mesh.vertices[a as usize].distance(mesh.vertices[b as usize]);
                if gap > 0.0 && gap < COARSEST {
                    vertices[b as usize] = vertices[a as usize];
                }
            }
        }
    }
    let (united, went) = moved(mesh, &vertices);
    (without_folds(united), went)
}

/// The mesh without pairs of triangles on the same corners that face away from each other.
fn without_folds(mut mesh: Mesh) -> Mesh {
    let turned = |t: [u32; 3]| {
        let k = (0..3).min_by_key(|&k| t[k]).unwrap_or(0);
        [t[k], t[(k + 1) % 3], t[(k + 2) % 3]]
    };
    let all: BTreeSet<[u32; 3]> = mesh.triangles.iter().map(|&t| turned(t)).collect();
    mesh.triangles.retain(|&[a, b, c]| !all.contains(&turned([a, c, b])));
    mesh
}

/// The solid as `settled`, or nothing where triangles would cross: what further booleans can rest on.
pub fn uncrossed(solid: &Solid) -> Option<Solid> {
    uncrossed_to(solid, COARSEST).and_then(|(mesh, _)| Solid::of(&mesh).ok())
}

/// The solid as `settled`, or nothing where triangles would cross; detail up to `coarsest` mm may be united for it.
pub fn uncrossed_to(solid: &Solid, coarsest: f64) -> Option<(Mesh, f64)> {
    closed_on_grid(solid, coarsest).find_map(|c| plain(solid, &c))
}

/// Closed meshes of the solid on `GRID` with more and more detail united, up to `coarsest` mm.
fn closed_on_grid(solid: &Solid, coarsest: f64) -> impl Iterator<Item = Candidate> {
    let whole = solid.mesh();
    let finest = details(&whole, coarsest).next().unwrap_or(coarsest);
    let sizes = details(&whole, coarsest);
    let as_it_is = std::iter::once_with(move || {
        let (mesh, went) = mended(on_grid(&whole), finest);
        Candidate { mesh, size: finest + went, by: By::Moving }
    });
    let united = sizes.map(|size| {
        let (mesh, _) = mended(on_grid(&solid.plain(size).mesh()), size);
        Candidate { mesh, size, by: By::Uniting }
    });
    as_it_is.chain(united).filter(|c| c.mesh.closure() == Closure::Closed)
}

/// Whether uniting detail has left the shape alone: what only one of both has is a skin of that thickness at most.
fn same(solid: &Solid, mesh: &Mesh, size: f64) -> bool {
    let apart = |other: Solid| solid.volume() + other.volume() - 2.0 * solid.common(&other).volume();
    Solid::of(mesh).is_ok_and(|other| apart(other) <= size * mesh.area())
}

/// Whether no triangles are known to cross; one without area counts as crossing its neighbours. A crowd that is not
/// looked through passes.
pub fn is_plain(mesh: &Mesh) -> bool {
    crossings(mesh).is_empty()
}

fn crossings(mesh: &Mesh) -> Vec<Crossing> {
    cross::within(mesh, &Bvh::new(mesh)).unwrap_or_default()
}

/// Sizes of detail to do without, in mm: from `FINEST` snaps of the mesh, doubling up to `coarsest`.
pub fn details(mesh: &Mesh, coarsest: f64) -> impl Iterator<Item = f64> + use<> {
    let (lo, hi) = mesh.bounds();
    let snap = grid_distance(lo.abs().max(hi.abs()).max_element());
    std::iter::successors(Some(FINEST * snap), |s| Some(s * 2.0)).take_while(move |s| *s <= coarsest)
}

/// The mesh with both ends of each edge united that is shorter than `size` and not between two opposite triangles, and how far
/// a corner went at most, mm.
fn mended(mesh: Mesh, size: f64) -> (Mesh, f64) {
    let short: Vec<(u32, u32)> = mesh
        .loose_edges()
        .into_iter()
        .filter(|&(a, b)| mesh.vertices[a as usize].distance(mesh.vertices[b as usize]) < size)
        .collect();
    if short.is_empty() {
        return (mesh, 0.0);
    }
    let mut vertices = mesh.vertices.clone();
    short.iter().for_each(|&(a, b)| vertices[b as usize] = vertices[a as usize]);
    moved(&mesh, &vertices)
}

/// The mesh with its corners there, and how far one went at most, mm.
fn moved(mesh: &Mesh, vertices: &[DVec3]) -> (Mesh, f64) {
    let went = mesh.vertices.iter().zip(vertices).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    let points = vertices.iter().map(|v| v.to_array().map(|x| x as f32 + 0.0)).collect();
    (united(points, mesh.triangles.iter().copied()), went)
}

/// Two corners this many snaps apart stay apart when each moves by one.
const FINEST: f64 = 4.0;

/// No detail of a mold is as small as this, mm: a tenth of the finest layer.
pub const COARSEST: f64 = 0.002;

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
