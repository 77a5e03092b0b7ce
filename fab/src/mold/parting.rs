//! Takes a part in its mold frame (pull along z); gives the surface that parts the mold: a plane where one does, else one
//! stepped up and down to the silhouette.
//!
//! A plane at height c is exact: below c no facet looks up and above c none looks down, so that on every upright line
//! the part is one stretch through c. Steps lean by the draft that is asked for wherever the part is not in the way.

use crate::bvh::Bvh;
use crate::mesh::{Mesh, area};
use crate::mold::layout::BEYOND;
use crate::mold::sweep::{self, Footprint, Way};
use crate::solid::{NotSolid, Solid, cuboid};
use glam::DVec3;

/// Which way a facet looks along the pull.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    Up,
    Down,
    /// A wall along the pull, to round-off.
    Wall,
}

/// A wall's top may stand this many snaps off its foot: both may be off by one in two coordinates.
const WALL_IN_SNAPS: f64 = 4.0;

pub fn looks(part: &Mesh, snap: f64) -> Vec<Look> {
    (0..part.triangles.len()).map(|t| look(part, t, snap)).collect()
}

fn look(part: &Mesh, t: usize, snap: f64) -> Look {
    let c = part.corners(t);
    let n = (c[1] - c[0]).cross(c[2] - c[0]);
    let heights = c.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v.z), h.max(v.z)));
    let lean = (heights.1 - heights.0) * n.z.abs();
    match n.z {
        _ if lean < WALL_IN_SNAPS * snap * n.truncate().length() => Look::Wall,
        z if z > 0.0 => Look::Up,
        z if z < 0.0 => Look::Down,
        _ => Look::Wall,
    }
}

/// A plane's height, and the projected area that it leaves on the wrong side, mm2; 0 for a plane that parts exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane {
    pub height: f64,
    pub wrong: f64,
}

/// The plane that parts best: in the middle of all that part exactly, or where the least area is on the wrong side.
pub fn plane(part: &Mesh, looks: &[Look], snap: f64) -> Plane {
    let heights = |l: Look| {
        let of = part.triangles.iter().zip(looks).filter(move |(_, k)| **k == l).flat_map(|(t, _)| *t);
        of.map(|v| part.vertices[v as usize].z)
    };
    let lowest = heights(Look::Up).fold(f64::INFINITY, f64::min);
    let highest = heights(Look::Down).fold(f64::NEG_INFINITY, f64::max);
    if highest <= lowest + WALL_IN_SNAPS * snap {
        return Plane { height: (lowest + highest) / 2.0, wrong: 0.0 };
    }
    compromise(part, looks)
}

/// Heights between which a compromise is looked for.
const HEIGHTS: usize = 64;

fn compromise(part: &Mesh, looks: &[Look]) -> Plane {
    let (lo, hi) = part.bounds();
    let step = (hi.z - lo.z) / HEIGHTS as f64;
    let heights = (1..HEIGHTS).map(|k| lo.z + step * k as f64);
    let rated = heights.map(|height| Plane { height, wrong: wrong(part, looks, height) });
    rated.min_by(|a, b| a.wrong.total_cmp(&b.wrong)).unwrap_or(Plane { height: lo.z, wrong: f64::INFINITY })
}

/// Projected area of facets whose middle is on the side that can not form them.
fn wrong(part: &Mesh, looks: &[Look], height: f64) -> f64 {
    let of = |t: usize| {
        let c = part.corners(t);
        let middle = (c[0].z + c[1].z + c[2].z) / 3.0;
        let bad = (looks[t] == Look::Up && middle < height) || (looks[t] == Look::Down && middle > height);
        if bad { area(c.map(|v| v.with_z(0.0))) } else { 0.0 }
    };
    (0..looks.len()).map(of).sum()
}

/// Everything of `block` below the parting surface: up to the plane, where the part is above it up to the part's
/// underside, and where the part is below it only down to the part's top. On every upright line it ends once, so the
/// halves part along z. Exact for a part that is one stretch on every upright line.
///
/// `tan`: of the draft that steps have beside the part, so that the halves do not rub; above the part (for what is
/// raised) and below it (for what is lowered) a step stays upright, since the other half has to leave there.
pub fn below(
    block: (DVec3, DVec3),
    cavity: &Solid,
    plane: &Plane,
    snap: f64,
    tan: f64,
) -> Result<Solid, NotSolid> {
    let (lo, hi) = block;
    let half = Solid::of(&cuboid(lo, hi.with_z(plane.height)))?;
    if plane.wrong == 0.0 {
        return Ok(half);
    }
    let mesh = cavity.mesh();
    let part = (&mesh, &Bvh::new(&mesh));
    let lid = hi.z + BEYOND;
    let raised = step(part, Way::down(plane.height), [lo.z, lid], (snap, tan));
    let lowered = step(part, Way::up(plane.height), [lid, lo.z - BEYOND], (snap, tan));
    Ok(half.with(&raised).minus(&lowered))
}

/// What one half takes beyond the plane: columns from the facets that it forms there to `ends[0]`, and around them
/// wedges, but for what lies behind the part, which leaves toward `ends[1]`.
fn step((mesh, tree): (&Mesh, &Bvh), way: Way, ends: [f64; 2], (snap, tan): (f64, f64)) -> Solid {
    let look_wanted = if way.sign > 0.0 { Look::Up } else { Look::Down };
    let beyond_plane = |t: usize| {
        let off = |v: DVec3| (way.level - v.z) * way.sign > WALL_IN_SNAPS * snap;
        look(mesh, t, snap) == look_wanted && mesh.corners(t).into_iter().any(off)
    };
    let chosen: Vec<bool> = (0..mesh.triangles.len()).map(beyond_plane).collect();
    let columns = sweep::columns((mesh, tree), Way { level: ends[0], ..way }, |t| chosen[t]);
    let wedges = sweep::wedges(mesh, way, ends[0], tan, |t| chosen[t]);
    if wedges.is_empty() {
        return columns;
    }
    let prints: Vec<Footprint> = wedges.iter().map(|w| Footprint::of(w.mesh().vertices)).collect();
    let near = |t: usize| {
        let own = Footprint::of(mesh.corners(t));
        prints.iter().any(|p| p.meets(&own))
    };
    let behind = sweep::columns((mesh, tree), Way { sign: -way.sign, level: ends[1] }, near);
    columns.with(&Solid::all(wedges).minus(&behind))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_is_parted_by_the_plane_through_its_middle() {
        let m = cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
        let looks = looks(&m, 1e-7);
        assert_eq!(plane(&m, &looks, 1e-7), Plane { height: 1.5, wrong: 0.0 });
    }
}
