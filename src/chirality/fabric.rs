//! Takes the unit tiles of a weave; gives the hand of the endless weave, its strands uncut, and its symmetry group.
//!
//! Complete on both sides for symmetries that carry crossings to crossings: such a one carries the first unit tile to a
//! stretch as long of some strand, cut between any two crossings, and all isometries to all such stretches are searched
//! for on the solids; the group is found on the draft, each class under translations once. A map counts when translations
//! stay translations and every unit tile goes to a stretch. Not promised: a name for the hand where the hands of all
//! stretches cancel.

use super::answer::{
    ClothAnswer, ElementAnswer, Evidence, GroupAnswer, HandAnswer, Handedness, Measure, SymmetryAnswer,
};
use super::cloth::{Cloth, Shaped};
use super::draft::{Reach, Symmetry};
use super::isometry::{self, Found, Search, corner_residual};
use super::judge::{self, Sense};
use super::moment;
use super::shape::Scale;
use crate::tile::{Lattice, Piece, TileError};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Stretches that are looked at; a draft of more is beyond any weave of the paper, and would take minutes.
const MOST_STRETCHES: usize = 512;

/// The endless weave of these unit tiles, one for each orbit; none for drafts of very many strands.
pub fn cloth(cloth: &Cloth, units: &[Shaped]) -> Result<Option<ClothAnswer>, TileError> {
    let pieces = stretches(units, &cloth.lattice);
    let Some(first) = units.first().filter(|_| pieces.len() <= MOST_STRETCHES) else { return Ok(None) };
    let targets = cloth.shaped(&pieces)?;
    let draft = &cloth.weave.draft;
    let rectangle = (draft.warps() as i32, draft.wefts() as i32);
    let endless = Endless { units, targets: &targets, lattice: &cloth.lattice, rectangle };
    let elements = cloth.woven().group(&cloth.lattice);
    let searches: Option<Vec<Search>> =
        targets.par_iter().map(|t| isometry::search(&first.shape, &t.shape, first.scale.rounding)).collect();
    let search = searches.map(|all| endless.search(&all));
    let resolution = units.iter().map(|u| u.scale.resolution).fold(0.0, f64::max);
    let told = |s: &Symmetry| {
        let residual = endless.carried(&judge::affine(s, cloth.profile.lift), resolution);
        judge::symmetry_answer(s, Reach::Weave, residual)
    };
    let drafted: Vec<SymmetryAnswer> = elements.iter().map(told).collect();
    let hand = hand(&targets, search, drafted, first.scale);
    Ok(Some(ClothAnswer { group: group(&elements, units, cloth), hand }))
}

fn hand(targets: &[Shaped], search: Option<Search>, draft: Vec<SymmetryAnswer>, scale: Scale) -> HandAnswer {
    let sense = |proper| judge::sense(proper, search.as_ref(), Some(&draft), scale);
    let (is, is_not) = (sense(true), sense(false));
    let agreement = judge::agreement([&is, &is_not], search.is_some(), true);
    let (hand, measure, why) = match is_not {
        Sense::Exists => (Handedness::Achiral, None, None),
        Sense::Unclear(why) => (Handedness::Undecided, None, Some(why)),
        Sense::Absent => named(targets),
    };
    let Search { found, tried, within, .. } = search.unwrap_or_default();
    let isometries = found.iter().map(judge::isometry_answer).collect();
    let resolution = scale.resolution;
    let evidence = Evidence { isometries, draft: Some(draft), agreement, tried, within, resolution };
    HandAnswer { hand, measure, why, evidence }
}

/// The unit tiles cut anywhere along their strands, each once under translations.
fn stretches(units: &[Shaped], lattice: &Lattice) -> Vec<Piece> {
    let cuts = |unit: &Piece| {
        (unit.from..unit.to)
            .map(|c| Piece { from: c, to: c + unit.to - unit.from, ..*unit })
            .collect::<Vec<_>>()
    };
    let all: BTreeSet<Piece> =
        units.iter().flat_map(|u| cuts(&u.piece)).map(|p| canonical(&p, lattice)).collect();
    all.into_iter().collect()
}

fn canonical(piece: &Piece, lattice: &Lattice) -> Piece {
    let (_, (dx, dy)) = lattice.canonical(piece.start());
    piece.moved((-dx, -dy))
}

/// Whether every unit tile goes to a tile of the cloth, as the cuts have it.
fn keeps_cuts(s: &Symmetry, units: &[Shaped], lattice: &Lattice) -> bool {
    let all: BTreeSet<Piece> = units.iter().map(|u| canonical(&u.piece, lattice)).collect();
    units.iter().all(|u| all.contains(&canonical(&s.piece(&u.piece), lattice)))
}

