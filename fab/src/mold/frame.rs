//! Takes a mesh and a pull direction; gives the mesh with the pull along z, its footprint as square to x and y as it can
//! be, the middle of its foot at the origin, and coordinates that f32 holds.

use crate::files::stl;
use crate::mesh::Mesh;
use crate::mold::shadow::flat;
use glam::{DMat3, DVec2, DVec3};

/// A part turned for its mold.
#[derive(Clone, Debug)]
pub struct Framed {
    pub mesh: Mesh,
    pub turn: DMat3,
    pub shift: DVec3,
    /// How far a coordinate may be off, mm.
    pub snap: f64,
}

/// A direction nearer to an axis than this is the axis: f64 round-off of a normalized cross product.
const AXIS_ROUND_OFF: f64 = 1e-12;

/// Turning the footprint must save this share of its rectangle, else it stays as it came.
const WORTH_TURNING: f64 = 0.02;

/// A rotation that takes `pull` (unit) to z; for an axis it only exchanges coordinates, which f64 does exactly.
pub fn upright(pull: DVec3) -> DMat3 {
    let z = on_axis(pull);
    let away = (z.abs().min_position() + usize::from(z.abs().max_element() == 1.0)) % 3;
    let x = (DVec3::AXES[away] - z * z[away]).normalize();
    let x = if z.abs().max_element() == 1.0 { DVec3::AXES[(z.abs().max_position() + 1) % 3] } else { x };
    DMat3::from_cols(x, z.cross(x), z).transpose()
}

fn on_axis(d: DVec3) -> DVec3 {
    let k = d.abs().max_position();
    let axis = DVec3::AXES[k] * d[k].signum();
    if (d - axis).length() < AXIS_ROUND_OFF { axis } else { d }
}

/// What of a part lies square to x and y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Footprint {
    /// The smallest rectangle around it.
    Smallest,
    /// Its walls: then walls that run along a bore lie exactly along it, also after rounding.
    Walls,
}

pub fn framed(part: &Mesh, pull: DVec3, footprint: Footprint) -> Framed {
    let upright = upright(pull);
    let turned = part.map(|v| upright * v);
    let angle = match footprint {
        Footprint::Smallest => squared(&hull(turned.vertices.iter().map(|&v| flat(v)).collect())),
        Footprint::Walls => walls(&turned),
    };
    let (sin, cos) = angle.sin_cos();
    let turn = if sin == 0.0 {
        upright
    } else {
        DMat3::from_cols(DVec3::new(cos, -sin, 0.0), DVec3::new(sin, cos, 0.0), DVec3::Z) * upright
    };
    let (lo, hi) = part.map(|v| turn * v).bounds();
    let shift = -((lo + hi) / 2.0).with_z(lo.z);
    let (mesh, snap) = settled(&part.map(|v| turn * v + shift));
    Framed { mesh, turn, shift, snap }
}

/// Coordinates within this many snaps become one: what should lie in one plane of the frame then does, and no boolean
/// leaves a sliver of round-off beside it.
const SAME_IN_SNAPS: f64 = 2.0;

/// The mesh in f32, equal coordinates made equal, and how far a coordinate may be off by both, mm.
pub fn settled(mesh: &Mesh) -> (Mesh, f64) {
    let (lo, hi) = mesh.bounds();
    let snap = stl::grid_distance(lo.abs().max(hi.abs()).max_element());
    let mut meshes = [stl::on_grid(mesh)];
    aligned(&mut meshes, SAME_IN_SNAPS * snap);
    (stl::on_grid(&meshes[0]), snap * (1.0 + SAME_IN_SNAPS))
}

/// Makes coordinates of all meshes that differ by at most `within` mm one.
pub fn aligned(meshes: &mut [Mesh], within: f64) {
    for axis in 0..3 {
        let mut all: Vec<&mut f64> =
            meshes.iter_mut().flat_map(|m| &mut m.vertices).map(|v| &mut v[axis]).collect();
        all.sort_by(|a, b| a.total_cmp(b));
        let mut first = f64::NEG_INFINITY;
        for here in all {
            if *here - first <= within {
                *here = first;
            } else {
                first = *here;
            }
        }
    }
}

/// The angle of the hull edge that lies along the smallest rectangle around the hull.
fn squared(hull: &[DVec2]) -> f64 {
    let area = |angle: f64| {
        let turn = DVec2::from_angle(-angle);
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (lo, hi) = hull.iter().map(|p| turn.rotate(*p)).fold(start, |(l, h), p| (l.min(p), h.max(p)));
        (hi - lo).element_product()
    };
    let edges = (0..hull.len()).map(|k| (hull[(k + 1) % hull.len()] - hull[k]).to_angle());
    let best = edges.map(|a| (area(a), a)).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    best.filter(|b| b.0 < area(0.0) * (1.0 - WORTH_TURNING)).map_or(0.0, |b| b.1)
}

/// The angle, up to a quarter turn, at which most area of upright walls stands; 0 where there are none.
fn walls(mesh: &Mesh) -> f64 {
    let wall = |t: usize| {
        let [a, b, c] = mesh.corners(t);
        let n = (b - a).cross(c - a);
        (n.z.abs() <= UPRIGHT * n.length() && n != DVec3::ZERO)
            .then(|| (flat(n).to_angle().rem_euclid(std::f64::consts::FRAC_PI_2), n.length()))
    };
    let mut all: Vec<(f64, f64)> = (0..mesh.triangles.len()).filter_map(wall).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = (0.0, 0.0);
    for angles in all.chunk_by(|a, b| b.0 - a.0 <= UPRIGHT) {
        let area = angles.iter().map(|a| a.1).sum::<f64>();
        if area > best.1 {
            best = (angles[0].0, area);
        }
    }
    // What is a quarter turn but for round-off needs none.
    if std::f64::consts::FRAC_PI_2 - best.0 <= UPRIGHT || best.0 <= UPRIGHT { 0.0 } else { best.0 }
}

/// Walls stand upright, and at the same angle, to this (radians): a coordinate of f32 over a millimetre at 100 mm.
const UPRIGHT: f64 = 1e-5;

/// Convex hull, counter-clockwise (monotone chain).
pub fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let chain = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut kept: Vec<DVec2> = Vec::new();
        for p in points {
            while kept.len() > 1
                && (kept[kept.len() - 1] - kept[kept.len() - 2]).perp_dot(p - kept[kept.len() - 1]) <= 0.0
            {
                kept.pop();
            }
            kept.push(p);
        }
        kept.pop();
        kept
    };
    let mut all = chain(&mut points.iter().copied());
    all.extend(chain(&mut points.iter().rev().copied()));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_that_are_nearly_one_become_one() {
        let box_of = |x: f64| crate::solid::cuboid(DVec3::ZERO, DVec3::new(x, 40.0, 50.0));
        let mut m = box_of(30.0);
        m.vertices[1].x += 2e-6;
        let (settled, snap) = settled(&m);
        assert_eq!(settled, stl::on_grid(&box_of(30.0)), "corners are numbered anew");
        assert!(snap < 2e-5, "{snap}");
    }

    #[test]
    fn the_pull_becomes_z_and_axes_stay_exact() {
        for d in [DVec3::X, DVec3::NEG_Z, DVec3::Y, DVec3::new(1.0, 2.0, -3.0).normalize()] {
            let m = upright(d);
            assert!((m * d - DVec3::Z).length() < 1e-15 && (m.determinant() - 1.0).abs() < 1e-14, "{d}");
        }
        assert_eq!(upright(DVec3::X) * DVec3::new(0.1, 0.2, 0.3), DVec3::new(0.2, 0.3, 0.1));
    }
}
