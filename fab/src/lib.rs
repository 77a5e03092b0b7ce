//! Takes closed solids in mm, face roles and a process; gives parts with clearance and allowance built in, their files,
//! what was measured on them, and findings. It knows nothing of weaves.

pub mod bvh;
pub mod check;
pub mod cross;
mod external;
pub mod files;
mod findings;
pub mod gap;
pub mod ledger;
pub mod make;
pub mod mesh;
pub mod near;
pub mod offset;
pub mod process;
pub mod report;
pub mod shape;
mod toml_faults;
