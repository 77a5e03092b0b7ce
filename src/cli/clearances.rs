//! Takes what the command line says of clearances; gives the one of all processes and those of single ones, or every fault.
//!
//! Not promised: that a process is in use; `make` looks at that, where processes are known.

use super::args::length;
use std::collections::{BTreeMap, BTreeSet};
use weavelock_fab::process::Overrides;

/// In mm on each face.
#[derive(Debug, Default, PartialEq)]
pub struct Clearances {
    pub all: Option<f64>,
    pub of: BTreeMap<String, f64>,
}

/// From `0.25 mm` for all processes and `sla=0.1 mm` for one.
pub fn clearances(texts: &[String]) -> Result<Clearances, Vec<String>> {
    let (mut found, mut faults) = (Clearances::default(), Vec::new());
    for text in texts {
        let (process, given) = match text.rsplit_once('=') {
            Some((process, given)) => (Some(process.trim()), given.trim()),
            None => (None, text.trim()),
        };
        let mm = match (process, length(given)) {
            (Some(""), _) => Err("no process stands before \"=\"".to_string()),
            (_, read) => read,
        };
        let mm = match mm {
            Ok(mm) => mm,
            Err(why) => {
                let hint = "as in --clearance \"0.25 mm\", or --clearance \"sla=0.1 mm\" for one process";
                faults.push(format!("--clearance {text:?}: {why}\n  hint: {hint}"));
                continue;
            }
        };
        let before = match process {
            None => found.all.replace(mm),
            Some(name) => found.of.insert(name.to_string(), mm),
        };
        if before.is_some() {
            let whom = process.map_or("all processes".to_string(), |name| format!("{name:?}"));
            faults.push(format!("--clearance gives two figures for {whom}\n  hint: a process has one"));
        }
    }
    if faults.is_empty() { Ok(found) } else { Err(faults) }
}

/// Clearances of processes that make no part.
pub fn of_nobody(own: &Overrides, makers: &BTreeSet<&str>) -> Vec<String> {
    let nobody = own.clearances.keys().filter(|name| !makers.contains(name.as_str()));
    let makers = makers.iter().copied().collect::<Vec<_>>().join(", ");
    let told = |name: &String| {
        format!(
            "a clearance is given for {name:?}, by which no part is made\n  hint: parts are made by {makers}"
        )
    };
    nobody.map(told).collect()
}
