//! Takes two pieces made of bricks on a lattice; gives how far either can go along each axis before it meets the other.
//!
//! Exact, for any offset at which they do not overlap. Not promised: anything for pieces that overlap.

use std::sync::atomic::{AtomicU64, Ordering};

/// A box on the lattice: `lo` up to but not including `hi`, in lattice steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Brick {
    pub lo: [i32; 3],
    pub hi: [i32; 3],
}

/// Steps that a piece can go: never stopped.
pub const FREE: u16 = (1 << BITS) - 1;

/// Bits for one number of steps in a table's entry: six of them stand in 64 bits.
const BITS: u32 = 10;

/// Widest piece, in lattice steps: twice its width is a number of steps below [`FREE`].
pub const WIDEST: i32 = 500;

/// Most offsets of one pair that are kept in a table (8 MiB); a pair with more is looked at anew each time.
const MOST_KEPT: usize = 1 << 20;

/// For each axis, how many steps `a` can go before it meets `b`: forward, and back. `b` goes as far the other way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reach {
    pub forward: [u16; 3],
    pub back: [u16; 3],
}

impl Reach {
    const NEVER: Reach = Reach { forward: [FREE; 3], back: [FREE; 3] };

    /// The same seen from `b`.
    pub fn turned(self) -> Reach {
        Reach { forward: self.back, back: self.forward }
    }

    /// The lowest bit says that the entry is known.
    fn packed(self) -> u64 {
        let all = self.forward.into_iter().chain(self.back);
        all.fold(0, |word, steps| word << BITS | u64::from(steps)) << 1 | 1
    }

    fn unpacked(word: u64) -> Reach {
        let at = |k: u32| (word >> (1 + BITS * (5 - k))) as u16 & FREE;
        Reach { forward: [at(0), at(1), at(2)], back: [at(3), at(4), at(5)] }
    }
}

/// Two shapes, and what is known of them by offset. Entries are filled as they are asked for; each is a function of its
/// offset alone, so the order of filling does not matter.
#[derive(Debug)]
pub struct Pair {
    a: Vec<Brick>,
    b: Vec<Brick>,
    /// Offsets of `b` at which the boxes around both touch from below and from above, by axis.
    from: [i32; 3],
    to: [i32; 3],
    known: Vec<AtomicU64>,
}

impl Pair {
    pub fn new(a: &[Brick], b: &[Brick]) -> Pair {
        let (around_a, around_b) = (around(a), around(b));
        let from: [i32; 3] = std::array::from_fn(|k| around_a.lo[k] - around_b.hi[k]);
        let to: [i32; 3] = std::array::from_fn(|k| around_a.hi[k] - around_b.lo[k]);
        let count = (0..3).map(|k| (to[k] - from[k] + 1) as usize).product::<usize>();
        let kept = if count <= MOST_KEPT { count } else { 0 };
        let known = (0..kept).map(|_| AtomicU64::new(0)).collect();
        Pair { a: a.to_vec(), b: b.to_vec(), from, to, known }
    }

    /// Size of the table.
    pub fn bytes(&self) -> usize {
        self.known.len() * size_of::<AtomicU64>()
    }

    /// With `b` moved by `offset`.
    pub fn reach(&self, offset: [i32; 3]) -> Reach {
        let inner: [i32; 3] = std::array::from_fn(|k| offset[k].clamp(self.from[k], self.to[k]));
        let mut reach = self.at(inner);
        for k in 0..3 {
            // Beyond the table the boxes are apart along this axis: only the gap along it grows.
            let more = offset[k] - inner[k];
            if more != 0 {
                let only = if more > 0 { reach.forward[k] } else { reach.back[k] };
                let grown = if only == FREE {
                    FREE
                } else {
                    (i32::from(only) + more.abs()).min(i32::from(FREE) - 1) as u16
                };
                reach = Reach::NEVER;
                let side = if more > 0 { &mut reach.forward } else { &mut reach.back };
                side[k] = grown;
            }
        }
        reach
    }

