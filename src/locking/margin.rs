//! Takes a lock or a motion and its rows; gives how far the rows may be wrong before the verdict falls.
//!
//! Sound: the lower bound is proven, with its rounding counted. Not tight: twists are measured in a box, which costs a
//! factor that grows with the number of parts that move together; the upper bound, from motions that were tried, says
//! by how much at most.
//!
//! A wrong row is one whose normal is turned, its point where it is. For a lock over the box |x_k| <= 1: if for every
//! unknown j and both signs there are forces y >= 0 with A^T y = -+e_j, then a motion x with x_j = +-1 has
//! sum y_i a_i x = -1; rows changed by at most mu w_i in the box could all be kept only if mu sum w_i y_i >= 1. So the
//! lock holds for mu below the least 1 / sum w_i y_i. (With w_i the relative speed at the contact: an angle in radians;
//! the least over all x is what grasping calls the Ferrari-Canny metric.)

use super::factor::Factor;
use super::many;
use super::reduce::kept;
use super::rows::{Freedom, Row, Unknowns};
use super::{Force, Motion, Stress};
use crate::assembly::PartIx;
use crate::contact::Slack;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT::NonnegativeConeT,
    SupportedConeT::ZeroConeT,
};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// More unknowns than this are not asked: the factor is dense. Nor where unknowns times rows that carry a force are more
/// than this: for every unknown all rows are summed.
const MOST_UNKNOWNS: usize = 1500;
const MOST_WORK: usize = 40_000_000;

/// How a bound is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// From the self-stress alone.
    Plain,
    /// Tightened by linear programs, for as many goals as their work allows: at most about a second.
    Programs,
}

/// Unknowns up to which programs are worth it.
const MOST_UNKNOWNS_OF_PROGRAMS: usize = 120;

/// Rows times unknowns squared over all programs: a program takes about twenty factorizations of that size. Not fewer than
/// [`LEAST_PROGRAMS`] are tried.
const MOST_WORK_OF_PROGRAMS: usize = 20_000_000;
const LEAST_PROGRAMS: usize = 16;

/// Programs that are solved side by side.
const BATCH: usize = 8;

/// Products of rows and parts up to which motions of single parts are tried for an upper bound.
const MOST_SINGLES: usize = 2_000_000;

const UNIT: f64 = f64::EPSILON / 2.0;

/// What a change of the rows costs: for each row the bound of its change over the unit box.
pub struct Weighted<'a> {
    pub rows: Vec<Row>,
    pub unknowns: &'a Unknowns,
    pub weights: Vec<f64>,
}

/// Bounds of the relative speed at each row's point over the unit box.
pub fn speeds(rows: &[Row], unknowns: &Unknowns) -> Vec<f64> {
    let one = |row: &Row| {
        let side = |part: PartIx| {
            if unknowns.column[part.at()].is_none() {
                return DVec3::ZERO;
            }
            let arm = (row.point - unknowns.centre[part.at()]).abs()
                * (turns(unknowns) / unknowns.lever[part.at()]);
            DVec3::new(1.0 + arm.y + arm.z, 1.0 + arm.z + arm.x, 1.0 + arm.x + arm.y)
        };
        (side(row.a) + side(row.b)).length() * (1.0 + 16.0 * UNIT)
    };
    rows.iter().map(one).collect()
}

/// Bounds of the relative rate of turning at each row over the unit box, radians for each unit of translation.
pub fn turnings(rows: &[Row], unknowns: &Unknowns) -> Vec<f64> {
    let side =
        |part: PartIx| f64::from(u8::from(unknowns.column[part.at()].is_some())) / unknowns.lever[part.at()];
    let root_3 = 3.0_f64.sqrt() * (1.0 + 4.0 * UNIT);
    let one = |row: &Row| (side(row.a) + side(row.b)) * root_3 * turns(unknowns);
    rows.iter().map(one).collect()
}

fn turns(unknowns: &Unknowns) -> f64 {
    f64::from(u8::from(unknowns.freedom == Freedom::Rigid))
}

/// What [`lock`] found.
pub struct Bound {
    /// Proven: the lock holds for all rows changed by less than this times their weights. Infinite without unknowns.
    pub lower: f64,
    /// Motions that nearly no row forbids.
    pub near: Vec<Vec<f64>>,
}

