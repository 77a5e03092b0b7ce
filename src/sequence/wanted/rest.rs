//! Takes a set of parts in place, gravity, and what stands by itself; says whether the parts rest, or which must be held.
//!
//! Statics of rigid parts of one density: contact forces that push, without friction, balance the weight of every part
//! (a linear program over the corners of the contact patches, clarabel). `Rests` means that such forces exist; not that
//! the rest is stable against a knock. With friction more would rest. Where hands must help, they may give each part any
//! force and moment; the least sum of these is found, the lower of parts that stand on each other first. The program
//! begins with few corners and takes in others by their prices (column generation; Dantzig and Wolfe 1960) until none of
//! all corners would make it better.

use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::sequence::field::Set;
use crate::solid::Solid;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Share of all weight below which hands bear nothing: what the solver promises (1e-8), with room for many rows.
const SOLVED_TO: f64 = 1e-6;

/// By how much a hand on the highest part costs more than on the lowest: little, so that the least sum stays nearly that.
const HIGHER_COSTS: f64 = 1.0 / 64.0;

/// Of a push, where a hand costs 1: parts wedged so that only pushes of a million times all weight would bear them count as
/// held. Without it pushes that balance each other may grow without end, and the solver does not come to one.
const PUSH_COSTS: f64 = 1.0 / (1u64 << 20) as f64;

#[derive(Clone, Debug, PartialEq)]
pub enum Rest {
    Rests,
    /// Hands must bear this share of the weight, at these parts.
    Held {
        parts: Vec<PartIx>,
        share: f64,
    },
    Undecided,
}

/// A corner is taken in where its push would pay at this multiple of `PUSH_COSTS`: so the answer is the best one for pushes
/// that cost something between one and this, and prices wrong by what the solver promises call nobody.
const PAYS_AT: f64 = 1.5;

/// A set of parts and what bears it.
pub struct Pile<'p> {
    pub asm: &'p Assembly,
    pub patches: &'p [Patch],
    pub set: &'p Set,
    /// Parts that stand by themselves: held, or fixed on the bench.
    pub fixed: &'p Set,
    /// Against gravity, unit vector.
    pub up: DVec3,
    /// Height of the table along `up`, and how far a corner may be from it and still touch, model units.
    pub table: Option<(f64, f64)>,
}

/// A force that may push a part, at a corner.
struct Push {
    on: [Option<PartIx>; 2],
    normal: DVec3,
    point: DVec3,
}

pub fn rest(pile: &Pile) -> Rest {
    let free: Vec<PartIx> = pile.set.iter().copied().filter(|p| !pile.fixed.contains(p)).collect();
    if free.is_empty() {
        return Rest::Rests;
    }
    let statics = Statics::new(pile, &free);
    let all = pushes(pile);
    let mut chosen = farthest(&all, pile);
    loop {
        let Some(balance) = statics.solved(&all, &chosen, pile.up) else { return Rest::Undecided };
        let more = statics.called(&all, &chosen, &balance.prices);
        if balance.rest == Rest::Rests || more.is_empty() {
            return balance.rest;
        }
        chosen.extend(more);
    }
}

fn pushes(pile: &Pile) -> Vec<Push> {
    let free = |p: PartIx| (pile.set.contains(&p) && !pile.fixed.contains(&p)).then_some(p);
    let between = pile.patches.iter().filter(|c| pile.set.contains(&c.a) && pile.set.contains(&c.b));
    // A contact pushes `a` against its normal and `b` along it.
    let contacts = between.flat_map(|c| {
        c.corners.iter().map(move |&point| Push { on: [free(c.a), free(c.b)], normal: c.normal, point })
    });
    let mut all: Vec<Push> = contacts.filter(|p| p.on != [None, None]).collect();
    let Some((height, near)) = pile.table else { return all };
    for p in pile.set.iter().copied().filter(|&p| free(p).is_some()) {
        let (part, solid) = (pile.asm.part(p), pile.asm.solid(p));
        let corners = solid.vertices.iter().map(|&v| part.pose.transform_point3(v));
        let low = corners.filter(|v| v.dot(pile.up) <= height + near);
        all.extend(low.map(|point| Push { on: [None, Some(p)], normal: pile.up, point }));
    }
    all
}

