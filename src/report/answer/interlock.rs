//! Takes what was found about keys and cores, gives it as it is written into the answer of `check`.

use super::{Certificate, MotionAnswer, Proof, Word, certificate, ids, proof, written};
use crate::assembly::{Assembly, PartIx};
use crate::cores::{Core, Firm, Set};
use crate::interlock::keys::{Complete, Directions, Least};
use crate::interlock::{Interlock, Key, Whole};
use crate::locking::{Check, Verdict};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Locked whichever one part is held: with the held set ignored and any one part fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum InterlockWord {
    Interlocked,
    NotInterlocked,
    Undecided,
    NotRun,
}

impl From<Word> for InterlockWord {
    fn from(word: Word) -> InterlockWord {
        match word {
            Word::Locked => InterlockWord::Interlocked,
            Word::Free => InterlockWord::NotInterlocked,
            Word::Undecided => InterlockWord::Undecided,
        }
    }
}

/// Extreme directions of the cone along which a group can start to move as one body: sums of `rays`, and of `lines`
/// either way. Unit vectors; none of either: it can not start to move without turning or changing its shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DirectionsAnswer {
    pub lines: Vec<[f64; 3]>,
    pub rays: Vec<[f64; 3]>,
}

/// A smallest group that can start to move while every other part stands still.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct KeyAnswer {
    pub parts: Vec<String>,
    pub motion: MotionAnswer,
    /// Null where a direction is too near a contact's plane to be told from blocked.
    pub directions: Option<DirectionsAnswer>,
    /// `shown`: every smaller group inside was asked and can not move; else `not-shown`. (`verify` does not check it.)
    pub least: String,
}

/// Parts that are locked by themselves, all others away.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LockedCore {
    pub parts: Vec<String>,
    /// `largest`: in no larger one; `smallest`: no part of it can be left out.
    pub kind: String,
    /// `holds`: the contacts are exact, or the lock survives every change of them within what the meshes' digits leave open;
    /// `unproven`: locked as written, and that is not shown.
    #[serde(default = "holds")]
    pub within_digits: String,
    pub certificate: Certificate,
}

fn holds() -> String {
    firm(Firm::Holds)
}

/// As it is written.
pub fn firm(firm: Firm) -> String {
    if firm == Firm::Holds { "holds" } else { "unproven" }.into()
}

/// How far was looked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SearchedAnswer {
    /// Groups that were asked whether they can move.
    pub groups: usize,
    /// All keys of up to so many parts are named; null: all.
    pub keys_up_to: Option<usize>,
    /// Groups, or sub-assemblies, whose numbers carry neither proof.
    pub undecided: Vec<Vec<String>>,
    /// Sub-assemblies too large to be asked about cores.
    pub not_asked: Vec<Vec<String>>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct InterlockAnswer {
    pub word: InterlockWord,
    /// The verdict with the held set ignored and the first part fixed; left out where at most one part is held, since
    /// it is then the verdict of the check.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proof: Option<Proof>,
    pub keys: Vec<KeyAnswer>,
    pub cores: Vec<LockedCore>,
    pub searched: SearchedAnswer,
}

pub fn interlock(asm: &Assembly, check: &Check, found: &Interlock) -> InterlockAnswer {
    let (word, proof) = whole(asm, check, &found.whole);
    let (keys, cores) = (&found.keys, &found.cores);
    let largest = cores.found.largest.iter().map(|c| core(asm, c, "largest"));
    let smallest = cores.smallest.iter().map(|c| core(asm, c, "smallest"));
    let sets = |sets: &mut dyn Iterator<Item = &Set>| sets.map(|s| names(asm, s)).collect();
    InterlockAnswer {
        word,
        proof,
        keys: keys.found.iter().map(|k| key(asm, k)).collect(),
        cores: largest.chain(smallest).collect(),
        searched: SearchedAnswer {
            groups: keys.asked,
            keys_up_to: match keys.complete {
                Complete::All => None,
                Complete::UpTo(n) => Some(n),
            },
            undecided: sets(&mut keys.undecided.iter().chain(&cores.found.undecided)),
            not_asked: sets(&mut cores.found.not_asked.iter()),
        },
    }
}

fn whole(asm: &Assembly, check: &Check, whole: &Whole) -> (InterlockWord, Option<Proof>) {
    let word = |verdict: &Verdict| match verdict {
        Verdict::Locked(_) => InterlockWord::Interlocked,
        Verdict::Free(_) => InterlockWord::NotInterlocked,
        Verdict::Undecided(_) => InterlockWord::Undecided,
    };
    match whole {
        Whole::AsChecked => (word(&check.rigid), None),
        Whole::Fixing(p, verdict) => (word(verdict), Some(proof(asm, &[*p], verdict))),
        Whole::NotRun { .. } => (InterlockWord::NotRun, None),
    }
}

fn names(asm: &Assembly, set: &Set) -> Vec<String> {
    ids(asm, &set.iter().copied().collect::<Vec<PartIx>>())
}

fn key(asm: &Assembly, k: &Key) -> KeyAnswer {
    let arrays = |d: &Directions| DirectionsAnswer {
        lines: d.lines.iter().map(|v| v.to_array()).collect(),
        rays: d.rays.iter().map(|v| v.to_array()).collect(),
    };
    KeyAnswer {
        parts: names(asm, &k.parts),
        motion: written(asm, &k.motion),
        directions: k.directions.as_ref().map(arrays),
        least: if k.least == Least::Shown { "shown" } else { "not-shown" }.into(),
    }
}

fn core(asm: &Assembly, c: &Core, kind: &str) -> LockedCore {
    let still: Vec<PartIx> = c.still.iter().copied().collect();
    LockedCore {
        parts: names(asm, &c.parts),
        kind: kind.into(),
        within_digits: firm(c.firm),
        certificate: certificate(asm, &still, &c.stress),
    }
}
