//! Takes a part as it is to be cast (mm, allowance built in) and what is wanted; gives the mold: pieces, OpenSCAD
//! sources, maps, measurements, findings.
//!
//! Not promised: that a mold fills, freezes or releases as geometry says; friction, flow and heat are not modelled.

pub mod checks;
mod cores;
mod curtain;
pub mod figures;
pub mod fill;
pub mod fins;
pub mod frame;
mod grown;
pub mod layout;
mod make;
mod maps;
mod more_parts;
pub mod parting;
mod picture;
mod pictures;
pub mod plan;
mod pour;
mod prepare;
pub mod pull;
pub mod ray;
mod rigid;
mod rooms;
mod scad;
pub mod shadow;
mod silicone;
pub mod surroundings;
pub mod tops;
mod tree;
mod two_part;
mod types;
mod wax;
mod write;

pub use make::make;
pub use types::*;
pub use write::{check_openscad, write};
