//! Flexible parts at the library and the command line: known minima, twins, symmetry, budgets, forged answers.

use crate::support::{joined, ran, tiles, verified, window};
use serde_json::Value;
use std::path::{Path, PathBuf};
use weavelock::contact::Joined;
use weavelock::cores::{self, Contacts, Guard, Set};
use weavelock::flex::{Ask, Flex, Listing, Wanted, flex};
use weavelock::report::answer::{Sealed, checksum};

/// Far below the size of a facet, far above the round-off of vertices.
const WITHIN: f64 = 1e-9;

const ASK: Ask =
    Ask { clearance: 0.0, wanted: Wanted::Smallest, work: 1_000_000, until: None, within: WITHIN };

fn asked(joined: &Joined, ask: &Ask) -> Flex {
    flex(joined.touching(), ask).expect("cells")
}

fn names(joined: &Joined, set: &Set) -> Vec<String> {
    set.iter().map(|&p| joined.assembly.part(p).id.clone()).collect()
}

/// The file's text in a folder of its own; the path.
fn written(name: &str, text: &str) -> PathBuf {
    let at = Path::new(env!("CARGO_TARGET_TMPDIR")).join("flex");
    std::fs::create_dir_all(&at).expect("a folder");
    let path = at.join(format!("{name}.toml"));
    std::fs::write(&path, text).expect("written");
    path
}

fn json(path: &Path, more: &[&str]) -> Value {
    let args: Vec<&str> =
        ["flex", path.to_str().unwrap(), "--json", "-q"].iter().chain(more).copied().collect();
    let out = ran(&args);
    serde_json::from_slice(&out.stdout).unwrap_or_else(|e| panic!("{e}: {out:?}"))
}

fn sealed_again(mut answer: Value) -> Value {
    answer["checksum"] = "".into();
    let sealed: Sealed = serde_json::from_value(answer.clone()).expect("an answer");
    let Sealed::Flex(a) = &sealed else { panic!("no answer of flex") };
    answer["checksum"] = checksum(a).into();
    answer
}

#[test]
fn plain_windows_need_every_second_strand() {
    // Up to symmetry: 2 x 2 any strand; 3 x 3 a middle one; 4 x 4 the two inner or outer of a kind.
    for (size, least, sets) in [(2, 1, 4), (3, 1, 2), (4, 2, 4)] {
        let joined = joined(&window([1, 1, 1], 6, size, size));
        let found = asked(&joined, &ASK);
        assert_eq!((found.minimum(), found.list), (Some(least), Listing::Complete), "{size} x {size}");
        assert_eq!(found.enough.iter().map(|e| e.orbit.len()).sum::<usize>(), sets, "{size} x {size}");
        assert_eq!(found.enough.len(), 1, "one up to symmetry");
        assert_eq!(found.symmetries.len(), 8, "of a plain window");
        assert!(found.unproven.is_empty());
    }
}

/// The twin: unit tiles of the same weave need none.
#[test]
fn what_goes_together_needs_none() {
    let joined = joined(&tiles([1, 1, 1], 6, 2, 1, 0));
    let found = asked(&joined, &ASK);
    assert_eq!((found.minimum(), found.cores.len(), found.enough.len()), (Some(0), 0, 1));
    assert!(found.enough[0].set.is_empty() && found.enough[0].plan.stuck.is_empty());
}

#[test]
fn minimal_sets_hold_no_smaller_one() {
    let joined = joined(&window([1, 1, 1], 6, 3, 3));
    let all = asked(&joined, &Ask { wanted: Wanted::Minimal, ..ASK });
    assert_eq!(all.list, Listing::Complete);
    let sets: Vec<&Set> = all.enough.iter().flat_map(|e| &e.orbit).collect();
    assert!(sets.len() > 2, "more than the smallest: {sets:?}");
    for (k, s) in sets.iter().enumerate() {
        let smaller = sets.iter().enumerate().find(|(j, t)| *j != k && t.is_subset(s));
        assert!(smaller.is_none(), "{:?} holds {:?}", names(&joined, s), smaller);
        // Without any one of its parts a core is left whole.
        for p in *s {
            let less: Set = s.iter().copied().filter(|q| q != p).collect();
            assert!(all.cores.iter().any(|c| c.parts.is_disjoint(&less)), "{:?}", names(&joined, s));
        }
    }
}

/// Cores are locked, and no part can be left out of one.
#[test]
fn cores_are_locked_and_minimal() {
    let joined = joined(&window([1, 1, 1], 6, 3, 3));
    let contacts = Contacts::new(joined.touching());
    let all: Set = joined.assembly.ids().collect();
    let largest = cores::largest(&contacts, &all, Guard::With).largest;
    assert_eq!(largest.len(), 1, "the whole window is locked");
    assert_eq!(largest[0].parts, all);
    let core = cores::least(&contacts, largest[0].clone());
    assert_eq!(core.parts.len(), 4, "{:?}", names(&joined, &core.parts));
    assert!(cores::locked(&contacts, &core.parts).is_some());
    for p in &core.parts {
        let less: Set = core.parts.iter().copied().filter(|q| q != p).collect();
        assert!(cores::largest(&contacts, &less, Guard::Without).largest.is_empty());
    }
}

/// Two windows side by side that share no part: cores of both are found, one after the other, without being told.
#[test]
fn the_largest_locked_sets_are_disjoint() {
    let pieces = |x: i32| {
        (0..2).map(move |k| {
            format!(
                "[[piece]]\nweft = {k}\nfrom = {x}\nto = {}\n[[piece]]\nwarp = {}\nfrom = 0\nto = 2\n",
                x + 2,
                x + k
            )
        })
    };
    let text = crate::support::woven([1, 1, 1], 6, &pieces(0).chain(pieces(4)).collect::<String>());
    let joined = joined(&text);
    let contacts = Contacts::new(joined.touching());
    let found = cores::largest(&contacts, &joined.assembly.ids().collect(), Guard::With).largest;
    assert_eq!(found.iter().map(|c| c.parts.len()).collect::<Vec<_>>(), [4, 4]);
    assert!(found[0].parts.is_disjoint(&found[1].parts));
    assert_eq!(asked(&joined, &ASK).minimum(), Some(2));
}

