//! Every example that help and README give runs, in a folder that holds the files they name.

use crate::support;
use clap::CommandFactory;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use weavelock::cli::args::Args;

/// Names in the examples and what they stand for.
const FILES: [(&str, &str); 4] = [
    ("piston.xmpuzzle", "fixtures/puzzles/piston.xmpuzzle"),
    ("plain.toml", "fixtures/examples/plain-2x2.toml"),
    ("twill.toml", "fixtures/assemblies/woven/twill-unit.toml"),
    ("roof.toml", "fixtures/assemblies/dovetail-open.toml"),
];

/// A folder with the files of the examples; meshes are named from their own folder.
fn room(name: &str) -> PathBuf {
    let at = support::room("examples", name);
    std::fs::create_dir(at.join("parts")).expect("a folder");
    for (to, from) in FILES {
        std::fs::copy(support::root().join(from), at.join(to)).expect("a fixture");
    }
    for mesh in
        std::fs::read_dir(support::root().join("fixtures/assemblies/parts")).expect("a folder").flatten()
    {
        std::fs::copy(mesh.path(), at.join("parts").join(mesh.file_name())).expect("a mesh");
    }
    at
}

/// The words of an example; double quotes hold words together. What follows `>` or `|` is the shell's.
fn words(example: &str) -> Vec<String> {
    let own = example.split(['>', '|']).next().unwrap_or_default();
    let mut words = vec![String::new()];
    let mut quoted = false;
    for c in own.chars() {
        match c {
            '"' => quoted = !quoted,
            c if c.is_whitespace() && !quoted => words.push(String::new()),
            c => words.last_mut().expect("a word").push(c),
        }
    }
    words.retain(|w| !w.is_empty());
    words
}

fn ran(words: &[String], at: &Path) -> Output {
    let program = Command::new(env!("CARGO_BIN_EXE_weavelock")).args(words).current_dir(at).output();
    program.expect("runs")
}

/// What stands in backticks and begins with the program's name.
fn examples(text: &str) -> Vec<String> {
    let own = text.split('`').skip(1).step_by(2).filter_map(|t| t.strip_prefix("weavelock "));
    own.map(str::to_string).collect()
}

fn answers(example: &str, at: &Path) {
    let out = ran(&words(example), at);
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(matches!(out.status.code(), Some(0 | 1)), "weavelock {example}: {:?}\n{said}", out.status);
    assert!(!out.stdout.is_empty(), "weavelock {example} says nothing");
}

#[test]
#[ignore = "half a minute"]
fn every_verb_has_an_example_that_runs() {
    let at = room("help");
    // `verify` reads what a check wrote.
    std::fs::create_dir_all(at.join("out")).expect("a folder");
    let check = ran(&words("check plain.toml --json"), &at);
    std::fs::write(at.join("out/check.json"), check.stdout).expect("written");
    for verb in Args::command().get_subcommands() {
        let own = verb.get_about().map(ToString::to_string).unwrap_or_default();
        let mut found = examples(&own);
        found.extend(verb.get_long_about().iter().flat_map(|t| examples(&t.to_string())));
        assert!(!found.is_empty(), "`weavelock {}` has no example", verb.get_name());
        // The atlas of the example takes a minute: a smaller one shows that it runs.
        let shorter = |e: &String| e.replace("--max-n 6", "--max-n 3");
        found.iter().for_each(|e| answers(&shorter(e), &at));
    }
}

#[test]
#[ignore = "half a minute"]
fn every_command_of_the_readme_runs() {
    let at = room("readme");
    let text = std::fs::read_to_string(support::root().join("README.md")).expect("a README");
    let own = text.lines().filter_map(|l| l.strip_prefix("    cargo run --release"));
    let own: Vec<&str> = own.filter(|l| !l.contains("-p weavelock-fab")).collect();
    assert!(own.len() >= 4, "{own:?}");
    for line in own {
        answers(line.strip_prefix(" -- ").unwrap_or(line), &at);
    }
}

/// Examples of the pages under docs/: lines set in by four blanks that begin with the program's name; what follows a
/// semicolon reads what the first wrote.
#[test]
#[ignore = "a minute"]
fn every_command_of_the_docs_runs() {
    let at = room("docs");
    std::fs::copy(support::root().join("fixtures/weaves/twill-2-2.draft"), at.join("my.draft"))
        .expect("a draft");
    let pages = std::fs::read_dir(support::root().join("docs")).expect("docs").flatten().map(|e| e.path());
    let pages: std::collections::BTreeSet<PathBuf> =
        pages.filter(|p| p.extension().is_some_and(|e| e == "md")).collect();
    let mut count = 0;
    for page in pages {
        let text = std::fs::read_to_string(&page).expect("a page");
        for line in text.lines().filter_map(|l| l.strip_prefix("    weavelock ")) {
            let line = line.split(" # ").next().unwrap_or_default();
            for part in line.split("; weavelock ").filter(|l| !l.starts_with("atlas")) {
                // The part that is named there stands in the README's roof; here it is the tail.
                answers_into(&part.replace("--flexible key", "--flexible tail"), &at);
                count += 1;
            }
        }
    }
    assert!(count >= 15, "{count} examples in docs/");
}

