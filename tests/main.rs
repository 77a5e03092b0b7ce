mod bad_input;
mod plan;
mod report;
mod weave;
