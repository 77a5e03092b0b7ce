//! Takes rows that the path of `decide` left undecided; gives the verdict by a conic solver and dense pivoted factors.
//!
//! Slower (cubic in the unknowns), and better where rows are nearly dependent: pivots are chosen by size, and nearly
//! unmoved rows are told from open ones by several guesses. Sound up to [`ROUND_OFF`]; not complete (undecided).

use super::decide::{
    BALANCED, Force, Gap, MOST_ROUNDS, Motion, ROUND_OFF, Stress, Verdict, twists, undecided,
};
use super::dense::{Cholesky, pivot_round_off};
use super::rows::{Freedom, Row, Unknowns};
use super::solve::{Candidate, candidate, widest};
use crate::assembly::PartIx;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Unknowns up to which it is tried: a dense factor of a thousand takes a third of 1e9 steps, about a second.
pub const MOST_UNKNOWNS: usize = 1000;

/// Openings below this share of the largest count as zero when a motion is polished: guesses, tried in turn. A wrong
/// one is found out, since the polished motion is tested on every row.
const KEPT: [f64; 5] = [1e-6, 1e-5, 1e-7, 1e-4, 1e-8];

/// Locked, free or undecided over these rows.
pub fn decide(rows: &[Row], unknowns: &Unknowns) -> Verdict {
    let mut chosen = first_rows(rows, unknowns);
    loop {
        let some: Vec<Row> = chosen.iter().map(|&k| rows[k]).collect();
        let motion = match candidate(&some, unknowns) {
            Candidate::Motion(x) => widest(&some, unknowns).unwrap_or(x),
            Candidate::Stress(y) => match balance(&some, unknowns, y) {
                Balanced::Stress(stress) => return Verdict::Locked(stress),
                Balanced::Null(x) => x,
                Balanced::Neither(gap) => return Verdict::Undecided(gap),
            },
            Candidate::Neither(_) if some.is_empty() => axis(unknowns),
            Candidate::Neither(why) => return undecided(format!("the solver stopped: {why}"), f64::NAN),
        };
        let size = chosen.len();
        for sign in [1.0, -1.0] {
            let x: Vec<f64> = motion.iter().map(|v| v * sign).collect();
            if let Some(motion) = KEPT.iter().find_map(|&kept| polished(rows, unknowns, &x, kept)) {
                return Verdict::Free(motion);
            }
            chosen.extend(broken(rows, unknowns, &x));
        }
        if chosen.len() == size {
            return undecided("a motion breaks no row by more than round-off, yet not none", ROUND_OFF);
        }
    }
}

/// Where nothing touches, anything moves.
fn axis(unknowns: &Unknowns) -> Vec<f64> {
    (0..unknowns.count).map(|k| if k == 0 { 1.0 } else { 0.0 }).collect()
}

/// For each pair of parts the rows that lie farthest along the axes of force and moment and their diagonals: a first
/// guess at the extreme rays of the pair's wrench cone.
fn first_rows(rows: &[Row], unknowns: &Unknowns) -> BTreeSet<usize> {
    let mut pairs: BTreeMap<(PartIx, PartIx), Vec<usize>> = BTreeMap::new();
    for (k, row) in rows.iter().enumerate() {
        pairs.entry((row.a, row.b)).or_default().push(k);
    }
    let mut chosen = BTreeSet::new();
    for of_pair in pairs.values() {
        let middle = of_pair.iter().map(|&k| rows[k].point).sum::<DVec3>() / of_pair.len() as f64;
        let wrench = |k: usize| (rows[k].normal, (rows[k].point - middle).cross(rows[k].normal));
        for (f, m) in probes(unknowns.freedom) {
            let along = |k: usize| {
                let (n, t) = wrench(k);
                f.dot(n) + m.dot(t)
            };
            chosen.extend(
                of_pair.iter().copied().max_by(|&i, &j| along(i).total_cmp(&along(j)).then(j.cmp(&i))),
            );
        }
    }
    chosen
}

fn probes(freedom: Freedom) -> Vec<(DVec3, DVec3)> {
    let signs =
        (0..27).map(|k| DVec3::new(f64::from(k % 3 - 1), f64::from(k / 3 % 3 - 1), f64::from(k / 9 - 1)));
    let dirs: Vec<DVec3> = signs.filter(|d| *d != DVec3::ZERO).collect();
    let forces = dirs.iter().map(|&d| (d, DVec3::ZERO));
    match freedom {
        Freedom::Translation => forces.collect(),
        Freedom::Rigid => forces.chain(dirs.iter().map(|&d| (DVec3::ZERO, d))).collect(),
    }
}

/// The row that the motion breaks most, for each pair of parts.
fn broken(rows: &[Row], unknowns: &Unknowns, x: &[f64]) -> Vec<usize> {
    let mut worst: BTreeMap<(PartIx, PartIx), (f64, usize)> = BTreeMap::new();
    let size = largest(x);
    for (k, row) in rows.iter().enumerate() {
        let opening = unknowns.opening(row, x) / size;
        if opening < -ROUND_OFF {
            let entry = worst.entry((row.a, row.b)).or_insert((opening, k));
            if opening < entry.0 {
                *entry = (opening, k);
            }
        }
    }
    worst.into_values().map(|w| w.1).collect()
}

