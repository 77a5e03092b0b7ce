//! Takes a symmetric positive semidefinite matrix; gives its pivoted Cholesky factor, rank and null directions.
//!
//! Backward stable; the rank is numerical. A direction called null is checked by the caller against the rows.

use rayon::prelude::*;

/// P G P^T = L L^T, up to what the pivots that were too small leave.
pub struct Cholesky {
    n: usize,
    /// Row k of L, in pivoted order, k + 1 entries used for k < rank.
    l: Vec<f64>,
    order: Vec<usize>,
    pub rank: usize,
    /// Smallest pivot over the largest; 1 where there is none.
    pub pivot_ratio: f64,
}

/// Lower bound on the relative size of a pivot that counts: forming and factoring a Gram matrix of m rows and n
/// columns is off by at most about (m + n) units of round-off times its trace.
pub fn pivot_round_off(rows: usize, columns: usize) -> f64 {
    (rows + columns) as f64 * f64::EPSILON
}

impl Cholesky {
    /// Factors the full `n` x `n` matrix `g` (row by row); pivots at or below `least` end it.
    pub fn new(mut g: Vec<f64>, n: usize, least: f64) -> Cholesky {
        let mut order: Vec<usize> = (0..n).collect();
        let (mut rank, mut pivot_ratio, mut first) = (0, 1.0, 0.0);
        for k in 0..n {
            let best = (k..n).max_by(|&i, &j| g[i * n + i].total_cmp(&g[j * n + j])).unwrap_or(k);
            let pivot = g[best * n + best];
            if pivot <= least {
                break;
            }
            swap(&mut g, n, k, best);
            order.swap(k, best);
            // Pivots fall, so the first one is the largest.
            first = if k == 0 { pivot } else { first };
            pivot_ratio = pivot / first;
            eliminate(&mut g, n, k);
            rank = k + 1;
        }
        Cholesky { n, l: g, order, rank, pivot_ratio }
    }

    /// Solves G x = b on the pivot columns; the other components of x are 0.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let (n, l) = (self.n, &self.l);
        let mut y: Vec<f64> = self.order[..self.rank].iter().map(|&i| b[i]).collect();
        for i in 0..self.rank {
            let done: f64 = (0..i).map(|k| l[i * n + k] * y[k]).sum();
            y[i] = (y[i] - done) / l[i * n + i];
        }
        self.back(y)
    }

    fn back(&self, mut y: Vec<f64>) -> Vec<f64> {
        let (n, l) = (self.n, &self.l);
        for i in (0..self.rank).rev() {
            y[i] /= l[i * n + i];
            for k in 0..i {
                y[k] -= l[i * n + k] * y[i];
            }
        }
        let mut x = vec![0.0; n];
        for (k, v) in y.into_iter().enumerate() {
            x[self.order[k]] = v;
        }
        x
    }

    /// A direction that the factor maps to (nearly) nothing, if the rank is not full: unit on one free column.
    pub fn null(&self) -> Option<Vec<f64>> {
        (self.rank < self.n).then(|| {
            let free = self.rank;
            let y = (0..self.rank).map(|k| -self.l[free * self.n + k]).collect();
            let mut x = self.back(y);
            x[self.order[free]] = 1.0;
            x
        })
    }
}

/// Exchanges row and column i with j, in the part that is not yet factored and in the factor's rows.
fn swap(g: &mut [f64], n: usize, i: usize, j: usize) {
    if i == j {
        return;
    }
    for k in 0..n {
        g.swap(i * n + k, j * n + k);
    }
    for k in 0..n {
        g.swap(k * n + i, k * n + j);
    }
}

/// One step: column k of L, and the rest of the matrix less its square.
fn eliminate(g: &mut [f64], n: usize, k: usize) {
    let pivot = g[k * n + k].sqrt();
    g[k * n + k] = pivot;
    for i in k + 1..n {
        g[i * n + k] /= pivot;
    }
    let column: Vec<f64> = (k + 1..n).map(|i| g[i * n + k]).collect();
    let rest = &mut g[(k + 1) * n..];
    let update = |(i, row): (usize, &mut [f64])| {
        let by = column[i];
        if by != 0.0 {
            row[k + 1..].iter_mut().zip(&column).for_each(|(v, c)| *v -= by * c);
        }
    };
    // Below this many rows a thread costs more than it saves.
    if n - k > 256 {
        rest.par_chunks_mut(n).enumerate().for_each(update);
    } else {
        rest.chunks_mut(n).enumerate().for_each(update);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_singular_gram_matrix_gives_rank_and_null_direction() {
        // Rows (1, 1, 0), (0, 1, 1), (1, 2, 1): rank 2, null direction (1, -1, 1).
        let a = [[1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 2.0, 1.0]];
        let g = (0..9).map(|k| a.iter().map(|r| r[k / 3] * r[k % 3]).sum()).collect();
        let f = Cholesky::new(g, 3, 1e-13);
        assert_eq!(f.rank, 2);
        let x = f.null().unwrap();
        assert!(a.iter().all(|r| (0..3).map(|k| r[k] * x[k]).sum::<f64>().abs() < 1e-14));
    }
}
