//! Puzzle files: read, filled, taken apart on their lattice, with the levels that others state; bad files.
//!
//! Six-piece burrs by their numbers (one more than the sum of the bits of the cubes taken away; Cutler, *A Computer
//! Analysis of All 6-Piece Burrs*; von Kanel, IBM Research, *Burr puzzles*), with published levels.

mod brute;
mod groups;
mod maze;

use crate::support;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::Value;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use weavelock::assembly::voxel;
use weavelock::contact::join;
use weavelock::sequence::lattice::on_lattice;
use weavelock::spec::puzzle::{Choice, Puzzle, parse, text::text, turn};
use weavelock::spec::{Spec, Subject};

/// A piece of a six-piece burr, `length` long: voxels along x, then y, then z.
fn piece(number: u32, length: usize) -> String {
    let over = (length - 6) / 2;
    let bit = |x: usize, y: usize, z: usize| match (x.checked_sub(over), z) {
        (Some(x @ 1..=4), 1) => Some(x - 1 + 4 * y),
        (Some(x @ 2..=3), 0) => Some(8 + x - 2 + 2 * y),
        _ => None,
    };
    let gone = |k: usize| (number - 1) >> k & 1 == 1;
    let at = |k: usize| bit(k % length, k / length % 2, k / length / 2);
    (0..4 * length).map(|k| if at(k).is_some_and(gone) { '_' } else { '#' }).collect()
}

/// The cross that six pieces make: what one stick alone reaches must be filled, where sticks meet holes may stay.
fn cross(length: usize) -> String {
    let over = (length - 6) / 2;
    let within = |v: usize, from: usize| (over + from..over + from + 2).contains(&v);
    let stick = |y: usize, z: usize| within(y, 2) && (within(z, 1) || within(z, 3));
    let at = |k: usize| (k % length, k / length % length, k / length / length);
    let sticks = |k: usize| {
        let (x, y, z) = at(k);
        [stick(y, z), stick(z, x), stick(x, y)].iter().filter(|s| **s).count()
    };
    (0..length.pow(3)).map(|k| ['_', '#', '+', '+'][sticks(k)]).collect()
}

fn burr(numbers: [u32; 6], length: usize) -> String {
    let mut kinds = numbers.to_vec();
    kinds.dedup();
    let mut out = String::from("<puzzle version=\"2\"><gridType type=\"0\"/><colors/><shapes>");
    for &n in &kinds {
        let _ = write!(
            out,
            "<voxel x=\"{length}\" y=\"2\" z=\"2\" name=\"p{n}\" type=\"0\">{}</voxel>",
            piece(n, length)
        );
    }
    let _ = write!(
        out,
        "<voxel x=\"{length}\" y=\"{length}\" z=\"{length}\" type=\"0\">{}</voxel>",
        cross(length)
    );
    out += "</shapes><problems><problem><shapes>";
    for (k, n) in kinds.iter().enumerate() {
        let count = numbers.iter().filter(|m| *m == n).count();
        let _ = write!(out, "<shape id=\"{k}\" count=\"{count}\"/>");
    }
    let _ = write!(out, "</shapes><result id=\"{}\"/><bitmap/></problem></problems></puzzle>", kinds.len());
    out
}

fn read(text: &str) -> Result<Spec, String> {
    parse(text, Path::new("test.xmpuzzle"), Choice::default()).map_err(|f| f.to_string())
}

fn puzzle(text: &str) -> Puzzle {
    let spec = read(text).unwrap_or_else(|f| panic!("{f}"));
    let Subject::Meshes(meshes) = spec.subject else { panic!("a puzzle's parts are solids") };
    *meshes.puzzle.expect("a puzzle")
}

fn room(name: &str) -> PathBuf {
    support::room("puzzle", name)
}

