//! Takes a motion and the rows that it nearly keeps closed; gives a motion near it that keeps these closed exactly.
//!
//! Not sound by itself: the caller decides every row for what comes back. Not complete: none for more than
//! [`MOST_UNKNOWNS`] unknowns, nor where the rows as written have full rank by their rounding.

use super::dyadic::Dyadic;
use super::field::{Residue, ZERO, independent};
use super::motion::{Row, Twist, Twists};
use crate::assembly::PartIx;
use dashu_int::IBig;

/// Unknowns of an exact solve that are borne: its numbers have about 150 digits for each.
const MOST_UNKNOWNS: usize = 96;

/// What to keep closed.
pub struct Tight<'r> {
    pub rows: &'r [Row],
    /// Unknowns of a part: 3 or 6.
    pub width: usize,
    /// A part whose twist has no larger number stands still.
    pub least: f64,
}

/// The motion with some of its numbers solved anew, exactly, so that the tight rows stay closed.
pub fn mended(x: &Twists, tight: &Tight) -> Option<Twists> {
    let moving = |t: &Twist| t.near.iter().any(|v| v.abs().max_element() > tight.least);
    let parts: Vec<usize> = (0..x.len()).filter(|&p| x[p].as_ref().is_some_and(moving)).collect();
    let columns = parts.len() * tight.width;
    if columns == 0 || columns > MOST_UNKNOWNS {
        return None;
    }
    let place = |p: PartIx| parts.iter().position(|&q| q == p.at()).map(|k| k * tight.width);
    let rows: Vec<&Row> =
        tight.rows.iter().filter(|r| place(r.a).is_some() || place(r.b).is_some()).collect();
    let chosen = independent(rows.iter().map(|r| residues(r, place, tight.width, columns)), columns);
    if chosen.len() == columns {
        return None;
    }
    let matrix: Vec<Vec<Dyadic>> =
        chosen.iter().map(|&k| entries(rows[k], place, tight.width, columns)).collect();
    let near: Vec<f64> = parts
        .iter()
        .flat_map(|&p| x[p].iter().flat_map(|t| t.near.iter().flat_map(|v| v.to_array())).take(tight.width))
        .collect();
    let solved = solved(&matrix, &near)?;
    let mut out: Twists = vec![None; x.len()];
    for (k, &p) in parts.iter().enumerate() {
        let at =
            |c: usize| if c < tight.width { solved[k * tight.width + c].clone() } else { Dyadic::zero() };
        out[p] = Some(Twist::new([0, 1, 2].map(at), [3, 4, 5].map(at)));
    }
    Some(out)
}

type Place<'p> = &'p dyn Fn(PartIx) -> Option<usize>;

fn filled<T: Clone>(
    row: &Row,
    place: Place,
    width: usize,
    mut out: Vec<T>,
    values: [T; 6],
    minus: impl Fn(&T) -> T,
) -> Vec<T> {
    for (part, negative) in [(row.a, true), (row.b, false)] {
        let Some(c) = place(part) else { continue };
        for (k, v) in values.iter().take(width).enumerate() {
            out[c + k] = if negative { minus(v) } else { v.clone() };
        }
    }
    out
}

/// The row in the field: normal, and point x normal.
fn residues(
    row: &Row,
    place: impl Fn(PartIx) -> Option<usize>,
    width: usize,
    columns: usize,
) -> Vec<Residue> {
    let (n, p) = (row.n.to_array().map(Residue::of), row.p.to_array().map(Residue::of));
    let moment = |i: usize, j: usize| p[i].times(n[j]).minus(p[j].times(n[i]));
    let values = [n[0], n[1], n[2], moment(1, 2), moment(2, 0), moment(0, 1)];
    filled(row, &place, width, vec![ZERO; columns], values, |v| ZERO.minus(*v))
}

fn entries(row: &Row, place: impl Fn(PartIx) -> Option<usize>, width: usize, columns: usize) -> Vec<Dyadic> {
    let (n, p) = (super::dyadic::vector(row.n), super::dyadic::vector(row.p));
    let m = super::dyadic::cross(&p, &n);
    let ([a, b, c], [d, e, f]) = (n, m);
    let zero = Dyadic::zero();
    filled(row, &place, width, vec![zero.clone(); columns], [a, b, c, d, e, f], |v| zero.clone().minus(v))
}

