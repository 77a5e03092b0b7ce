//! Takes `[a,b,c]`, a drawn draft or a WIF file; gives a checked draft: period, floats, family, does it hang together.
//!
//! Promised: a [`Draft`] is periodic both ways and stored at its least period. Not promised: that it is a fabric; one
//! that falls apart is a draft like any other (see [`hangs_together`]).

mod draft;

pub use draft::Draft;

use crate::fault::{Fault, Faults};
use serde::Serialize;
use std::fmt;
use std::path::PathBuf;

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

    /// A weave from a draft; its unit tile is one period of the strand.
    pub fn drawn(draft: Draft, origin: Origin) -> Weave {
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
