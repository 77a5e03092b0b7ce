//! Takes a mold; gives its parametric OpenSCAD source, which makes the same mold from the part's file.
//!
//! Not promised: that values other than the ones written leave a mold that opens.

use crate::files::stl::{self, GRID};
use crate::mold::layout::{Around, EDGE, SLOT, least_side};
use crate::mold::plan::Channel;
use crate::mold::rigid::KEY_TIP;
use crate::mold::silicone::LIP;
use crate::mold::tree::FLASK_WALL;
use crate::mold::wax::Tree;
use crate::mold::{Kind, Mold, Parting, Piece};
use crate::solid::SIDES;
use glam::DVec3;

const TWO_PART: &str = include_str!("../../scad/two-part.scad");
const MORE_PARTS: &str = include_str!("../../scad/more-parts.scad");
const SILICONE: &str = include_str!("../../scad/silicone.scad");
const TREE: &str = include_str!("../../scad/tree.scad");

pub fn file_name(mold: &Mold, piece: &str) -> String {
    format!("{}.{piece}.mm.stl", mold.name)
}

/// Values that both kinds of two-part molds have.
fn common(mold: &Mold) -> Vec<(&'static str, String)> {
    let (f, plan) = (&mold.figures, &mold.plan);
    let (low, high) = mold.part.bounds();
    vec![
        ("part", of(mold, Kind::Part)),
        ("part_low", vector(low)),
        ("part_high", vector(high)),
        ("parting", plan.parting.to_string()),
        ("wall", f.wall.value.to_string()),
        ("least_side", least_side(f).to_string()),
        ("edge", EDGE.to_string()),
        ("key_diameter", f.key_diameter.value.to_string()),
        ("key_height", f.key_height.value.to_string()),
        ("key_clearance", f.key_clearance.value.to_string()),
        ("key_tip", KEY_TIP.to_string()),
        ("sprues", list(&plan.sprues)),
        ("vents", list(&plan.vents)),
        ("aside", vector(ASIDE)),
        ("sides", SIDES.to_string()),
    ]
}

/// What the source moves an imported surface by where it should meet another just in a line, mm: in a hundred roundings of
/// f32 they touch in points instead, which is no solid to its kernel. A hundredth of the finest layer, of no axis, and in
/// whole steps of `GRID`, so that all corners move alike.
const ASIDE: DVec3 = DVec3::new(80.0 * GRID, 48.0 * GRID, -128.0 * GRID);

fn of(mold: &Mold, kind: Kind) -> String {
    mold.pieces.iter().find(|p| p.kind == kind).map(|p| file_name(mold, &p.name)).unwrap_or_default()
}

fn list(channels: &[Channel]) -> String {
    let one = |c: &Channel| format!("[{}, {}, {}]", vector(c.foot), c.below, c.above);
    format!("[{}]", channels.iter().map(one).collect::<Vec<_>>().join(", "))
}

/// The file of a core with the room that it takes.
pub fn room_name(core: &str) -> String {
    format!("{core}-room")
}

/// What the source of a rigid mold would import, and f32 can not hold apart: the surface below a stepped parting, or a core
/// that has no file with its room and is crossed itself.
pub fn lacking(mold: &Mold) -> Option<String> {
    let has = |name: &str| mold.pieces.iter().any(|p| p.name == name);
    let stepped = matches!(mold.parting, Some(Parting::Stepped { .. }));
    if stepped && !mold.pieces.iter().any(|p| p.kind == Kind::Below) {
        return Some("what lies below the parting".into());
    }
    let crossed = |p: &&Piece| p.kind == Kind::Core && !has(&room_name(&p.name)) && !stl::is_plain(&p.mesh);
    mold.pieces.iter().find(crossed).map(|p| p.name.clone())
}

/// The source of a rigid mold, its places filled in.
pub fn rigid(mold: &Mold) -> String {
    let cores: Vec<&Piece> = mold.pieces.iter().filter(|p| p.kind == Kind::Core).collect();
    if cores.is_empty() { two_part(mold) } else { more_parts(mold, &cores) }
}

