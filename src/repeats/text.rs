//! Takes a weave, a profile and a swatch; gives the spec that asks for it, as TOML.
//!
//! Promised: read again it gives the same draft, the same numbers to the last bit, and so the same contacts.

use crate::assembly::layout::Swatch;
use crate::spec::{Bounds, ProfileSpec, Shape};
use crate::weave::{Origin, Weave};

pub fn text(weave: &Weave, profile: &ProfileSpec, swatch: Swatch, pitch_mm: f64) -> String {
    let Swatch { wefts, warps, repeat, phase } = swatch;
    let weave = match &weave.origin {
        Origin::Abc { a, b, c } => format!("abc = [{a}, {b}, {c}]"),
        Origin::Drawn | Origin::Wif(_) => format!("draft = {:?}", weave.draft.rows()),
    };
    let shape = match &profile.shape {
        Shape::Rise(rise) => format!("rise = {rise:?}"),
        Shape::Points(points) => format!("points = {points:?}"),
    };
    let bounds = match profile.bounds {
        Bounds::Sandwich => "sandwich",
        Bounds::Prism => "prism",
    };
    let ProfileSpec { lift, cover, samples, .. } = profile;
    format!(
        "name = \"swatch\"\n[weave]\n{weave}\n[profile]\n{shape}\nlift = {lift:?}\ncover = {cover:?}\n\
         samples = {samples}\nbounds = \"{bounds}\"\n[swatch]\nwefts = {wefts}\nwarps = {warps}\ncut = \"tiles\"\n\
         repeat = {repeat}\nphase = {phase}\n[size]\npitch = \"{pitch_mm:?} mm\"\n"
    )
}
