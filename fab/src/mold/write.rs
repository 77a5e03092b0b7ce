//! Takes a mold and a folder; gives its files, what was measured on them after reading them back, and what OpenSCAD makes
//! of the source.
//!
//! A measurement that misses its limit is a finding of severity error; the files stay, so that it can be looked at.

use crate::bvh::Bvh;
use crate::check::openscad::OpenScad;
use crate::check::{Check, Outcome};
use crate::files::{Batch, FileError, stl};
use crate::mesh::{Closure, Mesh};
use crate::mold::checks::{self, Halves};
use crate::mold::fins::{self, Fins, Looked};
use crate::mold::make::finding;
use crate::mold::{Kind, Measured, Mold, MoldError, MoldReport, Piece, Route, WrittenPiece, scad};
use crate::report::{Finding, Place, Severity};
use std::path::Path;

/// Stages all files of the mold, reads them back and measures them. The caller commits the batch.
pub fn write(mold: &Mold, batch: &mut Batch) -> Result<MoldReport, MoldError> {
    let mut back = Vec::new();
    for piece in &mold.pieces {
        back.push(stage(mold, piece, batch)?);
    }
    for extra in &mold.extras {
        batch.stage(&extra.name, |out| out.write_all(&extra.bytes))?;
    }
    let maps = serde_json::to_vec(&mold.maps).unwrap_or_default();
    let maps_name = format!("{}.maps.json", mold.name);
    batch.stage(&maps_name, |out| out.write_all(&maps))?;
    let mut report = report(mold, &back);
    report.files.push(maps_name);
    let on_files = measured(mold, &back)?;
    report.findings.extend(on_files.iter().filter(|m| !m.kept).map(|m| of_measure(mold, m)));
    report.measured.extend(on_files);
    Ok(report)
}

fn stage(mold: &Mold, piece: &Piece, batch: &mut Batch) -> Result<Mesh, MoldError> {
    let snapped = stl::snapped(&piece.mesh);
    let path = batch.stage(&scad::file_name(mold, &piece.name), |out| stl::write(&snapped, out))?;
    let read = std::fs::File::open(&path).and_then(|mut f| stl::read(&mut f));
    read.map_err(|cause| MoldError::File(FileError { action: "read back", path, cause }))
}

fn measured(mold: &Mold, back: &[Mesh]) -> Result<Vec<Measured>, MoldError> {
    let find = |name: &str| mold.pieces.iter().position(|p| p.name == name).map(|k| &back[k]);
    match (mold.route, find("lower"), find("upper"), find("board")) {
        (Route::Rigid, Some(lower), Some(upper), _) => {
            let own = mold.pieces.iter().zip(back).filter(|(p, _)| p.kind == Kind::Core);
            let cores = own.map(|(p, m)| (m, p.pull)).collect();
            Ok(checks::rigid(mold, &Halves { lower, upper, cores })?)
        }
        (Route::Silicone, _, _, Some(board)) => Ok(checks::silicone(mold, board)?),
        _ => Ok(vec![]),
    }
}

fn of_measure(mold: &Mold, m: &Measured) -> Finding {
    let what = format!("{}: {:.6} {}, limit {:.6} ({})", m.of, m.value, m.unit, m.limit, m.because);
    finding(mold, Severity::Error, vec![], what, "do not use this mold; please report it with the part")
}

