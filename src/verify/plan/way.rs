//! Takes a moving and a still convex cell and a straight way, gives a bound on the largest ball that fits into both at
//! once at any time: no sampling, so nothing tunnels.
//!
//! Sound: the bound comes from multipliers that are added up, never from a search that stopped. A radius below zero
//! says how far the faces could still move outward before the cells meet, so the cells keep at least twice that.

use super::lp::{Bound, Row, maximize_last};
use crate::solid::Cell;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use glam::DVec3;

/// A straight way: unit direction and length in model units.
#[derive(Clone, Copy, Debug)]
pub struct Way {
    pub direction: DVec3,
    pub length: f64,
}

/// The largest ball in both cells along the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Upper bound on the radius, model units; negative: a gap (see above).
    pub radius: f64,
    /// Where along the way, model units.
    pub at: f64,
}

/// The faces alone: the least overlap, halved, over the faces of both cells. Cheap, and enough for most pairs.
pub fn by_faces(moving: &Cell, still: &Cell, way: Way) -> f64 {
    let least = |c: &Cell, n: DVec3| c.vertices.iter().map(|v| n.dot(*v)).fold(f64::INFINITY, f64::min);
    let run = |n: DVec3| n.dot(way.direction) * way.length;
    let of_still = still.planes.iter().map(|&(n, b)| b - least(moving, n) - run(n).min(0.0));
    let of_moving = moving.planes.iter().map(|&(n, b)| b + run(n).max(0.0) - least(still, n));
    of_still.chain(of_moving).fold(f64::INFINITY, f64::min) / 2.0
}

/// The exact program. None when it could not be solved, which is no verdict.
pub fn by_program(moving: &Cell, still: &Cell, way: Way) -> Option<Ball> {
    solved(moving, still, way).map(|(ball, _)| ball)
}

/// Two cells where they stand: the largest ball in both, and a plane between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parting {
    /// Upper bound, model units.
    pub radius: f64,
    /// Unit normal, from `b` to `a`: across it the cells overlap by little where the ball is small.
    pub normal: DVec3,
}

/// None where no program was solved.
pub fn parting(a: &Cell, b: &Cell) -> Option<Parting> {
    let (ball, normal) = solved(a, b, Way { direction: DVec3::Z, length: 0.0 })?;
    Some(Parting { radius: ball.radius, normal: normal.try_normalize()? })
}

/// The ball, and what the faces of `still` push with in the bound: outward, toward `moving`.
fn solved(moving: &Cell, still: &Cell, way: Way) -> Option<(Ball, DVec3)> {
    let corners = || moving.vertices.iter().chain(&still.vertices);
    let lo =
        corners().fold(DVec3::INFINITY, |m, v| m.min(*v)).min(DVec3::ZERO + corner_of(way, moving, false));
    let hi = corners().fold(DVec3::NEG_INFINITY, |m, v| m.max(*v)).max(corner_of(way, moving, true));
    let centre = (lo + hi) / 2.0;
    // Room for the centre of a ball of negative radius, whose faces meet outside the cells.
    let room = 2.0 * (hi - lo).length() + way.length;
    let rows = rows(moving, still, way, centre, room);
    let start = [rows.len() - 5, rows.len() - 4, rows.len() - 3, rows.len() - 2, rows.len() - 1];
    let Bound { bound, at, rests_on, weights } = maximize_last(&rows, start, 8.0 * room)?;
    let of_still = moving.planes.len()..moving.planes.len() + still.planes.len();
    let push = |(k, w): (&usize, f64)| {
        if of_still.contains(k) { still.planes[k - of_still.start].0 * w } else { DVec3::ZERO }
    };
    let normal = rests_on.iter().zip(weights).map(push).sum();
    // Resting on the artificial walls, a negative radius would be too low.
    let walled = rests_on.iter().any(|&k| k >= rows.len() - 5 && k != rows.len() - 2);
    Some((Ball { radius: if walled { bound.max(0.0) } else { bound }, at: at[3] }, normal))
}

/// How near two cells come on the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    pub distance: f64,
    /// From the still cell to the moving one.
    pub apart: DVec3,
    /// Where along the way, model units.
    pub at: f64,
}

/// The least distance between the cells on the way, by a quadratic program over a point of each and the time (interior
/// point, about 1e-7 of the sizes). None when it was not solved.
pub fn gap(moving: &Cell, still: &Cell, way: Way) -> Option<Gap> {
    let d = way.direction;
    // Half the squared length of p + t d - q, over (p, q, t).
    let to_gap: [DVec3; 7] = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z, d];
    let upper = |i: usize, j: usize| if i <= j { to_gap[i].dot(to_gap[j]) } else { 0.0 };
    let quadratic: Vec<[f64; 7]> = (0..7).map(|i| std::array::from_fn(|j| upper(i, j))).collect();
    let side = |c: &Cell, at: usize| -> Vec<([f64; 7], f64)> {
        let row = |n: DVec3| std::array::from_fn(|k| if k / 3 == at && k < 6 { n[k % 3] } else { 0.0 });
        c.planes.iter().map(|&(n, b)| (row(n), b)).collect()
    };
    let time = |sign: f64| std::array::from_fn(|k| if k == 6 { sign } else { 0.0 });
    let mut rows = side(moving, 0);
    rows.extend(side(still, 1));
    rows.extend([(time(1.0), way.length), (time(-1.0), 0.0)]);
    let (a, b): (Vec<[f64; 7]>, Vec<f64>) = rows.into_iter().unzip();
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(b.len())];
    let (p, a) = (CscMatrix::from(&quadratic), CscMatrix::from(&a));
    let mut solver = DefaultSolver::new(&p, &[0.0; 7], &a, &b, &cones, settings).ok()?;
    solver.solve();
    let x = &solver.solution.x;
    let apart: DVec3 = to_gap.iter().zip(x).map(|(&g, &x)| g * x).sum();
    (solver.solution.status == SolverStatus::Solved).then_some(Gap {
        distance: apart.length(),
        apart,
        at: x[6],
    })
}

fn corner_of(way: Way, moving: &Cell, high: bool) -> DVec3 {
    let ends = moving.vertices.iter().map(|&v| v + way.direction * way.length);
    if high { ends.fold(DVec3::NEG_INFINITY, DVec3::max) } else { ends.fold(DVec3::INFINITY, DVec3::min) }
}

/// Faces of both cells moved inward by the radius, the time's two ends, and the walls that make the start a vertex.
fn rows(moving: &Cell, still: &Cell, way: Way, centre: DVec3, room: f64) -> Vec<Row> {
    let of_moving =
        moving.planes.iter().map(|&(n, b)| ([n.x, n.y, n.z, -n.dot(way.direction), 1.0], b - n.dot(centre)));
    let of_still = still.planes.iter().map(|&(n, b)| ([n.x, n.y, n.z, 0.0, 1.0], b - n.dot(centre)));
    let mut rows: Vec<Row> = of_moving.chain(of_still).collect();
    rows.push(([0.0, 0.0, 0.0, 1.0, 0.0], way.length));
    for k in 0..3 {
        rows.push((std::array::from_fn(|i| if i == k { -1.0 } else { 0.0 }), room));
    }
    rows.push(([0.0, 0.0, 0.0, -1.0, 0.0], 0.0));
    rows.push(([0.0, 0.0, 0.0, 0.0, -1.0], 8.0 * room));
    rows
}
