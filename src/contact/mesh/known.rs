//! Takes parts and how well their files know their corners; gives each facet's normal in place and how well it is
//! known, with normals of the whole assembly made one that cannot be told apart.
//!
//! Promised: a face's own normal is off by no more than is said, if each corner is off by no more than its file's
//! resolution. Not promised: normals of facets that are known to be different faces of one part although they
//! cannot be told apart (neighbors) stay as they were read.

use super::direction::{Direction, alike};
use crate::assembly::{Assembly, PartIx};
use crate::solid::Solid;
use glam::DVec3;
use std::collections::BTreeMap;

/// How well a part in place is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Accuracy {
    /// By how much each coordinate of a corner may be off, in model units.
    pub corner: f64,
    /// By how much the part may be turned, in radians.
    pub turn: f64,
}

/// Round-off of a unit normal that is summed from a few cross products and turned by a pose.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// For each part the normals of its facets.
pub(super) fn normals(assembly: &Assembly, accuracy: &[Accuracy], tolerance: f64) -> Vec<Vec<Direction>> {
    let faces: Vec<Faces> = assembly.solids.iter().map(Faces::of).collect();
    let (mut all, mut apart, mut first, mut of_all) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for p in assembly.ids() {
        let own = &faces[assembly.part(p).solid];
        let turn = accuracy.get(p.at()).map_or(0.0, |a| a.turn);
        let off = corner_error(accuracy, p, tolerance);
        let start = all.len();
        first.push(start);
        of_all.extend((0..own.normals.len()).map(|k| (p, k)));
        all.extend((0..own.normals.len()).map(|k| own.direction(k, assembly, p, [off, turn])));
        apart.extend(own.beside.iter().map(|b| b.iter().map(|k| k + start).collect::<Vec<_>>()));
    }
    let fits = |k: usize, d: Direction| {
        let (p, face) = of_all[k];
        let own = &faces[assembly.part(p).solid];
        own.fits(face, d, assembly, p, corner_error(accuracy, p, tolerance))
    };
    let one = alike(&all, |k| &apart[k], fits);
    let of =
        |p: PartIx| faces[assembly.part(p).solid].of_facet.iter().map(|k| one[first[p.at()] + k]).collect();
    assembly.ids().map(of).collect()
}

/// The flat faces of a solid: facets with one normal that hang together.
struct Faces {
    of_facet: Vec<usize>,
    normals: Vec<DVec3>,
    /// Points at each face's corners, each once.
    corners: Vec<Vec<u32>>,
    /// Length of each face's rim over its area: how far its normal turns for each unit that its corners are off.
    rim_per_area: Vec<f64>,
    /// For each face those that share an edge with it.
    beside: Vec<Vec<usize>>,
}

impl Faces {
    fn of(solid: &Solid) -> Faces {
        let beside = neighbors(solid);
        let bits = |k: usize| solid.facets[k].normal.to_array().map(f64::to_bits);
        let count = solid.facets.len();
        let mut of_facet = vec![usize::MAX; count];
        let mut normals = Vec::new();
        for seed in 0..count {
            if of_facet[seed] != usize::MAX {
                continue;
            }
            let mut open = vec![seed];
            of_facet[seed] = normals.len();
            while let Some(k) = open.pop() {
                for &(j, _) in &beside[k] {
                    if of_facet[j] == usize::MAX && bits(j) == bits(k) {
                        of_facet[j] = normals.len();
                        open.push(j);
                    }
                }
            }
            normals.push(solid.facets[seed].normal);
        }
        let (mut rim, mut area) = (vec![0.0; normals.len()], vec![0.0; normals.len()]);
        let mut other = vec![Vec::new(); normals.len()];
        for k in 0..count {
            let f = of_facet[k];
            area[f] += facet_area(solid, k);
            for &(j, length) in beside[k].iter().filter(|(j, _)| of_facet[*j] != f) {
                rim[f] += length;
                other[f].push(of_facet[j]);
            }
        }
        other.iter_mut().for_each(|o| {
            o.sort_unstable();
            o.dedup();
        });
        let mut corners = vec![Vec::new(); normals.len()];
        (0..count).for_each(|k| corners[of_facet[k]].extend(&solid.facets[k].corners));
        corners.iter_mut().for_each(|c: &mut Vec<u32>| {
            c.sort_unstable();
            c.dedup();
        });
        let rim_per_area = rim.iter().zip(&area).map(|(r, a)| r / a).collect();
        Faces { of_facet, normals, corners, rim_per_area, beside: other }
    }

    /// The face's normal in place. Its area vector is half the sum of p x (next - before) / 2 over the rim, so
    /// corners off by `off` turn it by that times rim over area at most.
    fn direction(&self, face: usize, asm: &Assembly, p: PartIx, [off, turn]: [f64; 2]) -> Direction {
        let n = asm.part(p).pose.transform_vector3(self.normals[face]).normalize();
        Direction { n, known: off * self.rim_per_area[face] + turn + ROUND_OFF }
    }

    /// Whether the face's corners lie in a plane with that normal as well as both are known. A long thin face may turn
    /// about its length only.
    fn fits(&self, face: usize, d: Direction, asm: &Assembly, p: PartIx, off: f64) -> bool {
        let (solid, pose) = (asm.solid(p), asm.part(p).pose);
        let corners = self.corners[face].iter().map(|&i| pose.transform_vector3(solid.vertices[i as usize]));
        let corners: Vec<DVec3> = corners.collect();
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let allowed = |r: DVec3| 2.0 * off + (d.known + ROUND_OFF) * r.length();
        corners.iter().map(|c| *c - middle).all(|r| r.dot(d.n).abs() <= allowed(r))
    }
}

/// How far a corner may be off. What is known worse than the tolerance is known to the tolerance: the user says that
/// much counts.
fn corner_error(accuracy: &[Accuracy], p: PartIx, tolerance: f64) -> f64 {
    3f64.sqrt() * accuracy.get(p.at()).map_or(0.0, |a| a.corner).min(tolerance)
}

fn facet_area(solid: &Solid, k: usize) -> f64 {
    let c: Vec<DVec3> = solid.facets[k].corners.iter().map(|&i| solid.vertices[i as usize]).collect();
    c.windows(2).map(|w| (w[0] - c[0]).cross(w[1] - c[0])).sum::<DVec3>().length() / 2.0
}

/// For each facet those across its edges, with the edge's length.
fn neighbors(solid: &Solid) -> Vec<Vec<(usize, f64)>> {
    let edges = |k: usize| {
        let c = &solid.facets[k].corners;
        (0..c.len()).map(move |i| (c[i], c[(i + 1) % c.len()])).map(|(a, b)| (a.min(b), a.max(b)))
    };
    let mut at: BTreeMap<(u32, u32), Vec<usize>> = BTreeMap::new();
    for k in 0..solid.facets.len() {
        edges(k).for_each(|e| at.entry(e).or_default().push(k));
    }
    let length = |(a, b): (u32, u32)| solid.vertices[a as usize].distance(solid.vertices[b as usize]);
    let across = |k: usize| {
        let pairs = edges(k).flat_map(|e| at[&e].iter().map(move |&j| (j, e)));
        pairs.filter(|&(j, _)| j != k).map(|(j, e)| (j, length(e))).collect()
    };
    (0..solid.facets.len()).map(across).collect()
}
