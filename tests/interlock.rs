//! Interlocked, keys and cores: against all groups of small random assemblies, asked of the second solver; on fixtures
//! with their twins; and answers that were changed, which `verify` must refuse.

use crate::laws::degenerate;
use crate::random::{Made, random_tetrahedra, random_voxels};
use crate::second::{Opinion, opinion};
use crate::support::{Dice, source};
use std::collections::BTreeSet;
use std::path::Path;
use weavelock::assembly::{Assembly, PartIx};
use weavelock::contact::{Joined, Patch, Touching, join};
use weavelock::cores::Set;
use weavelock::interlock::keys::{Complete, Least};
use weavelock::interlock::{Interlock, Whole, interlock};
use weavelock::locking::{Verdict, check};
use weavelock::report::answer::{self, CheckAnswer, InterlockWord, Sealed};
use weavelock::spec::{Syntax, parse};
use weavelock::verify;

fn found(asm: &Assembly, patches: &[Patch]) -> Interlock {
    interlock(Touching::exactly(asm, patches), &check(asm, patches, None))
}

/// All sets of parts, small ones first.
fn sets(asm: &Assembly) -> Vec<Set> {
    let n = asm.parts.len();
    let set = |mask: u32| (0..n as u32).filter(|k| mask >> k & 1 == 1).map(PartIx).collect::<Set>();
    let mut all: Vec<Set> = (1..1u32 << n).map(set).collect();
    all.sort_by(|a, b| a.len().cmp(&b.len()).then(a.cmp(b)));
    all
}

/// Keys and cores by asking the second solver about every set of parts; none where it is in doubt.
fn truth((asm, patches): &Made) -> Option<(BTreeSet<Set>, BTreeSet<Set>, Opinion)> {
    let held: Set = asm.held().collect();
    let tied = if held.len() > 1 { held } else { Set::new() };
    let (mut keys, mut cores) = (BTreeSet::<Set>::new(), BTreeSet::<Set>::new());
    for set in sets(asm) {
        if set.is_disjoint(&tied) && set.len() < asm.parts.len() && !keys.iter().any(|k| k.is_subset(&set)) {
            let still: Vec<PartIx> = asm.ids().filter(|p| !set.contains(p)).collect();
            match opinion(asm, patches, &still, true) {
                Opinion::InDoubt => return None,
                Opinion::Locked => {}
                _ => drop(keys.insert(set.clone())),
            }
        }
        if set.len() > 1 && !set.is_subset(&tied) {
            let inside = |p: &&Patch| set.contains(&p.a) && set.contains(&p.b);
            let inside: Vec<Patch> = patches.iter().filter(inside).cloned().collect();
            let own: Set = set.intersection(&tied).copied().collect();
            let fixed = if own.is_empty() { set.iter().take(1).copied().collect() } else { own };
            let still: Vec<PartIx> = asm.ids().filter(|p| !set.contains(p) || fixed.contains(p)).collect();
            match opinion(asm, &inside, &still, true) {
                Opinion::InDoubt => return None,
                Opinion::Locked => drop(cores.insert(set)),
                _ => {}
            }
        }
    }
    let largest =
        cores.iter().filter(|c| !cores.iter().any(|d| c != &d && c.is_subset(d))).cloned().collect();
    Some((keys, largest, opinion(asm, patches, &[PartIx(0)], true)))
}

#[derive(Debug, Default)]
struct Tally {
    keys: usize,
    groups: usize,
    cores: usize,
    doubt: usize,
}

fn compare(made: &Made, about: &str, tally: &mut Tally) {
    let (asm, patches) = made;
    let Some((keys, cores, whole)) = truth(made) else {
        tally.doubt += 1;
        return;
    };
    let found = found(asm, patches);
    let own: BTreeSet<Set> = found.keys.found.iter().map(|k| k.parts.clone()).collect();
    assert_eq!(own, keys, "{about}: keys of {made:?}");
    assert_eq!(found.keys.complete, Complete::All, "{about}");
    assert!(found.keys.found.iter().all(|k| k.least == Least::Shown), "{about}");
    let own: BTreeSet<Set> = found.cores.found.largest.iter().map(|c| c.parts.clone()).collect();
    assert_eq!(own, cores, "{about}: cores of {made:?}");
    let word = match &found.whole {
        Whole::AsChecked => check(asm, patches, None).rigid.word(),
        Whole::Fixing(_, verdict) => verdict.word(),
        Whole::NotRun { why } => why,
    };
    if whole != Opinion::InDoubt {
        assert_eq!(word, whole.word(), "{about}");
    }
    tally.keys += keys.len();
    tally.groups += keys.iter().filter(|k| k.len() > 1).count();
    tally.cores += cores.len();
}

