//! Takes an assembly in place; gives the moves of its plan, made now or read from an answer of `plan`.
//!
//! Not promised: that a plan which is read belongs to the assembly beyond the names of its parts; `verify` checks plans.

use super::load::Placed;
use super::questions;
use super::told::Trouble;
use crate::assembly::PartIx;
use crate::fault::Fault;
use crate::input;
use crate::report::moves::{self, Moves};
use clap::Args;
use serde_json::Value;
use std::path::PathBuf;

/// Which plan is shown.
#[derive(Args, Debug, Default)]
pub struct Asked {
    /// The plan to show: an answer of `weavelock plan FILE --json` (default: planned now)
    #[arg(long, value_name = "ANSWER")]
    pub plan: Option<PathBuf>,
    /// Plan with this much air on each face of a contact: `--clearance "0.2 mm"`
    #[arg(long, value_name = "LENGTH", value_parser = super::args::length, conflicts_with = "plan")]
    pub clearance: Option<f64>,
}

pub fn moves(placed: &Placed, asked: &Asked) -> Result<Moves, Trouble> {
    let asm = &placed.joined.assembly;
    let ids: Vec<&str> = asm.parts.iter().map(|p| p.id.as_str()).collect();
    let answer = match &asked.plan {
        Some(file) => read(file)?,
        None => {
            let all: Vec<PartIx> = asm.ids().collect();
            let made = questions::planned(placed, &all, asked.clearance.unwrap_or(0.0));
            serde_json::to_value(&made).map_err(|e| Trouble::Word(format!("error: {e}")))?
        }
    };
    Ok(moves::read(&answer["steps"], &ids))
}

fn read(file: &std::path::Path) -> Result<Value, Trouble> {
    let text = input::text(input::answer_bytes(file)?, file)?;
    let wrong = |what: String| Fault {
        file: file.display().to_string(),
        place: None,
        key: "steps".into(),
        what,
        hint: "give what `weavelock plan FILE --json` printed".into(),
    };
    let answer: Value = serde_json::from_str(&text).map_err(|e| wrong(format!("this is no JSON: {e}")))?;
    if !answer["steps"].is_array() {
        return Err(wrong("this is no plan".into()).into());
    }
    Ok(answer)
}

/// Why there is nothing to show.
pub fn no_steps(asked: &Asked, moves: &Moves) -> String {
    let words = match (&moves.unread, &asked.plan, asked.clearance) {
        (Some(why), ..) => return why.clone(),
        (None, Some(file), _) => return format!("the plan in {} has no steps", file.display()),
        (None, None, Some(mm)) if mm > 0.0 => format!("no plan of rigid moves was found with {mm} mm of air"),
        _ => "there is no plan of rigid moves for the parts as they touch; with air between them there may be one: \
              --clearance \"0.2 mm\""
            .into(),
    };
    format!("{words} (`weavelock plan` says more)")
}

/// What a plan that is shown promises.
pub fn told(placed: &Placed, asked: &Asked, found: &Moves) -> String {
    let count = found.moves.len();
    let air = match (&asked.plan, asked.clearance) {
        (Some(file), _) => format!("as {} has it", file.display()),
        (None, Some(mm)) if mm > 0.0 => format!("for parts made with {mm} mm of air on each face"),
        _ => "for the parts as they touch".into(),
    };
    let unread = found.unread.as_ref().map_or(String::new(), |why| format!(" {why}."));
    format!("{} parts, {count} steps, {air}.{unread}", placed.joined.assembly.parts.len())
}
