//! Takes four answers; writes a commented spec of a woven assembly that the other verbs read.
//!
//! Not promised: that the assembly locks; that is the next question.

use super::questions::argument;
use super::told::{News, Told, Trouble};
use crate::report::content::{Chapter, Tone};
use crate::report::file::write_whole;
use crate::spec::{self, Syntax, length_mm};
use crate::weave::Weave;
use clap::Args;
use serde::Serialize;
use std::io::{BufRead, Write};
use std::path::PathBuf;
use weavelock_fab::process::{self, Process};

#[derive(Args, Debug)]
pub struct Asked {
    #[arg(default_value = "weave.toml")]
    pub file: PathBuf,
    /// Take the answer that Enter gives to every question, ask nothing
    #[arg(long)]
    pub defaults: bool,
    /// Replace the file if it is there
    #[arg(long)]
    pub force: bool,
}

/// A question with the answer that Enter gives; `check` says what is wrong with another.
struct Question {
    text: &'static str,
    default: &'static str,
    check: fn(&str) -> Result<(), String>,
}

const QUESTIONS: [Question; 4] = [
    Question {
        text: "Which weave: plain, twill or satin, or [a,b,c] (over a, under b, each row shifted by c)?",
        default: "plain",
        check: |text| Weave::parse_abc(abc(text)).map(|_| ()).map_err(|e| e.to_string()),
    },
    Question {
        text: "How many strands across and along (wefts x warps)?",
        default: "2 x 2",
        check: |text| strands(text).map(|_| ()),
    },
    Question {
        text: "How far apart are they (the pitch, with its unit)?",
        default: "20 mm",
        check: |text| match length_mm(text)? {
            mm if mm > 0.0 => Ok(()),
            _ => Err("a pitch is more than 0".into()),
        },
    },
    Question {
        text: "How is it made? (`weavelock processes` lists the names)",
        default: "fdm-pla",
        check: |text| match process::names().any(|n| n == text) {
            true => Process::find(text).map(|_| ()).map_err(|e| e.to_string()),
            false => Err(format!("the processes are {}", process::names().collect::<Vec<_>>().join(", "))),
        },
    },
];

/// Weaves by their name, each the smallest that has it.
const WEAVES: [(&str, &str); 3] = [("plain", "[1,1,1]"), ("twill", "[2,2,1]"), ("satin", "[4,1,2]")];

/// What is said of a weave as `[a,b,c]`.
fn abc(text: &str) -> &str {
    WEAVES.iter().find(|w| w.0.eq_ignore_ascii_case(text.trim())).map_or(text, |w| w.1)
}

/// Wefts and warps, as "2 x 3".
fn strands(text: &str) -> Result<[u32; 2], String> {
    let hint = || "write two whole numbers of at least 1, as \"4 x 4\"".to_string();
    let (a, b) = text.split_once(['x', 'X', ',', '*']).ok_or_else(hint)?;
    let one = |t: &str| t.trim().parse::<u32>().ok().filter(|n| *n > 0).ok_or_else(hint);
    Ok([one(a)?, one(b)?])
}

/// Answer of `new`.
#[derive(Serialize, schemars::JsonSchema)]
pub struct NewAnswer {
    pub verb: &'static str,
    pub file: String,
    pub text: String,
}

pub fn new(asked: &Asked) -> Result<Told, Trouble> {
    if asked.file.exists() && !asked.force {
        let hint = "give another name, or --force to replace it".to_string();
        return Err(argument(format!("{} is there already", asked.file.display()), hint).into());
    }
    let answers = if asked.defaults { QUESTIONS.map(|q| q.default.to_string()) } else { ask()? };
    let text = written(&answers)?;
    // What is written here must be read by the others.
    spec::parse(&text, &asked.file, Syntax::Toml)?;
    write_whole(&asked.file, text.as_bytes())?;
    let file = asked.file.display().to_string();
    let chapter = Chapter {
        tone: Tone::Good,
        headline: format!("Written to {file}."),
        words: vec![format!("Next: weavelock check {file}; everything at once: weavelock run {file}")],
        ..Chapter::default()
    };
    let answer = NewAnswer { verb: "new", file: file.clone(), text };
    Ok(Told::new(News::Good, &answer, &file, "A new spec", chapter))
}

/// Asks on stderr, reads on stdin; an answer that makes no sense is asked again, an end of input is an error.
fn ask() -> Result<[String; 4], Trouble> {
    let mut lines = std::io::stdin().lock().lines();
    let mut answers = Vec::new();
    for q in &QUESTIONS {
        let answer = loop {
            let _ = write!(std::io::stderr(), "{}\n  [Enter: {}] ", q.text, q.default);
            let _ = std::io::stderr().flush();
            let line = lines.next().and_then(Result::ok).ok_or_else(|| {
                Trouble::Word(
                    "error: the answers ended before the questions\n  hint: --defaults asks nothing".into(),
                )
            })?;
            let line = if line.trim().is_empty() { q.default.to_string() } else { line.trim().to_string() };
            match (q.check)(&line) {
                Ok(()) => break line,
                Err(why) => drop(writeln!(std::io::stderr(), "  {why}")),
            }
        };
        answers.push(answer);
    }
    let ended = || Trouble::Word("error: an answer is missing".into());
    <[String; 4]>::try_from(answers).map_err(|_| ended())
}

fn written([weave, count, pitch, process]: &[String; 4]) -> Result<String, Trouble> {
    let [wefts, warps] = strands(count).map_err(Trouble::Word)?;
    let inner = abc(weave).trim().trim_start_matches('[').trim_end_matches(']');
    let clearance = Process::find(process).map_or(f64::NAN, |p| p.clearance.value);
    Ok(format!(
        r#"# An assembly of woven tiles. Lengths along the cloth are in crossings; one crossing is the pitch.
name = "woven"

[weave]
# Over a, under b, each weft shifted by c against the one before. Or draft = ["X.", ".X"], or wif = "file.wif".
abc = [{inner}]

[profile]
# Share of a crossing over which a strand changes side: 0 is a square wave, 1 a zigzag.
rise = 0.6
# Height between the strand's two levels.
lift = 1.0
# Material below the lower and above the upper level.
cover = 1.0
# Sites in one crossing length: more follow the curved faces closer and take longer.
samples = 8

[swatch]
wefts = {wefts}
warps = {warps}
# "window": each strand is one piece; "tiles": pieces of `repeat` whole periods.
cut = "window"
# repeat = 2
# phase = 0
# held = ["weft-0"]       # parts that may not move; "rim" holds all at the edge

[size]
pitch = "{pitch}"

[fab]
# A name from `weavelock processes`, or a file of your own. Air on each face there: {clearance} mm.
process = "{process}"
"#
    ))
}
