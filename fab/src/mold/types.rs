//! Takes nothing; gives the shapes of a mold's answer: pieces, pull, maps, measurements, findings.

use crate::check::Check;
use crate::files::FileError;
use crate::mesh::Mesh;
use crate::mold::figures::Figures;
use crate::mold::fins::{Fin, Looked};
use crate::mold::plan::Plan;
use crate::mold::tops::Top;
use crate::report::Finding;
use glam::{DMat3, DVec3};
use serde::Serialize;

/// What a mold is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Route {
    /// Printed halves that take the casting material themselves.
    Rigid,
    /// A printed master on its parting board, with a box, for two pours of silicone.
    Silicone,
    /// Patterns on a tree, invested and burnt out.
    LostWax,
}

/// What is wanted.
#[derive(Clone, Debug)]
pub struct MoldSpec {
    /// Of files and findings.
    pub name: String,
    pub route: Route,
    pub figures: Figures,
    /// Pull along this instead of searching.
    pub pull: Option<DVec3>,
    /// Solids that enclose the cavity, in the part's frame (the cells around a tile); empty: the cavity is the part.
    pub surroundings: Vec<Mesh>,
    /// How many of the part: cavities of a gang mold, patterns on a tree. At least 1.
    pub count: usize,
}

impl MoldSpec {
    /// One part, pull searched, cavity the part itself.
    pub fn new(name: &str, route: Route, figures: Figures) -> MoldSpec {
        MoldSpec { name: name.to_string(), route, figures, pull: None, surroundings: vec![], count: 1 }
    }
}

/// What a piece of a mold is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A half of a rigid mold; leaves along its `pull`.
    Half,
    /// A side core of a rigid mold; leaves along its `pull` before the halves do.
    Core,
    /// Master and parting board in one print.
    PatternBoard,
    /// Stands on the board and holds the pour.
    BoxWall,
    /// Patterns, gates and runner in one.
    Tree,
    /// The container of the investment.
    Flask,
    /// The cavity itself, for the `.scad` sources.
    Part,
    /// Everything below the parting surface, for the `.scad` sources.
    Below,
    /// A side core with all the room that it takes, for the `.scad` sources.
    Room,
}

impl Kind {
    /// Whether it comes from the printer.
    pub fn is_printed(self) -> bool {
        matches!(self, Kind::Half | Kind::Core | Kind::PatternBoard | Kind::BoxWall)
    }

    /// Whether it is a solid to be made, not one that sources refer to.
    pub fn is_made(self) -> bool {
        !matches!(self, Kind::Part | Kind::Below | Kind::Room)
    }
}

impl Kind {
    pub fn words(self) -> &'static str {
        match self {
            Kind::Half => "mold half",
            Kind::Core => "side core",
            Kind::PatternBoard => "pattern board",
            Kind::BoxWall => "box wall",
            Kind::Tree => "tree, joined from patterns: not printed",
            Kind::Flask => "flask, of steel: not printed",
            Kind::Part => "part",
            Kind::Below => "parting surface",
            Kind::Room => "room of a side core",
        }
    }
}

/// One solid to be written, in the mold's frame (z along the pull), mm.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Stem of its file: `<mold>.<name>`.
    pub name: String,
    pub kind: Kind,
    pub mesh: Mesh,
    /// The way it leaves, unit; zero where it does not have to.
    pub pull: DVec3,
    /// How many of it to make.
    pub copies: usize,
}

/// The pull direction that was chosen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pull {
    /// Unit, in the part's frame.
    pub direction: DVec3,
    /// Area that neither half can reach straight, mm2; see `shadow`.
    pub undercut_mm2: f64,
    /// How far the undercut reaches under the part, mm: what would have to give.
    pub undercut_reach_mm: f64,
    /// Extent of the part along the pull, mm.
    pub depth_mm: f64,
    /// Directions that were looked at.
    pub candidates: usize,
    /// How they were chosen, in words.
    pub search: String,
}

/// For each triangle of the part (in the order of [`Mold::part`]).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Maps {
    /// Angle between facet and pull, degrees: 0 for a wall along the pull, 90 for a face across it.
    pub draft_deg: Vec<f64>,
    /// Which half or core forms it.
    pub half: Vec<String>,
    /// Area not reached from its half, mm2.
    pub undercut_mm2: Vec<f64>,
    /// Area with less than the draft asked for, mm2.
    pub low_draft_mm2: f64,
}

