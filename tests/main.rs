mod bad_input;
mod weave;
