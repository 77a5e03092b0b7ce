//! Takes a ready part that no two halves free; gives its rigid mold with side cores, or the finding that none was found.
//!
//! The pull of the search is tried, and a few others: the fewest cores win. Not promised: that a mold is found where there
//! is one; where none is, the silicone route is.

use crate::files::stl;
use crate::mesh::{Mesh, area};
use crate::mold::checks::{self, Halves, core_name};
use crate::mold::cores::{self, Core, Cored, Skins};
use crate::mold::frame::{Footprint, upright};
use crate::mold::layout::{self, Around};
use crate::mold::make::{blank, finding, keep, push};
use crate::mold::plan::Plan;
use crate::mold::prepare::{self, Ready};
use crate::mold::rigid::{self, Tools};
use crate::mold::rooms::Place;
use crate::mold::{Kind, Mold, MoldError, MoldSpec, parting, pictures, scad, two_part};
use crate::report::{Finding, Severity};
use crate::solid::Solid;
use glam::DVec3;

/// Fewer side cores, then a parting surface with less off its plane: less is better.
type Rank = (usize, f64);

/// A pull with its side cores, not yet made into pieces.
struct Candidate {
    ready: Ready,
    cored: Cored,
    plan: Plan,
    rank: Rank,
}

pub fn mold(part: &Mesh, ready: Ready, spec: &MoldSpec) -> Result<Mold, MoldError> {
    let mut refused = blank(&ready, spec, Plan::default(), spec.figures.draft.value);
    // Right, but other kernels refuse one of its pieces.
    let mut held: Option<Mold> = None;
    let mut why = vec![];
    for (all, skins) in attempts(part, spec, &ready)? {
        let mut found = vec![];
        for ready in all {
            match candidate(ready, spec, skins)? {
                Ok(candidate) => found.push(candidate),
                Err(w) => why.push(w),
            }
        }
        found.sort_by(|a, b| a.rank.0.cmp(&b.rank.0).then(a.rank.1.total_cmp(&b.rank.1)));
        for (candidate, formed) in found.iter().flat_map(|c| [(c, Formed::Part), (c, Formed::Filled)]) {
            match built(candidate, formed, spec)?.and_then(proven) {
                Ok(mold)
                    if scad::lacking(&mold).is_none() && !held.as_ref().is_some_and(|h| fewer(h, &mold)) =>
                {
                    return Ok(mold);
                }
                Ok(mold) => held = held.or(Some(mold)),
                Err(w) => why.push(w),
            }
        }
    }
    if let Some(mold) = held {
        return Ok(mold);
    }
    why.sort();
    why.dedup();
    refused.findings.push(refusal(&refused, &why.join("; ")));
    refused.extras.push(pictures::maps(&refused));
    Ok(refused)
}

/// Whether the first has fewer side cores.
fn fewer(a: &Mold, b: &Mold) -> bool {
    let cores = |m: &Mold| m.pieces.iter().filter(|p| p.kind == Kind::Core).count();
    cores(a) < cores(b)
}

/// Ways to try it, one after the other until one holds: walls that touch in a line, or lie in each other but for round-off,
/// may come out right one way and not another.
fn attempts(part: &Mesh, spec: &MoldSpec, ready: &Ready) -> Result<Vec<(Vec<Ready>, Skins)>, MoldError> {
    let [small, walls] =
        [Footprint::Smallest, Footprint::Walls].map(|f| prepare::with_others(part, spec, ready, f));
    let (small, walls) = (small?, walls?);
    let turned = |(w, s): &(&Ready, &Ready)| w.framed.turn != s.framed.turn;
    let other = walls.iter().zip(&small).filter(turned).map(|(w, _)| w.clone()).collect();
    Ok(vec![(small, Skins::Kept), (other, Skins::Kept), (walls, Skins::Passed)])
}

fn refusal(mold: &Mold, why: &str) -> Finding {
    let (area, wide) = (mold.pull.undercut_mm2, mold.pull.undercut_reach_mm);
    let what = format!(
        "{area:.3} mm2 are undercut in every direction looked at, here {wide:.2} mm wide; a rigid mold in two halves would not open, and none with side cores was found ({why})"
    );
    let at = two_part::worst_undercut(mold);
    finding(mold, Severity::Error, at, what, "take the silicone route, or divide the part")
}

