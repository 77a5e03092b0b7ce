//! Takes parts that are known to their files' digits; gives their check, where a lock that the digits leave open is
//! undecided.
//!
//! Sound: what stays locked was locked before. Not complete: motions are tried, not all; a lock that stays may still
//! fall within the digits (`beyond_sampling` says whether it is shown not to).

use crate::assembly::PartIx;
use crate::contact::Joined;
use crate::locking::digits::{guarded, rows_with_slack};
use crate::locking::{Check, Freedom, Unknowns, Verdict, check_loose};

/// Locked, free or undecided, for translations and for rigid motions.
pub fn checked(joined: &Joined, fix: Option<PartIx>) -> Check {
    let check = check_loose(&joined.assembly, &joined.patches, &joined.loose, fix);
    let still: Vec<PartIx> = check.held.iter().copied().chain(check.fixed).collect();
    let translation = known(joined, &still, Freedom::Translation, check.translation.clone());
    let rigid = known(joined, &still, Freedom::Rigid, check.rigid.clone());
    Check { translation, rigid, ..check }
}

/// The verdict, or why it is undecided: some contacts within what the digits say let a motion pass.
pub fn known(joined: &Joined, still: &[PartIx], freedom: Freedom, verdict: Verdict) -> Verdict {
    if joined.slack.is_empty() || joined.patches.len() > super::MOST_PATCHES {
        return verdict;
    }
    let (rows, slack) = rows_with_slack(&joined.patches, &joined.slack, freedom);
    let unknowns = Unknowns::new(&joined.assembly, &rows, still, freedom);
    guarded(&rows, &unknowns, &slack, verdict)
}
