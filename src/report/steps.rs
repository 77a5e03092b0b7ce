//! Takes a plan, gives the table of its moves in the order of assembly, as a person at the bench follows them.
//!
//! Not promised: digits beyond those printed, nor long lists of parts whole; the JSON answer has them all.

use super::content::{Column, Table};
use super::words::decimal;
use crate::assembly::Assembly;
use crate::sequence::{Ends, Gives, Motion, Outcome, Plan, Reached, Rigid, Screw, Step};

/// Every step backward, the last first; several motions at once take a row each.
pub fn table<C>(assembly: &Assembly, plan: &Plan<C>) -> Table {
    let rows = plan.steps.iter().rev().zip(1..).flat_map(|(s, k)| rows(assembly, s, k)).collect();
    let head = [Column::numbers("step"), Column::words("parts"), Column::words("move")];
    Table {
        caption: "Moves in the order of assembly; kept: the least distance on the way, 0 where parts slide"
            .into(),
        head: head.into_iter().chain([Column::numbers("kept, mm"), Column::words("onto")]).collect(),
        rows,
    }
}

fn rows(assembly: &Assembly, step: &Step, number: usize) -> Vec<Vec<String>> {
    let movers = step.motion.movers(&step.parts);
    let kept = format!("{:.2}", step.clear * assembly.mm_per_unit);
    let onto = match step.ends {
        Ends::Apart => listed(&step.stays),
        Ends::Inside => format!("{} (already together)", listed(&step.stays)),
    };
    let row = |(k, (parts, motion)): (usize, &(&[String], Rigid))| {
        let first = |text: &str| if k == 0 { text.to_owned() } else { String::new() };
        let way = told(assembly, motion);
        let way = if k == 0 { way } else { format!("at the same time {way}") };
        vec![first(&number.to_string()), parts.join(", "), way, first(&kept), first(&onto)]
    };
    movers.iter().enumerate().map(row).collect()
}

/// Most ids in a cell: of hundreds of parts the table would be a book.
const MOST_IDS: usize = 12;

fn listed(ids: &[String]) -> String {
    match ids.len().checked_sub(MOST_IDS) {
        None | Some(0) => ids.join(", "),
        Some(more) => format!("{} and {more} more", ids[..MOST_IDS].join(", ")),
    }
}

/// The motion backward, in words.
fn told(assembly: &Assembly, motion: &Rigid) -> String {
    match motion {
        Rigid::Translation(s) => {
            format!("{:.2} mm along {}", s.distance_mm, vector(s.direction.map(|c| -c)))
        }
        Rigid::Screw(s) => screw(assembly, s),
    }
}

fn screw(assembly: &Assembly, s: &Screw) -> String {
    let at = vector(s.point.map(|c| c * assembly.mm_per_unit));
    let turn = format!("turn by {:.2}\u{b0} about {} through {at} mm", -s.angle.to_degrees(), vector(s.axis));
    if s.advance == 0.0 { turn } else { format!("{turn}, {:.2} mm along it", -s.advance_mm) }
}

fn vector(v: [f64; 3]) -> String {
    format!("({})", v.map(decimal).join(", "))
}

/// The moves by kind, in words: "3 straight moves and 1 turn".
pub fn count<C>(plan: &Plan<C>) -> String {
    let of = |kind: fn(&Motion) -> bool| plan.steps.iter().filter(|s| kind(&s.motion)).count();
    let kinds = [
        (of(|m| matches!(m, Motion::Translation(_))), "straight move", "straight moves"),
        (of(|m| matches!(m, Motion::Screw(_))), "turn", "turns"),
        (of(|m| matches!(m, Motion::Several { .. })), "joint motion of several", "joint motions of several"),
    ];
    let told = kinds.iter().filter(|(n, ..)| *n > 0).map(|(n, one, many)| {
        let word = if *n == 1 { one } else { many };
        format!("{n} {word}")
    });
    told.collect::<Vec<_>>().join(" and ")
}

/// How far each part of the sets that stayed together got, where that was searched.
pub fn reached<C>(plan: &Plan<C>) -> Option<Table> {
    let all = plan.stuck.iter().flat_map(|s| &s.reached);
    let moved = all.filter(|r| r.distance_mm > 0.0 || r.turned_degrees > 0.0);
    let row = |r: &Reached| {
        vec![
            r.part.clone(),
            format!("{:.2}", r.distance_mm),
            vector(r.direction),
            format!("{:.1}", r.turned_degrees),
        ]
    };
    let rows: Vec<Vec<String>> = moved.map(row).collect();
    let head = [Column::words("part"), Column::numbers("shift, mm"), Column::words("toward")];
    (!rows.is_empty()).then(|| Table {
        caption: "The farthest that each part got in the search for a way out".into(),
        head: head.into_iter().chain([Column::numbers("turned, degrees")]).collect(),
        rows,
    })
}

/// Which part of a locked set would have to bend, in words.
pub fn gives<C>(plan: &Plan<C>) -> Vec<String> {
    plan.stuck.iter().filter_map(|s| s.gives.as_ref()).map(told_gives).collect()
}

fn told_gives(g: &Gives) -> String {
    let past: Vec<&str> = g.past.iter().map(|p| p.part.as_str()).collect();
    let rest = match g.rest {
        Outcome::Assembled => "the others of its set go together without it",
        _ => "for the others of its set no straight plan was found",
    };
    format!(
        "Made soft, {} could go in last, along {}: {rest}. It has to give way by {:.2} mm past {}; squeezed by that \
         where it is in the way, its mean strain is {:.0} % (depth over width, on the best of the ways sampled; an \
         estimate, not a finite element result).",
        g.part,
        vector(g.direction.map(|c| -c)),
        g.depth_mm,
        past.join(", "),
        100.0 * g.strain
    )
}
