//! A fabricator's package as it lies on the disk: whole or not there, never over something unasked, readable by others.

#[path = "package/shared.rs"]
mod shared;
#[path = "package/workshop.rs"]
mod workshop;

use crate::support;
use glam::DVec3;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use weavelock_fab::check::{Outcome, slicer};
use weavelock_fab::mesh::Closure;
use weavelock_fab::threemf;

fn room(name: &str) -> PathBuf {
    support::room("package", name)
}

fn plain() -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/specs/plain-2x2.toml").display().to_string()
}

fn ran(args: &[&str], at: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_weavelock")).args(args).current_dir(at).output().expect("starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn said(out: &Output) -> String {
    format!("{}{}", text(&out.stdout), text(&out.stderr))
}

/// All files below a folder by name.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let (mut found, mut todo) = (BTreeMap::new(), vec![folder.to_path_buf()]);
    while let Some(dir) = todo.pop() {
        for path in fs::read_dir(&dir).expect("a folder").map(|e| e.expect("an entry").path()) {
            match path.is_dir() {
                true => todo.push(path),
                false => {
                    let name = path.strip_prefix(folder).expect("below").display().to_string();
                    found.insert(name, fs::read(&path).expect("readable"));
                }
            }
        }
    }
    found
}

/// What stands beside, hidden or not.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .map(|e| e.expect("an entry").file_name().display().to_string())
        .collect();
    names.sort();
    names
}

#[test]
fn a_package_holds_what_a_fabricator_needs_and_lists_it() {
    let at = room("whole");
    let out = ran(&["fab", &plain(), "--out", "p", "--json", "--quiet"], &at);
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    let answer: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let all = files(&at.join("p"));
    for name in [
        "README.md",
        "1-coupon.md",
        "2-print.md",
        "ledger.md",
        "checked.md",
        "bill-of-materials.md",
        "package.json",
        "assembly.mm.3mf",
        "print/fdm-pla-plate-1.mm.3mf",
        "coupon/fdm-pla.mm.3mf",
        "coupon/fdm-pla-gauge.mm.stl",
        "parts/weft-0.mm.stl",
        "parts/weft-0.mm.3mf",
        "parts/weft-0.mm.obj",
        "pictures/assembly.png",
        "pictures/fdm-pla-plate-1.png",
        "pictures/coupon.png",
    ] {
        assert!(all.contains_key(name), "{name} is not in {:?}", all.keys());
    }
    let list: Value = serde_json::from_slice(&all["package.json"]).expect("JSON");
    let listed: Vec<&str> =
        list["files"].as_array().expect("files").iter().filter_map(Value::as_str).collect();
    let there: Vec<&str> = all.keys().map(String::as_str).filter(|n| *n != "package.json").collect();
    assert_eq!(listed, there);
    for part in answer["parts"].as_array().expect("parts") {
        assert!(at.join(part["file"].as_str().expect("a file")).exists(), "{part}");
    }
    let here = at.display().to_string();
    for (name, bytes) in all.iter().filter(|(n, _)| n.ends_with(".md") || n.ends_with(".json")) {
        assert!(!text(bytes).contains(&here), "{name} names this machine");
    }
    assert_eq!(names(&at), ["p"], "nothing is left beside");
}

#[test]
fn the_schema_has_just_the_keys_of_the_answers() {
    let at = room("schema");
    let run = |args: &[&str]| -> Value { serde_json::from_slice(&ran(args, &at).stdout).expect("JSON") };
    let schema = run(&["schema", "--json"]);
    let keys = |v: &Value| v.as_object().expect("an object").keys().cloned().collect::<Vec<_>>();
    let fab = run(&["fab", &plain(), "--out", "p", "--json"]);
    assert_eq!(keys(&schema["fab"]["properties"]), keys(&fab));
    for (name, list) in
        [("PartAnswer", "parts"), ("GapAnswer", "gaps"), ("PlateAnswer", "plates"), ("RouteAnswer", "routes")]
    {
        assert_eq!(keys(&schema["fab"]["$defs"][name]["properties"]), keys(&fab[list][0]), "{name}");
    }
    assert_eq!(keys(&schema["processes"]["properties"]), keys(&run(&["processes", "--json"])));
}

