//! Takes a sparse matrix of f64; gives a proven lower bound of its least singular value, or none.
//!
//! Sound: the bound holds for the matrix as given, all rounding counted. Not complete: none is given where twice the
//! digits of f64 do not show it (a condition beyond about 1e13), or where that would take too long.
//!
//! Method (Rump, "Verification of positive definiteness", BIT 46, 2006): where a Cholesky factorization of
//! G - s 1 runs through in rounded arithmetic, the least eigenvalue of G = A^T A is above s less the error that rounding
//! can have made, which is bounded beforehand.

use super::number::{EXTRA, Number, Twofold};

/// A row: columns and values, every column at most once.
pub type Sparse = Vec<(usize, f64)>;

/// Products for one factorization in twice the digits that are borne: about half a minute.
const MOST_PRODUCTS: f64 = 2e9;

/// Products for one factorization in f64 that are borne: about a minute.
const MOST_PLAIN_PRODUCTS: f64 = 1e11;

/// s as shares of the estimated least eigenvalue, tried in turn.
const SHARES: [f64; 3] = [0.5, 0.1, 0.01];

/// Room for the rounding of the bounds themselves, which are sums of up to millions of positive terms.
pub const UP: f64 = 1.0 + 1e-8;

/// Lower bound above 0 of the least singular value of the matrix with these rows. Each column should meet columns near
/// it: the factor fills each row from its first entry on.
pub fn least_singular(rows: &[Sparse], columns: usize) -> Option<f64> {
    if columns == 0 {
        return Some(f64::INFINITY);
    }
    let shape = Shape::new(rows, columns);
    let found = (shape.products <= MOST_PLAIN_PRODUCTS).then(|| attempt::<f64>(rows, &shape)).flatten();
    let found = found
        .or_else(|| (shape.products <= MOST_PRODUCTS).then(|| attempt::<Twofold>(rows, &shape)).flatten());
    found.map(|square| square.sqrt() / UP)
}

/// Which entries below the diagonal may be other than 0: from `first` on.
struct Shape {
    first: Vec<usize>,
    /// Where a row's entries start.
    start: Vec<usize>,
    products: f64,
    /// Most rows of the matrix that meet in one column.
    terms: usize,
    /// Largest row sum of |A|^T |A|.
    size: f64,
}

impl Shape {
    fn new(rows: &[Sparse], columns: usize) -> Shape {
        let mut first: Vec<usize> = (0..columns).collect();
        let (mut terms, mut sums) = (vec![0_usize; columns], vec![0.0; columns]);
        for row in rows {
            let least = row.iter().map(|e| e.0).min().unwrap_or(0);
            let all: f64 = row.iter().map(|e| e.1.abs()).sum();
            for &(c, v) in row {
                first[c] = first[c].min(least);
                terms[c] += 1;
                sums[c] += v.abs() * all;
            }
        }
        let mut start = Vec::with_capacity(columns + 1);
        let (mut at, mut products) = (0, 0.0);
        for (i, &f) in first.iter().enumerate() {
            start.push(at);
            at += i - f + 1;
            products += ((i - f + 1) as f64).powi(2) / 2.0;
        }
        start.push(at);
        let terms = terms.into_iter().max().unwrap_or(0);
        Shape { first, start, products, terms, size: sums.into_iter().fold(0.0, f64::max) * UP }
    }

    fn columns(&self) -> usize {
        self.first.len()
    }

    /// Longest row of the factor.
    fn longest(&self) -> usize {
        self.first.iter().enumerate().map(|(i, f)| i - f + 1).max().unwrap_or(0)
    }

    /// Largest sum over a row of the full symmetric envelope of sqrt(g_ii g_jj): bounds the norm of |R^T| |R|, since
    /// a column of the factor is no longer than the root of its diagonal entry (up to round-off, which `UP` covers).
    fn spread(&self, diagonal: &[f64]) -> f64 {
        let root: Vec<f64> = diagonal.iter().map(|d| d.max(0.0).sqrt()).collect();
        let mut sums = vec![0.0; self.columns()];
        for (i, &f) in self.first.iter().enumerate() {
            for j in f..=i {
                sums[i] += root[i] * root[j];
                if j < i {
                    sums[j] += root[i] * root[j];
                }
            }
        }
        sums.into_iter().fold(0.0, f64::max) * UP
    }
}

/// Lower bound of the least eigenvalue of A^T A, in one kind of arithmetic.
fn attempt<T: Number>(rows: &[Sparse], shape: &Shape) -> Option<f64> {
    let gram = gram::<T>(rows, shape);
    let diagonal: Vec<f64> = (0..shape.columns()).map(|i| gram[shape.start[i + 1] - 1].value()).collect();
    let estimate = estimate(&factor(&gram, shape, 0.0)?, shape);
    let round = |operations: usize| {
        let g = operations as f64 * T::ROUND_OFF;
        if g < 0.01 { 1.02 * g } else { f64::INFINITY }
    };
    let top = diagonal.iter().copied().fold(0.0, f64::max);
    // Forming G; taking s from its diagonal; the factorization.
    let error = round(shape.terms + 2) * shape.size
        + round(2) * (top + estimate)
        + round(shape.longest() + EXTRA) * shape.spread(&diagonal);
    let error = error * UP + f64::MIN_POSITIVE;
    SHARES.iter().map(|share| share * estimate).find_map(|s| {
        // Less than half would be the arithmetic's word, not the matrix's.
        (error.is_finite() && error < s / 2.0 && factor(&gram, shape, s).is_some()).then(|| (s - error) / UP)
    })
}

