//! Takes the steps of a plan's JSON; gives what each part does in each step, and where it is after any share of the plan.
//!
//! Promised: a kind of step that is not known here is named and ends the reading; nothing is guessed. Not promised: that
//! a plan is free of collisions; `verify` checks that.

use glam::{DAffine3, DMat3, DVec3};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// A rigid motion in world coordinates, model units, driven by one parameter from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Motion {
    Translation {
        by: DVec3,
    },
    /// A right-handed turn by `angle` radians about the axis (unit) through `point`, with an advance along it.
    Screw {
        point: DVec3,
        axis: DVec3,
        angle: f64,
        advance: f64,
    },
}

impl Motion {
    /// The displacement after the share `t`.
    pub fn at(&self, t: f64) -> DAffine3 {
        match *self {
            Motion::Translation { by } => DAffine3::from_translation(by * t),
            Motion::Screw { point, axis, angle, advance } => {
                let turn = DMat3::from_axis_angle(axis, angle * t);
                DAffine3::from_mat3_translation(turn, point - turn * point + axis * (advance * t))
            }
        }
    }
}

/// Parts (by place in the assembly) that move as one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mover {
    pub parts: Vec<usize>,
    pub motion: Motion,
}

/// A step, from assembled to apart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Move {
    pub movers: Vec<Mover>,
    /// Parts that stand still and are still on the table.
    pub stays: Vec<usize>,
    /// Model units; the least distance kept on the way.
    pub clear: Option<f64>,
    /// Whether what moved stays among the rest.
    pub inside: bool,
}

/// The moves of a plan, as many as could be read, and why not all.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moves {
    pub moves: Vec<Move>,
    pub unread: Option<String>,
}

/// Reads `steps` (those of the answer of `plan`) for parts with these ids.
pub fn read(steps: &Value, ids: &[&str]) -> Moves {
    let at: BTreeMap<&str, usize> = ids.iter().enumerate().map(|(k, id)| (*id, k)).collect();
    let mut all = Moves::default();
    for (k, step) in steps.as_array().into_iter().flatten().enumerate() {
        match one(step, &at) {
            Ok(m) => all.moves.push(m),
            Err(why) => {
                all.unread = Some(format!("step {} of the plan is not shown: {why}", k + 1));
                break;
            }
        }
    }
    all
}

type Places<'a> = BTreeMap<&'a str, usize>;

fn one(step: &Value, at: &Places) -> Result<Move, String> {
    let movers = match step["kind"].as_str() {
        Some("several") => {
            let list = step["motions"].as_array().ok_or("it has no motions")?;
            list.iter().map(|m| mover(m, at)).collect::<Result<Vec<_>, _>>()?
        }
        _ => vec![mover(step, at)?],
    };
    let stays = parts(&step["stays"], at)?;
    let inside = step["ends"].as_str() == Some("inside");
    Ok(Move { movers, stays, clear: step["clear"].as_f64(), inside })
}

fn mover(step: &Value, at: &Places) -> Result<Mover, String> {
    let number = |key: &str| {
        let found = step[key].as_f64().filter(|x| x.is_finite());
        found.ok_or_else(|| format!("its {key} is no number"))
    };
    let motion = match step["kind"].as_str() {
        Some("translation") => Motion::Translation { by: vector(step, "direction")? * number("distance")? },
        Some("screw") => Motion::Screw {
            point: vector(step, "point")?,
            axis: vector(step, "axis")?.try_normalize().ok_or("its axis has no direction")?,
            angle: number("angle")?,
            advance: number("advance")?,
        },
        kind => return Err(format!("its kind {} is not known", kind.unwrap_or("(none)"))),
    };
    Ok(Mover { parts: parts(&step["parts"], at)?, motion })
}

fn vector(step: &Value, key: &str) -> Result<DVec3, String> {
    let found = step[key].as_array().filter(|a| a.len() == 3);
    let numbers: Option<Vec<f64>> = found.and_then(|a| a.iter().map(Value::as_f64).collect());
    numbers.map(|n| DVec3::new(n[0], n[1], n[2])).ok_or_else(|| format!("its {key} is no vector"))
}

fn parts(list: &Value, at: &Places) -> Result<Vec<usize>, String> {
    let id = |v: &Value| {
        let id = v.as_str().unwrap_or_default();
        at.get(id).copied().ok_or_else(|| format!("there is no part `{id}`"))
    };
    list.as_array().into_iter().flatten().map(id).collect()
}

/// Displacement of each of `count` parts after `done` steps (a fraction is a share of the next one).
pub fn displacements(moves: &[Move], count: usize, done: f64) -> Vec<DAffine3> {
    let mut all = vec![DAffine3::IDENTITY; count];
    for (k, step) in moves.iter().enumerate() {
        let share = (done - k as f64).clamp(0.0, 1.0);
        if share == 0.0 {
            break;
        }
        for mover in &step.movers {
            let moved = mover.motion.at(share);
            mover.parts.iter().for_each(|&p| all[p] = moved * all[p]);
        }
    }
    all
}

