//! Takes solids and poses, or mesh files; gives parts with ids, which of them are held.
//!
//! Promised: part ids are unique and in the order of the file. Not promised: that parts touch, or that a swatch locks.

pub mod around;
pub mod layout;
pub mod mesh;
pub mod read;
pub mod voxel;
pub mod woven;

use crate::solid::{Cell, Solid};
use glam::{DAffine3, DVec3};

/// Index of a part in its assembly.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PartIx(pub u32);

impl PartIx {
    pub fn at(self) -> usize {
        self.0 as usize
    }
}

/// Whether a part may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mobility {
    Free,
    Held,
}

#[derive(Clone, Debug)]
pub struct Part {
    pub id: String,
    /// Index into [`Assembly::solids`]; congruent parts share one.
    pub solid: usize,
    /// Proper rigid motion from the solid's frame to the assembly's.
    pub pose: DAffine3,
    pub mobility: Mobility,
}

/// Parts in place. Lengths in model units; `mm_per_unit` turns them into millimetres.
#[derive(Clone, Debug)]
pub struct Assembly {
    pub name: String,
    pub solids: Vec<Solid>,
    pub parts: Vec<Part>,
    pub mm_per_unit: f64,
}

impl Assembly {
    pub fn ids(&self) -> impl Iterator<Item = PartIx> + use<> {
        (0..self.parts.len() as u32).map(PartIx)
    }

    pub fn part(&self, p: PartIx) -> &Part {
        &self.parts[p.at()]
    }

    pub fn solid(&self, p: PartIx) -> &Solid {
        &self.solids[self.part(p).solid]
    }

    /// The part's convex cells in the assembly's frame.
    pub fn cells(&self, p: PartIx) -> Vec<Cell> {
        let pose = &self.part(p).pose;
        self.solid(p).cells.iter().map(|c| c.moved(pose)).collect()
    }

    /// The part's vertices in the assembly's frame.
    pub fn vertices(&self, p: PartIx) -> impl Iterator<Item = DVec3> + '_ {
        let pose = self.part(p).pose;
        self.solid(p).vertices.iter().map(move |&v| pose.transform_point3(v))
    }

    /// Reference point of the part's twist: mean of its vertices, in the assembly's frame.
    pub fn centre(&self, p: PartIx) -> DVec3 {
        self.part(p).pose.transform_point3(self.solid(p).centre())
    }

    pub fn held(&self) -> impl Iterator<Item = PartIx> + '_ {
        self.ids().filter(|&p| self.part(p).mobility == Mobility::Held)
    }
}