/// The side cores of a pull, or why there are none.
fn candidate(
    mut ready: Ready,
    spec: &MoldSpec,
    skins: Skins,
) -> Result<Result<Candidate, String>, MoldError> {
    let f = &spec.figures;
    let filled = cores::filled(&ready)?;
    let (mesh, snap, around) = (filled.mesh(), ready.framed.snap, Around::printed(f));
    ready.plane = parting::plane(&mesh, &parting::looks(&mesh, snap), snap);
    let plan = layout::plan(&ready.framed.mesh, ready.plane.height, &ready.tops, f, around);
    let tan = f.draft.value.to_radians().tan();
    let Some(cored) = cores::cores(&ready, &filled, (plan.low, plan.high), (tan, skins))? else {
        return Ok(Err("some undercut is seen from no direction outside".into()));
    };
    let rooms: Vec<Solid> = cored.cores.iter().map(|c| c.room.clone()).collect();
    let (plan, shut) = layout::clear(&plan, &rooms, f, around)?;
    if shut > 0 {
        return Ok(Err("a side core would stand in the way of the sprue or a vent".into()));
    }
    if plan.keys.len() < KEYS || plan.bolts.len() < BOLTS {
        return Ok(Err("side cores leave no room for keys and screws".into()));
    }
    let rank = (cored.cores.len(), ready.plane.wrong);
    Ok(Ok(Candidate { ready, cored, plan, rank }))
}

/// A mold closes one way only by three keys, and stays closed by two screws.
const KEYS: usize = 3;
const BOLTS: usize = 2;

/// How far a core's room may go into the part, as a share of the least wall: two cores on both sides of a wall keep apart.
const MARGIN: f64 = 0.25;

/// What the halves form beside the cores.
#[derive(Clone, Copy)]
enum Formed {
    /// The part as it is.
    Part,
    /// The part with its undercuts filled, where bits of them that are too small for a core would hold a half.
    Filled,
}

/// The mold, if its pieces as they will be written keep what is measured on them.
fn proven(mold: Mold) -> Result<Mold, String> {
    let mesh = |name: &str| mold.pieces.iter().find(|p| p.name == name).map(|p| stl::snapped(&p.mesh));
    let (Some(lower), Some(upper)) = (mesh("lower"), mesh("upper")) else {
        return Err("it has not both halves".into());
    };
    let own = mold.pieces.iter().filter(|p| p.kind == Kind::Core);
    let own: Vec<(Mesh, DVec3)> = own.map(|p| (stl::snapped(&p.mesh), p.pull)).collect();
    let cores = own.iter().map(|(m, d)| (m, *d)).collect();
    let all = checks::rigid(&mold, &Halves { lower: &lower, upper: &upper, cores }).map_err(|e| e.0)?;
    let wrong: Vec<String> =
        all.iter().filter(|m| !m.kept).map(|m| format!("{} is {:.4} {}", m.of, m.value, m.unit)).collect();
    if wrong.is_empty() { Ok(mold) } else { Err(wrong.join(", ")) }
}

/// The mold of a candidate, or why it can not be made.
fn built(candidate: &Candidate, formed: Formed, spec: &MoldSpec) -> Result<Result<Mold, String>, MoldError> {
    let Candidate { ready, cored, plan, .. } = candidate;
    let mut mold = blank(ready, spec, plan.clone(), spec.figures.draft.value);
    mold.filled_mm3 = Some(cored.left_mm3);
    let below = two_part::below(&mold, &cored.filled, ready)?;
    let cavity = match formed {
        Formed::Part => &ready.solid,
        Formed::Filled => &cored.filled,
    };
    let tools = Tools::of(&mold.plan, &spec.figures)?;
    let least = (spec.figures.least_wall.value, cores::NOTHING * ready.solid.volume());
    let rooms = Solid::all(cored.cores.iter().map(|c| c.room.clone()).collect());
    for (name, half, pull) in rigid::halves(cavity, &below, &mold.plan, &tools)? {
        let half = half.minus(&rooms);
        if let Some(why) = hanging(&half, &cored.cores, least, &format!("the {name} half")) {
            return Ok(Err(why));
        }
        match whole(half, ready.solid.volume()) {
            Ok(half) => push(&mut mold, name, Kind::Half, &half, pull, 1),
            Err(off) => return Ok(Err(format!("side cores would cut {off:.3} mm3 off the {name} half"))),
        }
    }
    for (k, core) in cored.cores.iter().enumerate() {
        if let Some(why) = hanging(&core.solid, &cored.cores[..k], least, "a side core") {
            return Ok(Err(why));
        }
        push(&mut mold, &core_name(k), Kind::Core, &core.solid, core.pull, 1);
    }
    if let Some(wrong) = mold.findings.iter().find(|f| f.severity == Severity::Error) {
        return Ok(Err(wrong.what.clone()));
    }
    let place = Place::new(&ready.solid, spec.figures.least_wall.value * MARGIN);
    for (k, core) in cored.cores.iter().enumerate() {
        if let Some((room, settled)) = place.room(core) {
            keep(&mut mold, (&scad::room_name(&core_name(k)), Kind::Room), (&room, settled), DVec3::ZERO, 0);
        }
    }
    assign(&mut mold, &cored.cores);
    told(&mut mold, cored);
    let aside = two_part::aside(&mold, &cored.filled)?;
    two_part::finish(mold, &ready.solid, aside, &tools).map(Ok)
}

