//! Takes a part as made; gives the turn that lays it on a print bed.
//!
//! Tried are the directions of its flat faces: of those that it stands on, the one that needs least support, then the
//! lowest. Not promised: the least support of all turns, or that a part without a flat face stands.

use crate::mesh::{Mesh, area};
use crate::mold::frame::hull;
use glam::{DQuat, DVec2, DVec3};
use serde::Serialize;
use std::collections::BTreeMap;

/// A way to lay a part down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Laying {
    /// From the part's place in the assembly to the bed.
    #[serde(skip)]
    pub turn: DQuat,
    /// The direction in the assembly that faces the bed.
    pub down: DVec3,
    /// Of the faces on the bed, mm2.
    pub contact_mm2: f64,
    /// Of faces that overhang by more than 45 degrees, seen from above, mm2.
    pub overhang_mm2: f64,
    /// Of the room below these, mm3.
    pub support_mm3: f64,
    pub height_mm: f64,
    pub footing: Footing,
}

/// Whether the part stands by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Footing {
    /// Its centre of mass is above the face that it stands on.
    Stands,
    /// It has a flat face on the bed, but its centre of mass is beside it: supports or a brim hold it.
    Leans,
    /// No flat face of it is on the bed.
    Tips,
}

/// A face that is off the bed by less than this prints as if on it, mm: a tenth of a thin layer.
const FLAT: f64 = 0.01;
/// Faces whose normals round to the same multiple of this are one face for the search: about 0.06 degrees.
const SAME_NORMAL: f64 = 1e-3;
/// Faces that are tried, by area: a part has few that it can stand on.
const TRIED: usize = 64;
/// What overhangs less than this needs no support: cosine between a face's normal and down.
const OVERHANG: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// Supports that differ by less than this share are equal: the part's two broad faces are the same but for round-off.
const SAME_SUPPORT: f64 = 1e-6;

struct Face {
    centre: DVec3,
    normal: DVec3,
    area: f64,
}

/// The best way to lay the mesh down.
pub fn lay(mesh: &Mesh) -> Laying {
    let faces: Vec<Face> = (0..mesh.triangles.len()).map(|t| face(mesh.corners(t))).collect();
    let scale = mesh.volume().abs().max(f64::MIN_POSITIVE);
    let rank = |l: &Laying| {
        (l.footing, (l.support_mm3 / scale / SAME_SUPPORT).round(), (l.height_mm / FLAT).round())
    };
    let tried = directions(&faces).into_iter().map(|down| laid(mesh, &faces, down));
    let best = tried.min_by(|a, b| rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal));
    best.unwrap_or_else(|| laid(mesh, &faces, DVec3::NEG_Z))
}

/// The same way down of a mesh whose print face was cut: how it stands now.
pub fn again(mesh: &Mesh, before: &Laying) -> Laying {
    let faces: Vec<Face> = (0..mesh.triangles.len()).map(|t| face(mesh.corners(t))).collect();
    laid(mesh, &faces, before.down)
}

fn face(corners: [DVec3; 3]) -> Face {
    let [a, b, c] = corners;
    let normal = (b - a).cross(c - a).normalize_or_zero();
    Face { centre: (a + b + c) / 3.0, normal, area: area(corners) }
}

/// Down in the assembly first (so that equal ways keep it), then the normals with most area.
fn directions(faces: &[Face]) -> Vec<DVec3> {
    let mut areas: BTreeMap<[i64; 3], (f64, DVec3)> = BTreeMap::new();
    for f in faces {
        let key = (f.normal / SAME_NORMAL).round().to_array().map(|x| x as i64);
        let entry = areas.entry(key).or_insert((0.0, DVec3::ZERO));
        *entry = (entry.0 + f.area, entry.1 + f.normal * f.area);
    }
    let mut all: Vec<(f64, DVec3)> = areas.into_values().collect();
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let normals = all.into_iter().take(TRIED).filter_map(|(_, n)| n.try_normalize());
    [DVec3::NEG_Z, DVec3::Z].into_iter().chain(normals).collect()
}

