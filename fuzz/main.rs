//! Takes the name of a reader, a time in seconds and a seed; feeds the reader mutants of the fixtures until then.
//!
//! `cargo run --release --example fuzz -- spec 600 1`. What breaks a promise is written to the folder `target` and
//! ends the run with code 1. Not promised: that an overflow of the stack is caught; it ends the program, and the same
//! seed ends it again.

mod driver;
mod targets;

use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let word = |at: usize| words.get(at).map(String::as_str);
    let reader = targets::READERS.iter().find(|(name, ..)| word(0) == Some(name));
    let (Some((name, target, endings)), Some(Ok(seconds))) = (reader, word(1).map(str::parse)) else {
        eprintln!("fuzz spec|wif|draft SECONDS [SEED]");
        return ExitCode::from(2);
    };
    let seed = word(2).and_then(|seed| seed.parse().ok()).unwrap_or(1);
    eprintln!("{name}: {seconds} s from seed {seed}");
    let outcome = driver::run(*target, targets::corpus(endings), seconds, seed);
    println!("{name}, seed {seed}: {} inputs, {} verdicts", outcome.inputs, outcome.verdicts);
    let Some(found) = outcome.found else { return ExitCode::SUCCESS };
    let file = format!("target/fuzz-{name}-{seed}");
    println!("broken by input {}: {}\nin {file}", outcome.inputs, found.why);
    if let Err(error) = std::fs::write(&file, &found.input) {
        println!("it could not be written: {error}\n{:?}", String::from_utf8_lossy(&found.input));
    }
    ExitCode::from(1)
}
