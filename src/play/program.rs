//! Takes contact rows with air in each, and a linear goal; gives the farthest that the goal gets, to first order.
//!
//! Works on few rows at a time and adds those that the optimum breaks, so that the answer is one over all rows. Right
//! to [`SOLVED_TO`] of the air; `bound` comes from the multipliers and bounds the optimum from above.

use crate::assembly::PartIx;
use crate::locking::{Row, Unknowns};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use std::collections::{BTreeMap, BTreeSet};

/// How far a row may be beyond its air and still count as kept, as a share of the air: what the solver promises of its
/// answers (1e-8), with room for rows of some size.
pub const SOLVED_TO: f64 = 1e-6;

/// Rows of one pair of parts that join at once. Any number is right; few keep the programs small.
const JOIN: usize = 6;

/// Rounds of adding rows. Each adds rows that were not there, so it ends by itself; this bounds the work.
const MOST_ROUNDS: usize = 200;

pub(super) enum Farthest {
    /// `goal . x = value`, and nothing gets beyond `bound`; both for one unit of air in every contact.
    Reached {
        x: Vec<f64>,
        value: f64,
        bound: f64,
    },
    /// x can grow without end: the rows do not hold it.
    Endless {
        x: Vec<f64>,
    },
    Unsolved {
        why: String,
    },
}

/// All rows, and those that programs are made of so far (they serve the next goal too).
pub(super) struct Program<'a> {
    rows: &'a [Row],
    unknowns: &'a Unknowns,
    chosen: BTreeSet<usize>,
}

impl<'a> Program<'a> {
    pub(super) fn new(rows: &'a [Row], unknowns: &'a Unknowns) -> Program<'a> {
        let movable = |r: &Row| [r.a, r.b].iter().any(|p| unknowns.column[p.at()].is_some());
        let all = rows.iter().enumerate().filter(|(_, r)| movable(r));
        let mut farthest: BTreeMap<(PartIx, PartIx, usize), (f64, usize)> = BTreeMap::new();
        for (k, row) in all {
            let arm = (row.point - unknowns.centre[row.a.at()]).cross(row.normal);
            let six = [row.normal.to_array(), arm.to_array()].concat();
            for (axis, v) in six.iter().flat_map(|v| [*v, -*v]).enumerate() {
                let best = farthest.entry((row.a, row.b, axis)).or_insert((v, k));
                if v > best.0 {
                    *best = (v, k);
                }
            }
        }
        Program { rows, unknowns, chosen: farthest.into_values().map(|(_, k)| k).collect() }
    }

    /// The most of one unknown, or of its negative.
    pub(super) fn farthest(&mut self, column: usize, sign: f64) -> Farthest {
        for _ in 0..MOST_ROUNDS {
            let found = self.solve(column, sign);
            let (x, keep) = match &found {
                Farthest::Reached { x, .. } => (x, -1.0 - SOLVED_TO),
                Farthest::Endless { x } => (x, -SOLVED_TO),
                Farthest::Unsolved { .. } => return found,
            };
            let broken = self.broken(x, keep);
            if broken.is_empty() {
                return found;
            }
            self.chosen.extend(broken);
        }
        Farthest::Unsolved { why: format!("rows were still broken after {MOST_ROUNDS} rounds") }
    }

    /// Of each pair of parts the rows farthest below `keep`, those chosen already left out.
    fn broken(&self, x: &[f64], keep: f64) -> Vec<usize> {
        let mut worst: BTreeMap<(PartIx, PartIx), Vec<(f64, usize)>> = BTreeMap::new();
        for (k, row) in self.rows.iter().enumerate() {
            let opening = self.unknowns.opening(row, x);
            if opening < keep && !self.chosen.contains(&k) {
                worst.entry((row.a, row.b)).or_default().push((opening, k));
            }
        }
        let few = |mut rows: Vec<(f64, usize)>| {
            rows.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            rows.into_iter().take(JOIN).map(|r| r.1)
        };
        worst.into_values().flat_map(few).collect()
    }

    fn solve(&self, column: usize, sign: f64) -> Farthest {
        let n = self.unknowns.count;
        let (mut at, mut across, mut value) = (Vec::new(), Vec::new(), Vec::new());
        for (i, &k) in self.chosen.iter().enumerate() {
            for (c, v) in self.unknowns.entries(&self.rows[k]) {
                at.push(i);
                across.push(c);
                value.push(-v);
            }
        }
        let matrix = CscMatrix::new_from_triplets(self.chosen.len(), n, at, across, value);
        let mut goal = vec![0.0; n];
        goal[column] = -sign;
        let air = vec![1.0; self.chosen.len()];
        let cones = [NonnegativeConeT(self.chosen.len())];
        let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
        let none = CscMatrix::zeros((n, n));
        let Ok(mut solver) = DefaultSolver::new(&none, &goal, &matrix, &air, &cones, settings) else {
            return Farthest::Unsolved { why: "the solver refused the program".into() };
        };
        solver.solve();
        let s = &solver.solution;
        match s.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => {
                let bound = s.z.iter().sum();
                Farthest::Reached { x: s.x.clone(), value: sign * s.x[column], bound }
            }
            SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible => {
                let most = s.x.iter().fold(0.0f64, |m, v| m.max(v.abs()));
                Farthest::Endless { x: s.x.iter().map(|v| v / most).collect() }
            }
            other => Farthest::Unsolved { why: format!("the solver ended with {other:?}") },
        }
    }
}