/// Of each pair, the corners that lie farthest along the axes of force and moment: which of all.
fn farthest(all: &[Push], pile: &Pile) -> Vec<usize> {
    type Farthest = BTreeMap<([Option<PartIx>; 2], usize), (f64, usize)>;
    let mut best = Farthest::new();
    let about = pile.set.iter().map(|&p| pile.asm.centre(p)).sum::<DVec3>() / pile.set.len().max(1) as f64;
    for (k, push) in all.iter().enumerate() {
        let arm = (push.point - about).cross(push.normal);
        let six = [push.normal.to_array(), arm.to_array()].concat();
        for (axis, v) in six.into_iter().flat_map(|v| [v, -v]).enumerate() {
            let known = best.entry((push.on, axis)).or_insert((v, k));
            if v > known.0 {
                *known = (v, k);
            }
        }
    }
    let mut chosen: Vec<usize> = best.into_values().map(|(_, k)| k).collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// A program's answer.
struct Balance {
    rest: Rest,
    /// Of each row of balance: what the whole would cost more if it asked for one more of that force or moment.
    prices: Vec<f64>,
}

/// The parts that must be borne, and what they weigh.
struct Statics<'f> {
    /// Ascending.
    free: &'f [PartIx],
    /// Volume and centre of mass.
    masses: Vec<(f64, DVec3)>,
    /// Makes moments comparable with forces: the size of all of them.
    lever: f64,
}

impl<'f> Statics<'f> {
    fn new(pile: &Pile, free: &'f [PartIx]) -> Self {
        let masses = free.iter().map(|&p| mass(pile.asm, p)).collect();
        Statics { free, masses, lever: span(pile.asm, free) }
    }

    /// Three forces and three moments for each part.
    fn rows(&self) -> usize {
        6 * self.free.len()
    }

    /// None where the program was not solved.
    fn solved(&self, all: &[Push], chosen: &[usize], up: DVec3) -> Option<Balance> {
        let (matrix, limits) = self.balance(all, chosen, up);
        let cost = self.cost(chosen.len(), up);
        let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
        let cones = [ZeroConeT(self.rows()), NonnegativeConeT(cost.len())];
        let none = CscMatrix::zeros((cost.len(), cost.len()));
        let mut solver = DefaultSolver::new(&none, &cost, &matrix, &limits, &cones, settings).ok()?;
        solver.solve();
        if !matches!(solver.solution.status, SolverStatus::Solved) {
            return None;
        }
        let hands = &solver.solution.x[chosen.len()..];
        let of = |k: usize| hands[12 * k..12 * (k + 1)].iter().map(|h| h.max(0.0)).sum::<f64>();
        let free = self.free;
        let parts: Vec<PartIx> = (0..free.len()).filter(|&k| of(k) > SOLVED_TO).map(|k| free[k]).collect();
        let share = (0..free.len()).map(of).sum();
        let rest = if parts.is_empty() { Rest::Rests } else { Rest::Held { parts, share } };
        Some(Balance { rest, prices: solver.solution.z[..self.rows()].iter().map(|z| -z).collect() })
    }

    /// Of each pair of parts, the corner that is not in the program and whose push would pay most, if any pays.
    fn called(&self, all: &[Push], chosen: &[usize], prices: &[f64]) -> Vec<usize> {
        let known: BTreeSet<usize> = chosen.iter().copied().collect();
        let mut best: BTreeMap<[Option<PartIx>; 2], (f64, usize)> = BTreeMap::new();
        for (k, push) in all.iter().enumerate().filter(|(k, _)| !known.contains(k)) {
            let pays: f64 = self.column(push).map(|(row, v)| v * prices[row]).sum();
            let most = best.entry(push.on).or_insert((PAYS_AT * PUSH_COSTS, k));
            if pays > most.0 {
                *most = (pays, k);
            }
        }
        best.into_values().filter(|(pays, _)| *pays > PAYS_AT * PUSH_COSTS).map(|(_, k)| k).collect()
    }

