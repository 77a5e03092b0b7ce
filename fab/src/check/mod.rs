//! Takes written files and what is expected of them; gives what programs of others say.
//!
//! Not promised: that a program which passes a part has seen everything; each looks for its own kinds of fault. One
//! that is absent, or gives no answer, is `NotRun`, never `Passed`.

pub mod admesh;
pub mod openscad;
pub mod run;
pub mod slicer;

use serde::Serialize;

/// What came of one check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "outcome", content = "because")]
pub enum Outcome {
    Passed,
    Failed(String),
    NotRun(String),
}

/// One check of one thing by one program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// The program, with its version where it told one.
    pub by: String,
    /// What was looked at.
    pub of: String,
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// What the programs are called, or where they are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Programs {
    pub openscad: String,
    pub slicer: String,
    pub admesh: String,
}

impl Default for Programs {
    fn default() -> Self {
        let [openscad, slicer, admesh] = ["openscad", "prusa-slicer", "admesh"].map(String::from);
        Programs { openscad, slicer, admesh }
    }
}

/// Runs what gives `Ok` for a pass, and names the check.
pub(crate) fn check(by: &str, of: &str, verdict: Result<(), Outcome>) -> Check {
    Check { by: by.to_string(), of: of.to_string(), outcome: verdict.err().unwrap_or(Outcome::Passed) }
}

/// The line's value where it has the form `key = value` or `key : value`.
pub(crate) fn value_of<'a>(text: &'a str, key: &str) -> Option<&'a str> {
    text.lines().find_map(|line| {
        let rest = &line[line.find(key)? + key.len()..];
        rest.trim_start().strip_prefix(['=', ':'])?.split_whitespace().next()
    })
}
