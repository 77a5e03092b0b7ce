//! Takes a spec file (TOML, or JSON with the same keys); gives what it asks for, checked, or all its faults at once.
//!
//! Promised: every number lies in the bounds stated here. Not promised: that files named in it exist or hold meshes,
//! nor that ids in `held` of a swatch exist; the stages that know tell.

mod json;
mod meshes;
mod pieces;
mod points;
pub mod puzzle;
mod read;
mod reader;
pub mod shape;
mod tree;
mod units;
mod woven;

pub use pieces::piece_ids;
pub use read::{Syntax, parse, read};
pub use reader::nearest;
pub use woven::MAX_SITES;

use crate::assembly::Mobility;
use crate::fault::{Fault, Place};
use crate::weave::{Strand, Weave};
use glam::DAffine3;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A length written with its unit, as "0.5 mm", in mm.
pub fn length_mm(text: &str) -> Result<f64, String> {
    units::millimetres(text).map_err(|_| "write a length with its unit, as \"0.5 mm\"".into())
}

/// What a spec file asks for.
#[derive(Clone, Debug)]
pub struct Spec {
    pub name: String,
    pub subject: Subject,
    pub fab: Option<FabSpec>,
    /// The file as the user gave it.
    pub file: PathBuf,
    pub places: Places,
}

impl Spec {
    /// A fault that a later stage found in the key at `key`, pointing at its line in the file.
    pub fn fault(&self, key: &str, what: impl Into<String>, hint: impl Into<String>) -> Fault {
        let file = self.file.display().to_string();
        Fault { file, place: self.places.get(key), key: key.into(), what: what.into(), hint: hint.into() }
    }
}

/// Key path, as in `swatch.held[1]` or `piece[0].from`, to its place in the file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Places(pub(self) BTreeMap<String, Place>);

impl Places {
    /// The place of the key, or of the nearest key around it that stands in the file.
    pub fn get(&self, key: &str) -> Option<Place> {
        let around = |k: &str| k.rfind(['.', '[']).map(|at| k[..at].to_string());
        let mut path = Some(key.to_string());
        while let Some(k) = path {
            if let Some(&place) = self.0.get(&k) {
                return Some(place);
            }
            path = around(&k);
        }
        None
    }
}

/// What the assembly is made of.
#[derive(Clone, Debug)]
pub enum Subject {
    Woven(WovenSpec),
    Meshes(MeshSpec),
}

/// An assembly of woven tiles. Lengths in crossings but for the pitch.
#[derive(Clone, Debug)]
pub struct WovenSpec {
    pub weave: Weave,
    pub profile: ProfileSpec,
    pub layout: Layout,
    pub held: HeldSpec,
    /// Millimetres in one crossing.
    pub pitch_mm: f64,
}

/// How the centerlines run. Lengths in crossings.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileSpec {
    pub shape: Shape,
    /// Height of an over above an under.
    pub lift: f64,
    /// Distance of the sandwiching planes from the centerlines' heights 0 and `lift`.
    pub cover: f64,
    /// Sites in one crossing length of centerline.
    pub samples: u32,
    pub bounds: Bounds,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Width over which a centerline changes side: 0 a square wave, 1 triangular.
    Rise(f64),
    /// Control points [x, z] of a degree-1 curve over one period: a weft's, x = 0 where its overs begin. A warp's is
    /// the same with z mirrored at `lift / 2`, x = 0 where its unders begin.
    Points(Vec<[f64; 2]>),
}

/// What ends the tile above and below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bounds {
    /// Voronoi sites on two planes.
    Sandwich,
    /// The bounding prism cuts the cells.
    Prism,
}

/// Which pieces the assembly has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Layout {
    Swatch { wefts: u32, warps: u32, cut: Cut, repeat: u32, phase: i32 },
    Pieces(Vec<PieceSpec>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// Each strand is one piece as long as the window.
    Window,
    /// Each strand is cut into pieces of `repeat` unit tiles.
    Tiles,
}

/// A stretch of one strand, `from` up to but not including `to`, in crossings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PieceSpec {
    pub strand: Strand,
    pub from: i32,
    pub to: i32,
}

/// Which parts may not move.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HeldSpec {
    None,
    /// Every part at the edge.
    Rim,
    /// These ids; whether a swatch has them is checked when its parts are known.
    Parts(Vec<String>),
}

/// An assembly of meshes read from files.
#[derive(Clone, Debug)]
pub struct MeshSpec {
    pub parts: Vec<MeshPartSpec>,
    /// Distance within which two faces count as touching.
    pub tolerance_mm: f64,
    pub mm_per_unit: f64,
    /// Parts of voxels instead of parts from files: a puzzle, whose file holds them.
    pub puzzle: Option<Box<puzzle::Puzzle>>,
}

#[derive(Clone, Debug)]
pub struct MeshPartSpec {
    pub id: String,
    /// Relative to the folder of the spec file already resolved.
    pub mesh: PathBuf,
    pub held: Mobility,
    /// Proper rigid motion, translation in the file's unit.
    pub at: DAffine3,
    /// By how much the pose may be turned from the one that was meant, as far as its digits tell, in radians.
    pub turn: f64,
}

/// How the parts are to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct FabSpec {
    /// Name of a process.
    pub process: String,
    /// Air for each face, overriding the process.
    pub clearance_mm: Option<f64>,
    /// The same of single processes, by name; these come first.
    pub clearances_mm: BTreeMap<String, f64>,
    /// Step of the process to its linear shrinkage as a fraction, overriding the process.
    pub shrinkage: BTreeMap<String, f64>,
    /// Parts made by another process: id to its name.
    pub parts: BTreeMap<String, String>,
    /// A bed's name or size, overriding the process.
    pub bed: Option<String>,
    /// Chamfer around the print face, overriding the process.
    pub elephant_foot_mm: Option<f64>,
    /// Cut off below, overriding the process.
    pub flatten_mm: Option<f64>,
}