fn more_parts(mold: &Mold, cores: &[&Piece]) -> String {
    let (f, plan) = (&mold.figures, &mold.plan);
    let strings = |all: Vec<String>| format!("[{}]", all.join(", "));
    let quoted = |p: &&Piece| format!("\"{}\"", p.name);
    let room = |core: &&Piece| mold.pieces.iter().find(|p| p.name == room_name(&core.name));
    let room_file =
        |core: &&Piece| room(core).map_or("\"\"".into(), |p| format!("\"{}\"", file_name(mold, &p.name)));
    let own = [
        ("below", of(mold, Kind::Below)),
        ("names", cores.iter().map(|p| p.name.clone()).collect::<Vec<_>>().join(", ")),
        ("core_names", strings(cores.iter().map(quoted).collect())),
        ("core_rooms", strings(cores.iter().map(room_file).collect())),
        ("core_files", strings(cores.iter().map(|p| format!("\"{}\"", file_name(mold, &p.name))).collect())),
        ("core_pulls", strings(cores.iter().map(|p| vector(p.pull)).collect())),
        ("low", vector(plan.low)),
        ("high", vector(plan.high)),
        ("keys", strings(plan.keys.iter().map(|k| vector(k.at)).collect())),
        ("bolts", strings(plan.bolts.iter().map(|b| format!("[{}, {}]", b.x, b.y)).collect())),
        (
            "slots",
            strings(plan.slots.iter().map(|s| format!("[{}, {}]", vector(s.0), vector(s.1))).collect()),
        ),
        ("bolt", f.bolt.value.to_string()),
    ];
    filled(MORE_PARTS, &[common(mold), own.to_vec()].concat())
}

fn two_part(mold: &Mold) -> String {
    let f = &mold.figures;
    let own = [
        ("below", of(mold, Kind::Below)),
        ("rim", Around::printed(f).rim.to_string()),
        ("bolt", f.bolt.value.to_string()),
        ("slot", vector(SLOT)),
    ];
    filled(TWO_PART, &[common(mold), own.to_vec()].concat())
}

/// The source of the prints for a silicone mold.
pub fn silicone(mold: &Mold) -> String {
    let around = Around::silicone(&mold.figures);
    let own = [
        ("silicone", around.wall.to_string()),
        ("rim", around.rim.to_string()),
        ("lip", LIP.to_string()),
        ("grid", stl::GRID.to_string()),
    ];
    filled(SILICONE, &[common(mold), own.to_vec()].concat())
}

/// The source of a lost-wax tree and its flask.
pub fn tree(mold: &Mold, tree: &Tree) -> String {
    let runner = tree.runner;
    let (radius, low, high) = crate::mold::wax::flask(tree, &mold.figures);
    let levels: Vec<String> = tree.levels.iter().map(|(z, n)| format!("[{z}, {n}]")).collect();
    let values = [
        ("part", of(mold, Kind::Part)),
        ("runner", runner.to_string()),
        ("top", (tree.top - runner).to_string()),
        ("gate", tree.gate.to_string()),
        ("reach", tree.reach.to_string()),
        ("into", tree.into.to_string()),
        ("levels", format!("[{}]", levels.join(", "))),
        ("flask_radius", radius.to_string()),
        ("flask_thick", FLASK_WALL.to_string()),
        ("flask_low", low.to_string()),
        ("flask_high", high.to_string()),
        ("sides", SIDES.to_string()),
    ];
    filled(TREE, &values)
}

pub fn vector(v: DVec3) -> String {
    format!("[{}, {}, {}]", v.x, v.y, v.z)
}

pub fn filled(template: &str, values: &[(&str, String)]) -> String {
    values.iter().fold(template.to_string(), |text, (key, value)| text.replace(&format!("@{key}@"), value))
}
