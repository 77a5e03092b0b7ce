//! Takes a lock that an answer quotes as a proof; says whether it holds whatever the files' digits leave open of the contacts.
//!
//! The margin is computed again from the forces as written, by the code that `cores` uses: its bound is proven with its
//! rounding counted. Not promised: a second way to the same bound.

use crate::assembly::PartIx;
use crate::contact::{Joined, Slack};
use crate::cores::Firm;
use crate::locking::digits::{Within, rows_with_slack, within};
use crate::locking::{Freedom, Row, Unknowns};
use crate::report::answer::{self, Certificate};

/// What is shown of a lock of these parts alone within the digits.
pub fn firm(joined: &Joined, inside: &[PartIx], lock: &Certificate) -> Result<Firm, String> {
    if joined.slack.is_empty() {
        return Ok(Firm::Holds);
    }
    let asm = &joined.assembly;
    let stress = answer::stress_of(asm, lock).ok_or("the certificate names parts that are not there")?;
    let (rows, slack) = rows_with_slack(&joined.patches, &joined.slack, Freedom::Rigid);
    let own = |r: &Row| inside.contains(&r.a) && inside.contains(&r.b);
    let (rows, slack): (Vec<Row>, Vec<Slack>) = rows.into_iter().zip(slack).filter(|(r, _)| own(r)).unzip();
    let moves = |p: &PartIx| inside.contains(p) && !lock.still.contains(&asm.part(*p).id);
    let still: Vec<PartIx> = asm.ids().filter(|p| !moves(p)).collect();
    let unknowns = Unknowns::new(asm, &rows, &still, Freedom::Rigid);
    match within(&rows, &unknowns, &slack, &stress) {
        Within::Survives => Ok(Firm::Holds),
        Within::Unproven => Ok(Firm::Unproven),
        Within::Open(_) => Err("the files' digits leave open a motion of these parts".into()),
    }
}

/// Refuses a lock that is given as a proof and is not shown within the digits.
pub fn holds(joined: &Joined, inside: &[PartIx], lock: &Certificate) -> Result<(), String> {
    match firm(joined, inside, lock)? {
        Firm::Holds => Ok(()),
        Firm::Unproven => Err("the lock is not shown to hold within the files' digits".into()),
    }
}
