//! Takes directions that differ, finds those that lie in one plane as far as they are known, and puts them into it.
//!
//! Sound: after it they lie there to round-off, and none has turned by more than twice what it is known to; planes
//! that cannot all be had within that are given up, the smallest first. Not complete: above [`MOST`] directions
//! nothing is looked for.

use super::Direction;
use glam::DVec3;

/// The search takes the cube of the number of directions: a thousand million products of three numbers at most.
const MOST: usize = 1000;

/// An axis known worse than this (radians) gathers directions at random: of a hundred random ones ten lie as near.
const WORST_AXIS: f64 = 0.1;

/// Cosines below this are zero: round-off of unit vectors with room for a sum of three products.
const ROUND_OFF: f64 = 4.0 * f64::EPSILON;

/// Rounds of projection at most: each shortens what is left by the cosine of the angle between two planes, and a
/// thousand suffice down to a twentieth of a radian.
const ROUNDS: usize = 1000;

/// Three directions or more across one axis.
#[derive(Clone, Debug)]
struct Zone {
    axis: DVec3,
    members: Vec<usize>,
}

/// The directions, and how many planes they were put into.
pub(super) fn flattened(directions: &[Direction]) -> (Vec<Direction>, usize) {
    if directions.len() > MOST {
        return (directions.to_vec(), 0);
    }
    let mut zones = zones(directions);
    zones.sort_by_key(|z| std::cmp::Reverse(z.members.len()));
    loop {
        match projected(directions, &zones) {
            Ok(flat) => return (flat, zones.len()),
            Err(at) => drop(zones.remove(at)),
        }
    }
}

/// All maximal sets about the best known axes.
fn zones(directions: &[Direction]) -> Vec<Zone> {
    let count = directions.len();
    let mut seeds: Vec<(f64, usize, usize)> = Vec::new();
    for j in 0..count {
        for i in 0..j {
            let (a, b) = (directions[i], directions[j]);
            let error = (a.known + b.known) / a.n.cross(b.n).length();
            if error <= WORST_AXIS {
                seeds.push((error, i, j));
            }
        }
    }
    seeds.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    let mut seen = vec![false; count * count];
    let mut zones = Vec::new();
    for (error, i, j) in seeds {
        if seen[i * count + j] {
            continue;
        }
        let axis = directions[i].n.cross(directions[j].n).normalize();
        let across = |&k: &usize| directions[k].n.dot(axis).abs() <= directions[k].known + error + ROUND_OFF;
        let members: Vec<usize> = (0..count).filter(across).collect();
        for &a in &members {
            members.iter().for_each(|&b| seen[a * count + b] = true);
        }
        if members.len() > 2 {
            zones.push(Zone { axis, members });
        }
    }
    zones
}

/// All zones at once, by turns: each axis fitted to its members, each member projected across its axes. Where that
/// does not end within what is known, the place of a zone to give up.
fn projected(directions: &[Direction], zones: &[Zone]) -> Result<Vec<Direction>, usize> {
    let mut zones = zones.to_vec();
    let mut flat = directions.to_vec();
    let turned = |flat: &[Direction], k: usize| {
        flat[k].n.distance(directions[k].n) > 2.0 * directions[k].known + ROUND_OFF
    };
    for _ in 0..ROUNDS {
        zones.iter_mut().for_each(|z| z.axis = fitted(z, &flat));
        for zone in &zones {
            for &k in &zone.members {
                flat[k].n = flat[k].n.reject_from_normalized(zone.axis).normalize();
            }
        }
        let too_far = |z: &Zone| z.members.iter().any(|&k| turned(&flat, k));
        if zones.iter().all(|z| left(z, &flat) <= ROUND_OFF) || zones.iter().any(too_far) {
            break;
        }
    }
    let bad = |z: &Zone| left(z, &flat) > ROUND_OFF || z.members.iter().any(|&k| turned(&flat, k));
    match zones.iter().rposition(bad) {
        Some(at) => Err(at),
        None => Ok(flat),
    }
}

/// How far the members are from lying across the axis: the largest cosine.
fn left(zone: &Zone, flat: &[Direction]) -> f64 {
    zone.members.iter().map(|&k| flat[k].n.dot(zone.axis).abs()).fold(0.0, f64::max)
}

/// The axis turned a little, to the least sum of squared cosines, each weighed by how well its direction is known.
fn fitted(zone: &Zone, flat: &[Direction]) -> DVec3 {
    let (u, v) = zone.axis.any_orthonormal_pair();
    let (mut uu, mut uv, mut vv, mut ru, mut rv) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for &k in &zone.members {
        let Direction { n, known } = flat[k];
        let w = 1.0 / (known + f64::EPSILON).powi(2);
        let (x, y, r) = (n.dot(u), n.dot(v), n.dot(zone.axis));
        (uu, uv, vv) = (uu + w * x * x, uv + w * x * y, vv + w * y * y);
        (ru, rv) = (ru - w * x * r, rv - w * y * r);
    }
    let det = uu * vv - uv * uv;
    // The members span their plane, so the determinant is not zero beside the product.
    let step = if det > 0.0 {
        u * ((vv * ru - uv * rv) / det) + v * ((uu * rv - uv * ru) / det)
    } else {
        DVec3::ZERO
    };
    (zone.axis + step).normalize()
}
