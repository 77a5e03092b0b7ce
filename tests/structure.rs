//! The tree as it is written: the flow runs one way, files stay short and say what they promise, nothing panics.
//!
//! Reads the sources as text: names in macros or behind `pub use` of another module are not followed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Each module of `src` and the modules that it may use. What stands in one line never uses its neighbours there.
const FLOW: [&[&str]; 19] = [
    &["fault", "solid", "watch"],
    &["input"],
    &["weave"],
    &["spec"],
    &["profile"],
    &["sites"],
    &["tile"],
    &["assembly"],
    &["contact"],
    &["blocking", "locking"],
    &["cores"],
    &["sequence"],
    &["made"],
    &["repeats", "flex", "chirality", "fabricate", "sampling", "interlock", "play", "release"],
    &["report"],
    &["verify"],
    &["atlas"],
    &["cli"],
    &["main"],
];

/// Arrows against the flow that stand today: user, used, and why it is borne. One that is gone must go from here.
const WAIVED: [(&str, &str, &str); 2] = [
    (
        "spec",
        "assembly",
        "`Mobility` (held or free) is read from files and kept by parts; it belongs to `solid`",
    ),
    ("sites", "tile", "sites lie on the exact grid of `tile::exact`, which is no part of the tile stage"),
];

/// Files longer than they should be, and why it is borne.
const LONG: [(&str, &str); 0] = [];

const MOST_LINES: usize = 500;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Rust files below a folder, by their path from the root, in order.
fn files(folder: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    let mut folders = vec![root().join(folder)];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for path in entries.map(|e| e.expect("a readable folder").path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.insert(name(&path), std::fs::read_to_string(&path).expect("UTF-8"));
            }
        }
    }
    found
}

fn name(path: &Path) -> String {
    path.strip_prefix(root()).expect("below the root").display().to_string()
}

fn sources() -> BTreeMap<String, String> {
    let mut all = files("src");
    all.append(&mut files("fab/src"));
    assert!(all.len() > 50, "only {} sources found", all.len());
    all
}

/// The text without comments and without what is compiled for tests alone (test modules end their file).
fn code(text: &str) -> String {
    let mut lines = text.lines().peekable();
    let mut kept = String::new();
    while let Some(line) = lines.next() {
        if line.trim() == "#[cfg(test)]" {
            match lines.peek() {
                Some(next) if next.trim_end().ends_with(';') => drop(lines.next()),
                _ => break,
            }
        } else {
            kept += line.find("//").map_or(line, |at| &line[..at]);
            kept.push('\n');
        }
    }
    kept
}

/// The module at the root of the crate that a file of `src` belongs to.
fn module(file: &str) -> &str {
    let inside = file.strip_prefix("src/").unwrap_or(file);
    inside.split('/').next().unwrap_or(inside).trim_end_matches(".rs")
}

/// Names that follow `crate::`, also in a group, and `super::` where that is the root.
fn used(file: &str, code: &str) -> BTreeSet<String> {
    let at_top =
        file.matches('/').count() == 1 || (file.matches('/').count() == 2 && file.ends_with("/mod.rs"));
    let heads = ["crate::", if at_top { "super::" } else { "crate::" }, "weavelock::"];
    let mut names = BTreeSet::new();
    for head in heads {
        for (at, _) in code.match_indices(head) {
            let rest = &code[at + head.len()..];
            match rest.strip_prefix('{') {
                Some(group) => names.extend(heads_of_group(group)),
                None => drop(names.insert(word(rest))),
            }
        }
    }
    names
}

fn word(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// First names of the items of a use group, nested groups left out.
fn heads_of_group(group: &str) -> Vec<String> {
    let (mut depth, mut start, mut heads) = (0, 0, Vec::new());
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => {
                heads.push(word(group[start..at].trim_start()));
                break;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => {
                heads.push(word(group[start..at].trim_start()));
                start = at + 1;
            }
            _ => {}
        }
    }
    heads
}

fn stage(module: &str) -> Option<usize> {
    FLOW.iter().position(|level| level.contains(&module))
}

