//! Promises about files that are wrong: all faults at once, each with its place and a hint, and never a panic.

#[path = "../fuzz/driver.rs"]
mod driver;
#[path = "../fuzz/targets.rs"]
mod targets;

use std::fs;
use std::path::{Path, PathBuf};
use weavelock::assembly::Mobility;
use weavelock::fault::{Faults, Place};
use weavelock::spec::{
    Bounds, Cut, HeldSpec, Layout, Shape, Spec, Subject, Syntax, WovenSpec, parse, piece_ids, read,
};
use weavelock::weave::{Weave, parse_wif};

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

fn good(name: &str) -> Spec {
    read(&fixtures().join("specs").join(name)).unwrap_or_else(|faults| panic!("{faults}"))
}

fn woven(name: &str) -> WovenSpec {
    match good(name).subject {
        Subject::Woven(spec) => spec,
        Subject::Meshes(_) => panic!("{name} is woven"),
    }
}

/// The faults of a file as a person reads them, without the folder it lies in.
fn faults(path: &Path) -> String {
    let wrong = match path.extension().and_then(|end| end.to_str()) {
        Some("toml" | "json") => read(path).err(),
        _ => Weave::read(path).err(),
    };
    let Some(faults) = wrong else { panic!("{} was accepted", path.display()) };
    assert_sound(&faults);
    faults.to_string().replace(&format!("{}/", fixtures().join("bad").display()), "")
}

fn assert_sound(Faults(faults): &Faults) {
    assert!(!faults.is_empty(), "a failure names at least one fault");
    assert!(faults.iter().all(|f| !f.what.is_empty() && !f.hint.is_empty()), "{faults:#?}");
    assert!(faults.is_sorted_by_key(|f| (f.file.clone(), f.place)), "{faults:#?}");
}

/// Every file in `fixtures/bad` is refused in the words of the file beside it. To accept new words, delete the old.
#[test]
fn bad_files_are_refused_in_these_words() {
    let entries = fs::read_dir(fixtures().join("bad")).expect("fixtures/bad is there");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("readable").path()).collect();
    paths.retain(|path| path.extension().is_none_or(|end| end != "faults"));
    paths.sort();
    assert!(paths.len() > 20, "the corpus is there");
    let mut changed = Vec::new();
    for path in paths {
        let golden = path.with_file_name(format!("{}.faults", path.file_name().expect("a name").display()));
        let said = faults(&path) + "\n";
        match fs::read_to_string(&golden) {
            Ok(before) if before == said => {}
            Ok(before) => changed.push(format!("--- {}\n{before}+++\n{said}", golden.display())),
            Err(_) => {
                fs::write(&golden, &said).expect("fixtures/bad is writable");
                changed.push(format!("{} is new: look at it and run again\n{said}", golden.display()));
            }
        }
    }
    assert!(changed.is_empty(), "{}", changed.join("\n"));
}

/// The twins of the bad files: what is right is read, and read as meant.
#[test]
fn good_files_say_what_they_mean() {
    let (toml, json) = (woven("plain-2x2.toml"), woven("plain-2x2.json"));
    assert_eq!((&toml.weave, &toml.profile, &toml.layout), (&json.weave, &json.profile, &json.layout));
    assert_eq!((toml.pitch_mm, json.pitch_mm), (20.0, 20.0));
    let fab = good("plain-2x2.json").fab.expect("it has [fab]");
    assert_eq!(
        (fab.process.as_str(), fab.clearance_mm, fab.shrinkage["print"]),
        ("fdm-pla", Some(0.2), 0.002)
    );
    assert_eq!(good("twill-tiles.toml").name, "twill-tiles");
    let twill = woven("twill-tiles.toml");
    let layout = Layout::Swatch { wefts: 4, warps: 4, cut: Cut::Tiles, repeat: 2, phase: 0 };
    assert_eq!((twill.layout, twill.held), (layout, HeldSpec::Parts(vec!["weft-0".into(), "warp-3".into()])));
    let satin = woven("satin-pieces.toml");
    let Layout::Pieces(pieces) = satin.layout else { panic!("it lists pieces") };
    assert_eq!(piece_ids(&pieces), ["weft-0/1", "weft-0/0", "warp-2"]);
    assert_eq!(satin.held, HeldSpec::Parts(vec!["weft-0/1".into(), "warp-2".into()]));
    assert_eq!((satin.profile.bounds, satin.profile.samples), (Bounds::Prism, 8));
    let paper = woven("paper-points.toml");
    assert!(matches!(paper.profile.shape, Shape::Points(points) if points.len() == 11));
    assert_eq!(paper.held, HeldSpec::Rim);
}

