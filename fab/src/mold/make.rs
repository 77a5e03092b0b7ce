//! Takes a part and an order; gives the mold of the route that was asked for.

use crate::files::stl;
use crate::mesh::Mesh;
use crate::mold::checks::CAVITY_SHARE;
use crate::mold::fill;
use crate::mold::layout;
use crate::mold::maps::maps;
use crate::mold::parting::{self, Plane};
use crate::mold::picture::{self, Painted};
use crate::mold::plan::Plan;
use crate::mold::prepare::{Ready, ready, unfit};
use crate::mold::rigid;
use crate::mold::{Extra, Kind, Maps, Mold, MoldError, MoldSpec, Parting, Piece, Route, scad};
use crate::report::{Finding, Place, Severity};
use crate::solid::Solid;
use glam::DVec3;

/// Makes a mold of a part. Errors are of the input; what can not be molded as wanted is a finding of severity error, and
/// then there are no pieces.
pub fn make(part: &Mesh, spec: &MoldSpec) -> Result<Mold, MoldError> {
    if spec.count == 0 {
        return Err(unfit("a mold of no parts was asked for", "give a count of at least 1"));
    }
    let ready = ready(part, spec)?;
    match spec.route {
        Route::Rigid => rigid_mold(ready, spec),
        Route::Silicone | Route::LostWax => Err(unfit("this route is not built yet", "take the rigid mold")),
    }
}

fn rigid_mold(ready: Ready, spec: &MoldSpec) -> Result<Mold, MoldError> {
    let plan = layout::plan(&ready.framed.mesh, ready.plane.height, &ready.tops, &spec.figures);
    let snap = ready.framed.snap;
    let (cavity, grown) = filled(&ready)?;
    let mut mold = blank(&ready, spec, plan, spec.figures.draft.value);
    let stuck = ready.pull.undercut_reach_mm > spec.figures.snap.value && grown.is_none();
    mold.findings.extend(undercut_finding(&mold, grown, stuck));
    mold.extras.push(map_picture(&mold));
    if stuck {
        return Ok(mold);
    }
    let cavity = cavity.as_ref().unwrap_or(&ready.solid);
    let below = parting::below((mold.plan.low, mold.plan.high), cavity, &ready.plane, snap)?;
    let tools = rigid::Tools::of(&mold.plan, &spec.figures)?;
    for (name, half, pull) in rigid::halves(cavity, &below, &mold.plan, &tools)? {
        push(&mut mold, name, Kind::Half, &half, pull, 1);
    }
    mold.pieces.push(source("part", Kind::Part, &mold.part));
    if ready.plane.wrong > 0.0 {
        push(&mut mold, "below", Kind::Below, &below, DVec3::ZERO, 0);
    }
    mold.findings.extend(draft_finding(&mold));
    mold.extras
        .push(Extra { name: format!("{}.scad", mold.name), bytes: scad::two_part(&mold).into_bytes() });
    mold.extras.push(opened_picture(&mold));
    Ok(mold)
}

/// Adds a solid as a file can hold it, or the finding that none can.
pub fn push(mold: &mut Mold, name: &str, kind: Kind, solid: &Solid, pull: DVec3, copies: usize) {
    let (mesh, closed) = stl::settled(solid).map_or_else(|| (solid.mesh(), false), |(m, _)| (m, true));
    let bodies = mesh.topology().bodies;
    mold.pieces.push(Piece { name: name.to_string(), kind, mesh, pull, copies });
    let mut say = |what: String| {
        let remedy = "do not use this file; please report it with the part";
        let found = finding(mold, Severity::Error, vec![], what, remedy);
        mold.findings.push(found);
    };
    if !closed {
        say(format!("{name} has detail that f32 can not hold apart"));
    }
    if bodies != 1 && kind != Kind::Below {
        say(format!("{name} is {bodies} bodies, not one"));
    }
}

/// The part with its undercuts filled, where they are within what the cavity may be off; and how much came to it.
fn filled(ready: &Ready) -> Result<(Option<Solid>, Option<f64>), MoldError> {
    if !ready.blocked.is_real() {
        return Ok((None, Some(0.0)));
    }
    // Worth trying only where the air can be little: its volume is at least that of the overlaps' own columns.
    if ready.pull.undercut_reach_mm > WORTH_FILLING {
        return Ok((None, None));
    }
    let (solid, grown) = fill::fill(&ready.solid, &ready.framed.mesh, &ready.blocked, ready.framed.snap)?;
    let little = grown <= CAVITY_SHARE / 2.0 * ready.solid.volume();
    Ok(if little { (Some(solid), Some(grown)) } else { (None, None) })
}

/// Undercuts wider than this are features, mm, not slips of the facets: a tenth of the finest nozzle.
const WORTH_FILLING: f64 = 0.04;

fn source(name: &str, kind: Kind, mesh: &Mesh) -> Piece {
    Piece { name: name.to_string(), kind, mesh: mesh.clone(), pull: DVec3::ZERO, copies: 0 }
}

