//! Takes nothing; gives the shape of the answer: parts, gaps, scale with its ledger, findings.

use crate::check::Check;
use crate::gap::Gap;
use crate::ledger::Entry;
use crate::mesh::{Closure, Mesh};
use crate::mold::Kind;
use crate::mold::fins::{Fin, Looked};
use crate::process::{Figure, Process};
use crate::wall::Walls;
use glam::DVec3;
use serde::Serialize;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    Note,
    Warning,
    Error,
}

/// Where a finding is: ids of parts, and points in the finished assembly, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Place {
    pub parts: Vec<String>,
    pub at: Vec<DVec3>,
}

/// Something that whoever makes the parts has to know.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    pub severity: Severity,
    pub place: Place,
    pub what: String,
    pub remedy: String,
}

impl Finding {
    /// A remark about the whole.
    pub fn note(what: String, remedy: &str) -> Finding {
        Finding { severity: Severity::Note, place: Place::default(), what, remedy: remedy.to_string() }
    }
}

/// What was measured on a file after it was written, on the master's scale; all `None` where there is no file.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ReadBack {
    pub volume_mm3: Option<f64>,
    pub watertight: Option<bool>,
    /// Pieces of surface around material, and around hollows inside it.
    pub bodies: Option<usize>,
    pub hollows: Option<usize>,
    pub genus: Option<i64>,
    pub triangles: Option<usize>,
    /// Bounding box, mm.
    pub low: Option<DVec3>,
    pub high: Option<DVec3>,
}

impl ReadBack {
    pub fn of(mesh: &Mesh) -> ReadBack {
        let (topology, (low, high)) = (mesh.topology(), mesh.bounds());
        let bodies = mesh.shells().iter().filter(|v| **v > 0.0).count();
        ReadBack {
            volume_mm3: Some(mesh.volume()),
            watertight: Some(mesh.closure() == Closure::Closed),
            bodies: Some(bodies),
            hollows: Some(topology.bodies - bodies),
            genus: Some(topology.genus),
            triangles: Some(mesh.triangles.len()),
            low: Some(low),
            high: Some(high),
        }
    }

    /// Pieces of surface in all: what a slicer counts as parts.
    pub fn shells(&self) -> usize {
        self.bodies.unwrap_or(0) + self.hollows.unwrap_or(0)
    }
}

/// A part as written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartReport {
    pub id: String,
    /// What makes it, and its own K and clearance for each face.
    pub process: String,
    pub scale: f64,
    pub clearance_mm: f64,
    /// Binary STL on the master's scale, in its place in the assembly, mm; `None` where nothing was written.
    pub file: Option<String>,
    pub obj: Option<String>,
    /// The first part with the same solid up to a rigid motion, where there is one before this.
    pub same_as: Option<String>,
    #[serde(flatten)]
    pub read_back: ReadBack,
    /// Before writing, master's scale.
    pub expected_volume_mm3: f64,
    /// Before clearance and scale.
    pub nominal_volume_mm3: f64,
    /// What the clearance took away, finished size, and clearance times contact area, to which it should be near.
    pub removed_mm3: f64,
    pub clearance_volume_mm3: f64,
    /// Finished part, full infill.
    pub mass_g: f64,
    /// The longest way that clearance moved a corner, mm.
    pub longest_move_mm: f64,
    /// Where it is thinner than its process makes, finished size; `None` where there is no file.
    pub wall: Option<Walls>,
    pub least_wall_mm: f64,
    /// The widest slot of a printed shape that is narrower than the process's fit between two faces, finished size.
    pub slot: Option<Fin>,
    pub slots_looked_at: Looked,
    pub checks: Vec<Check>,
}

/// A process in use: its scale, and the parts that it makes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RouteReport {
    pub process: Process,
    pub scale: f64,
    pub scale_range: (f64, f64),
    pub ledger: Vec<Entry>,
    pub parts: Vec<String>,
}

/// A check of two parts together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PairCheck {
    pub a: String,
    pub b: String,
    #[serde(flatten)]
    pub check: Check,
}

/// The answer of `fab`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    pub name: String,
    pub process: String,
    /// For each face of the finished part.
    pub clearance: Figure,
    /// Between two faces, mm, finished.
    pub fit_mm: f64,
    /// K: the master is larger than the finished part by this factor.
    pub scale: f64,
    /// K at the ends of the ranges of all figures.
    pub scale_range: (f64, f64),
    /// The point of the assembly that scaling leaves in place, mm.
    pub datum: DVec3,
    pub ledger: Vec<Entry>,
    /// All processes in use; the figures above are those of the one that makes whatever has none of its own.
    pub routes: Vec<RouteReport>,
    pub parts: Vec<PartReport>,
    pub gaps: Vec<Gap>,
    pub pair_checks: Vec<PairCheck>,
    /// Pieces of molds; a package makes them.
    pub molds: Vec<MoldFile>,
    pub molds_note: String,
    pub findings: Vec<Finding>,
}

/// A piece of a mold as written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MoldFile {
    /// The mold that it belongs to.
    pub mold: String,
    pub file: String,
    pub kind: Kind,
    /// How many to make.
    pub copies: usize,
    pub volume_mm3: f64,
    pub watertight: bool,
    pub checks: Vec<Check>,
}

impl Report {
    /// The part of this id, and those after it that are the same solid by the same process.
    pub fn alike(&self, id: &str) -> Vec<String> {
        let Some(at) = self.parts.iter().position(|p| p.id == id) else { return vec![id.to_string()] };
        let root = |p: &PartReport| p.same_as.clone().unwrap_or(p.id.clone());
        let same = |p: &&PartReport| root(p) == root(&self.parts[at]) && p.process == self.parts[at].process;
        self.parts[at..].iter().filter(same).map(|p| p.id.clone()).collect()
    }

    /// The gravest severity among the findings.
    pub fn worst(&self) -> Option<Severity> {
        self.findings.iter().map(|f| f.severity).max()
    }
}
