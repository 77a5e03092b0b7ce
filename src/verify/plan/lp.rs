//! Takes a small linear program with a known vertex, gives an upper bound on its maximum that can be checked by adding up.
//!
//! Maximize the last variable over `a . x <= b`. Vertices are walked by the simplex method on the rows themselves
//! (five active at a time), with Bland's rule once the value stalls, so it ends. Sound whatever the walk did: the
//! bound is computed from non-negative multipliers by weak duality, and what they fail to cancel is added at its worst.

/// Variables: x, y, z, time, radius.
pub const SIZE: usize = 5;

pub type Row = ([f64; SIZE], f64);
type Square = [[f64; SIZE]; SIZE];

/// Rounds before giving up; programs of 40 rows take about 10.
const MOST_ROUNDS: usize = 300;

/// Rounds by steepest multiplier before Bland's rule.
const FREE_ROUNDS: usize = 60;

/// Round-off of a multiplier: rows are unit vectors and bases of five of them lose at most about half the digits.
const MULTIPLIER_ROUND_OFF: f64 = 1e-9;

/// Round-off of a rate between unit rows.
const RATE_ROUND_OFF: f64 = 1e-12;

/// A certified answer: no feasible point has a larger last variable than `bound`; `at` is the vertex reached.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    pub bound: f64,
    pub at: [f64; SIZE],
    /// The rows that carry the bound, and how much of it each.
    pub rests_on: [usize; SIZE],
    pub weights: [f64; SIZE],
}

/// Starts at the vertex where `active` rows hold with equality. `reach` bounds every variable's absolute value.
/// None when no optimum was reached.
pub fn maximize_last(rows: &[Row], mut active: [usize; SIZE], reach: f64) -> Option<Bound> {
    for round in 0..MOST_ROUNDS {
        let inverse = invert(&active.map(|k| rows[k].0))?;
        let at = vertex(&inverse, &active.map(|k| rows[k].1));
        let weights = inverse.map(|r| r[..].to_owned());
        let weights: [f64; SIZE] = std::array::from_fn(|k| weights[SIZE - 1][k]);
        let Some(out) = leaving(&weights, &active, round >= FREE_ROUNDS) else {
            return Some(Bound {
                bound: weak_duality(rows, &active, &weights, reach),
                at,
                rests_on: active,
                weights,
            });
        };
        let way: [f64; SIZE] = std::array::from_fn(|k| -inverse[k][out]);
        active[out] = entering(rows, &active, &at, &way)?;
    }
    None
}

/// The active row to leave: most negative multiplier, or (Bland) the first row with a negative one.
fn leaving(weights: &[f64; SIZE], active: &[usize; SIZE], bland: bool) -> Option<usize> {
    let negative = (0..SIZE).filter(|&k| weights[k] < -MULTIPLIER_ROUND_OFF);
    if bland {
        negative.min_by_key(|&k| active[k])
    } else {
        negative.min_by(|&a, &b| weights[a].total_cmp(&weights[b]))
    }
}

/// The first row met on the way; in a tie the one with the lowest index.
fn entering(rows: &[Row], active: &[usize; SIZE], at: &[f64; SIZE], way: &[f64; SIZE]) -> Option<usize> {
    let mut best: Option<(f64, usize)> = None;
    for (k, (a, b)) in rows.iter().enumerate() {
        let rate = dot(a, way);
        if rate <= RATE_ROUND_OFF || active.contains(&k) {
            continue;
        }
        let step = ((b - dot(a, at)) / rate).max(0.0);
        if best.is_none_or(|(s, _)| step < s) {
            best = Some((step, k));
        }
    }
    best.map(|(_, k)| k)
}

fn weak_duality(rows: &[Row], active: &[usize; SIZE], weights: &[f64; SIZE], reach: f64) -> f64 {
    let mut left = [0.0; SIZE];
    left[SIZE - 1] = 1.0;
    let mut bound = 0.0;
    for (&k, &w) in active.iter().zip(weights) {
        let w = w.max(0.0);
        bound += w * rows[k].1;
        for (l, a) in left.iter_mut().zip(&rows[k].0) {
            *l -= w * a;
        }
    }
    bound + left.iter().map(|l| l.abs() * reach).sum::<f64>()
}

fn dot(a: &[f64; SIZE], b: &[f64; SIZE]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn vertex(inverse: &Square, b: &[f64; SIZE]) -> [f64; SIZE] {
    inverse.map(|row| dot(&row, b))
}

/// Gauss and Jordan with row pivots; None when singular.
fn invert(m: &Square) -> Option<Square> {
    let mut a = *m;
    let mut inverse: Square = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for c in 0..SIZE {
        let p = (c..SIZE).max_by(|&i, &j| a[i][c].abs().total_cmp(&a[j][c].abs()))?;
        if a[p][c] == 0.0 {
            return None;
        }
        a.swap(c, p);
        inverse.swap(c, p);
        let scale = 1.0 / a[c][c];
        a[c] = a[c].map(|x| x * scale);
        inverse[c] = inverse[c].map(|x| x * scale);
        for r in (0..SIZE).filter(|&r| r != c) {
            let f = a[r][c];
            for k in 0..SIZE {
                a[r][k] -= f * a[c][k];
                inverse[r][k] -= f * inverse[c][k];
            }
        }
    }
    Some(inverse)
}
