//! Takes two meshes and the z direction; gives where one lies below the other with air between: what moving the lower
//! one up would hit.
//!
//! Exact up to round-off: every pair of a facet that leads and a facet that faces it is clipped in projection, and their
//! heights are compared on what they share. Where three layers stand above each other the area counts the pairs, so that
//! it is then an upper bound; it is 0 just where nothing is hit.

use crate::bvh::Bvh;
use crate::cross::pairs;
use crate::mesh::Mesh;
use glam::{DVec2, DVec3};

/// Projected overlap of two facets.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlap {
    pub lower: u32,
    pub upper: u32,
    /// Convex polygon in projection, counter-clockwise.
    pub outline: Vec<DVec2>,
    pub area: f64,
    /// Largest height of the air between, mm.
    pub gap: f64,
}

/// What blocks a straight way up.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Blocked {
    pub overlaps: Vec<Overlap>,
    /// Projected, mm2.
    pub area: f64,
    /// What round-off of the coordinates alone can make of it, mm2.
    pub round_off: f64,
    /// The widest strip that round-off can make, mm.
    pub strip: f64,
}

impl Blocked {
    /// Whether more is blocked than round-off explains: in all, or somewhere in width.
    pub fn is_real(&self) -> bool {
        self.area > self.round_off || (self.area > 0.0 && reach(self, self.strip) > self.strip)
    }
}

/// The side of a mesh that is seen from one end of z.
pub struct Side {
    flat: Mesh,
    tree: Bvh,
    /// The triangle of the mesh for each of `flat`.
    of: Vec<u32>,
    solid: Vec<[DVec3; 3]>,
}

impl Side {
    /// Facets whose normal has the sign of `z` along z.
    pub fn of(mesh: &Mesh, z: f64) -> Side {
        let rises = |c: [DVec3; 3]| (c[1] - c[0]).cross(c[2] - c[0]).z * z > 0.0;
        let of: Vec<u32> =
            (0..mesh.triangles.len()).filter(|&t| rises(mesh.corners(t))).map(|t| t as u32).collect();
        let flat = Mesh {
            vertices: mesh.vertices.iter().map(|v| v.with_z(0.0)).collect(),
            triangles: of.iter().map(|&t| mesh.triangles[t as usize]).collect(),
        };
        let solid = of.iter().map(|&t| mesh.corners(t as usize)).collect();
        Side { tree: Bvh::new(&flat), flat, of, solid }
    }

    /// Half of the facets' edges in projection, mm: what a strip of round-off can run along.
    fn edges(&self) -> f64 {
        let around = |c: &[DVec3; 3]| (0..3).map(|k| flat(c[k]).distance(flat(c[(k + 1) % 3]))).sum::<f64>();
        self.solid.iter().map(around).sum::<f64>() / 2.0
    }
}

/// Where moving `lower` up meets `upper`: pairs of a facet of `lower` that leads (seen from above) below one of `upper`
/// that faces it (seen from below). `snap`: how far each coordinate may be off, mm.
pub fn blocked(lower: &Side, upper: &Side, snap: f64) -> Blocked {
    let mut found = Vec::new();
    pairs((&lower.flat, &lower.tree), (&upper.flat, &upper.tree), &mut |s, t| {
        let (f, g) = (&lower.solid[s as usize], &upper.solid[t as usize]);
        if let Some((outline, area, gap)) = overlap(f, g, snap) {
            found.push(Overlap {
                lower: lower.of[s as usize],
                upper: upper.of[t as usize],
                outline,
                area,
                gap,
            });
        }
    });
    found.sort_by_key(|o| (o.lower, o.upper));
    let area = found.iter().map(|o| o.area).sum();
    let strip = STRIPS * LEVEL_IN_SNAPS * snap;
    Blocked { overlaps: found, area, round_off: STRIPS * snap * (lower.edges() + upper.edges()), strip }
}

/// A strip along an edge is at most this many snaps wide: each of its two borders moves by one.
const STRIPS: f64 = 2.0;

/// Heights that differ by less than this many snaps are the same: each of four coordinates may be off by one.
const LEVEL_IN_SNAPS: f64 = 4.0;

/// What round-off makes of the height between two facets, mm: a facet that leans and is off by one snap square to itself
/// is off by more along z. What is overlooked by it is never deeper than that, square to the facet.
fn level(f: &[DVec3; 3], g: &[DVec3; 3], snap: f64) -> f64 {
    let lean = |c: &[DVec3; 3]| 1.0 / (c[1] - c[0]).cross(c[2] - c[0]).normalize_or_zero().z.abs();
    LEVEL_IN_SNAPS / 2.0 * snap * (lean(f) + lean(g))
}

