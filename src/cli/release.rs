//! Takes an assembly; tells how much clearance releases its lock, and what a process does to that.
//!
//! Not promised: anything beyond what `release` and the planner promise.

use super::args::PuzzleArgs;
use super::load::{self, Placed};
use super::questions::{locked, planned, planned_by};
use super::told::{News, Told, Trouble};
use super::words::fact;
use crate::assembly::PartIx;
use crate::release::{At, bracket, range};
use crate::report::answer::{
    self, BracketAnswer, Length, PlanAnswer, ProcessRelease, ReleaseAnswer, ReleaseWord, Sealed,
};
use crate::report::content::{Chapter, Column, Table, Tone};
use crate::sequence::clearance::with_clearance;
use crate::sequence::{Motions, Outcome};
use crate::verify;
use crate::watch::{All, Watch};
use clap::Args;
use std::path::PathBuf;
use weavelock_fab::process::Process;

#[derive(Args, Debug)]
pub struct Asked {
    pub file: PathBuf,
    /// Say whether this process opens the lock: `--process fdm-pla`, `--process my.toml`
    #[arg(long, value_name = "NAME|FILE")]
    pub process: Option<String>,
}

pub fn release(asked: &Asked, puzzle: &PuzzleArgs, watch: &Watch) -> Result<Told, Trouble> {
    let placed = load::spec(&asked.file, puzzle, watch)?.joined()?;
    let wrong = |e: weavelock_fab::process::ProcessError| Trouble::Word(format!("error: {e}"));
    let process = asked.process.as_deref().map(Process::find).transpose().map_err(wrong)?;
    let process = process.map(|p| (p.name, p.clearance.value));
    let answer = released(&placed, process);
    Ok(told(&answer))
}

pub fn released(placed: &Placed, process: Option<(String, f64)>) -> ReleaseAnswer {
    let joined = &placed.joined;
    let all: Vec<PartIx> = joined.assembly.ids().collect();
    let zero = locked(joined, &all);
    let none = if zero.is_some() { None } else { Some(planned(placed, &all, 0.0)) };
    let brackets = match none.filter(|p| p.plan.outcome == Outcome::Assembled) {
        Some(plan) => vec![answer::needs_none(joined, plan)],
        None => MOTIONS
            .map(|(motions, words)| {
                answer::bracket(joined, words, &searched(placed, &all, motions), zero.as_ref())
            })
            .to_vec(),
    };
    let best = brackets.iter().filter_map(|b| b.hi).map(|h| h.clearance_mm).fold(f64::INFINITY, f64::min);
    let tried: usize = brackets.iter().map(|b| b.tried.iter().filter(|t| t.1 != "stopped").count()).sum();
    let stopped = placed.watch.is_stopped().then(|| format!("stopped by the user after {tried} clearances"));
    let answer = ReleaseAnswer {
        verb: "release".into(),
        name: joined.assembly.name.clone(),
        outcome: match best {
            0.0 => ReleaseWord::NeedsNone,
            b if b.is_finite() => ReleaseWord::Opens,
            _ => ReleaseWord::NotFound,
        },
        certificate: zero,
        process: process.map(|(name, mm)| at_process(&brackets, name, mm)),
        brackets,
        stopped: stopped.is_some(),
        remarks: joined.remarks.iter().cloned().chain(stopped).collect(),
        source: placed.source.clone(),
        checksum: String::new(),
    };
    ReleaseAnswer { checksum: answer::checksum(&answer), ..answer }
}

/// Without rotations, and with them.
const MOTIONS: [(Motions, &str); 2] = [
    (Motions::Straight, "straight moves"),
    (Motions::Any, "straight moves, stops half way, turns, several at once"),
];

fn searched(placed: &Placed, all: &[PartIx], motions: Motions) -> crate::release::Bracket<PlanAnswer> {
    let (asm, patches) = (&placed.joined.assembly, &placed.joined.patches);
    let stage = placed.watch.stage("clearances", "", All::Open);
    let tried = std::cell::Cell::new(0);
    bracket(range(asm), |clearance| {
        tried.set(tried.get() + 1);
        stage.reach(tried.get());
        let mm = clearance * asm.mm_per_unit;
        let _stage = placed.watch.stage(format!("the {}., {mm:.3} mm", tried.get()), "", All::Open);
        if placed.watch.is_stopped() {
            return At::Stopped;
        }
        if let Err(why) = with_clearance(asm, patches, clearance) {
            return At::Gone(why.to_string());
        }
        let plan = planned_by(placed, all, mm, motions);
        if plan.plan.stopped {
            return At::Stopped;
        }
        if plan.plan.outcome != Outcome::Assembled {
            return At::NotFound(left(&plan));
        }
        match verify::answer(&Sealed::Plan(Box::new(plan.clone()))) {
            Ok(v) if v.valid => At::Apart(plan),
            Ok(v) => At::NotFound(format!("a plan was found, but not confirmed: {}", v.why)),
            Err(why) => At::NotFound(format!("a plan was found, but not confirmed: {why}")),
        }
    })
}

