//! Takes a part in its mold frame (pull along z); gives the surface that parts the mold: a plane where one does, else one
//! stepped up and down to the silhouette.
//!
//! A plane at height c is exact: below c no facet looks up and above c none looks down, so that on every upright line
//! the part is one stretch through c. The steps are upright walls under (or over) the silhouette: they have no draft.

use crate::bvh::Bvh;
use crate::files::stl::grid_place;
use crate::mesh::{Mesh, area};
use crate::mold::curtain::{Seen, To};
use crate::mold::fill::{into, prism};
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

/// The plane that parts best: in the middle of all that part exactly, or where the least area is on the wrong side. It is a
/// plane of the files' grid, so that what was cut along it meets without a skin when it is read back.
pub fn plane(part: &Mesh, looks: &[Look], snap: f64) -> Plane {
    let heights = |l: Look| {
        let of = part.triangles.iter().zip(looks).filter(move |(_, k)| **k == l).flat_map(|(t, _)| *t);
        of.map(|v| part.vertices[v as usize].z)
    };
    let lowest = heights(Look::Up).fold(f64::INFINITY, f64::min);
    let highest = heights(Look::Down).fold(f64::NEG_INFINITY, f64::max);
    if highest <= lowest + WALL_IN_SNAPS * snap {
        return Plane { height: grid_place((lowest + highest) / 2.0), wrong: 0.0 };
    }
    compromise(part, looks)
}

/// Heights between which a compromise is looked for.
const HEIGHTS: usize = 64;

fn compromise(part: &Mesh, looks: &[Look]) -> Plane {
    let (lo, hi) = part.bounds();
    let step = (hi.z - lo.z) / HEIGHTS as f64;
    let heights = (1..HEIGHTS).map(|k| grid_place(lo.z + step * k as f64));
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
/// `fat`: how much wider the steps are on each side, mm. 0 for the mold itself; a little for a file that is read by
/// itself, where steps that meet in an edge must not.
pub fn below(
    block: (DVec3, DVec3),
    cavity: &Solid,
    plane: &Plane,
    snap: f64,
    fat: f64,
) -> Result<Solid, NotSolid> {
    let (lo, hi) = block;
    let half = Solid::of(&cuboid(lo, hi.with_z(plane.height)))?;
    if plane.wrong == 0.0 {
        return Ok(half);
    }
    let other = Solid::of(&cuboid(lo.with_z(plane.height), hi))?;
    let wrong = |cut: &Solid, way: Look| -> Result<Solid, NotSolid> {
        Ok(Solid::all(wrong_side(&cut.mesh(), way, plane.height, snap, fat)?))
    };
    let (raised, lowered) =
        rayon::join(|| wrong(&cavity.common(&other), Look::Down), || wrong(&cavity.common(&half), Look::Up));
    Ok(half.minus(&lowered?).with(&raised?))
}

/// What is between the plane and the facets that look the wrong way there, and on into the part.
fn wrong_side(cut: &Mesh, way: Look, height: f64, snap: f64, fat: f64) -> Result<Vec<Solid>, NotSolid> {
    let seen = Seen::along(cut, DVec3::Z, snap);
    let off_plane = |t: usize| cut.corners(t).iter().any(|c| (c.z - height).abs() > WALL_IN_SNAPS * snap);
    let wrong = seen.looking(way, off_plane);
    if fat > 0.0 {
        let tree = Bvh::new(cut);
        let fat = |t: &u32| fattened(&column((cut, &tree), cut.corners(*t as usize), height), fat);
        return Ok(wrong.iter().map(fat).collect());
    }
    seen.rooted(&wrong, if way == Look::Down { To::Against(height) } else { To::Along(height) })
}

fn fattened(column: &Mesh, fat: f64) -> Solid {
    let around = [DVec3::new(fat, fat, 0.0), DVec3::new(-fat, fat, 0.0)];
    let corners = column.vertices.iter().flat_map(|v| around.into_iter().flat_map(|a| [*v + a, *v - a]));
    Solid::hull(&corners.collect::<Vec<_>>())
}

fn column(part: (&Mesh, &Bvh), c: [DVec3; 3], height: f64) -> Mesh {
    let onto = |c: [DVec3; 3]| c.map(|v| v.with_z(height)).to_vec();
    let inner = |c: [DVec3; 3], way: DVec3| c.map(|v| v + way * into(part, v, way)).to_vec();
    if (c[1] - c[0]).cross(c[2] - c[0]).z > 0.0 {
        return prism(inner(c, DVec3::NEG_Z), onto(c));
    }
    let c = [c[0], c[2], c[1]];
    prism(onto(c), inner(c, DVec3::Z))
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
