//! Takes f64 numbers; gives exact sums and products of them.
//!
//! Every finite f64 is an integer times a power of two, and so is every sum and product of such: nothing here rounds
//! but [`Dyadic::size_above`], which rounds away from 0. Not promised: quotients.

use dashu_int::ops::BitTest;
use dashu_int::{IBig, Sign, UBig};
use std::cmp::Ordering;

/// The number m 2^e.
#[derive(Clone, Debug)]
pub struct Dyadic {
    m: IBig,
    e: i64,
}

impl Dyadic {
    pub fn zero() -> Dyadic {
        Dyadic { m: IBig::ZERO, e: 0 }
    }

    /// A finite number exactly; callers refuse what is not finite.
    pub fn of(v: f64) -> Dyadic {
        let bits = v.to_bits();
        let raw = (bits >> 52 & 0x7ff) as i64;
        let mantissa = bits & ((1 << 52) - 1);
        let (m, e) = if raw == 0 { (mantissa, -1074) } else { (mantissa | 1 << 52, raw - 1075) };
        let m = if v < 0.0 { -IBig::from(m) } else { IBig::from(m) };
        if m.is_zero() { Dyadic::zero() } else { Dyadic { m, e } }
    }

    pub fn plus(self, o: &Dyadic) -> Dyadic {
        // A zero's exponent says nothing, and aligning to it would cost digits.
        if o.m.is_zero() || self.m.is_zero() {
            return if o.m.is_zero() { self } else { o.clone() };
        }
        let e = self.e.min(o.e);
        let m = (self.m << (self.e - e) as usize) + (&o.m << (o.e - e) as usize);
        Dyadic { m, e }
    }

    pub fn minus(self, o: &Dyadic) -> Dyadic {
        self.plus(&Dyadic { m: -&o.m, e: o.e })
    }

    pub fn times(&self, o: &Dyadic) -> Dyadic {
        Dyadic { m: &self.m * &o.m, e: self.e + o.e }
    }

    /// Against 0.
    pub fn sign(&self) -> Ordering {
        self.m.cmp(&IBig::ZERO)
    }

    /// The integer m 2^(e - to), for an exponent `to` that is not above any in use.
    pub fn scaled(&self, to: i64) -> IBig {
        if self.m.is_zero() { IBig::ZERO } else { &self.m << (self.e - to).max(0) as usize }
    }

    pub fn integer(m: IBig) -> Dyadic {
        Dyadic { m, e: 0 }
    }

    /// Times 2^by.
    pub fn shifted(self, by: i64) -> Dyadic {
        Dyadic { e: self.e + by, ..self }
    }

    /// The power of two next above the size.
    pub fn magnitude(&self) -> i64 {
        self.e + self.m.clone().into_parts().1.bit_len() as i64
    }

    /// Nearly the number, within two units of round-off; 0 or infinite out of range.
    pub fn value(&self) -> f64 {
        let (sign, size): (Sign, UBig) = self.m.clone().into_parts();
        let cut = size.bit_len().saturating_sub(64);
        let e = self.e + cut as i64;
        let near = (size >> cut).to_f64().value() * power(e / 2) * power(e - e / 2);
        if sign == Sign::Negative { -near } else { near }
    }

    pub fn exponent(&self) -> i64 {
        if self.m.is_zero() { i64::MAX } else { self.e }
    }

    /// Absolute value, rounded up: off by at most one part in 2^50 and one subnormal step.
    pub fn size_above(&self) -> f64 {
        let (_, size): (Sign, UBig) = self.m.clone().into_parts();
        let cut = size.bit_len().saturating_sub(64);
        let top: UBig = (size >> cut) + UBig::ONE;
        if self.m.is_zero() {
            return 0.0;
        }
        let e = self.e + cut as i64;
        let half = power(e / 2);
        top.to_f64().value() * half * power(e - e / 2) * (1.0 + 2f64.powi(-50)) + f64::MIN_POSITIVE
    }
}

/// 2^e; 0 or infinite beyond the range.
fn power(e: i64) -> f64 {
    2f64.powi(e.clamp(-2000, 2000) as i32)
}

/// a . b of three numbers each.
pub fn dot(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> Dyadic {
    (0..3).fold(Dyadic::zero(), |sum, k| sum.plus(&a[k].times(&b[k])))
}

pub fn cross(a: &[Dyadic; 3], b: &[Dyadic; 3]) -> [Dyadic; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| a[i].times(&b[j]).minus(&a[j].times(&b[i])))
}

pub fn vector(v: glam::DVec3) -> [Dyadic; 3] {
    v.to_array().map(Dyadic::of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_products_do_not_round() {
        let [tenth, one, tiny] = [0.1, 1.0, 5e-324].map(Dyadic::of);
        let ten = Dyadic::of(10.0);
        // 10 * fl(0.1) is above 1 by less than a unit of round-off: f64 cannot tell.
        let over = ten.times(&tenth).minus(&one);
        assert_eq!(over.sign(), Ordering::Greater);
        assert!(over.size_above() < 1e-15 && over.size_above() > 1e-17);
        assert_eq!(one.clone().plus(&tiny).minus(&one).minus(&tiny).sign(), Ordering::Equal);
        assert_eq!(one.plus(&tiny).minus(&Dyadic::of(1.0)).sign(), Ordering::Greater);
    }

    #[test]
    fn sizes_are_rounded_up() {
        for v in [1.0, -3.5, 1e300, -1e-310, 0.3] {
            let size = Dyadic::of(v).size_above();
            assert!(size >= v.abs() && size <= v.abs() * (1.0 + 1e-14) + 1e-300, "{v}: {size}");
        }
        assert_eq!(Dyadic::zero().size_above(), 0.0);
        let small = Dyadic::of(1e-200).times(&Dyadic::of(1e-200));
        assert!(small.size_above() > 0.0, "a product below the range keeps its size");
    }
}
