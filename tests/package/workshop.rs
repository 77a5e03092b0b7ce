//! What a foundry and a hobbyist do with a package: weigh what they mix, measure the coupon, mix routes, edit a process.

use super::{files, plain, ran, room, said};
use serde_json::Value;
use std::fs;
use std::path::Path;
use weavelock_fab::files::stl;
use weavelock_fab::mesh::Mesh;
use weavelock_fab::offset::REACH;
use weavelock_fab::process::source;

pub fn fab(at: &Path, out: &str, more: &[&str]) -> Value {
    let file = plain();
    let made = ran(&[&["fab", &file, "--out", out, "--json", "-q"], more].concat(), at);
    assert_eq!(made.status.code(), Some(0), "{}", said(&made));
    serde_json::from_slice(&made.stdout).expect("JSON")
}

pub fn list<'a>(v: &'a Value, key: &str) -> &'a Vec<Value> {
    v[key].as_array().unwrap_or_else(|| panic!("{key} in {v}"))
}

pub fn number(v: &Value) -> f64 {
    v.as_f64().unwrap_or_else(|| panic!("a number: {v}"))
}

pub fn of(v: &Value, what: &str) -> f64 {
    let found = list(v, "volumes").iter().find(|x| x["of"].as_str().is_some_and(|w| w.starts_with(what)));
    number(&found.unwrap_or_else(|| panic!("{what} in {v}"))["grams"])
}

pub fn line<'a>(answer: &'a Value, end: &str) -> &'a Value {
    let found =
        list(&answer["bill"], "lines").iter().find(|l| l["what"].as_str().is_some_and(|w| w.ends_with(end)));
    found.unwrap_or_else(|| panic!("{end} in {}", answer["bill"]))
}

/// What fills a mold is the cavity and more, weighed by its own density, and bought with a tenth to spare.
#[test]
fn what_is_mixed_and_melted_is_weighed() {
    let at = room("weighed");
    let answer = fab(&at, "p", &["--part", "weft-0=silicone-platinum", "--part", "weft-1=pu-resin"]);
    for (part, mold, density, material) in [
        (0, "weft-0-mold", 1.07, "platinum-cure RTV silicone"),
        (1, "weft-1-silicone-mold", 1.05, "polyurethane resin"),
    ] {
        let sheet = list(&answer, "mold_sheets").iter().find(|m| m["name"] == mold).expect("a mold");
        let casting = of(sheet, "casting");
        let cavity = number(&answer["parts"][part]["volume_mm3"]) / 1000.0 * density;
        assert!((cavity..cavity * 1.25).contains(&casting), "{mold}: {casting} g for {cavity} g");
        let line = line(&answer, &format!("{mold}: casting with its channels, of {material}"));
        assert!(
            (number(&line["total_g"]) - 1.1 * casting).abs() < 1e-9 && line["material"] == material,
            "{line}"
        );
        let pour = fs::read_to_string(at.join("p/5-pour.md")).expect("a pour sheet");
        assert!(
            pour.contains(&format!("of {material} |")) && pour.contains(&format!("| {casting:.1} |")),
            "{pour}"
        );
    }
}

/// A bronze of the user's own is melted by its own mass; wax is not bought for patterns that are printed, and powder and
/// water not again as what they are mixed to.
#[test]
fn a_trees_metal_is_that_of_the_process() {
    let at = room("bronze");
    let bronze = source("aluminium-lost-pla")
        .expect("a process")
        .replacen("name = \"aluminium-lost-pla\"", "name = \"bronze\"", 1)
        .replacen("value = 2.70", "value = 8.8", 1)
        .replacen("high = 2.72", "high = 8.9", 1);
    fs::write(at.join("bronze.toml"), bronze).expect("writable");
    let answer = fab(&at, "p", &["--part", "weft-0=bronze.toml"]);
    let tree = list(&answer, "mold_sheets").iter().find(|m| m["name"] == "weft-0-tree").expect("a tree");
    let volume = |what: &str| {
        let found = list(tree, "volumes").iter().find(|v| v["of"] == what);
        number(&found.unwrap_or_else(|| panic!("{what}: {tree}"))["mm3"])
    };
    let (melt, bare) = (of(tree, "metal to melt"), volume("wax, runner and gates"));
    assert!((melt - volume("metal to melt") / 1000.0 * 8.8).abs() < 1e-9, "{melt}");
    let pattern = number(&answer["parts"][0]["volume_mm3"]);
    assert!((volume("metal to melt") / 1.1 - bare - pattern).abs() < 1e-3 * pattern, "{bare} {pattern}");
    let lines = list(&answer["bill"], "lines");
    assert!(lines.iter().all(|l| !l["what"].as_str().is_some_and(|w| w.contains("mixed"))), "{lines:?}");
    assert_eq!(line(&answer, "metal to melt")["material"], "aluminium A356");
}

