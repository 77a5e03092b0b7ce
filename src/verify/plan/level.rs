//! Takes the steps of a plan as written; says whether the moves and the level that the plan claims are those of its steps.
//!
//! Counted anew, set by set. Not checked: that no plan has fewer moves; only a search could.

use crate::sequence::lattice::answer::Counted;
use crate::sequence::{Ends, Step};
use std::collections::{BTreeMap, BTreeSet};

type Ids<'s> = BTreeSet<&'s str>;

/// Moves of a set up to its parting, and the sets that it parts into: what stays, what leaves.
#[derive(Default)]
struct Counts<'s> {
    moves: usize,
    parts_into: Option<(Ids<'s>, Ids<'s>)>,
}

/// # Errors
/// What does not agree.
pub fn counted(steps: &[Step], of: &[String], claimed: &Counted) -> Result<(), String> {
    let mut sets: BTreeMap<Ids, Counts> = BTreeMap::new();
    for step in steps {
        let stays: Ids = step.stays.iter().map(String::as_str).collect();
        let moved: Ids = step.parts.iter().map(String::as_str).collect();
        let own = sets.entry(stays.union(&moved).copied().collect()).or_default();
        own.moves += 1;
        if step.ends == Ends::Apart {
            own.parts_into = Some((stays, moved));
        }
    }
    if claimed.moves != steps.len() {
        return Err(format!("{} moves are claimed, {} are there", claimed.moves, steps.len()));
    }
    let whole: Ids = of.iter().map(String::as_str).collect();
    let found = level(&sets, &whole);
    let text = found.iter().map(usize::to_string).collect::<Vec<_>>().join(".");
    match (&claimed.levels, &claimed.level) {
        (None, None) => Ok(()),
        (Some(levels), Some(level)) if *levels == found && *level == text => Ok(()),
        _ => Err(format!("the level of these steps is {text}, not the one claimed")),
    }
}

fn level(sets: &BTreeMap<Ids, Counts>, set: &Ids) -> Vec<usize> {
    let Some(own) = sets.get(set) else { return Vec::new() };
    let below = own.parts_into.iter().flat_map(|(stays, leaves)| [stays, leaves]);
    let told = below.filter(|s| several(sets, s)).flat_map(|s| level(sets, s));
    std::iter::once(own.moves).chain(told).collect()
}

/// Whether the set or one that it parts into needs more than one move.
fn several(sets: &BTreeMap<Ids, Counts>, set: &Ids) -> bool {
    sets.get(set).is_some_and(|own| {
        own.moves > 1 || own.parts_into.iter().any(|(a, b)| several(sets, a) || several(sets, b))
    })
}
