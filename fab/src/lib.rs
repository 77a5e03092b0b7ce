//! Takes closed solids in mm, face roles and a process; gives parts with clearance and allowance built in, their files,
//! what was measured on them, and findings. It knows nothing of weaves.
//!
//! ```text
//! shape -> offset { body -> weld -> split -> settle -> relief } -> ledger (scale) -> files -> gap, wall -> check -> report -> package
//! ```
//!
//! `make` goes through all of it; `mold` makes the mold of one part, by the booleans of `solid`, and `package` puts molds
//! to the parts that need one. Not promised: that every wall keeps the least wall of a process; where one does not is said.

pub mod bvh;
pub mod check;
pub mod congruent;
pub mod coupon;
pub mod cross;
mod ears;
mod external;
pub mod files;
mod findings;
pub mod gap;
pub mod ledger;
pub mod make;
pub mod mesh;
pub mod mold;
pub mod near;
pub mod offset;
pub mod package;
mod pieces;
pub mod pinch;
mod print_face;
pub mod process;
pub mod report;
pub mod shape;
pub mod shave;
pub mod solid;
pub mod threemf;
mod toml_faults;
pub mod wall;
