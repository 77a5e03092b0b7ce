//! What `verify` says of certificates: exactly true, for every fixture and everyone's cases; and what it refuses. What a
//! check says of its margin and of the surfaces behind the samples.

use crate::random::parts;
use crate::support;
use crate::support::{Dice, joined, source, tiles, window};
use glam::DVec3;
use std::path::{Path, PathBuf};
use weavelock::assembly::{Assembly, PartIx};
use weavelock::contact::{Joined, Patch, join};
use weavelock::locking::{Verdict, check};
use weavelock::report::answer::{self, Certificate, CheckAnswer, ForceAnswer, Word};
use weavelock::sampling::{Beyond, refined};
use weavelock::spec::{Spec, Syntax, parse};
use weavelock::verify::certificate::{About, Arithmetic, Shown, certificate, proof};

fn spec(file: &Path, text: &str) -> Spec {
    parse(text, file, Syntax::Toml).unwrap_or_else(|f| panic!("{f}"))
}

fn answered(joined: &Joined, file: &Path, text: &str) -> CheckAnswer {
    let verdict = check(&joined.assembly, &joined.patches, None);
    answer::check(joined, &verdict, source(&file.display().to_string(), text))
}

/// Both proofs of an answer, held against the contacts.
fn shown(joined: &Joined, a: &CheckAnswer) -> [Shown; 2] {
    let still: Vec<String> = a.held.iter().cloned().chain(a.fixed.clone()).collect();
    let held = |p, about| {
        proof(&joined.assembly, &joined.patches, p, &still, about)
            .unwrap_or_else(|why| panic!("{}: {why}", a.name))
    };
    [held(&a.rigid, About::RigidMotions), held(&a.translation_proof, About::Translations)]
}

fn exactly(joined: &Joined, a: &CheckAnswer) {
    for (s, word) in shown(joined, a).iter().zip([a.rigid.verdict, a.translation]) {
        println!("{}: {word:?}: {s:?}", a.name);
        if word == Word::Locked {
            assert_eq!(s.arithmetic, Arithmetic::Exact, "{}", a.name);
            assert!(s.rank.is_some_and(|r| r > 0) && s.least_force.is_some_and(|f| f > 0.999), "{}", a.name);
        } else {
            assert!(s.arithmetic <= Arithmetic::RoundOff, "{}", a.name);
        }
    }
}

fn specs(folder: &str) -> Vec<PathBuf> {
    let all = std::fs::read_dir(support::root().join(folder))
        .expect("a folder")
        .map(|e| e.expect("an entry").path());
    let mut all: Vec<PathBuf> = all.filter(|p| p.extension().is_some_and(|e| e == "toml")).collect();
    all.sort();
    assert!(all.len() > 10, "only {} in {folder}", all.len());
    all
}

#[test]
fn every_fixture_is_verified() {
    for folder in ["fixtures/assemblies", "fixtures/assemblies/woven"] {
        for file in specs(folder) {
            let text = std::fs::read_to_string(&file).expect("UTF-8");
            let Ok(joined) = join(&spec(&file, &text)) else { continue };
            exactly(&joined, &answered(&joined, &file, &text));
        }
    }
}

/// The cases of others, each with who is held.
const CASES: [(&str, &[&str], Word); 7] = [
    ("bunny", &["part_1", "part_2"], Word::Locked),
    ("bunny", &["part_1"], Word::Free),
    ("cube9", &["part_1", "part_2"], Word::Locked),
    ("cube9", &["part_1"], Word::Free),
    ("roof", &["Boundary"], Word::Locked),
    ("frame14", &["piece0"], Word::Free),
    ("between-bars-3", &["piece0", "piece1"], Word::Free),
];

