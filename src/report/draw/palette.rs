//! Takes nothing, gives colours that stay apart for every kind of colour vision.
//!
//! Wefts are warm and wefts only, warps cool: orange against blue is the pair that deuteranopes, protanopes and
//! tritanopes all tell apart; neighbours of one family differ in lightness. Not promised: more than four shades each.

/// Linear light, each channel in 0..=1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour(pub [f64; 3]);

impl Colour {
    /// From the bytes that colour pickers and style sheets speak of.
    pub fn srgb(rgb: [u8; 3]) -> Colour {
        Colour(rgb.map(|c| decode(f64::from(c) / 255.0)))
    }

    pub(super) fn scaled(self, light: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|k| self.0[k] * light[k])
    }
}

pub const WARM: [[u8; 3]; 4] = [[230, 159, 0], [205, 88, 24], [247, 203, 110], [148, 62, 20]];
pub const COOL: [[u8; 3]; 4] = [[86, 164, 214], [22, 92, 152], [166, 210, 236], [28, 58, 104]];
pub const OTHER: [[u8; 3]; 8] = [
    [230, 159, 0],
    [86, 164, 214],
    [0, 138, 102],
    [240, 214, 90],
    [22, 92, 152],
    [205, 88, 24],
    [196, 130, 172],
    [150, 152, 150],
];
/// Lines, in nearly black.
pub const INK: [u8; 3] = [26, 26, 32];
pub const FORCE: [u8; 3] = [190, 20, 84];
pub const MOTION: [u8; 3] = [0, 120, 90];

/// The colour of a part: warm for `weft-J`, cool for `warp-I` (the ids of woven assemblies), else by its place. Pieces
/// of one strand (`weft-J/N`) are two shades apart.
pub fn of_part(id: &str, place: usize) -> Colour {
    Colour::srgb(bytes_of_part(id, place))
}

/// The same as the bytes of a style sheet.
pub fn bytes_of_part(id: &str, place: usize) -> [u8; 3] {
    let pick = |table: &[[u8; 3]], k: i64| table[k.rem_euclid(table.len() as i64) as usize];
    match (strand(id, "weft-"), strand(id, "warp-")) {
        (Some((j, n)), _) => pick(&WARM, j.wrapping_add(n.wrapping_mul(2))),
        (_, Some((i, n))) => pick(&COOL, i.wrapping_add(n.wrapping_mul(2))),
        _ => pick(&OTHER, place as i64),
    }
}

/// Strand and piece of an id that starts with `prefix`.
fn strand(id: &str, prefix: &str) -> Option<(i64, i64)> {
    let rest = id.strip_prefix(prefix)?;
    let (strand, piece) = rest.split_once('/').unwrap_or((rest, "0"));
    Some((strand.parse().ok()?, piece.parse().ok()?))
}

/// IEC 61966-2-1, encoded to linear.
fn decode(c: f64) -> f64 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// IEC 61966-2-1, linear to a byte.
pub(super) fn encode(c: f64) -> u8 {
    let c = c.clamp(0.0, 1.0);
    let e = if c <= 0.003_130_8 { c * 12.92 } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
    (e * 255.0).round() as u8
}
