//! Takes an assembly in place and what the command line asks for; makes a fabricator's package and tells what is in it.
//!
//! Not promised: anything beyond what `weavelock_fab::package` promises.

use super::args::{Common, Fab};
use super::clearances::{Clearances, clearances};
use super::load::Placed;
use super::make::{self, Checkers, Wish};
use super::pictured;
use super::told::{News, Told, Trouble};
use crate::assembly;
use crate::contact::Origin;
use crate::fabricate;
use crate::report::content::{Chapter, Column, Table};
use crate::spec::Subject;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use weavelock_fab::make::{Cavity, Recipe};
use weavelock_fab::mesh::Mesh;
use weavelock_fab::package::{self, Order, PackageReport, Replace};
use weavelock_fab::process::{self, Measured, Overrides, Process};
use weavelock_fab::report::Severity;

#[derive(Serialize)]
struct PackageAnswer<'a> {
    verb: &'a str,
    folder: String,
    #[serde(flatten)]
    package: &'a PackageReport,
}

pub fn fab(placed: &Placed, asked: &Fab, common: &Common) -> Result<Told, Trouble> {
    let cavity = if asked.direct { Cavity::Surroundings(around(placed)?) } else { Cavity::Part };
    let recipe = Recipe {
        cavity,
        gang: asked.gang.into(),
        ..make::recipe(placed, &wish(asked)?, Checkers::of(asked.check))?
    };
    let replace = if asked.force { Replace::Allowed } else { Replace::Never };
    let order = Order { replace, draw: &pictured::draw };
    if asked.check && !common.quiet {
        eprintln!("making the package and asking other programs ...");
    }
    let made = package::pack(&fabricate::job(&placed.joined), &recipe, &order, &asked.out);
    let mut package = made.map_err(|e| Trouble::Word(format!("error: {e}")))?;
    placed_in(&mut package, &asked.out);
    Ok(told(&package, &asked.out))
}

/// Of a woven assembly the cells of the weave beyond its parts; of meshes nothing.
fn around(placed: &Placed) -> Result<Vec<Mesh>, Trouble> {
    let (Subject::Woven(spec), Origin::Woven(woven)) = (&placed.spec.subject, &placed.joined.origin) else {
        return Ok(vec![]);
    };
    let cells = assembly::around::cells(&placed.spec, spec, &woven.pieces)?;
    Ok(cells.map_or(vec![], |cells| fabricate::meshes(&cells)))
}

/// The package of a run, as the spec says; files of an earlier run give way.
pub fn of_run(placed: &Placed, out: &Path) -> Result<Told, Trouble> {
    let recipe = make::recipe(placed, &Wish::default(), Checkers::None)?;
    let order = Order { replace: Replace::Allowed, draw: &pictured::draw };
    let made = package::pack(&fabricate::job(&placed.joined), &recipe, &order, out);
    let mut package = made.map_err(|e| Trouble::Word(format!("error: {e}")))?;
    placed_in(&mut package, out);
    Ok(told(&package, out))
}

fn wish(asked: &Fab) -> Result<Wish, Trouble> {
    let part = |text: &String| match text.split_once('=') {
        Some((id, name)) if !id.is_empty() && !name.is_empty() => Ok((id.to_string(), name.to_string())),
        _ => Err(format!("{text:?} is no part and process\n  hint: as in --part weft-0=silicone-platinum")),
    };
    let mut faults = Vec::new();
    let mut sound = |why: String| faults.push(format!("error: {why}"));
    let parts: Vec<(String, String)> =
        asked.parts.iter().filter_map(|t| part(t).map_err(&mut sound).ok()).collect();
    let measured: Vec<Measured> =
        asked.measured.iter().filter_map(|t| Measured::parse(t).map_err(&mut sound).ok()).collect();
    twice(parts.iter().map(|p| &p.0)).for_each(|id| {
        sound(format!("--part names two processes for {id:?}\n  hint: a part is made by one"));
    });
    twice(measured.iter().map(|m| &m.step)).for_each(|step| {
        sound(format!("--measured gives two lengths after {step:?}\n  hint: give the mean of both bars"));
    });
    let air = clearances(&asked.clearance).unwrap_or_else(|whys| {
        whys.into_iter().for_each(&mut sound);
        Clearances::default()
    });
    if !faults.is_empty() {
        return Err(Trouble::Word(faults.join("\n")));
    }
    Ok(Wish {
        process: asked.process.clone(),
        parts,
        own: Overrides {
            clearance: air.all,
            clearances: air.of,
            measured,
            bed: asked.bed.clone(),
            elephant_foot: asked.elephant_foot,
            flatten: asked.flatten,
            ..Overrides::default()
        },
    })
}

