//! Locks that only rounding makes are no proof anywhere: not as a core, not in a plan, not for `flex`, not for `verify`.

use super::files::{Format, Made, Put, write};
use super::made::all;
use super::noisy::{Folder, joined, remade};
use super::{fixtures, spec_assembly};
use crate::support::{Dice, ran, verified};
use serde_json::Value;
use std::path::Path;
use weavelock::contact::Joined;
use weavelock::cores::{self, Contacts, Firm, Found, Guard, Set, largest};
use weavelock::locking::{Verdict, check_loose};
use weavelock::report::answer::{self, Sealed, checksum};

fn turns(count: usize, seed: u64, format: Format) -> Vec<Put> {
    let mut dice = Dice::new(seed);
    let turn = |_| {
        let axis = [dice.signed(), dice.signed(), dice.signed() + 2.0];
        Put::turned(axis, 3.0 * dice.signed(), format)
    };
    (0..count).map(turn).collect()
}

fn fixture(name: &str, want: [&'static str; 2]) -> Made {
    Made { name: name.into(), ..remade(&spec_assembly(&fixtures()[name]), want) }
}

fn found(j: &Joined) -> Found {
    largest(&Contacts::new(j.touching()), &j.assembly.ids().collect(), Guard::With)
}

fn json(verb: &str, path: &Path) -> Value {
    let out = ran(&[verb, path.to_str().unwrap(), "--json", "-q"]);
    serde_json::from_slice(&out.stdout).unwrap_or_else(|e| panic!("{e}: {out:?}"))
}

/// The plan with a lock as written put in as a proof, sealed again.
fn forged(j: &Joined, mut plan: Value, parts: &Set) -> Value {
    let core = cores::locked(&Contacts::new(j.touching()), parts).expect("locked as written");
    let still: Vec<_> = core.still.iter().copied().collect();
    let lock = answer::certificate(&j.assembly, &still, &core.stress);
    plan["stuck"][0]["lock"] = serde_json::to_value(lock).unwrap();
    plan["outcome"] = "needs-flexible".into();
    plan["checksum"] = "".into();
    let sealed: Sealed = serde_json::from_value(plan.clone()).expect("an answer");
    let Sealed::Plan(a) = &sealed else { panic!("no plan") };
    plan["checksum"] = checksum(a).into();
    plan
}

#[test]
fn a_knob_jammed_by_rounding_is_no_core_and_proves_nothing() {
    let folder = Folder::new("firm");
    let made = fixture("knob-in-case", ["locked", "free"]);
    let mut jammed = 0;
    for (k, put) in turns(8, 5, Format::Obj(5)).into_iter().enumerate() {
        let path = write(&made, put, "0.001 mm", &folder.0);
        let j = joined(&path).unwrap_or_else(|e| panic!("{e}"));
        assert!(found(&j).largest.iter().all(|c| c.firm == Firm::Unproven), "turn {k}");
        if !matches!(check_loose(&j.assembly, &j.patches, &j.loose, None).rigid, Verdict::Locked(_)) {
            continue;
        }
        jammed += 1;
        let flex = json("flex", &path);
        assert_eq!((&flex["lower_bound"], &flex["cores"]), (&0.into(), &Value::Array(vec![])), "turn {k}");
        let plan = json("plan", &path);
        assert_ne!(plan["outcome"], "needs-flexible", "turn {k}");
        let told = verified(&forged(&j, plan, &j.assembly.ids().collect()));
        // For the digits, or because forces that hang on rounding do not balance to round-off.
        assert!(!told.valid, "turn {k}: a lock that only rounding makes is taken for a proof");
        println!("turn {k}: {}", told.why);
        let check = json("check", &path);
        assert!(verified(&check).valid, "turn {k}: {}", verified(&check).why);
        let cores = check["interlock"]["cores"].as_array().unwrap();
        assert!(cores.iter().all(|c| c["within_digits"] == "unproven"), "turn {k}");
    }
    println!("{jammed} of 8 turns jam the knob as written");
    assert!(jammed > 0, "no turn of these was jammed: the test shows nothing");
}

/// The twin: true locks stay proofs when rounded.
#[test]
fn true_locks_survive_their_rounding() {
    let folder = Folder::new("firm-twin");
    for name in ["block-in-case", "burr-keyed"] {
        let made = fixture(name, ["locked"; 2]);
        for put in turns(3, 7, Format::Obj(5)) {
            let path = write(&made, put, "0.001 mm", &folder.0);
            let j = joined(&path).unwrap_or_else(|e| panic!("{e}"));
            let found = found(&j);
            assert_eq!(found.largest.len(), 1, "{name}");
            assert_eq!(found.largest[0].firm, Firm::Holds, "{name}");
            let plan = json("plan", &path);
            assert_eq!(plan["outcome"], "needs-flexible", "{name}: {plan:#}");
            assert!(verified(&plan).valid, "{name}: {}", verified(&plan).why);
        }
    }
}

/// How many made locks are shown to survive: the guard must not call everything doubtful.
#[test]
#[ignore = "slow: all made assemblies, several formats"]
fn most_made_locks_survive_their_digits() {
    let folder = Folder::new("firm-all");
    let (mut locks, mut holds) = (0, 0);
    for format in [Format::Obj(5), Format::StlBinary] {
        for made in all().into_iter().filter(|m| m.want[1] == "locked") {
            let put = turns(1, 3, format).remove(0);
            let Ok(j) = joined(&write(&made, put, "0.001 mm", &folder.0)) else { continue };
            for core in found(&j).largest {
                locks += 1;
                holds += usize::from(core.firm == Firm::Holds);
                if core.firm != Firm::Holds {
                    println!("{} {format:?}: {} parts unproven", made.name, core.parts.len());
                }
            }
        }
    }
    println!("{holds} of {locks} locks survive");
    assert!(locks > 0 && 2 * holds > locks, "{holds} of {locks}");
}
