//! One mold for all parts that are one solid: made once, filled as often as there are parts, and weighed so.

use super::workshop::{fab, line, list, number, of};
use super::{room, said};
use serde_json::Value;
use std::fs;
use std::path::Path;

const ALL: [&str; 4] = ["weft-0", "weft-1", "warp-0", "warp-1"];

fn read(at: &Path, name: &str) -> String {
    fs::read_to_string(at.join("p").join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

fn words(v: &Value) -> Vec<&str> {
    v.as_array().expect("a list").iter().filter_map(Value::as_str).collect()
}

#[test]
fn the_four_tiles_of_a_plain_window_are_cast_in_one_mold() {
    let at = room("one-mold");
    let answer = fab(&at, "p", &["--process", "silicone-platinum"]);
    let [mold] = &list(&answer, "mold_sheets")[..] else { panic!("{}", answer["mold_sheets"]) };
    assert_eq!(
        (words(&mold["parts"]), &mold["castings"], &mold["pours"]),
        (ALL.to_vec(), &1.into(), &4.into())
    );
    let molds = list(&answer, "molds");
    assert_eq!(molds.iter().map(|m| number(&m["copies"])).collect::<Vec<_>>(), [1.0, 1.0]);
    let cast = line(&answer, "of platinum-cure RTV silicone");
    let grams = 1.1 * of(mold, "casting");
    assert_eq!(cast["count"], 4, "{cast}");
    assert!((number(&cast["mass_g"]) - grams).abs() < 1e-9);
    assert!((number(&cast["total_g"]) - 4.0 * grams).abs() < 1e-9);
    for half in ["lower", "upper"] {
        assert_eq!(line(&answer, &format!("weft-0-mold.{half}.mm.stl"))["count"], 1);
    }
    assert_eq!(line(&answer, "weft-0, weft-1, warp-0, warp-1")["count"], 4);
    assert!(read(&at, "README.md").contains("| weft-0-mold | weft-0, weft-1, warp-0, warp-1 | 1 | 4 |"));
    let told = "made once and filled 4 times";
    for sheet in ["3-molds.md", "4-cast.md", "5-pour.md"] {
        assert!(read(&at, sheet).contains(told), "{sheet}: {}", read(&at, sheet));
    }
    let total = format!("| {:.1} | 4 | {:.1} |", of(mold, "casting"), 4.0 * of(mold, "casting"));
    assert!(read(&at, "5-pour.md").contains(&total), "{total}");
}

/// Of three by one process and one by another each has its mold; several castings at once spare fillings.
#[test]
fn a_mold_serves_the_parts_of_its_process_alone_and_a_gang_is_filled_less_often() {
    let at = room("gang");
    let more = ["--process", "silicone-platinum", "--part", "warp-0=aluminium-lost-pla", "--gang", "2"];
    let answer = fab(&at, "p", &more);
    let molds: Vec<(&str, Vec<&str>, f64, f64)> = list(&answer, "mold_sheets")
        .iter()
        .map(|m| {
            (m["name"].as_str().unwrap(), words(&m["parts"]), number(&m["castings"]), number(&m["pours"]))
        })
        .collect();
    assert_eq!(
        molds,
        [
            ("weft-0-mold", vec!["weft-0", "weft-1", "warp-1"], 2.0, 2.0),
            ("warp-0-tree", vec!["warp-0"], 1.0, 1.0)
        ]
    );
    assert!(read(&at, "3-molds.md").contains("filled 2 times, 2 castings at once, 1 to spare"));
    assert!(read(&at, "3-molds.md").contains("The tree holds its pattern."));
}

#[test]
fn a_tree_holds_the_patterns_of_all_equal_parts() {
    let at = room("tree");
    let answer = fab(&at, "p", &["--process", "aluminium-lost-pla"]);
    let [tree] = &list(&answer, "mold_sheets")[..] else { panic!("{}", answer["mold_sheets"]) };
    assert_eq!(
        (words(&tree["parts"]), &tree["castings"], &tree["pours"]),
        (ALL.to_vec(), &4.into(), &1.into())
    );
    assert!(read(&at, "3-molds.md").contains("The tree holds all 4 patterns."));
    // A pattern is lost with each part: four are printed.
    let printed = line(&answer, "printed pattern: weft-0");
    assert_eq!(printed["count"], 4);
    let mm3 = |v: &Value| number(&v["mm3"]);
    let volumes = list(tree, "volumes");
    let metal = volumes.iter().find(|v| v["of"] == "metal to melt").map(mm3).expect("metal");
    let bare = volumes.iter().find(|v| v["of"] == "wax, runner and gates").map(mm3).expect("wax");
    let pattern = number(&answer["parts"][0]["volume_mm3"]);
    assert!((metal / 1.1 - bare - 4.0 * pattern).abs() < 1e-3 * pattern, "{metal} {bare} {pattern}");
}

/// What is done to print faces is done to all of a solid alike: they lie on the same face, and still share a mold.
#[test]
fn parts_whose_print_faces_are_cut_stay_one_solid() {
    let at = room("cut-alike");
    let answer = fab(&at, "p", &["--process", "pu-resin", "--flatten", "0.5 mm"]);
    let [mold] = &list(&answer, "mold_sheets")[..] else { panic!("{}", answer["mold_sheets"]) };
    assert_eq!(words(&mold["parts"]), ALL);
    let volumes: Vec<f64> = list(&answer, "parts").iter().map(|p| number(&p["volume_mm3"])).collect();
    // Each was cut in its own place and rounded to f32 there.
    assert!(volumes.iter().all(|v| (v / volumes[0] - 1.0).abs() < 1e-6), "{volumes:?}");
    assert_eq!(list(&answer, "layings").len(), 1);
}

/// A finding on a solid names all parts that it is.
#[test]
fn what_is_told_of_a_solid_names_every_part_of_it() {
    let at = room("named");
    let answer = fab(&at, "p", &["--process", "fdm-pla"]);
    let flat = list(&answer, "findings").iter().find(|f| f["what"] == "no flat face to stand on");
    assert_eq!(words(&flat.expect("told")["place"]["parts"]), ALL);
}

/// Meshes of two files, one turned and with its facets in another order, are one solid; a mirror image is not.
#[test]
fn imported_meshes_that_are_equal_by_chance_share_a_mold() {
    let at = room("imported");
    // A wedge without any symmetry, standing apart in three places.
    let corners = [[0., 0., 0.], [30., 0., 0.], [0., 20., 0.], [0., 0., 15.], [12., 0., 15.]];
    let facets = [[0, 2, 1], [0, 1, 4], [0, 4, 3], [1, 2, 4], [2, 3, 4], [0, 3, 2]];
    let obj = |place: &dyn Fn([f64; 3]) -> [f64; 3], facets: Vec<[usize; 3]>| {
        let v = corners.map(place).map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
        v + &facets.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)).collect::<String>()
    };
    let turned = facets.iter().rev().map(|[a, b, c]| [*b, *c, *a]).collect();
    let mirrored = facets.iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    for (name, text) in [
        ("a", obj(&|p| p, facets.to_vec())),
        ("b", obj(&|[x, y, z]| [100.0 - y, x, z], turned)),
        ("c", obj(&|[x, y, z]| [-100.0 - x, y, z], mirrored)),
    ] {
        fs::write(at.join(format!("{name}.obj")), text).expect("writable");
    }
    let part = |id: &str| format!("[[part]]\nid = \"{id}\"\nmesh = \"{id}.obj\"\n");
    let spec = format!("name = \"wedges\"\n{}[size]\nunit = \"mm\"\n", ["a", "b", "c"].map(part).concat());
    fs::write(at.join("wedges.toml"), spec).expect("writable");
    let out = super::ran(
        &["fab", "wedges.toml", "--process", "silicone-platinum", "--out", "p", "--json", "-q"],
        &at,
    );
    let answer: Value = serde_json::from_slice(&out.stdout).unwrap_or_else(|_| panic!("{}", said(&out)));
    let molds: Vec<Vec<&str>> = list(&answer, "mold_sheets").iter().map(|m| words(&m["parts"])).collect();
    assert_eq!(molds, [vec!["a", "b"], vec!["c"]], "{}", said(&out));
}

