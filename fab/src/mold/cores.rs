//! Takes a part that no one pull frees, in its mold frame, and its block; gives the side cores that form what the two
//! halves can not reach, in the order in which they leave, and the part with those places filled, which the halves form.
//!
//! A core leaves freely by construction: it is the undercut air that is seen from one direction, swept out along it and
//! widened by draft, less whatever the part shadows; that set is closed under moving outward. Directions are chosen
//! greedily among those of the pull search by sampled points, so the number of cores is not promised to be least.

use crate::bvh::Bvh;
use crate::mesh::{Mesh, area};
use crate::mold::frame::upright;
use crate::mold::sweep::{self, Footprint, Way};
use crate::mold::{prepare::Ready, pull, ray};
use crate::solid::{NotSolid, Solid};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// A side core.
pub struct Core {
    pub solid: Solid,
    /// The core and what its widening takes of the part's own room: the halves leave it free.
    pub room: Solid,
    /// The way it leaves, unit.
    pub pull: DVec3,
}

/// What side cores make of a part.
pub struct Cored {
    /// The part with its undercuts filled: what the halves form.
    pub filled: Solid,
    /// In the order in which they leave.
    pub cores: Vec<Core>,
    /// Undercut that no core reaches, mm3: it would be cast full.
    pub left_mm3: f64,
}

/// A core stands out of the block by this much, mm, so that it can be gripped.
pub const GRIP: f64 = 10.0;

/// Directions that are tried one after another; a mold of more loose pieces is nobody's wish.
const MOST_DIRECTIONS: usize = 6;

/// Air smaller than this share of the part's volume is no undercut to be formed: half of what the cavity may be off.
pub const NOTHING: f64 = crate::mold::checks::CAVITY_SHARE / 2.0;

/// Detail of undercut air below this is round-off of the sweeps, mm: a tenth of the finest layer.
pub const FINE: f64 = 0.002;

/// The part with all air filled that has the part both above and below it.
pub fn filled(ready: &Ready) -> Solid {
    let mesh = &ready.framed.mesh;
    let tree = Bvh::new(mesh);
    let (lo, hi) = mesh.bounds();
    let up = sweep::swept(&ready.solid, (mesh, &tree), Way::up(hi.z + 1.0));
    let down = sweep::swept(&ready.solid, (mesh, &tree), Way::down(lo.z - 1.0));
    up.common(&down)
}

/// `tan`: of the draft of cores. `block`: corners of the mold's block.
pub fn cores(
    ready: &Ready,
    filled: Solid,
    block: (DVec3, DVec3),
    tan: f64,
) -> Result<Option<Cored>, NotSolid> {
    let part = &ready.framed.mesh;
    let enough = NOTHING * ready.solid.volume();
    let mut left = filled.minus(&ready.solid).thick(FINE);
    let mut cores: Vec<Core> = Vec::new();
    let tree = Bvh::new(part);
    let ways = directions(part);
    for _ in 0..MOST_DIRECTIONS {
        if left.volume() <= enough {
            break;
        }
        let Some(d) = best((part, &tree), &ways, &left.mesh()) else { break };
        let Some(room) = room(part, &left, d, (block, tan))? else { break };
        let room = cores.iter().fold(room, |c, earlier| c.minus(&earlier.room));
        let before = left.volume();
        left = left.minus(&room).thick(FINE);
        if before - left.volume() <= enough {
            break;
        }
        let one = |room: Solid| Core { solid: room.minus(&ready.solid).thick(FINE), room, pull: d };
        let bodies = room.bodies().into_iter().filter(|b| b.volume() > enough);
        cores.extend(bodies.map(one));
    }
    let left_mm3 = left.volume().max(0.0);
    Ok((left_mm3 <= enough && !cores.is_empty()).then_some(Cored { filled, cores, left_mm3 }))
}

/// Both ends of every direction of the pull search.
fn directions(part: &Mesh) -> Vec<DVec3> {
    pull::candidates(part).into_iter().flat_map(|d| [d, -d]).collect()
}

/// Points on the walls of the undercut air, just inside it.
const SAMPLES: usize = 256;

