//! Takes an answer of `repeats`; gives the chapter that says it in words and tables.
//!
//! Not promised: a word more than the answer carries.

use super::words::fact;
use crate::report::answer::Word;
use crate::report::answer::repeats::{CaseAnswer, ClassAnswer, ProfileAnswer, RepeatsAnswer, RepeatsRow};
use crate::report::content::{Chapter, Column, Table, Tone};

pub fn chapter(a: &RepeatsAnswer) -> Chapter {
    let (tone, headline) = headline(a);
    let made = a.table.iter().any(|r| r.as_made.is_some());
    let mut tables = vec![cases(&a.cases), swatches(&a.table, made)];
    let profiles = a.cases.iter().any(|c| c.profile != a.cases[0].profile);
    match (profiles, a.cases.len() > 1 || a.cases.iter().any(|c| c.phases.len() > 1)) {
        // The table of swatches names no profile: JSON has all rows.
        (true, _) => drop(tables.pop()),
        (false, true) => {}
        (false, false) => drop(tables.remove(0)),
    }
    if !a.every_size.is_empty() {
        tables.push(classes(&a.every_size));
    }
    Chapter { tone, headline, words: words(a), facts: facts(a), tables, ..Chapter::default() }
}

fn headline(a: &RepeatsAnswer) -> (Tone, String) {
    let clearance = a.table.iter().find_map(|r| r.as_made.as_ref());
    let undecided = a.table.iter().any(|r| r.rigid == Word::Undecided);
    match (a.minimal_repeat, clearance) {
        (Some(1), _) => (Tone::Good, format!("Unit tiles of {} lock by themselves.", a.weave)),
        (Some(k), _) => {
            (Tone::Good, format!("Tiles of {} lock when {k} periods are joined in one piece.", a.weave))
        }
        (None, Some(made)) => at_clearance(a, made.clearance_mm),
        (None, None) if undecided => {
            (Tone::Undecided, "Undecided: some swatch carries neither proof.".into())
        }
        (None, None) => (Tone::Bad, format!("No repetition up to {} locks.", a.searched)),
    }
}

fn at_clearance(a: &RepeatsAnswer, mm: f64) -> (Tone, String) {
    let from: Option<Vec<u32>> = a.cases.iter().map(|c| c.no_plan_from).collect();
    let Some(k) = from.and_then(|f| f.into_iter().max()) else {
        return (Tone::Bad, format!("With {mm} mm on each face they come apart up to k = {}.", a.searched));
    };
    let below = if k > 1 { format!("up to k = {} they come apart; ", k - 1) } else { String::new() };
    let what =
        format!("With {mm} mm on each face: {below}from k = {k} on no plan was found, which proves nothing.");
    (Tone::Undecided, what)
}

/// What a weaver would say, once for each piece that comes loose, in the first rows that are free.
fn words(a: &RepeatsAnswer) -> Vec<String> {
    let mut words = Vec::new();
    for row in a.table.iter().filter(|r| r.rigid == Word::Free).take(MOST_TOLD) {
        let name = |w: &str| format!("k = {}, phase {}, {}: {w}.", row.k, row.phase, size(row));
        words.extend(row.loose.iter().take(1).map(|l| name(&l.words)));
    }
    words.push("The answer is about these swatches; one of another size or cut may have another.".into());
    if let Some(c) = a.every_size.first() {
        words.push(format!(
            "Every size: a class stands for all swatches with {} more wefts or {} more warps, any number of times; two \
             locked swatches that share a part are locked together.",
            c.step[0], c.step[1]
        ));
    }
    words
}

/// Rows that are explained in the text; JSON has all.
const MOST_TOLD: usize = 6;

