//! One test binary, a file for each kind of promise. Slow tests are marked `#[ignore]`; `tests/run` runs them too.

mod fab;
mod bad_input;
mod hands;
mod certificates;
mod cli;
mod golden;
mod known;
mod laws;
mod mesh;
mod pages;
mod plan;
mod random;
mod report;
mod second;
mod structure;
mod support;
mod twins;
mod weave;
