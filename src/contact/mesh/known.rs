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

/// How the facets of an assembly lie.
pub(super) struct Normals {
    /// For each part those of its facets.
    pub of: Vec<Vec<Direction>>,
    /// The largest angle (radians) by which one was turned.
    pub turned: f64,
    /// For each part by how much a corner may be off, in model units.
    pub off: Vec<f64>,
}

/// The normals of all facets in place.
pub(super) fn normals(assembly: &Assembly, accuracy: &[Accuracy], tolerance: f64) -> Normals {
    let faces: Vec<Faces> = assembly.solids.iter().map(Faces::of).collect();
    let (mut all, mut apart, mut first, mut of_all) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut offs = Vec::new();
    for p in assembly.ids() {
        let own = &faces[assembly.part(p).solid];
        let turn = accuracy.get(p.at()).map_or(0.0, |a| a.turn);
        let off = own.corner_error(accuracy, p, tolerance);
        offs.push(off);
        let start = all.len();
        first.push(start);
        of_all.extend((0..own.normals.len()).map(|k| (p, k)));
        all.extend((0..own.normals.len()).map(|k| own.direction(k, assembly, p, [off, turn])));
        apart.extend(own.beside.iter().map(|b| b.iter().map(|k| k + start).collect::<Vec<_>>()));
    }
    let fits = |k: usize, d: Direction| {
        let (p, face) = of_all[k];
        let own = &faces[assembly.part(p).solid];
        let turn = accuracy.get(p.at()).map_or(0.0, |a| a.turn);
        own.fits(face, d, assembly, p, [own.corner_error(accuracy, p, tolerance), turn])
    };
    let one = alike(&all, |k| &apart[k], fits);
    let of =
        |p: PartIx| faces[assembly.part(p).solid].of_facet.iter().map(|k| one[first[p.at()] + k]).collect();
    let turned = one.iter().zip(&all).map(|(d, e)| d.n.angle_between(e.n)).fold(0.0, f64::max);
    Normals { of: assembly.ids().map(of).collect(), turned, off: offs }
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
    /// Whether there are faces of four corners or more and all of them are plane to round-off.
    exact: bool,
    /// Of the coordinates, in model units.
    round_off: f64,
}

impl Faces {
    fn of(solid: &Solid) -> Faces {
        let across = neighbors(solid);
        let of_facet = grown(solid, &across);
        let count = of_facet.iter().max().map_or(0, |m| m + 1);
        let (mut normals, mut corners) = (vec![DVec3::ZERO; count], vec![Vec::new(); count]);
        let (mut rim, mut area, mut beside) = (vec![0.0; count], vec![0.0; count], vec![Vec::new(); count]);
        for (k, &f) in of_facet.iter().enumerate() {
            normals[f] = solid.facets[k].normal;
            corners[f].extend(&solid.facets[k].corners);
            area[f] += facet_area(solid, k);
            for &(j, length) in across[k].iter().filter(|(j, _)| of_facet[*j] != f) {
                rim[f] += length;
                beside[f].push(of_facet[j]);
            }
        }
        corners.iter_mut().for_each(once);
        beside.iter_mut().for_each(once);
        let rim_per_area = rim.iter().zip(&area).map(|(r, a)| r / a).collect();
        let round_off =
            f64::EPSILON * solid.vertices.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let exact = exact(solid, &normals, &corners, round_off);
        Faces { of_facet, normals, corners, rim_per_area, beside, exact, round_off }
    }

    /// The face's normal in place. Its area vector is half the sum of p x (next - before) / 2 over the rim, so
    /// corners off by `off` turn it by that times rim over area at most.
    fn direction(&self, face: usize, asm: &Assembly, p: PartIx, [off, turn]: [f64; 2]) -> Direction {
        let n = asm.part(p).pose.transform_vector3(self.normals[face]).normalize();
        Direction { n, known: off * self.rim_per_area[face] + turn + ROUND_OFF }
    }

    /// Whether the face's corners lie in a plane with that normal as well as both are known. A long thin face may turn
    /// about its length only.
    fn fits(&self, face: usize, d: Direction, asm: &Assembly, p: PartIx, [off, turn]: [f64; 2]) -> bool {
        let (solid, pose) = (asm.solid(p), asm.part(p).pose);
        let corners = self.corners[face].iter().map(|&i| pose.transform_vector3(solid.vertices[i as usize]));
        let corners: Vec<DVec3> = corners.collect();
        let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
        let allowed = |r: DVec3| 2.0 * off + (d.known + turn + ROUND_OFF) * r.length();
        corners.iter().map(|c| *c - middle).all(|r| r.dot(d.n).abs() <= allowed(r))
    }

    /// How far a corner may be off. Digits that no face contradicts are taken at their word: rounded corners do not
    /// lie in one plane by fours. What is known worse than the tolerance is known to the tolerance: the user says
    /// that much counts.
    fn corner_error(&self, accuracy: &[Accuracy], p: PartIx, tolerance: f64) -> f64 {
        let written = accuracy.get(p.at()).map_or(0.0, |a| a.corner);
        let corner = if self.exact { written.min(self.round_off) } else { written };
        (3f64.sqrt() * corner).min(tolerance)
    }
}

fn once<T: Ord>(list: &mut Vec<T>) {
    list.sort_unstable();
    list.dedup();
}

/// For each facet its face: over edges to facets with the same normal, to the last bit.
fn grown(solid: &Solid, across: &[Vec<(usize, f64)>]) -> Vec<usize> {
    let bits = |k: usize| solid.facets[k].normal.to_array().map(f64::to_bits);
    let mut of_facet = vec![usize::MAX; solid.facets.len()];
    let mut faces = 0;
    for seed in 0..of_facet.len() {
        if of_facet[seed] != usize::MAX {
            continue;
        }
        let mut open = vec![seed];
        of_facet[seed] = faces;
        while let Some(k) = open.pop() {
            for &(j, _) in &across[k] {
                if of_facet[j] == usize::MAX && bits(j) == bits(k) {
                    of_facet[j] = faces;
                    open.push(j);
                }
            }
        }
        faces += 1;
    }
    of_facet
}

/// A plane through three corners misses the fourth by the round-off of either, and of a normal over the face's size.
fn exact(solid: &Solid, normals: &[DVec3], corners: &[Vec<u32>], round_off: f64) -> bool {
    let mut larger = normals.iter().zip(corners).filter(|(_, c)| c.len() > 3).peekable();
    let plane = |(n, c): (&DVec3, &Vec<u32>)| {
        let at = |i: &u32| solid.vertices[*i as usize];
        let off = c.iter().map(|i| (at(i) - at(&c[0])).dot(*n).abs()).fold(0.0, f64::max);
        let size = c.iter().map(|i| at(i).distance(at(&c[0]))).fold(0.0, f64::max);
        off <= 8.0 * round_off + ROUND_OFF * size
    };
    larger.peek().is_some() && larger.all(plane)
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
