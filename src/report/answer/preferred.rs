//! Takes what came of the wishes for a plan; gives it as it is written, and puts it to the plan's answer.
//!
//! Not promised: more than `wanted` and its `rest` do; `verify` checks the moves, not the preferences.

use super::{PlanAnswer, checksum, ids};
use crate::assembly::Assembly;
use crate::sequence::wanted::{Ask, Chosen, Preferred, Rest, Table, Wish};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What was rather had of the order of assembly, and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PreferredAnswer {
    /// Against gravity, unit vector.
    pub up: [f64; 3],
    /// Whether each set that is put together stands on a table under its lowest point; else on what is held, or on the
    /// part that is there first.
    pub table: bool,
    pub flexible: Vec<String>,
    /// How the order was chosen: the `best` among all orders of single parts along the directions looked at (with a short
    /// test of rest: that something is under each part); among `some` of them, for want of counted work; `as-found` by
    /// the planner, since nothing better was seen or could be reordered.
    pub chosen: Chosen,
    /// Sets that were left and directions that were used until then, together, that were looked at.
    pub looked_at: usize,
    /// Steps whose parts would have to come through the table: lift the rest off it for them. Kept least before all wishes.
    pub through_table: usize,
    /// The first counts most.
    pub ranked: Vec<WishAnswer>,
    /// Where hands must bear weight while it is put together, by statics without friction.
    pub held_in_air: Vec<HandsAnswer>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Met {
    /// Nothing is left to wish for.
    Yes,
    No,
    /// Some set could not be judged.
    Undecided,
}

/// One wish.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct WishAnswer {
    pub wish: Wish,
    pub met: Met,
    /// What is to be small, as `what` says; null where some of it is undecided.
    pub count: Option<usize>,
    /// The same for the planner's own order.
    pub as_found: Option<usize>,
    /// The least that was seen where this wish came first: `count` beyond it is what the wishes before it cost.
    pub alone: Option<usize>,
    /// What is counted, in words, with its parts.
    pub what: String,
}

/// A step after which, in assembly, hands must bear weight until more is in place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HandsAnswer {
    /// Number of the step in the order of assembly, from 1.
    pub step: usize,
    pub parts: Vec<String>,
    /// Force and moment that hands must give, as a share of the weight of the parts that do not stand by themselves.
    pub share: f64,
}

/// The answer with what came of the wishes.
pub fn preferred(asm: &Assembly, answer: PlanAnswer, ask: &Ask, found: &Preferred) -> PlanAnswer {
    let told = PreferredAnswer {
        up: ask.up.to_array(),
        table: ask.table == Table::There,
        flexible: ids(asm, &ask.flexible.iter().copied().collect::<Vec<_>>()),
        chosen: found.chosen,
        looked_at: found.looked_at,
        through_table: found.judged.through_table,
        ranked: ask.ranked.iter().zip(&found.alone).map(|(w, alone)| wish(*w, *alone, ask, found)).collect(),
        held_in_air: hands(asm, &found.judged.rests),
    };
    let answer = PlanAnswer { preferences: Some(told), checksum: String::new(), ..answer };
    PlanAnswer { checksum: checksum(&answer), ..answer }
}

fn hands(asm: &Assembly, rests: &[Rest]) -> Vec<HandsAnswer> {
    let of = |(k, rest): (usize, &Rest)| match rest {
        Rest::Held { parts, share } => {
            Some(HandsAnswer { step: k + 1, parts: ids(asm, parts), share: *share })
        }
        _ => None,
    };
    rests.iter().rev().enumerate().filter_map(of).collect()
}

fn wish(wish: Wish, alone: Option<usize>, ask: &Ask, found: &Preferred) -> WishAnswer {
    let (j, count) = (&found.judged, found.judged.count(wish));
    let least = match wish {
        Wish::Steps => j.least_steps,
        Wish::Directions => 1.min(j.directions),
        _ => 0,
    };
    let what = match wish {
        Wish::Flexible if ask.flexible.is_empty() => "no part was named as flexible".into(),
        Wish::Flexible => "rigid parts that go in after a flexible one".into(),
        Wish::Steps => format!("steps; no plan parts these sets in fewer than {least}"),
        Wish::Air => "parts that hands must hold, over all steps: statics without friction".into(),
        Wish::Above => format!(
            "steps that do not come from above: {} sideways, {} from below, {} that turn; {} straight from above, {} aslant",
            j.sideways, j.from_below, j.turns, j.from_above, j.aslant
        ),
        Wish::Directions => "directions; each turn counts as one of its own".into(),
    };
    WishAnswer {
        wish,
        met: match count {
            None => Met::Undecided,
            Some(n) if n <= least => Met::Yes,
            Some(_) => Met::No,
        },
        count,
        as_found: found.as_found.count(wish),
        alone,
        what,
    }
}
