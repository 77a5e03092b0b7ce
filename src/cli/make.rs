//! Takes an assembly in place; writes its parts as made, and tells what was written.
//!
//! Not promised: a package around the parts; `package` makes that.

use super::clearances;
use super::load::Placed;
use super::told::{News, Told, Trouble};
use crate::fabricate;
use crate::report::content::{Chapter, Column, Table, Tone};
use crate::spec::FabSpec;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use weavelock_fab::check::{Check, Outcome, Programs};
use weavelock_fab::make::{self, Recipe};
use weavelock_fab::process::{Measured, Overrides, Process};
use weavelock_fab::report::{Finding, Report, RouteReport, Severity};

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

/// The parts alone, without a package around them.
pub fn made(placed: &Placed, out: &Path) -> Result<Report, Trouble> {
    let recipe = recipe(placed, &Wish::default(), Checkers::None)?;
    make::make(&fabricate::job(&placed.joined), &recipe, out)
        .map_err(|e| Trouble::Word(format!("error: {e}")))
}

/// What the command line asks for beyond the spec.
#[derive(Default)]
pub struct Wish {
    pub process: Option<String>,
    pub parts: Vec<(String, String)>,
    pub own: Overrides,
}

/// The recipe of a spec and a wish: processes found, the user's figures put into each that has the step.
pub fn recipe(placed: &Placed, wish: &Wish, checkers: Checkers) -> Result<Recipe, Trouble> {
    let spec = placed.spec.fab.as_ref();
    let beside = placed.spec.file.parent().unwrap_or(Path::new(""));
    let from_spec = |name: &str| match name.ends_with(".toml") {
        true => beside.join(name).display().to_string(),
        false => name.to_string(),
    };
    let main = wish.process.clone().or(spec.map(|f| from_spec(&f.process))).unwrap_or(DEFAULT_PROCESS.into());
    let mut names: BTreeMap<String, String> =
        spec.map(|f| f.parts.iter().map(|(id, n)| (id.clone(), from_spec(n))).collect()).unwrap_or_default();
    names.extend(wish.parts.iter().cloned());
    let own = overrides(spec, &wish.own);
    let mut faults = Vec::new();
    let mut find = |name: &str| Process::find(name).map_err(|e| faults.push(e.to_string())).ok();
    let main = find(&main);
    let parts: BTreeMap<String, Option<Process>> = names.into_iter().map(|(id, n)| (id, find(&n))).collect();
    let (Some(main), true) = (main, parts.values().all(Option::is_some)) else {
        return Err(all_faults(faults));
    };
    let parts: BTreeMap<String, Process> = parts.into_iter().filter_map(|(id, p)| Some((id, p?))).collect();
    let used: Vec<&Process> = std::iter::once(&main).chain(parts.values()).collect();
    faults.extend(steps_of_none(&own, &used));
    let asm = &placed.joined.assembly;
    let maker = |p| parts.get(&asm.part(p).id).unwrap_or(&main).name.as_str();
    faults.extend(clearances::of_nobody(&own, &asm.ids().map(maker).collect()));
    let mut with = |p: &Process| p.with(&for_its_steps(&own, p)).map_err(|e| faults.push(e.to_string())).ok();
    let main = with(&main);
    let parts = parts.iter().map(|(id, p)| Some((id.clone(), with(p)?))).collect::<Option<BTreeMap<_, _>>>();
    let (Some(process), Some(parts), true) = (main, parts, faults.is_empty()) else {
        return Err(all_faults(faults));
    };
    let programs = (checkers == Checkers::Installed).then(Programs::default);
    Ok(Recipe { programs, parts, ..Recipe::new(process) })
}

fn all_faults(mut faults: Vec<String>) -> Trouble {
    let mut seen = std::collections::BTreeSet::new();
    faults.retain(|f| seen.insert(f.clone()));
    Trouble::Word(format!("error: {}", faults.join("\n")))
}

/// The spec's figures and the command line's over them.
fn overrides(spec: Option<&FabSpec>, wish: &Overrides) -> Overrides {
    // The spec's shares are fractions, a process speaks of per cent.
    let shrinkage = spec.map(|f| f.shrinkage.iter().map(|(step, s)| (step.clone(), s * 100.0)).collect());
    let mut clearances = spec.map(|f| f.clearances_mm.clone()).unwrap_or_default();
    clearances.extend(wish.clearances.clone());
    Overrides {
        clearance: wish.clearance.or(spec.and_then(|f| f.clearance_mm)),
        clearances,
        shrinkage: shrinkage.unwrap_or_default(),
        measured: wish.measured.clone(),
        bed: wish.bed.clone().or(spec.and_then(|f| f.bed.clone())),
        elephant_foot: wish.elephant_foot.or(spec.and_then(|f| f.elephant_foot_mm)),
        flatten: wish.flatten.or(spec.and_then(|f| f.flatten_mm)),
    }
}

fn has(process: &Process, step: &str) -> bool {
    process.steps.iter().any(|s| s.name == step)
}

/// Between a process and a step of it, where a figure is not for all processes: `sla:print`.
const OF_PROCESS: char = ':';

