//! Takes f64 numbers; gives exact arithmetic on them modulo the prime 2^61 - 1.
//!
//! Every finite f64 is an integer times a power of two, so it has an exact image. A rank found here is a lower bound
//! of the rank over the rationals: sound for "full rank", not for "deficient".

const P: u64 = (1 << 61) - 1;

/// A residue modulo 2^61 - 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Residue(u64);

pub const ZERO: Residue = Residue(0);

impl Residue {
    /// The exact image of a finite number.
    pub fn of(v: f64) -> Residue {
        let bits = v.to_bits();
        let raw = (bits >> 52 & 0x7ff) as i64;
        let mantissa = bits & ((1 << 52) - 1);
        let (m, e) = if raw == 0 { (mantissa, -1074) } else { (mantissa | 1 << 52, raw - 1075) };
        // 2^61 = 1 modulo P, so exponents count modulo 61.
        let size = Residue(m).times(Residue(1 << e.rem_euclid(61)));
        if v < 0.0 { ZERO.minus(size) } else { size }
    }

    pub fn times(self, o: Residue) -> Residue {
        let wide = u128::from(self.0) * u128::from(o.0);
        Residue(reduce((wide & u128::from(P)) as u64 + (wide >> 61) as u64))
    }

    pub fn minus(self, o: Residue) -> Residue {
        Residue(reduce(self.0 + P - o.0))
    }

    /// The inverse, by Fermat; 0 for 0.
    fn inverse(self) -> Residue {
        let (mut result, mut base, mut e) = (Residue(1), self, P - 2);
        while e > 0 {
            if e & 1 == 1 {
                result = result.times(base);
            }
            base = base.times(base);
            e >>= 1;
        }
        result
    }
}

fn reduce(v: u64) -> u64 {
    if v >= P { v - P } else { v }
}

/// Rank over the field, by elimination; stops as soon as it is full.
pub fn rank(rows: impl Iterator<Item = Vec<Residue>>, columns: usize) -> usize {
    independent(rows, columns).len()
}

/// Which rows are independent of those before them, over the field; stops as soon as the rank is full.
pub fn independent(rows: impl Iterator<Item = Vec<Residue>>, columns: usize) -> Vec<usize> {
    // A reduced row for each pivot column, leading coefficient 1.
    let mut basis: Vec<Option<Vec<Residue>>> = vec![None; columns];
    let mut chosen = Vec::new();
    for (k, mut row) in rows.enumerate() {
        for c in 0..columns {
            if row[c] == ZERO {
                continue;
            }
            if let Some(pivot) = &basis[c] {
                let by = row[c];
                (c..columns).for_each(|k| row[k] = row[k].minus(by.times(pivot[k])));
            } else {
                let by = row[c].inverse();
                basis[c] = Some(row.iter().map(|v| v.times(by)).collect());
                chosen.push(k);
                break;
            }
        }
        if chosen.len() == columns {
            break;
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_are_exact() {
        let third = 1.0 / 3.0;
        assert_eq!(Residue::of(0.75).times(Residue::of(4.0)), Residue::of(3.0));
        assert_eq!(ZERO.minus(Residue::of(-2.5)), Residue::of(2.5));
        // 3 * fl(1/3) is not 1: the image is of the number as it is.
        assert_ne!(Residue::of(third).times(Residue::of(3.0)), Residue::of(1.0));
        assert_eq!(Residue::of(5e-324).times(Residue::of(2.0)), Residue::of(1e-323));
    }

    #[test]
    fn rank_of_a_dependent_row_does_not_count() {
        let row = |v: [f64; 3]| v.map(Residue::of).to_vec();
        let rows = [row([1.0, 2.0, 3.0]), row([0.1, 0.2, 0.3]), row([2.0, 4.0, 6.0])];
        // 0.1, 0.2, 0.3 are not in the ratio 1 : 2 : 3 as f64.
        assert_eq!(rank(rows.iter().cloned(), 3), 2);
        assert_eq!(rank([rows[0].clone(), rows[2].clone()].into_iter(), 3), 1);
    }
}
