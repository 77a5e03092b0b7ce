mod bad_input;
mod hands;
mod plan;
mod report;
mod weave;
