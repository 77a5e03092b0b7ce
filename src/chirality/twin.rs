//! Takes an assembly; gives its mirror image as a spec of its own, and compares the two as they were read back.
//!
//! A woven assembly is turned upside down by a mirror: over becomes under at each crossing, pieces keep their cuts. One
//! of meshes is mirrored at z = 0. Promised: the comparison is made on the solids of both, not on how they were made.
//! Not promised: the ids of tiles where several would do; the first that fits is named.

use super::answer::{Handedness, Hands, IsometryAnswer};
use super::cloth;
use super::isometry;
use super::judge::isometry_answer;
use super::parts::whole;
use super::shape::Scale;
use crate::assembly::{Assembly, Mobility};
use crate::contact::Joined;
use crate::spec::{Bounds, Shape as Curve, Spec, Subject, WovenSpec};
use crate::tile::Piece;
use crate::weave::{Kind, wave};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt::Write;

/// Which of the two ways of putting the parts together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    Given,
    Mirrored,
}

impl Way {
    pub fn word(self) -> &'static str {
        match self {
            Way::Given => "given",
            Way::Mirrored => "mirrored",
        }
    }
}

/// A tile of the given assembly that fills a place of the mirrored one.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FillAnswer {
    pub place: String,
    pub by: String,
}

/// A pair of neighbours in both assemblies.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PairAnswer {
    pub a: String,
    pub b: String,
    pub given: Handedness,
    pub mirrored: Handedness,
}

/// An assembly and its mirror image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TwinAnswer {
    pub given: Handedness,
    pub mirrored: Handedness,
    /// Isometries from the given to the mirrored assembly, found on the solids as read back.
    pub isometries: Vec<IsometryAnswer>,
    /// Isometries that were tried, and the distance within which points count as met; model units.
    pub tried: usize,
    pub within: f64,
    /// `mirror`: one is the mirror image of the other and not its moved copy; `same`: they are one assembly, moved;
    /// `undecided`.
    pub relation: String,
    /// Which tile of the given assembly fills each place of the mirrored one; null where the tiles are not the same.
    pub tiles: Option<Vec<FillAnswer>>,
    pub why: Option<String>,
    pub neighbours: Vec<PairAnswer>,
    pub files: Vec<String>,
}

/// Compares an assembly with its mirror image, both as read back.
pub fn twins(
    spec: &Spec,
    given: (&Joined, &Hands),
    mirrored: (&Joined, &Hands),
    files: Vec<String>,
) -> TwinAnswer {
    let scale = match &spec.subject {
        Subject::Woven(woven) => cloth::scale(&given.0.assembly.solids, &woven.profile),
        Subject::Meshes(meshes) => {
            let tolerance = meshes.tolerance_mm / meshes.mm_per_unit;
            Scale { rounding: tolerance, resolution: tolerance }
        }
    };
    let [a, b] = [given.0, mirrored.0].map(|j| whole(&j.assembly, scale));
    let search = isometry::search(&a, &b, scale.rounding).unwrap_or_default();
    let some = |proper| search.found.iter().any(|f| f.is_proper() == proper);
    let relation = match (some(true), some(false)) {
        (false, true) if search.loose.iter().all(|f| !f.is_proper()) => "mirror",
        (true, _) => "same",
        _ => "undecided",
    };
    let (tiles, why) = match fill(given.1) {
        Ok(tiles) => (Some(tiles), None),
        Err(why) => (None, Some(why)),
    };
    TwinAnswer {
        given: given.1.assembly.unwrap_or(Handedness::Undecided),
        mirrored: mirrored.1.assembly.unwrap_or(Handedness::Undecided),
        isometries: search.found.iter().map(isometry_answer).collect(),
        tried: search.tried,
        within: search.within,
        relation: relation.into(),
        tiles,
        why,
        neighbours: pairs(given.1, mirrored.1),
        files,
    }
}

/// A tile for each place: a place of an achiral shape takes its own tile, turned; one of a chiral shape a tile of the
/// other hand.
fn fill(hands: &Hands) -> Result<Vec<FillAnswer>, String> {
    let mut all = Vec::new();
    for shape in &hands.shapes {
        let fits = |places: &[String], tiles: &[String]| {
            let pair = |(place, by): (&String, &String)| FillAnswer { place: place.clone(), by: by.clone() };
            places.iter().zip(tiles).map(pair).collect::<Vec<_>>()
        };
        match (shape.hand, shape.same.len(), shape.mirrored.len()) {
            (Handedness::Achiral, ..) => all.extend(fits(&shape.same, &shape.same)),
            (_, s, m) if s == m => {
                all.extend(fits(&shape.same, &shape.mirrored));
                all.extend(fits(&shape.mirrored, &shape.same));
            }
            (_, s, m) => {
                let first = shape.same.first().cloned().unwrap_or_default();
                return Err(format!(
                    "{s} parts are as {first}, {m} its mirror image: the mirrored assembly needs {m} and {s}"
                ));
            }
        }
    }
    all.sort_by(|a, b| a.place.cmp(&b.place));
    Ok(all)
}

