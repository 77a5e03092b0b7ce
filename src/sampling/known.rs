//! Takes parts that are known to their files' digits; gives their check, where a lock that the digits leave open is
//! undecided.
//!
//! Sound: what stays locked was locked before. Not complete: motions are tried, not all; a lock that stays may still
//! fall within the digits (`beyond_sampling` says whether it is shown not to).

use super::Ground;
use crate::assembly::PartIx;
use crate::contact::{Joined, Origin};
use crate::locking::margin::{self, PROGRAMS};
use crate::locking::{Check, Freedom, Gap, Verdict, check_loose};

/// Locked, free or undecided, for translations and for rigid motions.
pub fn checked(joined: &Joined, fix: Option<PartIx>) -> Check {
    let check = check_loose(&joined.assembly, &joined.patches, &joined.loose, fix);
    let still: Vec<PartIx> = check.held.iter().copied().chain(check.fixed).collect();
    let translation = known(joined, &still, Freedom::Translation, check.translation.clone());
    let rigid = known(joined, &still, Freedom::Rigid, check.rigid.clone());
    Check { translation, rigid, ..check }
}

/// The verdict, or why it is undecided: some contact normals within what the digits say let a motion pass.
pub fn known(joined: &Joined, still: &[PartIx], freedom: Freedom, verdict: Verdict) -> Verdict {
    let exact = joined.known.iter().all(|&angle| angle == 0.0);
    let (Verdict::Locked(stress), Origin::Meshes, false) = (&verdict, &joined.origin, exact) else {
        return verdict;
    };
    if joined.patches.len() > super::MOST_PATCHES {
        return verdict;
    }
    let ground = Ground::new(joined, still.to_vec());
    let of = ground.weighed(freedom);
    let angles: Vec<f64> = of.errors.iter().map(|e| e.angle).collect();
    let change = angles.iter().zip(margin::speeds(&of.rows, &of.unknowns)).map(|(a, v)| a * v);
    let problem = of.weighted(change.collect());
    // First without programs: most locks survive by far.
    let bound = margin::lock(&problem, stress, 0).filter(|b| b.lower <= 1.0);
    let bound = bound.and_then(|_| margin::lock(&problem, stress, PROGRAMS)).filter(|b| b.lower <= 1.0);
    let open = bound.and_then(|b| margin::passing(&of.rows, &of.unknowns, &b.near, &angles));
    match open {
        None => verdict,
        Some(angle) => Verdict::Undecided(Gap {
            why: "locked as written, but the files' digits leave open a motion: contact normals are known no better \
                  than the turn that lets it pass (radians)"
                .into(),
            size: angle,
        }),
    }
}