#[test]
fn plates_hold_every_part_on_the_bed_in_the_positive_octant_without_double_vertices() {
    let at = room("plates");
    let out = ran(&["fab", &plain(), "--out", "p", "--json", "--bed", "90 x 100 x 60 mm"], &at);
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    let answer: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let plates = answer["plates"].as_array().expect("plates");
    assert!(plates.len() > 1, "four tiles do not lie on one bed of 90 x 100");
    let stands: usize = plates.iter().map(|p| p["stands"].as_array().expect("stands").len()).sum();
    assert_eq!(stands, 4);
    for plate in plates {
        let name = at.join("p").join(plate["file"].as_str().expect("a name"));
        for mesh in threemf::read(&fs::read(&name).expect("a plate")).expect("readable") {
            assert_eq!(mesh.closure(), Closure::Closed);
            let mut corners: Vec<[u64; 3]> =
                mesh.vertices.iter().map(|v| v.to_array().map(f64::to_bits)).collect();
            corners.sort_unstable();
            corners.dedup();
            assert_eq!(corners.len(), mesh.vertices.len(), "a vertex stands twice");
            let (low, high) = mesh.bounds();
            assert!(low.min_element() >= 0.0 && (high - DVec3::new(90.0, 100.0, 60.0)).max_element() <= 0.0);
        }
        for stand in plate["stands"].as_array().expect("stands") {
            let x = stand["at"].as_array().expect("a place");
            assert!(x.iter().all(|c| c.as_f64().is_some_and(|c| c >= 0.0)), "{stand}");
        }
    }
    let small = ran(&["fab", &plain(), "--out", "q", "--bed", "30 x 30 x 30 mm"], &at);
    assert_eq!(small.status.code(), Some(1));
    assert!(said(&small).contains("it is on no plate") && said(&small).contains("--bed"), "{}", said(&small));
}

#[test]
fn the_slicer_reads_plates_and_assembly_or_is_not_run() {
    let at = room("slicer");
    assert_eq!(ran(&["fab", &plain(), "--out", "p"], &at).status.code(), Some(0));
    for (file, bodies) in [
        ("print/fdm-pla-plate-1.mm.3mf", 4),
        ("assembly.mm.3mf", 4),
        ("coupon/fdm-pla.mm.3mf", 2),
        ("parts/warp-1.mm.3mf", 1),
    ] {
        let check = slicer::bodies("prusa-slicer", "slicer", &at.join("p").join(file), bodies);
        match check.outcome {
            Outcome::NotRun(why) => println!("not run: {why}"),
            outcome => assert_eq!(outcome, Outcome::Passed, "{file}"),
        }
    }
}

#[test]
fn the_same_package_is_the_same_bytes() {
    let at = room("bytes");
    for (out, threads) in [("a", "1"), ("b", "3")] {
        let out = ran(&["fab", &plain(), "--out", out, "--threads", threads, "--part", "weft-0=sla"], &at);
        assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    }
    let (a, b) = (files(&at.join("a")), files(&at.join("b")));
    assert_eq!(a.keys().collect::<Vec<_>>(), b.keys().collect::<Vec<_>>());
    for (name, bytes) in &a {
        assert!(*bytes == b[name], "{name} differs");
    }
}

#[test]
fn what_is_there_is_replaced_only_with_force_and_never_by_half() {
    let at = room("force");
    assert_eq!(ran(&["fab", &plain(), "--out", "p"], &at).status.code(), Some(0));
    let before = files(&at.join("p"));
    fs::write(at.join("p/notes.txt"), "mine").expect("writable");
    let again = ran(&["fab", &plain(), "--out", "p", "--process", "sla"], &at);
    assert_eq!(again.status.code(), Some(2));
    assert!(said(&again).contains("--force") && again.stdout.is_empty(), "{}", said(&again));
    let mut kept = files(&at.join("p"));
    assert_eq!(kept.remove("notes.txt"), Some(b"mine".to_vec()));
    assert!(kept == before, "something was touched");
    let forced = ran(&["fab", &plain(), "--out", "p", "--process", "sla", "--force"], &at);
    assert_eq!(forced.status.code(), Some(0), "{}", said(&forced));
    let after = files(&at.join("p"));
    assert!(after.contains_key("print/sla-plate-1.mm.3mf") && after.contains_key("notes.txt"));
    assert!(!after.contains_key("print/fdm-pla-plate-1.mm.3mf"), "the old package's plate is still there");
    assert_eq!(names(&at), ["p"]);
}

#[test]
fn a_folder_that_can_not_be_leaves_nothing() {
    let at = room("never");
    fs::write(at.join("file"), "x").expect("writable");
    for out in ["file", "file/p", "/proc/p"] {
        let out = ran(&["fab", &plain(), "--out", out], &at);
        assert_eq!(out.status.code(), Some(2), "{}", said(&out));
        assert!(said(&out).contains("hint"), "{}", said(&out));
    }
    assert_eq!(
        (names(&at), fs::read(at.join("file")).expect("still there")),
        (vec!["file".to_string()], b"x".to_vec())
    );
}