/// Other spellings of the same file: dotted keys, inline tables, other line ends, a byte order mark.
#[test]
fn spellings_of_one_file_are_one_spec() {
    let texts = [
        "[weave]\nabc = [2, 2, 1]\n[swatch]\nwefts = 4\nwarps = 3\nheld = \"rim\"\n",
        "\u{feff}[weave]\r\nabc=[2,2,1]\r\n[swatch]\r\nwefts=0x4\r\nwarps=3\r\nheld='rim'",
        "held = \"rim\"\nweave = { abc = [\n2,\n2,\n1,\n] }\nswatch.wefts = 4\nswatch.warps = 3",
        "\u{feff} {\"held\": \"r\\u0069m\", \"weave\": {\"abc\": [2,2,1]}, \"swatch\": {\"wefts\":4,\"warps\":3}}",
    ];
    let read = |text: &str| {
        let file = Path::new("spelling");
        let spec =
            parse(text, file, Syntax::of(file, text)).unwrap_or_else(|faults| panic!("{faults}\n{text}"));
        let Subject::Woven(woven) = spec.subject else { panic!("woven") };
        (woven.weave, woven.profile, woven.layout, woven.held)
    };
    assert_eq!(read(texts[0]).3, HeldSpec::Rim);
    assert!(texts.iter().all(|text| read(text) == read(texts[0])));
}

#[test]
fn meshes_are_placed_by_proper_motions() {
    let spec = good("meshes.toml");
    let Subject::Meshes(meshes) = &spec.subject else { panic!("it lists meshes") };
    assert_eq!((meshes.tolerance_mm, meshes.mm_per_unit), (0.001, 25.4));
    let [key, lock] = &meshes.parts[..] else { panic!("two parts") };
    assert_eq!((key.id.as_str(), key.held, lock.id.as_str()), ("key", Mobility::Held, "lock"));
    assert!(key.mesh.ends_with("fixtures/specs/parts/key.obj"));
    assert_eq!(lock.at.transform_point3(glam::dvec3(1.0, 2.0, 3.0)), glam::dvec3(3.0, 1.0, 5.5));
}

/// Six decimals are enough for a pose, and it is a rotation to round-off whatever was written.
#[test]
fn poses_written_in_decimals_become_rotations() {
    let text =
        "[[part]]\nmesh = \"a.stl\"\nat = [0.707107, -0.707107, 0, 1, 0.707107, 0.707107, 0, 2, 0, 0, 1, 3]";
    let spec = parse(text, Path::new("a.toml"), Syntax::Toml).unwrap_or_else(|f| panic!("{f}"));
    let Subject::Meshes(meshes) = spec.subject else { panic!("it lists meshes") };
    let m = meshes.parts[0].at.matrix3;
    assert!((m.determinant() - 1.0).abs() < 4.0 * f64::EPSILON, "{m}");
    assert!((m.x_axis.dot(m.y_axis)).abs() < 4.0 * f64::EPSILON, "{m}");
}

#[test]
fn later_stages_find_the_line_of_a_key() {
    let spec = good("twill-tiles.toml");
    assert_eq!(spec.fault("swatch.held[1]", "no such part", "").place, Some(Place { line: 10, column: 19 }));
    assert_eq!(spec.fault("swatch.cut.none", "", "").place.map(|p| p.line), Some(7));
    assert_eq!(spec.fault("profile.rise", "", "").place, None);
}

/// Bounds are met from both sides: the last value that is taken, and the first that is not.
#[test]
fn bounds_are_where_they_are_said_to_be() {
    let takes = |weave: &str, profile: &str, swatch: &str, pitch: &str| {
        let text = format!(
            "[weave]\nabc = {weave}\n[profile]\n{profile}\n[swatch]\nwefts = 2\nwarps = 2\n{swatch}\n[size]\npitch = \"{pitch}\""
        );
        parse(&text, Path::new("bounds.toml"), Syntax::Toml).is_ok()
    };
    let (weave, tiles) = ("[1, 1, 1]", "cut = \"tiles\"");
    for (yes, no) in [("[1, 64, 0]", "[0, 64, 0]"), ("[64, 64, -5]", "[65, 63, -5]")] {
        assert!(takes(yes, "", "", "1 mm") && !takes(no, "", "", "1 mm"), "{yes} {no}");
    }
    assert!(takes("[7, 1, 9223372036854775807]", "", "", "1 mm"), "any whole number shifts");
    for (yes, no) in [
        ("rise = 0", "rise = -0.001"),
        ("rise = 1", "rise = 1.001"),
        ("lift = 6", "lift = 6.001"),
        ("lift = 1e-9", "lift = 0"),
        ("cover = 6", "cover = inf"),
        ("samples = 2", "samples = 1"),
        ("samples = 64", "samples = 65"),
        ("bounds = \"prism\"", "bounds = \"prisma\""),
    ] {
        assert!(takes(weave, yes, "", "1 mm") && !takes(weave, no, "", "1 mm"), "{yes} {no}");
    }
    for (yes, no) in [("repeat = 1000", "repeat = 1001"), ("phase = -1000000", "phase = -1000001")] {
        let [yes, no] = [yes, no].map(|line| takes(weave, "", &format!("{tiles}\n{line}"), "1 mm"));
        assert!(yes && !no);
    }
    for (yes, no) in [("10 m", "10001 mm"), ("1e-3 mm", "0 mm"), ("1 in", "1"), ("2.5 cm", "nan mm")] {
        assert!(takes(weave, "", "", yes) && !takes(weave, "", "", no), "{yes} {no}");
    }
}

