//! Takes rings that close, tells which hang together and that each shell faces outward; a void faces inward,
//! inside a body.
//!
//! Not promised: that shells keep clear of each other.

use super::close::{area_vector, edges};
use super::faults::{Found, Place, found};
use glam::DVec3;
use std::collections::BTreeMap;

struct Shell<'a> {
    rings: Vec<&'a [u32]>,
    volume: f64,
    area: f64,
}

/// Numbers of bodies and of voids. `width` times the area is the volume below which a shell has no inside.
pub(super) fn outward(
    rings: &[Vec<u32>],
    points: &[DVec3],
    width: f64,
) -> Result<(usize, usize), Vec<Found>> {
    let shells = shells(rings, points);
    let (mut bodies, mut voids, mut faults) = (0, 0, Vec::new());
    for (k, shell) in shells.iter().enumerate() {
        let ring = shell.rings[0];
        let place = Place::Edge(points[ring[0] as usize], points[ring[1] as usize]);
        let hint = "turn every face of the shell over; corners run counter-clockwise seen from outside";
        if shell.volume.abs() <= width * shell.area {
            faults.push(found(place, "the shell beside it encloses no volume", "give it a thickness"));
        } else if shell.volume > 0.0 {
            bodies += 1;
        } else if within_others(&shells, k, points[ring[0] as usize], points) {
            voids += 1;
        } else {
            faults.push(found(place, "inside out: the shell beside it faces inward", hint));
        }
    }
    if faults.is_empty() { Ok((bodies, voids)) } else { Err(faults) }
}

fn within_others(shells: &[Shell], own: usize, p: DVec3, points: &[DVec3]) -> bool {
    let others = shells.iter().enumerate().filter(|&(k, _)| k != own).flat_map(|(_, s)| s.rings.iter());
    let turns: f64 = others.map(|r| ring_angle(r, points, p)).sum::<f64>() / (4.0 * std::f64::consts::PI);
    // A winding number is whole away from the surface; half is the middle between outside and inside.
    turns > 0.5
}

/// Solid angle under which p sees the ring, as a fan from its first corner.
fn ring_angle(ring: &[u32], points: &[DVec3], p: DVec3) -> f64 {
    let at = |k: usize| points[ring[k] as usize] - p;
    (1..ring.len() - 1).map(|k| solid_angle(at(0), at(k), at(k + 1))).sum()
}

/// Signed solid angle of a triangle seen from the origin (van Oosterom and Strackee).
pub(crate) fn solid_angle(a: DVec3, b: DVec3, c: DVec3) -> f64 {
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let den = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).atan2(den)
}

fn shells<'a>(rings: &'a [Vec<u32>], points: &[DVec3]) -> Vec<Shell<'a>> {
    let root = components(rings);
    let mut by_root: BTreeMap<usize, Shell> = BTreeMap::new();
    for (k, ring) in rings.iter().enumerate() {
        let shell = by_root.entry(root[k]).or_insert_with(|| Shell { rings: vec![], volume: 0.0, area: 0.0 });
        // About a corner of the shell itself: far from the origin nothing cancels.
        let o = points[shell.rings.first().map_or(ring[0], |r| r[0]) as usize];
        let area = area_vector(ring, points);
        shell.rings.push(ring);
        shell.volume += (points[ring[0] as usize] - o).dot(area) / 6.0;
        shell.area += area.length() / 2.0;
    }
    by_root.into_values().collect()
}

/// For each ring the least-numbered ring that it hangs together with over edges.
pub(super) fn components(rings: &[Vec<u32>]) -> Vec<usize> {
    let mut root: Vec<usize> = (0..rings.len()).collect();
    let mut owner: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (k, ring) in rings.iter().enumerate() {
        for (a, b) in edges(ring) {
            let first = *owner.entry((a.min(b), a.max(b))).or_insert(k);
            let (x, y) = (find(&mut root, first), find(&mut root, k));
            root[x.max(y)] = x.min(y);
        }
    }
    (0..rings.len()).map(|k| find(&mut root, k)).collect()
}

fn find(root: &mut [usize], mut k: usize) -> usize {
    while root[k] != k {
        root[k] = root[root[k]];
        k = root[k];
    }
    k
}
