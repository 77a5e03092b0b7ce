//! Takes a weave, a profile and swatch rules; gives the least repetition whose swatch is locked, and all that was tried.
//!
//! Each k is decided on its own; nothing is inferred from one k to the next. Not promised: that a larger swatch or
//! another rule has the same answer, nor that larger k stay locked; the answer names its swatches (MATHS.md).

use crate::assembly::layout::Swatch;
use crate::assembly::woven;
use crate::contact;
use crate::fault::Faults;
use crate::locking::{self, Verdict};
use crate::spec::{Cut, HeldSpec, Layout, Places, ProfileSpec, Spec, Subject, WovenSpec};
use crate::weave::Weave;
use rayon::prelude::*;
use std::path::PathBuf;

/// One swatch and its verdicts.
#[derive(Clone, Debug)]
pub struct Tried {
    pub swatch: Swatch,
    pub parts: usize,
    pub translation: Verdict,
    pub rigid: Verdict,
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

/// Tries k = 1, 2, ... until all phases lock, or `most` is passed.
pub fn repeats(weave: &Weave, profile: &ProfileSpec, search: &Search) -> Result<Repeats, Faults> {
    let mut tried = Vec::new();
    for repeat in 1..=search.most {
        let of = |&phase: &i32| {
            attempt(weave, profile, Swatch { wefts: search.wefts, warps: search.warps, repeat, phase })
        };
        let row: Vec<Tried> = search.phases.par_iter().map(of).collect::<Result<_, _>>()?;
        let all = row.iter().all(|t| matches!(t.rigid, Verdict::Locked(_)));
        tried.extend(row);
        if all {
            return Ok(Repeats { least: Some(repeat), tried });
        }
    }
    Ok(Repeats { least: None, tried })
}

fn attempt(weave: &Weave, profile: &ProfileSpec, swatch: Swatch) -> Result<Tried, Faults> {
    let spec = spec(weave, profile, swatch);
    let Subject::Woven(ref woven) = spec.subject else { return Err(Faults(Vec::new())) };
    let built = woven::build(&spec, woven)?;
    let check = locking::check(&built.assembly, &contact::woven::patches(&built), None);
    Ok(Tried {
        swatch,
        parts: built.assembly.parts.len(),
        translation: check.translation,
        rigid: check.rigid,
    })
}

/// The spec of a swatch of tiles, as if it had been read; the pitch does not matter to a verdict.
fn spec(weave: &Weave, profile: &ProfileSpec, swatch: Swatch) -> Spec {
    let Swatch { wefts, warps, repeat, phase } = swatch;
    let layout = Layout::Swatch { wefts, warps, cut: Cut::Tiles, repeat, phase };
    let (weave, profile) = (weave.clone(), profile.clone());
    let woven = WovenSpec { weave, profile, layout, held: HeldSpec::None, pitch_mm: 1.0 };
    let subject = Subject::Woven(woven);
    Spec { name: "swatch".into(), subject, fab: None, file: PathBuf::new(), places: Places::default() }
}