fn largest(x: &[f64]) -> f64 {
    x.iter().map(|v| v.abs()).fold(0.0, f64::max)
}

/// The Gram matrix A^T A of some rows.
fn gram(rows: &[Row], unknowns: &Unknowns) -> Vec<f64> {
    let n = unknowns.count;
    let mut g = vec![0.0; n * n];
    for row in rows {
        let entries: Vec<(usize, f64)> = unknowns.entries(row).collect();
        for &(i, v) in &entries {
            for &(j, w) in &entries {
                g[i * n + j] += v * w;
            }
        }
    }
    g
}

fn factor(rows: &[Row], unknowns: &Unknowns) -> Cholesky {
    let n = unknowns.count;
    let g = gram(rows, unknowns);
    let top = (0..n).map(|k| g[k * n + k]).fold(0.0, f64::max);
    Cholesky::new(g, n, top * pivot_round_off(rows.len(), n))
}

/// A^T y.
fn sum(rows: &[Row], unknowns: &Unknowns, y: &[f64]) -> Vec<f64> {
    let mut r = vec![0.0; unknowns.count];
    for (row, f) in rows.iter().zip(y) {
        for (c, v) in unknowns.entries(row) {
            r[c] += v * f;
        }
    }
    r
}

/// The largest share of what acts along an unknown that the forces miss of balance.
fn unbalanced(rows: &[Row], unknowns: &Unknowns, y: &[f64]) -> f64 {
    let mut acting = vec![0.0; unknowns.count];
    for (row, f) in rows.iter().zip(y) {
        unknowns.entries(row).for_each(|(c, v)| acting[c] += (v * f).abs());
    }
    let share = |(m, a): (f64, f64)| if m == 0.0 { 0.0 } else { m.abs() / a };
    sum(rows, unknowns, y).into_iter().zip(acting).map(share).fold(0.0, f64::max)
}

enum Balanced {
    Stress(Stress),
    Null(Vec<f64>),
    Neither(Gap),
}

/// Projects the forces onto those in balance, y - A (A^T A)^-1 A^T y, and says whether they stay positive; a rank that
/// is not full gives a null motion instead.
fn balance(rows: &[Row], unknowns: &Unknowns, mut y: Vec<f64>) -> Balanced {
    let factor = factor(rows, unknowns);
    if let Some(x) = factor.null() {
        return Balanced::Null(x);
    }
    // The second round takes away what the first one's own round-off left; more only where that still shows.
    for round in 0..MOST_ROUNDS {
        if round >= 2 && unbalanced(rows, unknowns, &y) <= BALANCED {
            break;
        }
        let x = factor.solve(&sum(rows, unknowns, &y));
        for (f, row) in y.iter_mut().zip(rows) {
            *f -= unknowns.opening(row, &x);
        }
    }
    let least = y.iter().copied().fold(f64::INFINITY, f64::min);
    if least.is_nan() || least <= 0.0 {
        return Balanced::Neither(Gap {
            why: "the forces found do not stay positive in balance".into(),
            size: least,
        });
    }
    let y: Vec<f64> = y.iter().map(|f| (f / least).max(1.0)).collect();
    let residual = largest(&sum(rows, unknowns, &y));
    let top = largest(&y);
    if residual > ROUND_OFF * top {
        return Balanced::Neither(Gap {
            why: "the forces do not balance to round-off".into(),
            size: residual,
        });
    }
    let forces = rows.iter().zip(&y).map(|(&row, &size)| Force { row, size }).collect();
    Balanced::Stress(Stress { forces, rank: factor.rank, residual, pivot_ratio: factor.pivot_ratio })
}

/// The motion with its nearly unmoved rows brought to exactly zero (to round-off), if it then keeps every row.
fn polished(rows: &[Row], unknowns: &Unknowns, x: &[f64], kept: f64) -> Option<Motion> {
    let size = largest(x);
    let mut x: Vec<f64> = x.iter().map(|v| v / size).collect();
    let top = rows.iter().map(|r| unknowns.opening(r, &x).abs()).fold(0.0, f64::max);
    let still: Vec<Row> =
        rows.iter().filter(|r| unknowns.opening(r, &x).abs() <= kept * top.max(kept)).copied().collect();
    if !still.is_empty() {
        let factor = factor(&still, unknowns);
        for _ in 0..3 {
            let openings: Vec<f64> = still.iter().map(|r| unknowns.opening(r, &x)).collect();
            let by = factor.solve(&sum(&still, unknowns, &openings));
            x.iter_mut().zip(by).for_each(|(v, d)| *v -= d);
        }
    }
    let size = largest(&x);
    // Less than half left: what was polished away was the motion itself.
    if size < 0.5 {
        return None;
    }
    x.iter_mut().for_each(|v| *v /= size);
    let openings = || rows.iter().map(|r| unknowns.opening(r, &x));
    let worst = openings().fold(0.0, f64::min);
    let opening = openings().fold(0.0, f64::max);
    let opening = if opening > ROUND_OFF { opening } else { 0.0 };
    (worst >= -ROUND_OFF).then(|| Motion { twists: twists(unknowns, &x), opening, worst: -worst })
}
