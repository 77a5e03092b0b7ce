//! Takes contact patches and an assembly; gives contact rows and their place among the unknowns.
//!
//! A row says that two parts may not approach at a point: n . (v_B(p) - v_A(p)) >= 0 (MATHS.md). First order only.

use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use glam::DVec3;
use std::collections::BTreeSet;

/// One contact row: parts `a` and `b` touch at `point`, `normal` leads from `a` to `b`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    pub a: PartIx,
    pub b: PartIx,
    pub normal: DVec3,
    pub point: DVec3,
}

/// Which motions the verdict is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freedom {
    Translation,
    Rigid,
}

impl Freedom {
    /// Unknowns of one free part.
    pub fn unknowns(self) -> usize {
        match self {
            Freedom::Translation => 3,
            Freedom::Rigid => 6,
        }
    }
}

/// Every corner of every patch, for rigid motions; for translations every normal of a pair once.
pub fn rows(patches: &[Patch], freedom: Freedom) -> Vec<Row> {
    let mut seen = BTreeSet::new();
    let mut rows = Vec::new();
    for &Patch { a, b, normal, ref corners } in patches {
        let bits = normal.to_array().map(f64::to_bits);
        match freedom {
            Freedom::Rigid => rows.extend(corners.iter().map(|&point| Row { a, b, normal, point })),
            Freedom::Translation if seen.insert((a, b, bits)) => {
                rows.extend(corners.first().map(|&point| Row { a, b, normal, point }));
            }
            Freedom::Translation => {}
        }
    }
    rows
}

/// The unknowns: for each part that may move, its translation and (rigid) `lever` times its rotation vector, about a
/// reference point near the part.
#[derive(Clone, Debug)]
pub struct Unknowns {
    pub freedom: Freedom,
    /// First column of each part; none for a part that stays.
    pub column: Vec<Option<usize>>,
    pub centre: Vec<DVec3>,
    /// For each part the length in model units that makes its rotations comparable with its translations: how far its
    /// farthest row is from its centre. Its own, so that a small part's turn counts as much as a large one's.
    pub lever: Vec<f64>,
    pub count: usize,
}

impl Unknowns {
    /// `fixed` are the parts without columns.
    pub fn new(assembly: &Assembly, rows: &[Row], fixed: &[PartIx], freedom: Freedom) -> Unknowns {
        let fixed: BTreeSet<PartIx> = fixed.iter().copied().collect();
        let mut count = 0;
        let column = assembly.ids().map(|p| {
            (!fixed.contains(&p)).then(|| {
                count += freedom.unknowns();
                count - freedom.unknowns()
            })
        });
        let column = column.collect();
        let centre: Vec<DVec3> = assembly.ids().map(|p| assembly.centre(p)).collect();
        let mut lever = vec![0.0; centre.len()];
        for row in rows {
            for p in [row.a.at(), row.b.at()] {
                lever[p] = f64::max(lever[p], (row.point - centre[p]).length());
            }
        }
        lever.iter_mut().filter(|l| **l == 0.0).for_each(|l| *l = 1.0);
        Unknowns { freedom, column, centre, lever, count }
    }

    /// The row's entries (column, value), columns rising within each part.
    pub fn entries(&self, row: &Row) -> impl Iterator<Item = (usize, f64)> + use<> {
        let sides = [(row.a, -1.0), (row.b, 1.0)].map(|(part, sign)| {
            let arm = row.point - self.centre[part.at()];
            (
                self.column[part.at()],
                row.normal * sign,
                arm.cross(row.normal) * (sign / self.lever[part.at()]),
            )
        });
        let width = self.freedom.unknowns();
        sides
            .into_iter()
            .filter_map(move |(c, n, m)| c.map(|c| (c, [n.x, n.y, n.z, m.x, m.y, m.z])))
            .flat_map(move |(c, values)| {
                values.into_iter().take(width).enumerate().map(move |(k, v)| (c + k, v))
            })
    }

    /// The row applied to a motion: how fast the contact opens.
    pub fn opening(&self, row: &Row, x: &[f64]) -> f64 {
        self.entries(row).map(|(c, v)| v * x[c]).sum()
    }
}
