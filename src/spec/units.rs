//! Takes a length or a share as a string with its unit; gives millimetres or percent, or what is wrong.
//!
//! Not promised: that the value is sensible; the caller knows its bounds.

/// Units of length and their millimetres; the first six may stand in a file, `um` with either of Unicode's two signs.
const LENGTHS: [(&str, f64); 7] = [
    ("mm", 1.0),
    ("cm", 10.0),
    ("m", 1000.0),
    ("in", 25.4),
    ("um", 1e-3),
    ("\u{b5}m", 1e-3),
    ("\u{3bc}m", 1e-3),
];

/// What is wrong with a quantity: what, and a hint.
pub type Wrong = (String, String);

/// Millimetres of a length such as `20 mm`.
pub fn millimetres(text: &str) -> Result<f64, Wrong> {
    let (number, unit) = parted(text);
    let factor = LENGTHS.iter().find(|(name, _)| *name == unit).map(|(_, factor)| factor);
    let hint = "a length is a number and one of mm, cm, m, in, um, as in \"20 mm\"";
    match (quantity(number), factor) {
        (Some(value), Some(factor)) => Ok(value * factor),
        (_, None) if unit.is_empty() => Err((format!("{text:?} has no unit"), hint.into())),
        (_, None) => Err((format!("{unit:?} is not a unit of length"), hint.into())),
        (None, _) => Err((format!("{number:?} is not a number"), hint.into())),
    }
}

/// Percent of a share such as `0.2 %`.
pub fn percent(text: &str) -> Result<f64, Wrong> {
    let value = text.trim().strip_suffix('%').and_then(|number| quantity(number.trim()));
    let hint = "a share is a number and a percent sign, as in \"0.2 %\"".to_string();
    value.ok_or_else(|| (format!("{text:?} is not a share"), hint))
}

/// Millimetres of a bare unit of length.
pub fn unit(text: &str) -> Option<f64> {
    LENGTHS.iter().find(|(name, _)| *name == text).map(|(_, factor)| *factor)
}

/// The number and the unit behind it: the letters at the end.
fn parted(text: &str) -> (&str, &str) {
    let text = text.trim();
    let number = text.trim_end_matches(char::is_alphabetic);
    (number.trim_end(), &text[number.len()..])
}

fn quantity(number: &str) -> Option<f64> {
    number.parse().ok().filter(|value: &f64| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_in_every_unit() {
        let good = [("20 mm", 20.0), ("2cm", 20.0), ("0.02 m", 20.0), (" 1 in ", 25.4), ("1e3 um", 1.0)];
        for (text, mm) in
            good.into_iter().chain([("5 \u{b5}m", 0.005), ("5\u{3bc}m", 0.005), ("-1 mm", -1.0)])
        {
            assert_eq!(millimetres(text), Ok(mm), "{text}");
        }
        for text in
            ["", "20", "mm", "20 ft", "1,5 mm", "inf mm", "nan mm", "infmm", "1 m m", "20 MM", "1e999 mm"]
        {
            assert!(millimetres(text).is_err(), "{text}");
        }
    }

    #[test]
    fn shares_need_their_sign() {
        assert_eq!(percent("50 %"), Ok(50.0));
        assert_eq!(percent("0.25%"), Ok(0.25));
        for text in ["", "%", "0.2", "0.2 %%", "nan %", "inf%"] {
            assert!(percent(text).is_err(), "{text}");
        }
    }
}
