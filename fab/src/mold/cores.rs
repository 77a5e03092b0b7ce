//! Takes a part that no one pull frees, in its mold frame, and its block; gives the side cores that form what the two
//! halves can not reach, in the order in which they leave, and the part with those places filled, which the halves form.
//!
//! A core leaves freely by construction: it is a shaft around the undercut air that is seen from one direction, widened
//! outward by draft, less the part and whatever lies in the part's shadow; that set is closed under moving outward.
//! Directions are chosen greedily among those of the pull search by sampled points, so the number of cores is not promised
//! to be least.

use crate::bvh::Bvh;
use crate::files::stl;
use crate::mesh::{Mesh, area};
use crate::mold::curtain::{Seen, To};
use crate::mold::frame::{hull, upright};
use crate::mold::parting::Look;
use crate::mold::shadow::flat;
use crate::mold::{prepare::Ready, pull, ray};
use crate::solid::{NotSolid, Solid};
use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;

/// A side core.
pub struct Core {
    pub solid: Solid,
    /// The core and what its shaft takes of the part's own room: the halves leave it free.
    pub room: Solid,
    /// What its shaft takes before it is divided into pieces: less the part, the core or several.
    pub shaft: Solid,
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

/// The part with all air filled that has the part both above and below it: what is above its undersides and below its
/// upper sides.
pub fn filled(ready: &Ready) -> Result<Solid, NotSolid> {
    let mesh = &ready.framed.mesh;
    let (lo, hi) = mesh.bounds();
    let seen = Seen::along(mesh, DVec3::Z, ready.framed.snap);
    let all = |way: Look, to: To| seen.hung_on(&seen.looking(way, |_| true), to).map(Solid::all);
    let up = all(Look::Down, To::Along(hi.z + BEYOND))?;
    let down = all(Look::Up, To::Against(lo.z - BEYOND))?;
    Ok(up.common(&down))
}

/// Shafts and curtains end this far from what they must pass, mm, so that no face of theirs lies in one of the part.
const BEYOND: f64 = 1.0;

/// What becomes of undercut air that only round-off leaves beside a core.
#[derive(Clone, Copy, PartialEq)]
pub enum Skins {
    Kept,
    /// Cores count as a little wider than they are: skins along their walls are nobody's.
    Passed,
}

/// `tan`: of the draft of cores. `block`: corners of the mold's block. A core may stand behind another's place, and
/// leave through it: then it has no grip outside.
pub fn cores(
    ready: &Ready,
    filled: &Solid,
    block: (DVec3, DVec3),
    (tan, skins): (f64, Skins),
) -> Result<Option<Cored>, NotSolid> {
    let part = &ready.framed.mesh;
    let enough = NOTHING * ready.solid.volume();
    let mut left = filled.minus(&ready.solid).thick(FINE);
    let mut cores: Vec<Core> = Vec::new();
    let (tree, ways) = (Bvh::new(part), directions(part));
    for _ in 0..MOST_DIRECTIONS {
        if left.volume() <= enough {
            break;
        }
        let Some(d) = best((part, &tree), &ways, &left.mesh()) else { break };
        let view = View { ready, d, turn: upright(d), lid: reach(d, block) + GRIP, tan };
        let room = Solid::all(rooms(&view, &left, enough)?);
        let room = cores.iter().fold(room, |c, earlier| c.minus(&earlier.room));
        let found = apart(&room, &view, enough);
        let before = left.volume();
        let passed = |room: &Solid| match skins {
            Skins::Kept => room.clone(),
            Skins::Passed => widened(room, view.turn, &AROUND),
        };
        left = found.iter().fold(left, |l, core| l.minus(&passed(&core.room))).thick(FINE);
        if before - left.volume() <= enough {
            break;
        }
        cores.extend(found);
    }
    let left_mm3 = left.volume().max(0.0);
    Ok((left_mm3 <= enough && !cores.is_empty()).then(|| Cored { filled: filled.clone(), cores, left_mm3 }))
}

/// A room's cores, each in one body; one that stands before another leaves first.
fn apart(room: &Solid, view: &View, enough: f64) -> Vec<Core> {
    let matter = |b: &Solid| b.mesh().volume() > enough;
    let mut all = Vec::new();
    for room in room.bodies().into_iter().filter(matter) {
        let room = stl::uncrossed(&room).unwrap_or(room);
        let whole = room.minus(&view.ready.solid).thick(FINE);
        let mut solids: Vec<Solid> = whole.bodies().into_iter().filter(matter).collect();
        let core = |solid: Solid, own: Solid| Core { solid, room: own, shaft: room.clone(), pull: view.d };
        match solids.len() {
            1 => all.extend(solids.pop().map(|solid| core(solid, room.clone()))),
            _ => all.extend(solids.into_iter().map(|solid| core(solid.clone(), solid))),
        }
    }
    let foot = |c: &Core| low(&c.solid.mesh(), view.d);
    let mut footed: Vec<(f64, Core)> = all.into_iter().map(|c| (foot(&c), c)).collect();
    footed.sort_by(|a, b| b.0.total_cmp(&a.0));
    footed.into_iter().map(|c| c.1).collect()
}

/// Where a mesh begins along a direction.
fn low(mesh: &Mesh, d: DVec3) -> f64 {
    mesh.vertices.iter().map(|v| v.dot(d)).fold(f64::INFINITY, f64::min)
}

/// Both ends of every direction of the pull search. One that over the part strays from a plane of the frame by less than
/// `FINE` does so by round-off of the facets that it was taken from, and is put into that plane.
fn directions(part: &Mesh) -> Vec<DVec3> {
    let (lo, hi) = part.bounds();
    let level = FINE / (hi - lo).max_element();
    let put = |d: DVec3| DVec3::select(d.abs().cmplt(DVec3::splat(level)), DVec3::ZERO, d).normalize();
    pull::candidates(part).into_iter().map(put).flat_map(|d| [d, -d]).collect()
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

/// A part seen from where a core leaves.
struct View<'a> {
    ready: &'a Ready,
    d: DVec3,
    turn: DMat3,
    /// Where the core ends outside, along `d`.
    lid: f64,
    tan: f64,
}

/// The rooms of cores along one direction: shafts around the air that is seen, less what the part shadows.
fn rooms(view: &View, left: &Solid, enough: f64) -> Result<Vec<Solid>, NotSolid> {
    let (part, d) = (&view.ready.framed.mesh, view.d);
    let seen = Seen::along(part, d, view.ready.framed.snap);
    let low = low(&left.mesh(), d) - 2.0 * BEYOND;
    let above = |t: usize| part.corners(t).iter().any(|c| c.dot(d) > low);
    let shade = Solid::all(seen.rooted(&seen.looking(Look::Down, above), To::Against(low - BEYOND))?);
    let air = left.minus(&shade).thick(FINE);
    // Skins, which two walls leave between them, and which may hang on to more than that, need no shaft.
    let bodies =
        air.narrowed(FINE / 2.0).bodies().into_iter().map(|b| b.mesh()).filter(|m| m.volume() > enough);
    let shafts: Vec<Solid> = bodies.filter_map(|m| shaft(view, &m)).collect();
    Ok(shafts.into_iter().map(|s| cleared(&s, &shade, view.turn)).collect())
}

/// A shaft less the shade. Shades that meet in a line pinch what is left there; moved a little they overlap.
fn cleared(shaft: &Solid, shade: &Solid, turn: DMat3) -> Solid {
    let plain = shaft.minus(shade).thick(FINE);
    if stl::uncrossed(&plain).is_some() {
        return plain;
    }
    let wide = [DVec3::X, DVec3::Y].map(|a| shaft.minus(&widened(shade, turn, &[a, -a])).thick(FINE));
    wide.into_iter().find(|s| stl::uncrossed(s).is_some()).unwrap_or(plain)
}

/// A solid with copies of it a little aside, in ways seen where `turn` sets its direction upright: walls along that direction
/// which only round-off holds apart are passed.
fn widened(solid: &Solid, turn: DMat3, ways: &[DVec3]) -> Solid {
    solid.with_copies(ways.iter().map(|&a| turn.transpose() * a * ASIDE))
}

/// Four ways square to z.
const AROUND: [DVec3; 4] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y];

