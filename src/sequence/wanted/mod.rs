//! Takes a plan and what a shop would rather have of it; gives the plan with its parts in another legal order, and for
//! each preference whether it is met and what was paid for it.
//!
//! Only the order, and the direction among those looked at, of parts that leave straight from their places is chosen,
//! singly or in the groups that the planner found: turns and moves that stop half way stay where the planner put them,
//! and so does the order in which a group comes apart. Each order is legal by the planner's own test; `verify` checks it
//! with other code. `best` is best among orders of single parts along the directions looked at, with the short test of
//! rest (see `orders`); what is told of rest is the long one (see `rest`).

mod judge;
mod orders;
mod rest;

use super::answer::{Step, step};
use super::field::{Field, Set};
use super::motion::{Ends, Motion};
use super::{Move, Plan};
use crate::assembly::{Assembly, PartIx};
use crate::blocking::SAME_ANGLE;
use crate::contact::Patch;
use crate::watch::Watch;
use glam::DVec3;
pub use judge::Judged;
use judge::judge;
use orders::{Choice, Looked, Run};
pub use rest::Rest;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What a shop may rather have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Wish {
    /// Flexible parts go in last.
    Flexible,
    /// Fewest steps.
    Steps,
    /// No part is held in the air.
    Air,
    /// Parts come from above.
    Above,
    /// Few directions.
    Directions,
}

impl Wish {
    /// What bears no load and what falls come first; a direction more costs a person least.
    pub const RANKED: [Wish; 5] = [Wish::Flexible, Wish::Steps, Wish::Air, Wish::Above, Wish::Directions];
}

/// Whether the parts stand on a table: a plane across `up`, under the lowest point of each set that is put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    There,
    None,
}

#[derive(Clone, Debug)]
pub struct Ask {
    /// Against gravity, unit vector.
    pub up: DVec3,
    pub table: Table,
    /// The first counts most; all five.
    pub ranked: [Wish; 5],
    pub flexible: Set,
}

/// How the order was chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Chosen {
    /// Among all orders of single parts along the directions looked at.
    Best,
    /// Among some of them: the bound on counted work was reached, or groups were among them.
    Some,
    /// The planner's own order is as good as any looked at, or nothing can be reordered.
    AsFound,
}

/// What was chosen, and what it is worth.
#[derive(Clone, Debug)]
pub struct Preferred {
    pub chosen: Chosen,
    /// Orders of the first parts that were looked at.
    pub looked_at: usize,
    pub judged: Judged,
    /// The planner's own order.
    pub as_found: Judged,
    /// For each wish, in the order of the ranking: what it counts where it alone comes first.
    pub alone: Vec<Option<usize>>,
}

/// Reorders the steps of a plan, and marks it where the user stopped that; `asm` as planned (with its clearance), `patches` as the parts touch.
pub fn prefer<C>(
    asm: &Assembly,
    patches: &[Patch],
    plan: &mut Plan<C>,
    ask: &Ask,
    clearance: bool,
    watch: &Watch,
) -> Preferred {
    // With air between the parts nothing touches at the start of a move.
    let field = Field::new(asm, if clearance { &[] } else { patches }, watch);
    let shop = Shop::new(&field, patches, ask);
    let as_found = judge(&shop, &plan.steps);
    let looks = |ranked: &[Wish; 5]| shop.reordered(&plan.steps, ranked, plan.counted.is_some());
    let (steps, looked) = looks(&ask.ranked);
    let judged = judge(&shop, &steps);
    let alone = ask.ranked.map(|wish| {
        let found = looks(&first(wish, &ask.ranked)).0;
        let found = if wish == Wish::Air { judge(&shop, &found) } else { judge::moves(&shop, &found) };
        Some(found.count(wish)?.min(judged.count(wish)?).min(as_found.count(wish)?))
    });
    plan.stopped |= watch.is_stopped();
    let better = judged.key(&ask.ranked) < as_found.key(&ask.ranked);
    if better {
        plan.steps = steps;
    }
    let chosen = match (better, looked.all) {
        (false, _) => Chosen::AsFound,
        (true, true) => Chosen::Best,
        (true, false) => Chosen::Some,
    };
    let judged = if better { judged } else { as_found.clone() };
    Preferred { chosen, looked_at: looked.states, judged, as_found, alone: alone.to_vec() }
}

/// The ranking with one wish moved to its front.
fn first(wish: Wish, ranked: &[Wish; 5]) -> [Wish; 5] {
    let mut out = *ranked;
    out.sort_by_key(|w| *w != wish);
    out
}

/// Straight steps of which each leaves what the one before left, the height of their table, the steps by which the
/// groups among them come apart, and all other steps.
struct Stretch<'r> {
    line: Vec<&'r Step>,
    floor: f64,
    inside: Vec<&'r Step>,
    others: Vec<&'r Step>,
}

/// What all orders are weighed with.
struct Shop<'s, 'a> {
    field: &'s Field<'a>,
    patches: &'s [Patch],
    ask: &'s Ask,
    ids: BTreeMap<&'s str, PartIx>,
}