/// The bound for a lock; none where there are too many unknowns, or the rows that carry a force are nearly dependent.
pub fn lock(problem: &Weighted, stress: &Stress, effort: Effort) -> Option<Bound> {
    let n = problem.unknowns.count;
    if n == 0 {
        return Some(Bound { lower: f64::INFINITY, near: Vec::new() });
    }
    if n > MOST_UNKNOWNS || n * stress.forces.len() > MOST_WORK {
        return None;
    }
    let (some, size) = problem.carrying(&stress.forces)?;
    let factor = Factor::of(&some.rows, some.unknowns)?;
    let goals: Vec<Goal> = (0..n).flat_map(|column| [1.0, -1.0].map(|sign| Goal { column, sign })).collect();
    let bound = |goal: Goal| (some.bound(&least_norm(&some, &factor, &size, goal), goal), goal);
    let mut bounds: Vec<(f64, Goal)> = goals.into_par_iter().map(bound).collect();
    let mut near = vec![factor.weakest()];
    if effort == Effort::Programs && n <= MOST_UNKNOWNS_OF_PROGRAMS {
        let all = problem.outlined();
        let few = all.rows.len() * n * n * LEAST_PROGRAMS <= MOST_WORK_OF_PROGRAMS;
        tighten(if few { &all } else { &some }, &mut bounds, &mut near);
    }
    let lower = bounds.iter().map(|b| b.0).fold(f64::INFINITY, f64::min);
    Some(Bound { lower, near })
}

/// The bound of `many` as an angle for all normals, proven; none where it shows nothing or nothing can move.
pub fn of_many(stress: &Stress, unknowns: &Unknowns) -> Option<f64> {
    let turned = vec![Slack { angle: 1.0, distance: 0.0 }; stress.forces.len()];
    (unknowns.count > 0).then(|| many::survives(stress, &turned, unknowns)).filter(|angle| *angle > 0.0)
}

/// The angle by which every normal may be turned so that the rows allow one of these motions, one of a single part
/// along or about an axis, or the reverse of one: the least found. A row that is closed and does not move needs no turn.
pub fn shown(rows: &[Row], unknowns: &Unknowns, motions: &[Vec<f64>]) -> Option<f64> {
    let most =
        |x: &[f64], sign: f64| rows.iter().map(|row| needed(row, unknowns, x, sign)).fold(0.0, f64::max);
    let all = tried(rows, unknowns, motions);
    let all = all.iter().flat_map(|x| [1.0, -1.0].map(|sign| most(x, sign)));
    // Room for the rounding of the speeds.
    all.reduce(f64::min).map(|angle| angle * (1.0 + 1e-9))
}

/// By how much the row's normal must be turned so that it lets the motion, or its reverse, pass.
fn needed(row: &Row, unknowns: &Unknowns, x: &[f64], sign: f64) -> f64 {
    let into = -sign * unknowns.opening(row, x);
    if into > 0.0 { (into / velocity(row, unknowns, x).0.length()).min(1.0).asin() } else { 0.0 }
}

/// The motions, and those of a single part along or about an axis where there are not too many.
pub(super) fn tried(rows: &[Row], unknowns: &Unknowns, motions: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let singles = if rows.len() * unknowns.count <= 6 * MOST_SINGLES { unknowns.count } else { 0 };
    let single = |k: usize| (0..unknowns.count).map(|c| f64::from(u8::from(c == k))).collect::<Vec<f64>>();
    motions.iter().cloned().chain((0..singles).map(single)).collect()
}

/// Velocity of part b against part a at the row's point, and its rate of turning against it.
pub(super) fn velocity(row: &Row, unknowns: &Unknowns, x: &[f64]) -> (DVec3, DVec3) {
    let side = |part: PartIx| {
        let Some(c) = unknowns.column[part.at()] else { return (DVec3::ZERO, DVec3::ZERO) };
        let turn = match unknowns.freedom {
            Freedom::Translation => DVec3::ZERO,
            Freedom::Rigid => DVec3::from_slice(&x[c + 3..]) / unknowns.lever[part.at()],
        };
        (DVec3::from_slice(&x[c..]) + turn.cross(row.point - unknowns.centre[part.at()]), turn)
    };
    let ((v, w), (u, t)) = (side(row.b), side(row.a));
    (v - u, w - t)
}

/// The margin of a free verdict with this motion as its witness: the least angle between a contact's plane and the
/// velocity across it, where there is any; 0 where something slides.
pub fn motion(rows: &[Row], motion: &Motion) -> f64 {
    let twists: BTreeMap<PartIx, super::Twist> = motion.twists.iter().copied().collect();
    let at = velocity_of(&twists);
    let speed = rows.iter().flat_map(|r| [at(r.a, r.point), at(r.b, r.point)]);
    let speed = speed.map(DVec3::length).fold(0.0, f64::max);
    let angle = |row: &Row| {
        let v = at(row.b, row.point) - at(row.a, row.point);
        let moves = v.length() > OPENING_ROUND_OFF * speed;
        moves.then(|| (row.normal.dot(v) / v.length()).clamp(0.0, 1.0).asin() - OPENING_ROUND_OFF)
    };
    rows.iter().filter_map(angle).fold(std::f64::consts::FRAC_PI_2, f64::min).max(0.0)
}