fn pairs(given: &Hands, mirrored: &Hands) -> Vec<PairAnswer> {
    let there = |a: &str, b: &str| {
        let same = |n: &&super::answer::NeighboursAnswer| n.a == a && n.b == b;
        mirrored.neighbours.iter().find(same).map_or(Handedness::Undecided, |n| n.hand)
    };
    let pair = |n: &super::answer::NeighboursAnswer| PairAnswer {
        a: n.a.clone(),
        b: n.b.clone(),
        given: n.hand,
        mirrored: there(&n.a, &n.b),
    };
    given.neighbours.iter().map(pair).collect()
}

/// The spec of a woven assembly of these pieces, as given or mirrored, piece by piece.
pub fn woven_spec(spec: &WovenSpec, assembly: &Assembly, pieces: &[Piece], way: Way) -> String {
    let rows: Vec<String> = spec.weave.draft.rows().iter().map(|r| format!("{:?}", row(r, way))).collect();
    let mut text = format!("name = {}\n[weave]\ndraft = [{}]\n", title(&assembly.name, way), rows.join(", "));
    let p = &spec.profile;
    let _ = writeln!(text, "[profile]\n{}", curve(spec, way));
    let bounds = if p.bounds == Bounds::Prism { "prism" } else { "sandwich" };
    let _ = writeln!(
        text,
        "lift = {:?}\ncover = {:?}\nsamples = {}\nbounds = {bounds:?}",
        p.lift, p.cover, p.samples
    );
    let _ = writeln!(text, "[size]\npitch = \"{:?} mm\"", spec.pitch_mm);
    for (part, piece) in assembly.parts.iter().zip(pieces) {
        let kind = if piece.strand.kind == Kind::Weft { "weft" } else { "warp" };
        let held = if part.mobility == Mobility::Held { "held = true\n" } else { "" };
        let Piece { strand, from, to } = piece;
        let _ = writeln!(text, "[[piece]]\n{kind} = {}\nfrom = {from}\nto = {to}\n{held}", strand.index);
    }
    text
}

fn title(name: &str, way: Way) -> String {
    let name = match way {
        Way::Given => name.to_string(),
        Way::Mirrored => format!("{name}, mirrored"),
    };
    // A basic string of TOML escapes as JSON does.
    serde_json::to_string(&name).unwrap_or_default()
}

fn row(row: &str, way: Way) -> String {
    let turned = |c: char| match (way, c) {
        (Way::Given, c) => c,
        (Way::Mirrored, 'X') => '.',
        (Way::Mirrored, _) => 'X',
    };
    row.chars().map(turned).collect()
}

/// Own points are those of a weft, x = 0 where its overs begin; mirrored, they begin where its unders did.
fn curve(spec: &WovenSpec, way: Way) -> String {
    let lift = spec.profile.lift;
    let overs = wave(&spec.weave.draft).map_or(0, |(overs, _)| overs);
    let moved = |&[x, z]: &[f64; 2]| match way {
        Way::Given => [x, z],
        Way::Mirrored => [x - f64::from(overs), lift - z],
    };
    match &spec.profile.shape {
        Curve::Rise(rise) => format!("rise = {rise:?}"),
        Curve::Points(points) => format!("points = {:?}", points.iter().map(moved).collect::<Vec<_>>()),
    }
}

/// The spec of an assembly of meshes that stand in place in files of these names, in mm.
pub fn mesh_spec(assembly: &Assembly, tolerance_mm: f64, files: &[String], way: Way) -> String {
    let mut text = format!("name = {}\n", title(&assembly.name, way));
    for (part, file) in assembly.parts.iter().zip(files) {
        let quoted = |t: &str| serde_json::to_string(t).unwrap_or_default();
        let held = if part.mobility == Mobility::Held { "held = true\n" } else { "" };
        let _ = writeln!(text, "[[part]]\nid = {}\nmesh = {}\n{held}", quoted(&part.id), quoted(file));
    }
    let _ = writeln!(text, "[contact]\ntolerance = \"{tolerance_mm:?} mm\"\n[size]\nunit = \"mm\"");
    text
}

/// The assembly with every part mirrored at z = 0.
pub fn mirrored(assembly: &Assembly) -> Assembly {
    let mut twin = assembly.clone();
    for solid in &mut twin.solids {
        for v in &mut solid.vertices {
            v.z = -v.z;
        }
        for facet in &mut solid.facets {
            facet.corners.reverse();
            facet.normal.z = -facet.normal.z;
        }
        // Cells are not written to files.
        solid.cells.clear();
    }
    for part in &mut twin.parts {
        // A reflection before and after keeps the pose a motion.
        let flip = glam::DAffine3::from_scale(glam::DVec3::new(1.0, 1.0, -1.0));
        part.pose = flip * part.pose * flip;
    }
    twin
}
