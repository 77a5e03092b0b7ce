//! Takes a weave; gives what is known of its draft as it is written.
//!
//! Not promised: anything about a finite swatch or rigid pieces.

use crate::weave::{Family, Float, Hanging, Weave, family, floats, hangs_together};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Answer of `weave`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WeaveAnswer {
    pub verb: String,
    /// One period: row = weft, first row j = 0; X: weft over warp.
    pub draft: Vec<String>,
    /// Warps and wefts in the least rectangle that repeats.
    pub period: [u32; 2],
    /// plain, twill, satin or other.
    pub family: String,
    /// S or Z, for twills.
    pub hand: Option<String>,
    /// Longest floats in crossings; null where there is none or it never ends.
    pub floats: FloatsAnswer,
    pub hangs_together: bool,
    /// Strands of one period that lift off, where it falls apart.
    pub lifts: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FloatsAnswer {
    pub weft_over: Option<u32>,
    pub weft_under: Option<u32>,
    pub warp_over: Option<u32>,
    pub warp_under: Option<u32>,
}

pub fn weave(weave: &Weave) -> WeaveAnswer {
    let draft = &weave.draft;
    let kind = family(draft);
    let (name, hand) = match &kind {
        Family::Plain => ("plain", None),
        Family::Twill { hand, .. } => ("twill", Some(format!("{hand:?}"))),
        Family::Satin { .. } => ("satin", None),
        Family::Other => ("other", None),
    };
    let f = floats(draft);
    let length = |f: Float| if let Float::Crossings(n) = f { Some(n) } else { None };
    let lifts = match hangs_together(draft) {
        Hanging::Together => Vec::new(),
        Hanging::FallsApart { lifts } => lifts.iter().map(ToString::to_string).collect(),
    };
    WeaveAnswer {
        verb: "weave".into(),
        draft: draft.rows(),
        period: [draft.warps(), draft.wefts()],
        family: name.into(),
        hand,
        floats: FloatsAnswer {
            weft_over: length(f.weft_over),
            weft_under: length(f.weft_under),
            warp_over: length(f.warp_over),
            warp_under: length(f.warp_under),
        },
        hangs_together: lifts.is_empty(),
        lifts,
    }
}
