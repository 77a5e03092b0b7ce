//! Takes a largest a + b; gives a row for every genus-1 weave up to it that hangs together: family, hands, repetition.
//!
//! Promised: rows in order of n, a, c, the same with any number of threads, no time in them. Weaves that an isometry
//! takes to one in the table are left out: `[b,a,c]` (turned over it is `[a,b,-c]`), so a >= b; `[a,b,-c]` (the mirror
//! image: the other hand), so 2 c <= a + b. Not promised: that a swatch of one left out has the same verdicts; the swatch
//! rule breaks ties towards smaller starts, which no mirror keeps (MATHS.md).

mod files;

pub use files::{Written, write};

use crate::chirality::answer::{Handedness, WarpIs};
use crate::chirality::{HandsError, of_weave};
use crate::fault::Faults;
use crate::repeats::{Search, Tried, repeats};
use crate::spec::{Bounds, ProfileSpec, Shape};
use crate::weave::{Hanging, MAX_RUN, Weave, family, hangs_together};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the table is to hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ask {
    /// Largest a + b.
    pub max_n: u32,
    /// Largest repetition that is tried for each weave, in unit tiles.
    pub most: u32,
    pub settings: Settings,
}

/// Repetitions that are tried when nobody says how many: twice what any known answer needs.
pub const MOST: u32 = 4;

impl Ask {
    /// The table up to `max_n` with the profile of the known answers.
    pub fn new(max_n: u32) -> Ask {
        Ask { max_n, most: MOST, settings: Settings::default() }
    }
}

/// The profile of all strands, lengths in crossings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Settings {
    pub rise: f64,
    pub lift: f64,
    pub cover: f64,
    pub samples: u32,
}

impl Default for Settings {
    /// Those of the known answers in MATHS.md.
    fn default() -> Settings {
        Settings { rise: 0.6, lift: 1.0, cover: 1.0, samples: 8 }
    }
}

impl Settings {
    fn profile(&self) -> ProfileSpec {
        let &Settings { rise, lift, cover, samples } = self;
        ProfileSpec { shape: Shape::Rise(rise), lift, cover, samples, bounds: Bounds::Sandwich }
    }
}

/// The verdicts about the swatch of n wefts and n warps whose pieces are k unit tiles, at phase 0.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Repeated {
    pub k: u32,
    pub translation: String,
    pub rigid: String,
}

/// A weave and what was found about it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Row {
    pub a: u32,
    pub b: u32,
    pub c: i32,
    pub family: String,
    /// Hand of the weft's unit tile at phase 0, and how the warp's follows; null where the tile could not be cut (`note`).
    pub tile: Option<Handedness>,
    pub warp_is: Option<WarpIs>,
    /// Least k that was found locked (rigid); null where none was, up to `most`, or a smaller one is undecided.
    pub minimal_repeat: Option<u32>,
    pub most: u32,
    /// In order of k, up to the first that locks.
    pub repeats: Vec<Repeated>,
    /// What went wrong; empty where nothing did.
    pub note: String,
    #[serde(flatten)]
    pub settings: Settings,
}

/// The weaves of the table, in its order.
pub fn weaves(max_n: u32) -> Vec<(u32, u32, i32)> {
    let of = |n: u32| {
        let runs = n.div_ceil(2)..n.min(MAX_RUN + 1);
        runs.flat_map(move |a| (1..=n as i32 / 2).map(move |c| (a, n - a, c)))
    };
    (2..=max_n.min(2 * MAX_RUN)).flat_map(of).filter(|&abc| holds(abc)).collect()
}

fn holds((a, b, c): (u32, u32, i32)) -> bool {
    Weave::abc(a, b, c).is_ok_and(|w| hangs_together(&w.draft) == Hanging::Together)
}

/// The row of one weave.
pub fn row((a, b, c): (u32, u32, i32), ask: &Ask) -> Result<Row, Faults> {
    let weave = Weave::abc(a, b, c)?;
    let profile = ask.settings.profile();
    let hands = of_weave(&weave, &profile);
    let search = Search { wefts: a + b, warps: a + b, phases: vec![0], most: ask.most };
    let found = repeats(&weave, &profile, &search);
    let tried: Vec<Repeated> = found.iter().flat_map(|r| &r.tried).map(repeated).collect();
    let note = [hands.as_ref().err().map(HandsError::to_string), found.as_ref().err().map(Faults::to_string)];
    let hands = hands.ok();
    Ok(Row {
        a,
        b,
        c,
        family: family(&weave.draft).to_string(),
        tile: hands.as_ref().and_then(|h| h.tile),
        warp_is: hands.as_ref().and_then(|h| h.warp_is),
        minimal_repeat: least(&tried),
        most: ask.most,
        repeats: tried,
        note: note.into_iter().flatten().collect::<Vec<_>>().join("; "),
        settings: ask.settings,
    })
}

fn repeated(tried: &Tried) -> Repeated {
    let (translation, rigid) = (tried.translation.word().to_string(), tried.rigid.word().to_string());
    Repeated { k: tried.swatch.repeat, translation, rigid }
}

/// The first k that locks, when every k before it is free.
fn least(tried: &[Repeated]) -> Option<u32> {
    tried.iter().find(|t| t.rigid != "free").filter(|t| t.rigid == "locked").map(|t| t.k)
}

/// The rows from number `done` on, in order, each handed to `each` as soon as those before it are there. As many weaves
/// as there are threads are looked at together.
pub fn rows<E: From<Faults>>(
    ask: &Ask,
    done: usize,
    mut each: impl FnMut(Row) -> Result<(), E>,
) -> Result<(), E> {
    let weaves = weaves(ask.max_n);
    for some in weaves.get(done..).unwrap_or_default().chunks(rayon::current_num_threads().max(1)) {
        let found: Vec<_> = some.par_iter().map(|&abc| row(abc, ask)).collect();
        for row in found {
            each(row?)?;
        }
    }
    Ok(())
}
