//! Takes what `repeats` tried; gives its answer as it is written: a table whose rows each carry their proof.
//!
//! Not promised: an answer for swatches that are not in the table, but for the classes of `every_size`.

use super::{Proof, Word, checksum, proof};
use crate::assembly::PartIx;
use crate::locking::Verdict;
use crate::made::Made;
use crate::repeats::explain::Loose;
use crate::repeats::grow::Class;
use crate::repeats::{AsMade, Tried};
use crate::sequence::Plan;
use crate::spec::{ProfileSpec, Shape};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One swatch and its verdicts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RepeatsRow {
    pub k: u32,
    pub phase: i32,
    pub swatch: SwatchAnswer,
    pub profile: ProfileAnswer,
    pub parts: usize,
    pub translation: Word,
    pub rigid: Word,
    /// What the rigid verdict rests on, in words.
    pub witness: String,
    /// Fewest changes of side among the pieces: over to under a thread that is there, or back.
    pub least_interlacing: usize,
    /// Why pieces are loose, where the verdict is free: the fastest that the motion moves.
    pub loose: Vec<Loose>,
    /// The parts as made, where a clearance was asked.
    pub as_made: Option<MadeAnswer>,
    /// Proof of the rigid verdict: a certificate, a motion or a gap; part 0 is taken as fixed.
    pub proof: Proof,
    /// The spec that was decided.
    pub spec: String,
}

/// Strands of a swatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
pub struct SwatchAnswer {
    pub wefts: u32,
    pub warps: u32,
}

/// The profile of all strands, lengths in crossings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProfileAnswer {
    /// Null where the centreline has control points of its own.
    pub rise: Option<f64>,
    pub lift: f64,
    pub cover: f64,
    pub samples: u32,
}

/// What is known of parts made with air in their contacts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MadeAnswer {
    /// Air on each face of a contact.
    pub clearance_mm: f64,
    /// `comes-apart` with a plan; `not-found`: no plan was found, which proves nothing.
    pub verdict: String,
    pub plan: Option<Plan<()>>,
    /// What was searched, where nothing was found.
    pub why: Option<String>,
}

/// The least k for one profile and swatch, over the phases asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CaseAnswer {
    pub profile: ProfileAnswer,
    pub swatch: SwatchAnswer,
    pub phases: Vec<i32>,
    /// Least k that locks at every phase; null where none was found up to `searched`, or a smaller one is undecided.
    pub minimal_repeat: Option<u32>,
    /// For each phase its own least k.
    pub by_phase: Vec<Option<u32>>,
    pub searched: u32,
    /// With a clearance: least k at which no plan takes every phase apart; not proven locked.
    pub no_plan_from: Option<u32>,
}

/// Swatches of one class of sizes, proven together: wefts + i * `step[0]`, warps + j * `step[1]` for all i, j >= 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClassAnswer {
    pub step: [u32; 2],
    /// The word for the class: that of its smallest swatch where that is locked and the lemma applies.
    pub holds: String,
    /// A strand of the smallest swatch that no piece crosses; null where each is crossed.
    pub uncrossed: Option<String>,
    pub base: RepeatsRow,
}

/// Answer of `repeats`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RepeatsAnswer {
    pub verb: String,
    pub weave: String,
    /// Least k that locks at every phase, swatch and profile asked for; null where none was found.
    pub minimal_repeat: Option<u32>,
    /// Largest k that was tried.
    pub searched: u32,
    pub cases: Vec<CaseAnswer>,
    pub table: Vec<RepeatsRow>,
    /// Proofs for swatches of every size, where asked; of the k of `minimal_repeat`.
    pub every_size: Vec<ClassAnswer>,
    /// True where the user stopped the search before it was done: `minimal_repeat` is null then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
    pub remarks: Vec<String>,
    pub checksum: String,
}

/// One profile and swatch with all that was tried for it.
pub struct Case<'a> {
    pub profile: &'a ProfileSpec,
    pub tried: &'a [Tried],
}

pub fn repeats(
    weave: &str,
    cases: &[Case],
    classes: (&ProfileSpec, &[Class]),
    made: AsMade,
    remarks: Vec<String>,
) -> RepeatsAnswer {
    let table: Vec<RepeatsRow> =
        cases.iter().flat_map(|c| c.tried.iter().map(|t| row(c.profile, t, made))).collect();
    let told: Vec<CaseAnswer> = cases.iter().filter_map(case).collect();
    let class = |c: &Class| ClassAnswer {
        step: [c.step.0, c.step.1],
        holds: class_word(c).into(),
        uncrossed: c.uncrossed.map(|s| s.to_string()),
        base: row(classes.0, &c.base, made),
    };
    let answer = RepeatsAnswer {
        verb: "repeats".into(),
        weave: weave.into(),
        minimal_repeat: overall(&told, &table),
        searched: table.iter().map(|t| t.k).max().unwrap_or(0),
        cases: told,
        every_size: classes.1.iter().map(class).collect(),
        table,
        stopped: false,
        remarks,
        checksum: String::new(),
    };
    RepeatsAnswer { checksum: checksum(&answer), ..answer }
}

