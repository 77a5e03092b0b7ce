//! Takes a reader and files that it knows; feeds it mutants of them and gives back the first that breaks a promise.
//!
//! Promised: the same seed gives the same mutants, whatever the time. Not promised: coverage; an input is kept for
//! further mutation when the reader says something about it that it has not said before.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Reads an input; gives its verdict in words, by which new behaviour is known, or panics where a promise is broken.
pub type Target = fn(&[u8]) -> String;

/// An input that broke a promise, and what happened.
#[derive(Debug)]
pub struct Found {
    pub input: Vec<u8>,
    pub why: String,
}

/// What a run came to.
#[derive(Debug)]
pub struct Outcome {
    pub inputs: u64,
    /// Different lines of verdicts seen.
    pub verdicts: usize,
    pub found: Option<Found>,
}

/// Longest that one input of at most [`LONGEST`] bytes may take; such files take milliseconds.
const SLOW: Duration = Duration::from_secs(2);

/// Longest mutant, in bytes.
const LONGEST: usize = 64 << 10;

/// Runs the target on mutants until the time is over or one is found that breaks a promise.
pub fn run(target: Target, corpus: Vec<Vec<u8>>, seconds: f64, seed: u64) -> Outcome {
    let (fixtures, mut corpus, mut verdicts, mut inputs) = (corpus.len(), corpus, BTreeSet::new(), 0);
    let mut random = Random(seed);
    let start = Instant::now();
    let mut waiting: Vec<Vec<u8>> = corpus.clone();
    let found = loop {
        if start.elapsed().as_secs_f64() > seconds {
            break None;
        }
        let input = waiting.pop().unwrap_or_else(|| mutant(&corpus, fixtures, &mut random));
        inputs += 1;
        match verdict(target, &input) {
            Ok(words) => {
                let known = verdicts.len();
                verdicts.extend(shapes(&words));
                if verdicts.len() > known {
                    corpus.push(input);
                }
            }
            Err(why) => break Some(Found { input, why }),
        }
    };
    Outcome { inputs, verdicts: verdicts.len(), found }
}

fn verdict(target: Target, input: &[u8]) -> Result<String, String> {
    let start = Instant::now();
    let words = catch_unwind(AssertUnwindSafe(|| target(input))).map_err(|panic| {
        let text = panic.downcast_ref::<String>().cloned();
        text.or_else(|| panic.downcast_ref::<&str>().map(|s| s.to_string())).unwrap_or_default()
    })?;
    match start.elapsed() {
        time if time > SLOW => Err(format!("it took {time:?}")),
        _ => Ok(words),
    }
}

/// Letters that tell one kind of line from another.
const SHAPE: usize = 60;

/// The shapes of a verdict's lines: letters only, without what stands in quotes (the user's own words). Only new lines
/// count, as there is no end of new mixtures.
fn shapes(words: &str) -> impl Iterator<Item = String> + '_ {
    words.lines().map(|line| {
        let outside = line.split(['"', '\'']).step_by(2).flat_map(str::chars);
        outside.filter(char::is_ascii_alphabetic).take(SHAPE).collect()
    })
}

/// SplitMix64: small, and the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `n`, and 0 below 0.
    fn below(&mut self, n: usize) -> usize {
        if n == 0 { 0 } else { (self.next() % n as u64) as usize }
    }

    fn pick<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[self.below(from.len())]
    }
}

/// Bits of text that readers take an interest in.
const WORDS: [&str; 64] = [
    "[weave]",
    "[profile]",
    "[swatch]",
    "[[piece]]",
    "[[part]]",
    "[size]",
    "[fab]",
    "[contact]",
    "abc = ",
    "draft = ",
    "wif = ",
    "held = ",
    "points = ",
    "lift = ",
    "cover = ",
    "rise = ",
    "samples = ",
    "\"rim\"",
    "\"tiles\"",
    "\"20 mm\"",
    "\"\"",
    "nan",
    "-inf",
    "1e308",
    "1e-308",
    "-0.0",
    "9223372036854775807",
    "-9223372036854775808",
    "99999999999999999999",
    "0x7fffffff",
    "64",
    "65",
    "1000000",
    "0",
    "-1",
    "0.5",
    "[0, 0.5]",
    "[",
    "]",
    "{",
    "}",
    ",",
    "=",
    ":",
    "\"",
    "'''",
    "\\u0000",
    "\\ud83d\\ude00",
    "\\ud800",
    "\n",
    "\r\n",
    "\t",
    ";",
    "[WIF]",
    "[LIFTPLAN]",
    "Rising Shed=no",
    "Threads=2048",
    "Shafts=512",
    "1=1,2,3",
    "X",
    ".",
    "XX..",
    "\u{feff}",
    "\u{1d11e}",
];

/// A mutant of one of the first `fixtures` of the corpus, or as often of any.
fn mutant(corpus: &[Vec<u8>], fixtures: usize, random: &mut Random) -> Vec<u8> {
    let from = if random.below(2) == 0 { &corpus[..fixtures] } else { corpus };
    let mut bytes = random.pick(from).clone();
    for _ in 0..=random.below(6) {
        mutate(&mut bytes, corpus, random);
    }
    bytes.truncate(LONGEST);
    bytes
}

fn mutate(bytes: &mut Vec<u8>, corpus: &[Vec<u8>], random: &mut Random) {
    let (from, to) = stretch(bytes, random);
    match random.below(8) {
        0 if !bytes.is_empty() => {
            let at = random.below(bytes.len());
            bytes[at] ^= 1 << random.below(8);
        }
        1 => drop(bytes.drain(from..to)),
        2 => {
            let copy: Vec<u8> = bytes[from..to].repeat(1 + random.below(4));
            bytes.splice(from..from, copy);
        }
        3 => {
            let other = random.pick(corpus);
            let (a, b) = stretch(other, random);
            bytes.splice(from..to, other[a..b].to_vec());
        }
        4 => drop(bytes.splice(from..from, random.pick(&WORDS).bytes())),
        5 => drop(bytes.splice(from..to, random.pick(&WORDS).bytes())),
        6 => other_number(bytes, random),
        _ => bytes.insert(from, random.next() as u8),
    }
}

/// A stretch of bytes, mostly short, sometimes whole lines.
fn stretch(bytes: &[u8], random: &mut Random) -> (usize, usize) {
    let from = random.below(bytes.len() + 1);
    let most = if random.below(4) == 0 { bytes.len() } else { 12 };
    let mut to = (from + random.below(most + 1)).min(bytes.len());
    if random.below(3) == 0 {
        to += bytes[to..].iter().position(|&b| b == b'\n').map_or(0, |at| at + 1);
    }
    (from, to)
}

/// Puts another number in the place of one that stands there.
fn other_number(bytes: &mut Vec<u8>, random: &mut Random) {
    let digits: Vec<usize> = (0..bytes.len()).filter(|&k| bytes[k].is_ascii_digit()).collect();
    if digits.is_empty() {
        return;
    }
    let number = |from: usize| from..from + bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let (here, there) = (number(*random.pick(&digits)), number(*random.pick(&digits)));
    let other = match random.below(5) {
        0 => random.below(70).to_string().into_bytes(),
        1 => (random.next() as i64 >> random.below(64)).to_string().into_bytes(),
        2 => format!("{:e}", f64::from_bits(random.next())).into_bytes(),
        _ => bytes[there].to_vec(),
    };
    bytes.splice(here, other);
}
