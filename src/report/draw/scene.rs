//! Takes an assembly, gives the scene to draw: which mesh stands where, in what colour, seen from where.
//!
//! Promised: parts that share a solid share its mesh. Not promised: that exploded parts stay apart.

use super::camera::View;
use super::mesh::{CreaseAngle, Mesh};
use super::palette::{self, Colour};
use crate::assembly::{Assembly, PartIx};
use crate::solid::Solid;
use glam::{DAffine3, DVec3};
use std::sync::Arc;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Opacity {
    Solid,
    /// See-through; `alpha` in 0..=1 is the share of light that the part keeps. Casts no shadow.
    Ghost {
        alpha: f64,
    },
    /// Not drawn, yet the camera leaves room for it: the same view with and without a part.
    Hidden,
}

/// Whether an item takes light away from others. Glyphs do not: they are signs, not things.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadow {
    Cast,
    None,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    Transparent,
    Plain(Colour),
}

#[derive(Clone, Debug)]
pub struct Item {
    pub mesh: Arc<Mesh>,
    pub pose: DAffine3,
    /// Shift after the pose, in the scene's units: how far an exploded view moved the item.
    pub offset: DVec3,
    pub colour: Colour,
    pub opacity: Opacity,
    pub shadow: Shadow,
}

impl Item {
    pub fn new(mesh: Arc<Mesh>, colour: Colour) -> Item {
        Item {
            mesh,
            pose: DAffine3::IDENTITY,
            offset: DVec3::ZERO,
            colour,
            opacity: Opacity::Solid,
            shadow: Shadow::Cast,
        }
    }

    /// An arrow or another sign: solid, without a shadow.
    pub fn sign(solid: &Solid, colour: Colour) -> Item {
        Item { shadow: Shadow::None, ..Item::new(Arc::new(Mesh::of(solid, CreaseAngle::default())), colour) }
    }

    pub(super) fn place(&self, p: DVec3) -> DVec3 {
        self.pose.transform_point3(p) + self.offset
    }

    pub(super) fn points(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.mesh.vertices.iter().map(|&p| self.place(p))
    }
}

#[derive(Clone, Debug)]
pub struct Scene {
    pub items: Vec<Item>,
    pub view: View,
    pub background: Background,
}

impl Scene {
    /// The assembly as it stands; item `k` is part `k`.
    pub fn of(assembly: &Assembly, view: View) -> Scene {
        let meshes: Vec<Arc<Mesh>> =
            assembly.solids.iter().map(|s| Arc::new(Mesh::of(s, CreaseAngle::default()))).collect();
        let items = (assembly.parts.iter().enumerate())
            .map(|(k, p)| Item {
                pose: p.pose,
                ..Item::new(meshes[p.solid].clone(), palette::of_part(&p.id, k))
            })
            .collect();
        Scene { items, view, background: Background::Transparent }
    }

    /// The same scene with one part see-through, hidden or solid again; a part that is not there changes nothing.
    pub fn with(mut self, part: PartIx, opacity: Opacity) -> Scene {
        if let Some(item) = self.items.get_mut(part.at()) {
            item.opacity = opacity;
        }
        self
    }

    /// Moves every item away from the middle of all, by `spread` times its distance along each axis.
    pub fn exploded(mut self, spread: DVec3) -> Scene {
        let middles: Vec<DVec3> = self.items.iter().map(middle).collect();
        let all = middles.iter().sum::<DVec3>() / middles.len().max(1) as f64;
        for (item, m) in self.items.iter_mut().zip(middles) {
            item.offset += (m - all) * spread;
        }
        self
    }
}

/// Centre of the bounding box.
fn middle(item: &Item) -> DVec3 {
    let bounds = item.points().fold(None, |b: Option<(DVec3, DVec3)>, p| match b {
        None => Some((p, p)),
        Some((lo, hi)) => Some((lo.min(p), hi.max(p))),
    });
    bounds.map_or(DVec3::ZERO, |(lo, hi)| (lo + hi) / 2.0)
}
