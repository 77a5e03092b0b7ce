//! Takes a system A; gives forces y > 0 with A^T y = 0, or a motion x with A x >= 0, found by an interior point method.
//!
//! Of the two homogeneous systems s = A x >= 0 and A^T y = 0, y >= 0 the path followed leads to a solution where each
//! row has s > 0 or y > 0 (Goldman and Tucker): the rows that can open, and those that carry force. Floating point:
//! what comes back is judged by the caller. Not complete: numbers near a boundary give neither.

use super::decide::{Gap, ROUND_OFF};
use super::sparse::{Factor, Pins};
use super::system::{Nodes, System};

/// What was found for the rows of the system.
pub enum Found<const W: usize> {
    /// A positive force for each row; they balance up to round-off.
    Stress(Vec<f64>),
    /// Largest component 1; no row is below 0 by more than round-off.
    Motion(Nodes<W>),
    Neither(Gap),
}

/// Steps before it is given up: such methods end in 10 to 40 steps or stall.
const MOST_STEPS: usize = 80;

/// Share of the way to the boundary that a step goes.
const SHORT_OF_BOUNDARY: f64 = 0.98;

/// Forces are taken once none is lost to balance but for this share of itself, so that the largest stays comparable.
const LEFT_IN_BALANCE: f64 = 0.02;

/// A step shorter than this moves nothing: the numbers carry no more.
const STALLED: f64 = 1e-9;

/// Whether rows that all carry force have full rank: then nothing moves, else something slides.
pub enum Rank<const W: usize> {
    /// With the smallest pivot of the scaled Gram matrix over its largest.
    Full(f64),
    /// A motion that moves no row, by more than round-off.
    Lacks(Nodes<W>),
    Unknown(Gap),
}

/// Null directions tried for one that every row allows: the first is one unless the rank itself is in doubt.
const MOST_SLIDES: usize = 8;

/// Proves full rank or finds a motion along which every row stays still.
pub fn rank<const W: usize>(system: &System<W>) -> Rank<W> {
    let ones = vec![1.0; system.rows()];
    let proof = system.factor(&ones, Pins::Proof);
    if proof.pinned.is_empty() {
        return Rank::Full(proof.pivot_ratio);
    }
    let doubtful = system.factor(&ones, Pins::Doubtful(RANK_GUESSES[RANK_GUESSES.len() - 1])).pinned;
    let slides: Vec<Nodes<W>> = doubtful.iter().take(MOST_SLIDES).map(|&at| unit(system, at)).collect();
    let why = "the rank of the rows can not be told from round-off";
    let unknown = || Rank::Unknown(Gap { why: why.into(), size: proof.pivot_ratio });
    unmoved(system, &ones, &slides).map_or_else(unknown, Rank::Lacks)
}

fn unit<const W: usize>(system: &System<W>, (node, component): (usize, usize)) -> Nodes<W> {
    let mut x = vec![[0.0; W]; system.nodes()];
    x[node][component] = 1.0;
    x
}

/// Looks for forces on all rows or a motion.
pub fn search<const W: usize>(system: &System<W>) -> Found<W> {
    if system.rows() == 0 {
        return Found::Motion(unit(system, (0, 0)));
    }
    let mut path = Path::new(system.rows());
    let mut tried = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let aim = path.aim(system);
        if let Some(found) = aim.found(system, &path, &mut tried) {
            return found;
        }
        if path.step(system, &aim) < STALLED {
            break;
        }
    }
    Found::Neither(Gap {
        why: "neither forces nor a motion come clear of round-off".into(),
        size: path.gap(),
    })
}

/// A point near the path: s = A x + theta, A^T y = theta A^T 1, s and y positive.
struct Path {
    s: Vec<f64>,
    y: Vec<f64>,
    theta: f64,
}

/// Where the path leads if it were straight: forces y (1 - t), motion x with A x = s t, both in balance.
struct Aim<const W: usize> {
    factor: Factor<W>,
    weights: Vec<f64>,
    x: Nodes<W>,
    t: Vec<f64>,
    low: f64,
    high: f64,
}

impl Path {
    fn new(rows: usize) -> Path {
        Path { s: vec![1.0; rows], y: vec![1.0; rows], theta: 1.0 }
    }

    fn gap(&self) -> f64 {
        self.s.iter().zip(&self.y).map(|(s, y)| s * y).sum::<f64>() / self.s.len() as f64
    }

    fn aim<const W: usize>(&self, system: &System<W>) -> Aim<W> {
        let weights: Vec<f64> = self.y.iter().zip(&self.s).map(|(y, s)| y / s).collect();
        let factor = system.factor(&weights, Pins::RoundOff);
        let x = factor.solve(&system.pattern, &system.sums(&self.y));
        let t: Vec<f64> = system.openings(&x).iter().zip(&self.s).map(|(o, s)| o / s).collect();
        let low = t.iter().copied().fold(f64::INFINITY, f64::min);
        let high = t.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Aim { factor, weights, x, t, low, high }
    }

