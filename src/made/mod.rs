//! Takes an assembly with its contacts and a clearance; gives what is known of parts made with that much air.
//!
//! With air in every contact anything can start to move, so no first-order lock exists; the question is how far. Told
//! are two things: a checked plan takes the parts apart, or nothing was found and what was searched is named. The last is
//! no proof of anything.

use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::sequence::clearance::with_clearance;
use crate::sequence::{self, Outcome, Plan};

/// What is known at a clearance.
#[derive(Clone, Debug)]
pub enum Made {
    ComesApart { plan: Box<Plan<()>> },
    NotFound { why: String },
}

impl Made {
    pub fn word(&self) -> &'static str {
        match self {
            Made::ComesApart { .. } => "comes-apart",
            Made::NotFound { .. } => "not-found",
        }
    }
}

/// `clearance` per face, in model units.
pub fn made(asm: &Assembly, patches: &[Patch], clearance: f64) -> Made {
    let all: Vec<PartIx> = asm.ids().collect();
    match planned(asm, &all, patches, clearance) {
        Ok(plan) if plan.outcome == Outcome::Assembled => Made::ComesApart { plan: Box::new(plan) },
        Ok(plan) => Made::NotFound { why: searched(&plan) },
        Err(why) => Made::NotFound { why: format!("no plan was searched: {why}") },
    }
}

/// The plan of parts made with a clearance.
pub fn planned(
    asm: &Assembly,
    parts: &[PartIx],
    patches: &[Patch],
    clearance: f64,
) -> Result<Plan<()>, String> {
    let made = with_clearance(asm, patches, clearance).map_err(|e| e.to_string())?;
    sequence::plan_of(&made, parts, &[], |_| None).map_err(|e| e.to_string())
}

fn searched(plan: &Plan<()>) -> String {
    let stuck: Vec<String> = plan.stuck.iter().map(|s| s.parts.len().to_string()).collect();
    format!(
        "straight moves of parts and groups, {} directions in {} sets, left {} parts together; turns and moves in \
         stages were not tried",
        plan.searched.directions,
        plan.searched.sets,
        stuck.join(" and ")
    )
}
