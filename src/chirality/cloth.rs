//! Takes a weave and its profile; gives its unit tiles as shapes, with the symmetries that should carry them.
//!
//! Not promised: tiles of other phases than 0 but for [`Cloth::other_phases`], which tries those that the draft allows.

use super::answer::{HandAnswer, PairAnswer, TileAnswer, WarpIs};
use super::draft::{Near, Reach, Set, Symmetry, Woven};
use super::judge::{self, Findings};
use super::shape::{SPREAD, Scale, Shape};
use crate::assembly::layout::first_cut;
use crate::sites::{Coincident, Sites};
use crate::solid::Solid;
use crate::spec::ProfileSpec;
use crate::tile::exact::{SITE_BITS, VERTEX_BITS};
use crate::tile::{self, Across, Lattice, Piece, Tile, TileError};
use crate::weave::{Kind, Weave};
use glam::DAffine3;
use std::collections::BTreeSet;

/// A weave ready to be cut.
pub struct Cloth<'a> {
    pub weave: &'a Weave,
    pub profile: &'a ProfileSpec,
    sites: Sites,
    pub lattice: Lattice,
}

/// A piece and its solid in place.
pub struct Shaped {
    pub piece: Piece,
    pub shape: Shape,
    pub scale: Scale,
    /// The sites that shape it.
    pub near: Near,
}

impl Shaped {
    pub fn set(&self) -> Set<'_> {
        Set { pieces: std::slice::from_ref(&self.piece), near: &self.near }
    }
}

impl<'a> Cloth<'a> {
    pub fn new(weave: &'a Weave, profile: &'a ProfileSpec) -> Result<Cloth<'a>, Coincident> {
        Ok(Cloth { weave, profile, sites: Sites::new(weave, profile)?, lattice: Lattice::new(&weave.draft) })
    }

    /// A unit tile at phase 0 for each orbit of strands, wefts first.
    pub fn units(&self) -> Vec<Piece> {
        let draft = &self.weave.draft;
        let mut seen = BTreeSet::new();
        let strands = draft.strands(Kind::Weft).chain(draft.strands(Kind::Warp));
        let units = strands.map(|strand| {
            let from = first_cut(self.weave, strand);
            Piece { strand, from, to: from + self.length(strand.kind) as i32 }
        });
        units.filter(|p| seen.insert((p.strand.kind, self.lattice.canonical(p.start()).0))).collect()
    }

    fn length(&self, kind: Kind) -> u32 {
        match kind {
            Kind::Weft => self.weave.tile.0,
            Kind::Warp => self.weave.tile.1,
        }
    }

    pub fn shaped(&self, pieces: &[Piece]) -> Result<Vec<Shaped>, TileError> {
        let tiles = tile::tiles(&self.sites, &self.lattice, pieces)?;
        Ok(tiles.iter().map(|t| self.placed(t.piece, &t.solid, DAffine3::IDENTITY, self.near(t))).collect())
    }

    /// A tile's sites and those that they face.
    fn near(&self, tile: &Tile) -> Near {
        let faced = tile.across.iter().filter_map(|(_, across)| match across {
            Across::Site(s) => Some(*s),
            Across::Face(_) => None,
        });
        faced.chain(tile::of_piece(&self.sites, tile.piece)).collect()
    }

    pub fn placed(&self, piece: Piece, solid: &Solid, pose: DAffine3, near: Near) -> Shaped {
        let scale = scale([solid], self.profile);
        Shaped { piece, shape: Shape::new([(solid, pose)], scale), scale, near }
    }

    /// The symmetries of the weave that carry one set of pieces to another.
    pub fn symmetries(&self, from: Set, to: Set) -> Vec<(Symmetry, Reach)> {
        self.woven().carry(from, to)
    }

    /// The weave as its symmetries see it.
    pub fn woven(&self) -> Woven<'_> {
        let lift = (self.profile.lift * f64::from(1 << SITE_BITS)).round() as i64;
        // Half of a crossing's centreline is sampled from its cut; every site since then may be off by one unit, and one
        // more where heights are mirrored.
        let slack = i64::from(self.profile.samples) + 1;
        Woven { draft: &self.weave.draft, sites: &self.sites, lift, slack }
    }

    pub fn hand(&self, tile: &Shaped) -> HandAnswer {
        let symmetries = self.symmetries(tile.set(), tile.set());
        judge::hand(&tile.shape, tile.scale, Some((&symmetries, self.profile.lift)))
    }

    pub fn tile_answer(&self, tile: &Shaped) -> TileAnswer {
        let Piece { strand, from, to } = tile.piece;
        TileAnswer { strand: strand.to_string(), from, to, hand: self.hand(tile) }
    }

    /// The isometries from one tile to another.
    pub fn compare(&self, from: &Shaped, to: &Shaped) -> Findings {
        let symmetries = self.symmetries(from.set(), to.set());
        judge::compare(&from.shape, &to.shape, to.scale, Some((&symmetries[..], self.profile.lift)))
    }

    pub fn pair_answer(&self, weft: &Shaped, warp: &Shaped, phase: u32) -> PairAnswer {
        let findings = self.compare(weft, warp);
        let (warp_is, why) = findings.kinship();
        let [weft, warp] = [weft, warp].map(|s| s.piece.strand.to_string());
        PairAnswer { weft, warp, phase, warp_is, why, evidence: findings.evidence }
    }

    /// The other cuts of a warp tile at which the draft carries a weft tile to it.
    pub fn other_phases(&self, wefts: &[&Shaped], warp: &Shaped) -> Result<Vec<PairAnswer>, TileError> {
        let mut answers = Vec::new();
        for phase in 1..self.length(Kind::Warp) {
            let cut = warp.piece.moved((0, phase as i32));
            for weft in wefts {
                // No tile but these can follow from the weft's by the weave; only then it is worth to be cut.
                let none = Near::new();
                let target = Set { pieces: &[cut], near: &none };
                if self.symmetries(weft.set(), target).iter().any(|s| s.1 == Reach::Weave) {
                    let moved = self.shaped(&[cut])?;
                    answers.extend(moved.iter().map(|warp| self.pair_answer(weft, warp, phase)));
                }
            }
        }
        Ok(answers)
    }
}