fn overlap(f: &[DVec3; 3], g: &[DVec3; 3], snap: f64) -> Option<(Vec<DVec2>, f64, f64)> {
    let top = |c: &[DVec3; 3]| c.iter().map(|p| p.z).fold(f64::MIN, f64::max);
    let foot = |c: &[DVec3; 3]| c.iter().map(|p| p.z).fold(f64::MAX, f64::min);
    if top(g) - foot(f) <= LEVEL_IN_SNAPS * snap {
        return None;
    }
    let outline = clip(counter_clockwise(f), counter_clockwise(g));
    let area = area(&outline);
    if area <= 0.0 {
        return None;
    }
    let gap = outline.iter().map(|&p| height(g, p) - height(f, p)).fold(f64::MIN, f64::max);
    (gap > level(f, g, snap)).then_some((outline, area, gap))
}

pub fn flat(p: DVec3) -> DVec2 {
    DVec2::new(p.x, p.y)
}

fn counter_clockwise(c: &[DVec3; 3]) -> Vec<DVec2> {
    let mut p = c.map(flat);
    if (p[1] - p[0]).perp_dot(p[2] - p[0]) < 0.0 {
        p.swap(1, 2);
    }
    p.to_vec()
}

/// The part of one convex polygon inside another, both counter-clockwise.
pub fn clip(mut subject: Vec<DVec2>, by: Vec<DVec2>) -> Vec<DVec2> {
    for k in 0..by.len() {
        if subject.is_empty() {
            break;
        }
        let (a, b) = (by[k], by[(k + 1) % by.len()]);
        let side = |p: DVec2| (b - a).perp_dot(p - a);
        let mut kept = Vec::with_capacity(subject.len() + 1);
        for i in 0..subject.len() {
            let (p, q) = (subject[i], subject[(i + 1) % subject.len()]);
            let (sp, sq) = (side(p), side(q));
            if sp >= 0.0 {
                kept.push(p);
            }
            if sp * sq < 0.0 {
                kept.push(p + (q - p) * (sp / (sp - sq)));
            }
        }
        subject = kept;
    }
    subject
}

/// Area of a polygon, counter-clockwise.
pub fn area(p: &[DVec2]) -> f64 {
    let Some(&o) = p.first() else { return 0.0 };
    p.windows(2).map(|w| (w[0] - o).perp_dot(w[1] - o)).sum::<f64>() / 2.0
}

/// Height of a facet's plane at a point, kept within the facet's own heights so that steep facets can not throw it off.
pub fn height(c: &[DVec3; 3], p: DVec2) -> f64 {
    let n = (c[1] - c[0]).cross(c[2] - c[0]);
    let (lo, hi) = c.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v.z), h.max(v.z)));
    let d = p - flat(c[0]);
    (c[0].z - (n.x * d.x + n.y * d.y) / n.z).clamp(lo, hi)
}

/// Widest local width of the blocked area in projection, mm, to within `step`: what would have to give way for the
/// lower body to pass. Found by narrowing the area until nothing is left.
pub fn reach(blocked: &Blocked, step: f64) -> f64 {
    let outlines = blocked.overlaps.iter().map(|o| o.outline.clone()).collect();
    crate::solid::width(outlines, step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::cuboid;

    fn up(m: &Mesh) -> Side {
        Side::of(m, 1.0)
    }

    fn down(m: &Mesh) -> Side {
        Side::of(m, -1.0)
    }

    #[test]
    fn a_box_under_another_is_blocked_by_what_they_share() {
        let low = cuboid(DVec3::ZERO, DVec3::ONE);
        let high = low.map(|v| v + DVec3::new(0.25, 0.5, 2.0));
        let b = blocked(&up(&low), &down(&high), 1e-9);
        assert!((b.area - 0.375).abs() < 1e-12, "{}", b.area);
        assert!(b.is_real() && !blocked(&up(&high), &down(&low), 1e-9).is_real());
        assert!((reach(&b, 1e-4) - 0.5).abs() < 1e-3, "{}", reach(&b, 1e-4));
    }

    #[test]
    fn boxes_that_touch_or_stand_beside_each_other_are_free() {
        let low = cuboid(DVec3::ZERO, DVec3::ONE);
        for by in [DVec3::Z, DVec3::new(1.0, 0.0, 3.0)] {
            let b = blocked(&up(&low), &down(&low.map(|v| v + by)), 1e-9);
            assert!(!b.is_real(), "{by}: {}", b.area);
        }
    }
}
