//! Takes a draft; gives its floats and the family that weavers would name.
//!
//! Promised: the family does not change when the draft is shifted. Not promised: names beyond plain, twill and satin;
//! broken, pointed or irregular ones are [`Family::Other`].

use super::{Draft, Kind, Strand};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Which way the diagonal of a twill climbs, with x (warps) to the right and y (wefts) up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Hand {
    /// Up to the left, as the stroke of the letter: `[a,b,-1]`.
    S,
    /// Up to the right: `[a,b,1]`.
    Z,
}

/// The family of a draft; plain goes before twill, twill before satin.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Family {
    Plain,
    /// Each weft is the one below moved by one crossing. `runs`: over, under, over, ... along a weft, one period.
    Twill {
        hand: Hand,
        runs: Vec<u32>,
    },
    /// One odd crossing in each row and column, moved by `step` (neither 1 nor -1) to the right from weft to weft.
    /// `face`: the strands that show most on top.
    Satin {
        step: u32,
        face: Kind,
    },
    Other,
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Family::Plain => write!(f, "plain"),
            Family::Twill { hand, runs } => {
                let runs: Vec<String> = runs.iter().map(u32::to_string).collect();
                write!(f, "twill {hand:?} {}", runs.join("/"))
            }
            Family::Satin { step, face } => write!(f, "satin, step {step}, {} face", face.word()),
            Family::Other => write!(f, "other"),
        }
    }
}

/// The family of the draft.
pub fn family(draft: &Draft) -> Family {
    let n = draft.warps();
    match shift(draft) {
        Some(1) if n == 2 => Family::Plain,
        Some(1) => Family::Twill { hand: Hand::Z, runs: runs(draft) },
        Some(s) if s > 0 && s == n - 1 => Family::Twill { hand: Hand::S, runs: runs(draft) },
        Some(step) if step > 0 && draft.wefts() == n => satin(draft, step),
        _ => Family::Other,
    }
}

/// The number of crossings, below the period, by which each weft is the one before it moved to the right.
fn shift(draft: &Draft) -> Option<u32> {
    let (wefts, warps) = (draft.wefts() as i32, draft.warps() as i32);
    let moves = |s: &i32| (0..wefts).all(|j| moved(draft, j, *s));
    (0..warps).find(moves).map(|s| s as u32)
}

fn moved(draft: &Draft, weft: i32, by: i32) -> bool {
    (0..draft.warps() as i32).all(|i| draft.weft_over(weft, i) == draft.weft_over(weft + 1, i + by))
}

/// A square draft whose wefts are one row moved by a step prime to its length has equal counts in rows and columns.
fn satin(draft: &Draft, step: u32) -> Family {
    let overs = (0..draft.warps() as i32).filter(|&i| draft.weft_over(0, i)).count() as u32;
    match overs {
        1 => Family::Satin { step, face: Kind::Warp },
        _ if overs + 1 == draft.warps() => Family::Satin { step, face: Kind::Weft },
        _ => Family::Other,
    }
}

/// Over and under runs of weft 0 over one period, turned so that the list is the greatest of its rotations.
fn runs(draft: &Draft) -> Vec<u32> {
    let ring = sides(draft, Strand { kind: Kind::Weft, index: 0 });
    let lengths: Vec<u32> = ring_runs(&ring).into_iter().map(|(_, length)| length).collect();
    let turns = (0..lengths.len()).step_by(2).map(|k| [&lengths[k..], &lengths[..k]].concat());
    turns.max().unwrap_or_default()
}

/// Maximal runs of equal values around a ring, from the first that starts with `true`; none where all are equal.
fn ring_runs(ring: &[bool]) -> Vec<(bool, u32)> {
    let n = ring.len();
    let Some(start) = (0..n).find(|&k| ring[k] && !ring[(k + n - 1) % n]) else { return Vec::new() };
    let turned: Vec<bool> = (0..n).map(|k| ring[(start + k) % n]).collect();
    turned.chunk_by(|a, b| a == b).map(|run| (run[0], run.len() as u32)).collect()
}

/// Overs and unders of each weft where all wefts pass over `a` and under `b` crossings in turn and all warps under `a`
/// and over `b`, so that one curve and its mirror image draw every strand; else the first strand that differs.
pub fn wave(draft: &Draft) -> Result<(u32, u32), Strand> {
    let first = Strand { kind: Kind::Weft, index: 0 };
    let [(_, a), (_, b)] = ring_runs(&sides(draft, first))[..] else { return Err(first) };
    let alike = |strand: &Strand| {
        let expected = match strand.kind {
            Kind::Weft => [(true, a), (false, b)],
            Kind::Warp => [(true, b), (false, a)],
        };
        ring_runs(&sides(draft, *strand)) == expected
    };
    let odd = draft.strands(Kind::Weft).chain(draft.strands(Kind::Warp)).find(|strand| !alike(strand));
    odd.map_or(Ok((a, b)), Err)
}

/// Whether the strand passes over, at each crossing of its period.
fn sides(draft: &Draft, strand: Strand) -> Vec<bool> {
    (0..draft.period(strand.kind) as i32).map(|k| draft.is_over(strand, k)).collect()
}

/// A run of crossings in which a strand stays on one side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Float {
    /// No strand of the kind is on that side anywhere.
    Absent,
    Crossings(u32),
    /// Some strand never changes to the other side.
    Endless,
}

impl fmt::Display for Float {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Float::Absent => write!(f, "none"),
            Float::Crossings(n) => write!(f, "{n}"),
            Float::Endless => write!(f, "endless"),
        }
    }
}

/// The longest floats of either kind of strand, on either side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Floats {
    pub weft_over: Float,
    pub weft_under: Float,
    pub warp_over: Float,
    pub warp_under: Float,
}

/// The longest floats of the draft.
pub fn floats(draft: &Draft) -> Floats {
    let longest =
        |kind, over| draft.strands(kind).map(|s| float(draft, s, over)).max().unwrap_or(Float::Absent);
    Floats {
        weft_over: longest(Kind::Weft, true),
        weft_under: longest(Kind::Weft, false),
        warp_over: longest(Kind::Warp, true),
        warp_under: longest(Kind::Warp, false),
    }
}

fn float(draft: &Draft, strand: Strand, over: bool) -> Float {
    let ring = sides(draft, strand);
    if ring.iter().all(|&side| side == over) {
        return Float::Endless;
    }
    let runs = ring_runs(&ring).into_iter().filter(|run| run.0 == over);
    runs.map(|run| Float::Crossings(run.1)).max().unwrap_or(Float::Absent)
}
