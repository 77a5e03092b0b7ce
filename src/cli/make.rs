//! Takes an assembly in place; writes its parts, as made or as they are, and tells what was written.
//!
//! Not promised: molds; they are not built yet, and the answer says so.

use super::args::{Format, Together};
use super::load::Placed;
use super::told::{News, Told, Trouble};
use crate::fabricate;
use crate::report::content::{Chapter, Column, Table, Tone};
use crate::report::export;
use crate::report::file::write_whole;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use weavelock_fab::check::{Outcome, Programs};
use weavelock_fab::make::{self, Recipe};
use weavelock_fab::process::{Overrides, Process};
use weavelock_fab::report::{Report, Severity};

/// Whether programs of others are asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Checkers {
    Installed,
    None,
}

impl Checkers {
    pub fn of(asked: bool) -> Checkers {
        if asked { Checkers::Installed } else { Checkers::None }
    }
}

/// What a part is made by where neither spec nor flag says: the commonest printer and plastic.
const DEFAULT_PROCESS: &str = "fdm-pla";

#[derive(Serialize)]
struct FabAnswer<'a> {
    verb: &'a str,
    #[serde(flatten)]
    report: &'a Report,
}

pub fn fab(placed: &Placed, process: Option<&str>, out: &Path, checkers: Checkers) -> Result<Told, Trouble> {
    let report = made(placed, process, out, checkers)?;
    Ok(told_fab(&report, out))
}

pub fn made(
    placed: &Placed,
    process: Option<&str>,
    out: &Path,
    checkers: Checkers,
) -> Result<Report, Trouble> {
    let own = placed.spec.fab.as_ref();
    let name = process.or(own.map(|f| f.process.as_str())).unwrap_or(DEFAULT_PROCESS);
    let wrong = |e: weavelock_fab::process::ProcessError| Trouble::Word(format!("error: {e}"));
    let overrides = own.map(|f| Overrides {
        clearance: f.clearance_mm,
        // The spec's shares are fractions, a process speaks of per cent.
        shrinkage: f.shrinkage.iter().map(|(step, s)| (step.clone(), s * 100.0)).collect(),
    });
    let process = Process::find(name).map_err(wrong)?.with(&overrides.unwrap_or_default()).map_err(wrong)?;
    let programs = (checkers == Checkers::Installed).then(Programs::default);
    let recipe = Recipe { programs, ..Recipe::new(process) };
    make::make(&fabricate::job(&placed.joined), &recipe, out)
        .map_err(|e| Trouble::Word(format!("error: {e}")))
}

pub fn told_fab(report: &Report, out: &Path) -> Told {
    let news = News::of(report.worst() != Some(Severity::Error));
    let answer = FabAnswer { verb: "fab", report };
    let chapter = fab_chapter(report, out);
    Told {
        remarks: vec![report.molds_note.clone()],
        ..Told::new(news, &answer, &report.name, "Parts as made", chapter)
    }
}

pub fn fab_chapter(report: &Report, out: &Path) -> Chapter {
    let errors = report.findings.iter().filter(|f| f.severity == Severity::Error).count();
    let least = report.gaps.iter().map(|g| g.least_mm).fold(f64::INFINITY, f64::min);
    let (tone, headline) = match errors {
        0 => (Tone::Good, format!("{} parts written to {}.", report.parts.len(), out.display())),
        n => (Tone::Bad, format!("{n} findings forbid making this as it is.")),
    };
    let row = |p: &weavelock_fab::report::PartReport| {
        let volume = p.read_back.volume_mm3.map_or("-".into(), |v| format!("{v:.1}"));
        let tight = p.read_back.watertight.map_or("not written", |w| if w { "yes" } else { "no" });
        vec![
            p.id.clone(),
            p.file.clone().unwrap_or("-".into()),
            volume,
            format!("{:.1}", p.mass_g),
            tight.into(),
        ]
    };
    let head = vec![
        Column::words("part"),
        Column::words("file"),
        Column::numbers("volume mm3"),
        Column::numbers("mass g"),
        Column::words("watertight"),
    ];
    let mut facts = vec![
        ("process".to_string(), report.process.clone()),
        (
            "clearance".into(),
            format!("{} mm for each face, fit {} mm", report.clearance.value, report.fit_mm),
        ),
        ("scale of the master".into(), format!("{:.5}", report.scale)),
    ];
    if least.is_finite() {
        facts.push((
            "least gap measured".into(),
            format!("{least:.4} mm between {} pairs", report.gaps.len()),
        ));
    }
    facts.extend(checked(report));
    let words =
        report.findings.iter().map(|f| format!("{:?}: {} ({})", f.severity, f.what, f.remedy)).collect();
    let tables = vec![Table {
        caption: "As read back from the files".into(),
        head,
        rows: report.parts.iter().map(row).collect(),
    }];
    Chapter { tone, headline, words, facts, tables, ..Chapter::default() }
}

