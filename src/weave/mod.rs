//! Takes `[a,b,c]`, a drawn draft or a WIF file; gives a checked draft: period, floats, family, does it hang together.
//!
//! Promised: a [`Draft`] is periodic both ways and stored at its least period. Not promised: that it is a fabric; one
//! that falls apart is a draft like any other (see [`hangs_together`]).

mod draft;
mod draw;
mod drawn;
mod family;
mod hanging;
mod ini;
mod svg;
mod wif;

pub use draft::Draft;
pub use draw::terminal;
pub use drawn::{DrawnFault, MAX_DRAFT, parse_drawn};
pub use family::{Family, Float, Floats, Hand, family, floats, wave};
pub use hanging::{Hanging, hangs_together};
pub use svg::svg;
pub use wif::{parse_wif, to_wif};

use crate::fault::{Fault, Faults, quoted};
use crate::input;
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// Which way a strand runs: wefts along x (rows of the draft), warps along y (its columns).
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Weft,
    Warp,
}

impl Kind {
    pub fn word(self) -> &'static str {
        match self {
            Kind::Weft => "weft",
            Kind::Warp => "warp",
        }
    }
}

/// Weft `j` is the strand y = j + 1/2, warp `i` the strand x = i + 1/2.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize)]
pub struct Strand {
    pub kind: Kind,
    pub index: i32,
}

impl fmt::Display for Strand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}", self.kind.word(), self.index)
    }
}

/// What the draft was made from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    Abc { a: u32, b: u32, c: i32 },
    Drawn,
    Wif(PathBuf),
}

/// A draft and where it comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Weave {
    pub draft: Draft,
    pub origin: Origin,
    /// Crossings in a unit tile of a weft, of a warp.
    pub tile: (u32, u32),
}

/// Longest run of overs or unders in `[a,b,c]`; a float of 64 crossings is far beyond what any cloth uses.
pub const MAX_RUN: u32 = 64;

impl Weave {
    /// The genus-1 weave in which weft `j` passes over warp `i` where `(i - c*j) mod (a + b) < a`.
    pub fn abc(a: u32, b: u32, c: i32) -> Result<Weave, Faults> {
        let wrong = [("a", a), ("b", b)].into_iter().filter(|&(_, v)| v == 0 || v > MAX_RUN);
        let faults = wrong.map(|(name, v)| run_fault(name, v)).collect();
        let n = a.saturating_add(b);
        Faults(faults).or(()).map(|()| Weave {
            draft: Draft::abc(a, b, c),
            origin: Origin::Abc { a, b, c },
            tile: (n, n),
        })
    }

    /// Greatest common divisor of c and a + b for `[a,b,c]`. Where it is 1 the weave hangs together by a theorem; where
    /// it is more the theorem is silent, and only [`hangs_together`] tells.
    pub fn common_divisor(&self) -> Option<u32> {
        match self.origin {
            Origin::Abc { a, b, c } => Some(gcd(a + b, c.unsigned_abs())),
            _ => None,
        }
    }

    /// The weave written `[a,b,c]`, as on the command line; brackets and white space may be left out.
    pub fn parse_abc(text: &str) -> Result<Weave, Faults> {
        let inner = text.trim().trim_start_matches('[').trim_end_matches(']');
        let words: Vec<&str> = inner.split(',').map(str::trim).collect();
        let numbers = match words[..] {
            [a, b, c] => a.parse().ok().zip(b.parse().ok()).zip(c.parse().ok()),
            _ => None,
        };
        let ((a, b), c) = numbers.ok_or_else(|| abc_fault(text))?;
        Weave::abc(a, b, c)
    }

    /// The weave of a file: WIF where its name ends in `.wif` or its text starts with `[`, else a drawn draft.
    pub fn read(path: &Path) -> Result<Weave, Faults> {
        let bytes = input::bytes(path)?;
        let named = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("wif"));
        if named || bytes.trim_ascii_start().starts_with(b"[") {
            return parse_wif(&input::legacy_text(bytes, path)?, path);
        }
        parse_drawn(&input::text(bytes, path)?, path)
    }

    /// A weave from a draft; its unit tile is one period of the strand.
    pub fn of_draft(draft: Draft, origin: Origin) -> Weave {
        let tile = (draft.warps(), draft.wefts());
        Weave { draft, origin, tile }
    }
}

fn run_fault(name: &str, value: u32) -> Fault {
    let hint = if value == 0 {
        "each strand needs at least one over (a) and one under (b), or nothing holds it"
    } else {
        "a float of more than 64 crossings is no cloth; the program stops there"
    };
    let what = format!("{name} = {value}, but it must be 1 to {MAX_RUN}");
    Fault { file: String::new(), place: None, key: "abc".into(), what, hint: hint.into() }
}

fn abc_fault(text: &str) -> Faults {
    let what = format!("{} is not a weave [a,b,c]", quoted(text));
    let hint =
        "three whole numbers: a overs, b unders (each 1 to 64), moved by c from weft to weft; as in [2,2,1]";
    Fault { file: String::new(), place: None, key: "abc".into(), what, hint: hint.into() }.into()
}

fn gcd(a: u32, b: u32) -> u32 {
    if b == 0 { a } else { gcd(b, a % b) }
}