#[test]
fn the_flow_runs_one_way() {
    let mut wrong = Vec::new();
    let mut waived = BTreeSet::new();
    for (file, text) in files("src").iter().filter(|(f, _)| *f != "src/lib.rs") {
        let own = module(file);
        let Some(level) = stage(own) else {
            wrong.push(format!("{file}: `{own}` has no place in the flow"));
            continue;
        };
        for other in used(file, &code(text)) {
            let below = match stage(&other) {
                Some(at) => at < level || own == other,
                None => true,
            };
            match WAIVED.iter().find(|w| w.0 == own && w.1 == other) {
                _ if below => {}
                Some(w) => drop(waived.insert((w.0, w.1))),
                None => wrong.push(format!("{file} uses `{other}`, which is not before `{own}` in the flow")),
            }
        }
    }
    let gone = WAIVED.iter().filter(|w| !waived.contains(&(w.0, w.1)));
    wrong.extend(gone.map(|w| format!("{} -> {} stands no more: take it from the waivers", w.0, w.1)));
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The package that makes things knows nothing of weaves.
#[test]
fn fab_knows_nothing_of_the_analysis() {
    let manifest = std::fs::read_to_string(root().join("fab/Cargo.toml")).expect("a manifest");
    assert!(!manifest.lines().any(|l| l.trim_start().starts_with("weavelock =")), "fab depends on the root");
    for (file, text) in files("fab/src") {
        let text = code(&text).to_lowercase();
        let found = ["weft", "warp_", "weavelock::"].iter().find(|w| text.contains(**w));
        assert_eq!(found, None, "{file}");
    }
}

#[test]
fn every_source_says_what_it_is_for() {
    let silent: Vec<String> =
        sources().into_iter().filter(|(_, t)| !t.starts_with("//!")).map(|(f, _)| f).collect();
    assert!(silent.is_empty(), "no `//!` at the top of {silent:?}");
}

#[test]
fn no_file_is_too_long() {
    let mut all = sources();
    all.append(&mut files("tests"));
    all.append(&mut files("benches"));
    let long: BTreeSet<String> =
        all.into_iter().filter(|(_, t)| t.lines().count() > MOST_LINES).map(|(f, _)| f).collect();
    let waived: BTreeSet<String> = LONG.iter().map(|l| l.0.to_string()).collect();
    assert_eq!(long, waived, "files over {MOST_LINES} lines against those waived");
}

/// A fault is a value; nothing here may end the program on its own.
#[test]
fn nothing_panics_by_name() {
    let words = [".unwrap()", ".expect(", "panic!", "todo!", "unimplemented!", "unreachable!"];
    let mut found = Vec::new();
    for (file, text) in sources() {
        let code = code(&text);
        let lines = code.lines().filter(|l| words.iter().any(|w| l.contains(w)));
        found.extend(lines.map(|l| format!("{file}: {}", l.trim())));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// Geometry does not print; the command line does.
#[test]
fn only_the_command_line_prints() {
    let mut found = Vec::new();
    for (file, text) in sources() {
        let code = code(&text);
        let prints = ["println!", "eprintln!", "print!(", "dbg!"].iter().any(|w| code.contains(w));
        if prints && !["cli", "main"].contains(&module(&file)) {
            found.push(file);
        }
    }
    assert!(found.is_empty(), "these print: {found:?}");
}

#[test]
fn the_reader_of_sources_reads() {
    let text = "use crate::{tile::{self, x}, sites};\n// crate::spec\nfn f() { crate::fault::g() }\n\
                #[cfg(test)]\nmod tests {\n use crate::report;\n}\n";
    let names: Vec<String> = used("src/a/b.rs", &code(text)).into_iter().collect();
    assert_eq!(names, ["fault", "sites", "tile"]);
    assert_eq!(module("src/assembly/mesh/obj.rs"), "assembly");
    assert_eq!(module("src/sites.rs"), "sites");
    let with_file = "#[cfg(test)]\nmod tests;\nuse crate::solid;\n";
    assert!(used("src/a.rs", &code(with_file)).contains("solid"));
}