#[test]
fn every_case_of_others_is_verified() {
    for (name, held, verdict) in CASES {
        let folder = support::root().join("../shared/cases/topolite").join(name);
        let Ok(files) = std::fs::read_dir(&folder) else {
            println!("skipped: no {} beside this repository", folder.display());
            continue;
        };
        let mut names: Vec<String> =
            files.map(|f| f.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        let part = |f: &String| {
            let held = held.contains(&f.trim_end_matches(".obj"));
            format!("[[part]]\nmesh = \"{f}\"\nheld = {held}\n")
        };
        let parts: String = names.iter().map(part).collect();
        let text =
            format!("name = \"{name}\"\n{parts}[contact]\ntolerance = \"0.001 mm\"\n[size]\nunit = \"mm\"\n");
        let file = folder.join("test.toml");
        let joined = join(&spec(&file, &text)).unwrap_or_else(|f| panic!("{f}"));
        let a = answered(&joined, &file, &text);
        assert_eq!(a.rigid.verdict, verdict, "{name}");
        exactly(&joined, &a);
    }
}

#[test]
fn woven_swatches_are_verified() {
    for text in [window([1, 1, 1], 6, 6, 6), tiles([2, 2, 1], 6, 8, 2, 0), tiles([1, 1, 1], 6, 8, 2, 0)] {
        let joined = joined(&text);
        let verdict = check(&joined.assembly, &joined.patches, None);
        assert_eq!(verdict.rigid.word(), "locked");
        let still = vec![PartIx(0)];
        let proof = answer::proof(&joined.assembly, &still, &verdict.rigid);
        let c = proof.certificate.expect("a certificate");
        let s = certificate(&joined.assembly, &joined.patches, &c, About::RigidMotions).expect("a true one");
        assert_eq!((s.arithmetic, s.rank), (Arithmetic::Exact, Some(c.unknowns)));
    }
}

/// Equal forces on every corner of every patch; part 0 is still.
fn equal_forces(asm: &Assembly, patches: &[Patch], width: usize) -> Certificate {
    let force = |q: &Patch, p: DVec3| ForceAnswer {
        a: asm.part(q.a).id.clone(),
        b: asm.part(q.b).id.clone(),
        normal: q.normal.to_array(),
        point: p.to_array(),
        size: 1.0,
    };
    let forces = patches.iter().flat_map(|q| q.corners.iter().map(move |&p| force(q, p))).collect();
    let unknowns = (asm.parts.len() - 1) * width;
    let still = vec![asm.parts[0].id.clone()];
    Certificate { kind: "self-stress".into(), still, unknowns, rank: unknowns, residual: 0.0, forces }
}

/// A cube in four faces that are turned by 2^-digits, two each way, and two that are not: along y it is locked by the
/// turn alone. All numbers are dyadic, so the forces balance exactly.
fn nearly_loose(digits: i32) -> (Assembly, Vec<Patch>) {
    let e = 2f64.powi(-digits);
    let corners =
        |x: f64| [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)].map(|(s, t)| DVec3::new(x, s, t));
    let patch = |normal: DVec3, corners: Vec<DVec3>| Patch { a: PartIx(0), b: PartIx(1), normal, corners };
    let mut patches = Vec::new();
    for x in [1.0, -1.0] {
        for turn in [e, -e] {
            patches.push(patch(DVec3::new(-x, turn, 0.0), corners(x).to_vec()));
        }
        let flat = corners(x).map(|c| DVec3::new(c.z, c.y, c.x));
        patches.push(patch(DVec3::new(0.0, 0.0, -x), flat.to_vec()));
    }
    let cube: Vec<DVec3> = [1.0, -1.0].iter().flat_map(|&x| corners(x)).collect();
    (parts(vec![cube.clone(), cube], &[true, false]), patches)
}

#[test]
fn a_nearly_singular_lock_is_verified_exactly() {
    for digits in [10, 30, 40, 43] {
        let (asm, patches) = nearly_loose(digits);
        for (about, width) in [(About::Translations, 3), (About::RigidMotions, 6)] {
            let c = equal_forces(&asm, &patches, width);
            let s = certificate(&asm, &patches, &c, about).unwrap_or_else(|why| panic!("{digits}: {why}"));
            assert_eq!((s.arithmetic, s.rank), (Arithmetic::Exact, Some(width)));
            let bound = s.bound.expect("a bound");
            assert!(
                bound < 2f64.powi(-digits),
                "{digits}: proven for rows within {bound}, which could slide"
            );
        }
    }
}

/// The same lock by less than round-off, and by nothing at all.
#[test]
fn a_lock_by_less_than_round_off_is_refused() {
    for digits in [52, 60, 2000] {
        let (asm, patches) = nearly_loose(digits);
        let c = equal_forces(&asm, &patches, 3);
        let why = certificate(&asm, &patches, &c, About::Translations).expect_err("not a lock");
        assert!(why.contains("round-off") || why.contains("rank"), "{why}");
    }
}

/// A force that is off by a little leaves a lock that is true, but a certificate that does not balance.
#[test]
fn forces_that_miss_balance_by_little_are_refused() {
    let joined = joined(&window([1, 1, 1], 4, 2, 2));
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let verdict = check(asm, patches, None);
    let c = answer::proof(asm, &[PartIx(0)], &verdict.rigid).certificate.expect("a certificate");
    let valid = |c: &Certificate| certificate(asm, patches, c, About::RigidMotions).is_ok();
    assert!(valid(&c));
    for share in [1e-3, 1e-6, 1e-9] {
        let mut forged = c.clone();
        forged.forces[0].size *= 1.0 + share;
        assert!(!valid(&forged), "off by {share}");
    }
    let one_less = |k: usize| {
        let mut forged = c.clone();
        forged.forces.remove(k);
        forged
    };
    assert!((0..c.forces.len()).step_by(7).all(|k| !valid(&one_less(k))), "a force is missing");
    for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0, 1e308] {
        let mut forged = c.clone();
        forged.forces[0].size = bad;
        assert!(!valid(&forged), "a force of {bad}");
    }
}