#[test]
fn what_is_asked_wrongly_is_refused_all_at_once_and_writes_nothing() {
    let at = room("wrong");
    let bad = [
        (vec!["--process", "fdm-plaa"], vec!["fdm-plaa", "known are", "fdm-pla"]),
        (vec!["--process", "absent.toml", "--part", "weft-0=nope"], vec!["absent.toml", "nope"]),
        (
            vec!["--part", "weft-7=sla"],
            vec!["weft-7", "weft-0, weft-1, warp-0"].into_iter().take(1).collect(),
        ),
        (vec!["--part", "weft-0"], vec!["--part weft-0=silicone-platinum"]),
        (vec!["--measured", "print=40"], vec!["33.3"]),
        (vec!["--measured", "wax=59"], vec!["\"wax\"", "print"]),
        (vec!["--bed", "table"], vec!["no bed", "prusa-mk4"]),
        (vec!["--flatten", "9 mm"], vec!["flatten of 9 mm"]),
        (vec!["--clearance", "0.2"], vec!["with its unit"]),
    ];
    for (more, words) in bad {
        let out = ran(&[&["fab", &plain(), "--out", "p"][..], &more].concat(), &at);
        assert_eq!(out.status.code(), Some(2), "{more:?}: {}", said(&out));
        for word in words {
            assert!(said(&out).contains(word), "{more:?}: {word} is not in {}", said(&out));
        }
        assert!(names(&at).is_empty(), "{more:?} left {:?}", names(&at));
    }
}

#[test]
fn a_process_is_printed_copied_edited_and_used() {
    let at = room("copied");
    let file = ran(&["processes", "fdm-pla"], &at);
    assert_eq!(file.status.code(), Some(0));
    let mine = text(&file.stdout).replace("name = \"fdm-pla\"", "name = \"my-pla\"").replacen(
        "value = 0.20",
        "value = 0.30",
        1,
    );
    fs::write(at.join("my.toml"), mine).expect("writable");
    let out = ran(&["fab", &plain(), "--process", "my.toml", "--out", "p", "--json"], &at);
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    let answer: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    assert_eq!((&answer["process"], &answer["fit_mm"]), (&"my-pla".into(), &0.6.into()));
    let list = ran(&["processes", "--json"], &at);
    let list: Value = serde_json::from_slice(&list.stdout).expect("JSON");
    assert!(list["processes"].as_array().is_some_and(|p| p.len() >= 10));
    assert_eq!(ran(&["processes", "nope"], &at).status.code(), Some(2));
}

#[test]
fn the_spec_names_processes_of_single_parts_and_they_are_read_beside_it() {
    let at = room("parts");
    let own = text(&ran(&["processes", "sla"], &at).stdout).replace("name = \"sla\"", "name = \"my-sla\"");
    fs::create_dir(at.join("specs")).expect("a folder");
    fs::write(at.join("specs/own.toml"), own).expect("writable");
    let spec = fs::read_to_string(plain()).expect("readable");
    let more = "bed = \"ender-3\"\nelephant_foot = \"0.2 mm\"\n[fab.parts]\n\"weft-0\" = \"own.toml\"\n";
    fs::write(at.join("specs/s.toml"), format!("{}\n{more}", spec.trim_end())).expect("writable");
    let out = ran(&["fab", "specs/s.toml", "--out", "p", "--json"], &at);
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    let answer: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let of = |id: &str| {
        answer["parts"].as_array().unwrap().iter().find(|p| p["id"] == id).unwrap()["process"].clone()
    };
    assert_eq!((of("weft-0"), of("weft-1")), ("my-sla".into(), "fdm-pla".into()));
    assert!(answer["plates"].as_array().unwrap().iter().all(|p| p["bed"] == "ender-3"));
}

#[test]
fn the_bill_holds_what_a_mold_takes() {
    let at = room("bill");
    let out = ran(&["fab", &plain(), "--part", "weft-0=silicone-platinum", "--out", "p", "--json"], &at);
    assert_eq!(out.status.code(), Some(0), "{}", said(&out));
    let answer: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let lines = answer["bill"]["lines"].as_array().expect("lines");
    let halves: Vec<&Value> = lines
        .iter()
        .filter(|l| l["what"].as_str().is_some_and(|w| w.starts_with("printed mold half")))
        .collect();
    assert_eq!(halves.len(), 2, "{lines:?}");
    assert!(halves.iter().all(|l| l["mass_g"].as_f64().is_some_and(|g| g > 0.0)));
    let sheet = fs::read_to_string(at.join("p/3-molds.md")).expect("a mold sheet");
    let all = ["keys fit one way only (cones of 8 mm", "opened.png", "than the 2 degrees that are asked for"];
    assert!(all.iter().all(|words| sheet.contains(words)), "{sheet}");
}

