//! Takes solids in place and contact patches, gives which part stops which along a direction: to first order and for good.
//!
//! Finite blocking is sound and complete for the convex cells given, up to [`Touch`]: an overlap no deeper than that
//! counts as sliding. It says nothing of matter that no cell covers, nor of cells thinner than [`Touch`].
//!
//! Laws (d a direction, i and j parts):
//! 1. i stops j along d exactly when j stops i along -d.
//! 2. Turning, moving, mirroring or scaling the whole assembly changes no arc.
//! 3. Parts that only touch or slide do not stop one another.

pub mod cone;
pub mod graph;
pub mod ndbg;
pub mod reach;
pub mod sector;
pub mod shadow;
pub mod sweep;

use crate::assembly::Assembly;
use glam::DVec3;

/// Share of the smallest part's box diagonal below which an overlap counts as touching: 2^-20.
///
/// Coordinates carry round-off of about 2^-40 of a crossing. A facet of span s therefore knows its normal to 2^-40 / s,
/// and a slide along it drifts by 2^-40 T / s over a way T. With s >= 2^-12 and T <= 2^6 that is 2^-22: a fourth of
/// this share, which at a pitch of 20 mm is 20 nm, far below what any workshop can make.
pub const TOUCH_SHARE: f64 = 1.0 / (1u64 << 20) as f64;

/// Round-off of a coordinate as a share of the assembly's extent, with a factor 4 for sums of three products: 2^-38.
pub const ROUND_OFF_SHARE: f64 = 1.0 / (1u64 << 38) as f64;

/// Angle in radians below which two directions count as one and a plane as parallel: [`TOUCH_SHARE`], because a part
/// of diagonal D moved by D along a direction wrong by this angle ends [`Touch`] away from where it should.
pub const SAME_ANGLE: f64 = TOUCH_SHARE;

/// Depth, in model units, up to which an overlap counts as touching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch(f64);

impl Touch {
    /// [`TOUCH_SHARE`] of the smallest part's box diagonal, but never below the round-off of the coordinates, nor below
    /// what the corners of two faces that are meant to touch may stand off them.
    pub fn of(asm: &Assembly) -> Touch {
        let boxes: Vec<(DVec3, DVec3)> = asm.ids().map(|p| bounds(asm.vertices(p))).collect();
        let least = boxes.iter().map(|(lo, hi)| (*hi - *lo).length()).fold(f64::INFINITY, f64::min);
        let reach = boxes.iter().map(|(lo, hi)| lo.abs().max(hi.abs()).max_element()).fold(0.0, f64::max);
        let off = asm.ids().map(|p| 2.0 * asm.solid(p).off).fold(reach * ROUND_OFF_SHARE, f64::max);
        Touch(if least.is_finite() { (least * TOUCH_SHARE).max(off) } else { 0.0 })
    }

    /// Model units.
    pub fn depth(self) -> f64 {
        self.0
    }
}

/// Least and greatest corner of the box around some points; (inf, -inf) around none.
pub fn bounds(points: impl Iterator<Item = DVec3>) -> (DVec3, DVec3) {
    points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| (lo.min(p), hi.max(p)))
}
