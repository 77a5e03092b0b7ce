//! The program: arguments in, answer out, exit code 0, 1 or 2.

use clap::Parser;
use std::process::ExitCode;
use weavelock::cli;

fn main() -> ExitCode {
    cli::main(cli::args::Args::parse())
}