/// Every part by its own route, on files alone: taken down by the K of their own ledger, boxes of part and part touch
/// nowhere, and each finished size is that of the same part in PLA but for the clearances.
#[test]
#[ignore = "ten seconds"]
fn parts_of_four_routes_fit_when_all_is_computed_back() {
    let at = room("routes");
    let routes = ["silicone-platinum", "wax-injected", "aluminium-lost-wax"];
    let flags: Vec<String> =
        ["weft-1", "warp-0", "warp-1"].iter().zip(routes).map(|(id, r)| format!("{id}={r}")).collect();
    let more: Vec<&str> = flags.iter().flat_map(|f| ["--part", f.as_str()]).collect();
    let (mixed, plain) = (fab(&at, "mixed", &more), fab(&at, "plain", &[]));
    let shrinkages: [&[f64]; 4] = [&[0.2], &[0.2, 0.1], &[0.2, 0.1, 1.5], &[0.2, 0.1, 1.5, 1.25]];
    let clearances = [0.2, 0.1, 0.15, 0.3];
    let finished = |answer: &Value, folder: &str, p: usize, k: f64| -> Mesh {
        let file = at.join(answer["parts"][p]["file"].as_str().expect("a file"));
        assert!(file.starts_with(at.join(folder)));
        stl::read(&mut fs::File::open(file).expect("there")).expect("readable").map(|v| v / k)
    };
    let product = |steps: &[f64]| steps.iter().map(|s| 1.0 / (1.0 - s / 100.0)).product::<f64>();
    let meshes: Vec<Mesh> = (0..4).map(|p| finished(&mixed, "mixed", p, product(shrinkages[p]))).collect();
    for p in 0..4 {
        assert!((number(&mixed["parts"][p]["scale"]) - product(shrinkages[p])).abs() < 1e-12);
        let same = finished(&plain, "plain", p, product(&[0.2]));
        let (a, b) = (meshes[p].bounds(), same.bounds());
        let off = ((a.0 - b.0).abs().max((a.1 - b.1).abs())).max_element();
        // A face goes back by its clearance, and no corner of these tiles by more than twice that; edges up to `REACH` of
        // the clearance are united first, and which of their ends is kept may hang on the last digit.
        let most = 2.0 * (clearances[p] - 0.2_f64).abs() + REACH * clearances[p].max(0.2) + 1e-4;
        assert!(off <= most, "{p}: {off}");
    }
    for gap in list(&mixed, "gaps") {
        let index = |id: &Value| {
            ["weft-0", "weft-1", "warp-0", "warp-1"].iter().position(|n| n == id).expect("a part")
        };
        let (a, b) = (index(&gap["a"]), index(&gap["b"]));
        let trees = [a, b].map(|p| weavelock_fab::bvh::Bvh::new(&meshes[p]));
        let least = weavelock_fab::near::nearest((&meshes[a], &trees[0]), (&meshes[b], &trees[1])).distance;
        let promised = clearances[a] + clearances[b];
        assert!(least >= promised && least < promised * 1.01, "{gap}: {least}");
        assert_eq!(gap["verdict"], "kept", "{gap}");
    }
}

/// The length of a coupon goes to the step of that process, or to that step of all.
#[test]
fn a_measure_of_one_process_changes_that_scale_alone() {
    let at = room("coupon");
    let more = ["--part", "weft-0=sla", "--measured", "print=59.80", "--measured", "sla:print=59.40"];
    let answer = fab(&at, "p", &more);
    let scale = |p: usize| number(&answer["parts"][p]["scale"]);
    assert!((scale(0) - 60.0 / 59.40).abs() < 1e-12 && (scale(1) - 60.0 / 59.80).abs() < 1e-12);
    let sheet = fs::read_to_string(at.join("p/1-coupon.md")).expect("a sheet");
    for word in ["--measured sla:print=", "--measured fdm-pla:print=", "59.40 mm", "59.80 mm"] {
        assert!(sheet.contains(word), "{word}: {sheet}");
    }
    let spec = fs::read_to_string(plain()).expect("a spec");
    let more =
        "[fab.parts]\n\"weft-0\" = \"sla\"\n[fab.shrinkage]\nprint = \"1 %\"\n\"sla:print\" = \"2 %\"\n";
    fs::write(at.join("s.toml"), format!("{}\n{more}", spec.trim_end())).expect("writable");
    let made = ran(&["fab", "s.toml", "--out", "q", "--json", "-q"], &at);
    let answer: Value = serde_json::from_slice(&made.stdout).expect("JSON");
    let scale = |p: usize| number(&answer["parts"][p]["scale"]);
    assert!(
        (scale(0) - 1.0 / 0.98).abs() < 1e-12 && (scale(1) - 1.0 / 0.99).abs() < 1e-12,
        "{}",
        said(&made)
    );
}

