//! Takes a part in its mold frame and what shadows it; gives the part with the air between filled, and how much that is.
//!
//! After it the part is one stretch on every upright line, to round-off: then two halves leave it. Meant for undercuts
//! that nobody sees; whoever calls decides how much may be filled.

use crate::mesh::Mesh;
use crate::mold::shadow::{Blocked, Overlap};
use crate::solid::{NotSolid, Solid};
use glam::{DVec2, DVec3};

/// How far a fill reaches into the part at both its ends, in snaps: so that it is one body with it.
const OVER_IN_SNAPS: f64 = 4.0;

/// The part with its undercuts filled, and the volume that came to it, mm3.
pub fn fill(part: &Solid, mesh: &Mesh, blocked: &Blocked, snap: f64) -> Result<(Solid, f64), NotSolid> {
    let columns: Vec<Solid> = blocked
        .overlaps
        .iter()
        .filter_map(|o| column(mesh, o, OVER_IN_SNAPS * snap).transpose())
        .collect::<Result<_, _>>()?;
    let filled = part.with(&Solid::all(columns));
    let grown = filled.volume() - part.volume();
    Ok((filled, grown))
}

/// The air between the two facets over the outline that they share.
fn column(mesh: &Mesh, o: &Overlap, over: f64) -> Result<Option<Solid>, NotSolid> {
    let height = |t: u32, p: DVec2| super::shadow::height(&mesh.corners(t as usize), p);
    let foot = o.outline.iter().map(|&p| p.extend(height(o.lower, p) - over));
    let top = o.outline.iter().map(|&p| p.extend(height(o.upper, p).max(height(o.lower, p)) + over));
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
