//! Parts as made: how far they rattle, and what clearance releases a lock; against numbers by hand and a second solver.

use crate::support::{joined, ran, verified, window};
use microlp::{ComparisonOp, OptimizationDirection, Problem};
use serde_json::Value;
use weavelock::assembly::PartIx;
use weavelock::locking::{Freedom, Unknowns, rows};
use weavelock::play::{Kind, Reach, play};

fn answer(args: &[&str]) -> (Value, i32) {
    let out = ran(args);
    let text = String::from_utf8(out.stdout).expect("UTF-8");
    let json = serde_json::from_str(&text).unwrap_or_else(|e| panic!("{e}: {text}"));
    (json, out.status.code().expect("a code"))
}

const BLOCK: &str = "fixtures/assemblies/block-in-case.toml";
const PLAIN: &str = "fixtures/examples/plain-2x2.toml";

/// By hand: a cube of 8 mm in a case shifts by the fit; turned about an axis its corners, 4 mm off, close the fit at an
/// angle of fit over 4 mm while its middle stays.
#[test]
fn a_block_in_its_case_rattles_as_far_as_computed_by_hand() {
    for clearance in [0.1, 0.5] {
        let (a, code) = answer(&["play", BLOCK, "--clearance", &format!("{clearance} mm"), "--json"]);
        assert_eq!((a["outcome"].as_str(), code), (Some("bounded"), 0));
        let fit = 2.0 * clearance;
        let near = |list: &Value, expected: f64| {
            for one in list.as_array().expect("a list") {
                let (found, bound) = (one["first_order"].as_f64(), one["at_most"].as_f64());
                let (found, bound) = (found.expect("a number"), bound.expect("a number"));
                assert!((found / expected - 1.0).abs() < 1e-6, "{found}, by hand {expected}");
                assert!((bound / found - 1.0).abs() < 1e-6, "{found}, at most {bound}");
            }
        };
        near(&a["parts"][0]["shift"], fit);
        near(&a["parts"][0]["tilt"], (fit / 4.0).to_degrees());
    }
}

#[test]
fn a_tail_that_slides_out_is_loose_along_its_socket_only() {
    let (a, code) =
        answer(&["play", "fixtures/assemblies/dovetail-open.toml", "--clearance", "0.2 mm", "--json"]);
    assert_eq!((a["outcome"].as_str(), code), (Some("loose"), 1));
    let open: Vec<&Value> =
        a["parts"][0]["shift"].as_array().expect("six").iter().filter(|s| !s["why"].is_null()).collect();
    assert_eq!(open.iter().map(|s| s["way"].as_str().expect("a way")).collect::<Vec<_>>(), ["+y", "-y"]);
}

/// The same program for a simplex solver, all rows at once.
#[test]
fn a_simplex_solver_finds_the_same_play() {
    let joined = joined(&window([1, 1, 1], 4, 2, 2));
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let all = rows(patches, Freedom::Rigid);
    let unknowns = Unknowns::new(asm, &all, &[PartIx(0)], Freedom::Rigid);
    for e in play(asm, patches, &[PartIx(1), PartIx(3)], &[PartIx(0)]).expect("few rows") {
        let Reach::Held { value, .. } = e.reach else { panic!("held: {e:?}") };
        let mut problem = Problem::new(OptimizationDirection::Maximize);
        let column = unknowns.column[e.part.at()].expect("free") + e.axis;
        let (goal, lever) = match e.kind {
            Kind::Shift => (column, 1.0),
            Kind::Tilt => (column + 3, unknowns.lever[e.part.at()]),
        };
        let wide = (f64::NEG_INFINITY, f64::INFINITY);
        let x: Vec<_> = (0..unknowns.count)
            .map(|c| problem.add_var(if c == goal { e.sign } else { 0.0 }, wide))
            .collect();
        for row in &all {
            let terms: Vec<_> = unknowns.entries(row).map(|(c, v)| (x[c], v)).collect();
            problem.add_constraint(&terms[..], ComparisonOp::Ge, -1.0);
        }
        let outcome = problem.solve().expect("bounded");
        let second = outcome.solution().expect("an optimum").objective() / lever;
        assert!(
            (value / second - 1.0).abs() < 1e-5,
            "{:?} {} {}: {value} and {second}",
            e.kind,
            e.axis,
            e.sign
        );
    }
}

#[test]
#[ignore = "a minute"]
fn the_plain_window_opens_between_two_clearances_and_the_plan_is_checked() {
    let (a, code) = answer(&["release", PLAIN, "--process", "fdm-pla", "--json"]);
    assert_eq!((a["outcome"].as_str(), code), (Some("opens"), 0));
    assert!(a["certificate"].is_object());
    for b in a["brackets"].as_array().expect("brackets") {
        let end = |name: &str| b[name]["clearance_mm"].as_f64().expect("a length");
        let (lo, hi) = (end("lo"), end("hi"));
        assert!(0.0 < lo && lo < hi && hi <= lo * 17.0 / 16.0 * 1.0001, "{lo} to {hi}");
        assert!((b["hi"]["of_pitch"].as_f64().expect("a share") - hi / 20.0).abs() < 1e-9);
    }
    let found = verified(&a);
    assert!(found.valid, "{}", found.why);
}

#[test]
fn a_release_that_was_changed_is_refused() {
    let (a, _) = answer(&["release", "fixtures/assemblies/dovetail-stopped.toml", "--json"]);
    assert!(verified(&a).valid);
    let mut less = a.clone();
    less["brackets"][0]["hi"]["clearance_mm"] = serde_json::json!(0.01);
    assert!(!verified(&less).valid);
    let mut none = a;
    none["outcome"] = "needs-none".into();
    assert!(!verified(&none).valid);
}

#[test]
fn what_comes_apart_as_it_is_needs_no_clearance() {
    let (a, code) =
        answer(&["release", "fixtures/assemblies/dovetail-open.toml", "--process", "sla", "--json"]);
    assert_eq!((a["outcome"].as_str(), code), (Some("needs-none"), 0));
    assert_eq!(a["process"]["lock"], "opens");
    assert!(verified(&a).valid);
}

#[test]
fn no_air_and_unknown_names_are_refused_with_a_hint() {
    for args in [
        &["play", BLOCK, "--clearance", "0 mm"][..],
        &["play", BLOCK, "--clearance", "0.1 mm", "--of", "nobody"],
        &["release", BLOCK, "--process", "no-such-process"],
    ] {
        let out = ran(args);
        assert_eq!(out.status.code(), Some(2), "{args:?}");
        assert!(out.stdout.is_empty() && !out.stderr.is_empty(), "{args:?}");
    }
}
