//! Takes a printed piece of a mold and the least wall of its printer; gives the widest fin that is thinner than that.
//!
//! Exact up to round-off where both sides of a fin are flat; fins that bend by more than a wall may (30 degrees) are
//! measured stretch by stretch. Slivers less wide than the least wall, as steps of a parting leave them, are no fin: they
//! only do not come out. Not promised: all fins of a piece that has very many; then the answer says that some were left.

use crate::bvh::Bvh;
use crate::mesh::Mesh;
use crate::mold::frame::upright;
use crate::mold::shadow::{clip, flat};
use crate::solid;
use crate::wall::{self, Thin};
use glam::{DMat3, DVec2, DVec3};
use serde::Serialize;

/// A fin or rib, in the mold's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fin {
    /// Where it is thinnest, and a point on each side there.
    #[serde(flatten)]
    pub thin: Thin,
    /// How wide it is thinner than the least wall, across its narrower way, mm.
    pub width_mm: f64,
}

/// What was found on a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fins {
    /// The widest of those looked at, if one is at least as wide as the least wall.
    pub widest: Option<Fin>,
    pub looked: Looked,
}

impl Fins {
    /// Of what has none, or is not printed.
    pub const NONE: Fins = Fins { widest: None, looked: Looked::All };
}

/// How much of a piece was looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Looked {
    All,
    Some,
}

/// Pairs of triangles with a thin place between them that are laid out: at some microseconds each as long as a mold takes.
const MOST_PAIRS: usize = 200_000;

/// Widths are found to this share of the least wall.
const STEP: f64 = 0.1;

/// One side that fins lie against: the way it looks, and what lies thin behind it. Sides look more than `wall::PARALLEL` apart,
/// so there are at most 58: as many caps of half that angle as the sphere has area for.
struct Side {
    turn: DMat3,
    normal: DVec3,
    outlines: Vec<Vec<DVec2>>,
    thinnest: Thin,
}

/// Fins thinner than `least` mm.
pub fn fins(mesh: &Mesh, tree: &Bvh, least: f64) -> Fins {
    let mut pairs = Vec::new();
    wall::opposed(mesh, tree, least, |pair, thin| {
        pairs.push((pair, thin));
        if pairs.len() < MOST_PAIRS { least } else { 0.0 }
    });
    let looked = if pairs.len() < MOST_PAIRS { Looked::All } else { Looked::Some };
    let mut sides: Vec<Side> = Vec::new();
    for ((s, t), thin) in pairs {
        lay(mesh, (s, t), thin, least, &mut sides);
    }
    let fins =
        sides.into_iter().map(|s| Fin { thin: s.thinnest, width_mm: solid::width(s.outlines, STEP * least) });
    let widest = fins.filter(|f| f.width_mm >= least).max_by(|a, b| a.width_mm.total_cmp(&b.width_mm));
    Fins { widest, looked }
}

/// Puts what two triangles have thin between them to the side that the first of them lies on.
fn lay(mesh: &Mesh, (s, t): (u32, u32), thin: Thin, least: f64, sides: &mut Vec<Side>) {
    let (front, rear) = (mesh.corners(s as usize), mesh.corners(t as usize));
    let normal = (front[1] - front[0]).cross(front[2] - front[0]).normalize_or_zero();
    let known = sides.iter().position(|k| k.normal.dot(normal) > wall::PARALLEL.to_radians().cos());
    let k = known.unwrap_or_else(|| {
        sides.push(Side { turn: upright(normal), normal, outlines: vec![], thinnest: thin });
        sides.len() - 1
    });
    let side = &mut sides[k];
    let outline = between(front.map(|v| side.turn * v), rear.map(|v| side.turn * v), least);
    if outline.len() > 2 {
        side.outlines.push(outline);
        if thin.thickness_mm < side.thinnest.thickness_mm {
            side.thinnest = thin;
        }
    }
}

/// Where the two triangles lie over one another, nearer than `least` along z, seen along it.
fn between(front: [DVec3; 3], rear: [DVec3; 3], least: f64) -> Vec<DVec2> {
    let ring = |c: [DVec3; 3]| {
        let mut p = c.map(flat);
        if (p[1] - p[0]).perp_dot(p[2] - p[0]) < 0.0 {
            p.swap(1, 2);
        }
        p.to_vec()
    };
    let shared = clip(ring(front), ring(rear));
    let depth = |p: DVec2| height(front, p) - height(rear, p);
    let mut kept = Vec::with_capacity(shared.len() + 1);
    for k in 0..shared.len() {
        let (p, q) = (shared[k], shared[(k + 1) % shared.len()]);
        let (over, next) = (depth(p) - least, depth(q) - least);
        if over <= 0.0 {
            kept.push(p);
        }
        if over * next < 0.0 {
            kept.push(p.lerp(q, over / (over - next)));
        }
    }
    kept
}

/// Of a triangle's plane above a point.
fn height([a, b, c]: [DVec3; 3], p: DVec2) -> f64 {
    let n = (b - a).cross(c - a);
    let d = p - flat(a);
    a.z - (n.x * d.x + n.y * d.y) / n.z
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::{Solid, cuboid};

    fn on_a_block(fin: DVec3) -> Option<Fin> {
        let block = Solid::of(&cuboid(DVec3::ZERO, DVec3::new(20.0, 20.0, 5.0))).unwrap();
        let low = DVec3::new(9.0, 2.0, 4.0);
        let mesh = block.with(&Solid::of(&cuboid(low, low + fin)).unwrap()).mesh();
        let found = fins(&mesh, &Bvh::new(&mesh), 0.8);
        assert_eq!(found.looked, Looked::All);
        found.widest
    }

    #[test]
    fn a_fin_of_a_tenth_is_told_with_its_width_and_one_of_a_millimetre_is_not() {
        let fin = on_a_block(DVec3::new(0.1, 15.0, 7.0)).unwrap();
        assert!((fin.thin.thickness_mm - 0.1).abs() < 1e-9 && (fin.width_mm - 6.0).abs() < 0.1, "{fin:?}");
        assert_eq!(on_a_block(DVec3::new(1.0, 15.0, 7.0)), None);
    }

    #[test]
    fn a_step_of_a_tenth_is_no_fin() {
        assert_eq!(on_a_block(DVec3::new(0.1, 15.0, 1.1)), None);
        assert_eq!(on_a_block(DVec3::new(0.1, 15.0, 1.5)), None);
    }
}
