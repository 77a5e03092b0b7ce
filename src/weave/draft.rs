//! Takes who lies over whom at each crossing of a rectangle; gives the two-way periodic draft at its least period.
//!
//! Not promised: that the least rectangle is the least repeat; a lattice of skew translations may have a smaller one
//! (`[a,b,c]` repeats on n crossings, its rectangle has n * n / gcd(c, n)).

use super::{Kind, Strand};

/// Who lies over whom, for every crossing of the plane. Row = weft, first row j = 0; column = warp, first i = 0.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Draft {
    wefts: u32,
    warps: u32,
    /// `over[j * warps + i]`: weft `j` passes over warp `i`.
    over: Vec<bool>,
}

impl Draft {
    /// The draft of a rectangle of `wefts` x `warps` crossings (each at least 1) continued periodically.
    pub(super) fn from_fn(wefts: u32, warps: u32, over: impl Fn(u32, u32) -> bool) -> Draft {
        let rows =
            least_period(wefts, |p| (p..wefts).all(|j| (0..warps).all(|i| over(j, i) == over(j - p, i))));
        let columns =
            least_period(warps, |p| (p..warps).all(|i| (0..rows).all(|j| over(j, i) == over(j, i - p))));
        let over =
            (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))).map(|(j, i)| over(j, i)).collect();
        Draft { wefts: rows, warps: columns, over }
    }

    pub(super) fn abc(a: u32, b: u32, c: i32) -> Draft {
        let n = i64::from(a + b);
        let over = |j, i| (i64::from(i) - i64::from(c) * i64::from(j)).rem_euclid(n) < i64::from(a);
        Draft::from_fn(a + b, a + b, over)
    }

    /// Wefts in the least period: rows of the draft.
    pub fn wefts(&self) -> u32 {
        self.wefts
    }

    /// Warps in the least period: columns of the draft.
    pub fn warps(&self) -> u32 {
        self.warps
    }

    /// Whether weft `weft` passes over warp `warp`; any index, of any sign.
    pub fn weft_over(&self, weft: i32, warp: i32) -> bool {
        let row = i64::from(weft).rem_euclid(i64::from(self.wefts));
        let column = i64::from(warp).rem_euclid(i64::from(self.warps));
        self.over[(row * i64::from(self.warps) + column) as usize]
    }

    /// Whether the strand passes over the one that it meets at `crossing` (the index of a warp on a weft, of a weft
    /// on a warp). A warp passes over where the weft does not.
    pub fn is_over(&self, strand: Strand, crossing: i32) -> bool {
        match strand.kind {
            Kind::Weft => self.weft_over(strand.index, crossing),
            Kind::Warp => !self.weft_over(crossing, strand.index),
        }
    }

    /// Crossings after which a strand of this kind repeats within the least rectangle.
    pub fn period(&self, kind: Kind) -> u32 {
        match kind {
            Kind::Weft => self.warps,
            Kind::Warp => self.wefts,
        }
    }

    /// The strands of this kind in one period.
    pub fn strands(&self, kind: Kind) -> impl Iterator<Item = Strand> + use<> {
        let count = match kind {
            Kind::Weft => self.wefts,
            Kind::Warp => self.warps,
        };
        (0..count as i32).map(move |index| Strand { kind, index })
    }

    /// One period drawn: a string for each weft, `X` where it passes over, `.` where under.
    pub fn rows(&self) -> Vec<String> {
        let mark = |&over: &bool| if over { 'X' } else { '.' };
        self.over.chunks(self.warps as usize).map(|row| row.iter().map(mark).collect()).collect()
    }
}

/// The least divisor of `n` that `repeats`; `n` itself always does.
fn least_period(n: u32, repeats: impl Fn(u32) -> bool) -> u32 {
    (1..n).filter(|p| n.is_multiple_of(*p)).find(|&p| repeats(p)).unwrap_or(n)
}