/// Openings and speeds below this share of a motion's top speed are its round-off.
const OPENING_ROUND_OFF: f64 = 1e-9;

/// Whether the motion keeps every row whose normal may be turned and whose point may be elsewhere by these angles and
/// distances (none: by nothing).
pub fn opens(rows: &[Row], motion: &Motion, errors: &[(f64, f64)]) -> bool {
    let twists: BTreeMap<PartIx, super::Twist> = motion.twists.iter().copied().collect();
    let (v, w) = (velocity_of(&twists), |part: PartIx| twists.get(&part).map_or(DVec3::ZERO, |t| t.rotation));
    let speed = rows.iter().flat_map(|r| [v(r.a, r.point), v(r.b, r.point)]);
    let speed = speed.map(DVec3::length).fold(0.0, f64::max);
    rows.iter().enumerate().all(|(k, r)| {
        let (angle, distance) = errors.get(k).copied().unwrap_or((0.0, 0.0));
        let across = v(r.b, r.point) - v(r.a, r.point);
        let elsewhere = distance * (w(r.b) - w(r.a)).length();
        // What is at rest against its neighbour but for round-off stays so, however its normal is turned.
        let needed =
            (across.length() - OPENING_ROUND_OFF * speed).max(0.0) * angle + elsewhere * (1.0 + angle);
        r.normal.dot(across) >= needed - OPENING_ROUND_OFF * speed
    })
}

fn velocity_of(twists: &BTreeMap<PartIx, super::Twist>) -> impl Fn(PartIx, DVec3) -> DVec3 + '_ {
    |part, p| twists.get(&part).map_or(DVec3::ZERO, |t| t.translation + t.rotation.cross(p - t.centre))
}

/// Solves linear programs for the goals with the least bounds until the least has been solved for.
fn tighten(problem: &Weighted, bounds: &mut [(f64, Goal)], near: &mut Vec<Vec<f64>>) {
    let n = problem.unknowns.count;
    let affordable = MOST_WORK_OF_PROGRAMS / (problem.rows.len() * n * n).max(1);
    let mut left = affordable.max(LEAST_PROGRAMS);
    let mut done = vec![false; bounds.len()];
    while left > 0 {
        let mut order: Vec<usize> = (0..bounds.len()).collect();
        order.sort_by(|&i, &j| bounds[i].0.total_cmp(&bounds[j].0).then(i.cmp(&j)));
        if done[order[0]] {
            break;
        }
        let open = order.into_iter().filter(|&k| !done[k]).take(BATCH.min(left));
        let batch: Vec<usize> = open.collect();
        left -= batch.len();
        let found: Vec<_> = batch.par_iter().map(|&k| program(problem, bounds[k].1)).collect();
        for (k, found) in batch.into_iter().zip(found) {
            done[k] = true;
            if let Some((y, x)) = found {
                bounds[k].0 = bounds[k].0.max(problem.bound(&y, bounds[k].1));
                near.push(x);
            }
        }
    }
}

/// What forces are to add up to: A^T y = -sign e_column.
#[derive(Clone, Copy)]
struct Goal {
    column: usize,
    sign: f64,
}

impl Weighted<'_> {
    /// Without rows inside the outlines of those with one normal: they cost programs more than they bring.
    fn outlined(&self) -> Weighted<'_> {
        let at = kept(&self.rows, self.unknowns);
        let weights = at.iter().map(|&k| self.weights[k]).collect();
        Weighted { rows: at.into_iter().map(|k| self.rows[k]).collect(), weights, unknowns: self.unknowns }
    }

    /// The rows that carry a force, with the forces; none where one is not among the rows.
    fn carrying(&self, forces: &[Force]) -> Option<(Weighted<'_>, Vec<f64>)> {
        let bits =
            |r: &Row| (r.a, r.b, r.normal.to_array().map(f64::to_bits), r.point.to_array().map(f64::to_bits));
        let index: BTreeMap<_, usize> = self.rows.iter().enumerate().map(|(k, r)| (bits(r), k)).collect();
        let at: Vec<usize> =
            forces.iter().map(|f| index.get(&bits(&f.row)).copied()).collect::<Option<_>>()?;
        let rows = at.iter().map(|&k| self.rows[k]).collect();
        let weights = at.iter().map(|&k| self.weights[k]).collect();
        Some((Weighted { rows, weights, unknowns: self.unknowns }, forces.iter().map(|f| f.size).collect()))
    }

    /// Proven bound from forces that nearly meet the goal: what they miss, and the rounding of all sums, counts against
    /// them.
    fn bound(&self, forces: &[f64], goal: Goal) -> f64 {
        let (mut sum, mut sizes) = (vec![0.0; self.unknowns.count], 0.0);
        sum[goal.column] = goal.sign;
        let mut cost = 0.0;
        for ((row, &f), &w) in self.rows.iter().zip(forces).zip(&self.weights) {
            // Not "below 0": what is no number must not pass.
            if f.is_nan() || f <= 0.0 {
                continue;
            }
            cost += f * w;
            for (c, v) in self.unknowns.entries(row) {
                sum[c] += v * f;
                sizes += (v * f).abs();
            }
        }
        let steps = (self.rows.len() + 32) as f64 * UNIT;
        let miss = (sum.iter().map(|s| s.abs()).sum::<f64>() + sizes * steps) * (1.0 + 1e-8);
        let cost = cost * (1.0 + 2.0 * steps);
        if cost == 0.0 && miss < 1.0 {
            return f64::INFINITY;
        }
        let bound = (1.0 - miss) / cost * (1.0 - 1e-12);
        if bound > 0.0 { bound } else { 0.0 }
    }
}

