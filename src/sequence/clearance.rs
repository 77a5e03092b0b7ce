//! Takes an assembly with its contacts and a clearance, gives the assembly with every contact facet moved inward by it:
//! what a plan "at a clearance" is about. Poses, ids and held parts stay.
//!
//! Each facet is moved within its own convex cell. At a concave edge that turns by an angle a this takes up to
//! clearance * tan(a / 2) more than moving the facets of the whole solid would; nowhere less. The facets of the solids
//! given back are those of the cells, inner ones included: for planning and checking, not for making (see `fab`).

use crate::assembly::{Assembly, PartIx};
use crate::blocking::{ROUND_OFF_SHARE, SAME_ANGLE, Touch};
use crate::contact::Patch;
use crate::solid::{Cell, Facet, Solid};
use glam::DVec3;
use std::collections::BTreeMap;

/// No such assembly: the clearance is no length, or nothing is left of these parts.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoClearance {
    #[error("a clearance is a length of at least 0, not {0}")]
    NoLength(f64),
    #[error("nothing is left of {}", .0.join(", "))]
    NothingLeft(Vec<String>),
}

/// `clearance` per face, in model units. Parts with the same solid and the same contact facets share the new one too.
pub fn with_clearance(asm: &Assembly, patches: &[Patch], clearance: f64) -> Result<Assembly, NoClearance> {
    if !clearance.is_finite() || clearance < 0.0 {
        return Err(NoClearance::NoLength(clearance));
    }
    let mut out = Assembly { solids: Vec::new(), ..asm.clone() };
    let mut known = BTreeMap::new();
    for p in asm.ids() {
        let touching = contact_facets(asm, p, patches);
        let new = *known.entry((asm.part(p).solid, touching.clone())).or_insert_with(|| {
            out.solids.push(drawn_in(&asm.solid(p).cells, &touching, clearance));
            out.solids.len() - 1
        });
        out.parts[p.at()].solid = new;
    }
    let gone: Vec<String> =
        out.ids().filter(|&p| out.solid(p).cells.is_empty()).map(|p| out.part(p).id.clone()).collect();
    if gone.is_empty() { Ok(out) } else { Err(NoClearance::NothingLeft(gone)) }
}

/// For each cell and facet of a part, whether a patch lies on it.
fn contact_facets(asm: &Assembly, p: PartIx, patches: &[Patch]) -> Vec<Vec<bool>> {
    let touch = Touch::of(asm).depth();
    let back = asm.part(p).pose.inverse();
    let sides: Vec<(DVec3, DVec3)> = patches
        .iter()
        .filter(|q| q.a == p || q.b == p)
        .map(|q| {
            let middle = q.corners.iter().sum::<DVec3>() / q.corners.len().max(1) as f64;
            let outward = if q.a == p { q.normal } else { -q.normal };
            (back.transform_vector3(outward), back.transform_point3(middle))
        })
        .collect();
    let on = |c: &Cell, n: DVec3, d: f64| {
        let lies = |x: DVec3| n.dot(x) >= d - touch && c.planes.iter().all(|(m, e)| m.dot(x) <= e + touch);
        sides.iter().any(|&(outward, x)| outward.distance(n) <= SAME_ANGLE && lies(x))
    };
    asm.solid(p).cells.iter().map(|c| c.planes.iter().map(|&(n, d)| on(c, n, d)).collect()).collect()
}

fn drawn_in(cells: &[Cell], touching: &[Vec<bool>], by: f64) -> Solid {
    let cut = |(cell, touching): (&Cell, &Vec<bool>)| {
        let moved = cell.planes.iter().zip(touching).filter(|(_, t)| **t).map(|(p, _)| p);
        moved.fold(Some(cell.clone()), |left, &(n, d)| left.and_then(|c| below(&c, n, d - by)))
    };
    let mut solid = Solid::default();
    for cell in cells.iter().zip(touching).filter_map(cut) {
        let base = solid.vertices.len() as u32;
        solid.vertices.extend(&cell.vertices);
        let facets = cell.facets.iter().zip(&cell.planes);
        solid.facets.extend(
            facets.map(|(f, p)| Facet { corners: f.iter().map(|k| k + base).collect(), normal: p.0 }),
        );
        solid.cells.push(cell);
    }
    solid
}

/// The part of a convex cell with `n . x <= d`; None when nothing is left. New corners are shared by the edge that they
/// lie on.
fn below(cell: &Cell, n: DVec3, d: f64) -> Option<Cell> {
    let reach = cell.vertices.iter().map(|v| v.length()).fold(d.abs(), f64::max);
    let on_plane = |s: &f64| s.abs() <= reach * ROUND_OFF_SHARE;
    let side = cell.vertices.iter().map(|v| n.dot(*v) - d).map(|s| if on_plane(&s) { 0.0 } else { s });
    let side: Vec<f64> = side.collect();
    if side.iter().all(|&s| s <= 0.0) {
        return Some(cell.clone());
    }
    if side.iter().all(|&s| s >= 0.0) {
        return None;
    }
    let mut out = Cell::default();
    let mut corners: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for (facet, &plane) in cell.facets.iter().zip(&cell.planes) {
        let mut left = Vec::new();
        for (k, &a) in facet.iter().enumerate() {
            let b = facet[(k + 1) % facet.len()];
            let (sa, sb) = (side[a as usize], side[b as usize]);
            if sa <= 0.0 {
                left.push(corner(cell, &side, (a, a), &mut out, &mut corners));
            }
            if sa * sb < 0.0 {
                left.push(corner(cell, &side, (a.min(b), a.max(b)), &mut out, &mut corners));
            }
        }
        if left.len() > 2 {
            out.facets.push(left);
            out.planes.push(plane);
        }
    }
    let on = |e: &(u32, u32)| e.0 != e.1 || side[e.0 as usize] == 0.0;
    let cap = around(&out.vertices, n, corners.iter().filter(|(e, _)| on(e)).map(|(_, &k)| k).collect());
    out.facets.push(cap);
    out.planes.push((n, d));
    Some(out)
}

/// The new number of an old corner (both ends the same), or of the point where an edge meets the plane.
fn corner(
    cell: &Cell,
    side: &[f64],
    edge: (u32, u32),
    out: &mut Cell,
    known: &mut BTreeMap<(u32, u32), u32>,
) -> u32 {
    *known.entry(edge).or_insert_with(|| {
        let [a, b] = [edge.0, edge.1].map(|k| k as usize);
        let (p, q) = (cell.vertices[a], cell.vertices[b]);
        out.vertices.push(if a == b { p } else { p.lerp(q, side[a] / (side[a] - side[b])) });
        out.vertices.len() as u32 - 1
    })
}

/// Corners of a convex polygon in order, counter-clockwise seen from the tip of its normal.
fn around(vertices: &[DVec3], normal: DVec3, mut corners: Vec<u32>) -> Vec<u32> {
    let at = |k: u32| vertices[k as usize];
    let middle = corners.iter().map(|&k| at(k)).sum::<DVec3>() / corners.len().max(1) as f64;
    let (u, v) = normal.any_orthonormal_pair();
    let angle = |k: u32| (at(k) - middle).dot(v).atan2((at(k) - middle).dot(u));
    corners.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)));
    corners
}
