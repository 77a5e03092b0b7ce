//! Plans of woven assemblies, as a file would describe them.

use super::*;
use std::path::Path;
use weavelock::assembly::PartIx;
use weavelock::contact::{Joined, join};
use weavelock::locking::{Verdict, check_some};
use weavelock::sequence::{Ends, Motions, plan_by, plan_of};
use weavelock::spec::{Syntax, parse};
use weavelock::verify::plan::check_of;

fn read(text: &str) -> Joined {
    let file = Path::new("woven.toml");
    let spec = parse(text, file, Syntax::of(file, text)).expect("a good file");
    join(&spec).expect("an assembly")
}

fn swatch(abc: [i32; 3], size: u32, cut: &str, samples: u32) -> Joined {
    read(&format!(
        "name = 'x'\n[weave]\nabc = {abc:?}\n[profile]\nrise = 0.6\nlift = 1.0\ncover = 1.0\nsamples = {samples}\n\
         [swatch]\nwefts = {size}\nwarps = {size}\ncut = '{cut}'\n[size]\npitch = '20 mm'\n"
    ))
}

fn planned(joined: &Joined, parts: &[PartIx]) -> Plan<()> {
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let lock = |set: &[PartIx]| matches!(check_some(asm, patches, set), Verdict::Locked(_)).then_some(());
    let p = plan_of(asm, parts, patches, lock).expect("sane parts");
    match check_of(asm, parts, &p) {
        Checked::Valid { clear, deepest } => assert!(clear == 0.0 && deepest < 1e-9, "{clear} {deepest}"),
        bad => panic!("own plan refused: {bad:?}\n{p:#?}"),
    }
    p
}

fn all(joined: &Joined) -> Vec<PartIx> {
    joined.assembly.ids().collect()
}

fn by_single_parts(joined: &Joined) {
    let p = planned(joined, &all(joined));
    assert_eq!(p.outcome, Outcome::Assembled, "{p:#?}");
    assert_eq!(p.steps.len(), joined.assembly.parts.len() - 1);
    assert!(p.steps.iter().all(|s| s.parts.len() == 1), "{p:#?}");
}

#[test]
fn plain_unit_tiles_come_apart_one_by_one() {
    for samples in [6, 8, 12] {
        by_single_parts(&swatch([1, 1, 1], 2, "tiles", samples));
    }
}

fn pieces(abc: [i32; 3], length: i32, samples: u32, wefts: &[i32], warps: &[i32]) -> Joined {
    let mut text = format!(
        "name = 'x'\n[weave]\nabc = {abc:?}\n[profile]\nsamples = {samples}\n[size]\npitch = '20 mm'\n"
    );
    for (kind, starts) in [("weft", wefts), ("warp", warps)] {
        for (k, s) in starts.iter().enumerate() {
            text += &format!("[[piece]]\n{kind} = {k}\nfrom = {s}\nto = {}\n", s + length);
        }
    }
    read(&text)
}

/// Which cut is taken matters: with one choice single parts can go in turn, with another a pair must go first.
#[test]
fn nine_crossings_of_plain_tiles_come_apart() {
    by_single_parts(&pieces([1, 1, 1], 2, 8, &[0, -1, 0], &[-1, 0, -1]));
    let twin = pieces([1, 1, 1], 2, 8, &[0, 1, 0], &[1, 0, 1]);
    let p = planned(&twin, &all(&twin));
    assert_eq!((p.outcome, p.steps[0].parts.len()), (Outcome::Assembled, 2), "{p:#?}");
}

/// Coarse twill tiles come apart. Finer ones catch on corner lips, about 0.02 of the pitch deep, that lock five
/// of the eight when there is no clearance at all (found with Qhull and HiGHS too).
#[test]
fn twill_unit_tiles_come_apart_unless_lips_lock_them() {
    let at = |samples| pieces([2, 2, 1], 4, samples, &[0, 1, -2, -1], &[1, -2, -1, 0]);
    for coarse in [2, 3].map(at) {
        assert_eq!(planned(&coarse, &all(&coarse)).outcome, Outcome::Assembled);
    }
    let fine = at(8);
    let p = planned(&fine, &all(&fine));
    assert_eq!(p.outcome, Outcome::NeedsFlexible, "{p:#?}");
    assert_eq!(p.stuck[0].parts, ["weft-0", "weft-1", "warp-1", "warp-2", "warp-3"]);
}