/// What is there more than once, each a single time.
fn twice<'a>(names: impl Iterator<Item = &'a String>) -> impl Iterator<Item = &'a String> {
    let mut count: BTreeMap<&String, usize> = BTreeMap::new();
    names.for_each(|n| *count.entry(n).or_default() += 1);
    count.into_iter().filter(|(_, n)| *n > 1).map(|(name, _)| name)
}

/// Names in the answer are paths that can be opened from here; those in the package's own list are below it.
fn placed_in(package: &mut PackageReport, out: &Path) {
    let from_here = |file: &mut Option<String>| {
        if let Some(name) = file {
            *name = out.join(&*name).display().to_string();
        }
    };
    for part in &mut package.report.parts {
        from_here(&mut part.file);
        from_here(&mut part.obj);
    }
}

fn told(package: &PackageReport, out: &Path) -> Told {
    let news = News::of(package.report.worst() != Some(Severity::Error));
    let answer = PackageAnswer { verb: "fab", folder: out.display().to_string(), package };
    let plates = package.plates.iter().flat_map(|p| p.checks.clone());
    let more: Vec<_> = plates.chain(package.assembly.iter().flat_map(|a| a.checks.clone())).collect();
    let mut chapter = make::fab_chapter(&package.report, out, &more);
    chapter.facts.push(("plates".into(), plates_fact(package)));
    let first = out.join("README.md").display().to_string();
    chapter.facts.push(("read first".into(), first));
    Told::new(news, &answer, &package.report.name, "Package", chapter)
}

fn plates_fact(package: &PackageReport) -> String {
    let grams: f64 = package.plates.iter().filter_map(|p| p.grams).sum();
    let sliced = if grams > 0.0 { format!(", {grams:.1} g of filament as sliced") } else { String::new() };
    format!("{}{sliced}", package.plates.len())
}

#[derive(Serialize)]
struct ProcessesAnswer {
    verb: &'static str,
    processes: Vec<Process>,
    beds: Vec<process::Bed>,
}

/// The list of processes, or the text of one.
pub fn processes(name: Option<&str>) -> Result<Told, Trouble> {
    let wrong = |e: process::ProcessError| Trouble::Word(format!("error: {e}"));
    let names: Vec<&str> = name.map_or_else(|| process::names().collect(), |n| vec![n]);
    let all: Vec<Process> =
        names.iter().map(|n| Process::find(n).map_err(wrong)).collect::<Result<_, _>>()?;
    let answer = ProcessesAnswer { verb: "processes", processes: all.clone(), beds: process::beds() };
    if let Some(text) = name.and_then(process::source) {
        let chapter = Chapter { figure: text.lines().map(String::from).collect(), ..Chapter::default() };
        return Ok(Told { bare: Some(text.to_string()), ..Told::new(News::Good, &answer, "", "", chapter) });
    }
    let row = |p: &Process| {
        let steps = p.steps.iter().map(|s| s.name.as_str()).collect::<Vec<_>>().join(", ");
        vec![
            p.name.clone(),
            p.title.clone(),
            p.clearance.value.to_string(),
            p.least_wall.value.to_string(),
            steps,
        ]
    };
    let head = ["name", "", "air mm", "wall mm", "steps"].map(Column::words).to_vec();
    let rows = all.iter().map(row).collect();
    let caption =
        "Copy one with: weavelock processes NAME > my.toml; then: weavelock fab FILE --process my.toml"
            .into();
    let headline = format!("{} processes come along.", all.len());
    let beds = process::beds().iter().map(|b| b.name.clone()).collect::<Vec<_>>().join(", ");
    let facts = vec![("beds".to_string(), beds)];
    let chapter =
        Chapter { headline, facts, tables: vec![Table { caption, head, rows }], ..Chapter::default() };
    Ok(Told::new(News::Good, &answer, "Processes", "Processes", chapter))
}
