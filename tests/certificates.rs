//! Answers that were changed: any number, in its fourth digit, as it stands and with the checksum made anew.
//!
//! A changed proof may still be a true one (a motion inside an open cone). What is accepted is therefore held against
//! the claim itself, computed here again.

use crate::laws::degenerate;
use crate::support::{Dice, plan_answer, source, tiles, window};
use glam::{DQuat, DVec3};
use serde_json::{Number, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use weavelock::assembly::PartIx;
use weavelock::contact::{Joined, join};
use weavelock::locking::check;
use weavelock::report::answer::{self, Certificate, ForceAnswer, Sealed};
use weavelock::spec::{Syntax, parse};
use weavelock::verify;
use weavelock::verify::certificate::{About, certificate};

struct Answer {
    name: &'static str,
    json: Value,
    joined: Joined,
}

fn built(file: &str, text: &str) -> Joined {
    let spec = parse(text, Path::new(file), Syntax::Toml).unwrap_or_else(|f| panic!("{f}"));
    join(&spec).unwrap_or_else(|f| panic!("{f}"))
}

fn checked(name: &'static str, file: &str, text: &str) -> Answer {
    let joined = built(file, text);
    let verdict = check(&joined.assembly, &joined.patches, None);
    let answer = answer::check(&joined, &verdict, source(file, text));
    Answer { name, json: serde_json::to_value(answer).expect("JSON"), joined }
}

fn planned(name: &'static str, text: &str) -> Answer {
    let joined = built("test.toml", text);
    let answer = plan_answer(&joined, source("test.toml", text));
    Answer { name, json: serde_json::to_value(answer).expect("JSON"), joined }
}

fn mesh(name: &'static str) -> Answer {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/assemblies").join(format!("{name}.toml"));
    let text = std::fs::read_to_string(&file).expect("a fixture");
    checked(name, &file.display().to_string(), &text)
}

fn answers() -> Vec<Answer> {
    vec![
        checked("plain window", "test.toml", &window([1, 1, 1], 4, 2, 2)),
        checked("plain unit tiles", "test.toml", &tiles([1, 1, 1], 4, 2, 1, 0)),
        checked("twill, phase 1", "test.toml", &tiles([2, 2, 1], 4, 4, 1, 1)),
        mesh("swirl"),
        mesh("knife-clamped"),
        planned("plan of the plain window", &window([1, 1, 1], 4, 2, 2)),
        planned("plan of plain unit tiles", &tiles([1, 1, 1], 4, 2, 1, 0)),
    ]
}

/// Paths of all numbers.
fn numbers(value: &Value, at: String, found: &mut Vec<String>) {
    match value {
        Value::Number(_) => found.push(at),
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(k, v)| numbers(v, format!("{at}/{k}"), found))
        }
        Value::Object(map) => map.iter().for_each(|(k, v)| numbers(v, format!("{at}/{k}"), found)),
        _ => {}
    }
}

/// The number a step up and down in its fourth significant digit; a whole number also by one.
fn changes(n: &Number) -> Vec<Value> {
    let x = n.as_f64().expect("a double");
    let step = if x == 0.0 { 1e-4 } else { 10f64.powf(x.abs().log10().floor() - 3.0) };
    let mut all = vec![Value::from(x + step), Value::from(x - step)];
    all.extend(n.as_u64().map(|whole| Value::from(whole + 1)));
    all.retain(|v| v.as_f64() != Some(x));
    all
}

/// The changed answer as it stands, or with its checksum made anew; none where it cannot even be read.
fn read(json: Value, forged: bool) -> Option<Sealed> {
    let mut sealed: Sealed = serde_json::from_value(json).ok()?;
    if forged {
        match &mut sealed {
            Sealed::Check(a) => {
                a.checksum.clear();
                a.checksum = answer::checksum(&**a);
            }
            Sealed::Plan(a) => {
                a.checksum.clear();
                a.checksum = answer::checksum(&**a);
            }
            #[allow(unreachable_patterns)]
            _ => {}
        }
    }
    Some(sealed)
}

