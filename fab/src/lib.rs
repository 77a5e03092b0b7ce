//! Takes closed solids in mm, face roles and a process; gives parts with clearance and allowance built in, their files,
//! what was measured on them, and findings. It knows nothing of weaves.

pub mod bvh;
pub mod cross;
pub mod ledger;
pub mod mesh;
pub mod near;
pub mod offset;
pub mod process;
pub mod shape;
mod toml_faults;
