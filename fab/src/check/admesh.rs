//! Takes a part file; gives ADMesh's word on its edges and its sign. It misses overlaps and always exits 0.

use super::run::{run, version};
use super::{Check, Outcome, check, value_of};
use std::path::Path;

/// Counts that are 0 for a sound file.
const COUNTS: [&str; 7] = [
    "Total disconnected facets",
    "Degenerate facets",
    "Edges fixed",
    "Facets removed",
    "Facets reversed",
    "Backwards edges",
    "Normals fixed",
];

/// The program's name with its version.
pub fn name(program: &str) -> String {
    version(program, "--version")
}

pub fn part(program: &str, name: &str, file: &Path) -> Check {
    check(name, "closed, consistent, positive volume", verdict(program, file))
}

fn verdict(program: &str, file: &Path) -> Result<(), Outcome> {
    let ran = run(program, &["-e".into(), file.display().to_string()])?;
    let failed = |why: String| Err(Outcome::Failed(why));
    for key in COUNTS {
        match value_of(&ran.stdout, key) {
            Some("0") => {}
            other => return failed(format!("{key}: {}", other.unwrap_or("(not said)"))),
        }
    }
    match value_of(&ran.stdout, "Volume").and_then(|v| v.parse::<f64>().ok()) {
        Some(v) if v > 0.0 => Ok(()),
        other => failed(format!("Volume: {other:?}")),
    }
}
