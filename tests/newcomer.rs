//! What a newcomer gets wrong, and what the program says to it: another kind of file, a slip in a name, a unit that is
//! missing, the line ends and marks of other systems. Nothing is half-written, and every message has a hint.

use crate::support;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use weavelock_fab::mesh::Closure;

fn room(name: &str) -> PathBuf {
    let at = support::room("newcomer", name);
    std::fs::copy(support::root().join("fixtures/examples/plain-2x2.toml"), at.join("plain.toml"))
        .expect("a spec");
    at
}

fn ran(args: &[&str], at: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_weavelock")).args(args).current_dir(at).output().expect("runs")
}

fn said(out: &Output) -> String {
    String::from_utf8_lossy(&out.stderr).into_owned()
}

fn refused(args: &[&str], at: &Path, words: &[&str]) {
    let out = ran(args, at);
    let said = said(&out);
    assert_eq!(out.status.code(), Some(2), "{args:?}: {said}");
    assert!(out.stdout.is_empty(), "{args:?} answers beside its error");
    words.iter().for_each(|w| assert!(said.contains(w), "{args:?} does not say {w:?}:\n{said}"));
}

#[test]
fn another_kind_of_file_is_told_for_what_it_is() {
    let at = room("kinds");
    std::fs::copy(support::root().join("fixtures/meshes/cube.stl"), at.join("cube.stl")).expect("a mesh");
    std::fs::copy(support::root().join("fixtures/weaves/plain.wif"), at.join("plain.wif")).expect("a draft");
    std::fs::write(at.join("picture.png"), b"\x89PNG\r\n").expect("a file");
    std::fs::write(at.join("empty.toml"), b"").expect("a file");
    for verb in ["check", "plan", "flex", "report", "fab", "export"] {
        refused(&[verb, "cube.stl"], &at, &["this is one mesh", "[[part]]", "mesh = \"cube.stl\""]);
    }
    refused(&["check", "plain.wif"], &at, &["draft alone", "wif = \"plain.wif\"", "weavelock weave"]);
    refused(&["check", "picture.png"], &at, &["no description of an assembly", "weavelock new"]);
    refused(&["check", "[1,1,1]"], &at, &["a file is wanted", "weavelock new"]);
    refused(&["check", "."], &at, &["directory"]);
    refused(&["check", "empty.toml"], &at, &["empty"]);
    refused(&["check", "plian.toml"], &at, &["no such file", "did you mean plain.toml?"]);
    refused(&["check", "nothing-like-it.toml"], &at, &["no such file", "hint"]);
}

#[test]
fn what_a_mesh_is_told_to_write_is_read() {
    let at = room("advice");
    std::fs::copy(support::root().join("fixtures/meshes/cube.stl"), at.join("cube.stl")).expect("a mesh");
    std::fs::copy(support::root().join("fixtures/meshes/cube.stl"), at.join("another.stl")).expect("a mesh");
    let advice = said(&ran(&["check", "cube.stl"], &at));
    let spec: Vec<&str> = advice.lines().filter_map(|l| l.strip_prefix("    ")).collect();
    // Two cubes at one place overlap; moved beside it the second is a part that can leave.
    let spec =
        spec.join("\n").replace("\"another.stl\"", "\"another.stl\"\nat = [1,0,0,10, 0,1,0,0, 0,0,1,0]");
    std::fs::write(at.join("assembly.toml"), &spec).expect("a spec");
    let out = ran(&["check", "assembly.toml", "--json"], &at);
    assert_eq!(out.status.code(), Some(1), "{spec}\n{}", said(&out));
}

#[test]
fn paths_of_other_systems_are_told_how_they_are_written() {
    let at = room("paths");
    for line in ["mesh = \"C:\\parts\\cube.stl\"", "mesh = 'parts\\cube.stl'"] {
        std::fs::write(at.join("a.toml"), format!("[[part]]\n{line}\n")).expect("a spec");
        if !cfg!(windows) {
            refused(&["check", "a.toml"], &at, &["backslash", "write paths with /", "a.toml:2:"]);
        }
    }
}

#[test]
fn files_of_other_systems_are_read() {
    let at = room("systems");
    let text = std::fs::read_to_string(at.join("plain.toml")).expect("a spec");
    let folder = at.join("Stücke mit Leerzeichen");
    std::fs::create_dir(&folder).expect("a folder");
    let verdict = |file: &Path| {
        let out = ran(&["check", &file.display().to_string(), "--json"], &at);
        let answer: Value = serde_json::from_slice(&out.stdout).unwrap_or_else(|_| panic!("{}", said(&out)));
        answer["verdict"].clone()
    };
    for (name, text) in [
        ("windows.toml", text.replace('\n', "\r\n")),
        ("marked.toml", format!("\u{feff}{text}")),
        ("über alles.toml", text.clone()),
    ] {
        let file = folder.join(name);
        std::fs::write(&file, text).expect("a spec");
        assert_eq!(verdict(&file), "locked", "{name}");
    }
}

