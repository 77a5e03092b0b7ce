//! Takes the meshes on their masters and the folder; gives the molds of whatever is not printed itself, written and
//! measured, or why there is none.
//!
//! One mold serves all parts of the same shape and route. Not promised: more than `mold` promises.

use super::PackageReport;
use super::folder::Folder;
use super::poured;
use super::prints::{self, MoldPrint, kind_of, stem};
use crate::ears::triangulate;
use crate::files::Batch;
use crate::make::{Cavity, FabError, Output, Recipe};
use crate::mesh::Mesh;
use crate::mold::figures::Figures;
use crate::mold::{self, Mold, MoldError, MoldReport, MoldSpec, Volume};
use crate::process::Route;
use crate::report::{Finding, MoldFile, Place, Severity};
use crate::shape::Job;
use glam::DVec3;
use serde::Serialize;

/// A mold of the package.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MoldSheet {
    /// The parts that it serves.
    pub parts: Vec<String>,
    pub process: String,
    /// Castings at once, and how often it is filled so that each of the parts has one.
    pub castings: usize,
    pub pours: usize,
    #[serde(flatten)]
    pub report: MoldReport,
}

impl MoldSheet {
    /// How often a volume is poured or mixed: with each filling, or once where it makes the mold.
    pub fn times(&self, v: &Volume) -> usize {
        let each = self.report.route == mold::Route::LostWax || v.of.starts_with(poured::CASTING);
        if each { self.pours } else { 1 }
    }
}

/// Where molds lie in a package.
const PLACE: &str = "molds";

/// What has to be molded on the way of a route, in order.
fn routes(route: Route) -> &'static [mold::Route] {
    match route {
        Route::Print => &[],
        Route::CastDirect => &[mold::Route::Rigid],
        Route::Cast => &[mold::Route::Silicone],
        Route::LostWax => &[mold::Route::Silicone, mold::Route::LostWax],
        Route::LostPrint => &[mold::Route::LostWax],
    }
}

fn word(route: mold::Route) -> &'static str {
    match route {
        mold::Route::Rigid => "mold",
        mold::Route::Silicone => "silicone-mold",
        mold::Route::LostWax => "tree",
    }
}

/// Makes, writes and measures all molds.
pub fn molds(
    job: &Job,
    output: &Output,
    package: &mut PackageReport,
    folder: &Folder,
    recipe: &Recipe,
) -> Result<(), FabError> {
    let figures = Figures::embedded().map_err(|e| FabError::Figures(e.to_string()))?;
    let place = folder.path().join(PLACE);
    let mut printed = Vec::new();
    for p in (0..output.masters.len()).filter(|&p| output.masters[p].is_some() && kind_of(output, p) == p) {
        let part = &output.report.parts[p];
        let process = recipe.process_of(&part.id);
        let parts: Vec<String> = (p..output.masters.len())
            .filter(|&q| output.masters[q].is_some() && kind_of(output, q) == p)
            .map(|q| output.report.parts[q].id.clone())
            .collect();
        for &wanted in routes(process.route) {
            let name = format!("{}-{}", stem(output, p), word(wanted));
            let count = if wanted == mold::Route::LostWax { parts.len() } else { recipe.gang };
            let spec = MoldSpec { count, ..MoldSpec::new(&name, wanted, figures.clone()) };
            let mut batch = Batch::new(&place)?;
            let write = |mold: Mold| mold::write(&mold, &mut batch).map(|report| (mold, report));
            match made((job, output), p, &spec, &recipe.cavity).map(|m| m.and_then(write)) {
                Some(Ok((mold, mut report))) => {
                    batch.commit()?;
                    let pattern = output.masters[p].as_ref().map_or(0.0, Mesh::volume);
                    let castings = mold.castings;
                    poured::add(&mut report, &mold, process, pattern * castings as f64);
                    printed.extend(prints_of(mold, &part.process));
                    if let Some(programs) = &recipe.programs {
                        mold::check_openscad(&mut report, &place, &programs.openscad);
                    }
                    let sheet = MoldSheet {
                        parts: parts.clone(),
                        process: part.process.clone(),
                        castings,
                        pours: parts.len().div_ceil(castings.max(1)),
                        report,
                    };
                    keep(package, sheet);
                }
                Some(Err(MoldError::File(e))) => return Err(e.into()),
                Some(Err(e)) => package.report.findings.push(unmade(&parts, word(wanted), &e)),
                None => {}
            }
        }
    }
    for file in prints::mold_plates(&printed, package) {
        folder.write(&file.name, &file.bytes)?;
    }
    package.report.findings.extend(idle(output, recipe));
    package.report.molds_note = note(package);
    super::bill::add_molds(&mut package.bill, &package.report, &package.mold_sheets);
    Ok(())
}

