//! Takes a locked set of parts; gives one inside it that nothing can be left out of.
//!
//! Not promised: that it has the fewest parts of all such sets inside; nor, if [`MOST_WORK`] is spent, that nothing can
//! be left out.

use super::split::{Guard, largest};
use super::{Contacts, Core, Set};
use crate::assembly::PartIx;
use std::collections::VecDeque;

/// Leaves out chunks of parts, halved until single parts are tried, while something locked is left. Each part that was
/// tried in vain is needed for good: what is locked in less is locked in more.
pub fn least(contacts: &Contacts, core: Core) -> Core {
    let mut core = core;
    let mut needed = Set::new();
    let mut chunk = core.parts.len().div_ceil(2);
    while chunk > 0 {
        let order: Vec<PartIx> =
            in_order(contacts, &core.parts).into_iter().filter(|p| !needed.contains(p)).collect();
        let mut smaller = None;
        for out in order.chunks(chunk) {
            let less: Set = core.parts.iter().copied().filter(|p| !out.contains(p)).collect();
            smaller =
                largest(contacts, &less, Guard::Without).largest.into_iter().min_by_key(|c| c.parts.len());
            if smaller.is_some() {
                break;
            }
            if let [one] = out {
                needed.insert(*one);
            }
        }
        match smaller {
            Some(less) => {
                // What all cores of the larger set need, those of a smaller one need.
                core = less;
                chunk = chunk.min(core.parts.len().div_ceil(2));
            }
            None => chunk /= 2,
        }
    }
    core
}

/// Breadth first through the contacts, so that what follows one another lies together.
fn in_order(contacts: &Contacts, set: &Set) -> Vec<PartIx> {
    let mut order = Vec::new();
    let mut seen = Set::new();
    for &first in set {
        let mut queue = VecDeque::from([first]);
        while let Some(p) = queue.pop_front() {
            if seen.insert(p) {
                order.push(p);
                queue.extend(contacts.beside(p).filter(|q| set.contains(q)).collect::<Set>());
            }
        }
    }
    order
}
