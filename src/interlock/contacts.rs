//! Takes contacts of an assembly, answers which groups of parts can start to move among which others.
//!
//! Sound up to the round-off of `locking`; nothing is asked about more than [`MOST_UNKNOWNS`].

use super::{MOST_UNKNOWNS, Set};
use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::locking::{Freedom, Row, Unknowns, Verdict, decide, rows};
use std::collections::BTreeSet;

pub struct Contacts {
    rows: Vec<Row>,
    /// Numbers of the rows of each part.
    of: Vec<Vec<usize>>,
    unknowns: Unknowns,
}

impl Contacts {
    pub fn new(asm: &Assembly, patches: &[Patch]) -> Contacts {
        let rows = rows(patches, Freedom::Rigid);
        let mut of = vec![Vec::new(); asm.parts.len()];
        for (k, row) in rows.iter().enumerate() {
            of[row.a.at()].push(k);
            of[row.b.at()].push(k);
        }
        let all: Vec<PartIx> = asm.ids().collect();
        let unknowns = Unknowns::new(asm, &rows, &all, Freedom::Rigid);
        Contacts { rows, of, unknowns }
    }

    /// The rows between the moving parts, and between them and those that stand still.
    pub fn rows<'a>(&'a self, moving: &Set, among: &Set) -> Vec<&'a Row> {
        let near: BTreeSet<usize> = moving.iter().flat_map(|p| self.of[p.at()].iter().copied()).collect();
        let inside = |r: &Row| among.contains(&r.a) && among.contains(&r.b);
        near.into_iter().map(|k| &self.rows[k]).filter(|r| inside(r)).collect()
    }

    /// Parts that a part touches.
    pub fn beside(&self, p: PartIx) -> impl Iterator<Item = PartIx> + '_ {
        self.of[p.at()]
            .iter()
            .map(move |&k| if self.rows[k].a == p { self.rows[k].b } else { self.rows[k].a })
    }

    /// The verdict about rigid motions of `moving`, each part by itself, while the rest of `among` stands still and all
    /// others are not there; none beyond [`MOST_UNKNOWNS`].
    pub fn verdict(&self, moving: &Set, among: &Set) -> Option<Verdict> {
        let width = Freedom::Rigid.unknowns();
        if moving.len() * width > MOST_UNKNOWNS {
            return None;
        }
        let rows: Vec<Row> = self.rows(moving, among).into_iter().copied().collect();
        let mut column = vec![None; self.of.len()];
        for (k, p) in moving.iter().enumerate() {
            column[p.at()] = Some(k * width);
        }
        let unknowns = Unknowns { column, count: moving.len() * width, ..self.unknowns.clone() };
        Some(decide(&rows, &unknowns))
    }

    pub fn centre(&self, p: PartIx) -> glam::DVec3 {
        self.unknowns.centre[p.at()]
    }

    /// Model units; makes turns comparable with shifts.
    pub fn lever(&self) -> f64 {
        self.unknowns.lever.iter().copied().fold(f64::MIN_POSITIVE, f64::max)
    }
}
