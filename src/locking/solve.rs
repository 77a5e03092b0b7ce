//! Takes contact rows over unknowns; gives a self-stress, or a motion that the rows allow, found by a conic solver.
//!
//! Neither sound nor complete by itself: what comes back is a candidate in floating point. `decide` polishes it and
//! judges it against the rows.

use super::rows::{Row, Unknowns};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT::NonnegativeConeT,
    SupportedConeT::ZeroConeT,
};

/// What the solver ended with.
pub enum Candidate {
    /// A force for each row, all at least about 1, in balance.
    Stress(Vec<f64>),
    /// A motion that opens or keeps every row.
    Motion(Vec<f64>),
    /// Neither: the solver's own word for it.
    Neither(String),
}

/// Looks for forces y >= 1 with A^T y = 0, of least norm; where there are none the solver's proof of that is a motion
/// x with A x >= 0 that opens a contact (Farkas).
pub fn candidate(rows: &[Row], unknowns: &Unknowns) -> Candidate {
    let (m, n) = (rows.len(), unknowns.count);
    if m == 0 {
        return Candidate::Neither("no contact rows".into());
    }
    let norm = CscMatrix::identity(m);
    let constraints = constraints(rows, unknowns);
    let mut bounds = vec![0.0; n];
    bounds.extend(vec![-1.0; m]);
    let cones = [ZeroConeT(n), NonnegativeConeT(m)];
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let Ok(mut solver) = DefaultSolver::new(&norm, &vec![0.0; m], &constraints, &bounds, &cones, settings)
    else {
        return Candidate::Neither("the solver refused the problem".into());
    };
    solver.solve();
    let solution = &solver.solution;
    match solution.status {
        SolverStatus::Solved | SolverStatus::AlmostSolved => Candidate::Stress(solution.x.clone()),
        SolverStatus::PrimalInfeasible | SolverStatus::AlmostPrimalInfeasible => {
            Candidate::Motion(solution.z[..n].to_vec())
        }
        other => Candidate::Neither(format!("{other:?}")),
    }
}

/// The motion within the unit box whose openings, each counted up to 1, sum to the most. An interior point method ends
/// inside the set of such motions, so that every row that can open does: zero and open rows lie far apart.
pub fn widest(rows: &[Row], unknowns: &Unknowns) -> Option<Vec<f64>> {
    let (m, n) = (rows.len(), unknowns.count);
    let mut matrix = Triplets::default();
    // Rows of the problem, all "at most": s - A x <= 0, s <= 1, -s <= 0, x <= 1, -x <= 1.
    for (k, row) in rows.iter().enumerate() {
        unknowns.entries(row).for_each(|(c, v)| matrix.push(k, c, -v));
        matrix.push(k, n + k, 1.0);
        matrix.push(m + k, n + k, 1.0);
        matrix.push(2 * m + k, n + k, -1.0);
    }
    for c in 0..n {
        matrix.push(3 * m + c, c, 1.0);
        matrix.push(3 * m + n + c, c, -1.0);
    }
    let height = 3 * m + 2 * n;
    let bound = |k: usize| if k < m || (2 * m..3 * m).contains(&k) { 0.0 } else { 1.0 };
    let bounds: Vec<f64> = (0..height).map(bound).collect();
    let goal: Vec<f64> = (0..n + m).map(|c| if c < n { 0.0 } else { -1.0 }).collect();
    let constraints = CscMatrix::new_from_triplets(height, n + m, matrix.row, matrix.column, matrix.value);
    let none = CscMatrix::zeros((n + m, n + m));
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(height)];
    let mut solver = DefaultSolver::new(&none, &goal, &constraints, &bounds, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    solved.then(|| solver.solution.x[..n].to_vec())
}

#[derive(Default)]
struct Triplets {
    row: Vec<usize>,
    column: Vec<usize>,
    value: Vec<f64>,
}

impl Triplets {
    fn push(&mut self, row: usize, column: usize, value: f64) {
        self.row.push(row);
        self.column.push(column);
        self.value.push(value);
    }
}

/// The stacked matrix of A^T y = 0 and -y + s = -1, column by column: a column a row of A, then its bound.
fn constraints(rows: &[Row], unknowns: &Unknowns) -> CscMatrix<f64> {
    let (m, n) = (rows.len(), unknowns.count);
    let (mut starts, mut index, mut value) = (vec![0], Vec::new(), Vec::new());
    for (k, row) in rows.iter().enumerate() {
        let mut entries: Vec<(usize, f64)> = unknowns.entries(row).collect();
        entries.sort_unstable_by_key(|e| e.0);
        entries.push((n + k, -1.0));
        index.extend(entries.iter().map(|e| e.0));
        value.extend(entries.iter().map(|e| e.1));
        starts.push(index.len());
    }
    CscMatrix::new(n + m, m, starts, index, value)
}
