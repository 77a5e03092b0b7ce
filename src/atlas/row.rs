//! Takes a weave and what the table is to hold; gives its row: family, hands, least repetition by phase, flexible parts.
//!
//! Promised: nothing in a row depends on time or threads; limits are counts, and what lies beyond one is told as not run.
//! Not promised: that weaves an isometry takes to each other have the same verdicts; the swatch rule breaks ties towards
//! smaller starts, which no mirror keeps (MATHS.md).

use super::release::release;
use super::table::{Ask, Phases};
use super::weaves::{Abc, Equivalent, equivalents};
use crate::assembly::woven;
use crate::chirality::answer::{Handedness, WarpIs};
use crate::chirality::{HandsError, of_weave};
use crate::contact::{self, Touching};
use crate::fault::Faults;
use crate::flex::{self, SAME_VERTEX, WORK, Wanted, flex};
use crate::repeats::{Search, Tried, repeats};
use crate::spec::{Cut, HeldSpec, Layout, Places, Spec, Subject, WovenSpec};
use crate::weave::{Weave, family};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// The verdicts about the swatch of n wefts and n warps whose pieces are k unit tiles.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Repeated {
    pub k: u32,
    pub translation: String,
    pub rigid: String,
}

/// What was found where all cuts are moved by `phase` crossings.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct AtPhase {
    pub phase: i32,
    /// Least k that was found locked (rigid), every smaller one free; null where none was up to `most`, or a smaller one
    /// is undecided.
    pub least: Option<u32>,
    /// In order of k, up to the first that is not free.
    pub tried: Vec<Repeated>,
}

/// Whether a column was worked out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    Found,
    /// The bounds do not meet.
    Undecided,
    NotRun,
}

impl Status {
    pub fn word(self) -> &'static str {
        match self {
            Status::Found => "found",
            Status::Undecided => "undecided",
            Status::NotRun => "not-run",
        }
    }
}

/// Fewest flexible parts of the window of n wefts and n warps, each strand one piece.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Flexible {
    pub status: Status,
    pub minimum: Option<usize>,
    pub lower_bound: Option<usize>,
    /// Size of a set that is enough.
    pub upper_bound: Option<usize>,
    /// Empty where found.
    pub why: String,
}

/// Clearance that opens the swatch of the least repetition at phase 0, in crossings, on each face of a contact: taken apart
/// by straight moves with `high`, not found so with `low`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Release {
    pub status: Status,
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub why: String,
}

/// A weave and what was found about it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Row {
    pub a: u32,
    pub b: u32,
    pub c: i32,
    pub n: u32,
    pub family: String,
    /// Other `[a,b,c]` of the same cloth, moved or mirrored; where the table has no rows of their own this row speaks of
    /// their family, and of their hands after the isometry named.
    pub equivalents: Vec<Equivalent>,
    /// Hand of the weft's unit tile at phase 0, how the warp's follows, and the hand of the endless weave, its strands uncut;
    /// null where a tile could not be cut (`note`).
    pub tile: Option<Handedness>,
    pub warp_is: Option<WarpIs>,
    pub assembly: Option<Handedness>,
    /// `least` at phase 0.
    pub minimal_repeat: Option<u32>,
    pub by_phase: Vec<AtPhase>,
    pub flexible: Flexible,
    pub release_clearance: Release,
    /// What went wrong; empty where nothing did.
    pub note: String,
}

