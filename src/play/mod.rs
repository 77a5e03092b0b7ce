//! Takes an assembly with its contact patches; gives how far each part can shift and tilt for each unit of air in the
//! contacts, or that it is not held.
//!
//! First order, and in full: all other parts give way as far as they can. Every contact gets the same air (twice the
//! clearance of a face); contacts without a row of their own do not count, so that play is never understated for them.
//! Not promised: the finite motion, which turns and so meets other corners; `verify` follows it.

mod program;

use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::locking::{Freedom, Row, Twist, Unknowns, rows};
use crate::watch::{All, Stage, Watch};
use glam::DVec3;
use program::{Farthest, Program};
use rayon::prelude::*;

/// A way to move a part: along or about a world axis, through the part's centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Shift,
    Tilt,
}

/// The farthest that one part gets in one way.
#[derive(Clone, Debug)]
pub struct Extreme {
    pub part: PartIx,
    pub kind: Kind,
    /// World axis, 0 to 2, and the way along or about it.
    pub axis: usize,
    pub sign: f64,
    pub reach: Reach,
}

#[derive(Clone, Debug)]
pub enum Reach {
    /// For one unit of air: `value` in model units (radians for tilts), nothing beyond `bound`; all parts' twists.
    Held {
        value: f64,
        bound: f64,
        twists: Vec<(PartIx, Twist)>,
    },
    /// No contact ends it: the part leaves, to first order, however little air there is.
    Endless {
        twists: Vec<(PartIx, Twist)>,
    },
    Unsolved {
        why: String,
    },
}

/// Programs times rows that are asked for at most: fifteen pieces with 39,000 rows are 7 million and take 50 s on two cores,
/// so some minutes.
pub const MOST_WORK: usize = 30_000_000;

/// Why a program is not solved that was not begun.
pub const STOPPED: &str = "stopped by the user";

/// Why play was not looked for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    #[error("{programs} programs over {rows} contact rows are more than are asked for at once")]
    TooMuch { programs: usize, rows: usize },
}

/// Play of `of` among all parts; `still` do not move.
pub fn play(
    assembly: &Assembly,
    patches: &[Patch],
    of: &[PartIx],
    still: &[PartIx],
) -> Result<Vec<Extreme>, Fault> {
    play_watched(assembly, patches, of, still, &Watch::default())
}

/// The same, watched: what is not solved when it is stopped stays so.
pub fn play_watched(
    assembly: &Assembly,
    patches: &[Patch],
    of: &[PartIx],
    still: &[PartIx],
    watch: &Watch,
) -> Result<Vec<Extreme>, Fault> {
    let rows = rows(patches, Freedom::Rigid);
    let unknowns = Unknowns::new(assembly, &rows, still, Freedom::Rigid);
    let movable: Vec<PartIx> = of.iter().copied().filter(|p| unknowns.column[p.at()].is_some()).collect();
    let programs = 12 * movable.len();
    if programs.saturating_mul(rows.len()) > MOST_WORK {
        return Err(Fault::TooMuch { programs, rows: rows.len() });
    }
    let stage = watch.stage("how far parts get", "programs", All::Just(programs as u64));
    let each = movable.par_iter().map(|&part| of_part(&rows, &unknowns, part, (watch, &stage)));
    Ok(each.collect::<Vec<_>>().concat())
}

fn of_part(
    rows: &[Row],
    unknowns: &Unknowns,
    part: PartIx,
    (watch, stage): (&Watch, &Stage),
) -> Vec<Extreme> {
    let mut program = Program::new(rows, unknowns);
    let Some(column) = unknowns.column[part.at()] else { return Vec::new() };
    let ways = [Kind::Shift, Kind::Tilt].into_iter().flat_map(|kind| (0..3).map(move |axis| (kind, axis)));
    let ways = ways.flat_map(|(kind, axis)| [1.0, -1.0].map(|sign| (kind, axis, sign)));
    ways.map(|(kind, axis, sign)| {
        if watch.is_stopped() {
            return Extreme { part, kind, axis, sign, reach: Reach::Unsolved { why: STOPPED.into() } };
        }
        // Rotations are unknowns times the part's lever.
        let (at, unit) = match kind {
            Kind::Shift => (column + axis, 1.0),
            Kind::Tilt => (column + 3 + axis, 1.0 / unknowns.lever[part.at()]),
        };
        let reach = match program.farthest(at, sign) {
            Farthest::Reached { x, value, bound } => {
                Reach::Held { value: value * unit, bound: bound * unit, twists: twists(unknowns, &x) }
            }
            Farthest::Endless { x } => Reach::Endless { twists: twists(unknowns, &x) },
            Farthest::Unsolved { why } => Reach::Unsolved { why },
        };
        stage.add(1);
        Extreme { part, kind, axis, sign, reach }
    })
    .collect()
}

fn twists(unknowns: &Unknowns, x: &[f64]) -> Vec<(PartIx, Twist)> {
    let columns = unknowns.column.iter().enumerate();
    columns
        .filter_map(|(p, c)| c.map(|c| (p, c)))
        .map(|(p, c)| {
            let vector = |k: usize| DVec3::new(x[c + k], x[c + k + 1], x[c + k + 2]);
            let twist = Twist {
                translation: vector(0),
                rotation: vector(3) / unknowns.lever[p],
                centre: unknowns.centre[p],
            };
            (PartIx(p as u32), twist)
        })
        .collect()
}
