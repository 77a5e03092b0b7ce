//! Takes a draft; gives its lattice of translations: which unit squares are alike.
//!
//! Complete for translations by whole crossings. Not promised: turns or reflections; those are `chirality`'s.

use crate::weave::Draft;

/// The translations that leave a draft unchanged, as a table over its least rectangle.
pub struct Lattice {
    size: (i32, i32),
    /// For each square of the rectangle, row by row: its representative.
    least: Vec<(i32, i32)>,
    /// Translations (dx, dy) within the rectangle, dy rising.
    pub shifts: Vec<(i32, i32)>,
}

impl Lattice {
    pub fn new(draft: &Draft) -> Lattice {
        let size = (draft.warps() as i32, draft.wefts() as i32);
        let shifts: Vec<(i32, i32)> = (0..size.1)
            .flat_map(|dy| (0..size.0).filter(move |&dx| fits(draft, size, dx, dy)).map(move |dx| (dx, dy)))
            .collect();
        let mut least = vec![(i32::MAX, i32::MAX); (size.0 * size.1) as usize];
        for y in 0..size.1 {
            for x in 0..size.0 {
                if least[(y * size.0 + x) as usize].0 < i32::MAX {
                    continue;
                }
                for (dx, dy) in &shifts {
                    let (u, v) = ((x + dx) % size.0, (y + dy) % size.1);
                    least[(v * size.0 + u) as usize] = (x, y);
                }
            }
        }
        Lattice { size, least, shifts }
    }

    /// The square's representative, and the shift that leads from there to the square.
    pub fn canonical(&self, (x, y): (i32, i32)) -> ((i32, i32), (i32, i32)) {
        let at = y.rem_euclid(self.size.1) * self.size.0 + x.rem_euclid(self.size.0);
        let least = self.least[at as usize];
        (least, (x - least.0, y - least.1))
    }
}

fn fits(draft: &Draft, size: (i32, i32), dx: i32, dy: i32) -> bool {
    (0..size.1).all(|j| (0..size.0).all(|i| draft.weft_over(j + dy, i + dx) == draft.weft_over(j, i)))
}
