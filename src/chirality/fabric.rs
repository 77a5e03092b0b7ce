//! Takes the unit tiles of a weave; gives the hand of the endless cloth that they make, and the weave's symmetry group.
//!
//! Complete on both sides: a symmetry of the cloth carries the first tile to a translate of some unit tile, and all
//! isometries between tiles are found on the solids; the group is found on the draft, each class once. A map counts for
//! the cloth when translations stay translations and every unit tile goes to a tile. Not promised: a name for the hand
//! where the hands of the tiles cancel.

use super::answer::{ClothAnswer, ElementAnswer, Evidence, GroupAnswer, HandAnswer, Handedness, Measure};
use super::cloth::{Cloth, Shaped};
use super::draft::{Reach, Symmetry};
use super::isometry::{self, Found, Search, corner_residual};
use super::judge::{self, Sense};
use super::moment;
use crate::tile::{Lattice, Piece};
use glam::{DAffine3, DVec3};
use std::collections::BTreeSet;

/// The cloth of these unit tiles, one for each orbit.
pub fn cloth(cloth: &Cloth, units: &[Shaped]) -> Option<ClothAnswer> {
    let first = units.first()?;
    let elements = cloth.woven().group(&cloth.lattice);
    let kept: Vec<(Symmetry, bool)> =
        elements.into_iter().map(|s| (s, keeps_cuts(&s, units, &cloth.lattice))).collect();
    let searches: Option<Vec<Search>> =
        units.iter().map(|u| isometry::search(&first.shape, &u.shape, first.scale.rounding)).collect();
    let draft = &cloth.weave.draft;
    let rectangle = (draft.warps() as i32, draft.wefts() as i32);
    let endless = Endless { units, lattice: &cloth.lattice, rectangle };
    let search = searches.map(|all| endless.search(&all));
    let resolution = units.iter().map(|u| u.scale.resolution).fold(0.0, f64::max);
    let draft: Vec<_> = kept
        .iter()
        .filter(|k| k.1)
        .map(|(s, _)| {
            let residual = endless.carried(&judge::affine(s, cloth.profile.lift), resolution);
            judge::symmetry_answer(s, Reach::Weave, residual)
        })
        .collect();
    let sense = |proper| judge::sense(proper, search.as_ref(), Some(&draft), first.scale);
    let (is, is_not) = (sense(true), sense(false));
    let agreement = judge::agreement([&is, &is_not], search.is_some(), true);
    let (hand, measure, why) = match is_not {
        Sense::Exists => (Handedness::Achiral, None, None),
        Sense::Unclear(why) => (Handedness::Undecided, None, Some(why)),
        Sense::Absent => named(units),
    };
    let search = search.unwrap_or_default();
    let isometries = search.found.iter().map(judge::isometry_answer).collect();
    let (tried, within) = (search.tried, search.within);
    let evidence = Evidence { isometries, draft: Some(draft), agreement, tried, within, resolution };
    let hand = HandAnswer { hand, measure, why, evidence };
    Some(ClothAnswer { group: group(&kept, &cloth.lattice, cloth), hand })
}

/// Whether every unit tile goes to a tile of the cloth, as the cuts have it.
fn keeps_cuts(s: &Symmetry, units: &[Shaped], lattice: &Lattice) -> bool {
    let canonical = |p: &Piece| {
        let (_, (dx, dy)) = lattice.canonical(p.start());
        p.moved((-dx, -dy))
    };
    let all: BTreeSet<Piece> = units.iter().map(|u| canonical(&u.piece)).collect();
    units.iter().all(|u| all.contains(&canonical(&s.piece(&u.piece))))
}

fn group(kept: &[(Symmetry, bool)], lattice: &Lattice, cloth: &Cloth) -> GroupAnswer {
    let element = |(s, keeps_cuts): &(Symmetry, bool)| ElementAnswer {
        proper: s.is_proper(),
        exchange: s.exchange,
        turned_over: s.upside_down,
        keeps_cuts: *keeps_cuts,
        map: s.text(),
    };
    let draft = &cloth.weave.draft;
    GroupAnswer {
        translations: lattice.shifts.iter().map(|&(x, y)| [x, y]).collect(),
        rectangle: [draft.warps() as i32, draft.wefts() as i32],
        elements: kept.iter().map(element).collect(),
    }
}

/// All translates of the unit tiles.
struct Endless<'a> {
    units: &'a [Shaped],
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
            let residual = self.units.iter().find_map(|to| self.meets(unit, to, map, within))?;
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

/// The hand of the first pseudo-scalar whose sum over the unit tiles is more than their errors.
fn named(units: &[Shaped]) -> (Handedness, Option<Measure>, Option<String>) {
    let mut sums = [0.0; 3];
    let mut names = [""; 3];
    let mut error = 0.0;
    for unit in units {
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
            let integrand = format!("{}, summed over the unit tiles", names[k]);
            (hand, Some(Measure { integrand, value: sums[k], round_off: error }), None)
        }
        None => {
            let why = "chiral, but the hands of its tiles cancel, so it has no name".to_string();
            (Handedness::Undecided, None, Some(why))
        }
    }
}