/// Exit code, stdout and stderr.
fn ran(args: &[&str], at: &Path) -> (i32, String, String) {
    let out =
        Command::new(env!("CARGO_BIN_EXE_weavelock")).args(args).current_dir(at).output().expect("it starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    (out.status.code().expect("no signal"), text(out.stdout), text(out.stderr))
}

fn planned(text: &str, name: &str) -> (i32, Value) {
    let at = room(name);
    std::fs::write(at.join("p.xmpuzzle"), text).expect("written");
    let (code, out, err) = ran(&["plan", "p.xmpuzzle", "--json"], &at);
    let json = serde_json::from_str(&out).unwrap_or_else(|e| panic!("{e}: {err}"));
    std::fs::write(at.join("plan.json"), out).expect("written");
    let (verified, out, err) = ran(&["verify", "plan.json"], &at);
    assert_eq!(verified, 0, "{name}: {out}{err}");
    (code, json)
}

#[test]
fn published_levels_are_found_again() {
    // Piece numbers from the sets on Rob's puzzle page (robspuzzlepage.com/interlocking.htm).
    let known = [
        // Philippe Dubois: level 6.4 (puzzleworld.org, "six_piece_burr").
        ("dubois", burr([120, 160, 256, 512, 880, 960], 6), "6.4"),
        // Peter Marineau's Piston Puzzle: 9.3 (smallpuzzlecollection.blogspot.com, 2011-10-25).
        ("piston", burr([88, 512, 768, 922, 1008, 1008], 6), "9.3"),
        // Bill Cutler's Computer's Choice Unique 10: ten moves, eight long (puzzlemad.co.uk, 2011-03-18).
        ("unique-10", burr([624, 702, 768, 883, 1015, 1024], 8), "10"),
        // Artifactory 5/4: its name.
        ("artifactory", burr([412, 480, 512, 704, 704, 960], 6), "5.4"),
        // A key slides out of the Chinese cross at once.
        ("chinese-cross", burr([1, 256, 824, 975, 928, 1024], 6), "1"),
    ];
    for (name, text, level) in known {
        let (code, plan) = planned(&text, name);
        assert_eq!((code, plan["outcome"].as_str()), (0, Some("assembled")), "{name}");
        assert_eq!(plan["level"], level, "{name}");
        assert_eq!(plan["fewest"], "proven", "{name}");
        assert_eq!(plan["moves"].as_u64(), plan["steps"].as_array().map(|s| s.len() as u64), "{name}");
        let first = level.split('.').next().expect("a number").parse::<usize>().expect("digits");
        let inside =
            plan["steps"].as_array().expect("steps").iter().take_while(|s| s["ends"] == "inside").count();
        assert_eq!(inside + 1, first, "{name}: moves until the first parting");
    }
}

/// Bruce Love's Dozen: the one assembly of a six-piece burr with level 12 (Cutler's analysis: none has more).
#[test]
fn one_way_to_put_loves_dozen_together_takes_twelve_moves() {
    let puzzle = puzzle(&burr([88, 512, 704, 960, 992, 1008], 6));
    let mut levels = Vec::new();
    let end = voxel::cover::assemblies(&puzzle, 1_000_000_000, |solution| {
        let asm = voxel::assembly("love", &puzzle, &solution, 1.0).expect("it fits");
        let parts: Vec<_> = asm.ids().collect();
        let found = on_lattice(&asm, &parts, Some(1.0), |_| 1, None).expect("on a lattice");
        levels.extend(found.apart.whole.level().map(|l| l[0]));
        std::ops::ControlFlow::Continue(())
    });
    assert_eq!(end, voxel::cover::Covered::All);
    assert_eq!(levels.iter().filter(|l| **l == 12).count(), 1);
    assert_eq!(levels.iter().max(), Some(&12));
}

/// Counted by brute force over six places and eight turns of each piece, twelve turns of the whole counting as one.
#[test]
fn all_ways_to_fill_a_burr_are_found_once() {
    let counts = [
        ([624, 702, 768, 883, 1015, 1024], 7),
        ([120, 160, 256, 512, 880, 960], 2),
        ([463, 564, 760, 909, 927, 1016], 1),
    ];
    for (numbers, expected) in counts {
        let (puzzle, mut count) = (puzzle(&burr(numbers, 6)), 0);
        voxel::cover::assemblies(&puzzle, 1_000_000_000, |solution| {
            assert!(voxel::placed(&puzzle, &solution).is_ok());
            count += 1;
            std::ops::ControlFlow::Continue(())
        });
        assert_eq!(count, expected, "{numbers:?}");
    }
}

/// A piece without symmetry, turned each way about a hot spot, against voxels turned by quarter turns one by one.
#[test]
fn every_turn_sets_a_piece_down_where_it_belongs() {
    let drawn = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [0, 1, 1]];
    let hot = [1, 0, 1];
    let quarter = |v: [i32; 3], axis: char| match axis {
        'x' => [v[0], -v[2], v[1]],
        'y' => [-v[2], v[1], v[0]],
        _ => [-v[1], v[0], v[2]],
    };
    let times = |v: [i32; 3], axis: char, n: usize| (0..n).fold(v, |v, _| quarter(v, axis));
    for k in 0..24 {
        let outer = [('y', 0), ('y', 1), ('y', 2), ('y', 3), ('z', 1), ('z', 3)][k / 4];
        let turned = |v: [i32; 3]| times(times(v, 'x', k % 4), outer.0, outer.1);
        let goal: Vec<[i32; 3]> =
            drawn.iter().map(|v| turned(std::array::from_fn(|a| v[a] - hot[a])).map(|x| x + 4)).collect();
        let draw = |all: &[[i32; 3]], size: [i32; 3]| -> String {
            let at = |k: i32| [k % size[0], k / size[0] % size[1], k / size[0] / size[1]];
            (0..size.iter().product()).map(|k| if all.contains(&at(k)) { '#' } else { '_' }).collect()
        };
        let file = |turn: usize| {
            format!(
                "<puzzle><shapes><voxel x=\"3\" y=\"2\" z=\"2\" hx=\"1\" hz=\"1\" type=\"0\">{}</voxel>\
                 <voxel x=\"9\" y=\"9\" z=\"9\" type=\"0\">{}</voxel></shapes><problems><problem><shapes><shape id=\"0\"/>\
                 </shapes><result id=\"1\"/><solutions><solution><assembly>4 4 4 {turn}</assembly></solution></solutions>\
                 </problem></problems></puzzle>",
                draw(&drawn, [3, 2, 2]),
                draw(&goal, [9, 9, 9])
            )
        };
        let spec = read(&file(k)).expect("a file");
        let joined = join(&spec).unwrap_or_else(|f| panic!("turn {k}: {f}"));
        assert_eq!(joined.assembly.solids[0].volume(), 5.0);
        let part = joined.assembly.ids().next().expect("one part");
        let middles = joined
            .assembly
            .cells(part)
            .into_iter()
            .map(|c| c.vertices.iter().map(|v| v.min_element()).fold(f64::INFINITY, f64::min));
        let least = goal.iter().flatten().copied().min().map(f64::from);
        assert_eq!(middles.reduce(f64::min), least, "turn {k}: the solid lies where its voxels do");
        assert!(
            join(&read(&file((k + 1) % 24)).expect("a file")).is_err(),
            "another turn than {k} does not fill it"
        );
        assert!(join(&read(&file(k + 24)).expect("a file")).is_err(), "no turn makes its mirror image of it");
    }
    assert_eq!(turn::matrix(0), [[1, 0, 0], [0, 1, 0], [0, 0, 1]]);
}

