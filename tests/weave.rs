//! Promises of the weave stage: conventions, periods, families, hanging together, WIF.

use std::path::{Path, PathBuf};
use weavelock::weave::{
    Draft, Family, Float, Hand, Hanging, Kind, Origin, Strand, Weave, family, floats, hangs_together,
    parse_drawn, parse_wif, svg, terminal, to_wif,
};

fn fixture(name: &str) -> Weave {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/weaves").join(name);
    Weave::read(&path).unwrap_or_else(|faults| panic!("{faults}"))
}

fn abc(a: u32, b: u32, c: i32) -> Draft {
    Weave::abc(a, b, c).expect("in bounds").draft
}

fn drawn(rows: &[&str]) -> Draft {
    Draft::drawn(rows).expect("well drawn")
}

/// All drafts drawn on `wefts` x `warps` crossings.
fn all_drafts(wefts: u32, warps: u32) -> impl Iterator<Item = Draft> {
    (0..1u32 << (wefts * warps)).map(move |bits| {
        let mark = |j: u32, i: u32| if bits >> (j * warps + i) & 1 == 1 { 'X' } else { '.' };
        let rows: Vec<String> = (0..wefts).map(|j| (0..warps).map(|i| mark(j, i)).collect()).collect();
        drawn(&rows.iter().map(String::as_str).collect::<Vec<_>>())
    })
}

#[test]
fn abc_follows_the_formula_at_any_index() {
    for (a, b, c) in
        [(1, 1, 1), (2, 2, 1), (7, 1, 3), (3, 3, 2), (6, 7, 4), (2, 3, -1), (1, 2, 0), (64, 64, 127)]
    {
        let (draft, n) = (abc(a, b, c), (a + b) as i32);
        for (j, i) in (-2 * n..2 * n).flat_map(|j| (-2 * n..2 * n).map(move |i| (j, i))) {
            let over = (i - c * j).rem_euclid(n) < a as i32;
            assert_eq!(draft.weft_over(j, i), over, "[{a},{b},{c}] at weft {j}, warp {i}");
            assert_eq!(draft.is_over(Strand { kind: Kind::Warp, index: i }, j), !over);
        }
    }
    assert!(
        abc(3, 4, i32::MIN).weft_over(i32::MIN, i32::MAX)
            == abc(3, 4, i32::MIN).weft_over(i32::MIN, i32::MAX - 7)
    );
}

#[test]
fn periods_are_least() {
    let sizes = |d: Draft| (d.wefts(), d.warps());
    assert_eq!(sizes(abc(3, 3, 2)), (3, 6));
    assert_eq!(sizes(abc(2, 2, 0)), (1, 4));
    assert_eq!(sizes(drawn(&["X.X.", ".X.X", "X.X."])), (3, 2));
    assert_eq!(sizes(drawn(&["XXX", "XXX"])), (1, 1));
    assert_eq!(abc(1, 1, 1), drawn(&["X.X.X.", ".X.X.X"]));
    assert_eq!(abc(2, 2, 1), abc(2, 2, 5));
}

#[test]
fn families_by_name() {
    let twill = |hand, runs: &[u32]| Family::Twill { hand, runs: runs.to_vec() };
    assert_eq!(family(&abc(1, 1, 1)), Family::Plain);
    assert_eq!(family(&abc(2, 2, 1)), twill(Hand::Z, &[2, 2]));
    assert_eq!(family(&abc(3, 1, -1)), twill(Hand::S, &[3, 1]));
    assert_eq!(family(&abc(1, 2, 2)), twill(Hand::S, &[1, 2]));
    assert_eq!(family(&abc(7, 1, 3)), Family::Satin { step: 3, face: Kind::Weft });
    assert_eq!(family(&abc(1, 4, 2)), Family::Satin { step: 2, face: Kind::Warp });
    assert_eq!(family(&abc(5, 1, 2)), Family::Other, "step 2 is not prime to 6");
    assert_eq!(family(&abc(6, 7, 4)), Family::Other);
    assert_eq!(family(&drawn(&["XX.X.", ".XX.X", "X.XX.", ".X.XX", "X.X.X"])), twill(Hand::Z, &[2, 1, 1, 1]));
    assert_eq!(family(&drawn(&["XX", "XX"])), Family::Other);
    let names = [(1, 1, 1), (2, 2, 1), (3, 1, -1), (7, 1, 3), (6, 7, 4)]
        .map(|(a, b, c)| family(&abc(a, b, c)).to_string());
    assert_eq!(names, ["plain", "twill Z 2/2", "twill S 3/1", "satin, step 3, weft face", "other"]);
    assert_eq!(family(&fixture("satin-4-irregular.draft").draft), Family::Other);
}

