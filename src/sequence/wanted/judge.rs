//! Takes steps of a plan; counts what each wish asks about.
//!
//! Rest is judged for every set as it stands when a part or group has just been put to it, at its place in the whole:
//! parts under way, and sets with a part that a motion within a set has taken from its place, are not judged.

use super::super::answer::Step;
use super::super::field::Set;
use super::super::motion::Ends;
use super::rest::{Pile, Rest, lowest, rest};
use super::{Shop, Table, Wish, out_along};
use crate::assembly::PartIx;
use crate::blocking::SAME_ANGLE;
use crate::watch::All;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What a plan counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    pub steps: usize,
    /// No plan of these parts has fewer: each step parts one set in two at most.
    pub least_steps: usize,
    pub directions: usize,
    pub from_above: usize,
    pub aslant: usize,
    pub sideways: usize,
    pub from_below: usize,
    pub turns: usize,
    /// Steps whose parts would go through the table.
    pub through_table: usize,
    /// For each step, from assembled to apart: how the set stands when the step has just been done in assembly.
    pub rests: Vec<Rest>,
    /// Rigid parts that go in after a flexible one, over all flexible ones.
    pub after_flexible: usize,
}

impl Judged {
    /// The number to be small; none where some of it is undecided.
    pub fn count(&self, wish: Wish) -> Option<usize> {
        match wish {
            Wish::Flexible => Some(self.after_flexible),
            Wish::Steps => Some(self.steps),
            Wish::Above => Some(self.sideways + self.from_below + self.turns),
            Wish::Directions => Some(self.directions),
            Wish::Air if self.rests.contains(&Rest::Undecided) => None,
            Wish::Air => Some(self.held().sum()),
        }
    }

    fn held(&self) -> impl Iterator<Item = usize> + '_ {
        self.rests.iter().map(|r| match r {
            Rest::Held { parts, .. } => parts.len(),
            _ => 0,
        })
    }

    /// For comparing: undecided counts as the parts known to be held; what goes through a table comes before all wishes.
    pub(super) fn key(&self, ranked: &[Wish; 5]) -> [usize; 7] {
        let mut key = [self.through_table, 0, 0, 0, 0, 0, self.aslant];
        for (k, &wish) in ranked.iter().enumerate() {
            key[k + 1] = self.count(wish).unwrap_or_else(|| self.held().sum());
        }
        key
    }
}

pub fn judge(shop: &Shop, steps: &[Step]) -> Judged {
    Judged { rests: rests(shop, steps), ..moves(shop, steps) }
}

/// All but the rest: nothing is said of it.
pub fn moves(shop: &Shop, steps: &[Step]) -> Judged {
    let up = shop.ask.up;
    let along: Vec<Option<DVec3>> = steps.iter().map(out_along).collect();
    let of = |is: &dyn Fn(DVec3) -> bool| along.iter().flatten().filter(|d| is(**d)).count();
    let straight_up = |d: DVec3| d.distance(up) <= SAME_ANGLE;
    let mut distinct: Vec<DVec3> = Vec::new();
    for d in along.iter().flatten() {
        if distinct.iter().all(|o| o.distance(*d) > SAME_ANGLE) {
            distinct.push(*d);
        }
    }
    let turns = along.iter().filter(|d| d.is_none()).count();
    let partings = steps.iter().filter(|s| s.ends == Ends::Apart).count();
    Judged {
        steps: steps.len(),
        least_steps: partings,
        directions: distinct.len() + turns,
        from_above: of(&straight_up),
        aslant: of(&|d| d.dot(up) > SAME_ANGLE && !straight_up(d)),
        sideways: of(&|d| d.dot(up).abs() <= SAME_ANGLE),
        from_below: of(&|d| d.dot(up) < -SAME_ANGLE),
        turns,
        through_table: if shop.ask.table == Table::There { of(&|d| d.dot(up) < -SAME_ANGLE) } else { 0 },
        rests: Vec::new(),
        after_flexible: after_flexible(shop, steps),
    }
}

/// How each set rests on its table, its held parts, or its first part.
fn rests(shop: &Shop, steps: &[Step]) -> Vec<Rest> {
    let floors = floors(shop, steps);
    let elsewhere = elsewhere(shop, steps);
    let watch = &shop.field.watch;
    let stage = watch.stage("what rests", "steps", All::Just(steps.len() as u64));
    let one = |(k, s): (usize, &Step)| {
        let (mut set, stays) = (shop.set(&s.parts), shop.set(&s.stays));
        set.extend(&stays);
        if watch.is_stopped() || !set.is_disjoint(&elsewhere[k]) {
            return Rest::Undecided;
        }
        let rest = judged(shop, &set, floors[k], first_placed(shop, stays, &steps[k + 1..]));
        stage.add(1);
        rest
    };
    let each: Vec<(usize, &Step)> = steps.iter().enumerate().collect();
    each.into_par_iter().map(one).collect()
}

/// For each step, the parts that motions within a set have taken from their places before it.
fn elsewhere(shop: &Shop, steps: &[Step]) -> Vec<Set> {
    let gone = |moved: &mut Set, s: &Step| {
        let before = moved.clone();
        if s.ends == Ends::Inside {
            moved.extend(shop.set(&s.parts));
        }
        Some(before)
    };
    steps.iter().scan(Set::new(), gone).collect()
}

/// The height of the table for each step: what stays keeps its place, what is built apart gets a table of its own.
pub fn floors(shop: &Shop, steps: &[Step]) -> Vec<f64> {
    let mut known: BTreeMap<Set, f64> = BTreeMap::new();
    let low = |p: &PartIx| lowest(shop.field.asm, *p, shop.ask.up);
    let of = |s: &Step| {
        let (mut set, stays) = (shop.set(&s.parts), shop.set(&s.stays));
        set.extend(&stays);
        let own = || set.iter().map(low).fold(f64::INFINITY, f64::min);
        let floor = known.get(&set).copied().unwrap_or_else(own);
        known.insert(stays, floor);
        floor
    };
    steps.iter().map(of).collect()
}

fn judged(shop: &Shop, set: &Set, floor: f64, first: Option<PartIx>) -> Rest {
    let (field, up) = (shop.field, shop.ask.up);
    let held: Set = set.iter().copied().filter(|&p| field.is_held(p)).collect();
    let table = (shop.ask.table == Table::There).then(|| (floor, field.touch.depth()));
    let fixed = if held.is_empty() && table.is_none() { first.into_iter().collect() } else { held };
    rest(&Pile { asm: field.asm, patches: shop.patches, set, fixed: &fixed, up, table })
}

/// The part of a set that later steps leave to the last: in assembly it is there first.
fn first_placed(shop: &Shop, mut set: Set, later: &[Step]) -> Option<PartIx> {
    for s in later {
        let stays = shop.set(&s.stays);
        let mut own = shop.set(&s.parts);
        own.extend(&stays);
        if own == set {
            set = stays;
        }
    }
    set.first().copied()
}

/// In assembly, the rigid parts that come to a set in which a flexible part already is.
fn after_flexible(shop: &Shop, steps: &[Step]) -> usize {
    let flexible = &shop.ask.flexible;
    let of = |s: &Step| {
        let (parts, stays) = (shop.set(&s.parts), shop.set(&s.stays));
        let rigid = parts.iter().filter(|p| !flexible.contains(p)).count();
        rigid * stays.intersection(flexible).count()
    };
    steps.iter().filter(|s| s.ends == Ends::Apart).map(of).sum()
}