fn all_agree(seeds: std::ops::Range<u64>) {
    let mut tally = Tally::default();
    let many = 2 * (seeds.end - seeds.start) as usize;
    for seed in seeds {
        compare(&random_voxels(&mut Dice::new(seed)), &format!("voxels {seed}"), &mut tally);
        compare(&random_tetrahedra(&mut Dice::new(seed)), &format!("tetrahedra {seed}"), &mut tally);
    }
    println!("{tally:?}");
    assert!(tally.doubt * 20 <= many && tally.groups > 0 && tally.cores * 10 > many, "{tally:?}");
}

#[test]
fn keys_and_cores_are_those_of_all_groups() {
    all_agree(0..40);
}

#[test]
#[ignore = "slow: a thousand assemblies, every group of each"]
fn keys_and_cores_are_those_of_all_groups_of_a_thousand() {
    all_agree(5_000..5_500);
}

#[test]
fn known_degenerate_assemblies_have_the_keys_of_all_groups() {
    for (name, made, _) in degenerate() {
        compare(&made, name, &mut Tally::default());
    }
}

fn fixture(name: &str) -> (String, Joined) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/assemblies/{name}.toml"));
    let text = std::fs::read_to_string(&file).expect("a fixture");
    let spec = parse(&text, &file, Syntax::Toml).unwrap_or_else(|f| panic!("{f}"));
    (file.display().to_string(), join(&spec).unwrap_or_else(|f| panic!("{f}")))
}

fn answered(name: &str) -> CheckAnswer {
    let (file, joined) = fixture(name);
    let text = std::fs::read_to_string(&file).expect("a fixture");
    let check = check(&joined.assembly, &joined.patches, None);
    let found = interlock(joined.touching(), &check);
    let written = answer::interlock(&joined.assembly, &check, &found);
    answer::with_interlock(answer::check(&joined, &check, source(&file, &text)), written)
}

/// Sets of ids, each sorted, in order.
fn ids(sets: impl Iterator<Item = Vec<String>>) -> Vec<String> {
    let mut out: Vec<String> = sets
        .map(|mut s| {
            s.sort();
            s.join("+")
        })
        .collect();
    out.sort();
    out
}

#[test]
fn fixtures_and_their_twins() {
    use InterlockWord::{Interlocked, NotInterlocked};
    let cases: [(&str, InterlockWord, &[&str], &[&str]); 8] = [
        ("burr", NotInterlocked, &["blue+green+red+white", "key"], &["blue+green+red+white"]),
        ("burr-keyed", NotInterlocked, &[], &["blue+green+key+red+white"]),
        (
            "swirl",
            NotInterlocked,
            &["swirl-east+swirl-south", "swirl-east+swirl-west", "swirl-south+swirl-west"],
            &[],
        ),
        ("swirl-two-held", NotInterlocked, &[], &["swirl-east+swirl-south+swirl-west"]),
        ("knob-in-case", NotInterlocked, &["case", "knob"], &[]),
        ("block-in-case", Interlocked, &[], &["block+case"]),
        ("woven/plain-window", Interlocked, &[], &["warp-0+warp-1+weft-0+weft-1"]),
        ("woven/plain-window-of-three", NotInterlocked, &[], &[]),
    ];
    for (name, word, keys, cores) in cases {
        let a = answered(name).interlock.expect("asked");
        assert_eq!(a.word, word, "{name}");
        let found = ids(a.keys.iter().map(|k| k.parts.clone()));
        if !keys.is_empty() || a.word == Interlocked {
            assert_eq!(found, keys, "{name}");
        }
        let largest = a.cores.iter().filter(|c| c.kind == "largest").map(|c| c.parts.clone());
        assert_eq!(ids(largest), cores, "{name}");
        let checked =
            verify::answer(&Sealed::Check(Box::new(answered(name)))).unwrap_or_else(|f| panic!("{f}"));
        assert!(checked.valid, "{name}: {}", checked.why);
    }
}

