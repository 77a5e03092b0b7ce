//! Some of the made assemblies as files that anyone can open: each is answered as it says, its twin otherwise.
//!
//! To write them anew set `WEAVELOCK_MADE` to the folder and run `kept_specs_are_those_of_the_generator`; the last digits of
//! meshes may differ from machine to machine, so only the specs are compared.

use super::files::{Format, Made, Put, write};
use super::made;
use super::noisy::{Folder, joined, judged};
use super::{expected, root};
use std::path::PathBuf;

fn folder() -> PathBuf {
    root().join("fixtures/assemblies/made")
}

/// Pairs, with the format in which they are kept and why they are telling.
fn pairs() -> Vec<([Made; 2], Format, &'static str)> {
    let both = |f: &dyn Fn(bool) -> Made| [f(true), f(false)];
    vec![
        (both(&made::dovetail), Format::StlBinary, "A dovetail turned and rounded to single precision."),
        (
            both(&|o| made::staves(5, o)),
            Format::StlText,
            "A core among five staves: no pair knows the way out alone.",
        ),
        (
            both(&made::slanted_sliders),
            Format::ThreeMf,
            "Two sliders that move only together, at right angles.",
        ),
        (both(&made::iris), Format::Obj(5), "Three blades that move only all at once, in three directions."),
        (
            both(&|d| made::wedge(1e-3, d)),
            Format::Obj(6),
            "A wedge of a milliradian, with its draft and against it.",
        ),
        (
            both(&|o| made::leaning_blocks(4, 4, o)),
            Format::ObjSignificant(6),
            "Blocks whose sides lean by turns.",
        ),
    ]
}

#[test]
fn kept_specs_are_those_of_the_generator() {
    let own = Folder::new("kept");
    let into = std::env::var_os("WEAVELOCK_MADE").map_or_else(|| own.0.clone(), PathBuf::from);
    for (twins, format, why) in pairs() {
        for (k, m) in twins.iter().enumerate() {
            let put = Put::turned([1., 2., -0.5], 1.234, format);
            let path = write(m, put, "0.001 mm", &into);
            let [translation, rigid] = m.want;
            let head = format!(
                "# {why}\n# expect: translation = {translation}, rigid = {rigid}\n# twin: {}\n\n",
                twins[1 - k].name
            );
            let spec = head + &std::fs::read_to_string(&path).expect("a spec");
            std::fs::write(&path, &spec).expect("a spec");
            let kept = folder().join(path.file_name().expect("a name"));
            assert_eq!(std::fs::read_to_string(kept).expect("a kept spec"), spec, "{}", m.name);
        }
    }
}

#[test]
fn made_fixtures_are_answered_as_they_say_and_their_twins_otherwise() {
    let files = std::fs::read_dir(folder())
        .expect("the folder of made fixtures")
        .map(|e| e.expect("an entry").path());
    let mut specs: Vec<PathBuf> = files.filter(|p| p.extension().is_some_and(|e| e == "toml")).collect();
    specs.sort();
    assert!(specs.len() >= 12, "{}", specs.len());
    for path in specs {
        let want = expected(&std::fs::read_to_string(&path).expect("text"));
        let twin = folder().join(format!("{}.toml", want.twin));
        let other = expected(&std::fs::read_to_string(&twin).expect("its twin"));
        let opposite = want.verdict.iter().zip(&other.verdict).all(|(w, o)| w != o && o != "undecided");
        assert!(opposite, "{} and its twin do not say the opposite", path.display());
        let j = joined(&path).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(judged(&j, None), want.verdict[..], "{}", path.display());
    }
}

#[test]
fn the_program_says_what_it_assumed_of_rounded_normals_and_its_answer_is_verified() {
    let program = |args: &[&std::ffi::OsStr]| {
        std::process::Command::new(env!("CARGO_BIN_EXE_weavelock")).args(args).output().expect("the program")
    };
    for (name, exit) in [("dovetail-slides", 1), ("dovetail-between-stops", 0)] {
        let spec = folder().join(format!("{name}.toml"));
        let out = program(&["check".as_ref(), spec.as_os_str(), "--json".as_ref()]);
        assert_eq!(out.status.code(), Some(exit), "{name}");
        let remarks = String::from_utf8_lossy(&out.stderr);
        assert!(remarks.contains("contact normals were taken as"), "{remarks}");
        let answer = std::env::temp_dir().join(format!("weavelock-{name}-{}.json", std::process::id()));
        std::fs::write(&answer, &out.stdout).expect("a file");
        let verified = program(&["verify".as_ref(), answer.as_os_str()]);
        std::fs::remove_file(&answer).ok();
        assert_eq!(verified.status.code(), Some(0), "{}", String::from_utf8_lossy(&verified.stdout));
    }
}
