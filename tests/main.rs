mod bad_input;
mod hands;
mod mesh;
mod plan;
mod report;
mod weave;
