//! Takes nothing; gives the words and records in which hands are told, as they stand in the JSON answer.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which hand a shape has. `right`: the first pseudo-scalar that does not vanish is positive (see `measure`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Handedness {
    /// Some improper isometry maps the shape to itself.
    Achiral,
    Left,
    Right,
    /// Draft and geometry disagree, or a proof is missing; `why` tells.
    Undecided,
}

/// How the tiles of the warps follow from those of the wefts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum WarpIs {
    /// Each warp tile is a weft tile, moved.
    Same,
    /// Each warp tile is the mirror image of a weft tile.
    Mirror,
    Both,
    Different,
    Undecided,
}

/// An isometry x -> linear x + shift, found on the solids alone; model units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct IsometryAnswer {
    /// A motion; else it includes a reflection.
    pub proper: bool,
    /// Rows of the linear part.
    pub linear: [[f64; 3]; 3],
    pub shift: [f64; 3],
    /// Farthest distance of a point's image from its partner.
    pub residual: f64,
}

/// A symmetry of the weave, found on the draft and the sites alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SymmetryAnswer {
    pub proper: bool,
    /// Image of (x, y, z); h is the height of an over above an under.
    pub map: String,
    /// Farthest distance of a corner of the solid from its partner under this map; null where one has no partner within
    /// the resolution.
    pub residual: Option<f64>,
    /// `weave`: of the endless weave; `surroundings`: of the crossings that shape this piece alone.
    pub reach: String,
}

/// Whether the search on the solids and the symmetries of the draft say the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Agreement {
    Agree,
    /// There is no draft.
    SolidsAlone,
    /// The solid has too few clear corners for the search; the draft's own symmetries meet on it.
    DraftAlone,
    Disagree,
}

/// A symmetry of the endless weave, up to its translations.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ElementAnswer {
    pub proper: bool,
    /// Wefts become warps.
    pub exchange: bool,
    /// Over becomes under.
    pub turned_over: bool,
    /// The cuts of the unit tiles go to cuts.
    pub keeps_cuts: bool,
    pub map: String,
}

/// The symmetry group of the weave, from its draft and sites.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct GroupAnswer {
    /// Translations [x, y] within the least rectangle, which is itself one.
    pub translations: Vec<[i32; 2]>,
    pub rectangle: [i32; 2],
    pub elements: Vec<ElementAnswer>,
}

/// The endless weave, its strands uncut.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClothAnswer {
    pub group: GroupAnswer,
    #[serde(flatten)]
    pub hand: HandAnswer,
}

/// What was found about the isometries from one shape to another (or itself), both ways.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Evidence {
    /// From the solids: all of them, up to `within`.
    pub isometries: Vec<IsometryAnswer>,
    /// From the draft; null where there is none.
    pub draft: Option<Vec<SymmetryAnswer>>,
    pub agreement: Agreement,
    /// Isometries that were tried on the solids.
    pub tried: usize,
    /// Points that meet within this distance count as met, from the rounding of vertices (for meshes from the user's
    /// tolerance); model units.
    pub within: f64,
    /// How far corners may miss since the sites are rounded; model units.
    pub resolution: f64,
}

/// The number that names a hand: positive for `right`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Measure {
    /// The determinant that is integrated over the shape.
    pub integrand: String,
    /// The integral, over that of the product of the lengths of its three columns: between -1 and 1.
    pub value: f64,
    /// Values below this are taken for 0.
    pub round_off: f64,
}

/// The hand of one shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HandAnswer {
    pub hand: Handedness,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measure: Option<Measure>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    pub evidence: Evidence,
}

/// A unit tile of an orbit of strands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TileAnswer {
    pub strand: String,
    /// Crossings along the strand: `from` up to but not including `to`.
    pub from: i32,
    pub to: i32,
    #[serde(flatten)]
    pub hand: HandAnswer,
}

/// One warp tile compared with one weft tile.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PairAnswer {
    pub weft: String,
    pub warp: String,
    /// Crossings by which the warp tile is cut later than at phase 0.
    pub phase: u32,
    pub warp_is: WarpIs,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
    pub evidence: Evidence,
}

/// How two parts that touch lie to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Touch {
    /// A weft and a warp.
    Crossing,
    /// Two of one kind side by side.
    Beside,
    /// Two of one strand.
    EndToEnd,
    /// Parts read from meshes.
    Meshes,
}

/// Two parts that touch, taken as one shape (paper, figure 18).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NeighboursAnswer {
    pub a: String,
    pub b: String,
    pub touch: Touch,
    pub hand: Handedness,
    pub agreement: Agreement,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
}

/// Parts that are one shape up to motions and mirrors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShapeAnswer {
    pub hand: Handedness,
    /// Parts that are the first of these, moved; all of them where the shape is achiral.
    pub same: Vec<String>,
    /// Parts that are its mirror image.
    pub mirrored: Vec<String>,
    /// Largest residual of the isometries that join them, model units.
    pub residual: f64,
}

/// Whether a mold or drawing of each hand is needed for some shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BothHands {
    Needed,
    NotNeeded,
    Undecided,
}

/// Two sources that do not say the same, or a thing that could not be decided.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FindingAnswer {
    pub at: String,
    pub what: String,
}

/// A part of the assembly and its hand.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PartAnswer {
    pub id: String,
    pub hand: Handedness,
}

/// Answer of `chirality`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Hands {
    pub verb: String,
    pub name: String,
    /// The unit tile of weft 0 at phase 0; null for an assembly of meshes.
    pub tile: Option<Handedness>,
    /// All warp tiles against all weft tiles at phase 0; null for an assembly of meshes.
    pub warp_is: Option<WarpIs>,
    /// Of the parts in place; where only a weave was asked about, of the endless weave, its strands
    /// uncut.
    pub assembly: Option<Handedness>,
    pub assembly_is: String,
    /// Whether some tile (or part) occurs in both hands.
    pub both_hands: Option<BothHands>,
    /// The least favourable of all agreements told below.
    pub agreement: Agreement,
    pub findings: Vec<FindingAnswer>,
    /// Null for an assembly of meshes.
    pub cloth: Option<ClothAnswer>,
    /// The weavers' hand of a twill.
    pub twill: Option<crate::weave::Hand>,
    /// A tile for each orbit of strands under the draft's translations, wefts first.
    pub tiles: Vec<TileAnswer>,
    pub strands: Vec<PairAnswer>,
    /// Where warp tiles are different at phase 0: cuts of the warp at which they are not.
    pub other_phases: Vec<PairAnswer>,
    pub assembly_evidence: Option<HandAnswer>,
    pub parts: Vec<PartAnswer>,
    /// Parts grouped by shape.
    pub shapes: Vec<ShapeAnswer>,
    /// Parts that touch, two by two.
    pub neighbours: Vec<NeighboursAnswer>,
    /// The mirrored assembly, where it was exported.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twin: Option<super::twin::TwinAnswer>,
    pub convention: String,
    pub remarks: Vec<String>,
}

/// What `left` and `right` mean.
pub const CONVENTION: &str = "right: positive integral of x y z in right-handed principal axes with their origin at \
the centroid, in the order of rising second moments; where that vanishes the next pseudo-scalar named under `measure`";
