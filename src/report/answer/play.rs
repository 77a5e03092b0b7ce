//! Takes the play that was found; gives it as it is written: millimetres and degrees at a clearance.
//!
//! Not promised: that `verify` reads it; the finite motion of each extreme was followed already, and says how far.

use super::Source;
use crate::assembly::Assembly;
use crate::play::{Extreme, Kind, Reach};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Answer of `play`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlayAnswer {
    pub verb: String,
    pub name: String,
    pub outcome: PlayWord,
    /// Air on each face of a contact, mm; between two faces there is twice that.
    pub clearance_mm: f64,
    pub fit_mm: f64,
    /// The parts that play is measured against.
    pub still: Vec<String>,
    pub parts: Vec<PartPlay>,
    /// True where the user stopped it: ways that were not looked at say so.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
    pub remarks: Vec<String>,
    pub source: Source,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PlayWord {
    /// Every part stays within its play.
    Bounded,
    /// Some part is not held to first order: contacts do not end its way.
    Loose,
    /// Some program was not solved.
    Undecided,
}

/// How far one part gets while all others give way as far as they can.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PartPlay {
    pub part: String,
    /// Along x, y, z of the world.
    pub shift: Vec<AxisPlay>,
    /// About x, y, z through the part's centre.
    pub tilt: Vec<AxisPlay>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AxisPlay {
    /// `+x`, `-x`, `+y`, ...
    pub way: String,
    /// mm or degrees, to first order; null: no end, or not solved.
    pub first_order: Option<f64>,
    /// What first order can not exceed, from the program's multipliers.
    pub at_most: Option<f64>,
    /// mm or degrees up to which the motion was followed by the solids as made without an overlap; null: not followed.
    pub followed: Option<f64>,
    /// Where there is no number: why.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
}

/// An extreme with the share of it that the solids as made were followed to.
pub struct Followed {
    pub extreme: Extreme,
    pub share: Option<f64>,
}

pub fn play(assembly: &Assembly, found: &[Followed], clearance_mm: f64) -> Vec<PartPlay> {
    let mut parts: Vec<PartPlay> = Vec::new();
    for one in found {
        let part = &assembly.part(one.extreme.part).id;
        if parts.last().is_none_or(|p| p.part != *part) {
            parts.push(PartPlay { part: part.clone(), shift: Vec::new(), tilt: Vec::new() });
        }
        let Some(last) = parts.last_mut() else { continue };
        let (list, unit) = match one.extreme.kind {
            // Values are for one model unit of air: shares of the air, which is twice the clearance.
            Kind::Shift => (&mut last.shift, 2.0 * clearance_mm),
            Kind::Tilt => (&mut last.tilt, (2.0 * clearance_mm / assembly.mm_per_unit).to_degrees()),
        };
        list.push(axis(one, unit));
    }
    parts
}

fn axis(one: &Followed, unit: f64) -> AxisPlay {
    let e = &one.extreme;
    let sign = if e.sign > 0.0 { '+' } else { '-' };
    let way = format!("{sign}{}", ["x", "y", "z"][e.axis]);
    let none = |why: String| AxisPlay {
        way: way.clone(),
        first_order: None,
        at_most: None,
        followed: None,
        why: Some(why),
    };
    match &e.reach {
        Reach::Held { value, bound, .. } => AxisPlay {
            way,
            first_order: Some(value * unit),
            at_most: Some(bound * unit),
            followed: one.share.map(|s| s * value * unit),
            why: None,
        },
        Reach::Endless { .. } => none("no contact ends this way".into()),
        Reach::Unsolved { why } => none(why.clone()),
    }
}

pub fn word(found: &[Followed]) -> PlayWord {
    let any = |is: fn(&Reach) -> bool| found.iter().any(|f| is(&f.extreme.reach));
    match () {
        () if any(|r| matches!(r, Reach::Endless { .. })) => PlayWord::Loose,
        () if any(|r| matches!(r, Reach::Unsolved { .. })) => PlayWord::Undecided,
        () => PlayWord::Bounded,
    }
}