fn left(plan: &PlanAnswer) -> String {
    let stuck: Vec<String> = plan.plan.stuck.iter().map(|s| s.parts.len().to_string()).collect();
    let s = plan.plan.searched;
    let of = if stuck.is_empty() { "none".to_string() } else { stuck.join(" and ") };
    format!("{of} parts stayed together after {} directions in {} sets", s.directions, s.sets)
}

fn at_process(brackets: &[BracketAnswer], process: String, clearance_mm: f64) -> ProcessRelease {
    let hi = brackets.iter().filter_map(|b| b.hi).map(|h| h.clearance_mm).fold(f64::INFINITY, f64::min);
    let lo = brackets.iter().map(|b| b.lo.clearance_mm).fold(f64::INFINITY, f64::min);
    let lock = match () {
        () if clearance_mm >= hi => "opens",
        () if !hi.is_finite() => "unknown",
        () if clearance_mm <= lo => "stays",
        () => "between",
    };
    ProcessRelease {
        process,
        clearance_mm,
        lock: lock.into(),
        lacking_mm: hi.is_finite().then(|| (hi - clearance_mm).max(0.0)),
        shrinkage: "made up for by the allowance; what is left over scales all parts alike and opens nothing"
            .into(),
    }
}

pub fn told(a: &ReleaseAnswer) -> Told {
    let news = News::of(a.outcome != ReleaseWord::NotFound);
    Told { remarks: a.remarks.clone(), ..Told::new(news, a, &a.name, "Release clearance", chapter(a)) }
}

fn chapter(a: &ReleaseAnswer) -> Chapter {
    let (tone, headline) = match a.outcome {
        ReleaseWord::NeedsNone => {
            (Tone::Good, "It comes apart as it is: no clearance is needed.".to_string())
        }
        ReleaseWord::NotFound => {
            (Tone::Undecided, "No clearance was found that opens it; that proves nothing.".to_string())
        }
        ReleaseWord::Opens => (Tone::Good, opens(a)),
    };
    let of = |p: &ProcessRelease| {
        let lacking = p.lacking_mm.filter(|l| *l > 0.0).map(|l| format!("; {l:.3} mm more would open it"));
        format!("{} mm: {}{}", p.clearance_mm, p.lock, lacking.unwrap_or_default())
    };
    let facts = a.process.iter().map(|p| fact(&p.process, of(p))).collect();
    Chapter {
        tone,
        headline,
        words: a.brackets.iter().map(|b| format!("Lower end ({}): {}.", b.motions, b.why)).collect(),
        facts,
        tables: vec![table(a)],
        ..Chapter::default()
    }
}

fn opens(a: &ReleaseAnswer) -> String {
    let best = a.brackets.iter().filter_map(|b| b.hi.map(|h| (b, h)));
    let best = best.min_by(|x, y| x.1.clearance_mm.total_cmp(&y.1.clearance_mm));
    best.map_or(String::new(), |(b, h)| {
        format!(
            "A checked plan takes it apart with {:.3} mm of clearance on each face; with {:.3} mm none was found.",
            h.clearance_mm, b.lo.clearance_mm
        )
    })
}

fn table(a: &ReleaseAnswer) -> Table {
    let head = ["motions", "end"].map(Column::words).into_iter();
    let head =
        head.chain(["clearance, mm", "fit, mm", "of pitch", "as shrinkage, %", "moves"].map(Column::numbers));
    let row = |b: &BracketAnswer, end: &str, l: Length, moves: String| {
        let pitch = l.of_pitch.map_or(String::new(), |p| format!("{p:.5}"));
        let numbers = [format!("{:.4}", l.clearance_mm), format!("{:.4}", l.fit_mm), pitch];
        [
            vec![b.motions.clone(), end.into()],
            numbers.to_vec(),
            vec![format!("{:.2}", l.shrinkage_percent), moves],
        ]
        .concat()
    };
    let both = |b: &BracketAnswer| {
        let lo = row(b, "lower", b.lo, String::new());
        let hi =
            b.hi.map(|h| row(b, "upper", h, b.plan.as_ref().map_or(0, |p| p.plan.steps.len()).to_string()));
        std::iter::once(lo).chain(hi).collect::<Vec<_>>()
    };
    Table {
        caption: "the ends of each bracket".into(),
        head: head.collect(),
        rows: a.brackets.iter().flat_map(both).collect(),
    }
}