fn group(elements: &[Symmetry], units: &[Shaped], cloth: &Cloth) -> GroupAnswer {
    let element = |s: &Symmetry| ElementAnswer {
        proper: s.is_proper(),
        exchange: s.exchange,
        turned_over: s.upside_down,
        keeps_cuts: keeps_cuts(s, units, &cloth.lattice),
        map: s.text(),
    };
    let draft = &cloth.weave.draft;
    GroupAnswer {
        translations: cloth.lattice.shifts.iter().map(|&(x, y)| [x, y]).collect(),
        rectangle: [draft.warps() as i32, draft.wefts() as i32],
        elements: elements.iter().map(element).collect(),
    }
}

/// The weave as its unit tiles, and all stretches that one may go to; with all their translates.
struct Endless<'a> {
    units: &'a [Shaped],
    targets: &'a [Shaped],
    lattice: &'a Lattice,
    /// Warps and wefts of the least rectangle.
    rectangle: (i32, i32),
}

impl Endless<'_> {
    /// Of the isometries between tiles those that carry the cloth to itself.
    fn search(&self, all: &[Search]) -> Search {
        let within = all.iter().map(|s| s.within).fold(0.0, f64::max);
        let whole = |f: &Found| {
            self.carried(&f.map, within).map(|residual| Found { residual: residual.max(f.residual), ..*f })
        };
        Search {
            found: all.iter().flat_map(|s| &s.found).filter_map(whole).collect(),
            loose: all.iter().flat_map(|s| &s.loose).filter_map(whole).collect(),
            tried: all.iter().map(|s| s.tried).sum(),
            within,
        }
    }

    /// Farthest distance of a tile's corner from a corner of the tile that it should meet; none where translations are
    /// lost or some tile has no image within `within`.
    fn carried(&self, map: &DAffine3, within: f64) -> Option<f64> {
        let (wide, high) = self.rectangle;
        let shifts = self.lattice.shifts.iter().copied().chain([(wide, 0), (0, high)]);
        shifts.into_iter().try_for_each(|s| self.translation(map, s))?;
        self.units.iter().try_fold(0.0, |worst: f64, unit| {
            let residual = self.targets.iter().find_map(|to| self.meets(unit, to, map, within))?;
            Some(worst.max(residual))
        })
    }

    /// The image of a translation of the draft is one.
    fn translation(&self, map: &DAffine3, (x, y): (i32, i32)) -> Option<()> {
        let image = map.transform_vector3(DVec3::new(f64::from(x), f64::from(y), 0.0)).round();
        let square = (image.x as i32, image.y as i32);
        (self.lattice.canonical(square).0 == self.lattice.canonical((0, 0)).0).then_some(())
    }

    fn meets(&self, unit: &Shaped, to: &Shaped, map: &DAffine3, within: f64) -> Option<f64> {
        let [from, goal] = [unit, to].map(|u| moment::centroid(&u.shape.triangles).1);
        let shift = (map.transform_point3(from) - goal).round();
        let square = (shift.x as i32, shift.y as i32);
        let translation = self.lattice.canonical(square).0 == self.lattice.canonical((0, 0)).0;
        let moved = DAffine3::from_translation(-DVec3::new(shift.x, shift.y, 0.0)) * *map;
        if translation { corner_residual(&unit.shape, &to.shape, &moved, within) } else { None }
    }
}

/// The hand of the first pseudo-scalar whose sum over all stretches is more than their errors.
fn named(stretches: &[Shaped]) -> (Handedness, Option<Measure>, Option<String>) {
    let mut sums = [0.0; 3];
    let mut names = [""; 3];
    let mut error = 0.0;
    for unit in stretches {
        let (scalars, round_off) = judge::scalars(&unit.shape, unit.scale);
        for (k, p) in scalars.iter().enumerate() {
            sums[k] += if p.size > 0.0 { p.value / p.size } else { 0.0 };
            names[k] = p.name;
        }
        error += round_off;
    }
    match (0..3).find(|&k| sums[k].abs() > error) {
        Some(k) => {
            let hand = if sums[k] > 0.0 { Handedness::Right } else { Handedness::Left };
            let integrand = format!("{}, summed over all stretches of a period", names[k]);
            (hand, Some(Measure { integrand, value: sums[k], round_off: error }), None)
        }
        None => {
            let why = "chiral, but the hands of its stretches cancel, so it has no name".to_string();
            (Handedness::Undecided, None, Some(why))
        }
    }
}
