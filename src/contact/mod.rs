//! Takes an assembly, gives contact patches between parts.

pub mod mesh;
pub mod woven;

use crate::assembly::PartIx;
use glam::DVec3;

/// A planar convex polygon on which part `a` and part `b` touch, in the assembly's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    pub a: PartIx,
    pub b: PartIx,
    /// Unit normal from `a` to `b`.
    pub normal: DVec3,
    pub corners: Vec<DVec3>,
}
