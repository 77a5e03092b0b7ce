//! Takes the path of a puzzle file and what is asked about in it; gives the spec with a solution, stated or found here.
//!
//! Promised: what was found here is said to be. Where nothing is stated, the first way to fill the result that comes
//! apart on the lattice is taken, or else the first way. Not promised: that there is none where none was found within
//! the bounds on counted work.

use super::args::PuzzleArgs;
use super::load::{Loaded, Placed};
use super::questions::locked;
use super::told::Trouble;
use crate::assembly::PartIx;
use crate::assembly::voxel;
use crate::assembly::voxel::cover::{Covered, assemblies_watched};
use crate::fault::Fault;
use crate::report::answer::Certificate;
use crate::sequence::lattice::answer::Asked;
use crate::sequence::lattice::{self, NoLattice, apart::written, on_lattice_watched};
use crate::sequence::{Outcome, Plan};
use crate::spec::Subject;
use crate::spec::puzzle::{self, Choice, Puzzle, Solution, text::text};
use crate::watch::{All, Watch};
use std::ops::ControlFlow;
use std::path::Path;

/// Placements that are tried to fill a result: about half a minute for a puzzle of twenty pieces.
const MOST_WORK: usize = 3_000_000;

/// Ways to fill the result that are taken apart before the first one is taken.
const MOST_TRIED: usize = 2_000;

/// Positions looked at for each of them, and for parts that straight moves do not take apart.
const MOST_STATES: usize = 1_000_000;

/// A puzzle file as asked.
pub fn loaded(file: &Path, asked: &PuzzleArgs, watch: &Watch) -> Result<Loaded, Trouble> {
    let choice = Choice { problem: asked.problem, solution: asked.solution, unit_mm: asked.unit };
    let mut spec = puzzle::parse(&puzzle::read_text(file)?, file, choice)?;
    let (name, shown) = (spec.name.clone(), file.display().to_string());
    let Subject::Meshes(meshes) = &mut spec.subject else {
        return Ok(Loaded::new(spec, String::new(), watch));
    };
    let unit_mm = meshes.mm_per_unit;
    let mut remarks = Vec::new();
    if let Some(puzzle) = &mut meshes.puzzle {
        if puzzle.solution.is_none() {
            let wrong = |(what, hint)| Fault { file: shown, place: None, key: String::new(), what, hint };
            let (solution, how) = match found(&name, puzzle, watch) {
                Err(_) if watch.is_stopped() => {
                    return Err(Trouble::Stopped("while a way to fill the result was searched".into()));
                }
                found => found.map_err(wrong)?,
            };
            puzzle.solution = Some(solution);
            remarks.push(how);
        }
        remarks.extend(told(puzzle, unit_mm, asked));
        let text = text(puzzle, unit_mm);
        return Ok(Loaded { remarks, ..Loaded::new(spec, text, watch) });
    }
    Ok(Loaded::new(spec, String::new(), watch))
}

/// What was taken where nothing was said.
fn told(puzzle: &Puzzle, unit_mm: f64, asked: &PuzzleArgs) -> Vec<String> {
    let (number, of) = puzzle.number;
    let several = of > 1 && asked.problem.is_none();
    let problem = several.then(|| format!("problem {number} of {of} (--problem asks for another)"));
    let (number, of) = puzzle.chosen;
    let several = of > 1 && asked.solution.is_none();
    let solution = several.then(|| format!("stated solution {number} of {of} (--solution asks for another)"));
    let level = puzzle.solution.as_ref().and_then(|s| s.level.as_ref());
    let level = level.map(|l| format!("the file states {} moves for this solution", written(l)));
    let unit =
        asked.unit.is_none().then(|| format!("one voxel is {unit_mm} mm (--unit \"10 mm\" says otherwise)"));
    let groups = puzzle.problem.pieces.iter().any(|p| !p.groups.is_empty());
    let groups = groups.then(|| "groups are not used: all pieces are taken apart".to_string());
    [problem, solution, level, unit, groups].into_iter().flatten().collect()
}

