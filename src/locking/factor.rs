//! Takes contact rows over unknowns; gives the factor of their Gram matrix, to solve with and to find the weakest motion.
//!
//! Dense and in floating point: nothing here is proven, callers bound what they make of it.

use super::rows::{Row, Unknowns};

/// G = A^T A = L L^T.
pub struct Factor {
    n: usize,
    /// Row by row, the lower half in full rows.
    l: Vec<f64>,
}

impl Factor {
    /// None where a pivot is not above 0.
    pub fn of(rows: &[Row], unknowns: &Unknowns) -> Option<Factor> {
        let n = unknowns.count;
        let mut l = vec![0.0; n * n];
        for row in rows {
            let entries: Vec<(usize, f64)> = unknowns.entries(row).collect();
            for &(i, v) in &entries {
                entries.iter().filter(|e| e.0 <= i).for_each(|&(j, w)| l[i * n + j] += v * w);
            }
        }
        for i in 0..n {
            let (done, rest) = l.split_at_mut(i * n);
            let own = &mut rest[..n];
            for j in 0..i {
                let other = &done[j * n..j * n + j + 1];
                own[j] = (own[j] - dot(&own[..j], &other[..j])) / other[j];
            }
            let pivot = own[i] - dot(&own[..i], &own[..i]);
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            own[i] = pivot.sqrt();
        }
        Some(Factor { n, l })
    }

    /// x with G x = b.
    pub fn solve(&self, b: &[f64]) -> Vec<f64> {
        let (n, l) = (self.n, &self.l);
        let mut x = b.to_vec();
        for i in 0..n {
            x[i] = (x[i] - dot(&l[i * n..i * n + i], &x[..i])) / l[i * n + i];
        }
        for i in (0..n).rev() {
            x[i] /= l[i * n + i];
            let own = x[i];
            x[..i].iter_mut().zip(&l[i * n..i * n + i]).for_each(|(v, a)| *v -= a * own);
        }
        x
    }

    /// About the motion that the rows oppose least, by inverse iteration.
    pub fn weakest(&self) -> Vec<f64> {
        const STEPS: usize = 12;
        // Any start will do that is not orthogonal to it by symmetry.
        let mut x: Vec<f64> =
            (0..self.n).map(|k| 1.0 + (k * 7 % 11) as f64 / 13.0 - (k % 3) as f64).collect();
        for _ in 0..STEPS {
            x = self.solve(&x);
            let size = x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            x.iter_mut().for_each(|v| *v /= size);
        }
        x
    }
}

/// Eight sums side by side, so that the processor need not wait for one.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (x, y) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f64 = x.remainder().iter().zip(y.remainder()).map(|(u, v)| u * v).sum();
    for (u, v) in x.zip(y) {
        (0..8).for_each(|k| sums[k] += u[k] * v[k]);
    }
    sums.iter().sum::<f64>() + rest
}
