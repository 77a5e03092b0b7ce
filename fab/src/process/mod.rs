//! Takes a process file (TOML) and the user's own figures; gives a process whose numbers all make sense, or every fault
//! of the file with its line and a hint.
//!
//! Not promised: that a figure is right for the machine at hand. Its source and grade say how well it stands.

pub mod library;
mod measured;
mod read;
mod sense;

pub use library::{bed, beds, names, source};
pub use measured::{COUPON_MM, Measured};
#[allow(unused_imports, reason = "files of figures outside of processes are read the same way")]
pub(crate) use {read::figure, sense::Kind};

use crate::toml_faults::FileFault;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

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

impl Grade {
    /// As it stands in files.
    pub fn sign(self) -> &'static str {
        match self {
            Grade::S => "S",
            Grade::SecondHand => "2",
            Grade::I => "I",
            Grade::M => "M",
            Grade::User => "user",
        }
    }
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

/// What lies between the file and the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Route {
    /// What is printed is the part.
    Print,
    /// Cast in a printed mold.
    CastDirect,
    /// Printed master, silicone mold, casting.
    Cast,
    /// Printed master, silicone mold, wax, investment, metal.
    LostWax,
    /// The printed pattern is burnt out of investment, metal.
    LostPrint,
}

impl Route {
    pub const ALL: [(&'static str, Route); 5] = [
        ("print", Route::Print),
        ("cast-direct", Route::CastDirect),
        ("cast", Route::Cast),
        ("lost-wax", Route::LostWax),
        ("lost-print", Route::LostPrint),
    ];

    /// What the printer makes of a part's file.
    pub fn printed(self) -> &'static str {
        match self {
            Route::Print => "part",
            Route::CastDirect => "mold",
            Route::Cast | Route::LostWax => "master",
            Route::LostPrint => "pattern",
        }
    }

    /// Whether the part's own file is printed (else its mold's is).
    pub fn prints_the_shape(self) -> bool {
        self != Route::CastDirect
    }

    /// Whether the part is metal poured into investment.
    pub fn is_metal(self) -> bool {
        matches!(self, Route::LostWax | Route::LostPrint)
    }
}

/// How whatever is printed is printed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Print {
    pub material: String,
    pub bed: Bed,
    pub supports: String,
    /// mm.
    pub layer: Figure,
    /// Per cent.
    pub infill: Figure,
    /// g/cm3.
    pub density: Figure,
    /// Chamfer around the print face, mm; 0 is off.
    pub elephant_foot: Figure,
    /// Cut off below, mm; 0 is off.
    pub flatten: Figure,
}

/// What a machine can print, mm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bed {
    pub name: String,
    pub size: [f64; 3],
}

/// What the part is poured into.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cavity {
    pub material: String,
    /// Of what is poured, C.
    pub pour: Figure,
    /// What the cavity bears, C.
    pub bears: Figure,
    /// From what heat on it is liquid, C; `None` of what does not melt, or of which it is not known.
    pub liquid: Option<Figure>,
}

/// One line of the cast schedule, in order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Instruction {
    pub stage: String,
    #[serde(rename = "do")]
    pub what: String,
    /// The material that is to be liquid at the figure's heat.
    pub melts: Option<String>,
    pub figure: Option<Figure>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Process {
    pub name: String,
    pub title: String,
    pub route: Route,
    /// Of the finished part.
    pub material: String,
    /// For each face, mm, in the finished part.
    pub clearance: Figure,
    /// mm.
    pub least_wall: Figure,
    /// g/cm3.
    pub density: Figure,
    pub print: Print,
    /// `None` where the part is printed.
    pub cavity: Option<Cavity>,
    pub steps: Vec<Step>,
    pub schedule: Vec<Instruction>,
}

/// The user's own figures; they replace those of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// mm for each face, of every process; and of single ones, by their names, which come first.
    pub clearance: Option<f64>,
    pub clearances: BTreeMap<String, f64>,
    /// Per cent, by the name of the step.
    pub shrinkage: BTreeMap<String, f64>,
    /// Lengths of the coupon that were measured.
    pub measured: Vec<Measured>,
    /// A bed's name or size.
    pub bed: Option<String>,
    /// Chamfer around the print face, mm.
    pub elephant_foot: Option<f64>,
    /// Cut off below, mm.
    pub flatten: Option<f64>,
}

/// Why there is no process.
#[derive(Debug, thiserror::Error)]
pub enum ProcessError {
    #[error("no process \"{name}\" (hint: known are {known}; a path to a .toml file works too)")]
    Unknown { name: String, known: String },
    #[error("process file {}: {cause} (hint: name a .toml file that can be read, or one of the known processes)", path.display())]
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

impl Process {
    /// By name, or from a file where `which` ends in `.toml`.
    pub fn find(which: &str) -> Result<Process, ProcessError> {
        library::find(which)
    }

    /// From the text of a file; `place` names it in faults.
    pub fn parse(place: &str, text: &str) -> Result<Process, ProcessError> {
        read::parse(place, text)
    }

    /// The same process with the user's figures, each checked like those of a file.
    pub fn with(&self, own: &Overrides) -> Result<Process, ProcessError> {
        let mut process = self.clone();
        let faults = sense::overrule(&mut process, own);
        let place = "given figures".to_string();
        if faults.is_empty() { Ok(process) } else { Err(ProcessError::Faulty { place, faults }) }
    }
}