#[test]
fn a_puzzle_written_and_read_again_is_the_same() {
    let file = "<puzzle><colors><color/><color/></colors><shapes><voxel x=\"2\" y=\"1\" z=\"1\" weight=\"3\" name=\"a &amp; b\" \
        type=\"0\">#1#</voxel><voxel x=\"2\" y=\"2\" z=\"1\" hy=\"1\" type=\"0\">#2#++12</voxel></shapes><problems><problem/>\
        <problem name=\"two\" maxHoles=\"2\"><shapes><shape id=\"0\" min=\"1\" max=\"2\"><group group=\"4\" count=\"1\"/></shape>\
        </shapes><result id=\"1\"/><bitmap><pair piece=\"0\" result=\"1\"/></bitmap><solutions><solution><assembly>0 0 0 0 x\
        </assembly><separationInfo>4 3 0 0 2 0 0</separationInfo></solution></solutions></problem></problems></puzzle>";
    let once = puzzle(file);
    assert_eq!((once.number, once.chosen), ((2, 2), (1, 1)));
    let stated = once.solution.as_ref().and_then(|s| s.level.clone());
    assert_eq!(stated, Some(vec![3, 2]), "one move at a time is left out");
    let mut twice = puzzle(&text(&once, 10.0));
    (twice.number, twice.chosen) = (once.number, once.chosen);
    let (Some(a), Some(b)) = (&once.solution, &mut twice.solution) else { panic!("a solution") };
    b.level.clone_from(&a.level);
    assert_eq!(once, twice);
    let Subject::Meshes(m) = read(&text(&once, 12.5)).expect("a file").subject else { panic!("solids") };
    assert_eq!(m.mm_per_unit, 12.5);
}

#[test]
fn what_does_not_come_apart_is_told_with_what_was_exhausted() {
    // With longer sticks no way to put these together comes apart; one of Artifactory's is locked to first order.
    let (code, plan) = planned(&burr([120, 160, 256, 512, 880, 960], 8), "dubois-8");
    assert_eq!((code, plan["outcome"].as_str()), (1, Some("not-found")));
    assert_eq!(plan["kept"][0]["looked_at"], "all-positions");
    assert_eq!(plan["level"], Value::Null);
    let (code, plan) = planned(&burr([412, 480, 512, 704, 704, 960], 8), "artifactory-8");
    assert_eq!((code, plan["outcome"].as_str()), (1, Some("needs-flexible")));
    assert!(plan["stuck"][0]["lock"].is_object());
}

