//! Re-checks answers without the code that made them.

pub mod plan;