#[test]
fn what_is_no_file_is_refused_before_it_is_read() {
    let said = |path: &Path| read(path).expect_err("refused").to_string();
    assert!(said(&fixtures()).contains("directory"));
    assert!(said(&fixtures().join("specs/none.toml")).contains("no such file"));
    let big = std::env::temp_dir().join(format!("weavelock-big-{}.toml", std::process::id()));
    let file = fs::File::create(&big).expect("the temporary folder is writable");
    file.set_len(2 << 30).expect("a sparse file");
    let (spec, wif) = (said(&big), Weave::read(&big).expect_err("refused").to_string());
    fs::remove_file(&big).expect("it is ours");
    assert!(spec.contains("2147483648 bytes") && wif.contains("4 MiB"), "{spec}\n{wif}");
    if cfg!(unix) {
        assert!(said(Path::new("/dev/zero")).contains("not a file"));
    }
}

/// Texts that are made to cost much: nesting, one very long line, very many faults. Each ends in seconds, not hours.
#[test]
fn hostile_texts_end() {
    let many = 200_000;
    let texts = [
        "a.".repeat(many) + "a = 1",
        "a = ".to_string() + &"[".repeat(many),
        "[".repeat(many),
        "{\"a\":".repeat(many),
        format!(
            "held = [{}]\n[weave]\nabc=[1,1,1]\n[[piece]]\nweft=0\nfrom=0\nto=1",
            "\"weft-0\", ".repeat(many)
        ),
        format!("{{\"held\": [{}\"a\"]}}", "\"weft-1\", ".repeat(many)),
        (0..many).map(|k| format!("k{k} = 1\n")).collect(),
        "a = 1\n".repeat(many),
        format!("[fab.shrinkage]\n{}", (0..many).map(|k| format!("s{k} = \"1 %\"\n")).collect::<String>()),
        format!("[weave]\nabc=[1,1,1]\n{}", "[[piece]]\nweft=0\nfrom=0\nto=1\n".repeat(many / 10)),
    ];
    for text in texts {
        for syntax in [Syntax::Toml, Syntax::Json] {
            let faults = parse(&text, Path::new("hostile"), syntax).expect_err("nothing of this is right");
            assert_sound(&faults);
        }
    }
    let sections = (0..many).map(|k| format!("[s{k}]\n")).collect::<String>();
    let lines = (0..many).map(|k| format!("k{k}\n")).collect::<String>();
    for text in [
        format!("[WIF]\n{sections}"),
        format!("[WIF]\n{lines}"),
        "[WIF]\n".repeat(many),
        "1=1\n".repeat(many),
    ] {
        assert_sound(&parse_wif(&text, Path::new("hostile.wif")).expect_err("no draft"));
    }
}

/// What a file holds is quoted in parts and escaped: it cannot flood the terminal, nor command it.
#[test]
fn messages_do_not_obey_the_file() {
    let escape = "\u{1b}[31m".repeat(1000);
    let toml = format!(
        "name = 'a'\n[\"{0}\"]\n[fab]\nprocess = \"p\"\n[fab.shrinkage]\n\"{0}\" = 1",
        "\\u001b[31m".repeat(1000)
    );
    let faults = parse(&toml, Path::new("a.toml"), Syntax::Toml).expect_err("wrong");
    let wif = format!(
        "[WIF]\n[{escape}]\n[WARP]\n{escape}={escape}\n{escape}\nThreads={escape}\n[THREADING]\n{escape}=1"
    );
    let more = parse_wif(&wif, Path::new("a.wif")).expect_err("wrong");
    for said in [faults.to_string(), more.to_string()] {
        assert!(!said.contains('\u{1b}') && said.lines().all(|line| line.len() < 1000), "{said}");
    }
}

/// About a second for each reader; the long run is `cargo run --release --example fuzz`.
#[test]
fn readers_survive_mutants_of_the_fixtures() {
    for (name, target, endings) in targets::READERS {
        let outcome = driver::run(target, targets::corpus(endings), 1.0, 2);
        if let Some(found) = outcome.found {
            panic!("{name}: {}\n{}", found.why, String::from_utf8_lossy(&found.input));
        }
        println!("{name}: {} inputs, {} verdicts", outcome.inputs, outcome.verdicts);
        assert!(outcome.inputs > 100 && outcome.verdicts > 5, "{name} was hardly tried");
    }
}