/// How far inside, as a share of the part's size: so that a ray along a wall does not meet it.
const INSIDE: f64 = 1e-4;

/// Two directions that free the same number of points to one in this many count as equal; then the one along an axis
/// wins, then the level one, then the one with the shorter way out.
const LEVELS: usize = 64;

fn best(part: (&Mesh, &Bvh), ways: &[DVec3], left: &Mesh) -> Option<DVec3> {
    let (lo, hi) = part.0.bounds();
    let inside = (hi - lo).length() * INSIDE;
    let points: Vec<DVec3> =
        pull::spread_over(left, SAMPLES).into_iter().map(|(p, n)| p - n * inside).collect();
    let far = |d: DVec3| part.0.vertices.iter().map(|v| v.dot(d)).fold(f64::MIN, f64::max);
    let rated = |d: &DVec3| {
        let seen: Vec<&DVec3> = points.iter().filter(|p| !ray::any(part, **p, *d, 0.0)).collect();
        let way: f64 = seen.iter().map(|p| far(*d) - p.dot(*d)).sum::<f64>() / seen.len().max(1) as f64;
        let level = (seen.len() * LEVELS).div_ceil(points.len().max(1));
        let plain = (d.abs().max_element() == 1.0, d.z == 0.0);
        (level, plain, way, *d)
    };
    let all: Vec<_> = ways.par_iter().map(rated).filter(|r| r.0 > 0).collect();
    let better = |a: &(usize, (bool, bool), f64, DVec3), b: &(usize, (bool, bool), f64, DVec3)| {
        a.0.cmp(&b.0).then(a.1.cmp(&b.1)).then(b.2.total_cmp(&a.2))
    };
    all.into_iter().max_by(better).map(|r| r.3)
}

/// The room of a core along one direction; `None` where nothing is seen from there.
fn room(
    part: &Mesh,
    left: &Solid,
    d: DVec3,
    (block, tan): ((DVec3, DVec3), f64),
) -> Result<Option<Solid>, NotSolid> {
    let turn = upright(d);
    let turned = |m: &Mesh| m.map(|v| turn * v);
    let (part, air) = (turned(part), turned(&left.mesh()));
    let lid = reach(turn, block) + GRIP;
    let (lo, hi) = air.bounds();
    let own = Footprint::of([lo, hi]).wider((lid - lo.z) * tan * 2.0);
    let tree = Bvh::new(&part);
    let near = |t: usize| {
        let c = part.corners(t);
        Footprint::of(c).meets(&own) && c.iter().any(|v| v.z > lo.z)
    };
    let shade = sweep::columns((&part, &tree), Way::down(lo.z - 1.0), near);
    let seen = Solid::of(&air)?.minus(&shade).thick(FINE);
    if seen.is_empty() {
        return Ok(None);
    }
    let mesh = seen.mesh();
    let out = Way::up(lid);
    let straight = sweep::swept(&seen, (&mesh, &Bvh::new(&mesh)), out);
    let wide = Solid::all(sweep::wedges(&mesh, out, lid, tan, |_| true));
    let whole = straight.with(&wide).minus(&shade).thick(FINE);
    (!whole.is_empty()).then_some(whole).map(|w| back(&w, turn)).transpose()
}

fn back(solid: &Solid, turn: DMat3) -> Result<Solid, NotSolid> {
    Solid::of(&solid.mesh().map(|v| turn.transpose() * v))
}

/// How far the block goes along the turned z.
fn reach(turn: DMat3, (lo, hi): (DVec3, DVec3)) -> f64 {
    let z = turn.row(2);
    (0..3).map(|k| (z[k] * lo[k]).max(z[k] * hi[k])).sum()
}

/// Which core (of their meshes) forms a facet that the halves do not reach: the one whose wall it lies on.
pub fn forming(cores: &[Mesh], part: &Mesh, t: usize) -> Option<usize> {
    let c = part.corners(t);
    let out = (c[1] - c[0]).cross(c[2] - c[0]).normalize_or_zero();
    let at = c.iter().sum::<DVec3>() / 3.0 + out * (INSIDE * area(c).sqrt()).max(FINE);
    cores.iter().position(|k| crate::cross::encloses(k, at))
}
