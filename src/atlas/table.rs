//! Takes nothing; gives what a table is to hold, as it stands at the head of its file.
//!
//! Not promised: anything about rows; two tables with the same head have the same rows (`row`).

use super::weaves::{Abc, Which, weaves};
use crate::spec::{Bounds, ProfileSpec, Shape};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What the table is to hold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Ask {
    /// Largest a + b.
    pub max_n: u32,
    pub which: Which,
    /// Largest repetition that is tried for each weave, in unit tiles.
    pub most: u32,
    pub phases: Phases,
    /// Largest a + b for which flexible parts are looked for.
    pub flex_up_to: u32,
    /// Largest a + b for which release clearance is looked for.
    pub release_up_to: u32,
    pub settings: Settings,
}

/// Where cuts are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Phases {
    /// Phase 0 alone.
    First,
    /// 0 to n - 1.
    All,
}

/// Repetitions that are tried when nobody says how many: twice what any known answer needs.
pub const MOST: u32 = 4;

/// Largest n of the window whose flexible parts are looked for when nobody says: beyond, one row may take hours.
pub const FLEX_UP_TO: u32 = 4;

/// Largest n of the swatch whose release clearance is looked for when nobody says: a dozen plans each.
pub const RELEASE_UP_TO: u32 = 3;

impl Ask {
    /// The table up to `max_n` with the profile of the known answers.
    pub fn new(max_n: u32) -> Ask {
        Ask {
            max_n,
            which: Which::Representatives,
            most: MOST,
            phases: Phases::All,
            flex_up_to: FLEX_UP_TO,
            release_up_to: RELEASE_UP_TO,
            settings: Settings::default(),
        }
    }

    /// Whether rows of `other` are rows of this table, as far as its weaves go.
    pub fn agrees(&self, other: &Ask) -> bool {
        Ask { max_n: self.max_n, ..*other } == *self
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
    pub fn profile(&self) -> ProfileSpec {
        let &Settings { rise, lift, cover, samples } = self;
        ProfileSpec { shape: Shape::Rise(rise), lift, cover, samples, bounds: Bounds::Sandwich }
    }
}

/// Shard `index` of `count`, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
pub struct Shard {
    index: u32,
    count: u32,
}

/// Most shards; beyond any scheduler's array, below what a mistyped number would ask for.
pub const MOST_SHARDS: u32 = 100_000;

impl Shard {
    /// From `i/m`, 1 <= i <= m.
    pub fn parse(text: &str) -> Result<Shard, String> {
        let wrong = || format!("write i/m with 1 <= i <= m <= {MOST_SHARDS}, as in 2/8");
        let (index, count) = text.split_once('/').ok_or_else(wrong)?;
        let number = |t: &str| t.trim().parse::<u32>().map_err(|_| wrong());
        let (index, count) = (number(index)?, number(count)?);
        if (1..=MOST_SHARDS).contains(&count) && (1..=count).contains(&index) {
            Ok(Shard { index, count })
        } else {
            Err(wrong())
        }
    }

    pub fn count(self) -> u32 {
        self.count
    }

    pub fn file(self) -> String {
        format!("atlas.{}-of-{}.jsonl", self.index, self.count)
    }

    /// This shard's weaves: all are dealt, the dearest first, each to the shard with the least to do so far.
    pub fn of(self, all: &[Abc]) -> Vec<Abc> {
        let dealt = deal(all, self.count as usize);
        all.iter().zip(dealt).filter(|(_, to)| *to == self.index as usize - 1).map(|(abc, _)| *abc).collect()
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// For each weave the shard that it goes to, from 0.
pub fn deal(all: &[Abc], shards: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by_key(|&k| (std::cmp::Reverse(all[k].n()), k));
    let mut load = vec![0_u64; shards];
    let mut to = vec![0; all.len()];
    for k in order {
        let least = (0..shards).min_by_key(|&s| (load[s], s)).unwrap_or(0);
        load[least] += cost(all[k]);
        to[k] = least;
    }
    to
}

/// How dear a row is against others: n phases, each measured to take about n squared from n = 4 to 7. Only the balance of
/// shards and the time left depend on it.
pub fn cost(abc: Abc) -> u64 {
    u64::from(abc.n()).pow(3)
}

/// The weaves that a run works on, in the table's order.
pub fn share(ask: &Ask, shard: Option<Shard>) -> Vec<Abc> {
    let all = weaves(ask.max_n, ask.which);
    shard.map_or_else(|| all.clone(), |s| s.of(&all))
}
