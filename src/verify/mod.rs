//! Takes an answer as written; says whether it holds, without the solver or planner that made it.
//!
//! The spec in the answer is read again and its contacts built again, so an answer about other contacts is refused.
//! Not promised: that the spec is the one its reader meant.

pub mod certificate;
mod digits;
mod dyadic;
mod field;
mod flex;
pub mod follow;
mod group;
mod interlock;
mod mend;
mod motion;
mod number;
mod order;
pub mod plan;
mod release;
mod repeats;
mod singular;
mod stress;

use crate::assembly::{Assembly, PartIx};
use crate::contact::{self, Joined};
use crate::fault::Faults;
use crate::locking::Freedom;
use crate::report::answer::{self, CheckAnswer, PlanAnswer, Sealed};
use crate::sampling::known;
use crate::sequence::Outcome;
use crate::sequence::clearance::with_clearance;
use crate::spec::{self, Syntax};
use certificate::{About, Arithmetic, Shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Answer of `verify`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Verified {
    pub verb: String,
    pub valid: bool,
    pub why: String,
    /// What the proofs were found true for: the weakest of them; null where one is refused.
    pub arithmetic: Option<Arithmetic>,
    /// Every proof that holds, by what it is about: `rigid`, `translation`, or a lock that a plan quotes.
    pub proofs: BTreeMap<String, Shown>,
}

/// Reads the spec of an answer again and holds the answer against it.
pub fn answer(sealed: &Sealed) -> Result<Verified, Faults> {
    match sealed {
        Sealed::Check(a) => {
            let spec = parsed(&a.source)?;
            let found = check(&spec, &contact::join(&spec)?, a);
            Ok(verified(found, format!("the {} verdict and its proofs hold", word(a))))
        }
        Sealed::Plan(a) => {
            let spec = parsed(&a.source)?;
            let found = plan(&spec, &contact::join(&spec)?, a);
            Ok(verified(found, "every move and every proof of the plan holds".into()))
        }
        Sealed::Flex(a) => flex::answer(a),
        Sealed::Repeats(a) => repeats::answer(a),
        Sealed::Release(a) => release::answer(a),
    }
}

fn parsed(source: &answer::Source) -> Result<spec::Spec, Faults> {
    let file = Path::new(&source.file);
    spec::parse(&source.text, file, Syntax::of(file, &source.text))
}

/// The assembly of an answer, built again.
fn rebuild(source: &answer::Source) -> Result<Joined, Faults> {
    contact::join(&parsed(source)?)
}

fn verified(found: Result<Proofs, String>, good: String) -> Verified {
    let (valid, why, proofs) =
        found.map_or_else(|why| (false, why, BTreeMap::new()), |proofs| (true, good, proofs));
    let arithmetic = proofs.values().map(|p| p.arithmetic).max();
    Verified { verb: "verify".into(), valid, why, arithmetic, proofs }
}

type Proofs = BTreeMap<String, Shown>;

fn word(a: &CheckAnswer) -> &'static str {
    match a.rigid.verdict {
        answer::Word::Locked => "locked",
        answer::Word::Free => "free",
        answer::Word::Undecided => "undecided",
    }
}

fn check(spec: &spec::Spec, joined: &Joined, a: &CheckAnswer) -> Result<Proofs, String> {
    sealed(&a.checksum, &CheckAnswer { checksum: String::new(), ..a.clone() })?;
    let asm = &joined.assembly;
    let rows = joined.patches.iter().map(|p| p.corners.len()).sum::<usize>();
    let held = answer::ids(asm, &asm.held().collect::<Vec<_>>());
    same("parts", a.parts, asm.parts.len())?;
    same("contacts", a.contacts, joined.patches.len())?;
    same("rows", a.rows, rows)?;
    same("held", &a.held, &held)?;
    same("verb", a.verb.as_str(), "check")?;
    same("translation", a.translation, a.translation_proof.verdict)?;
    let still: Vec<String> = match (&a.fixed, held.is_empty()) {
        (Some(id), true) => vec![id.clone()],
        (None, false) => held,
        _ => return Err("a part is fixed exactly where none is held".into()),
    };
    let rigid = certificate::proof(asm, &joined.patches, &a.rigid, &still, About::RigidMotions)?;
    let translation =
        certificate::proof(asm, &joined.patches, &a.translation_proof, &still, About::Translations)
            .map_err(|why| format!("translations: {why}"))?;
    within_digits(joined, a)?;
    sampling(joined, a)?;
    levels(spec, a)?;
    interlock::claims(joined, a)?;
    Ok(BTreeMap::from([("rigid".into(), rigid), ("translation".into(), translation)]))
}

/// A lock that the files' digits are found to leave open is none.
fn within_digits(joined: &Joined, a: &CheckAnswer) -> Result<(), String> {
    let check = answer::check_of(&joined.assembly, a).ok_or("the answer names parts that are not there")?;
    let still: Vec<PartIx> = check.held.iter().copied().chain(check.fixed).collect();
    for (freedom, verdict) in [(Freedom::Rigid, check.rigid), (Freedom::Translation, check.translation)] {
        let word = verdict.word();
        same("verdict within the files' digits", word, known(joined, &still, freedom, verdict).word())?;
    }
    Ok(())
}

