//! Takes a mesh and a level of z; gives what chosen facets sweep over on their way there: straight columns, and wedges
//! that widen with draft around them.
//!
//! Exact up to the kernel's round-off for facets that lead along the way. Not promised: anything about facets along z,
//! which sweep over nothing.

use crate::bvh::Bvh;
use crate::mesh::{Mesh, area};
use crate::mold::fill::{into, prism};
use crate::mold::shadow::flat;
use crate::solid::Solid;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// Along z: 1 or -1, and the level at which a sweep ends, mm.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    pub sign: f64,
    pub level: f64,
}

impl Way {
    pub fn up(level: f64) -> Way {
        Way { sign: 1.0, level }
    }

    pub fn down(level: f64) -> Way {
        Way { sign: -1.0, level }
    }

    /// Whether a facet with these corners leads along the way.
    pub fn leads(&self, [a, b, c]: [DVec3; 3]) -> bool {
        (b - a).cross(c - a).z * self.sign > 0.0
    }
}

/// A rectangle of the x-y plane, mm.
#[derive(Clone, Copy, Debug)]
pub struct Footprint {
    pub low: DVec2,
    pub high: DVec2,
}

impl Footprint {
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Footprint {
        let start = Footprint { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };
        points
            .into_iter()
            .fold(start, |f, p| Footprint { low: f.low.min(p.truncate()), high: f.high.max(p.truncate()) })
    }

    pub fn meets(&self, other: &Footprint) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    pub fn wider(&self, by: f64) -> Footprint {
        Footprint { low: self.low - by, high: self.high + by }
    }
}

/// Columns from the chosen facets to the level, begun a little inside the matter so that they meet it in volume.
pub fn columns(part: (&Mesh, &Bvh), way: Way, chosen: impl Fn(usize) -> bool) -> Solid {
    let mesh = part.0;
    let mut inner: BTreeMap<u32, DVec3> = BTreeMap::new();
    let mut bodies = Vec::new();
    for t in (0..mesh.triangles.len()).filter(|&t| way.leads(mesh.corners(t)) && chosen(t)) {
        let ring = mesh.triangles[t].map(|v| {
            *inner.entry(v).or_insert_with(|| {
                let at = mesh.vertices[v as usize];
                at + DVec3::Z * into(part, at, -way.sign)
            })
        });
        bodies.extend(column(ring, way));
    }
    Solid::all(bodies)
}

/// `None` where a facet is so steep that the kernel sees no volume under it.
fn column(ring: [DVec3; 3], way: Way) -> Option<Solid> {
    let end = ring.map(|v| v.with_z(way.level));
    let body = if way.sign > 0.0 {
        prism(ring.to_vec(), end.to_vec())
    } else {
        let turned = |c: [DVec3; 3]| vec![c[0], c[2], c[1]];
        prism(turned(end), turned(ring))
    };
    if area(ring.map(|v| flat(v).extend(0.0))) > 0.0 { Solid::of(&body).ok() } else { None }
}

/// Everything that a solid sweeps over, and itself.
pub fn swept(part: &Solid, mesh: (&Mesh, &Bvh), way: Way) -> Solid {
    part.with(&columns(mesh, way, |_| true))
}

/// Sides of the polygon that stands for a cone's circle; it is drawn around the circle, so that no draft is lost. It
/// stands out by 2 % of the widening.
const CONE_SIDES: u32 = 16;

/// A wedge that widens by less than this is left out, mm: no detail of a mold is as small.
const LEAST_WEDGE: f64 = 0.002;

/// What widens around a sweep: for each border edge of the chosen facets the cone of half angle `atan(tan)` from it to
/// the level, and from there straight on to `beyond`.
pub fn wedges(mesh: &Mesh, way: Way, beyond: f64, tan: f64, chosen: impl Fn(usize) -> bool) -> Vec<Solid> {
    let set: Vec<[u32; 3]> = (0..mesh.triangles.len())
        .filter(|&t| way.leads(mesh.corners(t)) && chosen(t))
        .map(|t| mesh.triangles[t])
        .collect();
    let edges = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    let all: std::collections::BTreeSet<(u32, u32)> = set.iter().flat_map(edges).collect();
    let border = all.iter().filter(|(a, b)| !all.contains(&(*b, *a)));
    let ends = border.map(|&(a, b)| [a, b].map(|v| mesh.vertices[v as usize]));
    ends.filter_map(|e| wedge(e, way, beyond, tan)).collect()
}

fn wedge(edge: [DVec3; 2], way: Way, beyond: f64, tan: f64) -> Option<Solid> {
    let width = |p: DVec3| ((way.level - p.z) * way.sign).max(0.0) * tan;
    if edge.iter().all(|p| width(*p) < LEAST_WEDGE) {
        return None;
    }
    let around = |p: DVec3| {
        let r = width(p) / (std::f64::consts::PI / f64::from(CONE_SIDES)).cos();
        (0..CONE_SIDES).flat_map(move |k| {
            let turn = std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(CONE_SIDES);
            let at = p.truncate() + DVec2::from_angle(turn) * r;
            [at.extend(way.level), at.extend(beyond)]
        })
    };
    // An end that is past the level already takes no part in the widening.
    let tips = edge.into_iter().filter(|p| (way.level - p.z) * way.sign > 0.0);
    let points: Vec<DVec3> = tips.chain(edge.into_iter().flat_map(around)).collect();
    let hull = Solid::hull(&points);
    (!hull.is_empty()).then_some(hull)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::cuboid;

    #[test]
    fn a_box_swept_up_is_a_taller_box() {
        let m = cuboid(DVec3::ZERO, DVec3::new(2.0, 3.0, 1.0));
        let all = swept(&Solid::of(&m).unwrap(), (&m, &Bvh::new(&m)), Way::up(5.0));
        assert!((all.volume() - 30.0).abs() < 1e-9, "{}", all.volume());
    }

    #[test]
    fn a_wedge_has_the_draft_on_its_flat_sides_at_least() {
        let m = cuboid(DVec3::ZERO, DVec3::new(2.0, 3.0, 1.0));
        let around = Solid::all(wedges(&m, Way::up(11.0), 11.0, 0.1, |_| true));
        let (lo, hi) = around.mesh().bounds();
        // 10 mm at 1 in 10 widen by 1 mm, and by what the polygon stands out at its corners.
        assert!(lo.x <= -1.0 && lo.x > -1.03 && hi.y >= 4.0 && hi.y < 4.03, "{lo} {hi}");
    }
}
