//! Takes a symmetric positive semidefinite matrix of W x W blocks; gives its Cholesky factor on the block pattern.
//!
//! The matrix is scaled to a unit diagonal first. No pivoting: columns whose pivot is within round-off are left out
//! (pinned), which finds null directions but does not prove their number; [`Pins::Proof`] proves full rank.

use super::order::Pattern;

/// Row by row.
pub type Block<const W: usize> = [[f64; W]; W];

pub const fn zero<const W: usize>() -> Block<W> {
    [[0.0; W]; W]
}

/// Which columns of the scaled matrix are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pins {
    /// Those whose pivot is within the round-off of the sums that make it.
    RoundOff,
    /// Those whose pivot is within so many times the bound of [`Pins::Proof`].
    Doubtful(f64),
    /// As `RoundOff`, of the matrix less a bound on the norm of all round-off: if none is left out the matrix is proven
    /// positive definite. The factor of a matrix with unit diagonal is off by at most as many units of round-off in
    /// each entry as products are added there (Higham 2002, theorem 10.3), the norm by that times a row's entries
    /// (Rump 2006).
    Proof,
    /// As `Proof`, less this as well: if none is left out all eigenvalues of the scaled matrix are proven to be larger.
    Above(f64),
}

/// S G S = L L^T on the columns that are not pinned, S diagonal.
pub struct Factor<const W: usize> {
    l: Vec<Block<W>>,
    scale: Vec<[f64; W]>,
    /// Columns left out: (node, component).
    pub pinned: Vec<(usize, usize)>,
    /// Smallest pivot kept over the largest; 1 where there is none.
    pub pivot_ratio: f64,
}

/// Lower bound on a pivot that counts, for a unit diagonal: each entry is a sum of that many products, each off by a
/// unit of round-off at most, as the matrix itself is.
fn pivot_round_off(terms: usize) -> f64 {
    terms as f64 * f64::EPSILON
}

impl<const W: usize> Factor<W> {
    /// `blocks` are laid out as the pattern's; `summed` is how many products were added in an entry of them at most.
    pub fn new(pattern: &Pattern, mut blocks: Vec<Block<W>>, summed: usize, pins: Pins) -> Factor<W> {
        let scale = scale(pattern, &mut blocks);
        let round_off = pivot_round_off(pattern.most_terms(W) + summed);
        let bound = round_off * pattern.most_entries(W) as f64;
        let (least, off) = match pins {
            Pins::RoundOff => (round_off, 0.0),
            Pins::Doubtful(times) => (bound * times, 0.0),
            Pins::Proof => (round_off, bound),
            Pins::Above(least) => (round_off, bound + least),
        };
        let mut pivots = Pivots { least, smallest: f64::INFINITY, largest: 0.0, pinned: Vec::new() };
        let mut at = vec![0; pattern.place.len()];
        for column in 0..pattern.place.len() {
            let (done, rest) = blocks.split_at_mut(pattern.start[column]);
            let own = &mut rest[..pattern.start[column + 1] - pattern.start[column]];
            (0..W).for_each(|c| own[0][c][c] -= off);
            gather(pattern, column, done, own, &mut at);
            pivots.close(column, own);
        }
        let node = node_at(pattern);
        let pinned = pivots.pinned.iter().map(|&(k, c)| (node[k], c)).collect();
        let pivot_ratio = if pivots.largest > 0.0 { pivots.smallest / pivots.largest } else { 1.0 };
        Factor { l: blocks, scale, pinned, pivot_ratio }
    }

    /// What the matrix was scaled by, for each node.
    pub fn scale(&self) -> &[[f64; W]] {
        &self.scale
    }

    /// Solves G x = b on the columns that are not pinned; the other components of x are 0. By node.
    pub fn solve(&self, pattern: &Pattern, b: &[[f64; W]]) -> Vec<[f64; W]> {
        let n = pattern.place.len();
        let mut x = vec![[0.0; W]; n];
        for (v, &k) in pattern.place.iter().enumerate() {
            x[k] = std::array::from_fn(|c| b[v][c] * self.scale[v][c]);
        }
        for k in 0..n {
            let own = &self.l[pattern.start[k]..pattern.start[k + 1]];
            let z = forward(&own[0], x[k]);
            x[k] = z;
            for (block, &r) in own.iter().zip(&pattern.row[pattern.start[k]..]).skip(1) {
                x[r] = std::array::from_fn(|i| x[r][i] - dot(&block[i], &z));
            }
        }
        for k in (0..n).rev() {
            let own = &self.l[pattern.start[k]..pattern.start[k + 1]];
            let mut z = x[k];
            for (block, &r) in own.iter().zip(&pattern.row[pattern.start[k]..]).skip(1) {
                for (line, v) in block.iter().zip(&x[r]) {
                    (0..W).for_each(|c| z[c] -= line[c] * v);
                }
            }
            x[k] = backward(&own[0], z);
        }
        let of = |v: usize| std::array::from_fn(|c| x[pattern.place[v]][c] * self.scale[v][c]);
        (0..n).map(of).collect()
    }
}

