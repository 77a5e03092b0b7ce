//! Takes what the stages found; gives the answers as they are written: one JSON object for each verb.
//!
//! Every answer carries the text of its spec, so that it can be checked without the file, and a checksum against
//! accidental change. Not promised: that a checksum stops a forger; `verify` re-does the mathematics.

mod blocking;
pub mod fab;
mod flex;
mod interlock;
mod play;
mod preferred;
mod release;
pub mod repeats;
mod sampling;
mod weave;

pub use blocking::{
    ArcAnswer, BlockingAnswer, CellAnswer, Connected, DbgAnswer, Found, NdbgAnswer, ReachWord, blocking, dbg,
};
pub use flex::{CoreAnswer, FlexAnswer, OrbitAnswer, SymmetryOfParts, flex};
pub use interlock::{
    DirectionsAnswer, InterlockAnswer, InterlockWord, KeyAnswer, LockedCore, SearchedAnswer, firm, interlock,
};
pub use play::{AxisPlay, Followed, PartPlay, PlayAnswer, PlayWord, play, word as play_word};
pub use preferred::{HandsAnswer, Met, PreferredAnswer, WishAnswer, preferred};
pub use release::{
    BracketAnswer, Evidence, Length, ProcessRelease, ReleaseAnswer, ReleaseWord, bracket, length, needs_none,
};
pub use repeats::RepeatsAnswer;
pub use sampling::{check_of, refined, stress_of};
pub use weave::{WeaveAnswer, weave};

use crate::assembly::{Assembly, PartIx};
use crate::contact::Joined;
use crate::locking::{Check, Motion, Stress, Twist, Verdict};
use crate::sampling::{Refined, Sampling, standing};
use crate::sequence::Plan;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The spec an answer is about, as it was read.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Source {
    /// Path as given; files that the spec names are relative to its folder.
    pub file: String,
    pub text: String,
}

/// A contact force along a contact row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ForceAnswer {
    pub a: String,
    pub b: String,
    /// Unit normal from a to b.
    pub normal: [f64; 3],
    /// A corner of the contact patch, model units.
    pub point: [f64; 3],
    /// At least 1.
    pub size: f64,
}

/// Proof of a lock: forces on contact rows that balance on every part that could move (Stiemke's theorem).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Certificate {
    pub kind: String,
    /// Parts that the balance leaves out: held, or fixed where none is held.
    pub still: Vec<String>,
    pub unknowns: usize,
    /// Rank of the rows that carry a force; the proof needs it to equal `unknowns`.
    pub rank: usize,
    /// Largest component by which the forces miss balance.
    pub residual: f64,
    pub forces: Vec<ForceAnswer>,
}

/// Velocity of a part: v(p) = translation + rotation x (p - centre).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TwistAnswer {
    pub part: String,
    pub translation: [f64; 3],
    /// Radians for each model unit of the largest translation.
    pub rotation: [f64; 3],
    pub centre: [f64; 3],
}

/// Proof of freedom: a motion that no contact row forbids.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MotionAnswer {
    /// `opens` where some contact opens, `slides` where every contact stays closed.
    pub kind: String,
    pub twists: Vec<TwistAnswer>,
    /// Fastest opening of a contact.
    pub opening: f64,
    /// How far the worst row is below 0, from round-off.
    pub round_off: f64,
}

/// Why neither proof holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GapAnswer {
    pub why: String,
    /// Size of what is missing, where it has one.
    pub size: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Word {
    Locked,
    Free,
    Undecided,
}

/// A verdict with exactly one witness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Proof {
    pub verdict: Word,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub certificate: Option<Certificate>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionAnswer>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap: Option<GapAnswer>,
}

/// Answer of `check`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CheckAnswer {
    pub verb: String,
    pub name: String,
    /// The verdict for rigid motions, with its witness.
    #[serde(flatten)]
    pub rigid: Proof,
    /// The verdict for translations alone.
    pub translation: Word,
    pub translation_proof: Proof,
    pub parts: usize,
    /// Contact patches.
    pub contacts: usize,
    /// Contact rows for rigid motions.
    pub rows: usize,
    pub held: Vec<String>,
    /// The part taken as fixed where none is held; the verdict does not depend on which.
    pub fixed: Option<String>,
    /// Locked whichever one part is held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interlocked: Option<InterlockWord>,
    /// Keys and cores.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interlock: Option<InterlockAnswer>,
    /// Margins, and whether the verdicts hold beyond the samples.
    #[serde(flatten)]
    pub sampling: Sampling,
    /// The check repeated with more samples, where that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refine: Option<Refined>,
    pub remarks: Vec<String>,
    pub source: Source,
    pub checksum: String,
}

/// Answer of `plan`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlanAnswer {
    pub verb: String,
    pub name: String,
    #[serde(flatten)]
    pub plan: Plan<Certificate>,
    /// The parts planned for; others were left out.
    pub of: Vec<String>,
    /// Air on each face of a contact, mm; 0: the parts as they touch.
    pub clearance_mm: f64,
    /// What was rather had of the order, and what came of it, where that was asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preferences: Option<PreferredAnswer>,
    pub remarks: Vec<String>,
    pub source: Source,
    pub checksum: String,
}

