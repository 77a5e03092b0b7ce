//! Takes contact rows over unknowns; gives the verdict with its witness.
//!
//! Works on few rows at a time: forces on some rows that balance, with full rank, prove the lock for all; a motion is
//! tested on all rows and the rows that it breaks join. Sound up to [`ROUND_OFF`]; not complete (undecided).

use super::again;
use super::interior::{Found, Rank, rank, search};
use super::reduce::{by_pair, kept, outermost, pair, turned};
use super::rows::{Freedom, Row, Unknowns};
use super::sparse::Pins;
use super::system::{Nodes, System};
use crate::assembly::PartIx;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// What the sum of up to a hundred thousand products of numbers of size 1 is off at most, with room for the solves
/// that lead there: 1e5 units of round-off are 2.2e-11.
pub const ROUND_OFF: f64 = 1e-10;

/// Share of what acts along an unknown that forces may miss of balance: 2^-43, a fourth of what `verify` grants.
pub(super) const BALANCED: f64 = 1.0 / (1_u64 << 43) as f64;

/// Rounds in which forces are brought to balance: each takes what the round-off of the one before left.
pub(super) const MOST_ROUNDS: usize = 4;

#[derive(Clone, Debug)]
pub enum Verdict {
    Locked(Stress),
    Free(Motion),
    Undecided(Gap),
}

impl Verdict {
    pub fn word(&self) -> &'static str {
        match self {
            Verdict::Locked(_) => "locked",
            Verdict::Free(_) => "free",
            Verdict::Undecided(_) => "undecided",
        }
    }
}

/// Contact forces, all at least 1, that balance on every part that could move; the rows they act on have full rank.
#[derive(Clone, Debug)]
pub struct Stress {
    pub forces: Vec<Force>,
    /// Rank of the rows that carry a force; equal to the number of unknowns.
    pub rank: usize,
    /// Largest component of the forces' sum over any unknown.
    pub residual: f64,
    /// The smallest pivot of the rows' Gram matrix, scaled to a unit diagonal, over its largest: how far the rank is
    /// from falling.
    pub pivot_ratio: f64,
}

/// A force of `size` along a row's normal.
#[derive(Clone, Copy, Debug)]
pub struct Force {
    pub row: Row,
    pub size: f64,
}

/// A motion that can start: a twist for each part that moves.
#[derive(Clone, Debug)]
pub struct Motion {
    pub twists: Vec<(PartIx, Twist)>,
    /// The fastest opening of a contact; 0 when everything slides.
    pub opening: f64,
    /// How far below 0 the worst row is, from round-off.
    pub worst: f64,
}

/// Velocity of a part: v(p) = translation + rotation x (p - centre).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist {
    pub translation: DVec3,
    pub rotation: DVec3,
    pub centre: DVec3,
}

/// Why neither proof holds.
#[derive(Clone, Debug)]
pub struct Gap {
    pub why: String,
    pub size: f64,
}

pub(super) fn undecided(why: impl Into<String>, size: f64) -> Verdict {
    Verdict::Undecided(Gap { why: why.into(), size })
}

/// Which rows a verdict starts from. All give the same verdict, but for round-off; they differ in cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Those that lie farthest along some axes, of the outlines of rows with one normal.
    Farthest,
    /// The outlines whole.
    Outlines,
    /// Those that lie farthest, of all rows.
    FarthestOfAll,
    /// All.
    All,
}

/// Locked, free or undecided over these rows.
pub fn decide(rows: &[Row], unknowns: &Unknowns) -> Verdict {
    decide_from(rows, unknowns, Start::Farthest)
}

/// As [`decide`], to measure what its reductions bring.
pub fn decide_from(rows: &[Row], unknowns: &Unknowns, start: Start) -> Verdict {
    let verdict = match unknowns.freedom {
        Freedom::Translation => Question::<3> { rows, unknowns, start }.decide(),
        Freedom::Rigid => Question::<6> { rows, unknowns, start }.decide(),
    };
    match verdict {
        Verdict::Undecided(_) if unknowns.count <= again::MOST_UNKNOWNS => again::decide(rows, unknowns),
        verdict => verdict,
    }
}

/// All rows, W unknowns for each free part.
struct Question<'a, const W: usize> {
    rows: &'a [Row],
    unknowns: &'a Unknowns,
    start: Start,
}

