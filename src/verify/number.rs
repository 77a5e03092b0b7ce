//! Takes f64 numbers; gives sums, products, quotients and roots in f64 or in twice its digits, with the error of each.
//!
//! Every operation is right up to a relative [`Number::ROUND_OFF`] unless it underflows (callers scale to about 1).
//! Twice the digits: a pair high + low (Dekker 1971; bounds after Joldes, Muller and Popescu 2017: at most 10 units of
//! 2^-106 for each of the operations used).

/// Operations on a term of a [`Number::dot`] beyond the number of terms: its product, and joining the partial sums.
pub const EXTRA: usize = 12;

/// A number with a bound on the relative error of each operation.
pub trait Number: Copy {
    const ROUND_OFF: f64;
    fn of(v: f64) -> Self;
    /// Product of two f64.
    fn product(a: f64, b: f64) -> Self;
    fn plus(self, o: Self) -> Self;
    fn times(self, o: Self) -> Self;
    fn over(self, o: Self) -> Self;
    fn root(self) -> Self;
    fn negated(self) -> Self;
    /// The nearest f64.
    fn value(self) -> f64;

    /// Sum of products, in any order: each term passes through at most [`EXTRA`] operations more than there are terms.
    fn dot(a: &[Self], b: &[Self]) -> Self {
        a.iter().zip(b).fold(Self::of(0.0), |sum, (&x, &y)| sum.plus(x.times(y)))
    }
}

impl Number for f64 {
    const ROUND_OFF: f64 = f64::EPSILON / 2.0;

    fn of(v: f64) -> f64 {
        v
    }
    fn product(a: f64, b: f64) -> f64 {
        a * b
    }
    fn plus(self, o: f64) -> f64 {
        self + o
    }
    fn times(self, o: f64) -> f64 {
        self * o
    }
    fn over(self, o: f64) -> f64 {
        self / o
    }
    fn root(self) -> f64 {
        self.sqrt()
    }
    fn negated(self) -> f64 {
        -self
    }
    fn value(self) -> f64 {
        self
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
}

/// high + low, low at most half a unit in the last place of high.
#[derive(Clone, Copy, Debug)]
pub struct Twofold {
    high: f64,
    low: f64,
}

/// a + b exactly.
fn sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// a + b exactly, for |a| >= |b| or a = 0.
fn quick(a: f64, b: f64) -> Twofold {
    let high = a + b;
    Twofold { high, low: b - (high - a) }
}

/// v in two halves of 26 bits (Veltkamp).
fn halves(v: f64) -> (f64, f64) {
    let t = v * 134_217_729.0;
    let high = t - (t - v);
    (high, v - high)
}

/// a b exactly, unless it underflows (Dekker).
fn product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    let ((ah, al), (bh, bl)) = (halves(a), halves(b));
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

impl Number for Twofold {
    /// 64 units of 2^-106: six times what the worst operation needs.
    const ROUND_OFF: f64 = 1.0 / (1u128 << 100) as f64;

    fn of(v: f64) -> Twofold {
        Twofold { high: v, low: 0.0 }
    }
    fn product(a: f64, b: f64) -> Twofold {
        let (high, low) = product(a, b);
        Twofold { high, low }
    }
    fn plus(self, o: Twofold) -> Twofold {
        let (s, e) = sum(self.high, o.high);
        let (t, f) = sum(self.low, o.low);
        let first = quick(s, e + t);
        quick(first.high, first.low + f)
    }
    fn times(self, o: Twofold) -> Twofold {
        let (p, e) = product(self.high, o.high);
        quick(p, e + (self.high * o.low + self.low * o.high))
    }
    fn over(self, o: Twofold) -> Twofold {
        // One quotient, then two corrections by what is left.
        let first = self.high / o.high;
        let left = self.plus(o.times(Twofold::of(first)).negated());
        let second = left.high / o.high;
        let left = left.plus(o.times(Twofold::of(second)).negated());
        let third = left.high / o.high;
        quick(first, second).plus(Twofold::of(third))
    }
    fn root(self) -> Twofold {
        let first = self.high.sqrt();
        if first == 0.0 {
            return Twofold::of(0.0);
        }
        // Two Newton steps: the first leaves about 2^-104 of error, the second what its own operations make.
        let step = |x: Twofold| {
            let left = self.plus(x.times(x).negated());
            x.plus(left.over(x.plus(x)))
        };
        step(step(Twofold::of(first)))
    }
    fn negated(self) -> Twofold {
        Twofold { high: -self.high, low: -self.low }
    }
    fn value(self) -> f64 {
        self.high
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::dyadic::Dyadic;

    fn exact(t: Twofold) -> Dyadic {
        Dyadic::of(t.high).plus(&Dyadic::of(t.low))
    }

    /// Operations on thousands of seeded pairs against exact arithmetic.
    #[test]
    fn operations_keep_their_bound() {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let v = (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
            v * 2f64.powi((seed % 40) as i32 - 20)
        };
        let bound = |off: &Dyadic, of: &Dyadic| off.size_above() <= of.size_above() * Twofold::ROUND_OFF;
        for _ in 0..5000 {
            let a = quick_pair(next(), next());
            let b = quick_pair(next(), next());
            let (x, y) = (exact(a), exact(b));
            let s = x.clone().plus(&y);
            assert!(bound(&exact(a.plus(b)).minus(&s), &s), "{a:?} + {b:?}");
            let p = x.times(&y);
            assert!(bound(&exact(a.times(b)).minus(&p), &p), "{a:?} * {b:?}");
            let back = exact(a.over(b)).times(&y);
            assert!(bound(&back.minus(&x), &x), "{a:?} / {b:?}");
            let square = Twofold { high: a.high.abs(), low: if a.high < 0.0 { -a.low } else { a.low } };
            let root = exact(square.root());
            let back = root.times(&root).minus(&exact(square));
            assert!(back.size_above() <= 2.0 * x.size_above() * Twofold::ROUND_OFF, "root of {a:?}");
        }
    }

    fn quick_pair(a: f64, b: f64) -> Twofold {
        let (high, low) = sum(a, b * 1e-17);
        Twofold { high, low }
    }
}
