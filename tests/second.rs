//! A second opinion on a verdict: another linear program (microlp's simplex) for motions that open a contact, and
//! elimination for motions along which every contact slides.
//!
//! Takes patches, gives a word or says that its own numbers are in doubt. Shares nothing with `locking`: rows are
//! built here, with moments about the origin. Meant for small assemblies near the origin.

use microlp::{ComparisonOp, OptimizationDirection, Problem};
use std::collections::BTreeSet;
use weavelock::assembly::{Assembly, PartIx};
use weavelock::contact::Patch;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Opinion {
    Locked,
    /// Free, and some contact opens.
    Opens,
    /// Free, and the best that can happen is that everything slides.
    Slides,
    /// A number lies between what round-off explains and what counts.
    InDoubt,
}

impl Opinion {
    pub fn word(self) -> &'static str {
        match self {
            Opinion::Locked => "locked",
            Opinion::Opens | Opinion::Slides => "free",
            Opinion::InDoubt => "in doubt",
        }
    }
}

/// Sum of openings of a motion in the unit box: below this it is the simplex's own tolerance (1e-8 for each of some
/// hundred rows), above [`OPENS`] it is a motion. Openings of the small assemblies meant here are some hundredths.
const SIMPLEX_ROUND_OFF: f64 = 1e-5;
const OPENS: f64 = 1e-3;

/// Pivots against the largest: elimination of some hundred rows is off by about 1e-13; a pivot that counts is larger
/// than the square root of machine precision by an order.
const NO_PIVOT: f64 = 1e-11;
const A_PIVOT: f64 = 1e-7;

/// The opinion on translations (`turning` false) or rigid motions while the parts `still` do not move.
pub fn opinion(asm: &Assembly, patches: &[Patch], still: &[PartIx], turning: bool) -> Opinion {
    let rows = rows(asm, patches, still, turning);
    let width = if turning { 6 } else { 3 };
    let columns = asm.parts.len().saturating_sub(still.len()) * width;
    if columns == 0 {
        return Opinion::Locked;
    }
    match (widest(&rows, columns), rank(rows.clone(), columns)) {
        (Some(sum), _) if sum > OPENS => Opinion::Opens,
        (Some(sum), Some(rank)) if sum < SIMPLEX_ROUND_OFF => {
            if rank == columns {
                Opinion::Locked
            } else {
                Opinion::Slides
            }
        }
        _ => Opinion::InDoubt,
    }
}

type Row = Vec<(usize, f64)>;

fn rows(asm: &Assembly, patches: &[Patch], still: &[PartIx], turning: bool) -> Vec<Row> {
    let mut first = vec![None; asm.parts.len()];
    let mut next = 0;
    for p in asm.ids().filter(|p| !still.contains(p)) {
        first[p.at()] = Some(next);
        next += if turning { 6 } else { 3 };
    }
    let (mut seen, mut rows) = (BTreeSet::new(), Vec::new());
    for patch in patches {
        for point in &patch.corners {
            let (n, m) = (patch.normal, point.cross(patch.normal));
            let wrench = [n.x, n.y, n.z, m.x, m.y, m.z];
            let wrench = &wrench[..if turning { 6 } else { 3 }];
            let mut row = Row::new();
            for (part, sign) in [(patch.a, -1.0), (patch.b, 1.0)] {
                if let Some(c) = first[part.at()] {
                    row.extend(wrench.iter().enumerate().map(|(k, v)| (c + k, sign * v)));
                }
            }
            let bits: Vec<_> = row.iter().map(|(c, v)| (*c, (v + 0.0).to_bits())).collect();
            if seen.insert(bits) {
                rows.push(row);
            }
        }
    }
    rows
}

/// The largest sum of openings, each counted up to 1, of a motion in the unit box.
fn widest(rows: &[Row], columns: usize) -> Option<f64> {
    let mut problem = Problem::new(OptimizationDirection::Maximize);
    let motion: Vec<_> = (0..columns).map(|_| problem.add_var(0.0, (-1.0, 1.0))).collect();
    for row in rows {
        let opening = problem.add_var(1.0, (0.0, 1.0));
        let mut terms: Vec<_> = row.iter().map(|&(c, v)| (motion[c], v)).collect();
        terms.push((opening, -1.0));
        problem.add_constraint(terms, ComparisonOp::Ge, 0.0);
    }
    let outcome = problem.solve().ok()?;
    outcome.is_optimal().then(|| outcome.solution().map(|s| s.objective())).flatten()
}

/// Rank by elimination with full pivoting; none where a pivot is neither zero nor not.
fn rank(rows: Vec<Row>, columns: usize) -> Option<usize> {
    let mut dense: Vec<Vec<f64>> = rows
        .into_iter()
        .map(|row| {
            let mut full = vec![0.0; columns];
            row.into_iter().for_each(|(c, v)| full[c] += v);
            full
        })
        .collect();
    let mut top = 0.0_f64;
    for k in 0..columns {
        let place = (k..dense.len()).flat_map(|i| (k..columns).map(move |j| (i, j)));
        let best = place.max_by(|&(i, j), &(u, v)| dense[i][j].abs().total_cmp(&dense[u][v].abs()));
        let size = best.map_or(0.0, |(i, j)| dense[i][j].abs());
        top = top.max(size);
        let Some((i, j)) = best.filter(|_| size > NO_PIVOT * top) else { return Some(k) };
        if size < A_PIVOT * top {
            return None;
        }
        dense.swap(k, i);
        dense.iter_mut().for_each(|row| row.swap(k, j));
        let (done, rest) = dense.split_at_mut(k + 1);
        for row in rest {
            let by = row[k] / done[k][k];
            row[k..].iter_mut().zip(&done[k][k..]).for_each(|(v, p)| *v -= by * p);
        }
    }
    Some(columns)
}