#[test]
fn a_name_that_cannot_be_written_is_refused_before_the_work() {
    let at = room("names");
    refused(&["report", "plain.toml", "--out", "no/page.html"], &at, &["no folder no", "make the folder"]);
    refused(&["report", "plain.toml", "--out", "."], &at, &["folder"]);
    refused(&["draw", "plain.toml", "--out", "no/a.png"], &at, &["no folder no"]);
    refused(&["draw", "plain.toml", "--out", "a.jpg"], &at, &[".png or .svg"]);
    refused(&["export", "plain.toml", "--out", "plain.dxf"], &at, &["stl, obj, ply, glb", "--as"]);
    refused(&["export", "plain.toml", "--as", "stl", "--out", "plain.obj"], &at, &["stl", "--as"]);
    refused(&["plan", "plain.toml", "--clearance=-0.2 mm"], &at, &["not negative"]);
    refused(&["plan", "plain.toml", "--clearance", "0.2"], &at, &["unit"]);
    let left: Vec<_> = std::fs::read_dir(&at).expect("a folder").flatten().map(|e| e.file_name()).collect();
    assert_eq!(left, ["plain.toml"], "something was written");
}

/// The page of the case, in which a knob is shut up: no mold forms its hollow.
#[test]
fn a_hollow_that_no_mold_forms_is_a_page_with_its_picture() {
    let at = room("hollow");
    let case = support::root().join("fixtures/assemblies/knob-in-case.toml").display().to_string();
    let out = ran(&["report", &case, "--mold", "case", "--out", "case.html", "--quiet"], &at);
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    let page = std::fs::read_to_string(at.join("case.html")).expect("a page");
    let molds =
        page.split("id=\"molds\"").nth(1).and_then(|t| t.split("</section>").next()).expect("a chapter");
    for words in [
        "No mold of case",
        "hollow inside that no mold can form",
        "<img",
        "around a hollow",
        "320.00",
        "384.00",
    ] {
        assert!(molds.contains(words), "{words} is not in the chapter");
    }
    assert!(page.contains("why there is no mold of case") && page.contains("Hollow inside"));
    let drawn = ran(&["draw", &case, "--what", "mold", "--part", "case", "--out", "case.png"], &at);
    assert_eq!((drawn.status.code(), at.join("case.png").exists()), (Some(1), false));
    assert!(String::from_utf8_lossy(&drawn.stdout).contains("hollow"));
    refused(&["report", &case, "--mold", "case", "--process", "sla"], &at, &["no mold", "silicone-platinum"]);
    refused(&["report", &case, "--mold", "case", "--process", "slla"], &at, &["slla", "fdm-pla"]);
}

/// A part that touches itself along an edge: 3MF wants two facets to each edge.
#[test]
fn a_part_that_touches_itself_is_a_3mf_of_two_facets_to_an_edge() {
    let at = room("pinched");
    let mesh = "odd-touches-itself.obj";
    std::fs::copy(support::root().join("fixtures/meshes").join(mesh), at.join(mesh)).expect("a mesh");
    std::fs::write(at.join("a.toml"), format!("[[part]]\nmesh = \"{mesh}\"\n")).expect("a spec");
    let out = ran(&["export", "a.toml", "--out", "a.3mf"], &at);
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    let read = weavelock_fab::threemf::read(&std::fs::read(at.join("a.3mf")).expect("a file")).expect("3MF");
    assert_eq!(read.len(), 1);
    for mesh in &read {
        assert_eq!(mesh.closure(), Closure::Closed);
        assert!(!mesh.is_pinched(), "an edge of four facets");
    }
}

/// One part alone is "locked" by the letter; nobody must take that for a lock that was found.
#[test]
fn a_lock_for_want_of_anything_to_move_is_told_as_such() {
    let at = room("alone");
    std::fs::copy(support::root().join("fixtures/meshes/cube.stl"), at.join("cube.stl")).expect("a mesh");
    let part = |id: &str| format!("[[part]]\nid = \"{id}\"\nmesh = \"cube.stl\"\n");
    std::fs::write(at.join("one.toml"), format!("name = \"one\"\n{}", part("a"))).expect("a spec");
    let out = ran(&["check", "one.toml"], &at);
    let words = String::from_utf8_lossy(&out.stdout).into_owned();
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    assert!(words.contains("nothing may move") && !words.contains("Proof"), "{words}");
    let whole = ran(&["check", "plain.toml"], &at);
    assert!(String::from_utf8_lossy(&whole.stdout).contains("Proof"), "a true lock keeps its words");
}
