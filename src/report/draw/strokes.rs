//! Takes a line of text; gives it as strokes of a pen, in the size of its letters.
//!
//! Promised: no font is read. Not promised: more than the letters, digits and signs of the table; others are an empty
//! box.

/// Width of the pen in the size of the letters.
pub const PEN: f64 = 0.085;

/// Units of the table in the size of the letters: capitals are six units and 0.72 of the size high, as in common fonts.
const UNIT: f64 = 0.72 / 6.0;

/// Height of the baseline in the table.
const BASE: f64 = 2.0;

/// Units between letters.
const GAP: f64 = 1.7;

/// Strokes of each sign: points as x, y from its lower left corner, y = 2 the baseline, 6 the height of an x, 8 of an X.
const TABLE: [(char, &str); 79] = [
    (' ', ""),
    ('0', "12 03 07 18 38 47 43 32 12"),
    ('1', "06 28 22;12 32"),
    ('2', "07 18 38 47 46 02 42"),
    ('3', "07 18 38 47 46 35 25;35 44 43 32 12 03"),
    ('4', "32 38 04 44"),
    ('5', "48 08 05 35 44 43 32 12 03"),
    ('6', "47 38 18 07 03 12 32 43 44 35 15 04"),
    ('7', "08 48 12"),
    ('8', "15 06 07 18 38 47 46 35 15 04 03 12 32 43 44 35"),
    ('9', "03 12 32 43 47 38 18 07 06 15 35 46"),
    ('a', "06 36 45 42;44 14 03 12 32 43"),
    ('b', "08 02;05 16 36 45 43 32 12 03"),
    ('c', "45 36 16 05 03 12 32 43"),
    ('d', "48 42;45 36 16 05 03 12 32 43"),
    ('e', "04 44 45 36 16 05 03 12 32 43"),
    ('f', "38 28 17 12;06 36"),
    ('g', "46 41 30 10;45 36 16 05 03 12 32 43"),
    ('h', "08 02;05 16 36 45 42"),
    ('i', "02 06;08 08"),
    ('j', "16 11 00;18 18"),
    ('k', "08 02;36 04 32"),
    ('l', "08 03 12"),
    ('m', "06 02;05 16 26 35 32;35 46 56 65 62"),
    ('n', "06 02;05 16 36 45 42"),
    ('o', "05 16 36 45 43 32 12 03 05"),
    ('p', "06 00;05 16 36 45 43 32 12 03"),
    ('q', "46 40;45 36 16 05 03 12 32 43"),
    ('r', "06 02;05 16 36"),
    ('s', "45 36 16 05 14 34 43 32 12 03"),
    ('t', "18 13 22 32;06 36"),
    ('u', "06 03 12 32 43;46 42"),
    ('v', "06 22 46"),
    ('w', "06 12 36 52 66"),
    ('x', "06 42;02 46"),
    ('y', "06 22;46 10 00"),
    ('z', "06 46 02 42"),
    ('A', "02 28 42;14 34"),
    ('B', "02 08 38 47 46 35 05;35 44 43 32 02"),
    ('C', "47 38 18 07 03 12 32 43"),
    ('D', "02 08 28 46 44 22 02"),
    ('E', "48 08 02 42;05 35"),
    ('F', "48 08 02;05 35"),
    ('G', "47 38 18 07 03 12 32 43 45 25"),
    ('H', "08 02;48 42;05 45"),
    ('I', "02 08"),
    ('J', "48 43 32 12 03"),
    ('K', "08 02;48 05;15 42"),
    ('L', "08 02 42"),
    ('M', "02 08 35 68 62"),
    ('N', "02 08 42 48"),
    ('O', "18 38 47 43 32 12 03 07 18"),
    ('P', "02 08 38 47 46 35 05"),
    ('Q', "18 38 47 43 32 12 03 07 18;24 42"),
    ('R', "02 08 38 47 46 35 05;25 42"),
    ('S', "47 38 18 07 06 15 35 44 43 32 12 03"),
    ('T', "08 48;28 22"),
    ('U', "08 03 12 32 43 48"),
    ('V', "08 22 48"),
    ('W', "08 12 36 52 68"),
    ('X', "08 42;02 48"),
    ('Y', "08 25 48;25 22"),
    ('Z', "08 48 02 42"),
    ('[', "18 08 01 11"),
    (']', "08 18 11 01"),
    ('(', "18 06 03 11"),
    (')', "08 16 13 01"),
    (',', "12 01"),
    ('.', "02 02"),
    (':', "02 02;05 05"),
    (';', "12 01;15 15"),
    ('-', "04 34"),
    ('+', "04 44;22 26"),
    ('=', "05 45;03 43"),
    ('/', "01 48"),
    ('?', "07 18 38 47 46 25 24;22 22"),
    ('<', "46 04 42"),
    ('>', "06 44 02"),
    ('\'', "08 07"),
];

const UNKNOWN: &str = "02 08 48 42 02";

/// Units a space is wide.
const SPACE: f64 = 1.5;

fn strokes(sign: char) -> &'static str {
    TABLE.iter().find(|(c, _)| *c == sign).map_or(UNKNOWN, |(_, s)| s)
}

fn points(stroke: &str) -> impl Iterator<Item = [f64; 2]> + '_ {
    let digit = |b: u8| f64::from(b.saturating_sub(b'0'));
    stroke.split_whitespace().map(move |p| match *p.as_bytes() {
        [x, y] => [digit(x), digit(y) - BASE],
        _ => [0.0, 0.0],
    })
}

/// Units from one sign to the next.
fn advance(sign: char) -> f64 {
    let widest = strokes(sign).split(';').flat_map(points).map(|p| p[0]).fold(0.0, f64::max);
    GAP + if sign == ' ' { SPACE } else { widest }
}

/// Width of a line in the size of its letters.
pub fn width(text: &str) -> f64 {
    let all: f64 = text.chars().map(advance).sum();
    (all - GAP).max(0.0) * UNIT
}

/// The strokes of a line that starts at 0 on the baseline, y up, in the size of its letters.
pub fn of(text: &str) -> Vec<Vec<[f64; 2]>> {
    let mut from = 0.0;
    let mut all = Vec::new();
    for sign in text.chars() {
        let own =
            strokes(sign).split(';').map(|s| points(s).map(|[x, y]| [(from + x) * UNIT, y * UNIT]).collect());
        all.extend(own.filter(|s: &Vec<[f64; 2]>| !s.is_empty()));
        from += advance(sign);
    }
    all
}
