mod bad_input;
mod mesh;
mod pages;
mod plan;
mod report;
mod weave;
