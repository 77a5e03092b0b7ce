//! Takes a puzzle and a solution; gives where its pieces lie, voxel by voxel, or every place where they do not fit.

use crate::spec::puzzle::turn::{Matrix, TURNS, apply, matrix};
use crate::spec::puzzle::{Fill, Placement, Puzzle, Shape, Solution};
use std::collections::{BTreeMap, BTreeSet};

/// So many misfits are listed one by one.
const LISTED: usize = 20;

/// A place where a solution does not hold. Voxels as the shape to fill counts them.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Misfit {
    #[error("pieces {a} and {b} both fill the voxel {at:?}")]
    Overlap { a: String, b: String, at: [i32; 3] },
    #[error("piece {id} fills the voxel {at:?}, which is not in the shape to fill")]
    Outside { id: String, at: [i32; 3] },
    #[error("no piece fills the voxel {at:?}")]
    Hole { at: [i32; 3] },
    #[error("piece {id} is its mirror image, and no turn makes that of it")]
    Mirrored { id: String },
    #[error("{holes} voxels stay empty, and no more than {most} may")]
    TooEmpty { holes: usize, most: usize },
}

/// A piece in place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Placed {
    pub id: String,
    /// Index of its shape.
    pub shape: usize,
    /// A proper turn.
    pub turn: Matrix,
    /// Where the hot spot lies.
    pub at: [i32; 3],
    pub voxels: Vec<[i32; 3]>,
}

/// The pieces that a solution uses, in the order of its placements.
pub fn placed(puzzle: &Puzzle, solution: &Solution) -> Result<Vec<Placed>, Vec<Misfit>> {
    let used: Vec<(usize, Placement)> =
        puzzle.problem.shapes().zip(&solution.placements).filter_map(|(s, p)| Some((s, (*p)?))).collect();
    let ids = ids(puzzle, &used.iter().map(|u| u.0).collect::<Vec<_>>());
    let (mut all, mut wrong) = (Vec::new(), Vec::new());
    for ((shape, placement), id) in used.into_iter().zip(ids) {
        match proper(&puzzle.shapes[shape], placement) {
            Some((turn, at)) => {
                let voxels = voxels(&puzzle.shapes[shape], turn, at);
                all.push(Placed { id, shape, turn, at, voxels });
            }
            None => wrong.push(Misfit::Mirrored { id }),
        }
    }
    wrong.extend(overlaps(&all));
    if wrong.is_empty() {
        wrong = filled(puzzle, &all);
    }
    wrong.truncate(LISTED);
    if wrong.is_empty() { Ok(all) } else { Err(wrong) }
}

pub fn voxels(shape: &Shape, turn: Matrix, at: [i32; 3]) -> Vec<[i32; 3]> {
    let place = |v: [i32; 3]| {
        let from_hot = apply(turn, std::array::from_fn(|k| v[k] - shape.hot[k]));
        std::array::from_fn(|k| from_hot[k] + at[k])
    };
    shape.voxels.iter().map(|v| place(v.at)).collect()
}

/// The placement by a proper turn; None where the piece would have to be mirrored.
fn proper(shape: &Shape, placement: Placement) -> Option<(Matrix, [i32; 3])> {
    let turn = matrix(placement.turn);
    if placement.turn < TURNS {
        return Some((turn, placement.at));
    }
    let goal: BTreeSet<[i32; 3]> = voxels(shape, turn, placement.at).into_iter().collect();
    let least = goal.first().copied()?;
    (0..TURNS).map(matrix).find_map(|turn| {
        let here: BTreeSet<[i32; 3]> = voxels(shape, turn, [0; 3]).into_iter().collect();
        let from = here.first().copied()?;
        let at: [i32; 3] = std::array::from_fn(|k| least[k] - from[k]);
        let moved = |v: &[i32; 3]| std::array::from_fn(|k| v[k] + at[k]);
        (here.iter().map(moved).eq(goal.iter().copied())).then_some((turn, at))
    })
}

/// Names: of the shape, or s1, s2 ... as BurrTools counts shapes; -1, -2 behind it where there are several.
fn ids(puzzle: &Puzzle, shapes: &[usize]) -> Vec<String> {
    let plain = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_' | ' ' | '.') { c } else { '_' };
    let number = |s: usize| format!("s{}", s + 1);
    let name = |s: usize| {
        let name: String = puzzle.shapes[s].name.chars().map(plain).take(LONGEST_NAME).collect();
        let name = name.trim_matches([' ', '.']).to_string();
        if name.is_empty() { number(s) } else { name }
    };
    let used: BTreeSet<usize> = shapes.iter().copied().collect();
    let alone = |s: usize| used.iter().filter(|&&other| name(other) == name(s)).count() == 1;
    let base: BTreeMap<usize, String> = used
        .iter()
        .map(|&s| (s, if alone(s) { name(s) } else { format!("{} {}", name(s), number(s)) }))
        .collect();
    let mut seen: BTreeMap<usize, usize> = BTreeMap::new();
    let id = |&s: &usize| {
        let count = seen.entry(s).or_insert(0);
        *count += 1;
        let several = shapes.iter().filter(|&&other| other == s).count() > 1;
        if several { format!("{}-{count}", base[&s]) } else { base[&s].clone() }
    };
    shapes.iter().map(id).collect()
}

/// Characters of a name that an id keeps: files are named after it.
const LONGEST_NAME: usize = 60;

fn overlaps(all: &[Placed]) -> Vec<Misfit> {
    let mut by: BTreeMap<[i32; 3], usize> = BTreeMap::new();
    let mut wrong = Vec::new();
    for (k, piece) in all.iter().enumerate() {
        for &at in &piece.voxels {
            if let Some(other) = by.insert(at, k).filter(|&other| other != k) {
                wrong.push(Misfit::Overlap { a: all[other].id.clone(), b: piece.id.clone(), at });
            }
        }
    }
    wrong
}

/// Whether the pieces fill the result. Pieces are set down in its voxels; some files count from its hot spot.
fn filled(puzzle: &Puzzle, all: &[Placed]) -> Vec<Misfit> {
    let result = &puzzle.shapes[puzzle.problem.result];
    let found = against(puzzle, all, [0; 3]);
    if found.is_empty() || result.hot == [0; 3] {
        return found;
    }
    let from_hot = against(puzzle, all, result.hot);
    if from_hot.is_empty() { from_hot } else { found }
}

fn against(puzzle: &Puzzle, all: &[Placed], shift: [i32; 3]) -> Vec<Misfit> {
    let result = &puzzle.shapes[puzzle.problem.result];
    let mut open: BTreeMap<[i32; 3], Fill> = result.voxels.iter().map(|v| (v.at, v.fill)).collect();
    let mut wrong = Vec::new();
    for piece in all {
        for v in &piece.voxels {
            let at = std::array::from_fn(|k| v[k] + shift[k]);
            if open.remove(&at).is_none() {
                wrong.push(Misfit::Outside { id: piece.id.clone(), at });
            }
        }
    }
    wrong.extend(open.iter().filter(|(_, f)| **f == Fill::Fixed).map(|(&at, _)| Misfit::Hole { at }));
    if let Some(most) = puzzle.problem.most_holes.filter(|&most| open.len() > most) {
        wrong.push(Misfit::TooEmpty { holes: open.len(), most });
    }
    wrong
}
