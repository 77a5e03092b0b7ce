//! Takes a woven spec and its pieces; gives the cells of the weave around them, each one crossing long, in place.
//!
//! With the pieces they fill the space near each piece, up to the sandwiching planes. Not promised: cells that stand
//! further off than `REACH`.

use super::{Assembly, woven};
use crate::fault::Faults;
use crate::spec::{HeldSpec, Layout, PieceSpec, Spec, WovenSpec};
use crate::tile::Piece;
use crate::weave::{Kind, Strand};
use std::collections::BTreeSet;

/// How far from a piece's crossings the cells stand that reach into its bounding box: a cell goes at most one crossing
/// beyond its own, where the next strand of its kind is nearer, and so does the piece.
const REACH: i32 = 2;

/// The cells around the pieces of a spec, without those of the pieces themselves; `None` where there are none.
pub fn cells(spec: &Spec, woven: &WovenSpec, pieces: &[Piece]) -> Result<Option<Assembly>, Faults> {
    let own: BTreeSet<(Strand, i32)> =
        pieces.iter().flat_map(|p| (p.from..p.to).map(|c| (p.strand, c))).collect();
    let near: BTreeSet<(Strand, i32)> = pieces.iter().flat_map(near).collect();
    let one = |&(strand, from): &(Strand, i32)| PieceSpec { strand, from, to: from + 1 };
    let list: Vec<PieceSpec> = near.difference(&own).map(one).collect();
    if list.is_empty() {
        return Ok(None);
    }
    let around = WovenSpec { layout: Layout::Pieces(list), held: HeldSpec::None, ..woven.clone() };
    Ok(Some(woven::build(spec, &around)?.assembly))
}

/// Both strands' crossings within `REACH` of a piece.
fn near(piece: &Piece) -> impl Iterator<Item = (Strand, i32)> + use<> {
    let (along, across) = (piece.from - REACH..piece.to + REACH, piece.strand.index);
    let other = if piece.strand.kind == Kind::Weft { Kind::Warp } else { Kind::Weft };
    let kind = piece.strand.kind;
    let sides = across - REACH..=across + REACH;
    let crossings = along.flat_map(move |c| sides.clone().map(move |s| (c, s)));
    crossings.flat_map(move |(c, s)| [(Strand { kind, index: s }, c), (Strand { kind: other, index: c }, s)])
}