/// A family is a property of the cloth, not of where its draft begins; and mirroring a twill changes its hand.
#[test]
fn families_survive_shifting_and_mirroring() {
    for (a, b, c) in (1..6).flat_map(|a| (1..6).flat_map(move |b| (-6..7).map(move |c| (a, b, c)))) {
        let there = abc(a, b, c);
        let shifted = redrawn(&there, |j, i| (j + 3, i + 5));
        assert_eq!(family(&there), family(&shifted), "[{a},{b},{c}]");
        match (family(&there), family(&redrawn(&there, |j, i| (j, -1 - i)))) {
            (Family::Twill { hand, .. }, Family::Twill { hand: mirrored, .. }) => assert_ne!(hand, mirrored),
            (Family::Satin { step, face }, Family::Satin { step: other, face: same }) => {
                assert_eq!((step + other, face), (there.warps(), same));
            }
            (one, two) => assert_eq!(one, two),
        }
    }
}

fn redrawn(draft: &Draft, from: impl Fn(i32, i32) -> (i32, i32)) -> Draft {
    let mark = |j, i| if draft.weft_over(from(j, i).0, from(j, i).1) { 'X' } else { '.' };
    let (wefts, warps) = (draft.wefts() as i32, draft.warps() as i32);
    let rows: Vec<String> = (0..wefts).map(|j| (0..warps).map(|i| mark(j, i)).collect()).collect();
    drawn(&rows.iter().map(String::as_str).collect::<Vec<_>>())
}

#[test]
fn floats_are_the_longest_runs() {
    let f = floats(&abc(7, 1, 3));
    assert_eq!((f.weft_over, f.weft_under), (Float::Crossings(7), Float::Crossings(1)));
    assert_eq!((f.warp_over, f.warp_under), (Float::Crossings(1), Float::Crossings(7)));
    let f = floats(&drawn(&["XX.", "XXX"]));
    assert_eq!((f.weft_over, f.weft_under), (Float::Endless, Float::Crossings(1)));
    assert_eq!((f.warp_over, f.warp_under), (Float::Crossings(1), Float::Endless));
    assert_eq!(floats(&drawn(&["X"])).warp_over, Float::Absent);
    assert_eq!(floats(&drawn(&["X..X"])).weft_over, Float::Crossings(2), "runs go on around the period");
}

/// The paper's condition (c prime to a + b) is enough for a weave to hang together...
#[test]
fn coprime_weaves_hang_together() {
    assert_eq!(hangs_together(&abc(6, 7, 4)), Hanging::Together);
    for (a, b, c) in (1..9u32).flat_map(|a| (1..9u32).flat_map(move |b| (1..9u32).map(move |c| (a, b, c)))) {
        let weave = Weave::abc(a, b, c as i32).expect("in bounds");
        if weave.common_divisor() == Some(1) {
            assert_eq!(hangs_together(&weave.draft), Hanging::Together, "[{a},{b},{c}]");
        }
    }
}

/// ... but not needed. [2,2,2] is plain weave with doubled warps. [3,3,2], which the paper's figure 5 names as one that
/// falls apart, has no set of strands that lifts off either: all 510 are tried. [5,1,2] does fall apart.
#[test]
fn weaves_that_share_a_divisor_may_hang_together() {
    assert_eq!(hangs_together(&abc(2, 2, 2)), Hanging::Together);
    let paper = abc(3, 3, 2);
    assert!(!lifts_by_brute_force(&paper, paper.wefts() as i32, paper.warps() as i32));
    assert_eq!(hangs_together(&paper), Hanging::Together);
    let Hanging::FallsApart { lifts } = hangs_together(&abc(5, 1, 2)) else { panic!("[5,1,2] falls apart") };
    assert_lifts(&abc(5, 1, 2), &lifts);
    let Hanging::FallsApart { lifts } = hangs_together(&drawn(&["XXX", "XX.", "X.X"])) else {
        panic!("weft 0 lifts")
    };
    assert_eq!(lifts, [Strand { kind: Kind::Weft, index: 0 }]);
}