/// What was asked of molds, and of print faces, where there are none.
fn idle(output: &Output, recipe: &Recipe) -> Vec<Finding> {
    let routes: Vec<Route> = output.report.routes.iter().map(|r| r.process.route).collect();
    let molded = routes.iter().any(|r| routes_of_cavities(*r));
    let printed = routes.iter().any(|r| r.prints_the_shape());
    let print = &recipe.process.print;
    let asked = [
        (recipe.gang > 1 && !molded, "several castings at once (--gang)", "no mold has a cavity"),
        (recipe.cavity != Cavity::Part && !molded, "the direct mold (--direct)", "no mold has a cavity"),
        (
            print.flatten.value > 0.0 && !printed,
            "a flat print face (--flatten)",
            "no part is printed in its own shape",
        ),
        (
            print.elephant_foot.value > 0.0 && !printed,
            "a chamfer (--elephant-foot)",
            "no part is printed in its own shape",
        ),
    ];
    let found = asked.iter().filter(|a| a.0).map(|(_, what, why)| {
        Finding::note(
            format!("{what} changed nothing: {why}"),
            "leave it out, or choose a process that casts or prints the part",
        )
    });
    found.collect()
}

fn routes_of_cavities(route: Route) -> bool {
    routes(route).iter().any(|m| *m != mold::Route::LostWax)
}

/// The mold of a shape; `None` where the part was not written. Of a cavity that the parts around it form: that of the first
/// part of this shape that is closed in by others, or why none is.
fn made(
    (job, output): (&Job, &Output),
    p: usize,
    spec: &MoldSpec,
    cavity: &Cavity,
) -> Option<Result<Mold, MoldError>> {
    let master = output.masters[p].as_ref()?;
    let others = match cavity {
        Cavity::Surroundings(others) if spec.route != mold::Route::LostWax => others,
        _ => return Some(mold::make(master, spec)),
    };
    let same = (p..output.masters.len()).filter(|&q| kind_of(output, q) == p);
    let mut refused = None;
    for q in same {
        let Some(part) = &output.masters[q] else { continue };
        let near = around((job, output), q, part, others);
        let tried = match others.is_empty() {
            true => mold::make(part, &MoldSpec { surroundings: near, ..spec.clone() }),
            false => among_cells(&nominal((job, output), q, q), &near, spec),
        };
        match tried {
            Ok(mut mold) => {
                mold.findings.push(no_clearance(&output.report.parts[q].id));
                return Some(Ok(mold));
            }
            Err(e) => refused = Some(e),
        }
    }
    refused.map(Err)
}

/// The mold of a part as it touches, whose faces the cells around it share.
fn among_cells(part: &Mesh, cells: &[Mesh], spec: &MoldSpec) -> Result<Mold, MoldError> {
    let shared = mold::surroundings::shared(part, cells)?;
    let mut mold = mold::make(part, spec)?;
    if !shared.kept {
        let what = format!("the cells around it share {:.4} mm3 with the cavity", shared.value);
        let place = Place { parts: vec![spec.name.clone()], at: vec![] };
        let remedy = "let the part itself form the cavity, and report this with the input".into();
        mold.findings.push(Finding { severity: Severity::Error, place, what, remedy });
    }
    mold.measured.push(shared);
    Ok(mold)
}

