//! Takes a part as it is to be cast (mm, allowance built in) and what is wanted; gives the mold: pieces, OpenSCAD
//! sources, maps, measurements, findings.
//!
//! Not promised: that a mold fills, freezes or releases as geometry says; friction, flow and heat are not modelled.

pub mod figures;
pub mod frame;
pub mod plan;
pub mod pull;
pub mod ray;
pub mod shadow;
mod types;

pub use types::*;