#[test]
#[ignore = "half a minute"]
fn corners_that_no_split_helps_are_given_up_and_told() {
    let at = room("burr");
    let burr = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/assemblies/burr.toml");
    let out = ran(&["fab", &burr.display().to_string(), "--out", "p", "--json"], &at);
    assert!(matches!(out.status.code(), Some(0 | 1)), "{}", said(&out));
    let answer: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let parts = answer["parts"].as_array().expect("parts");
    assert_eq!(parts.len(), 5);
    let findings = answer["findings"].as_array().expect("findings");
    let told = |id: &Value| {
        findings
            .iter()
            .any(|f| f["severity"] == "error" && f["place"]["parts"].as_array().unwrap().contains(id))
    };
    assert!(parts.iter().all(|p| !p["file"].is_null() || told(&p["id"])), "{findings:?}");
}

/// Prints of molds lie on plates of their own, on the bed, apart from masters; what is larger than the bed is told.
#[test]
fn mold_prints_stand_on_plates_of_their_own() {
    let at = room("mold-plates");
    let make = |out: &str, more: &[&str]| {
        let args =
            [&["fab", &plain(), "--part", "weft-0=silicone-platinum", "--json", "-q", "--out", out], more];
        ran(&args.concat(), &at)
    };
    let out = make("p", &[]);
    let answer: Value = serde_json::from_slice(&out.stdout).expect("JSON");
    let plates = answer["plates"].as_array().expect("plates");
    let molds = plates.iter().find(|p| p["file"] == "print/silicone-platinum-molds-plate-1.mm.3mf");
    let stands = molds.expect("a plate of molds")["stands"].as_array().expect("stands").len();
    let printed = answer["molds"].as_array().expect("molds").len();
    assert_eq!(stands, printed, "{}", said(&out));
    let file = fs::read(at.join("p/print/silicone-platinum-molds-plate-1.mm.3mf")).expect("a plate");
    for mesh in threemf::read(&file).expect("readable") {
        assert!(mesh.closure() == Closure::Closed && mesh.bounds().0.min_element() >= 0.0);
    }
    assert!(at.join("p/pictures/silicone-platinum-molds-plate-1.png").exists());
    let small = make("small", &["--bed", "70 x 70 x 60 mm"]);
    assert!(said(&small).contains("cast a shorter part"), "{}", said(&small));
}

/// A run that is killed leaves a hidden folder; the next one clears it.
#[cfg(unix)]
#[test]
fn what_a_killed_run_leaves_is_cleared_by_the_next() {
    let at = room("killed");
    let mut run = Command::new(env!("CARGO_BIN_EXE_weavelock"))
        .args(["fab", &plain(), "--process", "wax-injected", "-q", "--out", "out"])
        .current_dir(&at)
        .stdout(std::process::Stdio::null())
        .spawn()
        .expect("starts");
    let hidden = || names(&at).into_iter().any(|n| n.ends_with(".part"));
    for _ in 0..3000 {
        if hidden() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let _ = run.kill();
    let _ = run.wait();
    if !hidden() {
        eprintln!("not run: the package was done before it could be killed");
        return;
    }
    let out = ran(&["fab", &plain(), "-q", "--out", "other"], &at);
    assert_eq!(names(&at), ["other"], "{}", said(&out));
}

/// On a full disk nothing is left half written. Needs the right to mount.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_nothing_half_written() {
    let at = room("full");
    let mounted = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=300k", "tmpfs"])
        .arg(&at)
        .output()
        .is_ok_and(|o| o.status.success());
    if !mounted {
        eprintln!("not run: no right to mount a small disk");
        return;
    }
    let fab = ran(&["fab", &plain(), "-q", "--out", "out"], &at);
    let left = names(&at);
    let run = ran(&["run", &plain(), "-q", "--out", "run"], &at);
    let halves = files(&at).into_keys().filter(|n| n.contains(".part") || n.contains(".lock")).count();
    let unmounted = Command::new("umount").arg(&at).status().is_ok_and(|s| s.success());
    assert!(unmounted, "{} stays mounted", at.display());
    assert!(fab.status.code() == Some(2) && said(&fab).contains("disk is full"), "{}", said(&fab));
    assert!(left.is_empty(), "{left:?}");
    assert!(run.status.code() == Some(2) && halves == 0, "{}", said(&run));
}