fn laid(mesh: &Mesh, faces: &[Face], down: DVec3) -> Laying {
    let heights = mesh.vertices.iter().map(|v| -v.dot(down));
    let (low, high) = heights.fold((f64::MAX, f64::MIN), |(l, h), z| (l.min(z), h.max(z)));
    let on_bed = |t: usize| mesh.corners(t).iter().all(|v| -v.dot(down) - low < FLAT);
    let turn = upright(mesh, DQuat::from_rotation_arc(down, DVec3::NEG_Z));
    let (mut contact, mut overhang, mut support, mut feet) = (0.0, 0.0, 0.0, vec![]);
    for (t, f) in faces.iter().enumerate() {
        let facing = f.normal.dot(down);
        if on_bed(t) {
            contact += f.area;
            feet.extend(mesh.corners(t).map(|v| (turn * v).truncate()));
        } else if facing > OVERHANG {
            overhang += f.area * facing;
            support += f.area * facing * (-f.centre.dot(down) - low);
        }
    }
    let above = (turn * centre_of_mass(mesh)).truncate();
    let footing = match contact > 0.0 {
        true if within(&hull(feet), above) => Footing::Stands,
        true => Footing::Leans,
        false => Footing::Tips,
    };
    let height_mm = high - low;
    Laying {
        turn,
        down,
        contact_mm2: contact,
        overhang_mm2: overhang,
        support_mm3: support,
        height_mm,
        footing,
    }
}

/// Turned about the vertical so that the box around it is least, its long side along x.
fn upright(mesh: &Mesh, turn: DQuat) -> DQuat {
    let outline = hull(mesh.vertices.iter().map(|&v| (turn * v).truncate()).collect());
    let size = |angle: f64| {
        let along = DVec2::from_angle(-angle);
        let turned = outline.iter().map(|p| along.rotate(*p));
        let (lo, hi) = turned.fold((DVec2::MAX, DVec2::MIN), |(l, h), p| (l.min(p), h.max(p)));
        hi - lo
    };
    let edge = |k: usize| outline[(k + 1) % outline.len()] - outline[k];
    let angles = (0..outline.len()).map(|k| edge(k).to_angle());
    let area = |a: &f64| size(*a).element_product();
    // Not turned wins where turning gains nothing worth the name.
    let best = angles.min_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or(0.0);
    let best = if area(&best) < area(&0.0) * (1.0 - SAME_NORMAL) { best } else { 0.0 };
    let quarter = if size(best).y > size(best).x { std::f64::consts::FRAC_PI_2 } else { 0.0 };
    DQuat::from_rotation_z(quarter - best) * turn
}

fn centre_of_mass(mesh: &Mesh) -> DVec3 {
    let (lo, hi) = mesh.bounds();
    let o = (lo + hi) / 2.0;
    let cone = |t: usize| {
        let [a, b, c] = mesh.corners(t).map(|p| p - o);
        let six = a.dot(b.cross(c));
        (six, (a + b + c) / 4.0 * six)
    };
    let sum = (0..mesh.triangles.len()).map(cone).fold((0.0, DVec3::ZERO), |s, c| (s.0 + c.0, s.1 + c.1));
    if sum.0 == 0.0 { o } else { o + sum.1 / sum.0 }
}

fn within(hull: &[DVec2], p: DVec2) -> bool {
    hull.len() > 2
        && (0..hull.len()).all(|k| (hull[(k + 1) % hull.len()] - hull[k]).perp_dot(p - hull[k]) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::cuboid;

    #[test]
    fn a_plate_on_its_edge_is_laid_flat_and_its_long_side_along_x() {
        let mesh = cuboid(DVec3::ZERO, DVec3::new(2.0, 10.0, 30.0));
        let tilted = mesh.map(|v| DQuat::from_euler(glam::EulerRot::XYZ, 0.3, 0.7, 1.1) * v);
        let l = lay(&tilted);
        assert!((l.height_mm - 2.0).abs() < 1e-9 && (l.contact_mm2 - 300.0).abs() < 1e-6, "{l:?}");
        let (lo, hi) = tilted.map(|v| l.turn * v).bounds();
        assert!((hi - lo).distance(DVec3::new(30.0, 10.0, 2.0)) < 1e-9, "{}", hi - lo);
        assert_eq!((l.footing, l.support_mm3), (Footing::Stands, 0.0));
    }

    #[test]
    fn a_needle_on_its_point_tips() {
        let mut mesh = cuboid(DVec3::ZERO, DVec3::ONE);
        // A pyramid of which no face lies below its middle: all faces lean.
        mesh.vertices =
            mesh.vertices.iter().map(|v| DVec3::new(v.x * 0.1 + v.z * 5.0, v.y, v.z * 10.0)).collect();
        assert_eq!(laid(&mesh, &[], DVec3::NEG_Z).footing, Footing::Tips);
    }
}