/// Some strands lift, not all, and no strand that stays lies over one that lifts, in the infinite fabric.
fn assert_lifts(draft: &Draft, lifts: &[Strand]) {
    let all: Vec<Strand> = draft.strands(Kind::Weft).chain(draft.strands(Kind::Warp)).collect();
    assert!(!lifts.is_empty() && lifts.len() < all.len(), "{lifts:?}");
    let stays = |s: &&Strand| !lifts.contains(s);
    for (up, down) in lifts.iter().flat_map(|up| all.iter().filter(stays).map(move |down| (up, down))) {
        assert!(up.kind == down.kind || draft.is_over(*up, down.index), "{down} lies over {up}");
    }
}

/// Against all subsets of strands, on drafts repeated twice each way: that residues decide is part of the claim.
#[test]
fn hanging_together_agrees_with_all_subsets() {
    for draft in all_drafts(2, 2).chain(all_drafts(2, 3)).chain(all_drafts(3, 3)) {
        let brute = lifts_by_brute_force(&draft, 2 * draft.wefts() as i32, 2 * draft.warps() as i32);
        match hangs_together(&draft) {
            Hanging::Together => assert!(!brute, "{:?}", draft.rows()),
            Hanging::FallsApart { lifts } => {
                assert!(brute, "{:?}", draft.rows());
                assert_lifts(&draft, &lifts);
            }
        }
    }
}

/// Whether some set of the strands, neither empty nor everything, lies over all others.
fn lifts_by_brute_force(draft: &Draft, wefts: i32, warps: i32) -> bool {
    let lifts_off = |set: u32| {
        let (weft_in, warp_in) = (|j: i32| set >> j & 1 == 1, |i: i32| set >> (wefts + i) & 1 == 1);
        let held_by = |j, i| weft_in(j) != warp_in(i) && weft_in(j) != draft.weft_over(j, i);
        (0..wefts).all(|j| (0..warps).all(|i| !held_by(j, i)))
    };
    (1..(1u32 << (wefts + warps)) - 1).any(lifts_off)
}

#[test]
fn wif_files_weave_what_they_say() {
    assert_eq!(fixture("plain.wif").draft, drawn(&["X.", ".X"]));
    assert_eq!(fixture("plain.wif").tile, (2, 2));
    assert_eq!(fixture("twill-2-2-sinking.wif").draft, abc(2, 2, 1));
    assert_eq!(fixture("twill-2-2.draft").draft, abc(2, 2, 1));
    let satin = fixture("satin-5-liftplan.wif");
    assert_eq!(satin.draft.rows(), ["XXXX.", "X.XXX", "XXX.X", ".XXXX", "XX.XX"]);
    assert_eq!(family(&satin.draft), Family::Satin { step: 2, face: Kind::Weft });
    assert!(matches!(satin.origin, Origin::Wif(_)));
    assert_eq!(fixture("blank-entries.wif").draft.rows(), [".XX", "XXX", "X.X"]);
}

#[test]
fn wif_round_trips() {
    let drafts = all_drafts(3, 3).chain([abc(64, 64, 63), abc(7, 1, 3), abc(3, 3, 2)]);
    for draft in drafts {
        let wif = to_wif(&draft, "a title\nwith a break; [and] = more");
        let back = parse_wif(&wif, &PathBuf::from("written.wif")).unwrap_or_else(|f| panic!("{f}\n{wif}"));
        assert_eq!(back.draft, draft, "{wif}");
        let rows = draft.rows().join("\n");
        assert_eq!(parse_drawn(&rows, Path::new("")).expect("drawn").draft, draft);
    }
}

#[test]
fn weaves_on_the_command_line() {
    let weave = |text: &str| Weave::parse_abc(text).map(|w| w.origin);
    for text in ["[2,2,1]", "2,2,1", " [ 2, 2 ,1 ] "] {
        assert_eq!(weave(text), Ok(Origin::Abc { a: 2, b: 2, c: 1 }), "{text}");
    }
    for text in
        ["", "[]", "[1,1]", "[1,1,1,1]", "[1.5,1,1]", "[-1,2,1]", "[0,2,1]", "[65,2,1]", "1;1;1", "[NaN,1,1]"]
    {
        assert!(weave(text).is_err(), "{text}");
    }
    assert_eq!(Weave::abc(0, 65, 1).map_err(|f| f.0.len()), Err(2), "both faults at once");
}

