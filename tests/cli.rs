//! The program as a user meets it: verbs, keys of the answers, exit codes, what goes to stdout and what to stderr.

use crate::support;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn fixture(name: &str) -> String {
    support::root().join("fixtures").join(name).display().to_string()
}

fn woven(name: &str) -> String {
    fixture(&format!("assemblies/woven/{name}.toml"))
}

fn room(name: &str) -> PathBuf {
    support::room("cli", name)
}

fn program(args: &[&str], at: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weavelock"));
    command.args(args).current_dir(at);
    command
}

fn ran(args: &[&str], at: &Path) -> Output {
    program(args, at).output().expect("the program starts")
}

fn code(out: &Output) -> i32 {
    out.status.code().expect("an exit code, not a signal")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// The one JSON object on stdout.
fn json(out: &Output) -> Value {
    let text = text(&out.stdout);
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("not one object: {e}\n{text}\n{:?}", out.stderr))
}

/// A verb that is not there yet says so, and nothing else.
fn not_built(out: &Output) -> bool {
    code(out) == 2 && out.stdout.is_empty() && text(&out.stderr).contains("not built yet")
}

/// Verb and what follows it, the keys that its answer has at least, and its exit code.
type Row = (&'static [&'static str], &'static [&'static str], i32);

const CHECK: &[&str] = &["verdict", "translation", "parts", "contacts", "rows", "held"];
const PLAN: &[&str] = &["outcome", "steps"];
const FLEX: &[&str] = &["minimum", "lower_bound", "sets"];
const FAB: &[&str] = &["parts", "molds", "scale", "ledger", "findings"];
const HANDS: &[&str] = &["tile", "warp_is", "assembly"];

/// `LOCKED` and `FREE` stand for files.
const ROWS: [Row; 13] = [
    (&["check", "LOCKED"], CHECK, 0),
    (&["check", "FREE"], CHECK, 1),
    (&["check", "LOCKED", "--fix", "warp-1"], CHECK, 0),
    (&["plan", "LOCKED"], PLAN, 1),
    (&["plan", "FREE"], PLAN, 0),
    (&["plan", "LOCKED", "--of", "weft-0,weft-1,warp-0"], PLAN, 0),
    (&["flex", "LOCKED"], FLEX, 0),
    (&["repeats", "[1,1,1]", "--most", "2"], &["minimal_repeat", "table"], 0),
    (&["chirality", "[3,1,1]"], HANDS, 0),
    (&["weave", "[2,2,1]"], &["draft", "period", "floats", "family", "hangs_together"], 0),
    (&["fab", "LOCKED", "--out", "parts"], FAB, 0),
    (&["export", "LOCKED", "--as", "obj", "--out", "export"], &["files"], 0),
    (&["schema"], &["check", "plan", "spec"], 0),
];

fn row_ran(args: &[&str], at: &Path) -> Output {
    let (locked, free) = (woven("plain-window"), woven("plain-unit"));
    let of = |a: &&str| match *a {
        "LOCKED" => locked.clone(),
        "FREE" => free.clone(),
        a => a.to_string(),
    };
    let args: Vec<String> = args.iter().map(of).chain(["--json".to_string()]).collect();
    ran(&args.iter().map(String::as_str).collect::<Vec<_>>(), at)
}

#[test]
fn every_verb_answers_with_its_keys_and_its_exit_code() {
    let at = room("verbs");
    for (args, keys, exit) in ROWS {
        let out = row_ran(args, &at);
        if not_built(&out) {
            println!("not run: {args:?} is not built yet");
            continue;
        }
        assert_eq!(code(&out), exit, "{args:?}\n{}", text(&out.stderr));
        let answer = json(&out);
        let missing: Vec<_> = keys.iter().filter(|k| answer.get(**k).is_none()).collect();
        assert!(missing.is_empty(), "{args:?} lacks {missing:?}");
    }
}

#[test]
fn a_verdict_comes_with_its_one_witness() {
    let at = room("witness");
    for (file, witness) in
        [("plain-window", "certificate"), ("plain-unit", "motion"), ("twill-shifted", "motion")]
    {
        let answer = json(&ran(&["check", &woven(file), "--json"], &at));
        let has: Vec<_> =
            ["certificate", "motion", "gap"].into_iter().filter(|k| answer.get(*k).is_some()).collect();
        assert_eq!(has, [witness], "{file}");
    }
}

#[test]
fn steps_say_what_moves_how_and_what_is_kept() {
    let answer = json(&ran(&["plan", &woven("plain-unit"), "--json"], &room("steps")));
    assert_eq!(answer["outcome"], "assembled");
    for step in answer["steps"].as_array().expect("steps") {
        assert!(["translation", "screw"].contains(&step["kind"].as_str().expect("a kind")), "{step}");
        assert!(step["parts"].as_array().is_some_and(|p| !p.is_empty()), "{step}");
        assert!(step["clear"].as_f64().is_some_and(|c| c >= 0.0), "{step}");
    }
}

#[test]
fn an_answer_is_verified_and_a_changed_one_is_not() {
    let at = room("verify");
    for (name, verb) in [("plain-window", "check"), ("plain-unit", "check"), ("plain-unit", "plan")] {
        let answer = ran(&[verb, &woven(name), "--json"], &at).stdout;
        std::fs::write(at.join("good.json"), &answer).expect("written");
        let good = ran(&["verify", "good.json", "--json"], &at);
        assert_eq!((code(&good), json(&good)["valid"].clone()), (0, Value::from(true)), "{name}");
        let changed = text(&answer).replacen("0.", "0.0", 1);
        assert_ne!(changed, text(&answer));
        std::fs::write(at.join("bad.json"), changed).expect("written");
        let bad = ran(&["verify", "bad.json", "--json"], &at);
        assert_eq!((code(&bad), json(&bad)["valid"].clone()), (1, Value::from(false)), "{name}");
    }
}