/// By how much, mm: eighty steps of the grid of molds, a hundredth of the finest layer.
const ASIDE: f64 = 80.0 * stl::GRID;

/// From below a body of air out of the block: the hull of its outline, set off by `SEAT` and widened by draft.
fn shaft(view: &View, air: &Mesh) -> Option<Solid> {
    let points: Vec<DVec3> = air.vertices.iter().map(|&v| view.turn * v).collect();
    let foot = points.iter().map(|p| p.z).fold(f64::INFINITY, f64::min) - BEYOND;
    let outline = hull(points.into_iter().map(flat).collect());
    let wide = |level: f64| SEAT + (level - foot) * view.tan;
    let around =
        |level: f64| outline.iter().flat_map(move |&p| circle(p, wide(level)).map(move |q| q.extend(level)));
    let ends: Vec<DVec3> = around(foot).chain(around(view.lid)).map(|p| view.turn.transpose() * p).collect();
    let hull = Solid::hull(&ends);
    (!hull.is_empty()).then_some(hull)
}

/// A core stands over the rim of what it forms by this much, mm: two lines of a 0.4 mm nozzle, which seal it.
const SEAT: f64 = 0.8;

/// Sides of the polygon that stands for a circle around a corner; it is drawn around the circle, so that no draft is lost.
const SIDES: u32 = 16;

fn circle(middle: DVec2, radius: f64) -> impl Iterator<Item = DVec2> {
    let r = radius / (std::f64::consts::PI / f64::from(SIDES)).cos();
    (0..SIDES).map(move |k| {
        middle + DVec2::from_angle(std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(SIDES)) * r
    })
}

/// How far the block goes along a direction.
fn reach(d: DVec3, (lo, hi): (DVec3, DVec3)) -> f64 {
    (0..3).map(|k| (d[k] * lo[k]).max(d[k] * hi[k])).sum()
}

/// Which core (of their meshes) forms a facet that the halves do not reach: the one whose wall it lies on.
pub fn forming(cores: &[Mesh], part: &Mesh, t: usize) -> Option<usize> {
    let c = part.corners(t);
    let out = (c[1] - c[0]).cross(c[2] - c[0]).normalize_or_zero();
    let at = c.iter().sum::<DVec3>() / 3.0 + out * (INSIDE * area(c).sqrt()).max(FINE);
    cores.iter().position(|k| crate::cross::encloses(k, at))
}
