//! Takes the numerals of a file, tells how well the file knows its coordinates.
//!
//! Promised: no coordinate that was rounded the way its numerals look is off by more than what is given. Not
//! promised: that digits which are written were true before they were written.

use std::collections::BTreeMap;

/// Half a unit in the last place of single and of double precision, for numbers of size 1.
const SINGLE: f64 = f32::EPSILON as f64 / 2.0;
const DOUBLE: f64 = f64::EPSILON / 2.0;

/// Fewer significant digits than this do not tell a fixed number of them from round coordinates: C's `%g` and
/// C++ streams write six, and nothing in use writes fewer.
const FEWEST_SIGNIFICANT: i32 = 6;

/// What the numerals of one file have shown so far.
#[derive(Clone, Debug)]
pub(super) struct Digits {
    /// Half a unit in the last place of the finest numeral.
    finest: f64,
    /// Whether each number is one of single precision to the last bit.
    exact: bool,
    /// Whether each number is one of single precision as far as its digits tell.
    single: bool,
    /// How far the numbers are from those of single precision.
    aside: f64,
    reach: f64,
    /// By decade: most significant digits, finest half unit.
    decades: BTreeMap<i32, (i32, f64)>,
}

impl Default for Digits {
    fn default() -> Digits {
        Digits {
            finest: f64::INFINITY,
            exact: true,
            single: true,
            aside: 0.0,
            reach: 0.0,
            decades: BTreeMap::new(),
        }
    }
}

impl Digits {
    /// A number that was stored in single precision.
    pub fn note_single(&mut self, x: f32) {
        self.reach = self.reach.max(f64::from(x).abs());
    }

    /// A number in words; what is no number is passed over.
    pub fn note(&mut self, numeral: &str) {
        let Some(x) = numeral.parse::<f64>().ok().filter(|x| x.is_finite()) else { return };
        let half = half_unit(numeral);
        self.finest = self.finest.min(half);
        self.reach = self.reach.max(x.abs());
        self.exact &= x == f64::from(x as f32);
        let aside = (x - f64::from(x as f32)).abs();
        self.single &= aside <= half;
        self.aside = self.aside.max(aside);
        if x != 0.0 {
            let entry = self.decades.entry(x.abs().log10().floor() as i32).or_insert((0, f64::INFINITY));
            *entry = (entry.0.max(significant(numeral)), entry.1.min(half));
        }
    }

    /// By how much a coordinate may be off, in the file's own unit. What was stored in single precision and then
    /// written with no more digits than it has was rounded twice.
    pub fn resolution(&self) -> f64 {
        let stored = if self.single { SINGLE * self.reach + self.aside } else { DOUBLE * self.reach };
        if self.exact { stored } else { stored.max(self.written()) }
    }

    /// A fixed number of decimals is known by the finest numeral (others may have lost zeros at their ends); a
    /// fixed number of significant digits by the largest numbers, which are known worst.
    fn written(&self) -> f64 {
        let most = self.decades.values().map(|d| d.0).max().unwrap_or(0);
        match self.decades.last_key_value() {
            Some((_, &(digits, half))) if digits == most && most >= FEWEST_SIGNIFICANT => half,
            _ => self.finest,
        }
    }
}

/// Half a unit in the last place of a decimal numeral: `1.25` is known to 0.005, `3e-2` to 0.005.
fn half_unit(numeral: &str) -> f64 {
    let (mantissa, exponent) = split(numeral);
    let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len() as i32);
    0.5 * 10f64.powi(exponent.saturating_sub(decimals))
}

fn significant(numeral: &str) -> i32 {
    let digits = split(numeral).0.chars().filter(char::is_ascii_digit);
    digits.skip_while(|&c| c == '0').count() as i32
}

fn split(numeral: &str) -> (&str, i32) {
    match numeral.split_once(['e', 'E']) {
        Some((m, e)) => (m, e.parse::<i32>().unwrap_or(0)),
        None => (numeral, 0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resolution(numerals: &[&str]) -> f64 {
        let mut digits = Digits::default();
        numerals.iter().for_each(|s| digits.note(s));
        digits.resolution()
    }

    #[test]
    fn numerals_tell_how_well_they_are_known() {
        for (s, h) in [("1.25", 0.005), ("3e-2", 0.005), ("7", 0.5), ("-0.5000", 5e-5), ("1.5E+3", 50.0)] {
            assert!((half_unit(s) / h - 1.0).abs() < 1e-12, "{s}");
        }
    }

    #[test]
    fn fixed_decimals_are_told_from_significant_digits_and_single_precision() {
        let is = |numerals: &[&str], want: f64| {
            let got = resolution(numerals);
            assert!((got / want - 1.0).abs() < 1e-9, "{numerals:?}: {got}");
        };
        is(&["100", "0.1234"], 5e-5);
        is(&["100", "0.5"], SINGLE * 100.0);
        is(&["12.5000", "0.1234"], 5e-5);
        is(&["123.457", "0.00123457"], 5e-4);
        // Single precision, written with more digits than it has and with as many: rounded twice, by less than half a
        // unit of its own (SINGLE * 12.3 covers it) and to the words.
        let aside = |x: f64| (x - f64::from(x as f32)).abs();
        is(&["12.3456793", "0.100000001"], SINGLE * 12.3456793 + aside(12.3456793));
        is(&["12.345679", "0.1"], SINGLE * 12.345679 + aside(12.345679));
        is(&["12.345678901234567", "0.1"], DOUBLE * 12.345678901234567);
    }
}
