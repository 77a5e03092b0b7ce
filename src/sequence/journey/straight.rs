//! Takes the parts of a set in some poses, gives the straight moves that stop half way: until something is met, and
//! where the moved parts come level with an end of what they pass.
//!
//! Sound: no move goes farther than the first contact. Not complete: directions come from the contacts, the frame of
//! the set and the axes, stops from the ends of cells, at most so many of each.

use crate::assembly::PartIx;
use crate::blocking::SAME_ANGLE;
use crate::blocking::cone::polar;
use crate::blocking::reach::{Reach, reach_contact};
use crate::blocking::shadow::View;
use crate::sequence::field::{Field, Set};
use crate::sequence::leave::landmarks;
use glam::DVec3;

/// Stops looked at on one way.
const MOST_STOPS: usize = 12;

/// Directions looked at for one group.
const MOST_DIRECTIONS: usize = 16;

/// The least move, in touching depths: well above what round-off leaves of a contact.
const LEAST_MOVE: f64 = 64.0;

/// A straight move of a group, and where it may stop.
pub struct Slide {
    pub along: DVec3,
    /// Model units, rising; the last is where something is met, if anything is.
    pub stops: Vec<f64>,
}

/// `frame`: directions that are tried beside those of the contacts.
pub fn slides(field: &Field, group: &Set, rest: &Set, frame: &[DVec3]) -> Vec<Slide> {
    let normals: Vec<DVec3> = field.sides(group, rest).map(|s| s.normal).collect();
    let cone = polar(normals.iter().copied());
    let mut tried: Vec<DVec3> = Vec::new();
    for d in landmarks(&cone).chain(frame.iter().copied()) {
        let starts = normals.iter().all(|n| n.dot(d) <= SAME_ANGLE);
        if starts && tried.len() < MOST_DIRECTIONS && tried.iter().all(|t| t.distance(d) > SAME_ANGLE) {
            tried.push(d);
        }
    }
    let slide = |along: DVec3| {
        let stops = stops(field, group, rest, along);
        (!stops.is_empty()).then_some(Slide { along, stops })
    };
    tried.into_iter().filter_map(slide).collect()
}

fn stops(field: &Field, group: &Set, rest: &Set, along: DVec3) -> Vec<f64> {
    let view = View::new(&field.shapes, along);
    let pairs = || group.iter().flat_map(|&i| rest.iter().map(move |&j| (i, j)));
    let mut far = f64::INFINITY;
    for (i, j) in pairs() {
        match reach_contact(&view, i, j, field.touch) {
            Reach::Free => {}
            Reach::Until(t) => far = far.min(t),
            Reach::Unknown => return vec![],
        }
    }
    let least = LEAST_MOVE * field.touch.depth();
    if far < least {
        return vec![];
    }
    let mut stops: Vec<f64> = pairs().flat_map(|(i, j)| levels(&view, i, j)).filter(|t| *t > least).collect();
    stops.retain(|t| *t < far - least);
    stops.sort_by(f64::total_cmp);
    stops.dedup_by(|a, b| (*a - *b).abs() <= least);
    let every = stops.len().div_ceil(MOST_STOPS).max(1);
    let mut stops: Vec<f64> = stops.into_iter().step_by(every).collect();
    stops.extend(far.is_finite().then_some(far));
    stops
}

/// Where an end of a moving cell comes level with an end of a still one.
fn levels(view: &View, i: PartIx, j: PartIx) -> Vec<f64> {
    let ((moving, at_i), (still, at_j)) = (view.part(i), view.part(j));
    let ends = |s: &crate::blocking::shadow::Span| [s.lo.z, s.hi.z];
    let pairs = moving.spans.iter().flat_map(|x| still.spans.iter().map(move |y| (x, y)));
    let step = at_j.z - at_i.z;
    pairs.flat_map(|(x, y)| ends(y).into_iter().flat_map(move |b| ends(x).map(|a| b + step - a))).collect()
}
