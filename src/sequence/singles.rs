//! Takes a set of parts, lets every single part go that can: one round of moves, in few directions.
//!
//! A part that is free stays free when others leave, so all that a round finds can go one after the other.

use super::Work;
use super::field::{Field, Set};
use super::leave::{Found, Search, leave};
use crate::assembly::PartIx;
use crate::blocking::SAME_ANGLE;
use crate::blocking::shadow::View;
use glam::DVec3;
use rayon::prelude::*;

/// Directions of one round among which parts are asked to agree: enough for the sides of a box and its diagonals.
const MOST_SHARED: usize = 16;

impl Work<'_, '_> {
    /// True when at least one part left the set.
    pub(super) fn singles_leave(&mut self, set: &mut Set) -> bool {
        if self.is_done(set) || self.field.watch.is_stopped() {
            return false;
        }
        let (field, used) = (self.field, &self.used);
        let ask: Vec<PartIx> =
            set.iter().copied().filter(|&p| !field.is_held(p) && self.is_open(p, set)).collect();
        let found: Vec<Search> =
            ask.par_iter().map(|&p| leave(field, &Set::from([p]), &without(set, p), used)).collect();
        self.searched.sets += ask.len();
        self.searched.directions += found.iter().map(|s| s.tried).sum::<usize>();
        let mut free = Vec::new();
        for (p, search) in ask.into_iter().zip(found) {
            match search.found {
                Found::Along(d) => free.push((p, d)),
                settled => drop(self.settled.insert(p, settled)),
            }
        }
        self.leave_in_turn(set, agree(field, set, free))
    }

    /// False as long as all that was in the way when the part was last looked at is still there.
    fn is_open(&self, p: PartIx, set: &Set) -> bool {
        match self.settled.get(&p) {
            Some(Found::Never { because } | Found::GaveUp { because }) => !because.is_subset(set),
            _ => true,
        }
    }

    fn leave_in_turn(&mut self, set: &mut Set, free: Vec<(PartIx, DVec3)>) -> bool {
        let before = set.len();
        for (p, d) in free {
            if set.len() > 1 {
                *set = self.go(Set::from([p]), d, set);
            }
        }
        set.len() < before
    }
}

fn without(set: &Set, p: PartIx) -> Set {
    set.iter().copied().filter(|&q| q != p).collect()
}

/// Gives parts a common direction where they have one, most common first, small parts first within a direction.
fn agree(field: &Field, set: &Set, free: Vec<(PartIx, DVec3)>) -> Vec<(PartIx, DVec3)> {
    let mut shared: Vec<DVec3> = Vec::new();
    for &(_, d) in &free {
        if shared.len() < MOST_SHARED && shared.iter().all(|s| s.distance(d) > SAME_ANGLE) {
            shared.push(d);
        }
    }
    let open: Vec<Vec<bool>> = shared.par_iter().map(|&d| can_leave(field, set, &free, d)).collect();
    let mut left: Vec<usize> = (0..free.len()).collect();
    let mut out = Vec::new();
    while !left.is_empty() {
        let count = |k: &usize| left.iter().filter(|&&f| open[*k][f]).count();
        let best = (0..shared.len()).rev().max_by_key(count).filter(|k| count(k) > 0);
        let (mut go, stay): (Vec<usize>, Vec<usize>) =
            left.iter().partition(|&&f| best.is_none_or(|k| open[k][f]));
        go.sort_by(|&a, &b| field.volume(free[a].0).total_cmp(&field.volume(free[b].0)).then(a.cmp(&b)));
        out.extend(go.into_iter().map(|f| (free[f].0, best.map_or(free[f].1, |k| shared[k]))));
        left = stay;
    }
    out
}

fn can_leave(field: &Field, set: &Set, free: &[(PartIx, DVec3)], d: DVec3) -> Vec<bool> {
    let view = View::new(&field.shapes, d);
    free.iter()
        .map(|&(p, own)| {
            let (part, rest) = (Set::from([p]), without(set, p));
            let opposed = field.sides(&part, &rest).any(|s| s.normal.dot(d) > SAME_ANGLE);
            own == d || (!opposed && field.stopped(&view, &part, &rest).is_none())
        })
        .collect()
}