fn accepted(json: Value, forged: bool) -> bool {
    read(json, forged).is_some_and(|sealed| verify::answer(&sealed).is_ok_and(|v| v.valid))
}

/// Numbers beside the proof: a change leaves the claim and its proof as they are. `verify` does not hold them against
/// anything, so a forger may change them, with the checksum.
const BESIDE_THE_PROOF: [&str; 8] = [
    "/residual",
    "/opening",
    "/round_off",
    "/touch",
    "/searched/sets",
    "/searched/directions",
    "/searched/states",
    "/searched/programs",
];

/// Numbers from which the checker builds the parts again: another one is another question, and what it accepts then it
/// has checked for those parts.
const CHECKED_ANEW: [&str; 1] = ["/clearance_mm"];

/// How far below 0 an opening may be, against the top speed: the checker's own bound for round-off with room for
/// another way to add up. A change in the fourth digit that breaks a row breaks it by far more.
const BROKEN: f64 = 1e-7;

/// Whether the motion in an answer, as changed, still opens or keeps all contacts.
fn still_true(joined: &Joined, motion: &Value) -> bool {
    let vector = |t: &Value, key: &str| DVec3::from_array([0, 1, 2].map(|k| t[key][k].as_f64().expect("x")));
    let twists = motion["twists"].as_array().expect("twists");
    let twists: BTreeMap<&str, &Value> =
        twists.iter().map(|t| (t["part"].as_str().expect("id"), t)).collect();
    let velocity = |part: PartIx, p: DVec3| {
        twists.get(joined.assembly.part(part).id.as_str()).map_or(DVec3::ZERO, |t| {
            vector(t, "translation") + vector(t, "rotation").cross(p - vector(t, "centre"))
        })
    };
    let corners = || joined.patches.iter().flat_map(|q| q.corners.iter().map(move |&p| (q, p)));
    let speed = corners().map(|(q, p)| velocity(q.a, p).length().max(velocity(q.b, p).length()));
    let speed = speed.fold(0.0, f64::max);
    speed > 0.0
        && corners().all(|(q, p)| q.normal.dot(velocity(q.b, p) - velocity(q.a, p)) >= -BROKEN * speed)
}

/// The motion that a path leads into, if any.
fn motion<'v>(json: &'v Value, path: &str) -> Option<&'v Value> {
    let at = path.find("/motion/")?;
    json.pointer(&path[..at + "/motion".len()])
}

/// A force between two parts that do not move balances whatever it is.
fn between_still(json: &Value, path: &str) -> bool {
    let Some((proof, _)) = path.split_once("/forces/") else { return false };
    let force = json.pointer(path.trim_end_matches("/size")).expect("a force");
    let still = json.pointer(proof).and_then(|p| p["still"].as_array()).expect("still parts");
    ["a", "b"].iter().all(|side| still.contains(&force[*side]))
}

/// Changes the numbers at some paths; gives the keys of those that a forger could change unnoticed.
fn change(answer: &Answer, paths: &[String]) -> BTreeSet<String> {
    let mut open = BTreeSet::new();
    for path in paths {
        let Some(Value::Number(n)) = answer.json.pointer(path) else { panic!("{path} is no number") };
        for to in changes(n) {
            let mut json = answer.json.clone();
            *json.pointer_mut(path).expect("the path") = to.clone();
            let about = format!("{}: {path}: {n} made {to}", answer.name);
            assert!(!accepted(json.clone(), false), "{about}, accepted");
            if accepted(json.clone(), true) {
                let key: String =
                    path.split('/').filter(|k| k.parse::<usize>().is_err()).collect::<Vec<_>>().join("/");
                let beside = BESIDE_THE_PROOF.iter().chain(&CHECKED_ANEW).any(|k| path.ends_with(k));
                let true_motion = motion(&json, path).is_some_and(|m| still_true(&answer.joined, m));
                let true_force = path.ends_with("/size") && between_still(&json, path);
                assert!(beside || true_motion || true_force, "{about}, accepted from a forger");
                open.insert(key);
            }
        }
    }
    open
}

