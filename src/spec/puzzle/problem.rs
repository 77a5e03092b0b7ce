//! Takes `problem` elements; gives the one asked about with the solution asked about.
//!
//! Not promised: that solutions which were not asked about are free of faults.

use super::level;
use super::shape::{Fill, Shape};
use super::turn::{MIRRORED, TURNS};
use super::xml::Node;
use super::{Choice, Pieces, Placement, Problem, Reading, Solution};
use crate::fault::{Fault, quoted};
use std::collections::BTreeSet;

/// Most pieces of one shape, and of one problem.
const MOST_PIECES: i64 = 10_000;

/// Farthest that a piece is set down, in voxels.
const FARTHEST: i64 = 100_000;

/// Number of a turn by which older files say that a piece is not used.
const UNUSED: i64 = 255;

/// What the problem is read for.
pub struct Wanted<'s> {
    pub shapes: &'s [Shape],
    pub choice: Choice,
}

/// The problem asked about, and its number from 1.
pub fn chosen<'n>(
    reading: &mut Reading,
    root: &Node,
    problems: &[&'n Node],
    choice: Choice,
) -> Option<(usize, &'n Node)> {
    let solved = |p: &&Node| p.first("solutions").is_some_and(|s| s.first("solution").is_some());
    let default = problems.iter().position(solved).unwrap_or(0) + 1;
    let number = choice.problem.unwrap_or(default);
    match number.checked_sub(1).and_then(|k| problems.get(k)) {
        Some(node) => Some((number, node)),
        None if problems.is_empty() => {
            let hint = "a problem says which pieces fill which result";
            reading.fault(root, "problems", "there is no problem in the file", hint);
            None
        }
        None => {
            missing(reading, "problem", number, problems.len());
            None
        }
    }
}

fn missing(reading: &mut Reading, what: &str, number: usize, count: usize) {
    let hint = format!("they are counted from 1 to {count}");
    let what = format!("there is no {what} number {number}");
    reading.faults.push(Fault { file: reading.file.clone(), place: None, key: String::new(), what, hint });
}

/// The problem, its solution, and the number of that from 1 with how many are stated.
pub fn problem(
    reading: &mut Reading,
    node: &Node,
    wanted: &Wanted,
) -> Option<(Problem, Option<Solution>, (usize, usize))> {
    let last = wanted.shapes.len() as i64 - 1;
    let listed: Vec<&Node> = node.first("shapes").map_or(Vec::new(), |s| s.all("shape").collect());
    let all: Vec<Option<Pieces>> = listed.iter().map(|p| pieces(reading, p, wanted)).collect();
    let result = match node.first("result") {
        Some(result) => reading.number(result, "id", None, (0, last)),
        None => {
            reading.fault(node, "result", "is missing", "<result id=\"0\"/> names the shape to fill");
            None
        }
    };
    let most_holes = match node.attribute("maxHoles") {
        Some(_) => Some(reading.number(node, "maxHoles", None, (0, i64::from(u32::MAX)))?),
        None => None,
    };
    let pieces = all.into_iter().collect::<Option<Vec<Pieces>>>()?;
    let count = pieces.iter().map(|p| p.most).sum::<usize>();
    if count == 0 || count as i64 > MOST_PIECES {
        reading.fault(node, "shapes", format!("{count} pieces"), "at least one, at most 10,000");
        return None;
    }
    let allowed = allowed(node);
    let problem = Problem {
        name: node.attribute("name").unwrap_or_default().trim().to_string(),
        pieces,
        result: result? as usize,
        allowed,
        most_holes: most_holes.map(|n| n as usize),
    };
    let (solution, chosen) = solution(reading, node, count, &problem, wanted.choice)?;
    Some((problem, solution, chosen))
}

fn pieces(reading: &mut Reading, node: &Node, wanted: &Wanted) -> Option<Pieces> {
    let shape = reading.number(node, "id", None, (0, wanted.shapes.len() as i64 - 1));
    let bounds = (0, MOST_PIECES);
    let (least, most) = match node.attribute("count") {
        Some(_) => {
            let count = reading.number(node, "count", None, bounds);
            (count, count)
        }
        None => (reading.number(node, "min", Some(1), bounds), reading.number(node, "max", Some(1), bounds)),
    };
    let (least, most, shape) = (least? as usize, most? as usize, shape? as usize);
    if least > most {
        reading.fault(node, "min", format!("{least} is more than max, {most}"), "min is at most max");
        return None;
    }
    let drawn = &wanted.shapes[shape];
    if most > 0 && drawn.voxels.is_empty() {
        reading.fault(node, "id", format!("shape {shape} has no voxels"), "draw it, or do not use it");
        return None;
    }
    if most > 0 && drawn.voxels.iter().any(|v| v.fill == Fill::Variable) {
        let hint = "only the shape to fill may have voxels that stay empty";
        reading.fault(node, "id", format!("shape {shape} has variable voxels and is a piece"), hint);
        return None;
    }
    let groups = groups(reading, node, most)?;
    Some(Pieces { shape, least, most, groups })
}