/// An answer that `verify` reads.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Sealed {
    Check(Box<CheckAnswer>),
    Plan(Box<PlanAnswer>),
    Flex(Box<FlexAnswer>),
    Repeats(Box<RepeatsAnswer>),
    Release(Box<ReleaseAnswer>),
}

pub fn ids(assembly: &Assembly, parts: &[PartIx]) -> Vec<String> {
    parts.iter().map(|&p| assembly.part(p).id.clone()).collect()
}

pub fn check(joined: &Joined, check: &Check, source: Source) -> CheckAnswer {
    let assembly = &joined.assembly;
    let still: Vec<PartIx> = check.held.iter().copied().chain(check.fixed).collect();
    let translation_proof = proof(assembly, &still, &check.translation);
    let answer = CheckAnswer {
        verb: "check".into(),
        name: assembly.name.clone(),
        rigid: proof(assembly, &still, &check.rigid),
        translation: translation_proof.verdict,
        translation_proof,
        parts: assembly.parts.len(),
        contacts: joined.patches.len(),
        rows: check.rows,
        held: ids(assembly, &check.held),
        fixed: check.fixed.map(|p| assembly.part(p).id.clone()),
        interlocked: None,
        interlock: None,
        sampling: standing(joined, check),
        refine: None,
        remarks: joined.remarks.clone(),
        source,
        checksum: String::new(),
    };
    CheckAnswer { checksum: checksum(&answer), ..answer }
}

/// The answer with what was found about keys and cores.
pub fn with_interlock(answer: CheckAnswer, interlock: InterlockAnswer) -> CheckAnswer {
    let (interlocked, checksum) = (Some(interlock.word), String::new());
    let answer = CheckAnswer { interlocked, interlock: Some(interlock), checksum, ..answer };
    CheckAnswer { checksum: self::checksum(&answer), ..answer }
}

pub fn plan(
    joined: &Joined,
    plan: Plan<Certificate>,
    of: &[PartIx],
    clearance_mm: f64,
    remark: Option<String>,
    source: Source,
) -> PlanAnswer {
    let assembly = &joined.assembly;
    let remarks = joined.remarks.iter().cloned().chain(remark).collect();
    let answer = PlanAnswer {
        verb: "plan".into(),
        name: assembly.name.clone(),
        plan,
        of: ids(assembly, of),
        clearance_mm,
        preferences: None,
        remarks,
        source,
        checksum: String::new(),
    };
    PlanAnswer { checksum: checksum(&answer), ..answer }
}

/// CRC-32 of the answer as JSON with an empty checksum.
pub fn checksum(answer: &impl Serialize) -> String {
    format!("crc32:{:08x}", crc32fast::hash(serde_json::to_string(answer).unwrap_or_default().as_bytes()))
}

pub fn proof(assembly: &Assembly, still: &[PartIx], verdict: &Verdict) -> Proof {
    let none = |verdict| Proof { verdict, certificate: None, motion: None, gap: None };
    match verdict {
        Verdict::Locked(stress) => {
            Proof { certificate: Some(certificate(assembly, still, stress)), ..none(Word::Locked) }
        }
        Verdict::Free(motion) => Proof { motion: Some(written(assembly, motion)), ..none(Word::Free) },
        Verdict::Undecided(gap) => {
            let size = gap.size.is_finite().then_some(gap.size);
            Proof { gap: Some(GapAnswer { why: gap.why.clone(), size }), ..none(Word::Undecided) }
        }
    }
}

pub fn certificate(assembly: &Assembly, still: &[PartIx], stress: &Stress) -> Certificate {
    let force = |f: &crate::locking::Force| ForceAnswer {
        a: assembly.part(f.row.a).id.clone(),
        b: assembly.part(f.row.b).id.clone(),
        normal: f.row.normal.to_array(),
        point: f.row.point.to_array(),
        size: f.size,
    };
    Certificate {
        kind: "self-stress".into(),
        still: ids(assembly, still),
        unknowns: stress.rank,
        rank: stress.rank,
        residual: stress.residual,
        forces: stress.forces.iter().map(force).collect(),
    }
}

fn written(assembly: &Assembly, motion: &Motion) -> MotionAnswer {
    let arrays = |v: DVec3| v.to_array();
    let twist = |(p, t): &(PartIx, Twist)| TwistAnswer {
        part: assembly.part(*p).id.clone(),
        translation: arrays(t.translation),
        rotation: arrays(t.rotation),
        centre: arrays(t.centre),
    };
    let kind = if motion.opening > 0.0 { "opens" } else { "slides" };
    MotionAnswer {
        kind: kind.into(),
        twists: motion.twists.iter().map(twist).collect(),
        opening: motion.opening,
        round_off: motion.worst,
    }
}