    /// One step towards the aim, bent back to the middle as far as the straight one fell short (Mehrotra 1992); gives
    /// its length.
    fn step<const W: usize>(&mut self, system: &System<W>, aim: &Aim<W>) -> f64 {
        let straight = 1.0_f64.min((1.0 - aim.low).recip()).min(aim.high.max(1.0).recip());
        let centre = (1.0 - straight).powi(3).max(1e-9);
        let (mu, rest) = (self.gap(), 1.0 - centre);
        // What s dy + y ds shall be, over s.
        let wanted: Vec<f64> = (0..self.s.len())
            .map(|k| centre * mu / self.s[k] - self.y[k] * (1.0 + aim.t[k] * (1.0 - aim.t[k])))
            .collect();
        let pull: Vec<f64> =
            (0..self.s.len()).map(|k| wanted[k] + rest * (self.y[k] + self.theta * aim.weights[k])).collect();
        let dx = aim.factor.solve(&system.pattern, &system.sums(&pull));
        let ds: Vec<f64> = system.openings(&dx).iter().map(|o| o - rest * self.theta).collect();
        let dy: Vec<f64> = (0..ds.len()).map(|k| wanted[k] - aim.weights[k] * ds[k]).collect();
        let far = |v: &[f64], d: &[f64]| v.iter().zip(d).map(|(v, d)| -d / v).fold(0.0, f64::max);
        let length = (SHORT_OF_BOUNDARY / far(&self.s, &ds).max(far(&self.y, &dy))).min(1.0);
        self.s.iter_mut().zip(&ds).for_each(|(s, d)| *s += length * d);
        self.y.iter_mut().zip(&dy).for_each(|(y, d)| *y += length * d);
        self.theta *= 1.0 - length * rest;
        if length.is_nan() { 0.0 } else { length }
    }
}

impl<const W: usize> Aim<W> {
    /// What the aim itself answers, if anything.
    fn found(&self, system: &System<W>, path: &Path, tried: &mut f64) -> Option<Found<W>> {
        if self.high < 1.0 - LEFT_IN_BALANCE {
            return self.stress(system, path).map(Found::Stress);
        }
        if self.low >= 0.0 {
            return keeps(system, self.x.clone()).map(Found::Motion);
        }
        // Rows that open have t near 1, those that carry force t near 0.
        let unclear = self.t.iter().map(|t| t.abs().min((t - 1.0).abs())).fold(0.0, f64::max);
        if unclear > UNCLEAR || unclear > *tried {
            return None;
        }
        *tried = unclear * UNCLEAR;
        let still: Vec<f64> = self.t.iter().map(|t| if *t < 0.5 { 1.0 } else { 0.0 }).collect();
        unmoved(system, &still, std::slice::from_ref(&self.x)).map(Found::Motion)
    }

    /// The forces y (1 - t), what round-off left of their sum taken away in proportion to the weights.
    fn stress(&self, system: &System<W>, path: &Path) -> Option<Vec<f64>> {
        let mut y: Vec<f64> = path.y.iter().zip(&self.t).map(|(y, t)| y * (1.0 - t)).collect();
        let mut share = 0.0;
        for _ in 0..2 {
            let x = self.factor.solve(&system.pattern, &system.sums(&y));
            let off = system.openings(&x);
            share = 0.0;
            for ((f, d), o) in y.iter_mut().zip(&self.weights).zip(&off) {
                share = f64::max(share, (d * o / *f).abs());
                *f -= d * o;
            }
        }
        let positive = y.iter().all(|f| *f > 0.0);
        (positive && share < LEFT_IN_BALANCE).then_some(y)
    }
}

/// How far from 0 or 1 a row's t may be when its side is guessed. A wrong guess is found out by the rows; the next one
/// waits until all are clearer by as much again.
const UNCLEAR: f64 = 0.1;

/// The first of the motions that keeps every row once it is cleared of what moves the rows of weight 1. Their rank is
/// a guess, so a few are tried; the rows decide.
fn unmoved<const W: usize>(system: &System<W>, still: &[f64], motions: &[Nodes<W>]) -> Option<Nodes<W>> {
    RANK_GUESSES.iter().find_map(|&times| {
        let factor = system.factor(still, Pins::Doubtful(times));
        motions.iter().find_map(|x| keeps(system, cleared(system, &factor, still, x)?))
    })
}

/// A pivot counts if it stands this many times above what round-off alone can leave of a well conditioned matrix: how
/// much more it leaves of this one is not known beforehand.
const RANK_GUESSES: [f64; 3] = [1.0, 1e2, 1e4];

/// The motion less its part that moves the rows of weight 1 (least squares), so that they stay still to round-off.
fn cleared<const W: usize>(
    system: &System<W>,
    factor: &Factor<W>,
    still: &[f64],
    x: &Nodes<W>,
) -> Option<Nodes<W>> {
    let before = largest(x);
    let mut x: Nodes<W> = x.iter().map(|v| v.map(|c| c / before)).collect();
    // The second and third round take away what the round-off of the one before left.
    for _ in 0..3 {
        let moved: Vec<f64> = system.openings(&x).iter().zip(still).map(|(o, w)| o * w).collect();
        let by = factor.solve(&system.pattern, &system.sums(&moved));
        x.iter_mut().zip(by).for_each(|(v, d)| (0..W).for_each(|k| v[k] -= d[k]));
    }
    // Less than a hundredth left: what was cleared away was the motion itself.
    (largest(&x) > 0.01).then_some(x)
}

/// The motion at size 1, if it keeps every row of the system.
fn keeps<const W: usize>(system: &System<W>, x: Nodes<W>) -> Option<Nodes<W>> {
    let size = largest(&x);
    let worst = system.openings(&x).into_iter().fold(0.0, f64::min);
    (size > 0.0 && worst >= -ROUND_OFF * size).then(|| x.iter().map(|v| v.map(|c| c / size)).collect())
}

pub fn largest<const W: usize>(x: &Nodes<W>) -> f64 {
    x.iter().flatten().map(|v| v.abs()).fold(0.0, f64::max)
}
