//! Takes an assembly and what was asked about blocking; finds the graphs, writes the files asked for, tells the answer.
//!
//! Not promised: anything beyond what `blocking` promises.

use super::load::Placed;
use super::told::{News, Told, Trouble};
use crate::assembly::Mobility;
use crate::blocking::Touch;
use crate::blocking::graph::{self, Dbg, infinitesimal, pairs, tie};
use crate::blocking::ndbg::{Ndbg, NotRun, Reach, ndbg_watched};
use crate::blocking::shadow::{Shapes, View};
use crate::contact::Joined;
use crate::report::answer::{self, BlockingAnswer, Connected, DbgAnswer, Found};
use crate::report::content::{Chapter, Tone};
use crate::report::draw::sphere;
use crate::report::file::write_whole;
use crate::report::graphs;
use clap::Args;
use glam::DVec3;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub struct Blocking {
    pub file: PathBuf,
    /// The graph of this one direction (any length): `--direction 0,0,1`
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true)]
    pub direction: Option<DVec3>,
    /// What stops the very start of a motion (the default)
    #[arg(long, conflicts_with = "finite")]
    pub infinitesimal: bool,
    /// What stops a part on its whole way to infinity
    #[arg(long)]
    pub finite: bool,
    /// Write the graphs as DOT
    #[arg(long, value_name = "FILE")]
    pub dot: Option<PathBuf>,
    /// Write the graphs as GraphML
    #[arg(long, value_name = "FILE")]
    pub graphml: Option<PathBuf>,
    /// Draw the cells on the sphere of directions: PNG by the file's ending, else SVG
    #[arg(long, value_name = "FILE")]
    pub sphere: Option<PathBuf>,
}

/// Three numbers, not all zero; the unit vector along them.
pub(super) fn direction(text: &str) -> Result<DVec3, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|t| t.trim().parse::<f64>()).collect();
    let wrong = || "give three numbers that are not all zero, as 0,0,1".to_string();
    let numbers: [f64; 3] = numbers.map_err(|_| wrong())?.try_into().map_err(|_| wrong())?;
    let d = DVec3::from_array(numbers);
    let scale = d.abs().max_element();
    if !(scale > 0.0 && d.is_finite()) {
        return Err(wrong());
    }
    Ok((d / scale).normalize())
}

pub fn blocking(placed: &Placed, asked: &Blocking) -> Result<Told, Trouble> {
    let joined = &placed.joined;
    let reach = if asked.finite { Reach::Finite } else { Reach::Infinitesimal };
    let (one, not_run) = match asked.direction.map(|d| along(joined, d, reach)) {
        Some(Err(why)) => (None, Some(why)),
        found => (found.and_then(Result::ok), None),
    };
    let all = (asked.direction.is_none() || asked.sphere.is_some())
        .then(|| ndbg_watched(joined.touching(), reach, &placed.watch));
    let found = Found { reach, dbg: one, ndbg: all.as_ref(), not_run };
    let answer = answer::blocking(joined, found, placed.source.clone());
    write(asked, &answer, all.as_ref())?;
    Ok(told(&answer))
}

/// The graph of one direction, by the patches and by sweeps of the cells (not by the arrangement).
pub(super) fn along(joined: &Joined, d: DVec3, reach: Reach) -> Result<DbgAnswer, String> {
    let asm = &joined.assembly;
    let parts: Vec<_> = asm.ids().collect();
    let held = |p| asm.part(p).mobility == Mobility::Held;
    let mut plain = infinitesimal(&parts, &joined.patches, &pairs(&joined.patches), d);
    plain.retain_edges(|g, e| g.edge_endpoints(e).is_none_or(|(i, j)| !(held(g[i]) && held(g[j]))));
    if reach == Reach::Finite {
        if let Some(p) = asm.parts.iter().find(|p| asm.solids[p.solid].cells.is_empty()) {
            return Err(NotRun::NoCells(p.id.clone()).to_string());
        }
        let shapes = Shapes::of(asm);
        let known: Dbg = plain.clone();
        let both_held = |i, j| held(known[i]) && held(known[j]);
        let new = |i, j| !(known.contains_edge(i, j) || both_held(i, j));
        graph::stop_later(&mut plain, &View::new(&shapes, d), Touch::of(asm), new);
    }
    let mut tied = plain.clone();
    tie(&mut tied, held);
    Ok(answer::dbg(asm, d.to_array(), &plain, &tied))
}

fn write(
    asked: &Blocking,
    answer: &BlockingAnswer,
    all: Option<&Result<Ndbg, NotRun>>,
) -> Result<(), Trouble> {
    let trouble = |e: std::io::Error| Trouble::Word(format!("error: {e}"));
    let missing = |path: &Path| {
        let why = answer.not_run.as_deref().unwrap_or("nothing was found");
        Trouble::Word(format!("error: {} is not written: {why}", path.display()))
    };
    let graphs = graphs::graphs(answer);
    let mut files: Vec<(&Path, Vec<u8>)> = Vec::new();
    if let Some(path) = &asked.dot {
        files.push((path, graphs::dot(&graphs).into_bytes()));
    }
    if let Some(path) = &asked.graphml {
        files.push((path, graphs::graphml(&graphs).map_err(trouble)?));
    }
    if let Some((path, _)) = files.iter().find(|_| graphs.is_empty()) {
        return Err(missing(path));
    }
    if let Some(path) = &asked.sphere {
        let Some(Ok(ndbg)) = all else { return Err(missing(path)) };
        let sheet = sphere::sheet(ndbg, &answer.name);
        let png = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png"));
        files.push((path, if png { sheet.png().map_err(trouble)? } else { sheet.svg().into_bytes() }));
    }
    for (path, bytes) in files {
        write_whole(path, &bytes)?;
    }
    Ok(())
}