/// Margins and chord errors are computed again, by the code that they came from: a change is noticed, and no more.
fn sampling(joined: &Joined, a: &CheckAnswer) -> Result<(), String> {
    let check = answer::check_of(&joined.assembly, a).ok_or("the answer names parts that are not there")?;
    let found = crate::sampling::standing(joined, &check);
    if found != a.sampling {
        return Err("margin, chord error and what holds beyond the samples are not those found again".into());
    }
    Ok(())
}

/// The levels of a refinement, computed again.
fn levels(spec: &spec::Spec, a: &CheckAnswer) -> Result<(), String> {
    let Some(claimed) = &a.refine else { return Ok(()) };
    let found = crate::sampling::refined(spec).map_err(|f| f.to_string())?;
    if found == *claimed {
        Ok(())
    } else {
        Err("the levels of the refinement are not those found again".into())
    }
}

fn plan(spec: &spec::Spec, joined: &Joined, a: &PlanAnswer) -> Result<Proofs, String> {
    let mut proofs = Proofs::new();
    sealed(&a.checksum, &PlanAnswer { checksum: String::new(), ..a.clone() })?;
    same("verb", a.verb.as_str(), "plan")?;
    let parts = parts(joined, &a.of)?;
    let made = as_made(joined, a.clearance_mm)?;
    match plan::check_of(&made, &parts, &a.plan) {
        plan::Checked::Valid { .. } => {}
        plan::Checked::Invalid { step, parts, why, .. } => {
            return Err(format!("step {}: {}: {why}", step + 1, parts.join(", ")));
        }
        plan::Checked::Undecided { why } => return Err(format!("could not be decided: {why}")),
    }
    if let Some(claimed) = &a.plan.counted {
        plan::counted(&a.plan.steps, &a.of, claimed)?;
        group::allowed(spec, &joined.assembly, claimed)?;
    }
    for stuck in &a.plan.stuck {
        if let Some(lock) = &stuck.lock {
            same("clearance of a lock", a.clearance_mm, 0.0)?;
            proofs.insert(stuck.parts.join(", "), locked_alone(joined, &stuck.parts, lock)?);
            digits::holds(joined, &self::parts(joined, &stuck.parts)?, lock)?;
        }
    }
    let proven = a.plan.stuck.iter().any(|s| s.lock.is_some());
    match (a.plan.outcome, a.plan.stuck.is_empty(), proven) {
        (Outcome::Assembled, true, _)
        | (Outcome::NeedsFlexible, false, true)
        | (Outcome::NotFound, false, false) => Ok(proofs),
        (outcome, ..) => Err(format!("the outcome {outcome:?} does not follow from what stayed together")),
    }
}

/// The assembly that a plan at a clearance is about.
fn as_made(joined: &Joined, clearance_mm: f64) -> Result<Assembly, String> {
    let asm = &joined.assembly;
    if clearance_mm == 0.0 {
        return Ok(asm.clone());
    }
    with_clearance(asm, &joined.patches, clearance_mm / asm.mm_per_unit).map_err(|e| e.to_string())
}

/// The certificate is about these parts alone: all others are still, and contacts with them do not count.
fn locked_alone(joined: &Joined, ids: &[String], lock: &answer::Certificate) -> Result<Shown, String> {
    let asm = &joined.assembly;
    let inside = parts(joined, ids)?;
    let patches: Vec<_> =
        joined.patches.iter().filter(|p| inside.contains(&p.a) && inside.contains(&p.b)).cloned().collect();
    let free: Vec<PartIx> =
        inside.iter().copied().filter(|&p| !lock.still.contains(&asm.part(p).id)).collect();
    let held = inside.iter().any(|&p| asm.held().any(|h| h == p));
    // Without a held part one may be taken as fixed, no more; with some, just these.
    let missing = inside.len() - free.len();
    let own = inside.iter().filter(|&&p| asm.held().any(|h| h == p)).count();
    if (held && missing != own) || (!held && missing > 1) {
        return Err("a lock is claimed with more parts fixed than may be".into());
    }
    let outside = asm.ids().filter(|p| !inside.contains(p)).map(|p| asm.part(p).id.clone());
    let still = lock.still.iter().cloned().chain(outside).collect();
    let alone = answer::Certificate { still, ..lock.clone() };
    certificate::certificate(asm, &patches, &alone, About::RigidMotions)
}

fn parts(joined: &Joined, ids: &[String]) -> Result<Vec<PartIx>, String> {
    let asm = &joined.assembly;
    let find =
        |id: &String| asm.ids().find(|&p| asm.part(p).id == *id).ok_or(format!("no part is called `{id}`"));
    ids.iter().map(find).collect()
}

fn sealed(found: &str, without: &impl Serialize) -> Result<(), String> {
    let expected = answer::checksum(without);
    if found == expected {
        Ok(())
    } else {
        Err(format!("the answer was changed: its checksum is {expected}, not {found}"))
    }
}

fn same<T: PartialEq + std::fmt::Debug>(what: &str, claimed: T, found: T) -> Result<(), String> {
    if claimed == found { Ok(()) } else { Err(format!("{what}: {claimed:?} is claimed, {found:?} is found")) }
}