fn tamper(most: usize) {
    for answer in answers() {
        assert!(accepted(answer.json.clone(), false), "{}: refused as it is", answer.name);
        let mut paths = Vec::new();
        numbers(&answer.json, String::new(), &mut paths);
        let order = Dice::new(5).shuffled(paths.len());
        let some: Vec<String> = order.into_iter().take(most).map(|k| paths[k].clone()).collect();
        let open = change(&answer, &some);
        println!("{}: {} of {} numbers; a forger may change {open:?}", answer.name, some.len(), paths.len());
    }
}

#[test]
fn a_changed_number_is_noticed() {
    tamper(60);
}

#[test]
#[ignore = "slow: every number of every answer"]
fn every_changed_number_is_noticed() {
    tamper(usize::MAX);
}

/// The text of the spec is part of the answer: with another one the proof is about other contacts.
#[test]
fn another_spec_is_another_answer() {
    let text = window([1, 1, 1], 4, 2, 2);
    let answer = checked("plain window", "test.toml", &text);
    for (from, to) in
        [("samples = 4", "samples = 5"), ("rise = 0.6", "rise = 0.6001"), ("wefts = 2", "wefts = 3")]
    {
        let mut json = answer.json.clone();
        json["source"]["text"] = Value::from(text.replace(from, to));
        assert_ne!(json["source"]["text"], answer.json["source"]["text"]);
        assert!(!accepted(json, true), "{to}");
    }
}

/// Equal forces everywhere balance on what merely slides or turns. Turned obliquely its rows are rounded, and rounded
/// rows have full rank by accident: that must not pass for a lock.
#[test]
fn what_slides_is_never_certified_as_locked() {
    let sliding = ["a cube in a ring slides", "a swirl slides, all at once", "a bearing turns"];
    let mut dice = Dice::new(3);
    for (name, (asm, patches), _) in degenerate().into_iter().filter(|c| sliding.contains(&c.0)) {
        for _ in 0..8 {
            let turn =
                DQuat::from_xyzw(dice.signed(), dice.signed(), dice.signed(), dice.signed()).normalize();
            let (mut asm, mut patches) = (asm.clone(), patches.clone());
            asm.parts.iter_mut().for_each(|p| p.pose = glam::DAffine3::from_quat(turn));
            for q in &mut patches {
                q.normal = (turn * q.normal).normalize();
                q.corners.iter_mut().for_each(|c| *c = turn * *c);
            }
            let held: Vec<PartIx> = asm.held().collect();
            let still = if held.is_empty() { vec![PartIx(0)] } else { held };
            let forged = equal_forces(&asm, &patches, &answer::ids(&asm, &still));
            let found = certificate(&asm, &patches, &forged, About::RigidMotions);
            assert!(found.is_err(), "{name}, turned by {turn}: certified as locked");
        }
    }
}

fn equal_forces(
    asm: &weavelock::assembly::Assembly,
    patches: &[weavelock::contact::Patch],
    still: &[String],
) -> Certificate {
    let unknowns = (asm.parts.len() - still.len()) * 6;
    let force = |q: &weavelock::contact::Patch, p: DVec3| ForceAnswer {
        a: asm.part(q.a).id.clone(),
        b: asm.part(q.b).id.clone(),
        normal: q.normal.to_array(),
        point: p.to_array(),
        size: 1.0,
    };
    let forces = patches.iter().flat_map(|q| q.corners.iter().map(move |&p| force(q, p))).collect();
    Certificate {
        kind: "self-stress".into(),
        still: still.to_vec(),
        unknowns,
        rank: unknowns,
        residual: 0.0,
        forces,
    }
}