/// Parts of a step: those that move, and those that they leave.
pub fn on_table(step: &Move) -> impl Iterator<Item = usize> + '_ {
    step.movers.iter().flat_map(|m| m.parts.iter().copied()).chain(step.stays.iter().copied())
}

/// What the motion of a step is, in words, lengths in mm. `ids` are those of all parts.
pub fn told(step: &Move, ids: &[&str], mm_per_unit: f64, way: Way) -> String {
    let each = |m: &Mover| {
        let who = listed(&m.parts, ids);
        let verb = if m.parts.len() == 1 { "moves" } else { "move together" };
        let onto = if way == Way::Apart { "" } else { " into place" };
        format!("{who} {verb} {}{onto}", motion(&m.motion, mm_per_unit, way))
    };
    step.movers.iter().map(each).collect::<Vec<_>>().join("; at once ")
}

/// Which way a plan is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    Apart,
    Together,
}

fn motion(motion: &Motion, mm: f64, way: Way) -> String {
    let sign = if way == Way::Apart { 1.0 } else { -1.0 };
    match *motion {
        Motion::Translation { by } => {
            format!("{:.1} mm along {}", by.length() * mm, direction(by * sign))
        }
        Motion::Screw { axis, angle, advance, .. } => {
            let turn = format!("{:.0} degrees about {}", (angle * sign).to_degrees(), direction(axis));
            let along = advance * mm * sign;
            if along.abs() < LEAST_SHOWN_MM { turn } else { format!("{turn}, {along:.1} mm along it") }
        }
    }
}

/// Half of the last digit that is printed, mm.
const LEAST_SHOWN_MM: f64 = 0.05;

/// Share of a length below which a coordinate is told as none: half of the last digit of a direction.
const SMALL: f64 = 0.005;

/// A direction in words: an axis with its sign where it is one, else the components.
pub fn direction(v: DVec3) -> String {
    let v = v.normalize_or_zero();
    let axes = [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)];
    for (name, axis) in axes {
        let along = v.dot(axis);
        if (v - axis * along).length() < SMALL {
            let up = match (name, along > 0.0) {
                ("z", true) => " (up)",
                ("z", false) => " (down)",
                _ => "",
            };
            return format!("{}{name}{up}", if along > 0.0 { "+" } else { "-" });
        }
    }
    let shown = v.to_array().map(|c| if c.abs() < SMALL { 0.0 } else { c });
    format!("({:.2}, {:.2}, {:.2})", shown[0], shown[1], shown[2])
}

/// Most ids that are named one by one.
const MOST_NAMED: usize = 6;

/// Ids, or how many there are.
pub fn listed(parts: &[usize], ids: &[&str]) -> String {
    let names: Vec<&str> = parts.iter().take(MOST_NAMED).map(|&p| ids[p]).collect();
    match parts.len().checked_sub(MOST_NAMED) {
        Some(more) if more > 0 => format!("{} and {more} more", names.join(", ")),
        _ => names.join(", "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn poses_accumulate_over_steps_of_every_kind() {
        let steps = json!([
            {"parts": ["b"], "kind": "translation", "direction": [0, 0, 1], "distance": 2.0, "stays": ["a"]},
            {"parts": ["b"], "kind": "screw", "point": [1, 0, 0], "axis": [0, 0, 2], "angle": std::f64::consts::PI,
             "advance": 1.0, "stays": ["a"], "ends": "inside"},
            {"parts": ["a", "b"], "kind": "several", "stays": [], "motions": [
                {"parts": ["a"], "kind": "translation", "direction": [1, 0, 0], "distance": 1.0},
                {"parts": ["b"], "kind": "translation", "direction": [-1, 0, 0], "distance": 1.0}]},
        ]);
        let read = read(&steps, &["a", "b"]);
        assert_eq!(read.unread, None);
        let after = |done| displacements(&read.moves, 2, done)[1].transform_point3(DVec3::ZERO);
        assert!(after(1.0).abs_diff_eq(DVec3::new(0.0, 0.0, 2.0), 1e-15));
        assert!(after(2.0).abs_diff_eq(DVec3::new(2.0, 0.0, 3.0), 1e-15));
        assert!(after(2.5).abs_diff_eq(DVec3::new(1.5, 0.0, 3.0), 1e-15));
        assert!(after(9.0).abs_diff_eq(DVec3::new(1.0, 0.0, 3.0), 1e-15));
    }

    #[test]
    fn what_is_not_known_is_named() {
        let step = |kind: &str, part: &str| json!([{"parts": [part], "kind": kind, "stays": []}]);
        for (steps, word) in
            [(step("wobble", "a"), "wobble"), (step("screw", "a"), "point"), (json!([{}]), "none")]
        {
            let why = read(&steps, &["a"]).unread.unwrap();
            assert!(why.contains(word), "{why}");
        }
    }
}
