//! Takes contact rows over unknowns; gives the verdict with its witness.
//!
//! Works on few rows at a time: forces on some rows that balance, with full rank, prove the lock for all; a motion is
//! tested on all rows and the rows that it breaks join. Sound up to [`ROUND_OFF`]; not complete (undecided).

use super::interior::{Found, keeps, polished, search};
use super::reduce::{kept, pair, turned};
use super::rows::{Freedom, Row, Unknowns};
use super::sparse::Shift;
use super::system::{Nodes, System};
use crate::assembly::PartIx;
use glam::DVec3;
use std::collections::BTreeMap;

/// What the sum of up to a hundred thousand products of numbers of size 1 is off at most, with room for the solves
/// that lead there: 1e5 units of round-off are 2.2e-11.
pub const ROUND_OFF: f64 = 1e-10;

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

fn undecided(why: impl Into<String>, size: f64) -> Verdict {
    Verdict::Undecided(Gap { why: why.into(), size })
}

/// Locked, free or undecided over these rows.
pub fn decide(rows: &[Row], unknowns: &Unknowns) -> Verdict {
    match unknowns.freedom {
        Freedom::Translation => Question::<3> { rows, unknowns }.decide(),
        Freedom::Rigid => Question::<6> { rows, unknowns }.decide(),
    }
}

/// All rows, W unknowns for each free part.
struct Question<'a, const W: usize> {
    rows: &'a [Row],
    unknowns: &'a Unknowns,
}

impl<const W: usize> Question<'_, W> {
    fn decide(&self) -> Verdict {
        if self.unknowns.count == 0 {
            return Verdict::Locked(Stress { forces: Vec::new(), rank: 0, residual: 0.0, pivot_ratio: 1.0 });
        }
        let mut chosen = kept(self.rows, self.unknowns);
        loop {
            let some: Vec<Row> = chosen.iter().map(|&k| turned(&self.rows[k])).collect();
            let system = System::<W>::new(&some, self.unknowns);
            let x = match search(&system) {
                Found::Stress(y) => match self.lock(&system, &chosen, &y) {
                    Lock::Proven(stress) => return Verdict::Locked(stress),
                    Lock::Slides(x) => x,
                    Lock::Neither(gap) => return Verdict::Undecided(gap),
                },
                Found::Motion(x) => x,
                Found::Neither(gap) => return Verdict::Undecided(gap),
            };
            let x: Vec<f64> = x.into_iter().flatten().collect();
            if let Some(motion) = self.motion(&x) {
                return Verdict::Free(motion);
            }
            let more = self.broken(&x);
            if more.iter().all(|k| chosen.contains(k)) {
                return undecided("a motion breaks no row by more than round-off, yet not none", ROUND_OFF);
            }
            chosen.extend(more);
            chosen.sort_unstable_by_key(|&k| (pair(&self.rows[k]), k));
            chosen.dedup();
        }
    }

    /// Forces in balance prove a lock if the rows have full rank; if not, something slides.
    fn lock(&self, system: &System<W>, chosen: &[usize], y: &[f64]) -> Lock<W> {
        let ones = vec![1.0; system.rows()];
        if system.factor(&ones, Shift::Proving).pinned.is_empty() {
            let pivot_ratio = system.factor(&ones, Shift::None).pivot_ratio;
            return self.stress(chosen, y, pivot_ratio);
        }
        let factor = system.factor(&ones, Shift::None);
        let unit = |&(node, c): &(usize, usize)| {
            let mut x = vec![[0.0; W]; system.nodes()];
            x[node][c] = 1.0;
            x
        };
        let slide = |at| keeps(system, polished(system, &ones, &unit(at))?);
        match factor.pinned.iter().take(MOST_SLIDES).find_map(slide) {
            Some(x) => Lock::Slides(x),
            None => Lock::Neither(Gap {
                why: "the rank of the rows can not be told from round-off".into(),
                size: factor.pivot_ratio,
            }),
        }
    }

    /// The forces scaled to at least 1, in the order of the rows, if they balance by the unknowns' own entries too.
    fn stress(&self, chosen: &[usize], y: &[f64], pivot_ratio: f64) -> Lock<W> {
        let least = y.iter().copied().fold(f64::INFINITY, f64::min);
        let force = |(&k, f): (&usize, &f64)| (k, Force { row: self.rows[k], size: (f / least).max(1.0) });
        let mut forces: Vec<(usize, Force)> = chosen.iter().zip(y).map(force).collect();
        forces.sort_unstable_by_key(|f| f.0);
        let forces: Vec<Force> = forces.into_iter().map(|f| f.1).collect();
        let residual = self.sum(&forces);
        let top = forces.iter().map(|f| f.size).fold(0.0, f64::max);
        if residual.is_nan() || residual > ROUND_OFF * top {
            let why = "the forces do not balance to round-off".into();
            return Lock::Neither(Gap { why, size: residual });
        }
        Lock::Proven(Stress { forces, rank: self.unknowns.count, residual, pivot_ratio })
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

/// Null directions tried for one that every row allows: the first is one unless the rank itself is in doubt.
const MOST_SLIDES: usize = 8;

enum Lock<const W: usize> {
    Proven(Stress),
    /// The rows lack rank: a motion along which all of them stay still.
    Slides(Nodes<W>),
    Neither(Gap),
}

fn twists(unknowns: &Unknowns, x: &[f64]) -> Vec<(PartIx, Twist)> {
    let of = |(part, column): (usize, &Option<usize>)| {
        let c = (*column)?;
        let translation = DVec3::from_slice(&x[c..]);
        let rotation = match unknowns.freedom {
            Freedom::Translation => DVec3::ZERO,
            Freedom::Rigid => DVec3::from_slice(&x[c + 3..]) / unknowns.lever[part],
        };
        let centre = unknowns.centre[part];
        Some((PartIx(part as u32), Twist { translation, rotation, centre }))
    };
    unknowns.column.iter().enumerate().filter_map(of).collect()
}
