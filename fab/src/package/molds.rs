//! Takes the meshes on their masters and the folder; gives the molds of whatever is not printed itself, written and
//! measured, or why there is none.
//!
//! One mold serves all parts of the same shape and route. Not promised: more than `mold` promises.

use super::PackageReport;
use super::folder::Folder;
use super::prints::{kind_of, stem};
use crate::check::Programs;
use crate::files::Batch;
use crate::make::{FabError, Output};
use crate::mold::figures::Figures;
use crate::mold::{self, Kind, MoldError, MoldReport, MoldSpec};
use crate::process::Route;
use crate::report::{Finding, MoldFile, Place, Severity};
use serde::Serialize;

/// A mold of the package.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MoldSheet {
    /// The parts that it serves.
    pub parts: Vec<String>,
    pub process: String,
    #[serde(flatten)]
    pub report: MoldReport,
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
    output: &Output,
    package: &mut PackageReport,
    folder: &Folder,
    programs: Option<&Programs>,
) -> Result<(), FabError> {
    let figures = Figures::embedded().map_err(|e| FabError::Figures(e.to_string()))?;
    let place = folder.path().join(PLACE);
    for p in (0..output.masters.len()).filter(|&p| output.masters[p].is_some() && kind_of(output, p) == p) {
        let part = &output.report.parts[p];
        let route = output.report.routes.iter().find(|r| r.parts.contains(&part.id)).map(|r| r.process.route);
        let parts: Vec<String> = (p..output.masters.len())
            .filter(|&q| output.masters[q].is_some() && kind_of(output, q) == p)
            .map(|q| output.report.parts[q].id.clone())
            .collect();
        for &wanted in routes(route.unwrap_or(Route::Print)) {
            let name = format!("{}-{}", stem(output, p), word(wanted));
            let count = if wanted == mold::Route::LostWax { parts.len() } else { 1 };
            let spec = MoldSpec { count, ..MoldSpec::new(&name, wanted, figures.clone()) };
            let mut batch = Batch::new(&place)?;
            let made = output.masters[p]
                .as_ref()
                .map(|m| mold::make(m, &spec).and_then(|m| mold::write(&m, &mut batch)));
            match made {
                Some(Ok(mut report)) => {
                    batch.commit()?;
                    if let Some(programs) = programs {
                        mold::check_openscad(&mut report, &place, &programs.openscad);
                    }
                    keep(package, parts.clone(), &part.process, report);
                }
                Some(Err(MoldError::File(e))) => return Err(e.into()),
                Some(Err(e)) => package.report.findings.push(unmade(&parts, word(wanted), &e)),
                None => {}
            }
        }
    }
    package.report.molds_note = note(package);
    super::bill::add_molds(&mut package.bill, &package.report, &package.mold_sheets);
    Ok(())
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
        severity: Severity::Warning,
        place: Place { parts: parts.to_vec(), at: vec![] },
        what: format!("no {what} was made: {why}"),
        remedy: "make it by hand from the part's file, which has scale and clearance built in".into(),
    }
}

/// Heats of a tree are left out: the process has its own, and a sheet that says two is no sheet.
fn keep(package: &mut PackageReport, parts: Vec<String>, process: &str, mut report: MoldReport) {
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
    let made = |p: &&mold::WrittenPiece| !matches!(p.kind, Kind::Part | Kind::Below);
    package.report.molds.extend(report.pieces.iter().filter(made).map(file));
    package.report.findings.extend(report.findings.iter().cloned());
    package.mold_sheets.push(MoldSheet { parts, process: process.to_string(), report });
}