fn blank(ready: &Ready, spec: &MoldSpec, plan: Plan, draft: f64) -> Mold {
    let Framed { mesh, turn, shift, snap } = ready.framed.clone();
    let parting = match ready.plane {
        Plane { height, wrong: 0.0 } => Parting::Plane { height_mm: height },
        Plane { height, wrong } => Parting::Stepped { height_mm: height, off_mm2: wrong },
    };
    Mold {
        name: spec.name.clone(),
        route: spec.route,
        pull: ready.pull.clone(),
        turn,
        shift,
        maps: maps(&mesh, ready.plane.height, &ready.blocked, snap, draft),
        part: mesh,
        snap,
        parting: Some(parting),
        pieces: vec![],
        extras: vec![],
        volumes: vec![],
        measured: vec![],
        steps: vec![],
        findings: vec![],
        figures: spec.figures.clone(),
        plan,
        tops: ready.tops.clone(),
    }
}

use crate::mold::frame::Framed;

/// A finding with its place in the part's own frame.
pub fn finding(mold: &Mold, severity: Severity, at: Vec<DVec3>, what: String, remedy: &str) -> Finding {
    let back = |p: &DVec3| mold.turn.transpose() * (*p - mold.shift);
    let place = Place { parts: vec![mold.name.clone()], at: at.iter().map(back).collect() };
    Finding { severity, place, what, remedy: remedy.to_string() }
}

fn undercut_finding(mold: &Mold, grown: Option<f64>, stuck: bool) -> Option<Finding> {
    let p = &mold.pull;
    let worst = mold.maps.undercut_mm2.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    let at: Vec<DVec3> =
        worst.map(|(t, _)| mold.part.corners(t).iter().sum::<DVec3>() / 3.0).into_iter().collect();
    let (area, wide) = (p.undercut_mm2, p.undercut_reach_mm);
    if stuck {
        let what = format!(
            "{area:.3} mm2 are undercut in every direction looked at, here {wide:.2} mm wide; a rigid mold in two halves would not open, and none is made"
        );
        return Some(finding(mold, Severity::Error, at, what, "take the silicone route, or divide the part"));
    }
    match grown {
        Some(g) if g > 0.0 => Some(finding(
            mold,
            Severity::Note,
            at,
            format!(
                "{area:.4} mm2 of undercut, at most {wide:.4} mm wide, are filled in the cavity ({g:.6} mm3)"
            ),
            "nothing to do: it is below what the cavity may be off",
        )),
        None if area > 0.0 => Some(finding(
            mold,
            Severity::Warning,
            at,
            format!(
                "{area:.3} mm2 of undercut, at most {wide:.3} mm wide, stay: the casting must snap over them"
            ),
            "take the silicone route where the cast material is stiff",
        )),
        _ => None,
    }
}

fn draft_finding(mold: &Mold) -> Option<Finding> {
    let (low, least) = (mold.maps.low_draft_mm2, mold.figures.draft.value);
    (low > 0.0).then(|| {
        let what = format!("{low:.1} mm2 of the part have less than {least} degrees of draft along the pull");
        finding(
            mold,
            Severity::Warning,
            vec![],
            what,
            "use a release agent, or the silicone route, which needs no draft",
        )
    })
}

/// Draft from red (none) over yellow to green; undercut in magenta.
fn map_colours(maps: &Maps, least: f64) -> Vec<[u8; 3]> {
    let of = |(d, u): (&f64, &f64)| match d {
        _ if *u > 0.0 => [200, 0, 160],
        d if *d < least => [214, 69, 65],
        d if *d < 5.0 * least => [232, 190, 80],
        _ => [96, 170, 110],
    };
    maps.draft_deg.iter().zip(&maps.undercut_mm2).map(of).collect()
}

fn map_picture(mold: &Mold) -> Extra {
    let colours = map_colours(&mold.maps, mold.figures.draft.value);
    let (lo, hi) = mold.part.bounds();
    let over = mold.part.map(|v| DVec3::new(v.x, -v.y, -v.z));
    let below = DVec3::new(0.0, -(hi.y - lo.y) * 1.3 - 0.5 * (hi.z - lo.z), hi.z);
    let views = [
        Painted { mesh: &mold.part, colours: colours.clone(), shift: DVec3::ZERO },
        Painted { mesh: &over, colours, shift: below },
    ];
    Extra { name: format!("{}.draft.png", mold.name), bytes: picture::png(&views, 20.0, 50.0) }
}

/// The halves opened: the upper one turned over beside the lower.
fn opened_picture(mold: &Mold) -> Extra {
    let halves: Vec<&Piece> = mold.pieces.iter().filter(|p| p.kind == Kind::Half).collect();
    let over = halves[1].mesh.map(|v| DVec3::new(v.x, -v.y, -v.z));
    let wide = mold.plan.high - mold.plan.low;
    let beside = if wide.x > wide.y {
        DVec3::new(0.0, wide.y + 10.0, 0.0)
    } else {
        DVec3::new(wide.x + 10.0, 0.0, 0.0)
    };
    let level = DVec3::Z * (2.0 * mold.plan.parting);
    let views = [
        Painted { mesh: &halves[0].mesh, colours: vec![[150, 180, 210]], shift: DVec3::ZERO },
        Painted { mesh: &over, colours: vec![[210, 180, 140]], shift: beside + level },
    ];
    Extra { name: format!("{}.opened.png", mold.name), bytes: picture::png(&views, 25.0, 50.0) }
}