/// Normals turned at random by less than the proven margin: whatever is found, it is never free.
#[test]
fn no_turn_within_the_margin_frees() {
    let mut dice = Dice::new(17);
    let names =
        ["block-in-case", "dovetail-stopped", "swirl-two-held", "taper-against-draft", "woven/plain-window"];
    for name in names {
        let file = support::root().join("fixtures/assemblies").join(format!("{name}.toml"));
        let text = std::fs::read_to_string(&file).expect("a fixture");
        let joined = join(&spec(&file, &text)).unwrap_or_else(|f| panic!("{f}"));
        let a = answered(&joined, &file, &text);
        for (margin, rigid) in
            [(&a.sampling.rigid.margin, true), (&a.sampling.translation_standing.margin, false)]
        {
            let margin = margin.as_ref().expect("a margin");
            let (lower, upper) = (margin.lower.expect("a bound"), margin.upper.expect("a bound"));
            assert!(0.0 < lower && lower <= upper, "{name}: {lower} to {upper}");
            for _ in 0..4 {
                let found = check(&joined.assembly, &turned(&joined.patches, lower, &mut dice), None);
                let found = if rigid { found.rigid } else { found.translation };
                assert!(!matches!(found, Verdict::Free(_)), "{name}, turned by up to {lower}");
            }
        }
    }
}

/// Every corner as a patch of its own, its normal turned about a random axis by just under the angle.
fn turned(patches: &[Patch], angle: f64, dice: &mut Dice) -> Vec<Patch> {
    let mut one = |q: &Patch, p: DVec3| {
        let any = DVec3::new(dice.signed(), dice.signed(), dice.signed());
        let across = q.normal.cross(any).normalize();
        let (s, c) = (0.999 * angle).sin_cos();
        Patch { normal: (q.normal * c + across * s).normalize(), corners: vec![p], ..q.clone() }
    };
    patches
        .iter()
        .flat_map(|q| q.corners.iter().map(|&p| (q, p)).collect::<Vec<_>>())
        .map(|(q, p)| one(q, p))
        .collect()
}

#[test]
fn facets_come_nearer_to_the_true_surfaces_with_more_samples() {
    let distance = |samples| {
        let joined = joined(&window([1, 1, 1], samples, 2, 2));
        let a = answered(&joined, Path::new("test.toml"), &window([1, 1, 1], samples, 2, 2));
        println!(
            "{samples}: {:?} rad, {:?} crossings, {:?}",
            a.sampling.chord_error, a.sampling.chord_distance, a.sampling.rigid
        );
        a.sampling.chord_distance.expect("a distance")
    };
    let [coarse, fine, finest] = [4, 8, 16].map(distance);
    // Beside ridges the distance shrinks with the step only, elsewhere with its square: two doublings make a quarter.
    assert!(fine < coarse && finest < fine && finest < coarse / 4.0, "{coarse} {fine} {finest}");
}

#[test]
fn the_plain_window_stands_under_refinement() {
    let text = window([1, 1, 1], 4, 2, 2);
    let found = refined(&spec(Path::new("test.toml"), &text)).unwrap_or_else(|f| panic!("{f}"));
    println!("{found:?}");
    assert_eq!(found.stands, Beyond::Holds, "{}", found.why);
    assert_eq!(found.levels.iter().map(|l| l.samples).collect::<Vec<_>>(), [4, 8]);
    assert!(found.levels.iter().all(|l| l.verdict == "locked"));
}

#[test]
fn meshes_have_nothing_to_refine() {
    let file = support::root().join("fixtures/assemblies/block-in-case.toml");
    let text = std::fs::read_to_string(&file).expect("a fixture");
    let found = refined(&spec(&file, &text)).unwrap_or_else(|f| panic!("{f}"));
    assert_eq!((found.levels.len(), found.stands), (0, Beyond::Holds));
}

/// As a user meets it: keys of the answer, and what verifying it says.
#[test]
fn a_refined_check_is_told_and_verified() {
    let room = Path::new(env!("CARGO_TARGET_TMPDIR")).join("exact");
    std::fs::create_dir_all(&room).expect("a folder");
    let run = |args: &[&str]| {
        let done = std::process::Command::new(env!("CARGO_BIN_EXE_weavelock"))
            .args(args)
            .current_dir(&room)
            .output();
        let done = done.expect("the program starts");
        (done.status.code(), String::from_utf8(done.stdout).expect("UTF-8"))
    };
    std::fs::write(room.join("window.toml"), window([1, 1, 1], 4, 2, 2)).expect("a file");
    let (code, text) = run(&["check", "window.toml", "--refine", "--json", "-q"]);
    assert_eq!(code, Some(0));
    let json: serde_json::Value = serde_json::from_str(&text).expect("one object");
    assert_eq!((&json["beyond_sampling"], &json["refine"]["stands"]), (&"holds".into(), &"holds".into()));
    assert!(json["margin"]["lower"].as_f64() < json["margin"]["upper"].as_f64());
    assert!(json["chord_error"].as_f64().is_some_and(|e| e > 0.0));
    std::fs::write(room.join("check.json"), &text).expect("a file");
    let (code, text) = run(&["verify", "check.json", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&text).expect("one object");
    assert_eq!((code, &json["valid"], &json["arithmetic"]), (Some(0), &true.into(), &"exact".into()));
    assert_eq!(json["proofs"]["rigid"]["rank"], 18);
    let (code, text) = run(&["check", "window.toml", "--refine"]);
    assert!(code == Some(0) && text.contains("under refinement"), "{text}");
}
