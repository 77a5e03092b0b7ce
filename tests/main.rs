mod fab;
mod bad_input;
mod mesh;
mod plan;
mod report;
mod weave;