    fn at(&self, offset: [i32; 3]) -> Reach {
        let size = |k: usize| (self.to[k] - self.from[k] + 1) as usize;
        let step = |k: usize| (offset[k] - self.from[k]) as usize;
        let Some(slot) = self.known.get((step(2) * size(1) + step(1)) * size(0) + step(0)) else {
            return counted(&self.a, &self.b, offset);
        };
        match slot.load(Ordering::Relaxed) {
            0 => {
                let reach = counted(&self.a, &self.b, offset);
                slot.store(reach.packed(), Ordering::Relaxed);
                reach
            }
            word => Reach::unpacked(word),
        }
    }
}

/// The box around bricks.
pub fn around(bricks: &[Brick]) -> Brick {
    let first = bricks.first().copied().unwrap_or(Brick { lo: [0; 3], hi: [0; 3] });
    bricks.iter().fold(first, |all, b| Brick {
        lo: std::array::from_fn(|k| all.lo[k].min(b.lo[k])),
        hi: std::array::from_fn(|k| all.hi[k].max(b.hi[k])),
    })
}

/// Whether bricks of the two share space, with `b` moved by `offset`.
pub fn overlap(a: &[Brick], b: &[Brick], offset: [i32; 3]) -> bool {
    let meets =
        |x: &Brick, y: &Brick, k: usize| x.lo[k] < y.hi[k] + offset[k] && y.lo[k] + offset[k] < x.hi[k];
    a.iter().any(|x| b.iter().any(|y| (0..3).all(|k| meets(x, y, k))))
}

fn counted(a: &[Brick], b: &[Brick], offset: [i32; 3]) -> Reach {
    let mut reach = Reach::NEVER;
    for x in a {
        for y in b {
            let lo: [i32; 3] = std::array::from_fn(|k| y.lo[k] + offset[k]);
            let hi: [i32; 3] = std::array::from_fn(|k| y.hi[k] + offset[k]);
            let beside: [bool; 3] = std::array::from_fn(|k| x.hi[k] <= lo[k] || hi[k] <= x.lo[k]);
            let [Some(axis), None] = [0, 1].map(|n| (0..3).filter(|&k| beside[k]).nth(n)) else { continue };
            let (side, gap) = if x.hi[axis] <= lo[axis] {
                (&mut reach.forward[axis], lo[axis] - x.hi[axis])
            } else {
                (&mut reach.back[axis], x.lo[axis] - hi[axis])
            };
            *side = (*side).min(gap as u16);
        }
    }
    reach
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(at: [i32; 3]) -> Brick {
        Brick { lo: at, hi: at.map(|x| x + 1) }
    }

    #[test]
    fn a_table_says_what_counting_says_at_every_offset() {
        let a = [cube([0, 0, 0]), Brick { lo: [0, 1, 0], hi: [3, 2, 1] }, cube([2, 0, 1])];
        let b = [Brick { lo: [0, 0, 0], hi: [1, 1, 4] }, cube([1, 0, 3])];
        let pair = Pair::new(&a, &b);
        let mut seen = 0;
        for x in -9..9 {
            for y in -9..9 {
                for z in -9..9 {
                    if !overlap(&a, &b, [x, y, z]) {
                        assert_eq!(pair.reach([x, y, z]), counted(&a, &b, [x, y, z]), "{x} {y} {z}");
                        seen += 1;
                    }
                }
            }
        }
        assert!(seen > 5000);
    }

    #[test]
    fn what_one_is_stopped_by_stops_the_other_as_far_away() {
        let pair = Pair::new(&[cube([0, 0, 0])], &[cube([0, 0, 0])]);
        let reach = pair.reach([3, 0, 0]);
        assert_eq!(reach, Reach { forward: [2, FREE, FREE], back: [FREE; 3] });
        assert_eq!(Pair::new(&[cube([0, 0, 0])], &[cube([0, 0, 0])]).reach([-3, 0, 0]), reach.turned());
        assert_eq!(Reach::unpacked(reach.packed()), reach);
    }
}
