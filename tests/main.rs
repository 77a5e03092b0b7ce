mod bad_input;
mod hands;
mod mesh;
mod pages;
mod plan;
mod report;
mod weave;
