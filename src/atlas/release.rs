//! Takes a weave and the least repetition that locks it; gives the bracket of the clearance that opens its swatch.
//!
//! By straight moves; the plan at the upper end is checked by `verify`, the lower end says that none was found. Not
//! promised: that turns or smaller clearances do not open it.

use super::row::{Release, Status};
use super::table::Ask;
use crate::assembly::{Assembly, PartIx, woven};
use crate::contact;
use crate::release::{At, bracket, range};
use crate::sequence::clearance::with_clearance;
use crate::sequence::{Motions, Outcome, plan_by};
use crate::spec::{Cut, Subject};
use crate::verify::plan::{Checked, check_of};
use crate::weave::Weave;

/// The bracket for the n x n swatch of pieces of `least` unit tiles at phase 0.
pub fn release(weave: &Weave, ask: &Ask, least: Option<u32>) -> Release {
    let n = weave.tile.0;
    let not_run = |why: String| Release { status: Status::NotRun, low: None, high: None, why };
    let Some(k) = least else {
        return not_run("no swatch was found to lock at phase 0".into());
    };
    if n > ask.release_up_to {
        return not_run(format!("a + b = {n} is over the {} that was asked for", ask.release_up_to));
    }
    let spec = super::row::swatch(weave, ask, Cut::Tiles, k);
    let Subject::Woven(of) = &spec.subject else { return not_run("no weave".into()) };
    match woven::build(&spec, of) {
        Err(faults) => not_run(faults.to_string()),
        Ok(built) => bracketed(&built.assembly, &contact::woven::patches(&built)),
    }
}

fn bracketed(asm: &Assembly, patches: &[contact::Patch]) -> Release {
    let found = bracket(range(asm), |clearance| opened(asm, patches, clearance));
    let high = found.hi.map(|h| h.0);
    let (status, why) = match (high, found.gone) {
        (Some(_), _) => (Status::Found, "straight moves".into()),
        (None, Some((at, part))) => (
            Status::Undecided,
            format!("no plan by straight moves was found before {at} leaves nothing: {part}"),
        ),
        (None, None) => (Status::Undecided, "no plan by straight moves was found".into()),
    };
    Release { status, low: Some(found.lo), high, why }
}

fn opened(asm: &Assembly, patches: &[contact::Patch], clearance: f64) -> At<()> {
    let made = match with_clearance(asm, patches, clearance) {
        Ok(made) => made,
        Err(gone) => return At::Gone(gone.to_string()),
    };
    let all: Vec<PartIx> = asm.ids().collect();
    match plan_by(&made, &all, &[], Motions::Straight, |_| None::<()>) {
        Err(fault) => At::NotFound(fault.to_string()),
        Ok(plan) if plan.outcome != Outcome::Assembled => At::NotFound("some parts stayed together".into()),
        Ok(plan) => match check_of(&made, &all, &plan) {
            Checked::Valid { .. } => At::Apart(()),
            Checked::Invalid { why, .. } | Checked::Undecided { why } => At::NotFound(why),
        },
    }
}
