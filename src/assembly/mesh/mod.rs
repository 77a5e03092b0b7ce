//! Takes mesh files (STL, OBJ, 3MF), gives one closed solid for each.
//!
//! Promised: closed, outward, no face twice, vertices welded by identity, facets planar and convex; a file
//! that is not so is refused with all its faults. Not promised: that the surface touches itself nowhere, nor
//! that several shells keep clear of each other.

mod cells;
mod close;
mod crossing;
mod digits;
mod faults;
mod flat;
mod obj;
mod polygon;
mod shells;
mod soup;
mod stl;
mod threemf;

pub use cells::NoCells;
pub(crate) use cells::polytope::{halves, height};
pub use faults::{MeshFault, MeshFaults, Place};
pub(crate) use shells::solid_angle;

use crate::solid::{Facet, Solid};
use close::LISTED;
use faults::{Found, found};
use soup::Soup;
use std::path::Path;

/// What a mesh file holds.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// One part, in model units; its convex cells are filled where they are known.
    pub solid: Solid,
    /// Closed outward shells that share no edge; they count as one rigid part.
    pub bodies: usize,
    /// Hollows inside.
    pub voids: usize,
    /// Half a unit in the last place of the file's coordinates, in model units.
    pub resolution: f64,
    /// What was taken in good faith and may not be meant, in words.
    pub remarks: Vec<String>,
}

/// How a mesh file is to be read.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Only 3MF says its unit; STL and OBJ are taken as model units.
    pub mm_per_unit: f64,
    /// The user's contact tolerance, in model units: nothing finer decides what is flat.
    pub tolerance: f64,
}

/// Reads one file as one part.
///
/// # Errors
/// All faults of the file, each with its place.
pub fn read_mesh(path: &Path, reading: Reading) -> Result<Mesh, MeshFaults> {
    let own = |faults: Vec<Found>| {
        MeshFaults(
            faults
                .into_iter()
                .map(|f| MeshFault {
                    file: path.to_owned(),
                    place: f.place,
                    what: f.what,
                    hint: f.hint.to_owned(),
                })
                .collect(),
        )
    };
    let hint = "the path is taken relative to the file that names it";
    let bytes = std::fs::read(path).map_err(|e| own(vec![found(Place::File, e.to_string(), hint)]))?;
    let kind = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let soup = match kind.as_str() {
        "obj" => obj::read(&String::from_utf8_lossy(&bytes)),
        "stl" => stl::read(&bytes),
        "3mf" => threemf::read(&bytes, reading.mm_per_unit),
        _ => Err(vec![found(
            Place::File,
            format!("no mesh format is called `{kind}`"),
            "use .stl, .obj or .3mf",
        )]),
    };
    soup.and_then(|s| solid(&s, reading)).map_err(own)
}

fn solid(soup: &Soup, reading: Reading) -> Result<Mesh, Vec<Found>> {
    let width = flat::width(soup.resolution, reading.tolerance);
    let closed = close::close(soup, width)?;
    let mut facets = Vec::new();
    let mut faults = Vec::new();
    for ring in &closed.rings {
        match polygon::facets(ring, &soup.vertices, width) {
            Some(f) => facets.extend(f),
            None => {
                let at = |k: usize| soup.vertices[ring[k] as usize];
                faults.push(found(
                    Place::Edge(at(0), at(1)),
                    "the face beside it crosses itself",
                    "split it into triangles",
                ));
            }
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let crossed = crossing::crossings(&facets, &soup.vertices, width);
    if !crossed.is_empty() {
        return Err(crossed.into_iter().take(LISTED).map(|((a, b), _)| crossed_at(a, b, soup)).collect());
    }
    let normals = flat::normals(&facets, &soup.vertices, width, reading.tolerance);
    let facets = facets.into_iter().zip(normals).map(|(corners, normal)| Facet { corners, normal }).collect();
    let mut solid =
        used_only(Solid { vertices: soup.vertices.clone(), facets, off: width, ..Solid::default() });
    let mut remarks = remarks(&closed);
    match cells::cells(&solid, width) {
        Ok(cells) => {
            solid.off = cells.iter().map(cells::off).fold(width, f64::max);
            solid.cells = cells;
        }
        Err(why) => remarks.push(format!("no convex cells ({why}): plans are not run for this part")),
    }
    Ok(Mesh { solid, bodies: closed.bodies, voids: closed.voids, resolution: soup.resolution, remarks })
}

fn crossed_at(a: u32, b: u32, soup: &Soup) -> Found {
    let place = Place::Edge(soup.vertices[a as usize], soup.vertices[b as usize]);
    found(place, "runs through another face of the same shell", "the surface must not cross itself")
}

/// The solid without vertices that no facet uses.
fn used_only(mut solid: Solid) -> Solid {
    let mut new = vec![u32::MAX; solid.vertices.len()];
    let mut vertices = Vec::new();
    let mut facets = std::mem::take(&mut solid.facets);
    for i in facets.iter_mut().flat_map(|f| f.corners.iter_mut()) {
        if new[*i as usize] == u32::MAX {
            new[*i as usize] = vertices.len() as u32;
            vertices.push(solid.vertices[*i as usize]);
        }
        *i = new[*i as usize];
    }
    Solid { vertices, facets, ..solid }
}

fn remarks(c: &close::Closed) -> Vec<String> {
    let several = (c.bodies > 1).then(|| format!("{} bodies, taken as one rigid part", c.bodies));
    let hollow = (c.voids > 0).then(|| format!("{} hollows inside", c.voids));
    let tees =
        (c.t_junctions > 0).then(|| format!("{} vertices stood on the edge of a neighbor", c.t_junctions));
    let dropped = (c.dropped > 0).then(|| format!("{} faces without area were passed over", c.dropped));
    let walls =
        (c.walls > 0).then(|| format!("{} walls inside, a face and its reverse, were taken out", c.walls));
    let touch = (c.touching_edges > 0).then(|| format!("touches itself along {} edges", c.touching_edges));
    [several, hollow, tees, dropped, walls, touch].into_iter().flatten().collect()
}