pub fn dot<const W: usize>(a: &[f64; W], b: &[f64; W]) -> f64 {
    (0..W).map(|k| a[k] * b[k]).sum()
}

fn node_at(pattern: &Pattern) -> Vec<usize> {
    let mut node = vec![0; pattern.place.len()];
    pattern.place.iter().enumerate().for_each(|(v, &k)| node[k] = v);
    node
}

/// Scales to a unit diagonal; gives the scale of each node. A zero diagonal keeps scale 0.
fn scale<const W: usize>(pattern: &Pattern, blocks: &mut [Block<W>]) -> Vec<[f64; W]> {
    let of = |k: usize| -> [f64; W] {
        std::array::from_fn(|c| {
            let d = blocks[pattern.start[k]][c][c];
            if d > 0.0 { d.sqrt().recip() } else { 0.0 }
        })
    };
    let by: Vec<[f64; W]> = (0..pattern.place.len()).map(of).collect();
    for (column, s) in by.iter().enumerate() {
        let own = pattern.start[column]..pattern.start[column + 1];
        for (block, &row) in blocks[own.clone()].iter_mut().zip(&pattern.row[own]) {
            for (line, r) in block.iter_mut().zip(by[row]) {
                line.iter_mut().zip(s).for_each(|(v, s)| *v *= r * s);
            }
        }
    }
    pattern.place.iter().map(|&k| by[k]).collect()
}

/// Takes off a column what the columns before it leave there.
fn gather<const W: usize>(
    p: &Pattern,
    column: usize,
    done: &[Block<W>],
    own: &mut [Block<W>],
    at: &mut [usize],
) {
    for (k, &row) in p.row[p.start[column]..p.start[column + 1]].iter().enumerate() {
        at[row] = k;
    }
    for &(k, first) in &p.left[column] {
        let by = transposed(&done[first]);
        let rest = first..p.start[k + 1];
        for (block, &row) in done[rest.clone()].iter().zip(&p.row[rest]) {
            less_product(&mut own[at[row]], block, &by);
        }
    }
}

pub fn transposed<const W: usize>(a: &Block<W>) -> Block<W> {
    std::array::from_fn(|r| std::array::from_fn(|c| a[c][r]))
}

/// c -= a b.
fn less_product<const W: usize>(c: &mut Block<W>, a: &Block<W>, b: &Block<W>) {
    for (line, of) in c.iter_mut().zip(a) {
        let mut sum = *line;
        for (v, other) in of.iter().zip(b) {
            (0..W).for_each(|k| sum[k] -= v * other[k]);
        }
        *line = sum;
    }
}

struct Pivots {
    least: f64,
    smallest: f64,
    largest: f64,
    pinned: Vec<(usize, usize)>,
}

impl Pivots {
    /// Factors the column's own block and divides the others by it. A pinned column gets an infinite pivot: whatever
    /// is divided by it is 0.
    fn close<const W: usize>(&mut self, column: usize, own: &mut [Block<W>]) {
        for c in 0..W {
            let before: f64 = (0..c).map(|k| own[0][c][k] * own[0][c][k]).sum();
            let pivot = own[0][c][c] - before;
            let root = if pivot > self.least {
                (self.smallest, self.largest) = (self.smallest.min(pivot), self.largest.max(pivot));
                pivot.sqrt()
            } else {
                self.pinned.push((column, c));
                f64::INFINITY
            };
            own[0][c][c] = root;
            for r in c + 1..W {
                let before: f64 = (0..c).map(|k| own[0][r][k] * own[0][c][k]).sum();
                own[0][r][c] = (own[0][r][c] - before) / root;
            }
        }
        let (diagonal, below) = own.split_at_mut(1);
        below.iter_mut().flatten().for_each(|line| *line = forward(&diagonal[0], *line));
    }
}

/// Solves L z = b, L the lower triangle.
fn forward<const W: usize>(l: &Block<W>, mut b: [f64; W]) -> [f64; W] {
    for (r, line) in l.iter().enumerate() {
        let before: f64 = (0..r).map(|k| line[k] * b[k]).sum();
        b[r] = (b[r] - before) / line[r];
    }
    b
}

/// Solves L^T x = z.
fn backward<const W: usize>(l: &Block<W>, mut z: [f64; W]) -> [f64; W] {
    for r in (0..W).rev() {
        let after: f64 = (r + 1..W).map(|k| l[k][r] * z[k]).sum();
        z[r] = (z[r] - after) / l[r][r];
    }
    z
}
