//! Takes a weave, a profile, k and a phase; gives a proof that swatches of whole classes of sizes lock, however large.
//!
//! The lemma (docs/repeats.md): with L = k times the crossings of a unit tile, a swatch of W > L warps grown by L warps is
//! itself and its own translate by L together, and the two share the warp L. Two locked assemblies that share a part
//! are locked together. So where the swatch of W0 x H0 strands locks, L < W0, H0 <= 2 L, all swatches of
//! (W0 + i L) x (H0 + j L) strands lock. The union and the shared parts are checked on the pieces themselves.

use super::{AsMade, Tried, attempt};
use crate::assembly::layout::{Swatch, tiles};
use crate::fault::Faults;
use crate::spec::ProfileSpec;
use crate::tile::Piece;
use crate::weave::{Kind, Strand, Weave};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Which classes of sizes to prove.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sizes {
    /// Whole numbers of periods both ways.
    Periods,
    /// Every size.
    All,
}

/// One class: its smallest swatch stands for all that are larger by whole pieces.
#[derive(Clone, Debug)]
pub struct Class {
    pub base: Tried,
    /// What `wefts` and `warps` may grow by.
    pub step: (u32, u32),
    /// A strand of the smallest swatch that no piece crosses, which by itself leaves it loose.
    pub uncrossed: Option<Strand>,
    /// Why the lemma does not apply to this class; none where it does.
    pub flaw: Option<String>,
}

/// The classes, wefts first.
pub fn grow(
    weave: &Weave,
    profile: &ProfileSpec,
    k: u32,
    phase: i32,
    sizes: Sizes,
) -> Result<Vec<Class>, Faults> {
    // Wefts are counted along warps, whose pieces are k times tile.1 long.
    let step = (k * weave.tile.1, k * weave.tile.0);
    let first = |length: u32, tile: u32| -> Vec<u32> {
        match sizes {
            Sizes::All => (length + 1..=2 * length).collect(),
            Sizes::Periods => (1..=k).map(|r| length + r * tile).collect(),
        }
    };
    let warps = first(step.1, weave.tile.0);
    let sizes: Vec<(u32, u32)> =
        first(step.0, weave.tile.1).into_iter().flat_map(|h| warps.iter().map(move |&w| (h, w))).collect();
    let class = |&(wefts, warps): &(u32, u32)| {
        let swatch = Swatch { wefts, warps, repeat: k, phase };
        let base = attempt(weave, profile, swatch, AsMade::TOUCHING)?;
        Ok(Class { base, step, uncrossed: uncrossed(&tiles(weave, swatch)), flaw: flaw(weave, swatch, step) })
    };
    sizes.par_iter().map(class).collect()
}

/// Grows the swatch by one step each way, and holds the pieces against what the lemma says they are.
fn flaw(weave: &Weave, swatch: Swatch, step: (u32, u32)) -> Option<String> {
    let base = pieces(weave, swatch);
    let wide = Swatch { warps: swatch.warps + step.1, ..swatch };
    let long = Swatch { wefts: swatch.wefts + step.0, ..swatch };
    let both = Swatch { warps: wide.warps, ..long };
    let (right, up) = ((step.1 as i32, 0), (0, step.0 as i32));
    let grown = [
        ("warps", base.clone(), pieces(weave, wide), right),
        ("wefts", base, pieces(weave, long), up),
        ("warps of the longer one", pieces(weave, long), pieces(weave, both), right),
    ];
    grown.into_iter().find_map(|(what, small, large, by)| {
        let moved: BTreeSet<Piece> = small.iter().map(|p| p.moved(by)).collect();
        let union: BTreeSet<Piece> = small.union(&moved).copied().collect();
        match () {
            () if union != large => Some(format!("grown by {what} it is not the union of two translates")),
            () if small.is_disjoint(&moved) => Some(format!("grown by {what} the translates share no part")),
            () => None,
        }
    })
}

fn pieces(weave: &Weave, swatch: Swatch) -> BTreeSet<Piece> {
    tiles(weave, swatch).into_iter().collect()
}

/// A strand that no piece crosses.
fn uncrossed(pieces: &[Piece]) -> Option<Strand> {
    let crossed = |p: &Piece| {
        let kind = if p.strand.kind == Kind::Weft { Kind::Warp } else { Kind::Weft };
        pieces.iter().any(|q| {
            q.strand.kind == kind
                && (p.from..p.to).contains(&q.strand.index)
                && (q.from..q.to).contains(&p.strand.index)
        })
    };
    pieces.iter().find(|p| !crossed(p)).map(|p| p.strand)
}