fn report(mold: &Mold, back: &[Mesh]) -> MoldReport {
    let least = mold.figures.least_wall.value;
    let fins = |(p, m): (&Piece, &Mesh)| {
        if p.kind.is_printed() { fins::fins(m, &Bvh::new(m), least) } else { Fins::NONE }
    };
    let all: Vec<Fins> = mold.pieces.iter().zip(back).map(fins).collect();
    let piece = |((p, m), fins): ((&Piece, &Mesh), &Fins)| WrittenPiece {
        name: p.name.clone(),
        kind: p.kind,
        file: scad::file_name(mold, &p.name),
        copies: p.copies,
        pull: p.pull,
        volume_mm3: m.volume(),
        watertight: m.closure() == Closure::Closed,
        bodies: m.topology().bodies,
        triangles: m.triangles.len(),
        fin: fins.widest,
        fins_looked_at: fins.looked,
        checks: vec![],
    };
    let pieces: Vec<WrittenPiece> = mold.pieces.iter().zip(back).zip(&all).map(piece).collect();
    let files =
        pieces.iter().map(|p| p.file.clone()).chain(mold.extras.iter().map(|e| e.name.clone())).collect();
    let mut findings = mold.findings.clone();
    findings.extend(pieces.iter().filter(|p| !p.watertight).map(|p| {
        let what = format!("{} is not closed as written", p.file);
        finding(mold, Severity::Error, vec![], what, "do not use this file; please report it with the part")
    }));
    findings.extend(pieces.iter().filter_map(|p| of_fin(mold, p)));
    findings.extend(pieces.iter().filter(|p| p.fins_looked_at == Looked::Some).map(|p| {
        let what = format!("{} has more thin places than were looked at: there may be wider fins", p.file);
        finding(mold, Severity::Note, vec![], what, "make the mesh of the part coarser")
    }));
    MoldReport {
        name: mold.name.clone(),
        route: mold.route,
        pull: mold.pull.clone(),
        parting: mold.parting.clone(),
        filled_mm3: mold.filled_mm3,
        least_draft_deg: if mold.route == Route::Silicone { 0.0 } else { mold.figures.draft.value },
        low_draft_mm2: mold.maps.low_draft_mm2,
        pieces,
        files,
        volumes: mold.volumes.clone(),
        measured: mold.measured.clone(),
        steps: mold.steps.clone(),
        findings,
    }
}

/// A fin of a printed piece; its place is in the part's own frame.
fn of_fin(mold: &Mold, piece: &WrittenPiece) -> Option<Finding> {
    let fin = piece.fin?;
    let least = mold.figures.least_wall.value;
    let (thick, wide) = (fin.thin.thickness_mm, fin.width_mm);
    let (fin_words, remedy) = if thick < EDGE_SHARE * least {
        (
            "an edge that runs out to nothing".to_string(),
            "the piece will end short of it: cut the flash that the casting gets there off, or print this piece on a finer \
             machine",
        )
    } else {
        (
            format!("a fin of {thick:.2} mm"),
            "widen what forms it in the part (a slot, the room beside a lip), print this piece on a finer machine, or set a \
             strip of metal there",
        )
    };
    let what = format!(
        "{} has {fin_words}, over {wide:.1} mm thinner than the {least} mm that the printer of the mold makes",
        piece.file
    );
    Some(finding(mold, Severity::Warning, fin.thin.at.to_vec(), what, remedy))
}

/// What thins to less than this share of the least wall is an edge: where it ends on paper is not where the print does.
const EDGE_SHARE: f64 = 0.1;

/// Lets OpenSCAD make each piece from the source in the folder, and adds what it finds to the report.
pub fn check_openscad(report: &mut MoldReport, folder: &Path, program: &str) {
    let source = folder.join(format!("{}.scad", report.name));
    let Ok(openscad) = OpenScad::new(program, &std::env::temp_dir()) else { return };
    let there = source.exists();
    let rooms: Vec<String> =
        report.pieces.iter().filter(|p| p.kind == Kind::Room).map(|p| p.name.clone()).collect();
    for piece in report.pieces.iter_mut().filter(|p| p.copies > 0) {
        let as_it_is = piece.kind == Kind::Core && !rooms.contains(&scad::room_name(&piece.name));
        if !there || as_it_is {
            let why = if there { "the source takes it as it is" } else { "there is no source" };
            let outcome = Outcome::NotRun(why.into());
            piece.checks.push(Check {
                by: "OpenSCAD".into(),
                of: "the same solid from the source".into(),
                outcome,
            });
            continue;
        }
        let check = openscad.same(
            &source,
            &format!("half=\"{}\"", piece.name),
            &folder.join(&piece.file),
            piece.volume_mm3,
        );
        report.findings.extend(of_check(&report.name, &piece.file, &check));
        piece.checks.push(check);
    }
}

fn of_check(name: &str, file: &str, check: &Check) -> Option<Finding> {
    let (severity, why) = match &check.outcome {
        Outcome::Passed => return None,
        Outcome::Failed(why) => (Severity::Error, why),
        Outcome::NotRun(why) => (Severity::Note, why),
    };
    Some(Finding {
        severity,
        place: Place { parts: vec![name.to_string()], at: vec![] },
        what: format!("{file}, {}, {}: {why}", check.by, check.of),
        remedy: "compare the two solids before making either".into(),
    })
}