/// Air of one process among several; a figure that names the process comes before one for all.
#[test]
fn each_process_has_its_own_air() {
    let at = room("air");
    let parts = ["--part", "weft-0=sla", "--part", "weft-1=fdm-petg"];
    let air =
        |answer: &Value| list(answer, "parts").iter().map(|p| number(&p["clearance_mm"])).collect::<Vec<_>>();
    let answer = fab(&at, "p", &[&parts[..], &["--clearance", "0.3 mm, sla=0.12 mm"]].concat());
    assert_eq!(air(&answer), [0.12, 0.3, 0.3, 0.3]);
    for gap in list(&answer, "gaps") {
        let with_sla = gap["a"] == "weft-0" || gap["b"] == "weft-0";
        assert_eq!(number(&gap["promised_mm"]), if with_sla { 0.42 } else { 0.6 }, "{gap}");
        assert_eq!(gap["verdict"], "kept", "{gap}");
    }
    assert!(read(&at, "1-coupon.md").contains("--clearance \"sla=... mm\""), "{}", read(&at, "1-coupon.md"));
    let spec = fs::read_to_string(super::plain()).expect("a spec");
    let more =
        "clearance = \"0.25 mm\"\n[fab.parts]\nweft-0 = \"sla\"\n[fab.clearances]\nsla = \"0.15 mm\"\n";
    fs::write(at.join("s.toml"), format!("{}\n{more}", spec.trim_end())).expect("writable");
    let run = |more: &[&str]| {
        super::ran(&[&["fab", "s.toml", "--json", "-q", "--out", "q", "--force"], more].concat(), &at)
    };
    let of_run = |more: &[&str]| -> Vec<f64> {
        let out = run(more);
        air(&serde_json::from_slice(&out.stdout).unwrap_or_else(|_| panic!("{}", said(&out))))
    };
    assert_eq!(of_run(&[]), [0.15, 0.25, 0.25, 0.25]);
    assert_eq!(of_run(&["--clearance", "0.2 mm"]), [0.15, 0.2, 0.2, 0.2]);
    assert_eq!(of_run(&["--clearance", "sla=0.1 mm"]), [0.1, 0.25, 0.25, 0.25]);
}