fn groups(reading: &mut Reading, node: &Node, most: usize) -> Option<Vec<(u32, usize)>> {
    let whole = reading.number(node, "group", Some(0), (0, i64::from(u16::MAX)))?;
    let mut out: Vec<(u32, usize)> = (whole > 0).then_some((whole as u32, most)).into_iter().collect();
    for group in node.all("group") {
        let number = reading.number(group, "group", None, (0, i64::from(u16::MAX)));
        let count = reading.number(group, "count", None, (0, MOST_PIECES));
        out.push((number? as u32, count? as usize));
    }
    Some(out)
}

/// Pairs of colours, from 1; the file counts from 0.
fn allowed(node: &Node) -> BTreeSet<(u32, u32)> {
    let pairs = node.first("bitmap").into_iter().flat_map(|b| b.all("pair").collect::<Vec<_>>());
    let of = |pair: &Node, key: &str| pair.attribute(key).and_then(|t| t.trim().parse::<u16>().ok());
    let both = |pair: &Node| Some((u32::from(of(pair, "piece")?) + 1, u32::from(of(pair, "result")?) + 1));
    pairs.filter_map(both).collect()
}

type Chosen = (Option<Solution>, (usize, usize));

fn solution(
    reading: &mut Reading,
    node: &Node,
    count: usize,
    problem: &Problem,
    choice: Choice,
) -> Option<Chosen> {
    let stated: Vec<&Node> = node.first("solutions").map_or(Vec::new(), |s| s.all("solution").collect());
    if stated.is_empty() {
        return Some((None, (choice.solution.unwrap_or(1), 0)));
    }
    let number = choice.solution.unwrap_or(1);
    let Some(node) = number.checked_sub(1).and_then(|k| stated.get(k)) else {
        missing(reading, "solution", number, stated.len());
        return None;
    };
    let Some(assembly) = node.first("assembly") else {
        reading.fault(node, "assembly", "is missing", "it says where each piece lies");
        return None;
    };
    let placements = placements(reading, assembly, count)?;
    let mut first = 0;
    for pieces in &problem.pieces {
        let used = placements[first..first + pieces.most].iter().flatten().count();
        first += pieces.most;
        if used < pieces.least {
            let what = format!("{used} pieces of shape {} are used, not {}", pieces.shape, pieces.least);
            reading.fault(assembly, "", what, "the problem says how many at least");
            return None;
        }
    }
    Some((Some(Solution { placements, level: level::stated(node) }), (number, stated.len())))
}

/// Four numbers for each piece, x y z and its turn, or one `x`.
fn placements(reading: &mut Reading, node: &Node, count: usize) -> Option<Vec<Option<Placement>>> {
    let mut words = node.text.split_ascii_whitespace();
    let mut out = Vec::new();
    while let Some(word) = words.next() {
        if word == "x" {
            out.push(None);
            continue;
        }
        let mut numbers = [Some(word), words.next(), words.next(), words.next()].into_iter().map(|w| {
            let number = w.and_then(|w| w.parse::<i64>().ok());
            number.filter(|n| (-FARTHEST..=FARTHEST).contains(n))
        });
        let all: Option<Vec<i64>> = numbers.by_ref().collect();
        match all.as_deref() {
            Some(&[.., UNUSED]) => out.push(None),
            Some(&[x, y, z, turn]) if (0..(TURNS + MIRRORED) as i64).contains(&turn) => {
                out.push(Some(Placement { at: [x as i32, y as i32, z as i32], turn: turn as usize }));
            }
            _ => {
                let what = format!("placement {} begins with {} and is not one", out.len() + 1, quoted(word));
                reading.fault(
                    node,
                    "",
                    what,
                    "x y z and a turn from 0 to 47 for each piece, or x where it is not used",
                );
                return None;
            }
        }
    }
    if out.len() == count {
        return Some(out);
    }
    let what = format!("{} placements for {count} pieces", out.len());
    reading.fault(
        node,
        "",
        what,
        "four numbers for each piece, shape by shape, as many as there are at most",
    );
    None
}
