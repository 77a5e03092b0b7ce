//! One test binary, a file for each kind of promise. Slow tests are marked `#[ignore]`; `tests/run` runs them too.

mod bad_input;
mod blocking;
mod certificates;
mod cli;
mod fab;
mod golden;
mod hands;
mod interlock;
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
