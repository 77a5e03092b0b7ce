//! Takes a largest a + b; gives the weaves `[a,b,c]` that hang together, and which of them are one cloth.
//!
//! Promised: every `[a,b,c]` with 0 <= c < a + b <= the largest that hangs together is a representative or among the
//! equivalents of one. Sound: equivalents are one cloth after an isometry. Not promised: that no isometry joins two
//! representatives; those that a test by all isometries found up to a + b = 10 are joined.

use crate::weave::{Hanging, MAX_RUN, Weave, hangs_together};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// `[a,b,c]`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
pub struct Abc(pub u32, pub u32, pub i32);

impl Abc {
    pub fn n(self) -> u32 {
        self.0 + self.1
    }

    /// The order of the table: n, then a from large to small b, then c.
    pub fn rank(self) -> (u32, u32, i32) {
        (self.n(), self.0, self.2)
    }
}

impl std::fmt::Display for Abc {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "[{},{},{}]", self.0, self.1, self.2)
    }
}

/// Another name of a cloth.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Equivalent {
    pub abc: Abc,
    /// Whether a motion takes the row's cloth there, a mirror, or either.
    pub by: By,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum By {
    Motion,
    Mirror,
    Both,
}

impl By {
    pub fn word(self) -> &'static str {
        match self {
            By::Motion => "motion",
            By::Mirror => "mirror",
            By::Both => "both",
        }
    }
}

/// The other names of the cloth `[a,b,c]`, c from 0 to n - 1. From (i - c j) mod n < a: x reversed alone makes c to -c;
/// turned upside down a and b change places; with x and y exchanged, warps of one run (a or b is 1, c prime to n) have
/// the inverse of c for a shift, and overs and unders have changed places too.
pub fn equivalents(abc: Abc) -> Vec<Equivalent> {
    let mut found: BTreeMap<Abc, By> = BTreeMap::new();
    for (image, mirrored) in images(abc) {
        let by = if mirrored { By::Mirror } else { By::Motion };
        found.entry(image).and_modify(|b| *b = if *b == by { by } else { By::Both }).or_insert(by);
    }
    found.remove(&abc);
    found.into_iter().map(|(abc, by)| Equivalent { abc, by }).collect()
}

/// The images under reversing x, turning upside down and exchanging, each with whether the isometry is improper.
fn images(Abc(a, b, c): Abc) -> Vec<(Abc, bool)> {
    let n = (a + b) as i32;
    let mut images = Vec::new();
    for (c, exchanged) in std::iter::once((c, false)).chain(inverse(a, b, c).map(|c| (c, true))) {
        for reversed in [false, true] {
            for upside_down in [false, true] {
                let c = if reversed { (-c).rem_euclid(n) } else { c.rem_euclid(n) };
                let (a, b) = if upside_down != exchanged { (b, a) } else { (a, b) };
                images.push((Abc(a, b, c), reversed ^ upside_down ^ exchanged));
            }
        }
    }
    images
}

/// The inverse of c modulo n, where exchanging wefts and warps gives an `[a,b,c]` again.
fn inverse(a: u32, b: u32, c: i32) -> Option<i32> {
    let n = (a + b) as i32;
    let inverse = (0..n).find(|&d| (c * d).rem_euclid(n) == 1)?;
    let one_run = a == 1 || b == 1 || [1, n - 1].contains(&c.rem_euclid(n));
    one_run.then_some(inverse)
}

/// Which weaves have rows of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Which {
    /// Of each cloth the name with the largest a, then the least c.
    Representatives,
    /// Every `[a,b,c]` with c from 0 to n - 1.
    Every,
}

/// The weaves of the table, in its order.
pub fn weaves(max_n: u32, which: Which) -> Vec<Abc> {
    let of = |n: u32| (1..n).flat_map(move |a| (0..n as i32).map(move |c| Abc(a, n - a, c)));
    let wanted = |abc: &Abc| (which == Which::Every || represents(*abc)) && holds(*abc);
    let mut all: Vec<Abc> = (2..=max_n.min(2 * MAX_RUN)).flat_map(of).filter(wanted).collect();
    all.sort_by_key(|abc| abc.rank());
    all
}

fn represents(abc: Abc) -> bool {
    let key = |Abc(a, _, c): Abc| (std::cmp::Reverse(a), c);
    equivalents(abc).iter().all(|e| key(abc) < key(e.abc))
}

fn holds(Abc(a, b, c): Abc) -> bool {
    Weave::abc(a, b, c).is_ok_and(|w| hangs_together(&w.draft) == Hanging::Together)
}
