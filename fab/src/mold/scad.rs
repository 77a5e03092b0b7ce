//! Takes a mold; gives its parametric OpenSCAD source, which makes the same mold from the part's file.
//!
//! Not promised: that values other than the ones written leave a mold that opens; the asserts of nothing but sense.

use crate::mold::layout::{EDGE, SLOT, rim};
use crate::mold::plan::Channel;
use crate::mold::rigid::KEY_TIP;
use crate::mold::{Kind, Mold};
use crate::solid::SIDES;
use glam::DVec3;

const TWO_PART: &str = include_str!("../../scad/two-part.scad");

pub fn file_name(mold: &Mold, piece: &str) -> String {
    format!("{}.{piece}.mm.stl", mold.name)
}

/// The source with its places filled in.
pub fn two_part(mold: &Mold) -> String {
    let (f, plan) = (&mold.figures, &mold.plan);
    let (low, high) = mold.part.bounds();
    let of = |kind: Kind| {
        mold.pieces.iter().find(|p| p.kind == kind).map(|p| file_name(mold, &p.name)).unwrap_or_default()
    };
    let least_side = f.key_diameter.value + f.bolt.value + 4.0 * EDGE + 2.0 * SLOT.x;
    let list = |c: &[Channel]| {
        let one = |c: &Channel| format!("[{}, {}, {}]", vector(c.foot), c.below, c.above);
        format!("[{}]", c.iter().map(one).collect::<Vec<_>>().join(", "))
    };
    filled(
        TWO_PART,
        &[
            ("part", of(Kind::Part)),
            ("below", of(Kind::Below)),
            ("part_low", vector(low)),
            ("part_high", vector(high)),
            ("parting", plan.parting.to_string()),
            ("wall", f.wall.value.to_string()),
            ("rim", rim(f).to_string()),
            ("least_side", least_side.to_string()),
            ("edge", EDGE.to_string()),
            ("key_diameter", f.key_diameter.value.to_string()),
            ("key_height", f.key_height.value.to_string()),
            ("key_clearance", f.key_clearance.value.to_string()),
            ("key_tip", KEY_TIP.to_string()),
            ("sprues", list(&plan.sprues)),
            ("vents", list(&plan.vents)),
            ("bolt", f.bolt.value.to_string()),
            ("slot", vector(SLOT)),
            ("sides", SIDES.to_string()),
        ],
    )
}

pub fn vector(v: DVec3) -> String {
    format!("[{}, {}, {}]", v.x, v.y, v.z)
}

pub fn filled(template: &str, values: &[(&str, String)]) -> String {
    values.iter().fold(template.to_string(), |text, (key, value)| text.replace(&format!("@{key}@"), value))
}
