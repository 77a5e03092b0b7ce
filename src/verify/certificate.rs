//! Takes an assembly, its contacts and a proof as written; says whether the proof holds, and as what.
//!
//! `exact`: a theorem about the contact rows as written, f64 being rationals (`stress` for locks, `motion` for motions).
//! `round-off`: a theorem about rows that differ from those by no more than their own round-off; only motions may end
//! so. Not promised: anything about an undecided verdict, which claims nothing.

use super::{motion::motion, stress};
use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::report::answer::{Proof, Word};
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use super::stress::certificate;

/// Which motions a proof is about: translations alone leave out the moments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum About {
    Translations,
    RigidMotions,
}

impl About {
    /// Unknowns of a part that may move.
    pub fn width(self) -> usize {
        match self {
            About::Translations => 3,
            About::RigidMotions => 6,
        }
    }
}

/// Which rows a proof was found true for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Arithmetic {
    /// The contact rows as written, every f64 taken as the rational number that it is.
    Exact,
    /// Rows that differ from those written by at most `bound`, which is no more than their own round-off.
    RoundOff,
    /// The verdict is undecided and claims nothing.
    None,
}

/// A proof that holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Shown {
    pub arithmetic: Arithmetic,
    /// Locks: the exact rank of the rows that carry a force.
    pub rank: Option<usize>,
    /// Locks: forces in exact balance exist that are all at least this; proven.
    pub least_force: Option<f64>,
    /// Locks: the proof holds for all rows within this of those written; motions decided to round-off: it holds for some.
    /// For each part of a unit normal, and for each coordinate of a point as a share of the point's largest.
    pub bound: Option<f64>,
    pub how: String,
}

impl Shown {
    pub fn new(arithmetic: Arithmetic) -> Shown {
        Shown { arithmetic, rank: None, least_force: None, bound: None, how: String::new() }
    }
}

/// Holds the proof against the contacts of these parts.
pub fn proof(
    asm: &Assembly,
    patches: &[Patch],
    proof: &Proof,
    still: &[String],
    about: About,
) -> Result<Shown, String> {
    match (proof.verdict, &proof.certificate, &proof.motion, &proof.gap) {
        (Word::Locked, Some(c), None, None) if c.still == still => {
            stress::certificate(asm, patches, c, about)
        }
        (Word::Locked, Some(_), None, None) => {
            Err("the certificate leaves out other parts than it should".into())
        }
        (Word::Free, None, Some(m), None) => motion(asm, patches, m, still, about),
        (Word::Undecided, None, None, Some(_)) => {
            Ok(Shown { how: "nothing is claimed".into(), ..Shown::new(Arithmetic::None) })
        }
        _ => Err("the verdict does not come with the one witness that belongs to it".into()),
    }
}

/// A contact row by the bits of its numbers.
pub type Key = (PartIx, PartIx, [u64; 3], [u64; 3]);

pub fn key(a: PartIx, b: PartIx, n: DVec3, p: DVec3) -> Key {
    (a, b, n.to_array().map(f64::to_bits), p.to_array().map(f64::to_bits))
}

pub fn rows(patch: &Patch) -> impl Iterator<Item = Key> + '_ {
    patch.corners.iter().map(|&p| key(patch.a, patch.b, patch.normal, p))
}
