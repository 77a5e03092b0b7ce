//! Takes a set from which parts, and groups that are named, leave straight, and what is wished of their order; gives the
//! order that a dynamic program over what is left finds.
//!
//! Whether a part or a group leaves along a direction depends on each other part by itself, so all orders along the
//! directions looked at are known from one table. Costs add up over what is left and the directions used; exact for
//! single parts as long as no layer of states is cut to the width that counted work allows (`Looked::all`). How a group
//! comes apart afterwards is not weighed here, so with groups it is not said to be exact. The test of rest is a short
//! one: that something is under a part; `rest` does more.

use super::super::field::Set;
use super::{Shop, Table, Wish};
use crate::assembly::PartIx;
use crate::blocking::SAME_ANGLE;
use crate::blocking::shadow::View;
use crate::watch::All;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// One bit for each part of a run.
type Bits = u128;

/// Parts of one run: as many as a word has bits.
const MOST_PARTS: usize = 128;

/// Directions looked at: the axes and up, and as many more as a plan may have and still be followed.
pub const MOST_DIRECTIONS: usize = 24;

/// Moves looked at in one search: a few seconds. Layers of states are cut so that no search takes more.
const MOST_LOOKS: usize = 8_000_000;

/// States of one layer, however small the set.
const WIDEST: usize = 4096;

pub struct Looked {
    pub states: usize,
    /// No layer was cut, and there were no groups.
    pub all: bool,
}

pub struct Choice {
    pub moves: Vec<(Set, DVec3)>,
    pub looked: Looked,
}

pub struct Run<'r> {
    parts: Vec<PartIx>,
    directions: &'r [DVec3],
    up: DVec3,
    /// Parts that stay to the end.
    keep: Bits,
    leave: usize,
    flexible: Bits,
    used: u32,
    /// What may leave: each part, then the groups.
    units: Vec<Bits>,
    /// For each direction and unit: who stops it.
    stops: Vec<Vec<Bits>>,
    /// Who may bear each part; all for one that stands by itself.
    under: Vec<Bits>,
    /// Parts that may lack a bearer: the first on a bench without a table.
    lacking: u32,
}

/// What is left, and what it cost to come so far.
#[derive(Clone, Copy)]
struct State {
    left: Bits,
    used: u32,
    aslant: u32,
    not_above: u32,
    air: u32,
    flexible: u32,
    /// The layer and the number in it of the state before.
    from: (usize, usize),
    unit: usize,
    direction: usize,
}

impl State {
    fn key(&self, ranked: &[Wish; 5]) -> [u32; 6] {
        let mut key = [0; 6];
        for (k, wish) in ranked.iter().enumerate() {
            key[k] = match wish {
                Wish::Flexible => self.flexible,
                // Each step makes two sets of one, so parts are one more than steps, whatever the order.
                Wish::Steps => 0,
                Wish::Air => self.air,
                Wish::Above => self.not_above,
                Wish::Directions => self.used.count_ones(),
            };
        }
        key[5] = self.aslant;
        key
    }
}

