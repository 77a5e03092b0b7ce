//! Takes an assembly and its contact patches, gives what every search for a move asks again and again: cells by
//! orientation, patch normals by part, sizes. Nothing here decides anything.

use crate::assembly::{Assembly, Mobility, PartIx};
use crate::blocking::graph::{Pairs, pairs};
use crate::blocking::shadow::{Shapes, View};
use crate::blocking::sweep::meets;
use crate::blocking::{Touch, sector::Blocked};
use crate::contact::Patch;
use crate::watch::Watch;
use glam::DVec3;
use std::collections::BTreeSet;

/// A set of parts, in order.
pub type Set = BTreeSet<PartIx>;

/// The part across a patch, and the patch's normal toward it.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    pub other: PartIx,
    pub normal: DVec3,
}

#[derive(Debug)]
pub struct Field<'a> {
    pub asm: &'a Assembly,
    pub patches: &'a [Patch],
    pub shapes: Shapes,
    pub touch: Touch,
    pub pairs: Pairs,
    pub watch: Watch,
    sides: Vec<Vec<Side>>,
    volumes: Vec<f64>,
}

impl<'a> Field<'a> {
    pub fn new(asm: &'a Assembly, patches: &'a [Patch], watch: &Watch) -> Field<'a> {
        let mut sides = vec![Vec::new(); asm.parts.len()];
        for p in patches {
            sides[p.a.at()].push(Side { other: p.b, normal: p.normal });
            sides[p.b.at()].push(Side { other: p.a, normal: -p.normal });
        }
        let volumes = asm.solids.iter().map(|s| s.volume()).collect();
        Field {
            asm,
            patches,
            shapes: Shapes::of(asm),
            touch: Touch::of(asm),
            pairs: pairs(patches),
            watch: watch.clone(),
            sides,
            volumes,
        }
    }

    pub fn is_held(&self, p: PartIx) -> bool {
        self.asm.part(p).mobility == Mobility::Held
    }

    pub fn volume(&self, p: PartIx) -> f64 {
        self.volumes[self.asm.part(p).solid]
    }

    /// Patches between the moving parts and the rest, seen from the moving ones.
    pub fn sides<'s>(&'s self, moving: &'s Set, rest: &'s Set) -> impl Iterator<Item = Side> + 's {
        let between = |s: &&Side| rest.contains(&s.other);
        moving.iter().flat_map(move |m| self.sides[m.at()].iter().filter(between).copied())
    }

    /// The first moving and still part that meet along the view's direction, and the directions that they block.
    pub fn stopped(&self, view: &View, moving: &Set, rest: &Set) -> Option<(PartIx, Blocked)> {
        moving
            .iter()
            .flat_map(|&i| rest.iter().map(move |&j| (i, j)))
            .find_map(|(i, j)| meets(view, i, j, self.touch).map(|m| (j, self.blocked(i, m.a, j, m.b))))
    }

    /// The directions along which cell `a` of part `i` runs into cell `b` of part `j`.
    pub fn blocked(&self, i: PartIx, a: usize, j: PartIx, b: usize) -> Blocked {
        let ((ci, at_i), (cj, at_j)) = (self.shapes.part(i), self.shapes.part(j));
        Blocked::by_cells(&ci[a], &cj[b], at_j - at_i, self.touch.depth())
    }
}
