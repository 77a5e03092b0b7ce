//! Repetitions at the library and the command line: rows with proofs, verified and forged; classes of every size;
//! windows at every place of the draft, which docs/repeats.md builds on; what a weaver is told.

use crate::support;
use crate::support::{joined, ran, verified, words, woven};
use serde_json::Value;
use std::path::{Path, PathBuf};
use weavelock::assembly::layout::Swatch;
use weavelock::repeats::explain::How;
use weavelock::repeats::grow::{Sizes, grow};
use weavelock::repeats::{AsMade, Search, attempt, repeats, text};
use weavelock::report::answer::Sealed;
use weavelock::spec::{Bounds, ProfileSpec, Shape, Subject, Syntax, parse};
use weavelock::weave::Weave;

fn profile(samples: u32) -> ProfileSpec {
    ProfileSpec { shape: Shape::Rise(0.6), lift: 1.0, cover: 1.0, samples, bounds: Bounds::Sandwich }
}

fn json(args: &[&str]) -> Value {
    let args: Vec<&str> = args.iter().copied().chain(["--json", "-q"]).collect();
    let out = ran(&args);
    serde_json::from_slice(&out.stdout).unwrap_or_else(|e| panic!("{e}: {args:?}\n{out:?}"))
}

/// The seal of an answer changed on purpose, so that only the mathematics can tell.
fn sealed_again(mut answer: Value) -> Value {
    answer["checksum"] = "".into();
    let sealed: Sealed = serde_json::from_value(answer.clone()).expect("an answer");
    answer["checksum"] = match &sealed {
        Sealed::Repeats(a) => weavelock::report::answer::checksum(a).into(),
        _ => panic!("no answer of repeats"),
    };
    answer
}

fn room(name: &str) -> PathBuf {
    support::room("repeats", name)
}