/// The burr's key leaves one way along x; the knob can only turn, about z.
#[test]
fn keys_say_along_what_and_about_what() {
    let burr = answered("burr").interlock.expect("asked");
    let key = burr.keys.iter().find(|k| k.parts == ["key"]).expect("the key");
    let directions = key.directions.as_ref().expect("told");
    assert!(directions.lines.is_empty());
    assert_eq!(directions.rays, [[1.0, 0.0, 0.0]]);
    assert_eq!(key.motion.kind, "opens");
    let knob = answered("knob-in-case").interlock.expect("asked");
    for k in &knob.keys {
        assert_eq!(k.directions.as_ref().map(|d| d.lines.len() + d.rays.len()), Some(0));
        let w = k.motion.twists[0].rotation;
        assert!(w[2].abs() > 0.0 && w[0].abs() + w[1].abs() < 1e-9 * w[2].abs(), "{w:?}");
    }
}

/// Seals an answer again after it was changed, so that only the mathematics can refuse it.
fn refused(what: &str, mut a: CheckAnswer, change: impl Fn(&mut CheckAnswer)) {
    change(&mut a);
    a.checksum = String::new();
    a.checksum = answer::checksum(&a);
    let found = verify::answer(&Sealed::Check(Box::new(a))).unwrap_or_else(|f| panic!("{f}"));
    assert!(!found.valid, "{what} was accepted");
}

#[test]
fn changed_claims_are_refused() {
    let burr = || answered("burr");
    type Change = fn(&mut answer::InterlockAnswer);
    let changes: [(&str, Change); 8] = [
        ("a key that is none", |i| i.keys[0].parts = vec!["red".into()]),
        ("a motion without one of its parts", |i| {
            i.keys.iter_mut().for_each(|k| drop(k.motion.twists.pop()));
        }),
        ("the other way", |i| {
            i.keys.iter_mut().flat_map(|k| &mut k.motion.twists).for_each(|t| t.translation[0] *= -1.0);
        }),
        ("a direction that is blocked", |i| {
            i.keys
                .iter_mut()
                .filter_map(|k| k.directions.as_mut())
                .for_each(|d| d.rays.push([0.0, 0.0, 1.0]));
        }),
        ("a direction that is none", |i| {
            i.keys.iter_mut().filter_map(|k| k.directions.as_mut()).for_each(|d| d.rays[0][0] *= 2.0);
        }),
        ("a core with a part more", |i| i.cores[0].parts.push("key".into())),
        ("a core without a force", |i| {
            let c = &mut i.cores[0].certificate;
            c.forces.truncate(c.forces.len() / 2);
        }),
        ("another word", |i| i.word = InterlockWord::Interlocked),
    ];
    for (what, change) in changes {
        refused(what, burr(), |a| {
            let i = a.interlock.as_mut().expect("asked");
            change(i);
            a.interlocked = Some(i.word);
        });
    }
    refused("a word without its proof", burr(), |a| a.interlock = None);
    refused("two words", burr(), |a| a.interlocked = Some(InterlockWord::Undecided));
}

/// Eighty parts of which one is held, the key: all others are stopped by it, and once it is away one after another can
/// start, so nothing is locked without it.
#[test]
#[ignore = "slow: 79 parts that only move together"]
fn the_bunny_has_one_key() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases/topolite/bunny");
    if !folder.exists() {
        println!("not run: {} is absent", folder.display());
        return;
    }
    let part = |k: usize| format!("[[part]]\nmesh = \"part_{k}.obj\"\nheld = {}\n", k == 1);
    let parts: String = (1..=80).map(part).collect();
    let text =
        format!("name = \"bunny\"\n{parts}[contact]\ntolerance = \"0.001 mm\"\n[size]\nunit = \"mm\"\n");
    let spec = parse(&text, &folder.join("bunny.toml"), Syntax::Toml).unwrap_or_else(|f| panic!("{f}"));
    let joined = join(&spec).unwrap_or_else(|f| panic!("{f}"));
    let found = found(&joined.assembly, &joined.patches);
    assert!(matches!(check(&joined.assembly, &joined.patches, None).rigid, Verdict::Free(_)));
    assert!(found.keys.found.iter().any(|k| k.parts == Set::from([PartIx(0)])));
    assert!(found.cores.found.largest.is_empty());
}
