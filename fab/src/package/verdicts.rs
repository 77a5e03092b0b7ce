//! Takes a package on disk, not yet in its place; asks the programs of others about plates, assembly and coupon, and adds
//! what all this says to the findings.
//!
//! Not promised: that a slicer's pass means a good print; it slices thin walls and overlaps without a word.

use super::PackageReport;
use crate::check::slicer::{self, Slicing};
use crate::check::{Check, Outcome};
use crate::make::Recipe;
use crate::mesh::Mesh;
use crate::process::Process;
use crate::report::{Finding, Place, Severity};
use std::collections::BTreeMap;
use std::path::Path;

/// Asks whoever is installed; leaves the checks empty where nobody is to be asked.
pub fn ask(package: &mut PackageReport, recipe: &Recipe, folder: &Path) {
    let Some(programs) = &recipe.programs else { return };
    let name = slicer::name(&programs.slicer);
    let shells: BTreeMap<String, usize> =
        package.report.parts.iter().map(|p| (p.id.clone(), p.read_back.shells())).collect();
    // What is no part is a mold's print.
    let of = |(id, mesh): &(String, Mesh)| shells.get(id).copied().unwrap_or_else(|| mesh.topology().bodies);
    let routes: Vec<Process> = package.report.routes.iter().map(|r| r.process.clone()).collect();
    for plate in &mut package.plates {
        let file = folder.join(&plate.file);
        plate.checks.push(slicer::bodies(&programs.slicer, &name, &file, plate.shown.iter().map(of).sum()));
        let Some(process) = routes.iter().find(|p| p.name == plate.process) else { continue };
        if process.print.material == RESIN {
            let why = "resin is sliced by the machine's own program".to_string();
            plate.checks.push(Check { by: name.clone(), of: "sliced".into(), outcome: Outcome::NotRun(why) });
            continue;
        }
        let (check, grams) = slicer::plate(&programs.slicer, &name, &file, &slicing(process), folder);
        plate.checks.push(check);
        plate.grams = grams;
    }
    if let Some(assembly) = &mut package.assembly {
        let file = folder.join(&assembly.file);
        assembly.checks.push(slicer::bodies(&programs.slicer, &name, &file, shells.values().sum()));
    }
}

/// What is not sliced for filament.
const RESIN: &str = "resin";

fn slicing(process: &Process) -> Slicing {
    let p = &process.print;
    Slicing { bed: p.bed.size, layer: p.layer.value, infill: p.infill.value, density: p.density.value }
}

/// Puts failed checks and parts that do not stand among the findings, gravest first.
pub fn collect(package: &mut PackageReport) {
    let plates = package.plates.iter().flat_map(|p| p.checks.iter().map(|c| (p.file.as_str(), c)));
    let assembly = package.assembly.iter().flat_map(|a| a.checks.iter().map(|c| (a.file.as_str(), c)));
    let mut found: Vec<Finding> = plates.chain(assembly).filter_map(|(file, c)| of_check(file, c)).collect();
    found.extend(of_layings(package));
    package.report.findings.extend(found);
    package.report.findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
}

fn of_check(file: &str, check: &Check) -> Option<Finding> {
    let (severity, why, remedy) = match &check.outcome {
        Outcome::Passed => return None,
        Outcome::Failed(why) => (Severity::Error, why, "do not print this plate before it is clear why"),
        Outcome::NotRun(why) => (Severity::Note, why, "check it with another program"),
    };
    let what = format!("{file}: {}, {}: {why}", check.by, check.of);
    Some(Finding { severity, place: Place::default(), what, remedy: remedy.into() })
}

/// One finding for all parts that stand on nothing flat.
fn of_layings(package: &PackageReport) -> Option<Finding> {
    let tips = package.layings.iter().filter(|l| l.laying.footing == super::laying::Footing::Tips);
    let parts: Vec<String> = tips.flat_map(|l| package.report.alike(&l.part)).collect();
    (!parts.is_empty()).then(|| Finding {
        severity: Severity::Warning,
        place: Place { parts, at: vec![] },
        what: "no flat face to stand on".into(),
        remedy: "print with supports and a brim, or cut a face with --flatten".into(),
    })
}