/// Three cubes in a closed box of two by two by two: 8 x 7 x 6 positions, none of which lets one out.
#[test]
fn every_position_is_found_once() {
    let draw = |inside: char| -> String {
        let at = |k: usize| [k % 4, k / 4 % 4, k / 16];
        (0..64).map(|k| if at(k).iter().all(|v| (1..3).contains(v)) { inside } else { '#' }).collect()
    };
    let file = format!(
        "<puzzle><shapes><voxel x=\"4\" y=\"4\" z=\"4\" type=\"0\">{}</voxel><voxel x=\"1\" y=\"1\" z=\"1\" type=\"0\">#\
         </voxel><voxel x=\"4\" y=\"4\" z=\"4\" type=\"0\">{}</voxel></shapes><problems><problem><shapes><shape id=\"0\"/>\
         <shape id=\"1\" count=\"3\"/></shapes><result id=\"2\"/><solutions><solution><assembly>0 0 0 0 1 1 1 0 2 1 1 0 1 2 1 0\
         </assembly></solution></solutions></problem></problems></puzzle>",
        draw('_'),
        draw('+')
    );
    let (code, plan) = planned(&file, "box");
    assert_eq!((code, plan["positions"].as_u64()), (1, Some(8 * 7 * 6)));
    assert_eq!(plan["kept"][0]["looked_at"], "all-positions");
}

#[test]
fn a_changed_plan_is_refused_and_threads_change_no_byte() {
    let at = room("changed");
    std::fs::write(at.join("p.xmpuzzle"), burr([88, 512, 768, 922, 1008, 1008], 6)).expect("written");
    let [one, four] = ["1", "4"].map(|n| ran(&["plan", "p.xmpuzzle", "--json", "--threads", n], &at).1);
    assert_eq!(one, four);
    let good: weavelock::report::answer::PlanAnswer = serde_json::from_str(&one).expect("an answer");
    let refused = |change: &dyn Fn(&mut Value), what: &str| {
        let mut json: Value = serde_json::to_value(&good).expect("JSON");
        change(&mut json);
        let mut answer: weavelock::report::answer::PlanAnswer =
            serde_json::from_value(json).expect("an answer");
        answer.checksum.clear();
        answer.checksum = weavelock::report::answer::checksum(&answer);
        std::fs::write(at.join("a.json"), serde_json::to_string(&answer).expect("JSON")).expect("written");
        let (code, out, _) = ran(&["verify", "a.json"], &at);
        assert_eq!(code, 1, "{what}: {out}");
    };
    refused(&|p| p["level"] = "9.2".into(), "another level");
    refused(&|p| p["moves"] = 14.into(), "another number of moves");
    for k in 0..good.plan.steps.len() {
        refused(
            &|p| {
                let step = &mut p["steps"][k];
                let turned: Vec<f64> = step["direction"]
                    .as_array()
                    .expect("three")
                    .iter()
                    .map(|x| -x.as_f64().expect("a number"))
                    .collect();
                step["direction"] = turned.into();
            },
            &format!("step {k} the other way"),
        );
    }
}