/// How the parting surface runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "form")]
pub enum Parting {
    /// In the mold's frame.
    Plane { height_mm: f64 },
    /// A plane with upright steps to the silhouette where that leaves it; `off_mm2` is the projected area on steps,
    /// heights are of the silhouette's steps, in the mold's frame.
    Stepped { height_mm: f64, off_mm2: f64 },
}

/// Something measured against a limit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measured {
    pub of: String,
    pub value: f64,
    pub limit: f64,
    pub unit: &'static str,
    /// Where the limit comes from.
    pub because: String,
    pub kept: bool,
}

impl Measured {
    /// Kept where the value is at most the limit.
    pub fn at_most(
        of: impl Into<String>,
        value: f64,
        limit: f64,
        unit: &'static str,
        because: &str,
    ) -> Measured {
        let kept = value <= limit;
        Measured { of: of.into(), value, limit, unit, because: because.to_string(), kept }
    }

    /// Kept where the value is at least the limit.
    pub fn at_least(
        of: impl Into<String>,
        value: f64,
        limit: f64,
        unit: &'static str,
        because: &str,
    ) -> Measured {
        let kept = value >= limit;
        Measured { of: of.into(), value, limit, unit, because: because.to_string(), kept }
    }
}

/// Volumes in mm3, each named.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Volume {
    pub of: String,
    pub mm3: f64,
    /// Mass where the material is known, g.
    pub grams: Option<f64>,
}

/// A file beside the pieces: OpenSCAD source, picture, data.
#[derive(Clone, Debug, PartialEq)]
pub struct Extra {
    pub name: String,
    pub bytes: Vec<u8>,
}

/// One step of pouring, burning out, assembling.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    pub does: String,
    pub hours: Option<f64>,
    pub celsius: Option<f64>,
    pub source: String,
}

/// A mold, made and measured, not yet written.
#[derive(Clone, Debug)]
pub struct Mold {
    pub name: String,
    pub route: Route,
    pub pull: Pull,
    /// Turns the part's frame to the mold's: z is the pull. Then the mold's origin is the middle of the part's foot.
    pub turn: DMat3,
    pub shift: DVec3,
    /// The part in the mold's frame, as f32 can hold it; all of a gang.
    pub part: Mesh,
    /// Parts that one filling makes: as many as asked for, or as a tree takes.
    pub castings: usize,
    /// How far f32 may move a coordinate of a file, mm.
    pub snap: f64,
    pub parting: Option<Parting>,
    /// What undercuts below the cavity's tolerance took to fill, mm3 (0 where there are none); `None` where they stay.
    pub filled_mm3: Option<f64>,
    pub maps: Maps,
    pub pieces: Vec<Piece>,
    pub extras: Vec<Extra>,
    pub volumes: Vec<Volume>,
    pub measured: Vec<Measured>,
    pub steps: Vec<Step>,
    pub findings: Vec<Finding>,
    pub figures: Figures,
    /// Where keys, screws and channels stand.
    pub plan: Plan,
    /// Local high points of the cavity as it is poured.
    pub tops: Vec<Top>,
}

impl Mold {
    /// Everything within the outer walls.
    pub(crate) fn part_box(&self) -> Mesh {
        crate::solid::cuboid(self.plan.low, self.plan.high)
    }
}

/// A piece as written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WrittenPiece {
    pub name: String,
    pub kind: Kind,
    /// File name in the folder.
    pub file: String,
    pub copies: usize,
    pub pull: DVec3,
    pub volume_mm3: f64,
    pub watertight: bool,
    pub bodies: usize,
    pub triangles: usize,
    /// The widest fin of a printed piece that is thinner than the mold's printer makes.
    pub fin: Option<Fin>,
    pub fins_looked_at: Looked,
    pub checks: Vec<Check>,
}

/// The answer on one mold.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MoldReport {
    pub name: String,
    pub route: Route,
    pub pull: Pull,
    pub parting: Option<Parting>,
    pub filled_mm3: Option<f64>,
    /// Draft that is asked for; 0 of silicone, which gives way.
    pub least_draft_deg: f64,
    /// Faces with less.
    pub low_draft_mm2: f64,
    pub pieces: Vec<WrittenPiece>,
    pub files: Vec<String>,
    pub volumes: Vec<Volume>,
    /// On the files as written.
    pub measured: Vec<Measured>,
    pub steps: Vec<Step>,
    pub findings: Vec<Finding>,
}

/// Why there is no mold.
#[derive(Debug, thiserror::Error)]
pub enum MoldError {
    /// The part or the order can not be worked with: what, and a hint.
    #[error("{0} (hint: {1})")]
    Input(String, String),
    #[error(transparent)]
    File(#[from] FileError),
}
