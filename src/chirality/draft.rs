//! Takes a weave, its sites and pieces; gives the isometries of the weave that carry pieces to pieces.
//!
//! Complete for isometries that carry crossings to crossings, of the whole, endless weave or of the surroundings that
//! shape the pieces alone: a Voronoi cell is made by its neighbours, so where a piece's sites and all that these face go to
//! sites, there and back, the piece goes to the piece. Not promised: isometries that carry
//! crossings elsewhere; the solids are searched for those.

use crate::sites::{Site, Sites};
use crate::tile::exact::Grid;
use crate::tile::{Lattice, Piece};
use crate::weave::{Draft, Kind, Strand};
use std::collections::BTreeSet;

/// An isometry of the weave: exchange x and y (or not), turn axes round, then shift by whole crossings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Symmetry {
    /// Wefts become warps.
    pub exchange: bool,
    /// Whether the image runs against x, y; whether over becomes under.
    pub against: [bool; 2],
    pub upside_down: bool,
    /// Added to x and y, in crossings.
    pub shift: [i32; 2],
}

/// Which part of the weave a symmetry keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    Weave,
    /// The sites that shape the pieces, but not the whole weave.
    Surroundings,
}

/// The sites that shape pieces: their own, and those that these face.
pub type Near = BTreeSet<Site>;

/// Pieces with the sites that shape them.
#[derive(Clone, Copy)]
pub struct Set<'a> {
    pub pieces: &'a [Piece],
    pub near: &'a Near,
}

impl Symmetry {
    /// Its inverse but for the shift.
    fn back(&self) -> Symmetry {
        let [u, v] = self.against;
        Symmetry { against: if self.exchange { [v, u] } else { [u, v] }, shift: [0, 0], ..*self }
    }

    /// Whether these sites go to sites.
    fn keeps_near(&self, woven: &Woven, near: &Near) -> bool {
        near.iter().all(|&site| {
            let (x, y) = self.square((site.x, site.y));
            let image = self.point(woven.sites.at(site), woven.lift);
            let meets = |p: Grid| (0..3).all(|d| (p[d] - image[d]).abs() <= woven.slack);
            woven.sites.in_square(x, y).any(|other| meets(woven.sites.at(other)))
        })
    }

    /// Whether it is a motion: its linear part has determinant 1.
    pub fn is_proper(&self) -> bool {
        let turned = [self.exchange, self.against[0], self.against[1], self.upside_down];
        turned.iter().filter(|t| **t).count() % 2 == 0
    }

    /// All linear parts, without shift.
    fn linear(exchange: bool) -> impl Iterator<Item = Symmetry> {
        (0..8).map(move |bits: u32| Symmetry {
            exchange,
            against: [bits & 1 != 0, bits & 2 != 0],
            upside_down: bits & 4 != 0,
            shift: [0, 0],
        })
    }

    /// Unit square (x, y) to unit square.
    fn square(&self, (x, y): (i32, i32)) -> (i32, i32) {
        let [u, v] = if self.exchange { [y, x] } else { [x, y] };
        let turned = |against: bool, c: i32| if against { -1 - c } else { c };
        (turned(self.against[0], u) + self.shift[0], turned(self.against[1], v) + self.shift[1])
    }

    /// The piece's image.
    pub fn piece(&self, piece: &Piece) -> Piece {
        let last = piece.moved(match piece.strand.kind {
            Kind::Weft => (piece.to - piece.from - 1, 0),
            Kind::Warp => (0, piece.to - piece.from - 1),
        });
        let (p, q) = (self.square(piece.start()), self.square(last.start()));
        let kind = match (piece.strand.kind, self.exchange) {
            (Kind::Weft, false) | (Kind::Warp, true) => Kind::Weft,
            _ => Kind::Warp,
        };
        let (index, a, b) = match kind {
            Kind::Weft => (p.1, p.0, q.0),
            Kind::Warp => (p.0, p.1, q.1),
        };
        Piece { strand: Strand { kind, index }, from: a.min(b), to: a.max(b) + 1 }
    }

    /// Written out: the image of (x, y, z), with h the height of an over above an under.
    pub fn text(&self) -> String {
        let [u, v] = if self.exchange { ["y", "x"] } else { ["x", "y"] };
        // In coordinates the image of a unit square's corner x is shift - x, one less in whole squares.
        let term = |against: bool, name: &str, shift: i32| match (against, shift) {
            (false, 0) => name.to_string(),
            (false, s) if s < 0 => format!("{name} - {}", -s),
            (false, s) => format!("{name} + {s}"),
            (true, 0) => format!("-{name}"),
            (true, s) => format!("{s} - {name}"),
        };
        let z = if self.upside_down { "h - z" } else { "z" };
        format!(
            "({}, {}, {z})",
            term(self.against[0], u, self.shift[0]),
            term(self.against[1], v, self.shift[1])
        )
    }

    /// Whether the draft is its own image: an exchange turns "weft over" into "warp over", and so does upside down.
    fn keeps_draft(&self, draft: &Draft) -> bool {
        let (warps, wefts) = (draft.warps() as i32, draft.wefts() as i32);
        // Least periods are unique, so a draft of unequal ones is not its exchanged image.
        (!self.exchange || warps == wefts)
            && (0..wefts).all(|j| {
                (0..warps).all(|i| {
                    let (x, y) = self.square((i, j));
                    draft.weft_over(y, x) == (draft.weft_over(j, i) ^ self.exchange ^ self.upside_down)
                })
            })
    }

