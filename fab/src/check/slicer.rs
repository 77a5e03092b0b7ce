//! Takes a part file; gives PrusaSlicer's word on whether it is one manifold body that needs no repair.
//!
//! It repairs STL in silence, so any count of repairs fails the part, also where it then says `manifold = yes`.

use super::run::{run, version};
use super::{Check, Outcome, check, value_of};
use std::path::Path;

/// What `--info` counts only where it had to mend something.
const REPAIRS: [&str; 6] = [
    "open_edges",
    "edges_fixed",
    "degenerate_facets",
    "facets_removed",
    "facets_reversed",
    "backwards_edges",
];

/// The slicer's name with its version.
pub fn name(program: &str) -> String {
    version(program, "--help").split_whitespace().next().unwrap_or(program).to_string()
}

pub fn part(program: &str, name: &str, file: &Path) -> Check {
    check(name, "manifold without repair", verdict(program, file))
}

fn verdict(program: &str, file: &Path) -> Result<(), Outcome> {
    let ran = run(program, &["--info".into(), file.display().to_string()])?;
    let said = ran.all();
    let failed = |why: String| Err(Outcome::Failed(why));
    if ran.code != Some(0) {
        return failed(format!("it exits {:?}", ran.code));
    }
    match value_of(&said, "manifold") {
        Some("yes") => {}
        other => return failed(format!("manifold = {}", other.unwrap_or("(not said)"))),
    }
    let repair =
        REPAIRS.iter().find_map(|k| value_of(&said, k).filter(|v| *v != "0").map(|v| format!("{k} = {v}")));
    match (repair, value_of(&said, "number_of_parts")) {
        (Some(repair), _) => failed(repair),
        (None, Some("1")) => Ok(()),
        (None, other) => failed(format!("number_of_parts = {}", other.unwrap_or("(not said)"))),
    }
}