impl<'s, 'a> Shop<'s, 'a> {
    fn new(field: &'s Field<'a>, patches: &'s [Patch], ask: &'s Ask) -> Self {
        let ids = field.asm.ids().map(|p| (field.asm.part(p).id.as_str(), p)).collect();
        Shop { field, patches, ask, ids }
    }

    fn set(&self, ids: &[String]) -> Set {
        ids.iter().filter_map(|id| self.ids.get(id.as_str()).copied()).collect()
    }

    /// All parts that a step divides.
    fn divided(&self, step: &Step) -> Set {
        let mut all = self.set(&step.parts);
        all.extend(self.set(&step.stays));
        all
    }

    /// Each run of straight leaves in a better order, the rest as it was.
    fn reordered(&self, steps: &[Step], ranked: &[Wish; 5], counted: bool) -> (Vec<Step>, Looked) {
        let mut looked = Looked { states: 0, all: true };
        // After a motion within a set places are others; moves counted on a lattice keep their order.
        if counted || steps.iter().any(|s| s.ends == Ends::Inside) {
            return (steps.to_vec(), Looked { all: false, ..looked });
        }
        let (directions, floors) = (self.directions(steps), judge::floors(self, steps));
        let (mut out, mut at) = (Vec::new(), 0);
        while at < steps.len() {
            let (end, line, inside) = self.run_from(steps, at);
            if end == at {
                out.push(steps[at].clone());
                at += 1;
                continue;
            }
            let others = out.iter().chain(&steps[end..]).chain(inside.iter().copied()).collect();
            let run = Stretch { line, floor: floors[at], inside, others };
            let found = self.better(&run, &directions, ranked, &mut looked);
            out.extend(found.unwrap_or_else(|| steps[at..end].to_vec()));
            at = end;
        }
        (out, looked)
    }

    /// The run of straight leaves that begins here, and the steps between by which its groups come apart.
    fn run_from<'r>(&self, steps: &'r [Step], at: usize) -> (usize, Vec<&'r Step>, Vec<&'r Step>) {
        let (mut line, mut inside): (Vec<&Step>, Vec<&Step>) = (Vec::new(), Vec::new());
        let mut gone = Set::new();
        for (k, next) in steps.iter().enumerate().skip(at) {
            let divided = self.divided(next);
            let follows = line.last().is_none_or(|before| divided == self.set(&before.stays));
            if follows && next.ends == Ends::Apart && next.motion.straight().is_some() {
                gone.extend(self.set(&next.parts));
                line.push(next);
            } else if !line.is_empty() && divided.is_subset(&gone) {
                inside.push(next);
            } else {
                return (k, line, inside);
            }
        }
        (steps.len(), line, inside)
    }

    /// Those of the plan, up, and the axes: each once.
    fn directions(&self, steps: &[Step]) -> Vec<DVec3> {
        let straight = steps.iter().filter_map(|s| s.motion.straight());
        let own = straight.map(|s| DVec3::from_array(s.direction));
        let axes = DVec3::AXES.into_iter().flat_map(|a| [a, -a]);
        let mut out: Vec<DVec3> = Vec::new();
        for d in own.chain([self.ask.up]).chain(axes) {
            if out.len() < orders::MOST_DIRECTIONS && out.iter().all(|o| o.distance(d) > SAME_ANGLE) {
                out.push(d);
            }
        }
        out
    }

    fn better(
        &self,
        run: &Stretch,
        directions: &[DVec3],
        ranked: &[Wish; 5],
        looked: &mut Looked,
    ) -> Option<Vec<Step>> {
        let Stretch { line, floor, inside, others } = run;
        let set = self.divided(line.first()?);
        let last = self.set(&line.last()?.stays);
        let groups = line.iter().map(|s| self.set(&s.parts)).filter(|g| g.len() > 1);
        let groups: Vec<Set> = groups.collect();
        let used = |d: &DVec3| {
            let straight = others.iter().filter_map(|s| s.motion.straight());
            straight.into_iter().any(|s| DVec3::from_array(s.direction).distance(*d) <= SAME_ANGLE)
        };
        let used = directions.iter().map(used).collect();
        let run = Run::new(self, (&set, &last, &groups), *floor, directions, used)?;
        let Choice { moves, looked: more } = run.best(ranked)?;
        looked.states += more.states;
        looked.all &= more.all;
        let mut left = set;
        let mut told = Vec::new();
        for (parts, along) in moves {
            left.retain(|p| !parts.contains(p));
            let of_group = inside.iter().filter(|s| parts.len() > 1 && self.divided(s).is_subset(&parts));
            let of_group: Vec<Step> = of_group.map(|s| (*s).clone()).collect();
            told.push(step(self.field, &Move { parts, along, stays: left.clone() }));
            told.extend(of_group);
        }
        Some(told)
    }
}

/// The direction in which the moved parts go out, where they go straight.
fn out_along(step: &Step) -> Option<DVec3> {
    match &step.motion {
        Motion::Translation(shift) => Some(DVec3::from_array(shift.direction)),
        _ => None,
    }
}