/// x with the matrix times x exactly 0: as near for the columns that are left free, the others solved.
fn solved(matrix: &[Vec<Dyadic>], near: &[f64]) -> Option<Vec<Dyadic>> {
    let pivots = pivots(matrix, near.len())?;
    let free: Vec<usize> = (0..near.len()).filter(|c| !pivots.contains(c)).collect();
    let given: Vec<Dyadic> = near.iter().map(|&v| Dyadic::of(v)).collect();
    let equation = |row: &Vec<Dyadic>| {
        let rest = free.iter().fold(Dyadic::zero(), |s, &c| s.minus(&row[c].times(&given[c])));
        let all: Vec<Dyadic> = pivots.iter().map(|&c| row[c].clone()).chain([rest]).collect();
        let to = all.iter().map(Dyadic::exponent).min().unwrap_or(0).min(0);
        all.iter().map(|v| v.scaled(to)).collect::<Vec<IBig>>()
    };
    let (top, det) = eliminated(matrix.iter().map(equation).collect())?;
    let mut x = vec![Dyadic::zero(); near.len()];
    // All times the determinant, brought back to about the size of what was given by a power of two.
    let det = Dyadic::integer(det);
    let by = -det.magnitude();
    let det = det.shifted(by);
    free.iter().for_each(|&c| x[c] = given[c].times(&det));
    pivots.iter().zip(top).for_each(|(&c, v)| x[c] = Dyadic::integer(v).shifted(by));
    Some(x)
}

/// Columns that make a well-conditioned square matrix, by elimination with the largest entry first, in f64.
fn pivots(matrix: &[Vec<Dyadic>], columns: usize) -> Option<Vec<usize>> {
    let mut a: Vec<Vec<f64>> = matrix.iter().map(|r| r.iter().map(Dyadic::value).collect()).collect();
    let mut chosen = Vec::with_capacity(a.len());
    for k in 0..a.len() {
        let all = (k..a.len()).flat_map(|i| (0..columns).map(move |c| (i, c)));
        let (i, c) = all
            .filter(|(_, c)| !chosen.contains(c))
            .max_by(|&(i, c), &(j, d)| a[i][c].abs().total_cmp(&a[j][d].abs()))?;
        a.swap(k, i);
        if a[k][c] == 0.0 {
            return None;
        }
        chosen.push(c);
        let pivot = a[k].clone();
        for row in a.iter_mut().skip(k + 1) {
            let by = row[c] / pivot[c];
            row.iter_mut().zip(&pivot).for_each(|(v, p)| *v -= by * p);
        }
    }
    Some(chosen)
}

/// Solves a square system of integers, its right side in the last column, by fraction-free elimination (Bareiss 1968):
/// numerators, and the determinant that they all stand over.
fn eliminated(mut a: Vec<Vec<IBig>>) -> Option<(Vec<IBig>, IBig)> {
    let n = a.len();
    let mut before = IBig::ONE;
    for k in 0..n {
        let at = (k..n).find(|&i| !a[i][k].is_zero())?;
        a.swap(k, at);
        let pivot = a[k].clone();
        for (_, row) in a.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let by = row[k].clone();
            // Columns before k hold only the diagonal of the rows above, which takes the new pivot in the end.
            for (j, v) in row.iter_mut().enumerate().skip(k) {
                *v = (&pivot[k] * &*v - &by * &pivot[j]) / &before;
            }
        }
        before = pivot[k].clone();
    }
    Some((a.into_iter().map(|row| row[n].clone()).collect(), before))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_system_of_integers_is_solved_exactly() {
        // x + 2y = 3, 4x + 5y = 6: x = -1, y = 2, over the determinant -3.
        let a = [[1, 2, 3], [4, 5, 6]].map(|r| r.map(IBig::from).to_vec()).to_vec();
        let (top, det) = eliminated(a).unwrap();
        assert_eq!((top, det), (vec![IBig::from(3), IBig::from(-6)], IBig::from(-3)));
    }

    #[test]
    fn a_motion_along_an_oblique_plane_is_mended() {
        let n = DVec3::new(0.6, 0.8, 0.1).normalize();
        let row = |p: DVec3| Row { a: PartIx(0), b: PartIx(1), n, p };
        let rows = [row(DVec3::ZERO), row(DVec3::X), row(DVec3::Z)];
        let v = DVec3::new(0.8, -0.6, 0.0).to_array().map(Dyadic::of);
        let x = vec![None, Some(Twist::new(v, [0.0; 3].map(Dyadic::of)))];
        let mended = mended(&x, &Tight { rows: &rows, width: 3, least: 1e-9 }).unwrap();
        let t = mended[1].as_ref().unwrap();
        let along = super::super::dyadic::dot(&super::super::dyadic::vector(n), &t.v);
        assert_eq!(along.sign(), std::cmp::Ordering::Equal);
        assert!(t.near[0].normalize().distance(DVec3::new(0.8, -0.6, 0.0)) < 1e-12);
    }
}