#[test]
fn air_of_nobody_or_twice_is_refused_with_a_hint() {
    let at = room("no-air");
    let bad: [(&[&str], &[&str]); 6] = [
        (
            &["--clearance", "sla=0.1 mm"],
            &["\"sla\", by which no part is made", "hint: parts are made by fdm-pla"],
        ),
        (
            &["--clearance", "0.1 mm", "--clearance", "fdm-pla=0.2 mm,fdm-pla=0.3 mm,0.2 mm"],
            &["two figures for all processes", "two figures for \"fdm-pla\""],
        ),
        (&["--clearance", "fdm-pla=0.1"], &["with its unit", "--clearance \"sla=0.1 mm\""]),
        (&["--clearance", "=0.1 mm"], &["no process stands before"]),
        (&["--clearance", "fdm-pla=9 mm"], &["clearance of 9 mm is not possible"]),
        // The process of all parts makes none here.
        (
            &[
                "--part",
                "weft-0=sla",
                "--part",
                "weft-1=sla",
                "--part",
                "warp-0=sla",
                "--part",
                "warp-1=sla",
                "--clearance",
                "fdm-pla=0.1 mm",
            ],
            &["\"fdm-pla\", by which no part is made", "parts are made by sla"],
        ),
    ];
    for (more, words) in bad {
        let out = super::ran(&[&["fab", &super::plain(), "--out", "p"][..], more].concat(), &at);
        assert_eq!(out.status.code(), Some(2), "{more:?}: {}", said(&out));
        for word in words {
            assert!(said(&out).contains(word), "{more:?}: {word} is not in {}", said(&out));
        }
        assert!(super::names(&at).is_empty(), "{more:?}");
    }
}