/// The lower half of A^T A, row by row from its first entry.
fn gram<T: Number>(rows: &[Sparse], shape: &Shape) -> Vec<T> {
    let mut g = vec![T::of(0.0); shape.start[shape.columns()]];
    for row in rows {
        for &(i, v) in row {
            for &(j, w) in row.iter().filter(|e| e.0 <= i) {
                let at = shape.start[i] + j - shape.first[i];
                g[at] = g[at].plus(T::product(v, w));
            }
        }
    }
    g
}

/// Cholesky's factor of G - s 1; none where a pivot is not above 0.
fn factor<T: Number>(gram: &[T], shape: &Shape, s: f64) -> Option<Vec<T>> {
    let mut l = gram.to_vec();
    for i in 0..shape.columns() {
        let (done, rest) = l.split_at_mut(shape.start[i]);
        let own = &mut rest[..shape.start[i + 1] - shape.start[i]];
        let first = shape.first[i];
        for j in first..i {
            let from = first.max(shape.first[j]);
            let other = &done[shape.start[j]..shape.start[j + 1]];
            let known =
                T::dot(&own[from - first..j - first], &other[from - shape.first[j]..j - shape.first[j]]);
            own[j - first] = own[j - first].plus(known.negated()).over(other[j - shape.first[j]]);
        }
        let (before, last) = own.split_at_mut(i - first);
        let pivot = last[0].plus(T::of(-s)).plus(T::dot(before, before).negated());
        // Not above 0, or no number.
        if pivot.value().is_nan() || pivot.value() <= 0.0 {
            return None;
        }
        last[0] = pivot.root();
    }
    Some(l)
}

/// Steps of inverse iteration: an estimate only, too large by little after few.
const STEPS: usize = 8;

/// About the least eigenvalue.
fn estimate<T: Number>(l: &[T], shape: &Shape) -> f64 {
    let l: Vec<f64> = l.iter().map(|v| v.value()).collect();
    let n = shape.columns();
    // Any start will do that is not orthogonal to the eigenvector by symmetry.
    let mut x: Vec<f64> = (0..n).map(|k| 1.0 + (k * 7 % 11) as f64 / 13.0 - (k % 3) as f64).collect();
    let mut least = f64::INFINITY;
    for _ in 0..STEPS {
        let norm = x.iter().map(|v| v * v).sum::<f64>().sqrt();
        x.iter_mut().for_each(|v| *v /= norm);
        solve(&l, shape, &mut x);
        least = least.min(1.0 / x.iter().map(|v| v * v).sum::<f64>().sqrt());
    }
    least
}

fn solve(l: &[f64], shape: &Shape, x: &mut [f64]) {
    let row = |i: usize| &l[shape.start[i]..shape.start[i + 1]];
    for i in 0..shape.columns() {
        let (f, r) = (shape.first[i], row(i));
        let known = f64::dot(&r[..i - f], &x[f..i]);
        x[i] = (x[i] - known) / r[i - f];
    }
    for i in (0..shape.columns()).rev() {
        let (f, r) = (shape.first[i], row(i));
        x[i] /= r[i - f];
        let own = x[i];
        x[f..i].iter_mut().zip(r).for_each(|(v, a)| *v -= a * own);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dense(rows: &[&[f64]]) -> Vec<Sparse> {
        rows.iter().map(|r| r.iter().copied().enumerate().collect()).collect()
    }

    #[test]
    fn a_known_least_singular_value_is_bounded_closely() {
        // Singular values 3 and 1.
        let a = dense(&[&[2.0, 1.0], &[1.0, 2.0]]);
        let found = least_singular(&a, 2).unwrap();
        assert!(found <= 1.0 && found > 0.5, "{found}");
    }

    #[test]
    fn nearly_singular_needs_twice_the_digits_and_gets_them() {
        // Least singular value e / sqrt(2), nearly.
        for e in [2f64.powi(-30), 2f64.powi(-40)] {
            let a = dense(&[&[1.0, 1.0], &[1.0, 1.0 + e], &[1.0, 1.0]]);
            let shape = Shape::new(&a, 2);
            assert!(attempt::<f64>(&a, &shape).is_none());
            let found = least_singular(&a, 2).unwrap();
            assert!(found < e && found > e / 4.0, "{found} against {e}");
        }
    }

    #[test]
    fn a_singular_matrix_has_no_bound() {
        let a = dense(&[&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0], &[7.0, 8.0, 9.0]]);
        assert_eq!(least_singular(&a, 3), None);
        assert_eq!(least_singular(&a[..2], 3), None);
        // Doubling is exact, whatever the digits.
        let b = dense(&[&[0.1, 0.3], &[0.2, 0.6]]);
        assert_eq!(least_singular(&b, 2), None);
    }
}
