//! Takes what a shop would rather have of a plan; gives the plan in that order, and tells what came of each wish.
//!
//! Not promised: anything beyond what `wanted` promises.

use super::blocking::direction;
use super::load::Placed;
use super::questions::{argument, part};
use super::told::Trouble;
use crate::report::answer::{self, Met, PlanAnswer, PreferredAnswer};
use crate::report::content::{Chapter, Column, Table};
use crate::sequence::clearance::with_clearance;
use crate::sequence::wanted::{self, Ask, Chosen, Wish, prefer};
use clap::{Args, ValueEnum};
use glam::DVec3;

#[derive(Args, Debug, Default)]
pub struct Asked {
    /// Choose among legal orders by these, the first counts most (the others follow): `--prefer above,directions`
    #[arg(
        long,
        value_enum,
        value_name = "WISHES",
        value_delimiter = ',',
        help_heading = "What a shop wants"
    )]
    pub prefer: Vec<Wanted>,
    /// Against gravity (any length; default 0,0,1): `--up 0,0,-1` puts it together upside down
    #[arg(long, value_name = "X,Y,Z", value_parser = direction, allow_hyphen_values = true, help_heading = "What a shop wants")]
    pub up: Option<DVec3>,
    /// All that is put together stands on a table; else on held parts, or on the part that is there first
    #[arg(long, help_heading = "What a shop wants")]
    pub table: bool,
    /// Parts that are flexible, to go in last: `--flexible weft-0`
    #[arg(long, value_name = "PARTS", value_delimiter = ',', help_heading = "What a shop wants")]
    pub flexible: Vec<String>,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Flexible parts go in last
    Flexible,
    /// Fewest steps
    Steps,
    /// No part is held in the air
    Air,
    /// Parts come from above
    Above,
    /// Few directions
    Directions,
}

impl Asked {
    fn is_none(&self) -> bool {
        self.prefer.is_empty() && self.up.is_none() && !self.table && self.flexible.is_empty()
    }

    /// Those named, then the others as they are ranked where nothing is said.
    fn ranked(&self) -> [Wish; 5] {
        let named: Vec<Wish> = self.prefer.iter().map(|w| wish(*w)).collect();
        let mut ranked = Wish::RANKED;
        ranked.sort_by_key(|w| named.iter().position(|n| n == w).unwrap_or(named.len()));
        ranked
    }

    fn ask(&self, placed: &Placed) -> Result<Ask, Trouble> {
        let flexible =
            self.flexible.iter().map(|id| part(&placed.joined, id.trim())).collect::<Result<_, _>>()?;
        Ok(Ask {
            up: self.up.unwrap_or(DVec3::Z),
            table: if self.table { wanted::Table::There } else { wanted::Table::None },
            ranked: self.ranked(),
            flexible,
        })
    }
}

fn wish(wanted: Wanted) -> Wish {
    match wanted {
        Wanted::Flexible => Wish::Flexible,
        Wanted::Steps => Wish::Steps,
        Wanted::Air => Wish::Air,
        Wanted::Above => Wish::Above,
        Wanted::Directions => Wish::Directions,
    }
}

/// The answer in the order that was asked for; as it is where nothing was.
pub fn applied(placed: &Placed, found: PlanAnswer, asked: &Asked) -> Result<PlanAnswer, Trouble> {
    if asked.is_none() {
        return Ok(found);
    }
    let (joined, ask) = (&placed.joined, asked.ask(placed)?);
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let air = found.clearance_mm > 0.0;
    let made = with_clearance(asm, patches, found.clearance_mm / asm.mm_per_unit)
        .map_err(|e| argument(e.to_string(), "give a smaller --clearance".into()))?;
    let mut found = found;
    let before = found.plan.stopped;
    let came = prefer(if air { &made } else { asm }, patches, &mut found.plan, &ask, air, &placed.watch);
    if found.plan.stopped && !before {
        found.remarks.push(format!(
            "stopped by the user while wishes were looked at, after {} sets and directions: the plan stands, its order is \
             the best until then, and what was not judged is undecided",
            came.looked_at
        ));
    }
    Ok(answer::preferred(asm, found, &ask, &came))
}

/// Puts the wishes to the plan's chapter.
pub fn tell(chapter: &mut Chapter, a: &PreferredAnswer) {
    let chosen = match a.chosen {
        Chosen::Best => "the best of all orders of single parts along the directions looked at",
        Chosen::Some => "the best of some orders: the counted work was used up",
        Chosen::AsFound => "the planner's own: nothing better was seen, or nothing can be reordered",
    };
    let [x, y, z] = a.up;
    let stands = if a.table { "on a table" } else { "on held parts, or on the part that is there first" };
    chapter.facts.push(("order".into(), format!("{chosen} ({} states)", a.looked_at)));
    chapter.facts.push(("gravity".into(), format!("up is ({x:.3}, {y:.3}, {z:.3}); it stands {stands}")));
    if a.through_table > 0 {
        let words =
            format!("{} steps come from below, through the table: lift the rest off it.", a.through_table);
        chapter.words.push(words);
    }
    chapter.tables.push(wishes(a));
    if !a.held_in_air.is_empty() {
        chapter.tables.push(hands(a));
    }
}

fn wishes(a: &PreferredAnswer) -> Table {
    let number = |n: Option<usize>| n.map_or("?".into(), |n| n.to_string());
    let rows = a.ranked.iter().map(|w| {
        let met = match w.met {
            Met::Yes => "yes",
            Met::No => "no",
            Met::Undecided => "undecided",
        };
        let name = format!("{:?}", w.wish).to_lowercase();
        vec![name, met.into(), number(w.count), number(w.as_found), number(w.alone), w.what.clone()]
    });
    let head = [Column::words("wish"), Column::words("met")];
    let numbers = ["count", "planner", "alone"].map(Column::numbers);
    Table {
        caption:
            "Wishes by rank; planner: in its own order; alone: the least seen where this wish came first"
                .into(),
        head: head.into_iter().chain(numbers).chain([Column::words("counted")]).collect(),
        rows: rows.collect(),
    }
}

/// A tenth of a percent is as fine as a hand can tell.
fn share(of_all: f64) -> String {
    if of_all < 0.001 { "< 0.1 %".into() } else { format!("{:.1} %", 100.0 * of_all) }
}

fn hands(a: &PreferredAnswer) -> Table {
    let rows = a.held_in_air.iter().map(|h| vec![h.step.to_string(), h.parts.join(", "), share(h.share)]);
    Table {
        caption:
            "Hold these once the step is done, until more is in place; share of the weight, frictionless"
                .into(),
        head: vec![Column::numbers("step"), Column::words("hold"), Column::numbers("share")],
        rows: rows.collect(),
    }
}
