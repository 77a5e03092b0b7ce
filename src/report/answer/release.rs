//! Takes brackets of the clearance that releases a lock; gives them as they are written.
//!
//! Not promised: that the lower end is proven, where its evidence is `not-found`.

use super::{Certificate, PlanAnswer, Source};
use crate::assembly::Assembly;
use crate::contact::{Joined, Origin};
use crate::release::{Bracket, End};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Answer of `release`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReleaseAnswer {
    pub verb: String,
    pub name: String,
    pub outcome: ReleaseWord,
    /// Proof of the lock at zero clearance, to first order; null where there is none.
    pub certificate: Option<Certificate>,
    /// One for each kind of motions that was tried.
    pub brackets: Vec<BracketAnswer>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub process: Option<ProcessRelease>,
    /// True where the user stopped the search before it was done: the brackets are as wide as they were then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
    pub remarks: Vec<String>,
    pub source: Source,
    pub checksum: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ReleaseWord {
    /// It comes apart as it is, without clearance.
    NeedsNone,
    /// Some clearance was found that opens it.
    Opens,
    /// None was found up to where little is left of the parts.
    NotFound,
}

/// What stands behind a lower end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Evidence {
    /// Locked to first order at zero clearance (`certificate`).
    Locked,
    /// No plan was found: what was searched is in `why`. No proof.
    NotFound,
    /// Nothing smaller was tried, or nothing is needed.
    None,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BracketAnswer {
    /// The motions that plans were made of.
    pub motions: String,
    pub lo: Length,
    pub evidence: Evidence,
    pub why: String,
    /// Null where nothing came apart.
    pub hi: Option<Length>,
    /// The plan at the upper end, for the parts as made; `verify` accepted it.
    pub plan: Option<PlanAnswer>,
    /// Clearances tried, mm, and what was found there.
    pub tried: Vec<(f64, String)>,
}

/// A clearance in the words of three trades.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Length {
    /// On each face.
    pub clearance_mm: f64,
    /// Between two faces.
    pub fit_mm: f64,
    /// Clearance over pitch; null where there is no weave.
    pub of_pitch: Option<f64>,
    /// The linear shrinkage that takes as much volume off the parts as the clearance does: clearance x surface / (3 x
    /// volume), in percent. It stands for parts that shrink while their places do not: if all shrink and all places with
    /// them, the assembly only becomes smaller, and no shrinkage opens it.
    pub shrinkage_percent: f64,
}

/// What a process does to the lock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProcessRelease {
    pub process: String,
    pub clearance_mm: f64,
    /// `opens`: at or above the upper end; `stays`: at or below the lower end; `between`: no answer; `unknown`: no
    /// upper end.
    pub lock: String,
    /// Clearance that is lacking up to the upper end, mm; 0 where it opens.
    pub lacking_mm: Option<f64>,
    pub shrinkage: String,
}

pub fn length(joined: &Joined, clearance: f64) -> Length {
    let asm = &joined.assembly;
    let mm = clearance * asm.mm_per_unit;
    let (surface, volume) = skin(asm);
    Length {
        clearance_mm: mm,
        fit_mm: 2.0 * mm,
        // Woven assemblies are in crossings: the unit is the pitch.
        of_pitch: matches!(joined.origin, Origin::Woven(_)).then_some(clearance),
        shrinkage_percent: 100.0 * clearance * surface / (3.0 * volume),
    }
}

/// Surface and volume of all parts, model units.
fn skin(asm: &Assembly) -> (f64, f64) {
    asm.ids()
        .map(|p| asm.solid(p))
        .fold((0.0, 0.0), |(s, v), solid| (s + solid.surface(), v + solid.volume()))
}

/// `zero`: the proof of the lock at zero clearance, if there is one.
pub fn bracket(
    joined: &Joined,
    motions: &str,
    found: &Bracket<PlanAnswer>,
    zero: Option<&Certificate>,
) -> BracketAnswer {
    let mm = joined.assembly.mm_per_unit;
    let (evidence, why) = match (&found.why, zero) {
        (Some(why), _) => (Evidence::NotFound, why.clone()),
        (None, Some(_)) => (Evidence::Locked, "locked to first order at zero clearance".into()),
        (None, None) => (Evidence::None, "nothing smaller was tried".into()),
    };
    BracketAnswer {
        motions: motions.into(),
        lo: length(joined, found.lo),
        evidence,
        why: match (&found.hi, &found.gone) {
            (Some(_), _) => why,
            (None, Some((_, gone))) => format!("{why}; with more clearance: {gone}"),
            (None, None) if found.end == End::Stopped => format!("{why}; stopped by the user"),
            (None, None) => format!("{why}; larger clearances leave little of the parts and were not tried"),
        },
        hi: found.hi.as_ref().map(|h| length(joined, h.0)),
        plan: found.hi.as_ref().map(|h| h.1.clone()),
        tried: found.tried.iter().map(|t| (t.clearance * mm, t.word.to_string())).collect(),
    }
}

/// The bracket of an assembly that comes apart as it is.
pub fn needs_none(joined: &Joined, plan: PlanAnswer) -> BracketAnswer {
    BracketAnswer {
        motions: "straight moves, stops half way, turns, several at once".into(),
        lo: length(joined, 0.0),
        evidence: Evidence::None,
        why: "it comes apart without clearance".into(),
        hi: Some(length(joined, 0.0)),
        plan: Some(plan),
        tried: Vec::new(),
    }
}
