//! Takes a move, gives the least distance between what moves and what stays along the whole way.
//!
//! A cell on its way sweeps the hull of its start and end, so the distance is one between two convex sets (GJK of
//! parry3d): not sampled. Right to about 1e-6 of the sizes; 0 where the parts touch.

use super::field::{Field, Set};
use crate::blocking::bounds;
use crate::blocking::shadow::Convex;
use glam::DVec3;
use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::details::distance_support_map_support_map;
use parry3d_f64::shape::SupportMap;

/// A convex cell and where it goes.
struct Swept<'c> {
    cell: &'c Convex,
    at: DVec3,
    way: DVec3,
}

impl SupportMap for Swept<'_> {
    fn local_support_point(&self, dir: Vector) -> Vector {
        let far = self.cell.vertices.iter().max_by(|a, b| a.dot(dir).total_cmp(&b.dot(dir)));
        let ahead = if self.way.dot(dir) > 0.0 { self.way } else { DVec3::ZERO };
        far.map_or(self.at, |v| *v + self.at) + ahead
    }
}

impl Swept<'_> {
    fn bounds(&self) -> (DVec3, DVec3) {
        let (lo, hi) = bounds(self.cell.vertices.iter().map(|&v| v + self.at));
        (lo.min(lo + self.way), hi.max(hi + self.way))
    }
}

/// Model units; infinite when nothing stays.
pub(super) fn least_gap(field: &Field, moving: &Set, stays: &Set, way: DVec3) -> f64 {
    if field.sides(moving, stays).next().is_some() {
        return 0.0;
    }
    let go = swept(field, moving, way);
    let stand = swept(field, stays, DVec3::ZERO);
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (a, (_, (alo, ahi))) in go.iter().enumerate() {
        for (b, (_, (blo, bhi))) in stand.iter().enumerate() {
            let apart = (*blo - *ahi).max(*alo - *bhi).max(DVec3::ZERO).length();
            pairs.push((apart, a, b));
        }
    }
    pairs.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    let mut least = f64::INFINITY;
    for (apart, a, b) in pairs {
        if apart >= least || least <= field.touch.depth() {
            break;
        }
        least = least.min(distance_support_map_support_map(&Pose::IDENTITY, &go[a].0, &stand[b].0));
    }
    if least <= field.touch.depth() { 0.0 } else { least }
}

type Boxed<'c> = (Swept<'c>, (DVec3, DVec3));

fn swept<'f>(field: &'f Field, set: &Set, way: DVec3) -> Vec<Boxed<'f>> {
    let cells = set.iter().flat_map(|&p| {
        let (cells, at) = field.shapes.part(p);
        cells.iter().map(move |cell| Swept { cell, at, way })
    });
    cells
        .map(|s| {
            let b = s.bounds();
            (s, b)
        })
        .collect()
}
