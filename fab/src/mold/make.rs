//! Takes a part and an order; gives the mold of the route that was asked for.

use crate::files::stl;
use crate::mesh::Mesh;
use crate::mold::frame::Framed;
use crate::mold::maps::maps;
use crate::mold::parting::Plane;
use crate::mold::plan::Plan;
use crate::mold::prepare::{Ready, ready, unfit};
use crate::mold::{Extra, Kind, Mold, MoldError, MoldSpec, Parting, Piece, Route};
use crate::mold::{pour, surroundings, tree, two_part};
use crate::report::{Finding, Place, Severity};
use crate::solid::Solid;
use glam::DVec3;
use rayon::prelude::*;

/// Makes a mold of a part. Errors are of the input; what can not be molded as wanted is a finding of severity error, and
/// then there are no pieces.
pub fn make(part: &Mesh, spec: &MoldSpec) -> Result<Mold, MoldError> {
    if spec.count == 0 || spec.count > MOST {
        return Err(unfit(
            format!("a mold of {} parts was asked for", spec.count),
            "give a count from 1 to 100",
        ));
    }
    if spec.surroundings.is_empty() {
        return of_route(part, spec);
    }
    let (hollow, measure) = surroundings::hollow(part, &spec.surroundings)?;
    let mut mold = of_route(&hollow, spec)?;
    mold.measured.push(measure);
    Ok(mold)
}

/// Parts of one mold or tree: more fill no plate and no flask.
const MOST: usize = 100;

fn of_route(part: &Mesh, spec: &MoldSpec) -> Result<Mold, MoldError> {
    let ready = ready(part, spec)?;
    match spec.route {
        Route::Rigid => two_part::mold(part, ready, spec),
        Route::Silicone => pour::mold(ready, spec),
        Route::LostWax => tree::mold(ready, spec),
    }
}

pub fn extra(mold: &mut Mold, ending: &str, text: impl Fn(&Mold) -> String) {
    let made = Extra { name: format!("{}.{ending}", mold.name), bytes: text(mold).into_bytes() };
    mold.extras.push(made);
}

/// A solid on its way to its file, and the way it leaves.
pub struct Cast<'a> {
    pub name: &'a str,
    pub kind: Kind,
    pub solid: Solid,
    pub pull: DVec3,
}

/// What takes long of adding pieces, done for all of them at once.
pub fn settled(casts: &[Cast]) -> Vec<Settled> {
    casts.par_iter().map(|c| stl::settled(&c.solid)).collect()
}

/// Adds pieces of which one is made each.
pub fn push_all(mold: &mut Mold, casts: &[Cast], settled: Vec<Settled>) {
    for (c, settled) in casts.iter().zip(settled) {
        keep(mold, (c.name, c.kind), (&c.solid, settled), c.pull, 1);
    }
}

/// Adds a solid as a file can hold it, or the finding that none can.
pub fn push(mold: &mut Mold, name: &str, kind: Kind, solid: &Solid, pull: DVec3, copies: usize) {
    keep(mold, (name, kind), (solid, stl::settled(solid)), pull, copies);
}

/// What came of settling a solid: the mesh and the size of detail that it cost, or nothing.
pub type Settled = Option<(Mesh, f64)>;

/// Adds a solid that is settled; one that only the OpenSCAD source needs is left out where f32 can not hold it.
pub fn keep(
    mold: &mut Mold,
    (name, kind): (&str, Kind),
    (solid, settled): (&Solid, Settled),
    pull: DVec3,
    copies: usize,
) {
    let (mesh, closed) = settled.map_or_else(|| (solid.mesh(), false), |(m, _)| (m, true));
    let plain = closed && (kind.is_made() || stl::is_plain(&mesh));
    // A source without it is told where the source would be.
    if !kind.is_made() && !plain {
        return;
    }
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
    if bodies != 1 && kind.is_made() {
        say(format!("{name} is {bodies} bodies, not one"));
    }
}

pub fn source(name: &str, kind: Kind, mesh: &Mesh) -> Piece {
    Piece { name: name.to_string(), kind, mesh: mesh.clone(), pull: DVec3::ZERO, copies: 0 }
}

pub fn blank(ready: &Ready, spec: &MoldSpec, plan: Plan, draft: f64) -> Mold {
    let Framed { mesh, turn, shift, snap } = ready.framed.clone();
    let parting = match ready.plane {
        Plane { height, wrong: 0.0 } => Parting::Plane { height_mm: height },
        Plane { height, wrong } => Parting::Stepped { height_mm: height, off_mm2: wrong },
    };
    let mut mold = Mold {
        name: spec.name.clone(),
        route: spec.route,
        pull: ready.pull.clone(),
        turn,
        shift,
        maps: maps(&mesh, ready.plane.height, &ready.blocked, snap, draft),
        part: mesh,
        castings: spec.count,
        snap,
        parting: Some(parting),
        filled_mm3: None,
        pieces: vec![],
        extras: vec![],
        volumes: vec![],
        measured: vec![],
        steps: vec![],
        findings: vec![],
        figures: spec.figures.clone(),
        plan,
        tops: ready.tops.clone(),
    };
    if let Some(what) = &ready.mended {
        let found =
            finding(&mold, Severity::Note, vec![], what.clone(), "nothing to do; the volume stayed the same");
        mold.findings.push(found);
    }
    mold.findings.extend(wide_gate(&mold));
    mold
}

/// Told of a part that is narrower than the gate it is filled through.
fn wide_gate(mold: &Mold) -> Option<Finding> {
    let (lo, hi) = mold.part.bounds();
    let across = (hi - lo).truncate().min_element();
    let gate = mold.plan.sprues.iter().find(|s| s.below > across)?;
    let what = format!(
        "the gate, {:.2} mm, is wider than the part, {across:.2} mm across: it shapes what it covers, and may cut the mold \
         apart there",
        gate.below
    );
    let remedy = "print this part instead of casting it";
    Some(finding(mold, Severity::Warning, vec![gate.foot], what, remedy))
}

/// A finding with its place in the part's own frame.
pub fn finding(mold: &Mold, severity: Severity, at: Vec<DVec3>, what: String, remedy: &str) -> Finding {
    let back = |p: &DVec3| mold.turn.transpose() * (*p - mold.shift);
    let place = Place { parts: vec![mold.name.clone()], at: at.iter().map(back).collect() };
    Finding { severity, place, what, remedy: remedy.to_string() }
}