#[test]
fn the_text_of_a_swatch_is_read_back_to_the_bit() {
    for (shape, cover) in [
        (Shape::Rise(0.1 + 0.2), 1.0 / 3.0),
        (Shape::Points(vec![[0.0, 0.5], [0.3, 1.0], [0.7, 1.0], [1.3, 0.0], [1.7, 0.0], [2.0, 0.5]]), 0.7),
    ] {
        let profile = ProfileSpec { shape, cover, bounds: Bounds::Prism, ..profile(5) };
        for weave in [Weave::abc(1, 1, -1).unwrap(), Weave::read(&fixture("weaves/plain.wif")).unwrap()] {
            let text = text(&weave, &profile, Swatch { wefts: 3, warps: 2, repeat: 2, phase: -1 }, 12.5);
            let spec =
                parse(&text, Path::new("t.toml"), Syntax::Toml).unwrap_or_else(|e| panic!("{e}\n{text}"));
            let Subject::Woven(read) = spec.subject else { panic!("{text}") };
            assert_eq!(read.profile, profile, "{text}");
            assert_eq!((&read.weave.draft, read.weave.tile), (&weave.draft, weave.tile), "{text}");
            assert_eq!(read.pitch_mm, 12.5);
        }
    }
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

#[test]
fn a_free_piece_is_explained_by_its_crossings() {
    let plain = Weave::abc(1, 1, 1).unwrap();
    let tried =
        attempt(&plain, &profile(8), Swatch { wefts: 2, warps: 2, repeat: 1, phase: 0 }, AsMade::TOUCHING);
    let tried = tried.unwrap();
    assert_eq!(tried.rigid.word(), "free");
    assert!(!tried.loose.is_empty());
    for loose in &tried.loose {
        assert_eq!(loose.crossings.len(), 2, "a unit tile of plain weave has two crossings: {loose:?}");
        let there = loose.crossings.iter().filter(|c| c.part.is_some()).count();
        assert!(loose.float_over + loose.float_under <= there);
        assert!(loose.words.starts_with(&loose.part));
        match loose.how {
            How::Lifts => assert!(loose.crossings.iter().all(|c| c.rises > 0.0), "{loose:?}"),
            How::Drops => assert!(loose.crossings.iter().all(|c| c.rises < 0.0), "{loose:?}"),
            How::Tips => {
                let up = |c: &&weavelock::repeats::explain::CrossingAnswer| c.rises > 0.0;
                assert!(loose.crossings.iter().any(|c| up(&c)) && !loose.crossings.iter().all(|c| up(&c)));
            }
            How::SlidesAlong | How::SlidesAcross => {}
        }
    }
    // A piece that lifts alone has no thread over it.
    let lone = tried.loose.len() == 1 && tried.loose[0].how == How::Lifts;
    let under = |c: &weavelock::repeats::explain::CrossingAnswer| c.part.is_some() && c.passes == "under";
    assert!(!lone || !tried.loose[0].crossings.iter().any(under));
}

#[test]
fn a_locked_swatch_explains_nothing_and_interlaces() {
    let plain = Weave::abc(1, 1, 1).unwrap();
    let swatch = Swatch { wefts: 2, warps: 2, repeat: 2, phase: 0 };
    let tried = attempt(&plain, &profile(8), swatch, AsMade::TOUCHING).unwrap();
    assert_eq!((tried.rigid.word(), tried.loose.len(), tried.least_interlacing), ("locked", 0, 1));
}

/// Longer pieces keep every contact of shorter ones: where one piece runs along each strand, k locked makes k + 1 locked.
#[test]
fn longer_pieces_stay_locked() {
    for (a, b, c, least) in [(1, 1, 1, 2), (2, 1, 1, 2), (2, 2, 1, 2)] {
        let weave = Weave::abc(a, b, c).unwrap();
        let n = a + b;
        let search = Search { wefts: n, warps: n, phases: vec![0], most: 4 };
        assert_eq!(repeats(&weave, &profile(4), &search).unwrap().least, Some(least), "[{a},{b},{c}]");
        for repeat in least..=4 {
            let swatch = Swatch { wefts: n, warps: n, repeat, phase: 0 };
            let tried = attempt(&weave, &profile(4), swatch, AsMade::TOUCHING).unwrap();
            assert_eq!(tried.rigid.word(), "locked", "[{a},{b},{c}], k = {repeat}");
        }
    }
}

/// The lemma of docs/repeats.md: what is proven for a class holds for its larger swatches, decided one by one.
#[test]
fn a_class_of_sizes_speaks_for_its_larger_swatches() {
    let plain = Weave::abc(1, 1, 1).unwrap();
    let classes = grow(&plain, &profile(4), 2, 0, Sizes::All).unwrap();
    assert_eq!(classes.len(), 16);
    assert!(classes.iter().all(|c| c.flaw.is_none()), "{:?}", classes[0].flaw);
    let locked: Vec<_> = classes.iter().filter(|c| c.base.rigid.word() == "locked").collect();
    assert!(!locked.is_empty() && locked.len() < classes.len());
    for class in locked {
        let Swatch { wefts, warps, .. } = class.base.swatch;
        let swatch = Swatch { wefts: wefts + class.step.0, warps: warps + class.step.1, ..class.base.swatch };
        let tried = attempt(&plain, &profile(4), swatch, AsMade::TOUCHING).unwrap();
        assert_eq!(tried.rigid.word(), "locked", "{swatch:?}");
    }
}

/// A window of `size` strands each way whose first warp is `at`, as pieces one by one.
fn window(abc: [i32; 3], size: i32, at: i32) -> String {
    let pieces = (0..size).map(|k| {
        format!(
            "[[piece]]\nweft = {k}\nfrom = {at}\nto = {}\n[[piece]]\nwarp = {}\nfrom = 0\nto = {size}\n",
            at + size,
            at + k
        )
    });
    woven(abc, 5, &pieces.collect::<String>())
}

/// Windows at every place of the draft: a larger one is a union of these with longer pieces, and so is locked with them.
#[test]
fn windows_lock_wherever_they_are_cut() {
    for (abc, size) in [([1, 1, 1], 2), ([2, 1, 1], 3), ([2, 2, 1], 3), ([3, 1, 1], 4)] {
        for at in 0..abc[0] + abc[1] {
            let joined = joined(&window(abc, size, at));
            assert_eq!(words(&joined.assembly, &joined.patches).1, "locked", "{abc:?}, {size}, at {at}");
        }
    }
    // One strand less is not enough everywhere.
    for (abc, size) in [([2, 1, 1], 2), ([2, 2, 1], 2), ([3, 1, 1], 3)] {
        let free = (0..abc[0] + abc[1]).filter(|&at| {
            let joined = joined(&window(abc, size, at));
            words(&joined.assembly, &joined.patches).1 == "free"
        });
        assert!(free.count() > 0, "{abc:?}, {size}");
    }
}

#[test]
fn an_answer_is_verified_and_a_changed_one_is_not() {
    let answer = json(&["repeats", "[1,1,1]", "--swatch", "n,3x2", "--phases", "all", "--every-size"]);
    assert_eq!(answer["minimal_repeat"], 2, "{}", answer["cases"]);
    let good = verified(&answer);
    assert!(good.valid, "{}", good.why);
    type Change = fn(&mut Value);
    let changes: [(&str, Change); 7] = [
        ("least", |a| a["minimal_repeat"] = 1.into()),
        ("case", |a| a["cases"][0]["minimal_repeat"] = 1.into()),
        ("verdict", |a| a["table"][0]["rigid"] = "locked".into()),
        ("swatch", |a| a["table"][0]["swatch"]["wefts"] = 5.into()),
        ("profile", |a| a["table"][0]["profile"]["cover"] = 0.5.into()),
        ("parts", |a| a["table"][0]["parts"] = 9.into()),
        ("step", |a| a["every_size"][0]["step"][0] = 2.into()),
    ];
    for (what, change) in changes {
        let mut forged = answer.clone();
        change(&mut forged);
        assert!(!verified(&forged).valid, "{what}: the seal");
        assert!(!verified(&sealed_again(forged)).valid, "{what}: the mathematics");
    }
    let mut forged = answer.clone();
    let row = forged["table"].as_array_mut().unwrap().iter_mut().find(|r| r["rigid"] == "locked").unwrap();
    row["proof"]["certificate"]["forces"][0]["size"] = 7.5.into();
    assert!(!verified(&sealed_again(forged)).valid, "a force");
}

#[test]
fn proofs_are_written_as_answers_of_check() {
    let at = room("proofs");
    let folder = at.join("proofs");
    let file = fixture("weaves/twill-2-2.draft");
    let answer = json(&["repeats", file.to_str().unwrap(), "--proofs", folder.to_str().unwrap()]);
    assert_eq!(answer["minimal_repeat"], 2);
    let mut files: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    assert_eq!(files.len(), answer["table"].as_array().unwrap().len());
    for file in files {
        let out = ran(&["verify", file.to_str().unwrap(), "-q"]);
        assert_eq!(out.status.code(), Some(0), "{out:?}");
    }
}

#[test]
fn any_weave_file_and_varied_values() {
    let spec = fixture("specs/twill-tiles.toml");
    let wif = fixture("weaves/satin-5-liftplan.wif");
    for file in [spec, wif] {
        let answer = json(&["repeats", file.to_str().unwrap(), "--samples", "4", "--max-repeat", "3"]);
        assert!(answer["minimal_repeat"].is_u64(), "{}", answer["cases"]);
    }
    let answer = json(&[
        "repeats",
        "[1,1,1]",
        "--vary",
        "rise=0.2,1",
        "--vary",
        "cover=0.5,1",
        "--vary",
        "swatch=2x2,2x4",
    ]);
    assert_eq!(answer["cases"].as_array().unwrap().len(), 8);
    assert!(verified(&answer).valid);
}

#[test]
fn a_clearance_finds_plans_or_says_that_it_found_none() {
    let answer = json(&["repeats", "[2,2,1]", "--clearance", "0.2 mm", "--samples", "6"]);
    assert_eq!(answer["minimal_repeat"], Value::Null, "a plan that was not found proves nothing");
    let words: Vec<&str> = answer["table"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r["as_made"]["verdict"].as_str().unwrap())
        .collect();
    assert_eq!(words, ["comes-apart", "not-found"]);
    assert_eq!(answer["cases"][0]["no_plan_from"], 2);
    assert!(verified(&answer).valid);
}

#[test]
fn wrong_questions_are_refused_with_all_their_faults() {
    for (args, said) in [
        (&["repeats", "[1,1,1]", "--swatch", "2by2,0x3"][..], &["`2by2`", "`0x3`"][..]),
        (&["repeats", "[1,1,1]", "--vary", "weight=3", "--phases", "a"], &["`weight`", "`a`"]),
        (&["repeats", "[1,1,1]", "--vary", "rise=1.5"], &["rise"]),
        (&["repeats", "[1,1,1]", "--vary", "rise"], &["names no values"]),
    ] {
        let out = ran(args);
        let stderr = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{args:?}");
        assert!(out.stdout.is_empty() && said.iter().all(|s| stderr.contains(s)), "{args:?}: {stderr}");
    }
}

#[test]
fn the_same_bytes_with_any_number_of_threads() {
    let run = |threads| {
        ran(&["repeats", "[2,1,1]", "--phases", "all", "--json", "-q", "--threads", threads]).stdout
    };
    assert!(!run("1").is_empty());
    assert_eq!(run("1"), run("3"));
}
