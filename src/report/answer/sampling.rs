//! Takes a check as written; gives it as `locking` speaks of it, and with what refinement showed.
//!
//! Not promised: that a proof holds; `verify` finds out.

use super::{Certificate, CheckAnswer, Proof, Word, checksum};
use crate::assembly::Assembly;
use crate::locking::{Check, Force, Gap, Motion, Row, Stress, Twist, Verdict};
use crate::sampling::Refined;
use glam::DVec3;

/// The answer with the levels of a refinement in it.
pub fn refined(answer: CheckAnswer, refined: Refined) -> CheckAnswer {
    let answer = CheckAnswer { refine: Some(refined), checksum: String::new(), ..answer };
    CheckAnswer { checksum: checksum(&answer), ..answer }
}

/// The check that an answer was written from; none where it names parts that are not there, or lacks a witness.
pub fn check_of(assembly: &Assembly, answer: &CheckAnswer) -> Option<Check> {
    let part = |id: &String| assembly.ids().find(|&p| assembly.part(p).id == *id);
    Some(Check {
        rigid: verdict(assembly, &answer.rigid)?,
        translation: verdict(assembly, &answer.translation_proof)?,
        rows: answer.rows,
        held: answer.held.iter().map(part).collect::<Option<_>>()?,
        fixed: answer.fixed.as_ref().map(|id| part(id).ok_or(())).transpose().ok()?,
    })
}

/// The self-stress that a certificate was written from; none where it names parts that are not there.
pub fn stress_of(assembly: &Assembly, c: &Certificate) -> Option<Stress> {
    let part = |id: &String| assembly.ids().find(|&p| assembly.part(p).id == *id);
    let force = |f: &super::ForceAnswer| {
        let (normal, point) = (DVec3::from_array(f.normal), DVec3::from_array(f.point));
        Some(Force { row: Row { a: part(&f.a)?, b: part(&f.b)?, normal, point }, size: f.size })
    };
    let forces = c.forces.iter().map(force).collect::<Option<_>>()?;
    Some(Stress { forces, rank: c.rank, residual: c.residual, pivot_ratio: 0.0 })
}

fn verdict(assembly: &Assembly, proof: &Proof) -> Option<Verdict> {
    let part = |id: &String| assembly.ids().find(|&p| assembly.part(p).id == *id);
    Some(match proof.verdict {
        Word::Locked => Verdict::Locked(stress_of(assembly, proof.certificate.as_ref()?)?),
        Word::Free => {
            let m = proof.motion.as_ref()?;
            let twist = |t: &super::TwistAnswer| {
                let [translation, rotation, centre] =
                    [t.translation, t.rotation, t.centre].map(DVec3::from_array);
                Some((part(&t.part)?, Twist { translation, rotation, centre }))
            };
            let twists = m.twists.iter().map(twist).collect::<Option<_>>()?;
            Verdict::Free(Motion { twists, opening: m.opening, worst: m.round_off })
        }
        Word::Undecided => Verdict::Undecided(Gap { why: String::new(), size: f64::NAN }),
    })
}