    /// Whether the sites of one weft and one warp go to sites, up to `slack` grid units. Own control points may have
    /// less symmetry than the draft; strands of a kind share one curve.
    fn keeps_sites(&self, sites: &Sites, draft: &Draft, heights: i64, slack: i64) -> bool {
        [Kind::Weft, Kind::Warp].into_iter().all(|kind| {
            let strand = Strand { kind, index: 0 };
            (0..draft.period(kind) as i32).all(|c| self.keeps_crossing(sites, strand, c, heights, slack))
        })
    }

    fn keeps_crossing(&self, sites: &Sites, strand: Strand, crossing: i32, heights: i64, slack: i64) -> bool {
        let image = self.piece(&Piece { strand, from: crossing, to: crossing + 1 });
        let mut own: Vec<Grid> =
            sites.of_strand(strand, crossing).map(|s| self.point(sites.at(s), heights)).collect();
        let along = usize::from(strand.kind == Kind::Warp) ^ usize::from(self.exchange);
        if self.against[along] {
            own.reverse();
        }
        let other: Vec<Grid> = sites.of_strand(image.strand, image.from).map(|s| sites.at(s)).collect();
        let near = |(p, q): (&Grid, &Grid)| (0..3).all(|d| (p[d] - q[d]).abs() <= slack);
        own.len() == other.len() && own.iter().zip(&other).all(near)
    }

    /// A grid point's image; `heights` is the sum of an over's and an under's height.
    fn point(&self, p: Grid, heights: i64) -> Grid {
        let [u, v] = if self.exchange { [p[1], p[0]] } else { [p[0], p[1]] };
        let one = |against: bool, c: i64, shift: i32| {
            let s = i64::from(shift) << crate::tile::exact::SITE_BITS;
            if against { s - c } else { s + c }
        };
        let z = if self.upside_down { heights - p[2] } else { p[2] };
        [one(self.against[0], u, self.shift[0]), one(self.against[1], v, self.shift[1]), z]
    }
}

/// A weave as its symmetries see it.
pub struct Woven<'a> {
    pub draft: &'a Draft,
    pub sites: &'a Sites,
    /// Height of an over above an under, in grid units.
    pub lift: i64,
    /// By how many grid units sites may miss their mirror images: `sites` promises one for each site since a bend.
    pub slack: i64,
}

impl Woven<'_> {
    fn keeps(&self, symmetry: &Symmetry) -> bool {
        symmetry.keeps_draft(self.draft)
            && symmetry.keeps_sites(self.sites, self.draft, self.lift, self.slack)
    }

    /// The symmetries that carry the pieces `from`, as a set, to the pieces `to`. Empty sets have none.
    pub fn carry(&self, from: Set, to: Set) -> Vec<(Symmetry, Reach)> {
        let fits = |linear: Symmetry| {
            let there = shifted(linear, from.pieces, to.pieces)?;
            if self.keeps(&there) {
                return Some((there, Reach::Weave));
            }
            let back = shifted(linear.back(), to.pieces, from.pieces)?;
            let near = there.keeps_near(self, from.near) && back.keeps_near(self, to.near);
            near.then_some((there, Reach::Surroundings))
        };
        [false, true].into_iter().flat_map(Symmetry::linear).filter_map(fits).collect()
    }

    /// The symmetries of the endless weave, one for each class under its translations.
    pub fn group(&self, lattice: &Lattice) -> Vec<Symmetry> {
        let (wide, high) = (self.draft.warps() as i32, self.draft.wefts() as i32);
        let squares = (0..high).flat_map(|y| (0..wide).map(move |x| (x, y)));
        let shifts: Vec<(i32, i32)> = squares.filter(|&s| lattice.canonical(s).0 == s).collect();
        let all = [false, true].into_iter().flat_map(Symmetry::linear);
        let moved =
            all.flat_map(|linear| shifts.iter().map(move |&(x, y)| Symmetry { shift: [x, y], ..linear }));
        moved.filter(|s| self.keeps(s)).collect()
    }
}

/// The isometry with this linear part that carries the one set of pieces to the other, if one does.
fn shifted(linear: Symmetry, from: &[Piece], to: &[Piece]) -> Option<Symmetry> {
    let images: Vec<Piece> = from.iter().map(|p| linear.piece(p)).collect();
    let (here, there) = (corner(&images)?, corner(to)?);
    let shifted = Symmetry { shift: [there.0 - here.0, there.1 - here.1], ..linear };
    let carried: BTreeSet<Piece> = from.iter().map(|p| shifted.piece(p)).collect();
    (carried == to.iter().copied().collect()).then_some(shifted)
}

/// Least x and y of the pieces' unit squares.
fn corner(pieces: &[Piece]) -> Option<(i32, i32)> {
    let starts = || pieces.iter().map(Piece::start);
    Some((starts().map(|s| s.0).min()?, starts().map(|s| s.1).min()?))
}