#[test]
fn terminal_drawing_shows_the_draft() {
    let drawing = terminal(&abc(2, 2, 1), 80);
    let lines: Vec<&str> = drawing.lines().collect();
    assert_eq!(lines[0], "   7  ══┃┃┃┃══ ══┃┃┃┃══");
    assert_eq!(lines[4], "     ┌────────┐");
    assert_eq!(lines[8], "   0 │════┃┃┃┃│════┃┃┃┃");
    assert_eq!(lines[9], "     └────────┘");
    assert_eq!(lines[10], "       0 1 2 3  4 5 6 7");
    for (draft, width) in
        [(abc(64, 64, 63), 60), (abc(64, 64, 1), 0), (abc(1, 1, 1), 1), (drawn(&["X"]), 300)]
    {
        let drawing = terminal(&draft, width);
        let drawn = drawing.lines().filter(|line| !line.contains("weft over"));
        assert!(drawn.map(|line| line.chars().count()).max() <= Some(width.max(9)), "{drawing}");
    }
    assert!(terminal(&abc(64, 64, 63), 60).contains("only a part"));
}

#[test]
fn svg_has_a_mark_for_each_crossing() {
    for draft in [abc(1, 1, 1), abc(7, 1, 3), abc(3, 3, 2)] {
        let picture = svg(&draft);
        let paper = picture.split("point-paper").nth(1).expect("it has a point paper");
        let (filled, blank) =
            (paper.matches("#222222\" stroke").count(), paper.matches("#ffffff\" stroke").count());
        let overs = draft.rows().concat().matches('X').count();
        assert_eq!(filled * draft.rows().concat().len(), overs * (filled + blank));
        assert!(filled + blank >= 64);
    }
    assert!(svg(&abc(64, 64, 63)).contains("larger than this picture"));
}

/// Real files say `LIFTPLAN=no`, leave values blank, write 0 for none, and promise colors that they lack.
#[test]
fn wif_files_of_other_programs_are_read() {
    let head =
        "\n[WIF]\n[Version=1.1]\nDate=today\n[CONTENTS]\nWARP COLORS=true\nTIEUP=true\nLIFTPLAN=false\n";
    let loom = "[WEAVING]\nTreadles=6\nShafts=4\n[WARP]\nThreads=5\nUnits=centimeters\n[WEFT]\nThreads=6\n";
    let draft = "[THREADING]\n1=2\n2=3\n3=4\n4=\n5=1\n[TIEUP]\n1=1,3\n2=2,4\n3=1\n4=2\n5=3\n6=4\n\
                 [TREADLING]\n1=1,6\n2=5\n3=2,3,4\n4=0,1,4\n5=5,6\n6=3\n[LIFTPLAN]\n";
    let read =
        |shed: &str| parse_wif(&format!("{head}{loom}{shed}{draft}"), Path::new("")).map(|w| w.draft.rows());
    let rows = ["X..X.", "X.XXX", ".X.X.", "..XX.", "X..XX", "XXXX."];
    assert_eq!(read("").expect("rising"), rows);
    let other: Vec<String> =
        rows.iter().map(|row| row.chars().map(|c| if c == 'X' { '.' } else { 'X' }).collect()).collect();
    // A thread on no shaft stays down in a rising shed; in a sinking one it stays up.
    let sinking = format!("{head}{}{draft}", loom.replace("Shafts=4\n", "Shafts=4\nRising Shed=no\n"));
    assert_eq!(parse_wif(&sinking, Path::new("")).expect("sinking").draft.rows(), other);
}

/// The largest draft that is taken, of random crossings: every question is answered, in a time that a person waits.
#[test]
fn the_largest_draft_is_dealt_with() {
    let mut state = 1u64;
    let mut mark = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        if state >> 63 == 1 { 'X' } else { '.' }
    };
    let rows: Vec<String> = (0..512).map(|_| (0..512).map(|_| mark()).collect()).collect();
    let start = std::time::Instant::now();
    let draft = drawn(&rows.iter().map(String::as_str).collect::<Vec<_>>());
    assert_eq!((draft.wefts(), draft.warps(), family(&draft)), (512, 512, Family::Other));
    assert_eq!(hangs_together(&draft), Hanging::Together);
    assert_eq!(parse_wif(&to_wif(&draft, ""), Path::new("")).expect("written").draft, draft);
    println!("512 x 512: {:?}", start.elapsed());
    assert!(Draft::drawn(&vec!["X"; 513]).is_err() && Draft::drawn(&[&"X".repeat(513)]).is_err());
}