#[test]
fn what_is_given_twice_or_to_nobody_is_refused_all_at_once() {
    let at = room("twice");
    let copy = source("fdm-pla").expect("a process").replacen("value = 0.20", "value = 0.30", 1);
    fs::write(at.join("copy.toml"), copy).expect("writable");
    let bad: [(&[&str], &[&str]); 5] = [
        (
            &["--part", "weft-0=sla", "--part", "weft-0=fdm-abs", "--part", "x", "--measured", "print=59,8"],
            &["two processes for \"weft-0\"", "\"x\" is no part and process", "\"8\" is not a step"],
        ),
        (&["--measured", "print=59.8", "--measured", "print=59.7"], &["two lengths after \"print\"", "mean"]),
        (&["--measured", "sla:print=59.8"], &["\"sla:print\"", "fdm-pla: print"]),
        (&["--measured", "print=-59.8"], &["a bar of -59.8 mm"]),
        (
            &["--process", "copy.toml", "--part", "weft-0=fdm-pla"],
            &["two processes that differ are called \"fdm-pla\"", "hint"],
        ),
    ];
    for (more, words) in bad {
        let out = ran(&[&["fab", &plain(), "--out", "p"][..], more].concat(), &at);
        assert_eq!(out.status.code(), Some(2), "{more:?}: {}", said(&out));
        for word in words {
            assert!(said(&out).contains(word), "{more:?}: {word} is not in {}", said(&out));
        }
        assert_eq!(super::names(&at), ["copy.toml"], "{more:?}");
    }
}

#[test]
fn a_flag_that_changes_nothing_says_so() {
    let at = room("idle");
    let told = |v: &Value, word: &str| {
        list(v, "findings").iter().any(|f| f["what"].as_str().is_some_and(|w| w.contains(word)))
    };
    let printed = fab(&at, "a", &["--gang", "2", "--direct"]);
    assert!(told(&printed, "(--gang) changed nothing") && told(&printed, "(--direct) changed nothing"));
    let cast = fab(&at, "b", &["--process", "silicone-platinum", "--flatten", "0.5 mm"]);
    assert!(told(&cast, "(--flatten) changed nothing"), "{}", cast["findings"]);
    let flat = fab(&at, "c", &["--flatten", "1 mm", "--elephant-foot", "0.3 mm"]);
    assert!(!told(&flat, "changed nothing"));
    // The face that was cut is what it lies on.
    assert!(
        list(&flat, "layings").iter().all(|l| number(&l["contact_mm2"]) > 10.0 && l["footing"] != "tips"),
        "{}",
        flat["layings"]
    );
    assert_eq!(list(&flat, "parts").iter().filter(|p| !p["file"].is_null()).count(), 4);
}

/// What can not be put in its place leaves the old package as it was: a folder of the user's where a plate should be, and
/// a file where a folder should be.
#[test]
fn a_forced_package_that_can_not_be_put_in_place_leaves_the_old_one() {
    let at = room("in-the-way");
    fab(&at, "p", &[]);
    for (thing, words) in [("print/sla-plate-1.mm.3mf/mine", "a folder stands where"), ("molds", "hint")] {
        let path = at.join("p").join(thing);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(&path, "mine").expect("writable");
        let before = files(&at.join("p"));
        let process = if thing == "molds" { "silicone-tin" } else { "sla" };
        let out = ran(&["fab", &plain(), "--out", "p", "--process", process, "--force"], &at);
        assert!(out.status.code() == Some(2) && said(&out).contains(words), "{}", said(&out));
        assert_eq!(files(&at.join("p")), before, "{thing}");
        assert_eq!(super::names(&at), ["p"]);
    }
}
