//! Takes what is asked of the atlas; runs, shards or joins it, shows how far it is, and tells what was written.
//!
//! Not promised: the time left; it is the time so far in proportion to a guess of the work.

use super::args::Common;
use super::told::{News, Told, Trouble};
use crate::atlas::{
    self, Ask, FLEX_UP_TO, MOST, Phases, Progress, RELEASE_UP_TO, Release, Row, Settings, Shard, Which,
    Written,
};
use crate::chirality::answer::Handedness;
use crate::report::content::{Chapter, Column, Table, Tone};
use crate::spec;
use clap::{Args as ClapArgs, ValueEnum};
use schemars::JsonSchema;
use serde::Serialize;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

#[derive(ClapArgs, Debug)]
pub struct Asked {
    /// Largest a + b
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(2..=64))]
    pub max_n: u32,
    /// Folder for the files; a run that was stopped goes on there
    #[arg(long, default_value = "atlas")]
    pub out: PathBuf,
    /// Only part I of M, for a cluster: `--shard 3/8`; writes atlas.3-of-8.jsonl
    #[arg(long, value_name = "I/M", value_parser = Shard::parse)]
    pub shard: Option<Shard>,
    /// Join the files (or folders) of shards into --out instead of working rows out
    #[arg(long, value_name = "FILES", num_args = 1.., conflicts_with_all = ["shard", "max_n", "every", "most", "phases", "flex_up_to", "release_up_to", "rise", "lift", "cover", "samples"])]
    pub merge: Vec<PathBuf>,
    /// A row for every `[a,b,c]`, not only one for all names of a cloth
    #[arg(long)]
    pub every: bool,
    /// Largest repetition to try
    #[arg(long, default_value_t = MOST, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub most: u32,
    /// Phases of the cuts to try
    #[arg(long, value_enum, default_value = "all")]
    pub phases: Cuts,
    /// Look for flexible parts where a + b is at most this; a row takes minutes from 5 on
    #[arg(long, value_name = "N", default_value_t = FLEX_UP_TO, value_parser = clap::value_parser!(u32).range(0..=64))]
    pub flex_up_to: u32,
    /// Look for release clearance where a + b is at most this
    #[arg(long, value_name = "N", default_value_t = RELEASE_UP_TO, value_parser = clap::value_parser!(u32).range(0..=64))]
    pub release_up_to: u32,
    /// Profile, as in a spec's `[profile]`
    #[arg(long, default_value_t = Settings::default().rise)]
    pub rise: f64,
    #[arg(long, default_value_t = Settings::default().lift)]
    pub lift: f64,
    #[arg(long, default_value_t = Settings::default().cover)]
    pub cover: f64,
    #[arg(long, default_value_t = Settings::default().samples)]
    pub samples: u32,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cuts {
    /// 0 to n - 1
    All,
    /// 0 alone
    First,
}

impl Asked {
    fn ask(&self) -> Result<Ask, Trouble> {
        let settings =
            Settings { rise: self.rise, lift: self.lift, cover: self.cover, samples: self.samples };
        bounded(self.rise, self.lift, self.cover, self.samples)?;
        Ok(Ask {
            max_n: self.max_n,
            which: if self.every { Which::Every } else { Which::Representatives },
            most: self.most,
            phases: if self.phases == Cuts::All { Phases::All } else { Phases::First },
            flex_up_to: self.flex_up_to,
            release_up_to: self.release_up_to,
            settings,
        })
    }
}

pub fn atlas(asked: &Asked, common: &Common) -> Result<Told, Trouble> {
    let written = if asked.merge.is_empty() {
        let mut meter = Meter::new(common);
        let written = atlas::write(&asked.ask()?, asked.shard, &asked.out, |p| meter.show(&p));
        meter.end();
        written?
    } else {
        atlas::merge(&asked.merge, &asked.out)?
    };
    let answer =
        AtlasAnswer { verb: "atlas".into(), rows: written.rows.clone(), files: written.files.clone() };
    let name = asked.shard.map_or("Atlas".to_string(), |s| format!("Atlas, shard {s}"));
    Ok(Told::new(News::Good, &answer, &name, "Weaves", chapter(&written)))
}

/// Answer of `atlas`.
#[derive(Serialize, JsonSchema)]
pub struct AtlasAnswer {
    verb: String,
    rows: Vec<Row>,
    files: Vec<PathBuf>,
}

