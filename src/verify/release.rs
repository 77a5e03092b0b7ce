//! Takes an answer of `release`; says whether its upper ends and its lock hold.
//!
//! Not checked: that no plan exists at a lower end whose evidence is `not-found` (the answer claims no proof of that).

use super::{Proofs, Verified, locked_alone, parsed, plan, same, sealed, verified};
use crate::contact::{self, Joined};
use crate::fault::Faults;
use crate::report::answer::{BracketAnswer, Evidence, ReleaseAnswer, ReleaseWord};
use crate::spec::Spec;

pub(super) fn answer(a: &ReleaseAnswer) -> Result<Verified, Faults> {
    let spec = parsed(&a.source)?;
    let joined = contact::join(&spec)?;
    Ok(verified(release(&spec, &joined, a), "every plan at an upper end and every proof holds".into()))
}

fn release(spec: &Spec, joined: &Joined, a: &ReleaseAnswer) -> Result<Proofs, String> {
    sealed(&a.checksum, &ReleaseAnswer { checksum: String::new(), ..a.clone() })?;
    same("verb", a.verb.as_str(), "release")?;
    let mut proofs = Proofs::new();
    let all: Vec<String> = joined.assembly.parts.iter().map(|p| p.id.clone()).collect();
    if let Some(lock) = &a.certificate {
        proofs.insert("locked at zero clearance".into(), locked_alone(joined, &all, lock)?);
    }
    let mut best = f64::INFINITY;
    for b in &a.brackets {
        best = best.min(upper_end(spec, joined, b, &mut proofs)?);
        if b.evidence == Evidence::Locked && a.certificate.is_none() {
            return Err(format!("{}: locked without a proof", b.motions));
        }
    }
    let word = match best {
        0.0 => ReleaseWord::NeedsNone,
        b if b.is_finite() => ReleaseWord::Opens,
        _ => ReleaseWord::NotFound,
    };
    if a.outcome == word {
        Ok(proofs)
    } else {
        Err(format!("{:?} does not follow from the brackets", a.outcome))
    }
}

/// The clearance at the upper end, mm; infinite where there is none.
fn upper_end(spec: &Spec, joined: &Joined, b: &BracketAnswer, proofs: &mut Proofs) -> Result<f64, String> {
    match (&b.plan, b.hi) {
        (None, None) => Ok(f64::INFINITY),
        (Some(found), Some(hi)) => {
            same("clearance of a plan", found.clearance_mm, hi.clearance_mm)?;
            same("parts of a plan", found.of.len(), joined.assembly.parts.len())?;
            if !found.plan.stuck.is_empty() {
                return Err(format!("{}: the plan leaves parts together", b.motions));
            }
            proofs.extend(plan(spec, joined, found)?);
            Ok(hi.clearance_mm)
        }
        _ => Err(format!("{}: an upper end and its plan belong together", b.motions)),
    }
}