/// A way to fill the result, and in words how it was found; or a fault and its hint.
fn found(name: &str, puzzle: &Puzzle, watch: &Watch) -> Result<(Solution, String), (String, String)> {
    let wanted = puzzle.chosen.0.max(1);
    let (mut first, mut good, mut tried, mut apart) = (None, None, 0, 0);
    let stage = watch.stage("filling the result", "ways tried", All::AtMost(MOST_TRIED as u64));
    let end = assemblies_watched(puzzle, MOST_WORK, watch, |solution| {
        tried += 1;
        stage.reach(tried);
        if comes_apart(name, puzzle, &solution, watch) {
            apart += 1;
            if apart == wanted {
                good = Some(solution);
                return ControlFlow::Break(());
            }
        } else if first.is_none() {
            first = Some(solution);
        }
        if tried < MOST_TRIED && !watch.is_stopped() {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    });
    if let Some(solution) = good {
        return Ok((
            solution,
            format!(
                "no solution is stated: found here, way {tried} to fill the result, the {wanted}. that comes apart"
            ),
        ));
    }
    let all = match end {
        Covered::All => "all",
        _ if watch.is_stopped() => "those until the user stopped it,",
        _ => "the first",
    };
    match first {
        Some(solution) if wanted == 1 => Ok((
            solution,
            format!(
                "no solution is stated: of {all} {tried} ways to fill the result none was found to come apart; this is the first"
            ),
        )),
        None if end == Covered::All && tried == 0 => Err((
            "its pieces do not fill the result in any way".into(),
            "no solution is stated, and there is none".into(),
        )),
        _ => Err((
            format!(
                "no solution is stated, and {apart} that come apart were found here among {all} {tried} ways to fill the result"
            ),
            "solve the puzzle with BurrTools and save it, or ask for another --solution".into(),
        )),
    }
}

fn comes_apart(name: &str, puzzle: &Puzzle, solution: &Solution, watch: &Watch) -> bool {
    let Ok(asm) = voxel::assembly(name, puzzle, solution, 1.0) else { return false };
    let all: Vec<_> = asm.ids().collect();
    let found = on_lattice_watched(&asm, &all, Some(1.0), |_| 1, Some(MOST_STATES), watch);
    found.is_ok_and(|f| f.apart.whole.kept().is_empty())
}

/// Any plan of a search, or why it was not made.
type Searched = Result<Plan<Certificate>, String>;

/// The plan for these parts. Pieces of a puzzle are taken apart on their lattice first, so that moves are counted as
/// puzzlers do; other parts by `straight` moves first. Where one way does not take all apart, the other is asked.
pub fn plan(
    placed: &Placed,
    of: &[PartIx],
    clearance_mm: f64,
    straight: impl FnOnce() -> Searched,
) -> Searched {
    let is_whole = |plan: &Plan<Certificate>| plan.outcome == Outcome::Assembled;
    if puzzle_of(placed).is_some() && clearance_mm == 0.0 {
        return match on_its_lattice(placed, of, None) {
            Ok(plan) if is_whole(&plan) || plan.stopped => Ok(plan),
            Ok(plan) => Ok(straight().ok().filter(is_whole).unwrap_or(plan)),
            Err(_) => straight(),
        };
    }
    match straight() {
        Ok(plan) if is_whole(&plan) => Ok(plan),
        Ok(plan) if plan.stopped => Ok(plan),
        found => match on_its_lattice(placed, of, Some(MOST_STATES)) {
            Ok(plan) if clearance_mm == 0.0 => Ok(plan),
            // With air between them the parts can do all that they can do without; fewer moves may do.
            Ok(plan) if is_whole(&plan) => Ok(Plan { counted: None, ..plan }),
            _ => found,
        },
    }
}

fn puzzle_of(placed: &Placed) -> Option<&Puzzle> {
    match &placed.spec.subject {
        Subject::Meshes(meshes) => meshes.puzzle.as_deref(),
        Subject::Woven(_) => None,
    }
}

fn on_its_lattice(
    placed: &Placed,
    of: &[PartIx],
    most: Option<usize>,
) -> Result<Plan<Certificate>, NoLattice> {
    let joined = &placed.joined;
    let weights = puzzle_of(placed).map(weights);
    let asked = Asked {
        asm: &joined.assembly,
        parts: of,
        step: weights.is_some().then_some(1.0),
        weight: |p: PartIx| weights.as_ref().and_then(|w| w.get(p.at()).copied()).unwrap_or(1),
        most,
        watch: &placed.watch,
    };
    lattice::answer::plan(&asked, |set| locked(joined, set))
}

/// Of the pieces that are used, in their order.
fn weights(puzzle: &Puzzle) -> Vec<i32> {
    let placements = puzzle.solution.iter().flat_map(|s| &s.placements);
    let used = puzzle.problem.shapes().zip(placements).filter(|(_, p)| p.is_some());
    used.map(|(shape, _)| puzzle.shapes[shape].weight).collect()
}
