//! One test binary, a file for each kind of promise. Slow tests are marked `#[ignore]`; `tests/run` runs them too.

mod bad_input;
mod known;
mod plan;
mod report;
mod structure;
mod support;
mod weave;