/// The row of one weave.
pub fn row(abc: Abc, ask: &Ask) -> Result<Row, Faults> {
    let Abc(a, b, c) = abc;
    let weave = Weave::abc(a, b, c)?;
    let hands = of_weave(&weave, &ask.settings.profile());
    let phases: Vec<_> = phases(ask, a + b).into_par_iter().map(|p| at_phase(&weave, ask, p)).collect();
    let flexible = flexible(&weave, ask);
    let faults = phases.iter().filter_map(|p| p.as_ref().err().map(Faults::to_string));
    let note: Vec<String> =
        hands.as_ref().err().map(HandsError::to_string).into_iter().chain(faults).collect();
    let by_phase: Vec<AtPhase> = phases.into_iter().flatten().collect();
    let hands = hands.ok();
    let minimal_repeat = by_phase.iter().find(|p| p.phase == 0).and_then(|p| p.least);
    let release_clearance = release(&weave, ask, minimal_repeat);
    Ok(Row {
        a,
        b,
        c,
        n: a + b,
        family: family(&weave.draft).to_string(),
        equivalents: equivalents(abc),
        tile: hands.as_ref().and_then(|h| h.tile),
        warp_is: hands.as_ref().and_then(|h| h.warp_is),
        assembly: hands.as_ref().and_then(|h| h.assembly),
        minimal_repeat,
        by_phase,
        flexible,
        release_clearance,
        note: note.join("; "),
    })
}

fn phases(ask: &Ask, n: u32) -> Vec<i32> {
    match ask.phases {
        Phases::First => vec![0],
        Phases::All => (0..n as i32).collect(),
    }
}

fn at_phase(weave: &Weave, ask: &Ask, phase: i32) -> Result<AtPhase, Faults> {
    let n = weave.tile.0;
    let search = Search { wefts: n, warps: n, phases: vec![phase], most: ask.most };
    let found = repeats(weave, &ask.settings.profile(), &search)?;
    let all: Vec<Repeated> = found.tried.iter().map(repeated).collect();
    let end = all.iter().position(|t| t.rigid != "free").map_or(all.len(), |k| k + 1);
    let tried = all[..end].to_vec();
    let least = tried.last().filter(|t| t.rigid == "locked").map(|t| t.k);
    Ok(AtPhase { phase, least, tried })
}

fn repeated(tried: &Tried) -> Repeated {
    let (translation, rigid) = (tried.translation.word().to_string(), tried.rigid.word().to_string());
    Repeated { k: tried.swatch.repeat, translation, rigid }
}

fn flexible(weave: &Weave, ask: &Ask) -> Flexible {
    let none = |status, why| Flexible { status, minimum: None, lower_bound: None, upper_bound: None, why };
    let n = weave.tile.0;
    if n > ask.flex_up_to {
        let why = format!("a + b = {n} is over the {} that was asked for", ask.flex_up_to);
        return none(Status::NotRun, why);
    }
    let spec = swatch(weave, ask, Cut::Window, 1);
    let Subject::Woven(woven) = &spec.subject else { return none(Status::NotRun, "no weave".into()) };
    let built = match woven::build(&spec, woven) {
        Ok(built) => built,
        Err(faults) => return none(Status::NotRun, faults.to_string()),
    };
    let asked =
        flex::Ask { clearance: 0.0, wanted: Wanted::Smallest, work: WORK, until: None, within: SAME_VERTEX };
    let patches = contact::woven::patches(&built);
    match flex(Touching::exactly(&built.assembly, &patches), &asked) {
        Err(fault) => none(Status::NotRun, fault.to_string()),
        Ok(found) => {
            let (minimum, lower, upper) = (found.minimum(), found.lower, found.upper);
            let (status, why) = match minimum {
                Some(_) => (Status::Found, String::new()),
                None => (Status::Undecided, "the bounds do not meet".into()),
            };
            Flexible { status, minimum, lower_bound: Some(lower), upper_bound: Some(upper), why }
        }
    }
}

/// The n x n swatch at phase 0, as if its spec had been read; the pitch does not matter to a verdict.
pub(super) fn swatch(weave: &Weave, ask: &Ask, cut: Cut, repeat: u32) -> Spec {
    let n = weave.tile.0;
    let layout = Layout::Swatch { wefts: n, warps: n, cut, repeat, phase: 0 };
    let (weave, profile) = (weave.clone(), ask.settings.profile());
    let subject = Subject::Woven(WovenSpec { weave, profile, layout, held: HeldSpec::None, pitch_mm: 1.0 });
    Spec { name: "swatch".into(), subject, fab: None, file: PathBuf::new(), places: Places::default() }
}
