//! One test binary, a file for each kind of promise. Slow tests are marked `#[ignore]`; `tests/run` runs them too.

mod bad_input;
mod certificates;
mod cli;
mod fab;
mod flex;
mod golden;
mod hands;
mod known;
mod laws;
mod mesh;
mod pages;
mod plan;
mod random;
mod repeats;
mod report;
mod second;
mod structure;
mod support;
mod twins;
mod weave;