/// How the master came to its scale.
pub fn ledger_chapter(report: &Report) -> Chapter {
    let row = |e: &weavelock_fab::ledger::Entry| {
        let range = format!("{} to {}", e.low_percent, e.high_percent);
        let grade = format!("{:?}", e.grade);
        vec![
            e.step.clone(),
            e.shrinkage_percent.to_string(),
            range,
            format!("{:.6}", e.factor),
            e.source.clone(),
            grade,
        ]
    };
    let head = vec![
        Column::words("step"),
        Column::numbers("shrinks by %"),
        Column::words("range %"),
        Column::numbers("factor"),
        Column::words("source"),
        Column::words("grade"),
    ];
    let table = Table { caption: "Steps".into(), head, rows: report.ledger.iter().map(row).collect() };
    let headline = format!("The master is made {:.5} times the finished size.", report.scale);
    Chapter { headline, tables: vec![table], ..Chapter::default() }
}

/// What programs of others said, a line for each program; that they were not asked is said too.
fn checked(report: &Report) -> Vec<(String, String)> {
    let all = report.parts.iter().flat_map(|p| &p.checks).chain(report.pair_checks.iter().map(|p| &p.check));
    let mut by: BTreeMap<&str, [usize; 3]> = BTreeMap::new();
    for check in all {
        let column = match check.outcome {
            Outcome::Passed => 0,
            Outcome::Failed(_) => 1,
            Outcome::NotRun(_) => 2,
        };
        by.entry(&check.by).or_default()[column] += 1;
    }
    if by.is_empty() {
        let why = "not run: OpenSCAD, PrusaSlicer, ADMesh (`weavelock fab --check` asks them)";
        return vec![("checked by others".into(), why.into())];
    }
    let line = |(name, [passed, failed, not_run]): (&str, [usize; 3])| {
        (format!("checked by {name}"), format!("{passed} passed, {failed} failed, {not_run} not run"))
    };
    by.into_iter().map(line).collect()
}

#[derive(Serialize)]
struct ExportAnswer {
    verb: &'static str,
    unit: &'static str,
    files: Vec<String>,
}

pub fn export(placed: &Placed, format: Format, layout: Together, out: &Path) -> Result<Told, Trouble> {
    let asm = &placed.joined.assembly;
    let ending = if format == Format::Stl { "stl" } else { "obj" };
    let groups: Vec<(String, Vec<_>)> = match layout {
        Together::Whole => vec![(asm.name.clone(), asm.ids().collect())],
        Together::Parts => asm.ids().map(|p| (asm.part(p).id.clone(), vec![p])).collect(),
    };
    std::fs::create_dir_all(out).map_err(|e| {
        Trouble::Word(format!(
            "error: cannot make the folder {}: {e}\n  hint: name a folder that you may write to with --out",
            out.display()
        ))
    })?;
    let mut files = Vec::new();
    for (name, parts) in groups {
        // STL has no unit, so the name says it.
        let file = format!("{}.mm.{ending}", name.replace(['/', '\\'], "-"));
        let bytes = match format {
            Format::Stl => export::stl(asm, &parts),
            Format::Obj => export::obj(asm, &parts),
        };
        write_whole(&out.join(&file), &bytes)?;
        files.push(file);
    }
    let headline = format!("{} files in {}, in mm, in place.", files.len(), out.display());
    let chapter = Chapter { tone: Tone::Good, headline, words: files.clone(), ..Chapter::default() };
    let answer = ExportAnswer { verb: "export", unit: "mm", files };
    Ok(Told::new(News::Good, &answer, &asm.name, "Files", chapter))
}
