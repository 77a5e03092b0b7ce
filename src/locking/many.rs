//! Takes a lock of any number of parts and by how much its rows may be off; gives how many times that it survives.
//!
//! Sound: proven, with its rounding counted. Not tight: norms over all parts are summed; where parts are few `margin` gives
//! more. Cost: some sparse factors.
//!
//! B: the rows that carry a force, each times its force, unknowns scaled to columns of norm 1; 1 balances it but for
//! r = B^T 1. If its least singular value s is at least t times the Frobenius norm of its change and |B^T 1| stays below
//! what is left of s, then rank is full and forces 1 + e in exact balance exist with |e| < 1: the lock holds.

use super::Stress;
use super::interior::largest;
use super::reduce::{pair, turned};
use super::rows::{Freedom, Row, Unknowns};
use super::sparse::Pins;
use super::system::{Nodes, System};
use crate::assembly::PartIx;
use crate::contact::Slack;

/// Shares of the estimated least eigenvalue that are tried for a proof.
const SHARES: [f64; 4] = [0.9, 0.5, 0.1, 0.01];

/// Inverse iterations for the estimate: each gains a digit or so.
const STEPS: usize = 8;

/// The lock holds for all rows changed by less than this times their slack, one for each force; 0 where that is not shown.
pub fn survives(stress: &Stress, slack: &[Slack], unknowns: &Unknowns) -> f64 {
    match unknowns.freedom {
        Freedom::Translation => times::<3>(stress, slack, unknowns),
        Freedom::Rigid => times::<6>(stress, slack, unknowns),
    }
}

fn times<const W: usize>(stress: &Stress, slack: &[Slack], unknowns: &Unknowns) -> f64 {
    let mut all: Vec<(Row, f64, Slack)> =
        stress.forces.iter().zip(slack).map(|(f, s)| (turned(&f.row), f.size, *s)).collect();
    all.sort_by_key(|(r, ..)| pair(r));
    let rows: Vec<Row> = all.iter().map(|a| a.0).collect();
    let sizes: Vec<f64> = all.iter().map(|a| a.1).collect();
    let node = |p: PartIx| unknowns.column[p.at()].map(|c| c / W);
    let system = System::<W>::new(&rows, unknowns, unknowns.count / W, node);
    let squares: Vec<f64> = sizes.iter().map(|f| f * f).collect();
    let plain = system.factor(&squares, Pins::RoundOff);
    if !plain.pinned.is_empty() {
        return 0.0;
    }
    let guess = least_eigenvalue(&system, &plain);
    let proven = SHARES.iter().map(|share| share * guess);
    let Some(least) = proven.into_iter().find(|&l| system.factor(&squares, Pins::Above(l)).pinned.is_empty())
    else {
        return 0.0;
    };
    let top = |p: PartIx| node(p).map(|k| plain.scale()[k].iter().copied().fold(0.0, f64::max));
    let (mut frobenius, mut sums, mut misses) = (0.0, vec![0.0; system.nodes()], vec![0.0; system.nodes()]);
    for (row, size, slack) in &all {
        for p in [row.a, row.b] {
            let (Some(k), Some(top)) = (node(p), top(p)) else { continue };
            let arm = (row.point - unknowns.centre[p.at()]).length() / unknowns.lever[p.at()];
            let whole = (1.0 + arm * arm).sqrt();
            let change = top
                * size
                * (slack.angle * whole + slack.distance * (1.0 + slack.angle) / unknowns.lever[p.at()]);
            frobenius += change * change;
            sums[k] += change;
            misses[k] += top * size * whole;
        }
    }
    let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let missing =
        residual(&all, unknowns, plain.scale()) + norm(&misses) * (rows.len() + 64) as f64 * f64::EPSILON;
    // Room for the rounding of these sums, all of positive numbers.
    let left = (least.sqrt() - missing) * (1.0 - 1e-6);
    let cost = (frobenius.sqrt() + norm(&sums)) * (1.0 + 1e-6);
    if left > 0.0 { left / cost } else { 0.0 }
}

/// |B^T 1| in scaled unknowns.
fn residual<const W: usize>(all: &[(Row, f64, Slack)], unknowns: &Unknowns, scale: &[[f64; W]]) -> f64 {
    let mut sum = vec![0.0; unknowns.count];
    for (row, size, _) in all {
        unknowns.entries(row).for_each(|(c, v)| sum[c] += v * size);
    }
    let scaled = sum.iter().enumerate().map(|(c, v)| v * scale[c / W][c % W]);
    scaled.map(|v| v * v).sum::<f64>().sqrt()
}

/// About the least eigenvalue of the scaled matrix, by inverse iteration: a guess, proven by the caller.
fn least_eigenvalue<const W: usize>(system: &System<W>, factor: &super::sparse::Factor<W>) -> f64 {
    let unscaled = |x: &Nodes<W>, power: i32| -> Nodes<W> {
        let of = |(v, s): (&[f64; W], &[f64; W])| std::array::from_fn(|c| v[c] * s[c].powi(power));
        x.iter().zip(factor.scale()).map(of).collect()
    };
    let mut x: Nodes<W> = (0..system.nodes())
        .map(|k| std::array::from_fn(|c| 1.0 + ((W * k + c) * 7 % 11) as f64 / 13.0 - ((k + c) % 3) as f64))
        .collect();
    let mut grown = 1.0;
    for _ in 0..STEPS {
        // (S G S)^-1 x = S^-1 G^-1 S^-1 x.
        x = unscaled(&factor.solve(&system.pattern, &unscaled(&x, -1)), -1);
        grown = largest(&x);
        x.iter_mut().flatten().for_each(|v| *v /= grown);
    }
    grown.recip()
}
