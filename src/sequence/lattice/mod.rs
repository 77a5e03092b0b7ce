//! Takes an assembly whose convex cells are boxes on one lattice; gives how it comes apart by moves along the axes,
//! with moves that stop half way, or why it does not.
//!
//! Sound: each move is counted on the bricks themselves. For each set the moves until the first parting are the fewest
//! where that is said. Exhaustive over translations where a set is `Exhausted`. Not promised: turns, and plans of the
//! fewest moves in all.

pub mod answer;
pub mod apart;
pub mod bricks;
pub mod moves;
pub mod pairs;
pub mod search;
pub mod starts;
pub mod states;
pub mod tables;
pub mod tries;

use crate::assembly::{Assembly, PartIx};
use crate::spec::puzzle::groups::Groups;
use crate::watch::{All, Watch};
use apart::{Apart, take_apart};
pub use bricks::NoLattice;

use bricks::{Lattice, pieces};
use search::{Looks, Piece, Scene};

/// Bytes that positions may take in all, kept or not: 768 MiB, so that a machine of 2 GiB holds a search.
const MOST_BYTES: usize = 768 << 20;

/// Bytes for each position beside its coordinates: where it came from (4), and up to four slots (4 each) while the table
/// of slots is doubled.
const BYTES_BESIDE: usize = 20;

/// An assembly on its lattice, taken apart. Indices of pieces are places in the list of parts asked for.
#[derive(Clone, Debug)]
pub struct OnLattice {
    pub lattice: Lattice,
    pub pieces: Vec<Piece>,
    pub apart: Apart,
    /// The bound on positions.
    pub most: usize,
}

/// Takes the parts apart on their lattice. `step`: the lattice's where it is known, in model units; `weight`: where two
/// sets part, the one with the heaviest part counts as the one that stays; `most`: positions looked at in all, by default
/// as many as memory holds.
pub fn on_lattice(
    asm: &Assembly,
    parts: &[PartIx],
    step: Option<f64>,
    weight: impl Fn(PartIx) -> i32,
    most: Option<usize>,
) -> Result<OnLattice, NoLattice> {
    on_lattice_watched(asm, parts, step, weight, most, None, &Watch::default())
}

/// The same, watched: a set that is being looked at when it is stopped stays together. `groups`: of the parts, in the
/// order of `parts`; what they allow stays together.
pub fn on_lattice_watched(
    asm: &Assembly,
    parts: &[PartIx],
    step: Option<f64>,
    weight: impl Fn(PartIx) -> i32,
    most: Option<usize>,
    groups: Option<&Groups>,
    watch: &Watch,
) -> Result<OnLattice, NoLattice> {
    let (lattice, pieces) = pieces(asm, parts, step, weight)?;
    let most = most.unwrap_or(MOST_BYTES / (3 * parts.len() + BYTES_BESIDE));
    let all: Vec<usize> = (0..parts.len()).collect();
    let scene = Scene::new(pieces);
    let stage = watch.stage("moves along the axes", "positions", All::AtMost(most as u64));
    let apart = take_apart(&scene, &all, most, groups, &Looks { watch, stage: &stage });
    Ok(OnLattice { lattice, pieces: scene.pieces, apart, most })
}