#[test]
fn bad_files_are_told_with_their_place_and_leave_nothing() {
    let at = room("bad");
    let good = burr([1, 256, 824, 975, 928, 1024], 6);
    let packed = |text: &[u8]| {
        let mut out = GzEncoder::new(Vec::new(), Compression::best());
        out.write_all(text).and_then(|()| out.finish()).expect("packed")
    };
    let whole = packed(good.as_bytes());
    let solved = |words: &str| {
        good.replace(
            "<bitmap/>",
            &format!("<bitmap/><solutions><solution><assembly>{words}</assembly></solution></solutions>"),
        )
    };
    let rows: Vec<(&str, Vec<u8>, &str)> = vec![
        ("cut gzip", whole[..whole.len() / 2].to_vec(), "no whole gzip file"),
        ("a bomb", packed(&vec![b' '; 80 << 20]), "unpacks to more than"),
        ("cut XML", good.as_bytes()[..500].to_vec(), "ends inside <"),
        (
            "another grid",
            good.replace("gridType type=\"0\"", "gridType type=\"1\"").into(),
            "triangular prisms",
        ),
        ("absurd size", good.replace("x=\"6\" y=\"2\"", "x=\"99999999\" y=\"2\"").into(), "99999999"),
        ("too few voxels", good.replace(">####", ">###").into(), "voxels are drawn"),
        ("no such shape", good.replace("result id=\"6\"", "result id=\"66\"").into(), "result.id"),
        ("no problem", good.replace("problem", "question").into(), "no problem"),
        ("no puzzle", b"<svg/>".to_vec(), "<svg>"),
        ("short solution", solved("1 2 3").into(), "placement 1"),
        ("a turn too far", solved("0 0 0 48 x x x x x").into(), "placement 1"),
        ("too few used", solved("0 0 0 0 x x x x x").into(), "pieces of shape 1"),
        ("overlap", solved("0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0").into(), "both fill the voxel"),
        ("variable piece", good.replacen('#', "+", 1).into(), "variable voxels"),
        (
            "nothing fits",
            good.replacen("name=\"p1\"", "name=\"p1\" ", 1)
                .replace("count=\"1\"/><shape id=\"1\"", "count=\"5\"/><shape id=\"1\"")
                .into(),
            "do not fill the result",
        ),
    ];
    for (name, bytes, told) in rows {
        std::fs::write(at.join("p.xmpuzzle"), bytes).expect("written");
        let (code, out, err) = ran(&["plan", "p.xmpuzzle", "--json"], &at);
        assert_eq!((code, out.as_str()), (2, ""), "{name}: {err}");
        assert!(
            err.contains(told) && err.contains("hint:") && !err.contains("fault of weavelock"),
            "{name}: {err}"
        );
    }
    std::fs::write(at.join("p.xmpuzzle"), whole).expect("written");
    assert_eq!(ran(&["plan", "p.xmpuzzle"], &at).0, 0, "packed is as good as plain");
    assert_eq!(ran(&["plan", "p.xmpuzzle", "--problem", "2"], &at).0, 2);
    assert_eq!(ran(&["plan", "p.xmpuzzle", "--solution", "0"], &at).0, 2);
    assert_eq!(ran(&["plan", "p.xmpuzzle", "--unit", "0 mm"], &at).0, 2);
}

#[test]
fn every_verb_takes_a_puzzle() {
    let at = room("verbs");
    // Two voxels of this piece touch along an edge only.
    let pinched = "<puzzle><shapes><voxel x=\"2\" y=\"2\" z=\"2\" type=\"0\">##_##_#_</voxel><voxel x=\"2\" y=\"2\" z=\"2\" \
        type=\"0\">__#__#_#</voxel><voxel x=\"2\" y=\"2\" z=\"2\" type=\"0\">########</voxel></shapes><problems><problem><shapes>\
        <shape id=\"0\"/><shape id=\"1\"/></shapes><result id=\"2\"/><solutions><solution><assembly>0 0 0 0 0 0 0 0</assembly>\
        </solution></solutions></problem></problems></puzzle>";
    std::fs::write(at.join("pinched.xmpuzzle"), pinched).expect("written");
    std::fs::write(at.join("burr.xmpuzzle"), burr([120, 160, 256, 512, 880, 960], 6)).expect("written");
    for file in ["pinched.xmpuzzle", "burr.xmpuzzle"] {
        for verb in [
            &["check"][..],
            &["blocking", "--direction", "1,0,0"],
            &["plan"],
            &["flex"],
            &["chirality"],
            &["export"],
        ] {
            let args = [&verb[..1], &[file, "--json"], &verb[1..]].concat();
            let (code, out, err) = ran(&args, &at);
            assert!(code < 2 && serde_json::from_str::<Value>(&out).is_ok(), "{args:?}: {err}");
        }
    }
    let (code, out, _) =
        ran(&["fab", "burr.xmpuzzle", "--unit", "10 mm", "--process", "fdm-pla", "--out", "pkg"], &at);
    assert!(code < 2 && at.join("pkg").is_dir(), "{out}");
}

/// Parts read from meshes that happen to be boxes on a lattice are planned there where straight moves do not do.
#[test]
fn meshes_on_a_lattice_are_seen() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/assemblies/burr-keyed.toml");
    let asm = join(&weavelock::spec::read(&file).expect("a spec")).unwrap_or_else(|f| panic!("{f}")).assembly;
    let parts: Vec<_> = asm.ids().collect();
    let found = on_lattice(&asm, &parts, None, |_| 1, None).expect("boxes on one lattice");
    assert!(found.apart.states > 0);
    let woven = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/examples/plain-2x2.toml");
    let asm =
        join(&weavelock::spec::read(&woven).expect("a spec")).unwrap_or_else(|f| panic!("{f}")).assembly;
    let parts: Vec<_> = asm.ids().collect();
    assert!(on_lattice(&asm, &parts, None, |_| 1, None).is_err(), "tiles are no boxes");
}