/// Runs an example; what it sends to a file is written there.
fn answers_into(example: &str, at: &Path) {
    let out = ran(&words(example), at);
    let said = String::from_utf8_lossy(&out.stderr);
    assert!(matches!(out.status.code(), Some(0 | 1)), "weavelock {example}: {:?}\n{said}", out.status);
    if let Some((_, file)) = example.split_once('>') {
        std::fs::write(at.join(file.trim()), out.stdout).expect("written");
    }
}

/// Specs shown in the README are read as they stand.
#[test]
fn the_specs_of_the_readme_are_read() {
    let at = room("shown");
    let parts = support::root().join("fixtures/assemblies/parts");
    std::fs::copy(parts.join("dovetail-socket.obj"), at.join("rail.obj")).expect("a mesh");
    std::fs::copy(support::root().join("fixtures/meshes/cube.stl"), at.join("panel.stl")).expect("a mesh");
    let text = std::fs::read_to_string(support::root().join("README.md")).expect("a README");
    let blocks: Vec<String> = text
        .split("\n\n")
        .filter(|b| b.starts_with("    name = "))
        .map(|b| b.lines().map(|l| format!("{}\n", l.trim_start())).collect())
        .collect();
    assert_eq!(blocks.len(), 2);
    for block in blocks {
        // The two meshes stand in for ones that do not overlap: the second is set aside.
        let block =
            block.replace("mesh = \"panel.stl\"", "mesh = \"panel.stl\"\nat = [1,0,0,90, 0,1,0,0, 0,0,1,0]");
        std::fs::write(at.join("shown.toml"), block).expect("a spec");
        answers("export shown.toml --still --as csv --out shown", &at);
    }
}

fn told(args: &[&str], at: &Path, typed: &str) -> Output {
    let mut program = Command::new(env!("CARGO_BIN_EXE_weavelock"));
    let piped = program
        .args(args)
        .current_dir(at)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = piped.spawn().expect("runs");
    child.stdin.take().expect("a pipe").write_all(typed.as_bytes()).expect("typed");
    child.wait_with_output().expect("ends")
}

#[test]
fn a_new_spec_is_asked_for_written_once_and_answers() {
    let at = room("new");
    // A slip is asked again; Enter takes the answer in brackets.
    let out = told(&["new", "own.toml"], &at, "twil\nTwill\n4 x 4\n12\n12 mm\n\n");
    assert_eq!(out.status.code(), Some(0), "{}", String::from_utf8_lossy(&out.stderr));
    let text = std::fs::read_to_string(at.join("own.toml")).expect("written");
    for line in ["abc = [2,2,1]", "wefts = 4", "warps = 4", "pitch = \"12 mm\"", "process = \"fdm-pla\""] {
        assert!(text.contains(line), "{line} is not in\n{text}");
    }
    answers("check own.toml", &at);
    let again = told(&["new", "own.toml", "--defaults"], &at, "");
    assert_eq!(again.status.code(), Some(2));
    assert_eq!(std::fs::read_to_string(at.join("own.toml")).expect("still there"), text);
    let short = told(&["new", "short.toml"], &at, "[1,1,1]\n");
    assert_eq!(short.status.code(), Some(2));
    assert!(!at.join("short.toml").exists());
}

#[test]
fn shells_and_the_manual_know_every_verb() {
    let at = room("shell");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let out = ran(&words(&format!("completions {shell}")), &at);
        let text = String::from_utf8(out.stdout).expect("UTF-8");
        for verb in Args::command().get_subcommands() {
            assert!(text.contains(verb.get_name()), "{shell} does not know {}", verb.get_name());
        }
    }
    let page = String::from_utf8(ran(&words("man"), &at).stdout).expect("UTF-8");
    for verb in Args::command().get_subcommands().filter(|v| v.get_name() != "help") {
        assert!(
            page.contains(&format!("WEAVELOCK {}", verb.get_name().to_uppercase())),
            "{}",
            verb.get_name()
        );
    }
}

#[test]
fn a_misspelt_verb_is_guessed() {
    let out = ran(&words("chek plain.toml"), &room("slip"));
    assert_eq!(out.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&out.stderr).contains("check"));
}