fn facts(a: &RepeatsAnswer) -> Vec<(String, String)> {
    let least = |locked: bool| {
        let rows = a.table.iter().filter(move |r| (r.rigid == Word::Locked) == locked);
        let values: Vec<usize> = rows.map(|r| r.least_interlacing).collect();
        let (lo, hi) = (values.iter().min(), values.iter().max());
        lo.zip(hi).map(|(lo, hi)| if lo == hi { lo.to_string() } else { format!("{lo} to {hi}") })
    };
    let name = |word: &str| format!("fewest changes of side, {word}");
    let rows = [("locked", least(true)), ("not locked", least(false))];
    rows.into_iter().filter_map(|(w, v)| Some(fact(&name(w), v?))).collect()
}

fn size(row: &RepeatsRow) -> String {
    format!("{} x {}", row.swatch.wefts, row.swatch.warps)
}

fn number(v: Option<u32>, searched: u32) -> String {
    v.map_or(format!("none to {searched}"), |k| k.to_string())
}

fn profile(p: &ProfileAnswer) -> [String; 4] {
    let rise = p.rise.map_or("points".into(), |r| r.to_string());
    [rise, p.lift.to_string(), p.cover.to_string(), p.samples.to_string()]
}

fn cases(all: &[CaseAnswer]) -> Table {
    let row = |c: &CaseAnswer| {
        let by = c.phases.iter().zip(&c.by_phase);
        let by: Vec<String> =
            by.map(|(p, k)| format!("{p}: {}", k.map_or("-".into(), |k| k.to_string()))).collect();
        let head = vec![format!("{} x {}", c.swatch.wefts, c.swatch.warps)];
        let least = [number(c.minimal_repeat, c.searched), by.join(", ")];
        head.into_iter().chain(profile(&c.profile)).chain(least).collect()
    };
    Table {
        caption: "Least k for each swatch (wefts x warps) and profile; by phase".into(),
        head: vec![
            Column::words("swatch"),
            Column::numbers("rise"),
            Column::numbers("lift"),
            Column::numbers("cover"),
            Column::numbers("samples"),
            Column::numbers("least k"),
            Column::words("phase: k"),
        ],
        rows: all.iter().map(row).collect(),
    }
}

fn swatches(table: &[RepeatsRow], made: bool) -> Table {
    let row = |r: &RepeatsRow| {
        let mut cells = vec![
            r.k.to_string(),
            r.phase.to_string(),
            size(r),
            word(r.translation).into(),
            word(r.rigid).into(),
            r.least_interlacing.to_string(),
        ];
        cells.extend(r.as_made.as_ref().filter(|_| made).map(|m| m.verdict.clone()));
        cells.push(r.witness.clone());
        cells
    };
    let mut head = vec![Column::numbers("k"), Column::numbers("phase"), Column::words("swatch")];
    head.extend(["translation", "rigid"].map(Column::words));
    head.push(Column::numbers("sides"));
    head.extend(made.then(|| Column::words("as made")));
    head.push(Column::words("witness"));
    Table {
        caption: "Swatches tried (wefts x warps); sides: fewest changes of side among the pieces".into(),
        head,
        rows: table.iter().map(row).collect(),
    }
}

fn classes(all: &[ClassAnswer]) -> Table {
    let row = |c: &ClassAnswer| {
        vec![
            format!("{} + {} i", c.base.swatch.wefts, c.step[0]),
            format!("{} + {} j", c.base.swatch.warps, c.step[1]),
            c.base.k.to_string(),
            c.base.phase.to_string(),
            c.holds.clone(),
            c.uncrossed.as_ref().map_or(String::new(), |s| format!("nothing crosses {s}")),
        ]
    };
    Table {
        caption: "Swatches of every size, i and j from 0 on".into(),
        head: vec![
            Column::numbers("wefts"),
            Column::numbers("warps"),
            Column::numbers("k"),
            Column::numbers("phase"),
            Column::words("all of them"),
            Column::words(""),
        ],
        rows: all.iter().map(row).collect(),
    }
}

fn word(w: Word) -> &'static str {
    match w {
        Word::Locked => "locked",
        Word::Free => "free",
        Word::Undecided => "undecided",
    }
}