#[test]
fn bad_input_is_told_on_stderr_alone_and_ends_with_2() {
    let at = room("bad");
    std::fs::write(at.join("typo.toml"), "name = \"x\"\n[weave]\nabc = [1, 0.5, 1]\n[swatsh]\nwefts = -2\n")
        .unwrap();
    std::fs::write(at.join("empty.json"), "{}").unwrap();
    let cases: [&[&str]; 9] = [
        &["check", "nothing-here.toml"],
        &["check", "."],
        &["check", "typo.toml"],
        &["plan", "typo.toml"],
        &["fab", "typo.toml", "--out", "parts"],
        &["verify", "empty.json"],
        &["verify", "typo.toml"],
        &["repeats", "[1,1"],
        &["no-such-verb"],
    ];
    for args in cases {
        for json in [false, true] {
            let args: Vec<&str> = args.iter().copied().chain(json.then_some("--json")).collect();
            let out = ran(&args, &at);
            assert_eq!(code(&out), 2, "{args:?}: {}", text(&out.stderr));
            assert!(out.stdout.is_empty(), "{args:?}: {}", text(&out.stdout));
            let told = text(&out.stderr);
            assert!(!told.trim().is_empty() && !told.contains("panicked"), "{args:?}: {told}");
        }
    }
    let told = text(&ran(&["check", "typo.toml"], &at).stderr);
    assert!(told.contains("typo.toml:3") && told.contains("swatsh"), "all faults with their places: {told}");
    assert!(!at.join("parts").exists(), "something was written");
}

/// A file where a folder should be; the superuser may write anywhere else.
#[test]
fn a_folder_that_cannot_be_made_is_an_error_and_leaves_nothing() {
    let at = room("unwritable");
    std::fs::write(at.join("file"), "in the way").unwrap();
    let locked = woven("plain-window");
    let cases: [&[&str]; 5] = [
        &["fab", &locked, "--out", "file/parts"],
        &["export", &locked, "--out", "file/parts"],
        &["report", &locked, "--out", "file/page.html"],
        &["run", &locked, "--out", "file/out"],
        &["weave", "[1,1,1]", "--svg", "file/weave.svg"],
    ];
    for args in cases {
        let out = ran(args, &at);
        assert_eq!(code(&out), 2, "{args:?}: {}", text(&out.stderr));
        assert!(text(&out.stderr).contains("file"), "{args:?} does not say where: {}", text(&out.stderr));
        let left: Vec<_> = std::fs::read_dir(&at).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left, ["file"], "{args:?} left something behind");
    }
    assert_eq!(std::fs::read_to_string(at.join("file")).unwrap(), "in the way");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let full = std::fs::File::options().write(true).open("/dev/full").expect("a full device");
    let out = program(&["check", &woven("plain-window"), "--json"], support::root())
        .stdout(full)
        .output()
        .expect("starts");
    assert_eq!(code(&out), 2, "{}", text(&out.stderr));
}

#[test]
fn words_for_people_carry_no_colour_into_a_pipe() {
    for no_color in [false, true] {
        let mut command = program(&["check", &woven("plain-window")], support::root());
        if no_color {
            command.env("NO_COLOR", "1");
        }
        let out = command.output().expect("starts");
        assert_eq!(code(&out), 0);
        assert!(!out.stdout.contains(&0x1b) && !out.stderr.contains(&0x1b), "{}", text(&out.stdout));
        assert!(text(&out.stdout).to_lowercase().contains("locked"));
    }
}

#[test]
fn quiet_leaves_the_answer_alone() {
    let out = ran(&["fab", &woven("plain-window"), "--json", "--quiet", "--out", "parts"], &room("quiet"));
    assert!(out.stderr.is_empty(), "{}", text(&out.stderr));
    assert!(json(&out).is_object());
}

#[test]
fn threads_change_no_byte() {
    let at = room("threads");
    for (verb, name) in [("check", "twill-shifted"), ("plan", "plain-unit"), ("check", "plain-doubled")] {
        let with = |threads: &str| {
            let mut command = program(&[verb, &woven(name), "--json"], &at);
            command.env("RAYON_NUM_THREADS", threads).output().expect("starts").stdout
        };
        let (one, two) = (with("1"), with("2"));
        assert!(!one.is_empty() && one == two, "{verb} {name} depends on the threads");
        assert!(one == ran(&[verb, &woven(name), "--json", "--threads", "3"], &at).stdout, "{verb} {name}");
    }
}

#[test]
fn without_arguments_the_example_goes_through_everything() {
    let at = room("example");
    let out = ran(&[], &at);
    assert_eq!(code(&out), 0, "{}", text(&out.stderr));
    let said = text(&out.stdout).to_lowercase();
    assert!(said.contains("locked") && said.contains("flexible"), "{said}");
    let check = at.join("out/check.json").display().to_string();
    let verified = ran(&["verify", &check, "--json"], &at);
    assert_eq!(code(&verified), 0, "{}{}", text(&verified.stdout), text(&verified.stderr));
}