/// Why a piece is none that can be made, if where cores take half a wall more on all sides something comes off it: it
/// hangs by less than a wall.
fn hanging(piece: &Solid, cores: &[Core], (wall, enough): (f64, f64), name: &str) -> Option<String> {
    let shifts = |c: &Core| {
        let turn = upright(c.pull);
        let ways = [turn.row(0), turn.row(1), turn.row(2)].into_iter().flat_map(|a| [a, -a]);
        ways.map(|a| c.room.moved(a * wall / 2.0)).collect::<Vec<_>>()
    };
    let left = piece.minus(&Solid::all(cores.iter().flat_map(shifts).collect()));
    let mut bodies: Vec<f64> = left.bodies().iter().map(Solid::volume).collect();
    bodies.sort_by(f64::total_cmp);
    bodies.pop();
    let off: f64 = bodies.iter().sum();
    (off > enough).then(|| format!("{off:.3} mm3 of {name} would hang by less than a wall"))
}

/// A half in one body: crumbs within what the cavity may be off are left away; more than that, in mm3, is too much.
fn whole(half: Solid, part_mm3: f64) -> Result<Solid, f64> {
    let half = half.thick(cores::FINE);
    let mut bodies = half.bodies();
    bodies.sort_by(|a, b| b.volume().total_cmp(&a.volume()));
    let off = bodies.iter().skip(1).map(Solid::volume).sum::<f64>();
    match bodies.len() {
        0 | 1 => Ok(half),
        _ if off <= cores::NOTHING * part_mm3 => Ok(bodies.swap_remove(0)),
        _ => Err(off),
    }
}

/// Facets that a core forms get its name, and their draft along its pull.
fn assign(mold: &mut Mold, cores: &[Core]) {
    let meshes: Vec<Mesh> = cores.iter().map(|c| c.solid.mesh()).collect();
    let hidden: Vec<usize> =
        (0..mold.maps.half.len()).filter(|&t| mold.maps.undercut_mm2[t] > 0.0 || wall(mold, t)).collect();
    for t in hidden {
        if let Some(k) = cores::forming(&meshes, &mold.part, t) {
            let [a, b, c] = mold.part.corners(t);
            let along = (b - a).cross(c - a).normalize_or_zero().dot(cores[k].pull).abs();
            mold.maps.half[t] = core_name(k);
            mold.maps.draft_deg[t] = along.min(1.0).asin().to_degrees();
            mold.maps.undercut_mm2[t] = 0.0;
        }
    }
    let least = mold.figures.draft.value;
    let low = (0..mold.maps.draft_deg.len()).filter(|&t| mold.maps.draft_deg[t] < least);
    mold.maps.low_draft_mm2 = low.map(|t| area(mold.part.corners(t))).sum();
}

/// Walls along the main pull shadow nothing, and may yet be a core's.
fn wall(mold: &Mold, t: usize) -> bool {
    mold.maps.draft_deg[t] < mold.figures.draft.value
}

fn told(mold: &mut Mold, cored: &Cored) {
    let (area, n) = (mold.pull.undercut_mm2, cored.cores.len());
    let what = format!(
        "{area:.1} mm2 are undercut along the pull; {n} side core{} form{} them and leave{} first",
        if n == 1 { "" } else { "s" },
        if n == 1 { "s" } else { "" },
        if n == 1 { "s" } else { "" },
    );
    let found = finding(mold, Severity::Note, vec![], what, "follow the order of the mold sheet");
    mold.findings.push(found);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::cuboid;

    fn block(lo: [f64; 3], hi: [f64; 3]) -> Solid {
        Solid::of(&cuboid(lo.into(), hi.into())).unwrap()
    }

    /// Two blocks of 10 mm with a bridge of the given thickness between them, which a core passes underneath.
    fn bridged(thick: f64) -> (Solid, Core) {
        let whole = block([0.0, 0.0, 0.0], [30.0, 10.0, 10.0]);
        let room = block([10.0, -5.0, -5.0], [20.0, 15.0, 10.0 - thick]);
        let core = Core { solid: room.clone(), shaft: room.clone(), room: room.clone(), pull: DVec3::NEG_Y };
        (whole.minus(&room), core)
    }

    #[test]
    fn what_hangs_by_less_than_a_wall_is_told_and_what_hangs_by_one_is_not() {
        let says = |thick: f64| {
            let (piece, core) = bridged(thick);
            hanging(&piece, &[core], (0.8, 0.1), "the lower half")
        };
        let thin = says(0.3).unwrap();
        assert!(thin.contains("of the lower half would hang"), "{thin}");
        assert_eq!(says(1.0), None);
    }
}
