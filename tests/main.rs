mod fab;
mod bad_input;
mod weave;
mod plan;
mod report;