fn chapter(written: &Written) -> Chapter {
    let lower = |word: String| word.to_lowercase();
    let row = |r: &Row| {
        let hand = |h: Option<Handedness>| lower(h.map_or("-".into(), |h| format!("{h:?}")));
        let phases: Vec<String> = r.by_phase.iter().map(atlas::told).collect();
        vec![
            format!("[{},{},{}]", r.a, r.b, r.c),
            r.family.clone(),
            hand(r.tile),
            lower(r.warp_is.map_or("-".into(), |w| format!("{w:?}"))),
            hand(r.assembly),
            phases.join(" "),
            r.flexible.minimum.map_or(r.flexible.status.word().into(), |k| k.to_string()),
            between(&r.release_clearance),
        ]
    };
    let table = Table {
        caption: "Swatch n x n; - none found, ? undecided. Clearance that opens it, in crossings: not found to find with the first, \
                  found with the second".into(),
        head: ["weave", "family", "tile", "warp is", "weave's", "least k by phase", "flexible", "opens between"]
            .map(Column::words)
            .to_vec(),
        rows: written.rows.iter().map(row).collect(),
    };
    let headline =
        format!("{} weaves, {} of them found there from before.", written.rows.len(), written.found);
    let words = written.files.iter().map(|f| f.display().to_string()).collect();
    Chapter { tone: Tone::Plain, headline, words, tables: vec![table], ..Chapter::default() }
}

fn between(r: &Release) -> String {
    match (r.low, r.high) {
        (Some(low), Some(high)) => format!("{low:.4} and {high:.4}"),
        (Some(low), None) => format!("over {low:.4}, if at all"),
        _ => r.status.word().into(),
    }
}

/// Shows how far a run is: a bar on a terminal, else a line from time to time.
struct Meter {
    start: Instant,
    said: Option<Instant>,
    way: Way,
}

#[derive(PartialEq)]
enum Way {
    Silent,
    Bar,
    Lines,
}

/// Between two lines of a log.
const PAUSE: Duration = Duration::from_secs(10);

/// Letters of the bar.
const BAR: usize = 30;

impl Meter {
    fn new(common: &Common) -> Meter {
        let way = match (common.quiet, std::io::stderr().is_terminal()) {
            (true, _) => Way::Silent,
            (_, true) => Way::Bar,
            _ => Way::Lines,
        };
        Meter { start: Instant::now(), said: None, way }
    }

    fn show(&mut self, p: &Progress) {
        let left = self.start.elapsed().mul_f64(p.left as f64 / p.worked.max(1) as f64);
        let text = format!("{} of {} weaves, {} done, about {} left", p.done, p.all, p.abc, time(left));
        let due = p.done == p.all || self.said.is_none_or(|at| at.elapsed() >= PAUSE);
        match self.way {
            Way::Bar => {
                let full = BAR * p.done / p.all.max(1);
                let bar = format!("{}{}", "#".repeat(full), ".".repeat(BAR - full));
                let _ = write!(std::io::stderr(), "\r[{bar}] {text}\u{1b}[K");
            }
            Way::Lines if due => {
                self.said = Some(Instant::now());
                let _ = writeln!(std::io::stderr(), "{text}");
            }
            _ => {}
        }
    }

    fn end(&self) {
        if self.way == Way::Bar {
            let _ = write!(std::io::stderr(), "\r\u{1b}[K");
        }
    }
}

/// A length of time in few letters.
pub fn time(left: Duration) -> String {
    match left.as_secs() {
        s @ 0..=99 => format!("{s} s"),
        s @ 100..=5999 => format!("{} min", s.div_ceil(60)),
        s => format!("{:.1} h", s as f64 / 3600.0),
    }
}

/// Holds the profile of the flags to the bounds of a spec's.
fn bounded(rise: f64, lift: f64, cover: f64, samples: u32) -> Result<(), Trouble> {
    let text = format!(
        "[weave]\nabc = [1, 1, 1]\n[profile]\nrise = {rise:?}\nlift = {lift:?}\ncover = {cover:?}\nsamples = {samples}\n[swatch]\nwefts = 2\nwarps = 2\ncut = \"window\"\n[size]\npitch = \"1 mm\"\n"
    );
    spec::parse(&text, Path::new("(flags)"), spec::Syntax::Toml)?;
    Ok(())
}