/// The step of this process that a name stands for, and whether it names the process.
fn step_in<'a>(process: &Process, name: &'a str) -> Option<(&'a str, bool)> {
    if has(process, name) {
        return Some((name, false));
    }
    let (of, step) = name.rsplit_once(OF_PROCESS)?;
    (of == process.name && has(process, step)).then_some((step, true))
}

/// Figures of a step hold for every process that has it; one that names the process comes before one that does not.
fn for_its_steps(own: &Overrides, process: &Process) -> Overrides {
    let mut shrinkage: BTreeMap<String, f64> = BTreeMap::new();
    let mut measured: BTreeMap<String, Measured> = BTreeMap::new();
    for for_it_alone in [false, true] {
        let step =
            |name: &str| step_in(process, name).filter(|s| s.1 == for_it_alone).map(|s| s.0.to_string());
        shrinkage.extend(own.shrinkage.iter().filter_map(|(name, s)| Some((step(name)?, *s))));
        let of_step = |m: &Measured| {
            let step = step(&m.step)?;
            Some((step.clone(), Measured { step, length: m.length }))
        };
        measured.extend(own.measured.iter().filter_map(of_step));
    }
    Overrides { shrinkage, measured: measured.into_values().collect(), ..own.clone() }
}

fn steps_of_none(own: &Overrides, used: &[&Process]) -> Vec<String> {
    let steps = own.shrinkage.keys().chain(own.measured.iter().map(|m| &m.step));
    let mut known: Vec<String> = Vec::new();
    for p in used {
        let line =
            format!("{}: {}", p.name, p.steps.iter().map(|s| &s.name[..]).collect::<Vec<_>>().join(", "));
        if !known.contains(&line) {
            known.push(line);
        }
    }
    let known = known.join("; ");
    let none = steps.filter(|s| used.iter().all(|p| step_in(p, s).is_none()));
    none.map(|s| format!("shrinkage is given for a step {s:?} that no process in use has\n  hint: their steps are {known}; PROCESS:STEP is a step of one of them"))
        .collect()
}

pub fn told_fab(report: &Report, out: &Path) -> Told {
    let news = News::of(report.worst() != Some(Severity::Error));
    let answer = FabAnswer { verb: "fab", report };
    Told::new(news, &answer, &report.name, "Parts as made", fab_chapter(report, out, &[]))
}

pub fn fab_chapter(report: &Report, out: &Path, more: &[Check]) -> Chapter {
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
    let mut facts: Vec<(String, String)> = report.routes.iter().map(route_fact).collect();
    if least.is_finite() {
        facts.push((
            "least gap measured".into(),
            format!("{least:.4} mm between {} pairs", report.gaps.len()),
        ));
    }
    facts.extend(checked(report, more));
    let words = report.findings.iter().map(finding).collect();
    let tables = vec![Table {
        caption: "As read back from the files".into(),
        head,
        rows: report.parts.iter().map(row).collect(),
    }];
    Chapter { tone, headline, words, facts, tables, ..Chapter::default() }
}

/// A finding in a line, with the parts that it is about and its first place, mm.
fn finding(f: &Finding) -> String {
    let of = if f.place.parts.is_empty() { String::new() } else { f.place.parts.join(", ") + ": " };
    let place =
        f.place.at.first().map_or(String::new(), |p| format!(", at ({:.2}, {:.2}, {:.2})", p.x, p.y, p.z));
    format!("{:?}: {of}{}{place} ({})", f.severity, f.what, f.remedy)
}

/// What whoever makes the parts has to know, worst first.
pub fn findings_chapter(report: &Report) -> Chapter {
    let mut found: Vec<&Finding> = report.findings.iter().collect();
    found.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let (tone, headline) = match (found.first().map(|f| f.severity), found.len()) {
        (None, _) => (Tone::Good, "Nothing stands in the way of making the parts.".to_string()),
        (Some(Severity::Error), n) => {
            (Tone::Bad, format!("{n} findings; the first forbids making this as it is."))
        }
        (_, 1) => (Tone::Plain, "One finding; it forbids nothing.".into()),
        (_, n) => (Tone::Plain, format!("{n} findings; none forbids making the parts.")),
    };
    let row = |f: &&Finding| {
        vec![format!("{:?}", f.severity), f.place.parts.join(", "), f.what.clone(), f.remedy.clone()]
    };
    let head = ["severity", "parts", "what", "remedy"].map(Column::words).to_vec();
    let table = Table { caption: "Findings".into(), head, rows: found.iter().map(row).collect() };
    let tables = if found.is_empty() { vec![] } else { vec![table] };
    Chapter { tone, headline, tables, ..Chapter::default() }
}

fn route_fact(r: &RouteReport) -> (String, String) {
    let parts = if r.parts.len() == 1 { r.parts[0].clone() } else { format!("{} parts", r.parts.len()) };
    let said = format!("{parts}, {} mm of air on each face, scale {:.5}", r.process.clearance.value, r.scale);
    (r.process.name.clone(), said)
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
fn checked(report: &Report, more: &[Check]) -> Vec<(String, String)> {
    let all = report.parts.iter().flat_map(|p| &p.checks).chain(report.pair_checks.iter().map(|p| &p.check));
    let all = all.chain(report.molds.iter().flat_map(|m| &m.checks)).chain(more);
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