/// The least forces that meet the goal, plus as much of the self-stress as makes all of them at least 0.
fn least_norm(problem: &Weighted, factor: &Factor, stress: &[f64], goal: Goal) -> Vec<f64> {
    let mut wanted = vec![0.0; problem.unknowns.count];
    wanted[goal.column] = -goal.sign;
    let x = factor.solve(&wanted);
    let y: Vec<f64> = problem.rows.iter().map(|row| problem.unknowns.opening(row, &x)).collect();
    let more = y.iter().zip(stress).map(|(f, s)| -f / s).fold(0.0, f64::max);
    y.iter().zip(stress).map(|(f, s)| f + more * s).collect()
}

/// The cheapest forces that meet the goal, and the motion that the solver shows beside them.
fn program(problem: &Weighted, goal: Goal) -> Option<(Vec<f64>, Vec<f64>)> {
    let (m, n) = (problem.rows.len(), problem.unknowns.count);
    let (mut starts, mut index, mut value) = (vec![0], Vec::new(), Vec::new());
    for (k, row) in problem.rows.iter().enumerate() {
        let mut entries: Vec<(usize, f64)> = problem.unknowns.entries(row).collect();
        entries.sort_unstable_by_key(|e| e.0);
        entries.push((n + k, -1.0));
        index.extend(entries.iter().map(|e| e.0));
        value.extend(entries.iter().map(|e| e.1));
        starts.push(index.len());
    }
    let matrix = CscMatrix::new(n + m, m, starts, index, value);
    let mut bounds = vec![0.0; n + m];
    bounds[goal.column] = -goal.sign;
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [ZeroConeT(n), NonnegativeConeT(m)];
    let none = CscMatrix::zeros((m, m));
    let mut solver = DefaultSolver::new(&none, &problem.weights, &matrix, &bounds, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    solved.then(|| (solver.solution.x.clone(), solver.solution.z[..n].to_vec()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::locking::Stress;

    /// A point between two opposite walls and four more: a square whose normals are those of the axes, translations.
    fn square() -> (Vec<Row>, Unknowns) {
        let row = |normal: DVec3| Row { a: PartIx(0), b: PartIx(1), normal, point: DVec3::ZERO };
        let rows = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z].map(row).to_vec();
        let unknowns = Unknowns {
            freedom: Freedom::Translation,
            column: vec![None, Some(0)],
            centre: vec![DVec3::ZERO; 2],
            lever: vec![1.0; 2],
            count: 3,
        };
        (rows, unknowns)
    }

    /// Six walls: a motion along a diagonal of space meets them all as flat as can be, at asin(1 / sqrt 3).
    #[test]
    fn the_margin_of_a_box_is_bracketed() {
        let (rows, unknowns) = square();
        let forces = rows.iter().map(|&row| Force { row, size: 1.0 }).collect();
        let stress = Stress { forces, rank: 3, residual: 0.0, pivot_ratio: 1.0 };
        let weights = speeds(&rows, &unknowns);
        let problem = Weighted { rows: rows.clone(), unknowns: &unknowns, weights };
        let found = lock(&problem, &stress, Effort::Programs).unwrap();
        let truth = (1.0 / 3.0_f64.sqrt()).asin();
        assert!(found.lower <= truth && found.lower > 0.9 / 3.0_f64.sqrt(), "{}", found.lower);
        let diagonal = vec![vec![1.0, 1.0, 1.0]];
        let upper = shown(&rows, &unknowns, &diagonal).unwrap();
        assert!((upper - truth).abs() < 1e-6, "{upper}");
    }
}
