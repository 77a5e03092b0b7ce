//! Takes nothing; gives the shape of the answers of `fab` and `processes`, for their JSON Schema.
//!
//! The answers themselves are written by the maker of parts, which knows nothing of schemas; a test holds the keys of a
//! real one against these. Not promised: every key of what is nested here as an object.

use schemars::JsonSchema;
use serde_json::{Map, Value};

type Object = Map<String, Value>;

/// The answer of `fab`: a fabricator's package.
#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FabAnswer {
    /// `fab`
    pub verb: String,
    /// Where the package lies.
    pub folder: String,
    pub name: String,
    /// The process of every part that has none of its own.
    pub process: String,
    pub clearance: FigureAnswer,
    /// Between two faces of that process, mm, finished.
    pub fit_mm: f64,
    /// K of that process: master / finished; and at the ends of the ranges of its figures.
    pub scale: f64,
    pub scale_range: [f64; 2],
    /// The point that scaling leaves where it is, mm.
    pub datum: [f64; 3],
    pub ledger: Vec<EntryAnswer>,
    /// Every process in use with its own K, ledger and parts.
    pub routes: Vec<RouteAnswer>,
    pub parts: Vec<PartAnswer>,
    pub gaps: Vec<GapAnswer>,
    /// Answers of other programs about pairs of parts.
    pub pair_checks: Vec<Object>,
    pub molds: Vec<MoldAnswer>,
    pub molds_note: String,
    pub findings: Vec<FindingAnswer>,
    /// Bill of materials: what is made, printed, poured, with masses.
    pub bill: Object,
    /// How each part lies on its plate.
    pub layings: Vec<Object>,
    pub plates: Vec<PlateAnswer>,
    /// All parts in place as one object; null where a clearance is zero.
    pub assembly: Option<Object>,
    pub coupons: Vec<Object>,
    /// Each mold with pull, parting, volumes, measurements, steps.
    pub mold_sheets: Vec<Object>,
    /// Files of the package, below the folder.
    pub files: Vec<String>,
}

/// A number of the workshop.
#[derive(JsonSchema)]
pub struct FigureAnswer {
    pub value: f64,
    pub unit: String,
    pub low: f64,
    pub high: f64,
    pub source: String,
    /// `S`, `2`, `I`, `M` or `user`.
    pub grade: String,
}

/// A step that shrinks.
#[derive(JsonSchema)]
pub struct EntryAnswer {
    pub step: String,
    pub shrinkage_percent: f64,
    pub low_percent: f64,
    pub high_percent: f64,
    pub factor: f64,
    /// Of this step and all before it.
    pub product: f64,
    pub source: String,
    pub grade: String,
}

#[derive(JsonSchema)]
pub struct RouteAnswer {
    /// The process file as read.
    pub process: Object,
    pub scale: f64,
    pub scale_range: [f64; 2],
    pub ledger: Vec<EntryAnswer>,
    pub parts: Vec<String>,
}

/// A part as made; what was read back is null where no file was written.
#[derive(JsonSchema)]
pub struct PartAnswer {
    pub id: String,
    pub process: String,
    pub scale: f64,
    pub clearance_mm: f64,
    pub file: Option<String>,
    pub obj: Option<String>,
    pub same_as: Option<String>,
    pub volume_mm3: Option<f64>,
    pub watertight: Option<bool>,
    pub bodies: Option<u64>,
    pub hollows: Option<u64>,
    pub genus: Option<i64>,
    pub triangles: Option<u64>,
    pub low: Option<[f64; 3]>,
    pub high: Option<[f64; 3]>,
    pub expected_volume_mm3: f64,
    pub nominal_volume_mm3: f64,
    pub removed_mm3: f64,
    pub clearance_volume_mm3: f64,
    pub mass_g: f64,
    pub longest_move_mm: f64,
    /// `thinnest` wall and `sharpest` edge, each null where its process makes them.
    pub wall: Option<Object>,
    pub least_wall_mm: f64,
    /// The widest slot of a printed shape that is narrower than the fit between two faces.
    pub slot: Option<Object>,
    /// Whether all slots were looked at: "all" or "some".
    pub slots_looked_at: String,
    pub checks: Vec<Object>,
}

/// The least gap between two parts, at finished size.
#[derive(JsonSchema)]
pub struct GapAnswer {
    pub a: String,
    pub b: String,
    pub relation: String,
    pub promised_mm: f64,
    pub least_mm: f64,
    pub at: [[f64; 3]; 2],
    pub verdict: String,
}

/// A piece of a mold.
#[derive(JsonSchema)]
pub struct MoldAnswer {
    pub mold: String,
    pub file: String,
    pub kind: String,
    pub copies: u64,
    pub volume_mm3: f64,
    pub watertight: bool,
    pub checks: Vec<Object>,
}

#[derive(JsonSchema)]
pub struct FindingAnswer {
    /// `note`, `warning` or `error`.
    pub severity: String,
    pub place: Object,
    pub what: String,
    pub remedy: String,
}

#[derive(JsonSchema)]
pub struct PlateAnswer {
    pub file: String,
    pub process: String,
    pub bed: String,
    pub bed_mm: [f64; 3],
    pub stands: Vec<Object>,
    /// Filament by the slicer; null where it was not run.
    pub grams: Option<f64>,
    pub checks: Vec<Object>,
}

/// The answer of `processes`.
#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProcessesAnswer {
    /// `processes`
    pub verb: String,
    pub processes: Vec<Object>,
    pub beds: Vec<Object>,
}