fn class_word(c: &Class) -> &'static str {
    match (&c.base.rigid, &c.flaw) {
        (Verdict::Locked(_), None) => "locked",
        (Verdict::Free(_), _) => "free at the smallest",
        _ => "not proven",
    }
}

/// The largest least k, where every case is locked at it.
pub fn overall(cases: &[CaseAnswer], table: &[RepeatsRow]) -> Option<u32> {
    let all: Option<Vec<u32>> = cases.iter().map(|c| c.minimal_repeat).collect();
    let k = all?.into_iter().max()?;
    let locked = |c: &CaseAnswer| {
        let rows = || table.iter().filter(|r| r.k == k && r.swatch == c.swatch && r.profile == c.profile);
        c.phases.iter().all(|p| rows().any(|r| r.phase == *p && r.holds()))
    };
    cases.iter().all(locked).then_some(k)
}

impl RepeatsRow {
    /// Proven locked, as asked.
    pub fn holds(&self) -> bool {
        self.rigid == Word::Locked && self.as_made.is_none()
    }

    pub fn comes_apart(&self) -> bool {
        self.as_made.as_ref().is_some_and(|m| m.verdict == "comes-apart")
    }
}

fn case(c: &Case) -> Option<CaseAnswer> {
    let first = c.tried.first()?;
    let mut phases: Vec<i32> = c.tried.iter().map(|t| t.swatch.phase).collect();
    phases.sort_unstable();
    phases.dedup();
    let at = |k: u32| c.tried.iter().filter(move |t| t.swatch.repeat == k);
    let searched = c.tried.iter().map(|t| t.swatch.repeat).max().unwrap_or(0);
    let first_k =
        |holds: &dyn Fn(&Tried) -> bool| (1..=searched).find(|&k| at(k).count() > 0 && at(k).all(holds));
    // The least only where each smaller k is known not to lock: undecided is not free.
    let free = |t: &Tried| matches!(t.rigid, Verdict::Free(_));
    let minimal = first_k(&Tried::holds).filter(|&k| (1..k).all(|j| at(j).any(free)));
    let own = |&phase: &i32| {
        let rows = || c.tried.iter().filter(move |t| t.swatch.phase == phase);
        let k = rows().filter(|t| t.holds()).map(|t| t.swatch.repeat).min()?;
        rows().filter(|t| t.swatch.repeat < k).all(free).then_some(k)
    };
    Some(CaseAnswer {
        profile: profile(c.profile),
        swatch: SwatchAnswer { wefts: first.swatch.wefts, warps: first.swatch.warps },
        minimal_repeat: minimal,
        by_phase: phases.iter().map(own).collect(),
        searched,
        no_plan_from: first_k(&|t| matches!(t.made, Some(Made::NotFound { .. }))),
        phases,
    })
}

fn profile(p: &ProfileSpec) -> ProfileAnswer {
    let rise = match p.shape {
        Shape::Rise(rise) => Some(rise),
        Shape::Points(_) => None,
    };
    ProfileAnswer { rise, lift: p.lift, cover: p.cover, samples: p.samples }
}

fn row(with: &ProfileSpec, t: &Tried, made: AsMade) -> RepeatsRow {
    RepeatsRow {
        k: t.swatch.repeat,
        phase: t.swatch.phase,
        swatch: SwatchAnswer { wefts: t.swatch.wefts, warps: t.swatch.warps },
        profile: profile(with),
        parts: t.parts,
        translation: word(&t.translation),
        rigid: word(&t.rigid),
        witness: witness(&t.rigid),
        least_interlacing: t.least_interlacing,
        loose: t.loose.clone(),
        as_made: t.made.as_ref().map(|m| made_answer(m, made)),
        proof: proof(&t.outline, &[PartIx(0)], &t.rigid),
        spec: t.text.clone(),
    }
}

fn made_answer(made: &Made, at: AsMade) -> MadeAnswer {
    let (plan, why) = match made {
        Made::ComesApart { plan } => (Some((**plan).clone()), None),
        Made::NotFound { why } => (None, Some(why.clone())),
    };
    MadeAnswer { clearance_mm: at.clearance_mm, verdict: made.word().into(), plan, why }
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
