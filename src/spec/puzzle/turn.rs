//! Takes the index of a turn as puzzle files count them; gives its matrix.
//!
//! Turn k is a quarter turn about x done k mod 4 times, then one of six: nothing, one to three quarter turns about y, one
//! or three about z. A quarter turn takes y to z about x, z to -x... of each axis as [`QUARTERS`] says. 24 to 47 are the
//! same after mirroring x. (Facts from BurrTools' table `tabs_0/rotmatrix.inc`; tests hold the order against it.)

/// Proper turns.
pub const TURNS: usize = 24;

/// Turns after a mirror.
pub const MIRRORED: usize = 24;

/// Rows first.
pub type Matrix = [[i32; 3]; 3];

const NONE: Matrix = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/// A quarter turn about x (y to z), about y (x to z), about z (x to y).
const QUARTERS: [Matrix; 3] = [
    [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
    [[0, 0, -1], [0, 1, 0], [1, 0, 0]],
    [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
];

const MIRROR_X: Matrix = [[-1, 0, 0], [0, 1, 0], [0, 0, 1]];

/// The matrix of turn `k`, below 48.
pub fn matrix(k: usize) -> Matrix {
    let [x, y, z] = QUARTERS;
    let outer = match k % TURNS / 4 {
        5 => power(z, 3),
        4 => z,
        n => power(y, n),
    };
    let turn = times(outer, power(x, k % 4));
    if k < TURNS { turn } else { times(turn, MIRROR_X) }
}

pub fn times(a: Matrix, b: Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn power(m: Matrix, n: usize) -> Matrix {
    (0..n).fold(NONE, |all, _| times(m, all))
}

pub fn apply(m: Matrix, v: [i32; 3]) -> [i32; 3] {
    m.map(|row| (0..3).map(|k| row[k] * v[k]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn determinant(m: Matrix) -> i32 {
        let minor = |a: usize, b: usize| m[1][a] * m[2][b] - m[1][b] * m[2][a];
        m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1)
    }

    #[test]
    fn there_are_24_turns_and_24_mirrored_ones_all_different() {
        let all: BTreeSet<Matrix> = (0..48).map(matrix).collect();
        assert_eq!(all.len(), 48);
        assert!((0..24).all(|k| determinant(matrix(k)) == 1));
        assert!((24..48).all(|k| determinant(matrix(k)) == -1));
    }

    /// Where (1, 2, 3) goes by turns 0 to 23, worked out by hand from BurrTools' table of rotations.
    #[test]
    fn turns_are_counted_as_puzzle_files_count_them() {
        let goes = [
            [1, 2, 3],
            [1, -3, 2],
            [1, -2, -3],
            [1, 3, -2],
            [-3, 2, 1],
            [-2, -3, 1],
            [3, -2, 1],
            [2, 3, 1],
            [-1, 2, -3],
            [-1, -3, -2],
            [-1, -2, 3],
            [-1, 3, 2],
            [3, 2, -1],
            [2, -3, -1],
            [-3, -2, -1],
            [-2, 3, -1],
            [-2, 1, 3],
            [3, 1, 2],
            [2, 1, -3],
            [-3, 1, -2],
            [2, -1, 3],
            [-3, -1, 2],
            [-2, -1, -3],
            [3, -1, -2],
        ];
        for (k, to) in goes.into_iter().enumerate() {
            assert_eq!(apply(matrix(k), [1, 2, 3]), to, "turn {k}");
            assert_eq!(apply(matrix(k + 24), [-1, 2, 3]), to, "turn {k} mirrored");
        }
    }
}
