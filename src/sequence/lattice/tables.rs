//! Takes shapes as bricks; gives them numbers, and for two of them what is known of the pair.
//!
//! Kept from scene to scene, so that what one assembly of a puzzle's pieces finds out serves the next. Not promised: that
//! anything is kept, beyond `MOST_BYTES`.

use super::pairs::{Brick, Pair};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Tables are dropped, all at once, before they take more than about 256 MiB: a third of what positions may take.
const MOST_BYTES: usize = 256 << 20;

/// Shapes, each from its least corner, by number; pairs of them, the lower number first.
#[derive(Debug, Default)]
pub struct Tables {
    numbers: BTreeMap<Vec<Brick>, usize>,
    shapes: Vec<Vec<Brick>>,
    pairs: BTreeMap<(usize, usize), Arc<Pair>>,
    bytes: usize,
}

impl Tables {
    /// Forgets all where it is too much. Numbers given before do not hold any more.
    pub fn make_room(&mut self) {
        if self.bytes > MOST_BYTES {
            *self = Tables::default();
        }
    }

    pub fn shape(&mut self, bricks: Vec<Brick>) -> usize {
        let next = self.shapes.len();
        let number = *self.numbers.entry(bricks.clone()).or_insert(next);
        if number == next {
            self.shapes.push(bricks);
        }
        number
    }

    pub fn pair(&mut self, (a, b): (usize, usize)) -> Arc<Pair> {
        let Tables { shapes, pairs, bytes, .. } = self;
        let made = pairs.entry((a, b)).or_insert_with(|| {
            let pair = Pair::new(&shapes[a], &shapes[b]);
            *bytes += pair.bytes();
            Arc::new(pair)
        });
        Arc::clone(made)
    }
}
