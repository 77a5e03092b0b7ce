//! Promise of molds: OpenSCAD makes the same solids from the sources, for plain shapes, side cores and woven tiles.
//!
//! Slow: its kernel takes seconds over each half. Where it is not installed, a word is printed and nothing is shown.

use super::piped::{cross, elbow};
use super::whole::lone_spec;
use super::{angle, bobbin, bracket, holed, scratch, spec, wavy, written};
use std::process::Command;
use weavelock_fab::check::Outcome;
use weavelock_fab::files::stl;
use weavelock_fab::mesh::Mesh;
use weavelock_fab::mold::{Kind, Mold, MoldSpec, Route, check_openscad, make};

/// One weft tile of a weave of period `n`, which stands alone: its faces are those that the weave gives, no clearance.
fn lone(abc: &str, n: usize) -> Mesh {
    let dir = scratch(&format!("lone-{n}"));
    std::fs::create_dir_all(&dir).unwrap();
    std::fs::write(dir.join("lone.toml"), lone_spec(abc, n, "fdm-pla")).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_weavelock"));
    let out = program.current_dir(&dir).args(["export", "lone.toml", "--as", "stl", "--out", "out"]).output();
    let file = dir.join("out").join("weft-0.mm.stl");
    let read = std::fs::File::open(&file).and_then(|mut f| stl::read(&mut f));
    let mesh = read.unwrap_or_else(|e| panic!("{e}: {:?}", out.unwrap()));
    std::fs::remove_dir_all(dir).unwrap();
    mesh
}

/// How many pieces OpenSCAD passed; one that it did not pass fails the test, where it is installed.
fn agreed(mold: &Mold) -> usize {
    let (mut report, dir) = written(mold);
    check_openscad(&mut report, &dir, "openscad");
    std::fs::remove_dir_all(dir).unwrap();
    let mut passed = 0;
    for check in report.pieces.iter().flat_map(|p| &p.checks) {
        match &check.outcome {
            Outcome::NotRun(why) if why.contains("not installed") => eprintln!("not run: {why}"),
            other => {
                assert_eq!(*other, Outcome::Passed, "{}: {}", mold.name, check.of);
                passed += 1;
            }
        }
    }
    passed
}

#[test]
#[ignore = "20 s: OpenSCAD"]
fn openscad_makes_the_same_molds_of_plain_shapes() {
    for (name, part, route) in [
        ("scad-wavy", wavy(), Route::Rigid),
        ("scad-holed", holed(), Route::Silicone),
        ("scad-tree", angle(), Route::LostWax),
    ] {
        agreed(&make(&part, &spec(name, route)).unwrap());
    }
}

#[test]
#[ignore = "a minute: side cores are searched, and OpenSCAD makes them"]
fn openscad_makes_the_same_side_cores() {
    for (name, part) in [("scad-bobbin", bobbin()), ("scad-bracket", bracket())] {
        let mold = make(&part, &spec(name, Route::Rigid)).unwrap();
        assert!(mold.pieces.iter().any(|p| p.kind == Kind::Core), "{name}");
        let passed = agreed(&mold);
        assert!(passed == 0 || passed >= 3, "{name}: {passed} pieces");
    }
}

/// Bores that touch each other's ends and walls: their cores' rooms touch themselves, and the source makes each piece all the
/// same.
#[test]
#[ignore = "a minute: side cores are searched, and OpenSCAD makes each piece"]
fn openscad_makes_the_same_pieces_of_molds_whose_cores_touch() {
    for (name, part) in [("scad-cross", cross()), ("scad-elbow", elbow())] {
        let mold = make(&part, &spec(name, Route::Rigid)).unwrap();
        assert!(mold.extras.iter().any(|e| e.name == format!("{name}.scad")), "{name}: {:#?}", mold.findings);
        let passed = agreed(&mold);
        let made = mold.pieces.iter().filter(|p| p.kind.is_made()).count();
        assert!(passed == 0 || passed == made, "{name}: {passed} of {made} pieces");
    }
}

#[test]
#[ignore = "half a minute: OpenSCAD"]
fn openscad_makes_the_same_molds_of_tiles_of_plain_and_twill() {
    for (abc, n) in [("1, 1, 1", 2), ("2, 2, 1", 4)] {
        agreed(&make(&lone(abc, n), &spec(&format!("scad-lone-{n}"), Route::Rigid)).unwrap());
    }
}

#[test]
#[ignore = "half a minute: OpenSCAD"]
fn openscad_makes_the_same_mold_of_a_satin_tile_and_of_a_gang() {
    agreed(&make(&lone("7, 1, 3", 8), &spec("scad-lone-8", Route::Rigid)).unwrap());
    let two = MoldSpec { count: 2, ..spec("scad-gang", Route::Rigid) };
    agreed(&make(&lone("1, 1, 1", 2), &two).unwrap());
}