/// What distances mean on tiles: vertices are rounded to multiples of 2^-[`VERTEX_BITS`], sites to 2^-[`SITE_BITS`].
pub fn scale<'s>(solids: impl IntoIterator<Item = &'s Solid>, profile: &ProfileSpec) -> Scale {
    let half = |bits: u32| 3f64.sqrt() / 2.0 / (1_u64 << bits) as f64;
    let cells = solids.into_iter().flat_map(|s| &s.cells);
    let reach = cells.map(|c| c.vertices.iter().map(|v| v.distance(c.vertices[0])).fold(0.0, f64::max));
    // The plane halfway between two sites that are each off by s, at least 1 / samples apart, moves at a lever l by
    // no more than s + 2 s l samples; a corner of three such planes by 3 / SPREAD times as much, its mirror image too.
    let lever = 1.0 + 2.0 * reach.fold(0.0, f64::max) * f64::from(profile.samples);
    Scale { rounding: half(VERTEX_BITS), resolution: 2.0 * 3.0 / SPREAD * half(SITE_BITS) * lever }
}

/// All warp tiles together: each must be some weft tile, in the sense told.
pub fn overall(pairs: &[PairAnswer], wefts: usize) -> WarpIs {
    let warps = || pairs.chunks(wefts.max(1));
    let every = |senses: [WarpIs; 2]| warps().all(|of| of.iter().any(|p| senses.contains(&p.warp_is)));
    match (every([WarpIs::Same, WarpIs::Both]), every([WarpIs::Mirror, WarpIs::Both])) {
        (true, true) => WarpIs::Both,
        _ if pairs.iter().any(|p| p.warp_is == WarpIs::Undecided) => WarpIs::Undecided,
        (true, false) => WarpIs::Same,
        (false, true) => WarpIs::Mirror,
        (false, false) => WarpIs::Different,
    }
}
