//! Takes an assembly; asks which parts must be flexible, and tells it as a maker would hear it.
//!
//! Not promised: anything beyond what `flex` promises.

use super::args::PuzzleArgs;
use super::args::length;
use super::load::{self, Placed};
use super::questions::argument;
use super::told::{News, Told, Trouble};
use super::words::fact;
use crate::contact::Origin;
use crate::flex::{self, Ask, SAME_VERTEX, WORK, Wanted};
use crate::report::answer::{self, FlexAnswer};
use crate::report::content::{Chapter, Column, Table, Tone};
use crate::spec::Subject;
use crate::watch::Watch;
use clap::Args;
use std::path::PathBuf;
use std::time::{Duration, Instant};

#[derive(Args, Debug)]
pub struct Asked {
    pub file: PathBuf,
    /// Air on each face of a contact, as "0.2 mm": plans for parts made with that clearance
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub clearance: Option<f64>,
    /// Also list larger sets from which no part can be left out
    #[arg(long)]
    pub minimal: bool,
    /// Locks and plans that may be tried, each counted as its parts squared and its contact patches
    #[arg(long, value_name = "N", default_value_t = WORK)]
    pub work: u64,
    /// Stop after this long, as "60 s"; what is found then depends on the machine (--work does not)
    #[arg(long, value_name = "TIME", value_parser = duration)]
    pub time: Option<Duration>,
}

/// How to ask.
pub struct Settings {
    pub clearance_mm: f64,
    pub wanted: Wanted,
    pub work: u64,
    pub time: Option<Duration>,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings { clearance_mm: 0.0, wanted: Wanted::Smallest, work: WORK, time: None }
    }
}

fn duration(text: &str) -> Result<Duration, String> {
    let hint = || "write a time with its unit, as \"60 s\" or \"5 min\"".to_string();
    let at = text.find(|c: char| c.is_alphabetic()).ok_or_else(hint)?;
    let number: f64 = text[..at].trim().parse().map_err(|_| hint())?;
    let seconds = match text[at..].trim() {
        "s" => number,
        "min" => 60.0 * number,
        "h" => 3600.0 * number,
        _ => return Err(hint()),
    };
    Duration::try_from_secs_f64(seconds).map_err(|_| hint())
}

pub fn flex(asked: &Asked, puzzle: &PuzzleArgs, watch: &Watch) -> Result<Told, Trouble> {
    let placed = load::spec(&asked.file, puzzle, watch)?.joined()?;
    let wanted = if asked.minimal { Wanted::Minimal } else { Wanted::Smallest };
    let clearance_mm = asked.clearance.unwrap_or(0.0);
    let settings = Settings { clearance_mm, wanted, work: asked.work, time: asked.time };
    Ok(told(&flexed(&placed, &settings)?))
}

pub fn flexed(placed: &Placed, settings: &Settings) -> Result<FlexAnswer, Trouble> {
    let joined = &placed.joined;
    let within = match (&joined.origin, &placed.spec.subject) {
        (Origin::Meshes, Subject::Meshes(m)) => m.tolerance_mm / m.mm_per_unit,
        _ => SAME_VERTEX,
    };
    let ask = Ask {
        clearance: settings.clearance_mm / joined.assembly.mm_per_unit,
        wanted: settings.wanted,
        work: settings.work,
        until: settings.time.and_then(|t| Instant::now().checked_add(t)),
        within,
    };
    let found = flex::flex_watched(joined.touching(), &ask, &placed.watch).map_err(|why| {
        argument(
            format!("not searched: {why}"),
            "flexible parts are found by plans, and plans need parts made of convex cells, thicker than the air".into(),
        )
    })?;
    Ok(answer::flex(joined, &found, &ask, placed.source.clone()))
}

pub fn told(answer: &FlexAnswer) -> Told {
    let news = News::of(answer.minimum.is_some());
    Told {
        remarks: answer.remarks.clone(),
        ..Told::new(news, answer, &answer.name, "Flexible parts", chapter(answer))
    }
}

fn chapter(a: &FlexAnswer) -> Chapter {
    let tone = if a.minimum.is_some() { Tone::Good } else { Tone::Undecided };
    Chapter {
        tone,
        headline: headline(a),
        words: words(a),
        facts: facts(a),
        tables: tables(a),
        ..Chapter::default()
    }
}

