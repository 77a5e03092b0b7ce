//! Takes pieces as bricks in place; gives whether any of them can move a step at all.
//!
//! Exact for moves of sets along the axes: where a step in one of three ways drags all pieces along, whichever piece
//! begins it, nothing can start. Not promised: that what starts comes apart.

use super::moves::{MOST_PARTS, Mask, dragged};
use super::pairs::{Brick, around};

/// Whether some set, not all, can take a step along an axis; the others then take it the other way. None where there are
/// more pieces than are counted.
pub fn can_start(pieces: &[Vec<Brick>]) -> Option<bool> {
    if pieces.len() > MOST_PARTS {
        return None;
    }
    let most = (pieces.len() as u32).saturating_sub(1);
    Some((0..3).any(|axis| {
        let met = met(pieces, axis);
        (0..pieces.len()).any(|k| dragged(&met, k, most).is_some())
    }))
}

/// For each piece those that it meets at once along the axis.
fn met(pieces: &[Vec<Brick>], axis: usize) -> Vec<Mask> {
    let boxes: Vec<Brick> = pieces.iter().map(|p| around(p)).collect();
    let meets = |a: usize, b: usize| {
        touch(&boxes[a], &boxes[b], axis)
            && pieces[a].iter().any(|x| pieces[b].iter().any(|y| meets_next(x, y, axis)))
    };
    let of = |a: usize| (0..pieces.len()).filter(move |&b| b != a && meets(a, b));
    (0..pieces.len()).map(|a| of(a).fold(0, |all, b| all | 1 << b)).collect()
}

/// Whether `a`, grown by a step, shares space with `b`.
fn touch(a: &Brick, b: &Brick, axis: usize) -> bool {
    (0..3).all(|k| a.lo[k] < b.hi[k] && b.lo[k] < a.hi[k] + i32::from(k == axis))
}

/// Whether `b` begins where `a` ends, before it.
fn meets_next(a: &Brick, b: &Brick, axis: usize) -> bool {
    a.hi[axis] == b.lo[axis] && touch(a, b, axis)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hook_in_a_hook_cannot_start_and_an_open_one_can() {
        let cube = |at: [i32; 3]| Brick { lo: at, hi: at.map(|x| x + 1) };
        let ring = |z: i32| -> Vec<Brick> {
            let flat = (0..9).filter(|k| k != &4).map(|k| cube([k % 3, k / 3, z]));
            flat.collect()
        };
        let rod = vec![Brick { lo: [1, 1, 0], hi: [2, 2, 3] }];
        assert_eq!(can_start(&[ring(1), rod.clone()]), Some(true));
        // A rod with a head at either end holds the ring.
        let mut held = rod.clone();
        held.extend([cube([0, 1, 0]), cube([0, 1, 2])]);
        assert_eq!(can_start(&[ring(1), held]), Some(false));
        assert_eq!(can_start(&[rod]), Some(false), "one piece alone moves against nothing");
    }
}
