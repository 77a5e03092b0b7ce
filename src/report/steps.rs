//! Takes a plan, gives the table of its moves in the order of assembly, as a person at the bench follows them.
//!
//! Not promised: digits beyond those printed; the JSON answer has them all.

use super::content::{Column, Table};
use super::words::decimal;
use crate::assembly::Assembly;
use crate::sequence::{Ends, Motion, Plan, Rigid, Screw, Step};

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
        Ends::Apart => step.stays.join(", "),
        Ends::Inside => format!("{} (already together)", step.stays.join(", ")),
    };
    let row = |(k, (parts, motion)): (usize, &(&[String], Rigid))| {
        let first = |text: &str| if k == 0 { text.to_owned() } else { String::new() };
        let way = told(assembly, motion);
        let way = if k == 0 { way } else { format!("at the same time {way}") };
        vec![first(&number.to_string()), parts.join(", "), way, first(&kept), first(&onto)]
    };
    movers.iter().enumerate().map(row).collect()
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
