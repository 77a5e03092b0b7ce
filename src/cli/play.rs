//! Takes an assembly and a clearance; tells how far its parts shift and tilt.
//!
//! Not promised: anything beyond what `play` promises of first order, and what was followed of it.

use super::args::{PuzzleArgs, length};
use super::load::{self, Placed};
use super::questions::{argument, part};
use super::told::{News, Told, Trouble};
use crate::assembly::PartIx;
use crate::play::{self, Extreme, Reach};
use crate::report::answer::{self, AxisPlay, Followed, PlayAnswer, PlayWord};
use crate::report::content::{Chapter, Column, Table, Tone};
use crate::sequence::clearance::with_clearance;
use crate::verify::follow::followed;
use crate::watch::{All, Watch};
use clap::Args;
use rayon::prelude::*;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub struct Asked {
    pub file: PathBuf,
    /// Air on each face of a contact, as "0.2 mm"
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub clearance: f64,
    /// Only these parts (all others still give way): `--of weft-0,warp-1`
    #[arg(long, value_name = "PARTS", value_delimiter = ',')]
    pub of: Vec<String>,
}

pub fn play(asked: &Asked, puzzle: &PuzzleArgs, watch: &Watch) -> Result<Told, Trouble> {
    let placed = load::spec(&asked.file, puzzle, watch)?.joined()?;
    if asked.clearance <= 0.0 {
        let hint = "give the air that the parts are made with, as --clearance \"0.2 mm\"".to_string();
        return Err(argument(format!("{} mm of air leave no play", asked.clearance), hint).into());
    }
    let of = asked.of.iter().map(|id| part(&placed.joined, id.trim())).collect::<Result<Vec<_>, _>>()?;
    Ok(told(&played(&placed, &of, asked.clearance)?))
}

/// Play of these parts, of all where none is named.
pub fn played(placed: &Placed, of: &[PartIx], clearance_mm: f64) -> Result<PlayAnswer, Trouble> {
    let asm = &placed.joined.assembly;
    let held: Vec<PartIx> = asm.held().collect();
    let still = if held.is_empty() { vec![PartIx(0)] } else { held };
    let all: Vec<PartIx> = asm.ids().collect();
    let of = if of.is_empty() { &all[..] } else { of };
    let found =
        play::play_watched(asm, &placed.joined.patches, of, &still, &placed.watch).map_err(|why| {
            argument(format!("not searched: {why}"), "name some parts: --of weft-0,warp-1".into())
        })?;
    let found = follow(placed, found, clearance_mm);
    let stopped = placed.watch.is_stopped().then(|| stopped(&found));
    Ok(PlayAnswer {
        verb: "play".into(),
        name: asm.name.clone(),
        outcome: answer::play_word(&found),
        clearance_mm,
        fit_mm: 2.0 * clearance_mm,
        still: answer::ids(asm, &still),
        parts: answer::play(asm, &found, clearance_mm),
        stopped: stopped.is_some(),
        remarks: placed.joined.remarks.iter().cloned().chain(stopped).collect(),
        source: placed.source.clone(),
    })
}

/// What to say where the user stopped it.
fn stopped(found: &[Followed]) -> String {
    let solved = found.iter().filter(|f| !matches!(f.extreme.reach, Reach::Unsolved { .. })).count();
    format!("stopped by the user after {solved} of {} programs", found.len())
}

/// How far the solids as made follow each extreme; nothing where there are no such solids.
fn follow(placed: &Placed, found: Vec<Extreme>, clearance_mm: f64) -> Vec<Followed> {
    let (asm, patches) = (&placed.joined.assembly, &placed.joined.patches);
    let clearance = clearance_mm / asm.mm_per_unit;
    let Ok(made) = with_clearance(asm, patches, clearance) else {
        return found.into_iter().map(|extreme| Followed { extreme, share: None }).collect();
    };
    let share = |e: &Extreme| match &e.reach {
        Reach::Held { twists, .. } => followed(&made, twists, 2.0 * clearance),
        Reach::Endless { .. } | Reach::Unsolved { .. } => None,
    };
    let stage = placed.watch.stage("following them", "motions", All::Just(found.len() as u64));
    let followed = |extreme: Extreme| {
        let share = if placed.watch.is_stopped() { None } else { share(&extreme) };
        stage.add(1);
        Followed { share, extreme }
    };
    found.into_par_iter().map(followed).collect()
}

pub fn told(a: &PlayAnswer) -> Told {
    let news = News::of(a.outcome == PlayWord::Bounded);
    Told { remarks: a.remarks.clone(), ..Told::new(news, a, &a.name, "Play", chapter(a)) }
}

fn chapter(a: &PlayAnswer) -> Chapter {
    let (tone, headline) = match a.outcome {
        PlayWord::Bounded => (Tone::Good, bounded(a)),
        PlayWord::Loose => {
            (Tone::Bad, "Loose: some part is not held, however little air there is.".to_string())
        }
        PlayWord::Undecided => (Tone::Undecided, "Undecided: some program was not solved.".to_string()),
    };
    Chapter {
        tone,
        headline,
        words: vec![
            "First order: the farthest that each part gets while all others give way; behind it what the solids as \
             made were followed to without an overlap."
                .into(),
        ],
        facts: vec![
            ("clearance".into(), format!("{} mm on each face, {} mm between two", a.clearance_mm, a.fit_mm)),
            ("measured against".into(), a.still.join(", ")),
        ],
        tables: vec![
            table("shift, mm", a, |p| &p.shift),
            table("tilt, degrees", a, |p| &p.tilt),
        ],
        ..Chapter::default()
    }
}

fn bounded(a: &PlayAnswer) -> String {
    let most = |list: fn(&answer::PartPlay) -> &Vec<AxisPlay>| {
        a.parts.iter().flat_map(list).filter_map(|p| p.first_order).fold(0.0, f64::max)
    };
    let (shift, tilt) = (most(|p| &p.shift), most(|p| &p.tilt));
    format!("Held: no part shifts by more than {shift:.3} mm or tilts by more than {tilt:.2} degrees.")
}

fn table(caption: &str, a: &PlayAnswer, of: fn(&answer::PartPlay) -> &Vec<AxisPlay>) -> Table {
    let ways = ["+x", "-x", "+y", "-y", "+z", "-z"];
    let head = std::iter::once(Column::words("part")).chain(ways.map(Column::numbers)).collect();
    let cell = |p: &AxisPlay| match (p.first_order, p.followed) {
        (Some(v), Some(f)) => format!("{v:.3} ({f:.3})"),
        (Some(v), None) => format!("{v:.3}"),
        (None, _) => p.why.clone().unwrap_or_default(),
    };
    let row = |p: &answer::PartPlay| std::iter::once(p.part.clone()).chain(of(p).iter().map(cell)).collect();
    Table { caption: caption.into(), head, rows: a.parts.iter().map(row).collect() }
}
