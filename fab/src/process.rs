//! Takes a process file (TOML) and the user's own figures; gives a process whose numbers all make sense, or every fault
//! of the file with its line and a hint.
//!
//! Not promised: that a figure is right for the machine at hand. Its source and grade say how well it stands.

use crate::toml_faults::{Cursor, FileFault};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

/// How well a number stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Grade {
    /// The text of the source was seen.
    S,
    /// Second hand.
    #[serde(rename = "2")]
    SecondHand,
    /// Inferred.
    I,
    /// Measured for this project.
    M,
    /// Given by the user.
    #[serde(rename = "user")]
    User,
}

/// A number of the workshop.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    pub value: f64,
    pub unit: &'static str,
    pub low: f64,
    pub high: f64,
    pub source: String,
    pub grade: Grade,
}

/// A step after the file that changes lengths: L becomes L (1 - s).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    pub name: String,
    /// In per cent.
    pub shrinkage: Figure,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Process {
    pub name: String,
    pub title: String,
    /// For each face, mm, in the finished part.
    pub clearance: Figure,
    /// mm.
    pub least_wall: Figure,
    /// g/cm3.
    pub density: Figure,
    pub steps: Vec<Step>,
}

/// The user's own figures; they replace those of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// mm for each face.
    pub clearance: Option<f64>,
    /// Per cent, by the name of the step.
    pub shrinkage: BTreeMap<String, f64>,
}

/// What a kind of figure may be: its unit, and the values that are not a slip of the pen.
#[derive(Clone, Copy)]
pub(crate) struct Kind {
    pub unit: &'static str,
    pub least: f64,
    pub most: f64,
}

/// A clearance wider than 5 mm is no fit; a negative one is a press fit, which nothing here can promise.
const CLEARANCE: Kind = Kind { unit: "mm", least: 0.0, most: 5.0 };
const WALL: Kind = Kind { unit: "mm", least: 0.01, most: 50.0 };
/// From foam to osmium.
const DENSITY: Kind = Kind { unit: "g/cm3", least: 0.01, most: 22.6 };
/// No step of a casting chain shrinks by more than a few per cent; above a tenth a volume figure was probably meant.
const SHRINKAGE: Kind = Kind { unit: "%", least: -10.0, most: 10.0 };

/// Why there is no process.
#[derive(Debug, thiserror::Error)]
pub enum ProcessError {
    #[error("no process \"{name}\"; known: {known}; a path to a .toml file works too")]
    Unknown { name: String, known: String },
    #[error("process file {}: {cause}", path.display())]
    Unreadable { path: PathBuf, cause: std::io::Error },
    #[error("{}", FaultList { place, faults })]
    Faulty { place: String, faults: Vec<FileFault> },
}

struct FaultList<'a> {
    place: &'a str,
    faults: &'a [FileFault],
}

impl fmt::Display for FaultList<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let lines = self.faults.iter().map(|x| format!("{}:{x}", self.place));
        f.write_str(&lines.collect::<Vec<_>>().join("\n"))
    }
}

const EMBEDDED: [(&str, &str); 4] = [
    ("fdm-pla", include_str!("../processes/fdm-pla.toml")),
    ("fdm-petg", include_str!("../processes/fdm-petg.toml")),
    ("fdm-abs", include_str!("../processes/fdm-abs.toml")),
    ("sla", include_str!("../processes/sla.toml")),
];

/// Names of the processes that come with the program.
pub fn names() -> impl Iterator<Item = &'static str> {
    EMBEDDED.iter().map(|(name, _)| *name)
}

impl Process {
    /// By name, or from a file where `which` ends in `.toml`.
    pub fn find(which: &str) -> Result<Process, ProcessError> {
        if let Some((name, text)) = EMBEDDED.iter().find(|(name, _)| *name == which) {
            return Process::parse(&format!("{name}.toml"), text);
        }
        if !which.ends_with(".toml") {
            let known = names().collect::<Vec<_>>().join(", ");
            return Err(ProcessError::Unknown { name: which.to_string(), known });
        }
        let path = Path::new(which);
        let unreadable = |cause| ProcessError::Unreadable { path: path.to_path_buf(), cause };
        Process::parse(which, &std::fs::read_to_string(path).map_err(unreadable)?)
    }