fn told(answer: &BlockingAnswer) -> Told {
    let news = News::of(answer.not_run.is_none());
    let title = answer.name.clone();
    Told {
        remarks: answer.remarks.clone(),
        ..Told::new(news, answer, &title, "Who stops whom", chapter(answer))
    }
}

fn chapter(answer: &BlockingAnswer) -> Chapter {
    let mut facts = Vec::new();
    let mut fact = |name: &str, value: String| facts.push((name.to_string(), value));
    fact(
        "reach",
        if answer.reach == answer::ReachWord::Finite {
            "on the whole way".into()
        } else {
            "at the very start".to_string()
        },
    );
    if let Some(dbg) = &answer.dbg {
        let [x, y, z] = dbg.direction;
        fact("direction", format!("{x:.6}, {y:.6}, {z:.6}"));
        fact(
            "arcs",
            dbg.arcs.iter().map(|a| format!("{} -> {}", a.from, a.to)).collect::<Vec<_>>().join(", "),
        );
        fact("can leave", leavers(&dbg.leave));
        fact("strongly connected", listed(&dbg.components));
    }
    let (tone, headline) = headline(answer);
    let mut words = Vec::new();
    let mut tables = Vec::new();
    if let Some(ndbg) = &answer.ndbg {
        let of = |dimension| ndbg.cells.iter().filter(|c| c.dimension == dimension).count();
        fact(
            "cells of the sphere",
            format!("{} patches, {} arcs, {} single directions", of(2), of(1), of(0)),
        );
        let connected = ndbg.graphs.iter().filter(|g| g.components.len() == 1).count();
        fact("distinct graphs", format!("{}, {connected} of them strongly connected", ndbg.graphs.len()));
        fact(
            "resolution",
            format!(
                "{:.1e} rad: directions nearer to one another count as one; those that do differ by {:.1e} at most",
                ndbg.resolution, ndbg.merged
            ),
        );
        words.push("Strongly connected along every direction is less than locked: parts that move in different directions at once are not seen.".into());
        tables.extend(table(ndbg));
    }
    if let Some(why) = &answer.not_run {
        fact("not run", why.clone());
    }
    Chapter { tone, headline, words, facts, tables, ..Chapter::default() }
}

fn headline(answer: &BlockingAnswer) -> (Tone, String) {
    match (answer.strongly_connected, &answer.dbg) {
        (Connected::Everywhere, _) => (
            Tone::Plain,
            "Along every direction all parts are tied into one strongly connected component.".into(),
        ),
        (Connected::NotEverywhere, _) => {
            (Tone::Plain, "Along some directions the parts are not all tied together.".into())
        }
        (Connected::NotRun, Some(dbg)) if dbg.components.len() == 1 => {
            (Tone::Plain, "Along this direction all parts are tied together.".into())
        }
        (Connected::NotRun, Some(_)) => {
            (Tone::Plain, "Along this direction the parts are not all tied together.".into())
        }
        (Connected::NotRun, None) => (Tone::Undecided, "Not run.".into()),
    }
}

fn leavers(sets: &[Vec<String>]) -> String {
    if sets.is_empty() { "none".into() } else { listed(sets) }
}

fn listed(sets: &[Vec<String>]) -> String {
    sets.iter().map(|s| s.join(" + ")).collect::<Vec<_>>().join("; ")
}

/// Cells whose graph lets something leave, as many as a reader takes in.
const MOST_ROWS: usize = 24;

fn table(ndbg: &answer::NdbgAnswer) -> Option<crate::report::content::Table> {
    use crate::report::content::{Column, Table};
    let free: Vec<_> = ndbg.cells.iter().filter(|c| !ndbg.graphs[c.graph].leave.is_empty()).collect();
    let row = |c: &&answer::CellAnswer| {
        let kind = ["alone", "arc", "patch"][usize::from(c.dimension.min(2))];
        let numbers = c.direction.map(|v| format!("{:.4}", if v.abs() < 5e-5 { 0.0 } else { v }));
        [&numbers[..], &[kind.to_string(), leavers(&ndbg.graphs[c.graph].leave)]].concat()
    };
    let more = if free.len() > MOST_ROWS {
        format!(" (the first {MOST_ROWS} of {})", free.len())
    } else {
        String::new()
    };
    (!free.is_empty()).then(|| Table {
        caption: format!("Directions along which a set can leave{more}"),
        head: ["x", "y", "z"]
            .map(Column::numbers)
            .into_iter()
            .chain(["cell", "smallest sets"].map(Column::words))
            .collect(),
        rows: free.iter().take(MOST_ROWS).map(row).collect(),
    })
}
