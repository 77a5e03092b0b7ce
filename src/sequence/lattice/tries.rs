//! Takes ways in which a puzzle's pieces lie together, as voxels; gives which of them come apart.
//!
//! Sound, and complete where the search does not give up: by moves along the axes, but for sets that groups allow to stay
//! together. Not promised: how they come apart; the plan is made anew for the way that is taken.

use super::apart::take_apart;
use super::pairs::{Brick, WIDEST, around};
use super::search::{Looks, Piece, Scene};
use super::starts::can_start;
use super::tables::Tables;
use crate::spec::puzzle::groups::Groups;
use crate::watch::{All, Watch};
use rayon::prelude::*;

/// One way: the boxes of each piece, from least corners up to but not including the others.
pub type Lying = Vec<Vec<Brick>>;

/// Whether a way comes apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tried {
    pub comes_apart: bool,
    /// Positions that were looked at.
    pub positions: usize,
}

/// What is known from way to way.
#[derive(Debug, Default)]
pub struct Tries {
    tables: Tables,
}

impl Tries {
    /// Each way by itself, in their order. `most`: positions for each.
    pub fn come_apart(&mut self, ways: &[(Lying, Option<Groups>)], most: usize, watch: &Watch) -> Vec<Tried> {
        let scenes: Vec<Option<Scene>> = ways.iter().map(|w| self.scene(&w.0)).collect();
        let stage = watch.stage("moves along the axes", "positions", All::Open);
        let one = |(scene, (_, groups)): (&Option<Scene>, &(Lying, Option<Groups>))| {
            let Some(scene) = scene else { return Tried { comes_apart: false, positions: 0 } };
            let all: Vec<usize> = (0..scene.pieces.len()).collect();
            let looks = Looks { watch, stage: &stage };
            let apart = take_apart(scene, &all, most, groups.as_ref(), &looks);
            Tried { comes_apart: apart.whole.kept().is_empty(), positions: apart.states }
        };
        scenes.par_iter().zip(ways).map(one).collect()
    }

    /// None where nothing can start, or where it is more than this stage takes.
    fn scene(&mut self, way: &Lying) -> Option<Scene> {
        let narrow = |bricks: &Vec<Brick>| {
            let around = around(bricks);
            (0..3).all(|k| around.hi[k] - around.lo[k] <= WIDEST)
        };
        let can_start = way.len() == 1 || can_start(way)?;
        let piece = |bricks: &Vec<Brick>| Piece { bricks: bricks.clone(), held: false, weight: 1 };
        (can_start && way.iter().all(narrow))
            .then(|| Scene::with(way.iter().map(piece).collect(), &mut self.tables))
    }
}
