//! Takes the path of a puzzle file and what is asked about in it; gives the spec with a solution, stated or found here.
//!
//! Promised: what was found here is said to be. Where nothing is stated, the first way to fill the result that comes
//! apart on the lattice is taken, or else the first way. Not promised: that there is none where none was found within
//! the bounds on counted work.

use super::args::PuzzleArgs;
use super::filled::found;
use super::load::{Loaded, Placed};
use super::questions::locked;
use super::told::Trouble;
use crate::assembly::PartIx;
use crate::fault::Fault;
use crate::report::answer::Certificate;
use crate::sequence::lattice::answer::Asked;
use crate::sequence::lattice::{self, NoLattice, apart::written, moves::MOST_PARTS};
use crate::sequence::{Outcome, Plan};
use crate::spec::Subject;
use crate::spec::puzzle::groups::Groups;
use crate::spec::puzzle::{self, Choice, Puzzle, Solution, text::text};
use crate::watch::Watch;
use std::path::Path;

/// Positions looked at for parts that straight moves do not take apart.
const MOST_STATES: usize = 1_000_000;

/// A puzzle file as asked.
pub fn loaded(file: &Path, asked: &PuzzleArgs, watch: &Watch) -> Result<Loaded, Trouble> {
    let choice = Choice { problem: asked.problem, solution: asked.solution, unit_mm: asked.unit };
    let mut spec = puzzle::parse(&puzzle::read_text(file)?, file, choice)?;
    let shown = file.display().to_string();
    let Subject::Meshes(meshes) = &mut spec.subject else {
        return Ok(Loaded::new(spec, String::new(), watch));
    };
    let unit_mm = meshes.mm_per_unit;
    let mut remarks = Vec::new();
    if let Some(puzzle) = &mut meshes.puzzle {
        if puzzle.solution.is_none() {
            let (solution, how) = solved(puzzle, asked, &shown, watch)?;
            puzzle.solution = Some(solution);
            remarks.push(how);
        }
        remarks.extend(told(puzzle, unit_mm, asked));
        let text = text(puzzle, unit_mm);
        return Ok(Loaded { remarks, ..Loaded::new(spec, text, watch) });
    }
    Ok(Loaded::new(spec, String::new(), watch))
}

/// A way to fill the result, and in words how it was found; `file` names the file in a fault.
fn solved(
    puzzle: &Puzzle,
    asked: &PuzzleArgs,
    file: &str,
    watch: &Watch,
) -> Result<(Solution, String), Trouble> {
    let (number, of) = puzzle.number;
    let several = of > 1 && asked.problem.is_none();
    let which = several.then(|| format!("problem {number} of {of} (--problem asks for another): "));
    let wrong = |(what, hint): (String, String)| {
        let what = which.unwrap_or_default() + &what;
        Fault { file: file.into(), place: None, key: String::new(), what, hint }
    };
    match found(puzzle, watch) {
        Err(_) if watch.is_stopped() => {
            Err(Trouble::Stopped("while a way to fill the result was searched".into()))
        }
        found => Ok(found.map_err(wrong)?),
    }
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
    let groups = groups.then(|| {
        "the puzzle's groups say which pieces need not be parted: moves along the axes leave them together".to_string()
    });
    let used = puzzle.solution.iter().flat_map(|s| &s.placements).flatten().count();
    let many = (used > MOST_PARTS).then(|| {
        format!(
            "{used} pieces: a level is counted for up to {MOST_PARTS}, straight moves are searched for more"
        )
    });
    [problem, solution, level, unit, groups, many].into_iter().flatten().collect()
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
        groups: puzzle_of(placed)
            .and_then(Groups::of)
            .map(|g| g.among(&of.iter().map(|p| p.at()).collect::<Vec<_>>())),
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