/// A fiftieth of the pitch is enough to lift every twill tile over the lips, one by one; with half of that
/// some must go together first.
#[test]
fn twill_unit_tiles_with_clearance_come_apart_one_by_one() {
    use weavelock::sequence::clearance::with_clearance;
    let tight = pieces([2, 2, 1], 4, 6, &[0, 1, -2, -1], &[1, -2, -1, 0]);
    let at = |clearance: f64| {
        let loose = with_clearance(&tight.assembly, &tight.patches, clearance).expect("something is left");
        let p = plan(&loose, &[], |_| None::<()>).expect("sane parts");
        assert!(matches!(check(&loose, &p), Checked::Valid { .. }), "{:?}", check(&loose, &p));
        p
    };
    let p = at(0.025);
    assert_eq!((p.outcome, p.steps.len()), (Outcome::Assembled, 7));
    assert!(p.steps.iter().all(|s| s.parts.len() == 1 && s.clear > 0.0), "{p:#?}");
    let p = at(0.01);
    assert_eq!(p.outcome, Outcome::Assembled);
    assert!(p.steps[0].parts.len() > 1, "{p:#?}");
}

#[test]
fn no_clearance_changes_nothing_and_too_much_leaves_nothing() {
    use weavelock::sequence::clearance::{NoClearance, with_clearance};
    let joined = swatch([1, 1, 1], 2, "window", 6);
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let same = with_clearance(asm, patches, 0.0).expect("all is left");
    let p = plan(&same, patches, |_| None::<()>).expect("sane parts");
    assert!(matches!(check(&same, &p), Checked::Valid { .. }), "{:?}", check(&same, &p));
    assert_eq!((p.outcome, p.stuck[0].parts.len()), (Outcome::NotFound, 4));
    for wrong in [-0.1, f64::NAN, f64::INFINITY] {
        assert!(matches!(with_clearance(asm, patches, wrong), Err(NoClearance::NoLength(_))));
    }
    assert!(matches!(with_clearance(asm, patches, 5.0), Err(NoClearance::NothingLeft(_))));
}

#[test]
fn a_large_plain_swatch_comes_apart() {
    let joined = swatch([1, 1, 1], 6, "tiles", 6);
    assert_eq!(planned(&joined, &all(&joined)).outcome, Outcome::Assembled);
}

#[test]
fn the_plain_window_is_locked_and_any_three_of_it_come_apart() {
    let joined = swatch([1, 1, 1], 2, "window", 8);
    let p = planned(&joined, &all(&joined));
    assert_eq!(p.outcome, Outcome::NeedsFlexible);
    assert_eq!((p.stuck[0].parts.len(), p.stuck[0].straight_moves), (4, weavelock::sequence::Straight::None));
    for left_out in 0..4 {
        let three: Vec<PartIx> = all(&joined).into_iter().filter(|p| p.at() != left_out).collect();
        let p = planned(&joined, &three);
        assert_eq!((p.outcome, p.steps.len()), (Outcome::Assembled, 2), "without {left_out}: {p:#?}");
    }
}

/// Locked for shifts, not for turns (k = 1, phase 1): with tens of thousands of rows the turns are searched all the same.
/// Three tiles turn out; what is left has not moved and is locked, so its proof holds.
#[test]
#[ignore = "half a minute"]
fn twill_tiles_that_only_turns_can_open_are_turned_as_far_as_they_go() {
    let joined = read(
        "name = 'x'\n[weave]\nabc = [2, 2, 1]\n[profile]\nrise = 0.6\nlift = 1.0\ncover = 1.0\nsamples = 8\n[swatch]\n\
         wefts = 4\nwarps = 4\ncut = 'tiles'\nphase = 1\n",
    );
    let lock = |set: &[PartIx]| {
        matches!(check_some(&joined.assembly, &joined.patches, set), Verdict::Locked(_)).then_some(())
    };
    let all = all(&joined);
    let p = plan_by(&joined.assembly, &all, &joined.patches, Motions::Any, lock).expect("sane parts");
    assert!(p.searched.programs > 0, "turns were followed: {:?}", p.searched);
    let turns = p.steps.iter().filter(|s| !matches!(s.motion, Motion::Translation(_))).count();
    let apart = p.steps.iter().filter(|s| s.ends == Ends::Apart).count();
    assert!(turns > 0 && apart == 3, "{p:#?}");
    assert_eq!(p.outcome, Outcome::NeedsFlexible);
    assert_eq!(p.stuck.iter().map(|s| (s.parts.len(), s.lock)).collect::<Vec<_>>(), [(5, Some(()))]);
    let checked = check_of(&joined.assembly, &all, &p);
    assert!(matches!(checked, Checked::Valid { .. }), "{checked:?}");
}
