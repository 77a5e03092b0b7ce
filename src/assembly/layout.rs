//! Takes a layout; gives the pieces of a swatch in order: wefts by index and along the strand, then warps.
//!
//! The rule for swatches of tiles is that of MATHS.md ("Repetition"), continued to strands of several pieces. Not
//! promised: that another rule gives the same verdict; an answer is about its swatch.

use crate::spec::{Cut, Layout, PieceSpec, WovenSpec};
use crate::tile::Piece;
use crate::weave::{Kind, Strand, Weave};

/// A regular swatch's measures, in crossings and unit tiles.
#[derive(Clone, Copy, Debug)]
pub struct Swatch {
    pub wefts: u32,
    pub warps: u32,
    pub repeat: u32,
    pub phase: i32,
}

pub fn pieces(spec: &WovenSpec) -> Vec<Piece> {
    match &spec.layout {
        Layout::Pieces(list) => {
            list.iter().map(|&PieceSpec { strand, from, to }| Piece { strand, from, to }).collect()
        }
        &Layout::Swatch { wefts, warps, cut: Cut::Window, .. } => strands(wefts, warps)
            .map(|strand| Piece { strand, from: 0, to: across(strand.kind, wefts, warps) as i32 })
            .collect(),
        &Layout::Swatch { wefts, warps, cut: Cut::Tiles, repeat, phase } => {
            tiles(&spec.weave, Swatch { wefts, warps, repeat, phase })
        }
    }
}

fn strands(wefts: u32, warps: u32) -> impl Iterator<Item = Strand> {
    let of = |kind, n| (0..n as i32).map(move |index| Strand { kind, index });
    of(Kind::Weft, wefts).chain(of(Kind::Warp, warps))
}

/// Crossings of a strand of this kind in the window.
fn across(kind: Kind, wefts: u32, warps: u32) -> u32 {
    match kind {
        Kind::Weft => warps,
        Kind::Warp => wefts,
    }
}

/// Each strand as a run of pieces of `repeat` unit tiles. Runs start at cuts (`start` + phase + whole tiles); a run has
/// as many whole pieces as the window is long, at least one, and lies with its middle nearest to the window's; in a
/// tie the smaller start.
pub fn tiles(weave: &Weave, swatch: Swatch) -> Vec<Piece> {
    let run = |strand: Strand| {
        let n = if strand.kind == Kind::Weft { weave.tile.0 } else { weave.tile.1 } as i32;
        let window = across(strand.kind, swatch.wefts, swatch.warps) as i32;
        let length = n * swatch.repeat as i32;
        let count = (window / length).max(1);
        let first = first_cut(weave, strand) + swatch.phase;
        let start = nearest(first, n, (window - count * length, 2));
        (0..count).map(move |k| Piece { strand, from: start + k * length, to: start + (k + 1) * length })
    };
    strands(swatch.wefts, swatch.warps).flat_map(run).collect()
}

/// The first crossing at or after 0 where the strand comes up; 0 where it never does.
pub fn first_cut(weave: &Weave, strand: Strand) -> i32 {
    let period = weave.draft.period(strand.kind) as i32;
    let rises = |&c: &i32| weave.draft.is_over(strand, c) && !weave.draft.is_over(strand, c - 1);
    (0..period).find(rises).unwrap_or(0)
}

/// The number s = first (mod n) nearest to the fraction `goal`; in a tie the smaller.
fn nearest(first: i32, n: i32, goal: (i32, i32)) -> i32 {
    let (top, bottom) = goal;
    // Least s with bottom * s >= top - bottom * n / 2, which is within half a period below or at the goal.
    let least = (2 * top - bottom * n).div_euclid(2 * bottom)
        + i32::from((2 * top - bottom * n).rem_euclid(2 * bottom) != 0);
    least + (first - least).rem_euclid(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn starts(abc: (u32, u32, i32), repeat: u32, phase: i32) -> Vec<i32> {
        let weave = Weave::abc(abc.0, abc.1, abc.2).unwrap();
        let n = abc.0 + abc.1;
        tiles(&weave, Swatch { wefts: n, warps: n, repeat, phase }).iter().map(|p| p.from).collect()
    }

    #[test]
    fn starts_are_those_of_the_known_answers() {
        assert_eq!(starts((1, 1, 1), 1, 0), [0, -1, -1, 0]);
        assert_eq!(starts((1, 1, 1), 2, 0), [-2, -1, -1, -2]);
        assert_eq!(starts((2, 2, 1), 1, 0), [0, 1, -2, -1, 1, -2, -1, 0]);
        assert_eq!(starts((2, 2, 1), 1, 1), [1, -2, -1, 0, -2, -1, 0, 1]);
        assert_eq!(starts((2, 2, 1), 2, 0), [-4, -3, -2, -1, -3, -2, -1, -4]);
        assert_eq!(starts((7, 1, 3), 1, 0), [0, 3, -2, 1, -4, -1, 2, -3, 3, -2, 1, -4, -1, 2, -3, 0]);
        assert_eq!(starts((7, 1, 3), 2, 0), [-8, -5, -2, -7, -4, -1, -6, -3, -5, -2, -7, -4, -1, -6, -3, -8]);
    }
}