    /// What a push of 1 does to the parts that must be borne: rows of balance and how much.
    fn column<'c>(&'c self, push: &'c Push) -> impl Iterator<Item = (usize, f64)> + 'c {
        push.on.iter().zip([-1.0, 1.0]).flat_map(move |(part, sign)| {
            let k = part.and_then(|p| self.free.binary_search(&p).ok());
            k.into_iter().flat_map(move |k| {
                let moment = (push.point - self.masses[k].1).cross(push.normal) / self.lever;
                let six = push.normal.to_array().into_iter().chain(moment.to_array());
                six.enumerate().map(move |(d, v)| (6 * k + d, sign * v))
            })
        })
    }

    /// Rows of balance (all weight is 1), then of unknowns that are at least 0: pushes, and hands both ways on each row.
    fn balance(&self, all: &[Push], chosen: &[usize], up: DVec3) -> (CscMatrix, Vec<f64>) {
        let (mut is, mut js, mut vs) = (Vec::new(), Vec::new(), Vec::new());
        let mut put = |i: usize, j: usize, v: f64| {
            is.push(i);
            js.push(j);
            vs.push(v);
        };
        for (j, &push) in chosen.iter().enumerate() {
            self.column(&all[push]).for_each(|(i, v)| put(i, j, v));
        }
        let (rows, unknowns) = (self.rows(), chosen.len() + 2 * self.rows());
        for i in 0..rows {
            put(i, chosen.len() + 2 * i, 1.0);
            put(i, chosen.len() + 2 * i + 1, -1.0);
        }
        (0..unknowns).for_each(|j| put(rows + j, j, -1.0));
        let total: f64 = self.masses.iter().map(|m| m.0).sum();
        let lift = |(weight, _): &(f64, DVec3)| [(up * (weight / total)).to_array(), [0.0; 3]].concat();
        let limits = self.masses.iter().flat_map(lift).chain(std::iter::repeat_n(0.0, unknowns)).collect();
        (CscMatrix::new_from_triplets(rows + unknowns, unknowns, is, js, vs), limits)
    }

    /// Pushes cost next to nothing, hands what they bear.
    fn cost(&self, pushes: usize, up: DVec3) -> Vec<f64> {
        let hands = dearness(&self.masses, up).into_iter().flat_map(|dear| [dear; 12]);
        std::iter::repeat_n(PUSH_COSTS, pushes).chain(hands).collect()
    }
}

/// What a hand costs on each part: a little more on higher ones.
fn dearness(masses: &[(f64, DVec3)], up: DVec3) -> Vec<f64> {
    let mut order: Vec<usize> = (0..masses.len()).collect();
    order.sort_by(|&a, &b| masses[a].1.dot(up).total_cmp(&masses[b].1.dot(up)).then(a.cmp(&b)));
    let mut dear = vec![1.0; masses.len()];
    for (rank, &k) in order.iter().enumerate() {
        dear[k] += HIGHER_COSTS * rank as f64 / masses.len() as f64;
    }
    dear
}

fn span(asm: &Assembly, parts: &[PartIx]) -> f64 {
    let corners = parts.iter().flat_map(|&p| {
        let pose = asm.part(p).pose;
        asm.solid(p).vertices.iter().map(move |&v| pose.transform_point3(v))
    });
    let (lo, hi) = crate::blocking::bounds(corners);
    (hi - lo).length()
}

/// Volume and centre of mass, in place.
fn mass(asm: &Assembly, p: PartIx) -> (f64, DVec3) {
    let solid: &Solid = asm.solid(p);
    let (volume, moment) = solid.triangles().fold((0.0, DVec3::ZERO), |(v, m), t| {
        let [a, b, c] = t.map(|i| solid.vertices[i as usize]);
        let six = a.dot(b.cross(c));
        (v + six / 6.0, m + (a + b + c) * (six / 24.0))
    });
    (volume, asm.part(p).pose.transform_point3(moment / volume))
}

/// Height of the lowest corner of a part.
pub fn lowest(asm: &Assembly, p: PartIx, up: DVec3) -> f64 {
    let pose = asm.part(p).pose;
    asm.solid(p).vertices.iter().map(|&v| pose.transform_point3(v).dot(up)).fold(f64::INFINITY, f64::min)
}