    /// From the text of a file; `place` names it in faults.
    pub fn parse(place: &str, text: &str) -> Result<Process, ProcessError> {
        let mut faults = Vec::new();
        let process = Cursor::parse(text, &mut faults).map(|mut top| read(&mut top));
        faults.sort_by_key(|f| f.line);
        match process {
            Some(process) if faults.is_empty() => Ok(process),
            _ => Err(ProcessError::Faulty { place: place.to_string(), faults }),
        }
    }

    /// The same process with the user's figures, each checked like those of a file.
    pub fn with(&self, own: &Overrides) -> Result<Process, ProcessError> {
        let mut process = self.clone();
        let mut faults = Vec::new();
        if let Some(value) = own.clearance {
            replace(&mut process.clearance, value, CLEARANCE, "clearance", &mut faults);
        }
        for (name, &value) in &own.shrinkage {
            match process.steps.iter_mut().find(|s| s.name == *name) {
                Some(step) => replace(&mut step.shrinkage, value, SHRINKAGE, name, &mut faults),
                None => faults.push(FileFault {
                    line: 0,
                    what: format!(
                        "shrinkage is given for a step \"{name}\" that {} does not have",
                        self.name
                    ),
                    hint: format!(
                        "its steps: {}",
                        self.steps.iter().map(|s| &s.name[..]).collect::<Vec<_>>().join(", ")
                    ),
                }),
            }
        }
        let place = "given figures".to_string();
        if faults.is_empty() { Ok(process) } else { Err(ProcessError::Faulty { place, faults }) }
    }
}

fn replace(figure: &mut Figure, value: f64, kind: Kind, name: &str, faults: &mut Vec<FileFault>) {
    if !(kind.least..=kind.most).contains(&value) {
        let what = format!("{name} of {value} {} is not possible", kind.unit);
        faults.push(FileFault { line: 0, what, hint: range_hint(kind) });
    }
    let (low, high) = (figure.low.min(value), figure.high.max(value));
    *figure =
        Figure { value, unit: kind.unit, low, high, source: "given by the user".into(), grade: Grade::User };
}

fn range_hint(kind: Kind) -> String {
    format!("from {} to {} {}", kind.least, kind.most, kind.unit)
}

fn read(top: &mut Cursor) -> Process {
    let process = Process {
        name: top.text("name"),
        title: top.text("title"),
        clearance: figure(top, "clearance", CLEARANCE),
        least_wall: figure(top, "least_wall", WALL),
        density: figure(top, "density", DENSITY),
        steps: top.each("step", |step| Step {
            name: step.text("name"),
            shrinkage: figure(step, "shrinkage", SHRINKAGE),
        }),
    };
    top.refuse_others("a process has name, title, clearance, least_wall, density and [[step]]");
    process
}

pub(crate) fn figure(at: &mut Cursor, key: &'static str, kind: Kind) -> Figure {
    at.table(key, |t| {
        let [value, low, high] =
            ["value", "low", "high"].map(|k| t.number_in(k, kind.least, kind.most, kind.unit));
        t.text_of("unit", &[kind.unit]);
        let grade = match t.text_of("grade", &["S", "2", "I", "M"]).as_str() {
            "S" => Grade::S,
            "2" => Grade::SecondHand,
            "M" => Grade::M,
            _ => Grade::I,
        };
        let figure = Figure { value, unit: kind.unit, low, high, source: t.text("source"), grade };
        if !(low <= value && value <= high) && [low, value, high].iter().all(|x| x.is_finite()) {
            t.fault(
                "value",
                format!("{key}: low {low}, value {value}, high {high} are not in order"),
                "low <= value <= high",
            );
        }
        t.refuse_others("a figure has value, unit, low, high, source and grade");
        figure
    })
}
