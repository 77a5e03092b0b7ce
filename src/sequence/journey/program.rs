//! Takes a wished motion of the parts of a set and the gaps between them, gives the nearest motion that closes no gap
//! further than it may, to first order.
//!
//! A quadratic program (interior point, clarabel): least |x - wish|^2 with n . (v_b(p) - v_a(p)) >= -gap for each row and
//! |x| <= step for each unknown. Not promised: anything beyond first order; the caller moves and looks again.

use super::bodies::{Bodies, Body, Owner, Poses, between};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use glam::{DAffine3, DMat3, DVec3};

/// Velocity of a part about its centre: shift, and turn in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    pub shift: DVec3,
    pub turn: DVec3,
}

/// A corner of one part at a height over a plane of another.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub a: usize,
    pub b: usize,
    /// Unit, from a to b.
    pub normal: DVec3,
    pub point: DVec3,
    pub gap: f64,
}

/// Rows of a program before the set counts as too large for this search: about 50 ms for each solve.
pub const MOST_ROWS: usize = 6000;

/// The rows of all pairs of parts within `reach` of each other, and the deepest overlap (0: none).
pub fn rows(bodies: &Bodies, poses: &Poses, reach: f64, touch: f64) -> (Vec<Row>, f64) {
    let placed: Vec<Vec<Body>> = poses.iter().enumerate().map(|(k, pose)| bodies.placed(k, pose)).collect();
    let (mut rows, mut deepest) = (Vec::new(), 0.0f64);
    for a in 0..poses.len() {
        for b in a + 1..poses.len() {
            if bodies.fixed[a] && bodies.fixed[b] {
                continue;
            }
            for x in &placed[a] {
                let near = |y: &&Body| x.centre.distance(y.centre) <= x.radius + y.radius + reach;
                for y in placed[b].iter().filter(near) {
                    let plane = between(x, y, touch);
                    if plane.gap <= reach {
                        deepest = deepest.max(-plane.gap);
                        over(&mut rows, (a, x), (b, y), (plane.normal, plane.owner), reach);
                    }
                }
            }
        }
    }
    (rows, deepest)
}

/// The corners within reach of the plane, seen from the cell that it is fixed to.
fn over(
    rows: &mut Vec<Row>,
    (a, x): (usize, &Body),
    (b, y): (usize, &Body),
    (normal, owner): (DVec3, Owner),
    reach: f64,
) {
    let (own, other, sign) = match owner {
        Owner::First => (x, y, 1.0),
        Owner::Second => (y, x, -1.0),
    };
    let outward = normal * sign;
    let base = outward.dot(own.far(outward));
    for &point in &other.vertices {
        let gap = outward.dot(point) - base;
        if gap <= reach {
            rows.push(Row { a, b, normal, point, gap });
        }
    }
}

/// The nearest allowed motion; None where the program was not solved. `step` bounds each shift, and each turn times the
/// part's lever, in model units. `room`: how much of each gap may be used, given the gap.
pub fn nearest(
    bodies: &Bodies,
    poses: &Poses,
    rows: &[Row],
    wish: &[Twist],
    step: f64,
    room: impl Fn(f64) -> f64,
) -> Option<Vec<Twist>> {
    let mut column = vec![None; poses.len()];
    let mut count = 0;
    for k in bodies.movable() {
        column[k] = Some(count);
        count += 6;
    }
    let centre = |k: usize| poses[k].transform_point3(bodies.centre[k]);
    let (mut is, mut js, mut vs, mut limits) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (i, r) in rows.iter().enumerate() {
        for (k, sign) in [(r.a, 1.0), (r.b, -1.0)] {
            let Some(c) = column[k] else { continue };
            let moment = (r.point - centre(k)).cross(r.normal) / bodies.lever[k];
            for (d, v) in r.normal.to_array().into_iter().chain(moment.to_array()).enumerate() {
                is.push(i);
                js.push(c + d);
                vs.push(sign * v);
            }
        }
        limits.push(room(r.gap));
    }
    for c in 0..count {
        for sign in [1.0, -1.0] {
            is.push(limits.len());
            js.push(c);
            vs.push(sign);
            limits.push(step);
        }
    }
    let mut cost = vec![0.0; count];
    for (k, c) in column.iter().enumerate().filter_map(|(k, c)| c.map(|c| (k, c))) {
        let turn = wish[k].turn * bodies.lever[k];
        let own = wish[k].shift.to_array().into_iter().chain(turn.to_array());
        own.enumerate().for_each(|(d, v)| cost[c + d] = -v / step);
    }
    // In units of the step, so that the solver's absolute tolerances mean the same at every size.
    limits.iter_mut().for_each(|l| *l /= step);
    let matrix = CscMatrix::new_from_triplets(limits.len(), count, is, js, vs);
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(limits.len())];
    let mut solver =
        DefaultSolver::new(&CscMatrix::identity(count), &cost, &matrix, &limits, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    let x = &solver.solution.x;
    let twist = |(k, c): (usize, &Option<usize>)| {
        let Some(c) = *c else { return Twist::default() };
        let own = |at: usize| DVec3::new(x[c + at], x[c + at + 1], x[c + at + 2]) * step;
        Twist { shift: still(own(0), step), turn: still(own(3), step) / bodies.lever[k] }
    };
    solved.then(|| column.iter().enumerate().map(twist).collect())
}

/// What is within the solver's tolerance (1e-8 of the step) of nothing is nothing.
fn still(v: DVec3, step: f64) -> DVec3 {
    const SOLVER_SHARE: f64 = 1e-7;
    if v.abs().max_element() <= SOLVER_SHARE * step { DVec3::ZERO } else { v }
}

/// The poses after a motion: each part along the screw that its twist begins.
pub fn moved(bodies: &Bodies, poses: &Poses, twists: &[Twist]) -> Poses {
    let go = |(k, (pose, t)): (usize, (&DAffine3, &Twist))| {
        let centre = pose.transform_point3(bodies.centre[k]);
        screw(centre, t) * *pose
    };
    poses.iter().zip(twists).enumerate().map(go).collect()
}

fn screw(centre: DVec3, t: &Twist) -> DAffine3 {
    let angle = t.turn.length();
    let Some(axis) = t.turn.try_normalize() else { return DAffine3::from_translation(t.shift) };
    let through = centre + t.turn.cross(t.shift) / (angle * angle);
    let turn = DMat3::from_axis_angle(axis, angle);
    DAffine3::from_mat3_translation(turn, through - turn * through + axis * t.shift.dot(axis))
}