fn no_clearance(id: &str) -> Finding {
    Finding {
        severity: Severity::Warning,
        place: Place { parts: vec![id.to_string()], at: vec![] },
        what:
            "the cavity is what the parts around this one leave: the casting touches them, with no clearance"
                .into(),
        remedy: "take it for a part that gives way, or let the part itself form the cavity".into(),
    }
}

/// The parts and `others` near a part as they touch, without clearance, brought to its scale: with clearance there would be cracks
/// between them.
fn around((job, output): (&Job, &Output), q: usize, part: &Mesh, others: &[Mesh]) -> Vec<Mesh> {
    let (lo, hi) = part.bounds();
    let near = |m: &Mesh| {
        let (l, h) = m.bounds();
        l.cmple(hi).all() && lo.cmple(h).all()
    };
    let parts = (0..job.parts.len()).filter(|&r| r != q).map(|r| nominal((job, output), r, q));
    let beyond = others.iter().map(|m| m.map(|v| scaled(output, q, v)));
    parts.chain(beyond).filter(near).collect()
}

/// A part as it touches, in place, at the scale of part `q`.
fn nominal((job, output): (&Job, &Output), r: usize, q: usize) -> Mesh {
    let (shape, pose) = (&job.shapes[job.parts[r].shape], job.parts[r].pose);
    let triangles = shape.facets.iter().flat_map(|f| triangulate(&shape.vertices, f)).collect();
    let place = |v: &DVec3| scaled(output, q, pose.transform_point3(*v));
    Mesh { vertices: shape.vertices.iter().map(place).collect(), triangles }
}

fn scaled(output: &Output, q: usize, at: DVec3) -> DVec3 {
    let datum = output.report.datum;
    datum + (at - datum) * output.report.parts[q].scale
}

/// What of a mold comes from the printer.
fn prints_of(mold: Mold, process: &str) -> Vec<MoldPrint> {
    let name = mold.name;
    let made = mold.pieces.into_iter().filter(|p| p.copies > 0 && p.kind.is_printed());
    let print = |p: mold::Piece| MoldPrint {
        process: process.to_string(),
        name: format!("{name}.{}", p.name),
        kind: p.kind,
        pull: p.pull,
        copies: p.copies,
        mesh: p.mesh,
    };
    made.map(print).collect()
}

fn note(package: &PackageReport) -> String {
    match package.mold_sheets.len() {
        0 if package.report.routes.iter().all(|r| r.process.route == Route::Print) => {
            "nothing is cast".into()
        }
        0 => "none could be made; the findings say why".into(),
        n => format!("{n} in molds/"),
    }
}

fn unmade(parts: &[String], what: &str, why: &MoldError) -> Finding {
    Finding {
        severity: Severity::Error,
        place: Place { parts: parts.to_vec(), at: vec![] },
        what: format!("no {what} was made: {why}"),
        remedy: "take another process for it with --part, or make the mold by hand from the part's file, which has scale and clearance built in".into(),
    }
}

/// Heats of a tree are left out: the process has its own, and a sheet that says two is no sheet.
fn keep(package: &mut PackageReport, mut sheet: MoldSheet) {
    let report = &mut sheet.report;
    report.steps.retain(|s| s.celsius.is_none());
    let file = |p: &mold::WrittenPiece| MoldFile {
        mold: report.name.clone(),
        file: format!("{PLACE}/{}", p.file),
        kind: p.kind,
        copies: p.copies,
        volume_mm3: p.volume_mm3,
        watertight: p.watertight,
        checks: p.checks.clone(),
    };
    let made = |p: &&mold::WrittenPiece| p.kind.is_made();
    package.report.molds.extend(report.pieces.iter().filter(made).map(file));
    package.report.findings.extend(report.findings.iter().cloned());
    package.mold_sheets.push(sheet);
}
