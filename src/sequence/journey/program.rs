//! Takes a wished motion of the parts of a set and the gaps between them, gives the nearest motion that closes no gap
//! further than it may, to first order.
//!
//! A quadratic program (interior point, clarabel): least |x - wish|^2 with n . (v_b(p) - v_a(p)) >= -gap for each row and
//! |x| <= step for each unknown. Of many rows few bind: those that the motion so far breaks are added until it breaks
//! none, which gives the same motion. Not promised: anything beyond first order; the caller moves and looks again.

use super::bodies::{Bodies, Body, Owner, Poses, between};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use glam::{DAffine3, DMat3, DVec3};
use std::collections::BTreeMap;

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

/// Rows of a program before its step counts as too long: each round looks at all of them, some milliseconds.
pub const MOST_ROWS: usize = 200_000;

/// Programs of so many rows are solved as they are: a few milliseconds each.
pub const SOLVED_WHOLE: usize = 1500;

/// Rows of one pair of parts added in one round, those that are broken most: three turns and three shifts leave no more
/// than six of them binding at once, with as many again that take their place.
const ADDED: usize = 12;

/// Rounds before a program counts as not solved.
const ROUNDS: usize = 60;

/// Share of the step by which a row may be broken: ten times the solver's own tolerance.
const BROKEN_SHARE: f64 = 1e-7;

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
    if rows.len() <= SOLVED_WHOLE {
        return solved(bodies, poses, rows, wish, step, &room);
    }
    let movable: Vec<bool> = bodies.fixed.iter().map(|f| !f).collect();
    let own = |(k, t): (usize, &Twist)| if movable[k] { *t } else { Twist::default() };
    let mut motion: Vec<Twist> = wish.iter().enumerate().map(own).collect();
    let mut taken = vec![false; rows.len()];
    let mut chosen: Vec<Row> = Vec::new();
    for round in 0..ROUNDS {
        let found = broken(bodies, poses, rows, &taken, &motion, step, &room);
        // The wish itself is not yet within the step.
        if found.is_empty() && round > 0 {
            return Some(motion);
        }
        found.iter().for_each(|&k| taken[k] = true);
        chosen.extend(found.iter().map(|&k| rows[k]));
        motion = solved(bodies, poses, &chosen, wish, step, &room)?;
    }
    None
}

/// Of each pair of parts the rows not taken yet that the motion breaks most.
fn broken(
    bodies: &Bodies,
    poses: &Poses,
    rows: &[Row],
    taken: &[bool],
    motion: &[Twist],
    step: f64,
    room: &impl Fn(f64) -> f64,
) -> Vec<usize> {
    let at: Vec<DVec3> = (0..poses.len()).map(|k| poses[k].transform_point3(bodies.centre[k])).collect();
    let speed = |k: usize, p: DVec3| motion[k].shift + motion[k].turn.cross(p - at[k]);
    let mut by_pair: BTreeMap<(usize, usize), Vec<(f64, usize)>> = BTreeMap::new();
    for (k, r) in rows.iter().enumerate().filter(|(k, _)| !taken[*k]) {
        let closing = r.normal.dot(speed(r.a, r.point) - speed(r.b, r.point));
        let over = closing - room(r.gap);
        if over > BROKEN_SHARE * step {
            by_pair.entry((r.a, r.b)).or_default().push((over, k));
        }
    }
    let worst = |mut of: Vec<(f64, usize)>| {
        of.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        of.truncate(ADDED);
        of
    };
    by_pair.into_values().flat_map(worst).map(|(_, k)| k).collect()
}

/// The program with all of these rows.
fn solved(
    bodies: &Bodies,
    poses: &Poses,
    rows: &[Row],
    wish: &[Twist],
    step: f64,
    room: &impl Fn(f64) -> f64,
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
