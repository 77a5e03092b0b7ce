//! Takes two parts and a direction, gives how far the first can go before it overlaps the second by more than touching.
//!
//! By a linear program for each pair of cells that meet (interior point: right to about 1e-7 of the sizes). For moves
//! that stop on their way; a move to infinity needs only `sweep`.

use super::Touch;
use super::shadow::{Convex, View};
use super::sweep::meetings;
use crate::assembly::PartIx;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use glam::DVec3;

/// How far a part can go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// It passes: any distance.
    Free,
    /// Model units.
    Until(f64),
    /// It meets something, and a program was not solved.
    Unknown,
}

/// Along the view's direction, `i` moving and `j` still.
pub fn reach(view: &View, i: PartIx, j: PartIx, touch: Touch) -> Reach {
    until(view, i, j, touch, touch.depth() / 2.0)
}

/// As [`reach`], but only until it touches what it would run into.
pub fn reach_contact(view: &View, i: PartIx, j: PartIx, touch: Touch) -> Reach {
    until(view, i, j, touch, 0.0)
}

fn until(view: &View, i: PartIx, j: PartIx, touch: Touch, radius: f64) -> Reach {
    let ((cells_i, at_i), (cells_j, at_j)) = (view.shapes.part(i), view.shapes.part(j));
    let mut least = f64::INFINITY;
    let unsolved = meetings(view, i, j, touch, |m| {
        match first_overlap(&cells_i[m.a], &cells_j[m.b], at_j - at_i, view.d, radius) {
            Some(t) => least = least.min(t),
            None => return Some(()),
        }
        None
    });
    match unsolved {
        Some(()) => Reach::Unknown,
        None if least.is_infinite() => Reach::Free,
        None => Reach::Until(least),
    }
}

/// Least t >= 0 at which a ball of this radius fits into both cells: over its centre x and t, inside `b` moved by
/// `step`, and inside `a` moved by t d.
fn first_overlap(a: &Convex, b: &Convex, step: DVec3, d: DVec3, radius: f64) -> Option<f64> {
    let of_a = a.planes.iter().map(|&(n, c)| ([n.x, n.y, n.z, -n.dot(d)], c - radius));
    let of_b = b.planes.iter().map(|&(n, c)| ([n.x, n.y, n.z, 0.0], c + n.dot(step) - radius));
    let rows = of_a.chain(of_b).chain([([0.0, 0.0, 0.0, -1.0], 0.0)]);
    let (rows, limits): (Vec<[f64; 4]>, Vec<f64>) = rows.unzip();
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(limits.len())];
    let (none, rows) = (CscMatrix::zeros((4, 4)), CscMatrix::from(&rows));
    let mut solver =
        DefaultSolver::new(&none, &[0.0, 0.0, 0.0, 1.0], &rows, &limits, &cones, settings).ok()?;
    solver.solve();
    (solver.solution.status == SolverStatus::Solved).then(|| solver.solution.x[3].max(0.0))
}