#[test]
fn where_the_work_ends_the_gap_is_told() {
    let joined = joined(&window([1, 1, 1], 6, 4, 4));
    let whole = asked(&joined, &ASK);
    for work in [0, 64, 200, whole.work / 2] {
        let cut = asked(&joined, &Ask { work, ..ASK });
        assert!(matches!(cut.list, Listing::CutShort(_)) || cut.work >= work, "{work}");
        assert!(cut.lower <= 2 && cut.upper >= 2, "{work}: {} to {}", cut.lower, cut.upper);
        assert!(cut.enough.iter().all(|e| e.plan.stuck.is_empty()));
    }
}

#[test]
fn an_answer_is_verified_and_a_changed_one_is_not() {
    let path = written("three", &window([1, 1, 1], 6, 3, 3));
    let answer = json(&path, &["--minimal"]);
    assert_eq!((&answer["minimum"], &answer["sets_complete"]), (&1.into(), &true.into()));
    let good = verified(&answer);
    assert!(good.valid, "{}", good.why);
    type Change = fn(&mut Value);
    let changes: [(&str, Change); 8] = [
        ("bound", |a| {
            a["lower_bound"] = 2.into();
            a["minimum"] = Value::Null;
        }),
        ("minimum", |a| a["minimum"] = 0.into()),
        ("a core less", |a| a["cores"] = Value::Array(Vec::new())),
        ("a force", |a| a["cores"][0]["certificate"]["forces"][0]["size"] = 9.0.into()),
        ("a set less", |a| drop(a["sets"].as_array_mut().unwrap().pop())),
        ("another set", |a| a["orbits"][0]["set"][0] = "weft-0".into()),
        ("a step less", |a| drop(a["orbits"][0]["plan"]["steps"].as_array_mut().unwrap().pop())),
        ("a symmetry", |a| a["symmetries"][1]["linear"][0][0] = 0.5.into()),
    ];
    for (what, change) in changes {
        let mut forged = answer.clone();
        change(&mut forged);
        assert!(!verified(&forged).valid, "{what}: the seal");
        assert!(!verified(&sealed_again(forged)).valid, "{what}: the mathematics");
    }
}

#[test]
fn with_clearance_only_plans_speak() {
    let path = written("lips", &tiles([2, 2, 1], 6, 4, 1, 0));
    let touching = json(&path, &[]);
    assert!(
        touching["lower_bound"].as_u64() > Some(0),
        "lips lock as they touch: {}",
        touching["lower_bound"]
    );
    let made = json(&path, &["--clearance", "0.2 mm"]);
    assert_eq!((&made["minimum"], &made["clearance_mm"]), (&0.into(), &0.2.into()));
    assert!(made["cores"].as_array().unwrap().is_empty());
    for answer in [touching, made] {
        let found = verified(&answer);
        assert!(found.valid, "{}", found.why);
    }
}

#[test]
fn the_same_bytes_with_any_number_of_threads() {
    let path = written("threads", &window([1, 1, 1], 6, 3, 4));
    let run = |threads| ran(&["flex", path.to_str().unwrap(), "--json", "-q", "--threads", threads]).stdout;
    assert!(!run("1").is_empty());
    assert_eq!(run("1"), run("3"));
}

#[test]
fn words_for_a_maker_and_bad_flags() {
    let path = written("two", &window([1, 1, 1], 6, 2, 2));
    let out = ran(&["flex", path.to_str().unwrap()]);
    let said = String::from_utf8_lossy(&out.stdout).into_owned();
    assert!(said.contains("flexible (cast in silicone") && said.contains("locked by themselves"), "{said}");
    for (flag, value) in [("--time", "soon"), ("--time", "-3 s"), ("--clearance", "thin"), ("--work", "much")]
    {
        let out = ran(&["flex", path.to_str().unwrap(), &format!("{flag}={value}")]);
        assert_eq!(out.status.code(), Some(2), "{flag} {value}");
    }
    let out = ran(&["flex", path.to_str().unwrap(), "--clearance", "40 mm"]);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(2), "{said}");
    assert!(said.contains("nothing is left"), "{said}");
}

/// Other people's roof: locked with its boundary held, and one flexible part is enough.
#[test]
#[ignore = "slow: 62 parts, some ten seconds"]
fn the_roof_needs_one() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases/topolite/roof");
    let Ok(all) = std::fs::read_dir(&folder) else {
        println!("skipped: no {}", folder.display());
        return;
    };
    let mut files: Vec<PathBuf> = all.map(|e| e.expect("an entry").path()).collect();
    files.retain(|f| f.extension().is_some_and(|e| e == "obj"));
    files.sort();
    let mut text =
        "name = \"roof\"\n[contact]\ntolerance = \"0.001 mm\"\n[size]\nunit = \"mm\"\n".to_string();
    for f in files {
        let held = f.file_stem().is_some_and(|s| s == "Boundary");
        text += &format!("[[part]]\nmesh = {:?}\nheld = {held}\n", f.display().to_string());
    }
    let answer = json(&written("roof", &text), &["--work", "1000000"]);
    assert_eq!(answer["minimum"], 1, "{} to {}", answer["lower_bound"], answer["upper_bound"]);
    let found = verified(&answer);
    assert!(found.valid, "{}", found.why);
}
