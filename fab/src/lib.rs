//! Takes closed solids in mm, face roles and a process; gives parts with clearance and allowance built in, their files,
//! what was measured on them, and findings. It knows nothing of weaves.
//!
//! ```text
//! shape -> offset { body -> weld -> split -> settle -> relief } -> ledger (scale) -> files -> gap, wall -> check -> report -> package
//! ```
//!
//! `make` goes through all of it; `mold` makes the mold of one part, by the booleans of `solid`. Not promised: that `make`
//! calls `mold`, and walls against the least wall of a process; both are said in the report.

pub mod bvh;
pub mod check;
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
pub mod process;
pub mod report;
pub mod shape;
pub mod solid;
pub mod threemf;
mod toml_faults;
pub mod wall;
