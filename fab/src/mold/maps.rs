//! Takes a part in its mold frame with its parting and shadows; gives draft, half and undercut for each facet.
//!
//! Not promised: the draft of the smooth shape that the facets stand for.

use crate::mesh::{Mesh, area};
use crate::mold::Maps;
use crate::mold::parting::{Look, looks};
use crate::mold::pull::real_area;
use crate::mold::shadow::Blocked;

pub fn maps(part: &Mesh, parting: f64, blocked: &Blocked, snap: f64, least_draft: f64) -> Maps {
    let looks = looks(part, snap);
    let draft: Vec<f64> = (0..part.triangles.len()).map(|t| draft(part, t)).collect();
    let middle = |t: usize| part.corners(t).iter().map(|c| c.z).sum::<f64>() / 3.0;
    let half = |t: usize| match looks[t] {
        Look::Up => "upper",
        Look::Down => "lower",
        Look::Wall if middle(t) >= parting => "upper",
        Look::Wall => "lower",
    };
    let low = (0..draft.len()).filter(|&t| draft[t] < least_draft).map(|t| area(part.corners(t)));
    Maps {
        half: (0..draft.len()).map(|t| half(t).to_string()).collect(),
        undercut_mm2: real_area(part, blocked),
        low_draft_mm2: low.sum(),
        draft_deg: draft,
    }
}

/// Degrees between a facet and the pull.
fn draft(part: &Mesh, t: usize) -> f64 {
    let [a, b, c] = part.corners(t);
    (b - a).cross(c - a).normalize_or_zero().z.abs().min(1.0).asin().to_degrees()
}
