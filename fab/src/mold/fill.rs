//! Takes a part in its mold frame and what shadows it; gives the part with the air between filled, and how much that is.
//!
//! After it the part is one stretch on every upright line, to round-off: then two halves leave it. Meant for undercuts
//! that nobody sees; whoever calls decides how much may be filled.

use crate::bvh::Bvh;
use crate::mesh::Mesh;
use crate::mold::ray;
use crate::mold::shadow::{self, Blocked, Overlap};
use crate::solid::{NotSolid, Solid};
use glam::{DVec2, DVec3};

/// Columns go on into the matter at their ends by this share of it, at most `DEEPEST` mm, so that they meet the part in
/// volume and not in faces; at a sharp rim there is none, and they end on it.
const INTO: f64 = 0.25;
const DEEPEST: f64 = 0.5;

/// How far a column that ends on the part at `at` goes on into it along a unit vector.
pub fn into(part: (&Mesh, &Bvh), at: DVec3, along: DVec3) -> f64 {
    (INTO * ray::matter(part, at, along)).min(DEEPEST)
}

/// The part with its undercuts filled, and the volume that came to it, mm3.
pub fn fill(part: &Solid, mesh: &Mesh, blocked: &Blocked) -> Result<(Solid, f64), NotSolid> {
    let tree = Bvh::new(mesh);
    let columns: Vec<Solid> = blocked
        .overlaps
        .iter()
        .filter_map(|o| column((mesh, &tree), o).transpose())
        .collect::<Result<_, _>>()?;
    let filled = part.with(&Solid::all(columns));
    let grown = filled.volume() - part.volume();
    Ok((filled, grown))
}

/// The air between the two facets over the outline that they share.
fn column(part: (&Mesh, &Bvh), o: &Overlap) -> Result<Option<Solid>, NotSolid> {
    let height = |t: u32, p: DVec2| shadow::height(&part.0.corners(t as usize), p);
    let end = |p: DVec2, z: f64, way: DVec3| p.extend(z) + way * into(part, p.extend(z), way);
    let foot = o.outline.iter().map(|&p| end(p, height(o.lower, p), DVec3::NEG_Z));
    let top = o.outline.iter().map(|&p| end(p, height(o.upper, p).max(height(o.lower, p)), DVec3::Z));
    let body = prism(foot.collect(), top.collect());
    if body.volume() <= 0.0 { Ok(None) } else { Solid::of(&body).map(Some) }
}

/// A body between two rings of as many points, counter-clockwise from above.
pub fn prism(foot: Vec<DVec3>, top: Vec<DVec3>) -> Mesh {
    let n = foot.len() as u32;
    let caps = (1..n.max(1) - 1).flat_map(|k| [[0, k + 1, k], [n, n + k, n + k + 1]]);
    let walls = (0..n).flat_map(|k| {
        let next = (k + 1) % n;
        [[k, next, n + next], [k, n + next, n + k]]
    });
    let triangles = caps.chain(walls).collect();
    Mesh { vertices: foot.into_iter().chain(top).collect(), triangles }
}
