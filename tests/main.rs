//! One test binary, a file for each kind of promise. Slow tests are marked `#[ignore]`; `tests/run` runs them too.

mod atlas;
mod bad_input;
mod blocking;
mod certificates;
mod cli;
mod fab;
mod flex;
mod golden;
mod hands;
mod interlock;
mod known;
mod laws;
mod mesh;
mod molds;
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