impl<const W: usize> Question<'_, W> {
    fn decide(&self) -> Verdict {
        if self.unknowns.count == 0 {
            return Verdict::Locked(Stress { forces: Vec::new(), rank: 0, residual: 0.0, pivot_ratio: 1.0 });
        }
        let mut kept = match self.start {
            Start::Farthest | Start::Outlines => kept(self.rows, self.unknowns),
            Start::FarthestOfAll | Start::All => by_pair(self.rows, self.unknowns),
        };
        let mut chosen = match self.start {
            Start::Farthest | Start::FarthestOfAll => outermost(self.rows, &kept, self.unknowns.freedom),
            Start::Outlines | Start::All => kept.clone(),
        };
        // Where most would be chosen, a second search costs more than the rest of the rows.
        if 2 * chosen.len() > kept.len() {
            chosen.clone_from(&kept);
        }
        if let Some(motion) = self.alone(&chosen, &kept) {
            return Verdict::Free(motion);
        }
        loop {
            let x = match self.of_chosen(&chosen) {
                Answer::Moves(x) => x,
                Answer::Is(verdict) => return verdict,
            };
            if let Some(motion) = self.motion(&x) {
                return Verdict::Free(motion);
            }
            let before: BTreeSet<usize> = chosen.iter().copied().collect();
            // What few rows do not lock is asked with all that are worth it; then only what is left out by round-off joins.
            let mut more = self.broken(&x);
            more.append(&mut kept);
            if more.iter().all(|k| before.contains(k)) {
                return undecided("a motion breaks no row by more than round-off, yet not none", ROUND_OFF);
            }
            chosen.extend(more);
            chosen.sort_unstable_by_key(|&k| (pair(&self.rows[k]), k));
            chosen.dedup();
        }
    }

    fn of_chosen(&self, chosen: &[usize]) -> Answer {
        let some: Vec<Row> = chosen.iter().map(|&k| turned(&self.rows[k])).collect();
        let node = |p: PartIx| self.unknowns.column[p.at()].map(|c| c / W);
        let system = System::<W>::new(&some, self.unknowns, self.unknowns.count / W, node);
        let x = match search(&system) {
            Found::Stress(y) => match rank(&system) {
                Rank::Full(pivot_ratio) => {
                    let y = self.balanced(&system, &some, y);
                    return Answer::Is(self.lock(chosen, &y, pivot_ratio));
                }
                Rank::Lacks(x) => x,
                Rank::Unknown(gap) => return Answer::Is(Verdict::Undecided(gap)),
            },
            Found::Motion(x) => x,
            Found::Neither(gap) => return Answer::Is(Verdict::Undecided(gap)),
        };
        Answer::Moves(x.into_iter().flatten().collect())
    }

    /// The motion of the first part that can start to move while all others stand still: most free assemblies have
    /// one, and its few unknowns cost nothing beside those of all parts together. What few rows do not stop is asked with
    /// all that are worth it.
    fn alone(&self, chosen: &[usize], kept: &[usize]) -> Option<Motion> {
        let (few, all) = (self.by_part(chosen), self.by_part(kept));
        few.par_iter().zip(&all).enumerate().find_map_first(|(part, (few, all))| {
            self.unknowns.column[part]?;
            let moved = self.moves_alone(part, few)?;
            self.motion(&moved).or_else(|| self.moves_alone(part, all).and_then(|x| self.motion(&x)))
        })
    }

    fn by_part(&self, rows: &[usize]) -> Vec<Vec<usize>> {
        let mut own: Vec<Vec<usize>> = vec![Vec::new(); self.unknowns.column.len()];
        for &k in rows {
            own[self.rows[k].a.at()].push(k);
            own[self.rows[k].b.at()].push(k);
        }
        own
    }

    /// A motion of one part that these rows allow.
    fn moves_alone(&self, part: usize, own: &[usize]) -> Option<Vec<f64>> {
        let column = self.unknowns.column[part]?;
        let some: Vec<Row> = own.iter().map(|&k| turned(&self.rows[k])).collect();
        let system = System::<W>::new(&some, self.unknowns, 1, |p| (p.at() == part).then_some(0));
        let moved = match search(&system) {
            Found::Motion(x) => x,
            Found::Stress(_) => match rank(&system) {
                Rank::Lacks(x) => x,
                Rank::Full(_) | Rank::Unknown(_) => return None,
            },
            Found::Neither(_) => return None,
        };
        let mut x = vec![0.0; self.unknowns.count];
        x[column..column + W].copy_from_slice(&moved[0]);
        Some(x)
    }

    /// The forces with what they miss of balance, by the unknowns' own entries, taken off in proportion to their squares,
    /// until it is within [`BALANCED`] or no more can be done.
    fn balanced(&self, system: &System<W>, rows: &[Row], mut y: Vec<f64>) -> Vec<f64> {
        let mut factor = None;
        let squares: Vec<f64> = y.iter().map(|f| f * f).collect();
        for _ in 0..MOST_ROUNDS {
            let (missing, share) = self.missing(rows, &y);
            if share <= BALANCED {
                break;
            }
            let factor = factor.get_or_insert_with(|| system.factor(&squares, Pins::RoundOff));
            let off = system.openings(&factor.solve(&system.pattern, &missing));
            let better: Vec<f64> = (0..y.len()).map(|k| y[k] - squares[k] * off[k]).collect();
            // Forces that would not push any more: the numbers carry no more.
            if !better.iter().all(|f| *f > 0.0) {
                break;
            }
            y = better;
        }
        y
    }

    /// What forces miss of balance, and the largest share of what acts along an unknown that this is.
    fn missing(&self, rows: &[Row], y: &[f64]) -> (Nodes<W>, f64) {
        let nodes = self.unknowns.count / W;
        let (mut missing, mut acting) = (vec![[0.0; W]; nodes], vec![[0.0; W]; nodes]);
        for (row, f) in rows.iter().zip(y) {
            for (c, v) in self.unknowns.entries(row) {
                missing[c / W][c % W] += v * f;
                acting[c / W][c % W] += (v * f).abs();
            }
        }
        let shares = missing.iter().flatten().zip(acting.iter().flatten());
        let share = shares.map(|(m, a)| if *m == 0.0 { 0.0 } else { m.abs() / a }).fold(0.0, f64::max);
        (missing, share)
    }

    /// The forces scaled to at least 1, in the order of the rows, if they balance by the unknowns' own entries too.
    fn lock(&self, chosen: &[usize], y: &[f64], pivot_ratio: f64) -> Verdict {
        let least = y.iter().copied().fold(f64::INFINITY, f64::min);
        let force = |(&k, f): (&usize, &f64)| (k, Force { row: self.rows[k], size: (f / least).max(1.0) });
        let mut forces: Vec<(usize, Force)> = chosen.iter().zip(y).map(force).collect();
        forces.sort_unstable_by_key(|f| f.0);
        let forces: Vec<Force> = forces.into_iter().map(|f| f.1).collect();
        let residual = self.sum(&forces);
        let top = forces.iter().map(|f| f.size).fold(0.0, f64::max);
        if residual.is_nan() || residual > ROUND_OFF * top {
            return undecided("the forces do not balance to round-off", residual);
        }
        Verdict::Locked(Stress { forces, rank: self.unknowns.count, residual, pivot_ratio })
    }

    /// The largest component of the forces' sum.
    fn sum(&self, forces: &[Force]) -> f64 {
        let mut sum = vec![0.0; self.unknowns.count];
        for f in forces {
            self.unknowns.entries(&f.row).for_each(|(c, v)| sum[c] += v * f.size);
        }
        sum.into_iter().map(f64::abs).fold(0.0, f64::max)
    }

    /// The motion, if it keeps every row. Its largest component is 1.
    fn motion(&self, x: &[f64]) -> Option<Motion> {
        let openings = || self.rows.iter().map(|r| self.unknowns.opening(r, x));
        let worst = openings().fold(0.0, f64::min);
        let opening = openings().fold(0.0, f64::max);
        let opening = if opening > ROUND_OFF { opening } else { 0.0 };
        (worst >= -ROUND_OFF).then(|| Motion { twists: twists(self.unknowns, x), opening, worst: -worst })
    }

    /// The row that the motion breaks most, for each pair of parts.
    fn broken(&self, x: &[f64]) -> Vec<usize> {
        let mut worst: BTreeMap<(u32, u32), (f64, usize)> = BTreeMap::new();
        for (k, row) in self.rows.iter().enumerate() {
            let opening = self.unknowns.opening(row, x);
            if opening < -ROUND_OFF {
                let entry = worst.entry(pair(row)).or_insert((opening, k));
                if opening < entry.0 {
                    *entry = (opening, k);
                }
            }
        }
        worst.into_values().map(|w| w.1).collect()
    }
}

/// What some of the rows say: a motion that they allow, or the verdict.
enum Answer {
    Moves(Vec<f64>),
    Is(Verdict),
}

pub(super) fn twists(unknowns: &Unknowns, x: &[f64]) -> Vec<(PartIx, Twist)> {
    let of = |(part, column): (usize, &Option<usize>)| {
        let c = (*column)?;
        let own = &x[c..c + unknowns.freedom.unknowns()];
        let translation = DVec3::from_slice(own);
        let rotation = match unknowns.freedom {
            Freedom::Translation => DVec3::ZERO,
            Freedom::Rigid => DVec3::from_slice(&own[3..]) / unknowns.lever[part],
        };
        let centre = unknowns.centre[part];
        let moves = own.iter().any(|v| *v != 0.0);
        moves.then_some((PartIx(part as u32), Twist { translation, rotation, centre }))
    };
    unknowns.column.iter().enumerate().filter_map(of).collect()
}