fn headline(a: &FlexAnswer) -> String {
    match (a.minimum, a.upper_bound) {
        (Some(0), _) => "No part needs to be flexible: all go together rigidly.".to_string(),
        (Some(1), _) => "One flexible part is needed, and is enough.".to_string(),
        (Some(n), _) => format!("{n} flexible parts are needed, and are enough."),
        (None, upper) => {
            format!("Between {} and {upper} flexible parts: the bounds do not meet.", a.lower_bound)
        }
    }
}

/// Sets and cores named in words; JSON has all.
const MOST_NAMED: usize = 8;

fn words(a: &FlexAnswer) -> Vec<String> {
    let mut words = Vec::new();
    if let Some(first) = a.orbits.first().filter(|o| !o.set.is_empty()) {
        let parts = a.symmetries.first().map_or(0, |s| s.to.len());
        words.push(format!(
            "Make {} flexible (cast in silicone, say); the other {} go together rigid in {} moves, and the \
             flexible ones are bent in whenever they fit.",
            first.set.join(" and "),
            parts.saturating_sub(first.set.len()),
            first.plan.steps.len()
        ));
    }
    if let Some(core) = a.cores.first() {
        let few = match a.lower_bound {
            0 | 1 => String::new(),
            2 => ", and no single part lies in all of them".to_string(),
            n => format!(", and no {} parts meet them all", n - 1),
        };
        words.push(format!(
            "Why no fewer: {} sub-assemblies are locked by themselves, such as {} ({} contact forces in balance). One part \
             of each must bend{few}.",
            a.cores.len(),
            core.parts.join(", "),
            core.certificate.forces.len(),
        ));
    }
    if !a.unproven.is_empty() {
        words.push(format!(
            "Sets that no plan took apart though they are not proven locked: {}. Straight moves of parts and groups were \
             tried, turns and moves in stages were not.",
            a.unproven.len()
        ));
    }
    if !a.doubtful.is_empty() {
        words.push(format!(
            "Sets that are locked as written, but not shown to be whatever the files' digits leave open of their contacts: {}. \
             No bound rests on them.",
            a.doubtful.len()
        ));
    }
    if a.clearance_mm > 0.0 {
        words.push(format!(
            "With {} mm of air on each face nothing is locked to first order: the upper number is a plan's, the lower \
             one is 0 because no lock was proven.",
            a.clearance_mm
        ));
    }
    words
}

fn facts(a: &FlexAnswer) -> Vec<(String, String)> {
    let all = match a.listed.as_str() {
        "complete" => "all are listed",
        "smallest-complete" => "all of the least size are listed, larger ones may be missing",
        "time" => "more may exist: the time was up",
        "stopped" => "more may exist: the user stopped it",
        "many" => "more may exist: too many to list",
        _ => "more may exist: the work allowed was spent",
    };
    let mut facts =
        vec![fact("bounds", format!("{} proven, {} shown to be enough", a.lower_bound, a.upper_bound))];
    if a.upper_bound > 0 {
        let orbits = a.orbits.iter().filter(|o| o.set.len() == a.upper_bound).count();
        facts.push(fact("smallest sets", format!("{}, {orbits} up to symmetry; {all}", a.sets.len())));
    }
    facts.push(fact("symmetries", format!("{} isometries carry the assembly to itself", a.symmetries.len())));
    facts.push(fact("locked cores", a.cores.len().to_string()));
    facts.push(fact(
        "work",
        format!("{} (parts squared and contacts, over all locks and plans tried)", a.work),
    ));
    facts
}

fn tables(a: &FlexAnswer) -> Vec<Table> {
    let row =
        |o: &answer::OrbitAnswer| vec![o.set.len().to_string(), o.all.len().to_string(), o.set.join(" + ")];
    let sets = Table {
        caption: "Sets that are enough, one of each orbit".into(),
        head: vec![Column::numbers("parts"), Column::numbers("alike"), Column::words("set")],
        rows: a.orbits.iter().filter(|o| !o.set.is_empty()).take(MOST_NAMED).map(row).collect(),
    };
    let cores = Table {
        caption: "Locked by themselves: one of each must give".into(),
        head: vec![Column::numbers("parts"), Column::numbers("forces"), Column::words("core")],
        rows: a.cores.iter().take(MOST_NAMED).map(core).collect(),
    };
    [sets, cores].into_iter().filter(|t| !t.rows.is_empty()).collect()
}

fn core(c: &answer::CoreAnswer) -> Vec<String> {
    vec![c.parts.len().to_string(), c.certificate.forces.len().to_string(), c.parts.join(", ")]
}
