//! Takes nothing; gives the shape of a spec file as types, for its JSON Schema alone.
//!
//! The reader (`read`) is what decides; it finds all faults and their places, which a derived reader can not. Not
//! promised: the bounds of numbers.

#![allow(
    rustdoc::broken_intra_doc_links,
    reason = "these texts go into the schema; brackets are TOML tables"
)]
#![allow(dead_code, reason = "these types are read by the schema's derive, never made")]

use schemars::JsonSchema;

/// A spec file: a woven assembly ([weave] and [swatch] or [[piece]]) or an assembly of meshes ([[part]]).
#[derive(JsonSchema)]
#[serde(untagged)]
pub enum SpecFile {
    Woven(Box<WovenFile>),
    Meshes(Box<MeshesFile>),
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WovenFile {
    /// By default the file's stem.
    name: Option<String>,
    weave: WeaveTable,
    profile: Option<ProfileTable>,
    swatch: Option<SwatchTable>,
    piece: Option<Vec<PieceTable>>,
    /// With [[piece]]: ids of parts that may not move, or "rim".
    held: Option<Held>,
    /// By default a pitch of 20 mm.
    size: Option<PitchTable>,
    fab: Option<FabTable>,
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
struct WeaveTable {
    /// Exactly one of abc, draft, wif.
    abc: Option<[i64; 3]>,
    /// Row = weft, first row j = 0; X: weft over warp, .: under.
    draft: Option<Vec<String>>,
    wif: Option<String>,
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
struct ProfileTable {
    rise: Option<f64>,
    points: Option<Vec<[f64; 2]>>,
    lift: Option<f64>,
    cover: Option<f64>,
    samples: Option<u32>,
    bounds: Option<BoundsWord>,
}

#[derive(JsonSchema)]
#[serde(rename_all = "lowercase")]
enum BoundsWord {
    Sandwich,
    Prism,
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
struct SwatchTable {
    wefts: u32,
    warps: u32,
    /// By default "window".
    cut: Option<CutWord>,
    repeat: Option<u32>,
    phase: Option<i32>,
    held: Option<Held>,
}

#[derive(JsonSchema)]
#[serde(rename_all = "lowercase")]
enum CutWord {
    Window,
    Tiles,
}

#[derive(JsonSchema)]
#[serde(untagged)]
enum Held {
    Rim(String),
    Parts(Vec<String>),
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
struct PieceTable {
    /// Exactly one of weft, warp.
    weft: Option<i32>,
    warp: Option<i32>,
    from: i32,
    to: i32,
    held: Option<bool>,
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
struct PitchTable {
    /// A length with its unit, as "20 mm".
    pitch: Option<String>,
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshesFile {
    /// By default the file's stem.
    name: Option<String>,
    part: Vec<PartTable>,
    contact: Option<ContactTable>,
    size: Option<UnitTable>,
    fab: Option<FabTable>,
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
struct PartTable {
    id: Option<String>,
    /// STL, OBJ or 3MF, relative to the spec.
    mesh: String,
    held: Option<bool>,
    /// 3 x 4 pose, row by row.
    at: Option<[f64; 12]>,
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
struct ContactTable {
    tolerance: Option<String>,
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
struct UnitTable {
    unit: Option<String>,
}

#[derive(JsonSchema)]
#[serde(deny_unknown_fields)]
struct FabTable {
    process: String,
    clearance: Option<String>,
    /// Of single processes, by name.
    clearances: Option<std::collections::BTreeMap<String, String>>,
    shrinkage: Option<std::collections::BTreeMap<String, String>>,
    /// Processes of single parts, by id.
    parts: Option<std::collections::BTreeMap<String, String>>,
    /// A bed by name, or as "250 x 210 x 220 mm".
    bed: Option<String>,
    /// Chamfer around the print face, as "0.3 mm".
    elephant_foot: Option<String>,
    /// Cut off below, as "0.2 mm".
    flatten: Option<String>,
}
