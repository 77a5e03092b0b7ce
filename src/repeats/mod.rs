//! Takes a weave, profiles and swatch rules; gives the least repetition whose swatches lock, and all that was tried.
//!
//! Each k is decided on its own; nothing is inferred from one k to the next. Not promised: that another rule has the
//! same answer; about swatches that were not tried see [`grow`]. With a clearance nothing is locked to first order:
//! see [`crate::made`] for what is asked then.

pub mod explain;
pub mod grow;
mod text;

pub use text::text;

use crate::assembly::Assembly;
use crate::assembly::layout::Swatch;
use crate::contact::{self, Joined, Origin};
use crate::fault::Faults;
use crate::locking::{self, Verdict};
use crate::made::{self, Made};
use crate::spec::{self, ProfileSpec, Syntax};
use crate::watch::{All, Stage, Watch};
use crate::weave::Weave;
use explain::Loose;
use rayon::prelude::*;
use std::path::Path;

/// One swatch and its verdicts.
#[derive(Clone, Debug)]
pub struct Tried {
    pub swatch: Swatch,
    pub parts: usize,
    pub translation: Verdict,
    pub rigid: Verdict,
    /// The spec that was decided, as text: whoever reads it finds the same contacts.
    pub text: String,
    /// The parts by id; their solids are left out.
    pub outline: Assembly,
    /// Fewest changes of side among the pieces: how often the present strands that cross a piece go from over to under
    /// it or back.
    pub least_interlacing: usize,
    /// Why the pieces that the motion moves are loose; empty where nothing moves.
    pub loose: Vec<Loose>,
    /// The question at a clearance, where one was asked.
    pub made: Option<Made>,
}

impl Tried {
    /// Whether this swatch is proven locked; with air in its contacts nothing is.
    pub fn holds(&self) -> bool {
        self.made.is_none() && matches!(self.rigid, Verdict::Locked(_))
    }

    /// Whether nothing was found that takes it apart: the search may go no further.
    fn is_last(&self) -> bool {
        self.holds() || matches!(self.made, Some(Made::NotFound { .. }))
    }
}

/// What was tried, in order of k and phase, and the least k that locks at every phase asked for.
#[derive(Clone, Debug)]
pub struct Repeats {
    pub least: Option<u32>,
    pub tried: Vec<Tried>,
}

/// Which swatches to try.
#[derive(Clone, Debug)]
pub struct Search {
    pub wefts: u32,
    pub warps: u32,
    pub phases: Vec<i32>,
    pub most: u32,
}

/// How the parts are made: air on each face of a contact, and the length of one crossing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AsMade {
    pub clearance_mm: f64,
    pub pitch_mm: f64,
}

impl AsMade {
    /// As the parts touch; no verdict depends on the pitch.
    pub const TOUCHING: AsMade = AsMade { clearance_mm: 0.0, pitch_mm: 20.0 };
}

/// Tries k = 1, 2, ... until all phases lock, or `most` is passed.
pub fn repeats(weave: &Weave, profile: &ProfileSpec, search: &Search) -> Result<Repeats, Faults> {
    repeats_made(weave, profile, search, AsMade::TOUCHING)
}

/// The same for parts as made. At a clearance the search ends at the first k at which no plan takes any swatch apart;
/// a least k is not told then, since a plan that was not found proves nothing.
pub fn repeats_made(
    weave: &Weave,
    profile: &ProfileSpec,
    search: &Search,
    made: AsMade,
) -> Result<Repeats, Faults> {
    repeats_watched(weave, profile, search, made, &Watch::default())
}

/// The same, watched: what a stop leaves is all k whose phases were all tried.
pub fn repeats_watched(
    weave: &Weave,
    profile: &ProfileSpec,
    search: &Search,
    made: AsMade,
    watch: &Watch,
) -> Result<Repeats, Faults> {
    let all = u64::from(search.most) * search.phases.len() as u64;
    let stage = watch.stage("swatches of each k and phase", "swatches", All::AtMost(all));
    let mut tried = Vec::new();
    for repeat in 1..=search.most {
        let Some(row) = round(weave, profile, search, (made, repeat), (watch, &stage))? else { break };
        let (all, last) = (row.iter().all(Tried::holds), row.iter().all(Tried::is_last));
        tried.extend(row);
        if all || last {
            return Ok(Repeats { least: all.then_some(repeat), tried });
        }
    }
    Ok(Repeats { least: None, tried })
}

/// Every phase at one k; nothing where it was stopped before all were tried.
pub fn round(
    weave: &Weave,
    profile: &ProfileSpec,
    search: &Search,
    (made, repeat): (AsMade, u32),
    (watch, stage): (&Watch, &Stage),
) -> Result<Option<Vec<Tried>>, Faults> {
    let of = |&phase: &i32| {
        if watch.is_stopped() {
            return Ok(None);
        }
        let swatch = Swatch { wefts: search.wefts, warps: search.warps, repeat, phase };
        let tried = attempt(weave, profile, swatch, made);
        stage.add(1);
        tried.map(Some)
    };
    let all: Result<Vec<Option<Tried>>, Faults> = search.phases.par_iter().map(of).collect();
    Ok(all?.into_iter().collect())
}

/// Decides one swatch, built from its own text.
pub fn attempt(
    weave: &Weave,
    profile: &ProfileSpec,
    swatch: Swatch,
    as_made: AsMade,
) -> Result<Tried, Faults> {
    let text = text(weave, profile, swatch, as_made.pitch_mm);
    let joined = contact::join(&spec::parse(&text, Path::new(FILE), Syntax::Toml)?)?;
    let check = locking::check(&joined.assembly, &joined.patches, None);
    let pieces = match &joined.origin {
        Origin::Woven(woven) => &woven.pieces[..],
        Origin::Meshes => &[],
    };
    let loose = match &check.rigid {
        Verdict::Free(motion) => explain::loose(weave, profile, &joined.assembly, pieces, motion),
        _ => Vec::new(),
    };
    Ok(Tried {
        swatch,
        parts: joined.assembly.parts.len(),
        translation: check.translation,
        rigid: check.rigid,
        least_interlacing: explain::least_interlacing(&weave.draft, pieces),
        loose,
        made: made_at(&joined, as_made),
        outline: Assembly { solids: Vec::new(), ..joined.assembly },
        text,
    })
}

/// Name of the spec of a swatch: it stands in no file.
pub const FILE: &str = "swatch.toml";

fn made_at(joined: &Joined, as_made: AsMade) -> Option<Made> {
    let clearance = as_made.clearance_mm / as_made.pitch_mm;
    (clearance > 0.0).then(|| made::made(&joined.assembly, &joined.patches, clearance))
}
