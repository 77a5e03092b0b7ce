//! Takes placements; gives them by number, what is asked of many in a row side by side in memory.

use super::board::Way;
use crate::spec::puzzle::Placement;

pub struct Ways {
    entries: Vec<u32>,
    placements: Vec<Placement>,
    /// Words of one placement's bits.
    words: usize,
    bits: Vec<u64>,
    /// Where each placement's voxels begin; one more for the end.
    first: Vec<u32>,
    cells: Vec<u32>,
}

impl Ways {
    pub fn new(ways: &[Way]) -> Ways {
        let mut first = vec![0];
        let mut cells = Vec::new();
        for way in ways {
            cells.extend(&way.cells);
            first.push(cells.len() as u32);
        }
        Ways {
            entries: ways.iter().map(|w| w.entry as u32).collect(),
            placements: ways.iter().map(|w| w.placement).collect(),
            words: ways.first().map_or(0, |w| w.bits.len()),
            bits: ways.iter().flat_map(|w| w.bits.iter().copied()).collect(),
            first,
            cells,
        }
    }

    pub fn count(&self) -> usize {
        self.entries.len()
    }

    /// Index into the problem's list of pieces.
    pub fn entry(&self, w: u32) -> usize {
        self.entries[w as usize] as usize
    }

    pub fn placement(&self, w: u32) -> Placement {
        self.placements[w as usize]
    }

    pub fn bits(&self, w: u32) -> &[u64] {
        &self.bits[w as usize * self.words..][..self.words]
    }

    pub fn cells(&self, w: u32) -> &[u32] {
        &self.cells[self.first[w as usize] as usize..self.first[w as usize + 1] as usize]
    }
}