impl<'r> Run<'r> {
    /// None where the set is too large.
    pub fn new(
        shop: &Shop,
        (set, last, groups): (&Set, &Set, &[Set]),
        floor: f64,
        directions: &'r [DVec3],
        used: Vec<bool>,
    ) -> Option<Run<'r>> {
        let parts: Vec<PartIx> = set.iter().copied().collect();
        let held = |p: &PartIx| shop.field.is_held(*p);
        // Where one part that is not held is left, any may be.
        let any = last.len() == 1 && !parts.iter().any(held);
        let bits = |of: &dyn Fn(&PartIx) -> bool| -> Bits {
            parts.iter().enumerate().filter(|(_, p)| of(p)).map(|(k, _)| 1 << k).sum()
        };
        if parts.len() > MOST_PARTS {
            return None;
        }
        let alone = shop.ask.table == Table::None && !parts.iter().any(held);
        let singles = (0..parts.len()).map(|k| 1 << k);
        let units: Vec<Bits> = singles.chain(groups.iter().map(|g| bits(&|p| g.contains(p)))).collect();
        Some(Run {
            keep: if any { 0 } else { bits(&|p| last.contains(p)) },
            leave: parts.len() - last.len(),
            flexible: bits(&|p| shop.ask.flexible.contains(p)),
            used: used.iter().enumerate().filter(|(_, u)| **u).map(|(k, _)| 1 << k).sum(),
            stops: stops(shop, &parts, &units, directions),
            units,
            under: under(shop, &parts, floor),
            lacking: u32::from(alone),
            up: shop.ask.up,
            parts,
            directions,
        })
    }

    /// The order that counts least; none where some part leaves along no direction that is allowed.
    pub fn best(&self, ranked: &[Wish; 5]) -> Option<Choice> {
        let all = if self.parts.len() == MOST_PARTS { Bits::MAX } else { (1 << self.parts.len()) - 1 };
        let each = (self.parts.len() * self.units.len() * self.directions.len()).max(1);
        let width = (MOST_LOOKS / each).clamp(1, WIDEST);
        let start = State {
            left: all,
            used: self.used,
            aslant: 0,
            not_above: 0,
            air: 0,
            flexible: 0,
            from: (0, 0),
            unit: 0,
            direction: 0,
        };
        // By how many parts have left; a group skips layers.
        let mut open: Vec<BTreeMap<(Bits, u32), State>> = vec![BTreeMap::new(); self.leave + 1];
        open[0].insert((start.left, start.used), start);
        let mut layers: Vec<Vec<State>> = Vec::new();
        let mut looked = Looked { states: 0, all: self.units.len() == self.parts.len() };
        for gone in 0..=self.leave {
            let mut layer: Vec<State> = std::mem::take(&mut open[gone]).into_values().collect();
            layer.sort_by_key(|s| s.key(ranked));
            looked.states += layer.len();
            looked.all &= layer.len() <= width;
            layer.truncate(width);
            for (k, state) in layer.iter().enumerate() {
                self.after(state, (gone, k), ranked, &mut open);
            }
            layers.push(layer);
        }
        (!layers.last()?.is_empty()).then(|| Choice { moves: self.traced(&layers), looked })
    }

    /// Adds all that one move makes of this state to the layers, each once, the better where two are one.
    fn after(
        &self,
        state: &State,
        from: (usize, usize),
        ranked: &[Wish; 5],
        open: &mut [BTreeMap<(Bits, u32), State>],
    ) {
        for (unit, &parts) in self.units.iter().enumerate() {
            let to = from.0 + parts.count_ones() as usize;
            if parts & !(state.left & !self.keep) != 0 || to > self.leave {
                continue;
            }
            let free = |d: &usize| self.stops[*d][unit] & state.left == 0;
            for direction in (0..self.directions.len()).filter(free) {
                let new = self.moved(state, from, unit, direction);
                let known = open[to].entry((new.left, new.used)).or_insert(new);
                if new.key(ranked) < known.key(ranked) {
                    *known = new;
                }
            }
        }
    }

    fn moved(&self, state: &State, from: (usize, usize), unit: usize, direction: usize) -> State {
        let left = state.left & !self.units[unit];
        let d = self.directions[direction];
        let above = d.dot(self.up) > SAME_ANGLE;
        let rigid = self.flexible & self.units[unit] == 0;
        State {
            left,
            used: state.used | 1 << direction,
            aslant: state.aslant + u32::from(above && d.distance(self.up) > SAME_ANGLE),
            not_above: state.not_above + u32::from(!above),
            air: state.air + self.in_air(state.left),
            flexible: state.flexible + if rigid { (self.flexible & left).count_ones() } else { 0 },
            from,
            unit,
            direction,
        }
    }

    fn in_air(&self, set: Bits) -> u32 {
        let lacks = |k: &usize| set >> k & 1 == 1 && self.under[*k] & set == 0;
        ((0..self.parts.len()).filter(lacks).count() as u32).saturating_sub(self.lacking)
    }

    fn traced(&self, layers: &[Vec<State>]) -> Vec<(Set, DVec3)> {
        let (mut moves, mut at) = (Vec::new(), (self.leave, 0));
        while at.0 > 0 {
            let Some(state) = layers[at.0].get(at.1) else { return Vec::new() };
            let of_unit = |k: &usize| self.units[state.unit] >> k & 1 == 1;
            let parts = (0..self.parts.len()).filter(of_unit).map(|k| self.parts[k]);
            moves.push((parts.collect(), self.directions[state.direction]));
            at = state.from;
        }
        moves.reverse();
        moves
    }
}

/// Who stops each unit along each direction, as the planner tests it. Who is held is stopped by itself, and so is who
/// would go through the table.
fn stops(shop: &Shop, parts: &[PartIx], units: &[Bits], directions: &[DVec3]) -> Vec<Vec<Bits>> {
    let field = shop.field;
    let stage = field.watch.stage("who stops whom", "directions", All::Just(directions.len() as u64));
    let along = |&d: &DVec3| {
        let view = View::new(&field.shapes, d);
        let stopped = |p: PartIx, q: PartIx| {
            let (p, q) = (Set::from([p]), Set::from([q]));
            let opposed = field.sides(&p, &q).any(|s| s.normal.dot(d) > SAME_ANGLE);
            opposed || field.stopped(&view, &p, &q).is_some()
        };
        let into_table = shop.ask.table == Table::There && d.dot(shop.ask.up) < -SAME_ANGLE;
        let of = |(k, &p): (usize, &PartIx)| -> Bits {
            if field.is_held(p) || into_table {
                return 1 << k;
            }
            let others = parts.iter().enumerate().filter(|(j, _)| *j != k);
            others.filter(|(_, q)| stopped(p, **q)).map(|(j, _)| 1 << j).sum()
        };
        let each: Vec<Bits> = parts.iter().enumerate().map(of).collect();
        let of_unit = |&unit: &Bits| {
            let own = (0..parts.len()).filter(|k| unit >> k & 1 == 1);
            // Its own parts go along, unless one of them cannot go at all.
            own.fold(0, |all, k| all | each[k] & !unit | each[k] & 1 << k)
        };
        let all = units.iter().map(of_unit).collect();
        stage.add(1);
        all
    };
    directions.par_iter().map(along).collect()
}

/// Who has a contact with a part that pushes it up; itself where it is held or reaches the table.
fn under(shop: &Shop, parts: &[PartIx], floor: f64) -> Vec<Bits> {
    let (field, up) = (shop.field, shop.ask.up);
    let low = |p: PartIx| super::rest::lowest(field.asm, p, up);
    let of = |(k, &p): (usize, &PartIx)| -> Bits {
        let on_table = shop.ask.table == Table::There && low(p) <= floor + field.touch.depth();
        let own: Bits = if field.is_held(p) || on_table { 1 << k } else { 0 };
        let bears = |q: PartIx| {
            shop.patches.iter().any(|c| {
                (c.a == p && c.b == q && c.normal.dot(up) < -SAME_ANGLE)
                    || (c.b == p && c.a == q && c.normal.dot(up) > SAME_ANGLE)
            })
        };
        let others = parts.iter().enumerate().filter(|(j, q)| *j != k && bears(**q));
        own | others.map(|(j, _)| 1 << j).sum::<Bits>()
    };
    parts.iter().enumerate().map(of).collect()
}
