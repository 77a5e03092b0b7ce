//! Takes what `repeats` tried; gives its answer as it is written.
//!
//! Not promised: an answer for swatches that are not in the table.

use super::Word;
use crate::locking::Verdict;
use crate::repeats::{Repeats, Tried};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One swatch and its verdicts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RepeatsRow {
    pub k: u32,
    pub phase: i32,
    pub swatch: SwatchAnswer,
    pub parts: usize,
    pub translation: Word,
    pub rigid: Word,
    /// What the rigid verdict rests on, in words.
    pub witness: String,
}

/// Strands of a swatch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SwatchAnswer {
    pub wefts: u32,
    pub warps: u32,
}

/// Answer of `repeats`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RepeatsAnswer {
    pub verb: String,
    pub weave: String,
    /// Least k whose swatch is locked at every phase asked for; null where none was found.
    pub minimal_repeat: Option<u32>,
    /// Largest k that was tried.
    pub searched: u32,
    pub table: Vec<RepeatsRow>,
    pub remarks: Vec<String>,
}

pub fn repeats(weave: &str, found: &Repeats, remarks: Vec<String>) -> RepeatsAnswer {
    RepeatsAnswer {
        verb: "repeats".into(),
        weave: weave.into(),
        minimal_repeat: found.least,
        searched: found.tried.iter().map(|t| t.swatch.repeat).max().unwrap_or(0),
        table: found.tried.iter().map(row).collect(),
        remarks,
    }
}

fn row(t: &Tried) -> RepeatsRow {
    RepeatsRow {
        k: t.swatch.repeat,
        phase: t.swatch.phase,
        swatch: SwatchAnswer { wefts: t.swatch.wefts, warps: t.swatch.warps },
        parts: t.parts,
        translation: word(&t.translation),
        rigid: word(&t.rigid),
        witness: witness(&t.rigid),
    }
}

fn word(v: &Verdict) -> Word {
    match v {
        Verdict::Locked(_) => Word::Locked,
        Verdict::Free(_) => Word::Free,
        Verdict::Undecided(_) => Word::Undecided,
    }
}

fn witness(v: &Verdict) -> String {
    match v {
        Verdict::Locked(s) => {
            format!("{} contact forces in balance, rank {} of {}", s.forces.len(), s.rank, s.rank)
        }
        Verdict::Free(m) if m.opening > 0.0 => "a motion that opens a contact and presses none".into(),
        Verdict::Free(_) => "a motion in which every contact slides".into(),
        Verdict::Undecided(gap) => gap.why.clone(),
    }
}
