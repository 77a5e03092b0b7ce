//! Promises of the chirality stage: known hands, mirrored weaves, agreement of draft and solids, meshes.

use std::path::Path;
use weavelock::chirality::answer::{Handedness, Hands, WarpIs};
use weavelock::chirality::{of_assembly, of_weave};
use weavelock::contact::join;
use weavelock::spec::{Bounds, ProfileSpec, Shape, Syntax, parse};
use weavelock::weave::Weave;

fn profile(rise: f64, samples: u32) -> ProfileSpec {
    ProfileSpec { shape: Shape::Rise(rise), lift: 1.0, cover: 1.0, samples, bounds: Bounds::Sandwich }
}

fn weave(abc: (u32, u32, i32)) -> Weave {
    Weave::abc(abc.0, abc.1, abc.2).expect("in bounds")
}

fn hands(abc: (u32, u32, i32), profile: &ProfileSpec) -> Hands {
    of_weave(&weave(abc), profile).unwrap_or_else(|e| panic!("{abc:?}: {e}"))
}

fn words(abc: (u32, u32, i32), profile: &ProfileSpec) -> (Handedness, WarpIs) {
    let hands = hands(abc, profile);
    (hands.tile.expect("a weave has a tile"), hands.warp_is.expect("a weave has warps"))
}

fn assembly(toml: &str) -> Hands {
    let spec = parse(toml, Path::new("spec.toml"), Syntax::Toml).unwrap_or_else(|f| panic!("{f}"));
    let joined = join(&spec).unwrap_or_else(|f| panic!("{f}"));
    of_assembly(&spec, &joined).unwrap_or_else(|e| panic!("{e}"))
}

fn window(abc: &str, wefts: u32, warps: u32) -> String {
    format!(
        "[weave]\nabc = {abc}\n[profile]\nrise = 0.6\nsamples = 6\n[swatch]\nwefts = {wefts}\nwarps = {warps}\ncut = \"window\"\n"
    )
}

/// What follows from the draft by hand: phase 0 tiles of `[a,b,c]` are achiral where a = b or 2c = 0 (mod n).
fn by_hand((a, b, c): (u32, u32, i32)) -> (bool, bool, bool) {
    let n = (a + b) as i32;
    let is = |v: i32| v.rem_euclid(n) == 0;
    (a == b || is(2 * c), is(c * c - 1), is(c * c + 1))
}

#[test]
fn tiles_of_the_known_answers() {
    let at = profile(0.6, 8);
    assert_eq!(words((1, 1, 1), &at), (Handedness::Achiral, WarpIs::Both));
    assert_eq!(words((2, 2, 1), &at), (Handedness::Achiral, WarpIs::Both));
    assert!(matches!(words((3, 1, 1), &at), (Handedness::Left | Handedness::Right, WarpIs::Same)));
    assert!(matches!(words((4, 1, 2), &at), (Handedness::Left | Handedness::Right, WarpIs::Mirror)));
    assert!(matches!(words((7, 1, 3), &at), (Handedness::Left | Handedness::Right, WarpIs::Same)));
}

#[test]
fn solids_and_draft_agree_with_the_congruences() {
    for rise in [0.6, 0.0, 1.0, 0.35] {
        for n in 2..=6_u32 {
            for (a, c) in (1..n).flat_map(|a| (1..n as i32).map(move |c| (a, c))) {
                let abc = (a, n - a, c);
                let (achiral, same, mirror) = by_hand(abc);
                let (tile, warp) = words(abc, &profile(rise, 4));
                assert_ne!(
                    tile,
                    Handedness::Undecided,
                    "{abc:?} rise {rise}: {:#?}",
                    hands(abc, &profile(rise, 4))
                );
                assert_eq!(tile == Handedness::Achiral, achiral, "{abc:?} rise {rise}");
                // The congruences speak of warps that have the wefts' runs: one over and one under in a period.
                if a == 1 || n - a == 1 || same {
                    let both = (same && mirror) || (achiral && (same || mirror));
                    let expected = match (both, same, mirror) {
                        (true, ..) => WarpIs::Both,
                        (_, true, _) => WarpIs::Same,
                        (_, _, true) => WarpIs::Mirror,
                        _ => WarpIs::Different,
                    };
                    assert_eq!(warp, expected, "{abc:?} rise {rise}");
                }
            }
        }
    }
}

#[test]
fn mirrored_weaves_have_opposite_hands() {
    for (a, b, c) in [(3, 1, 1), (4, 1, 2), (7, 1, 3), (3, 2, 1), (2, 1, 1)] {
        let [here, there] = [c, -c].map(|c| words((a, b, c), &profile(0.6, 6)).0);
        assert!([here, there].contains(&Handedness::Left), "[{a},{b},{c}] {here:?} {there:?}");
        assert!([here, there].contains(&Handedness::Right), "[{a},{b},{c}] {here:?} {there:?}");
    }
}

#[test]
fn hands_stand_under_refinement() {
    for abc in [(3, 1, 1), (4, 1, 2), (3, 2, 1)] {
        let at = |samples| words(abc, &profile(0.6, samples));
        assert_eq!(at(6), at(8));
        assert_eq!(at(8), at(12));
    }
}

#[test]
fn found_isometries_are_exact_and_as_many_as_the_draft_has() {
    for abc in [(1, 1, 1), (2, 2, 1), (3, 1, 2), (3, 1, 1)] {
        let hands = hands(abc, &profile(0.6, 8));
        for tile in &hands.tiles {
            let e = &tile.hand.evidence;
            assert_eq!(Some(e.isometries.len()), e.draft.as_ref().map(Vec::len), "{abc:?} {}", tile.strand);
            assert!(e.isometries.iter().all(|i| i.residual <= e.within && e.within < 1e-9), "{abc:?}");
        }
    }
}

#[test]
fn heights_off_the_grid_are_still_decided() {
    for lift in [0.7, 1.1, 1.0 / 3.0 + 0.5] {
        let at = ProfileSpec { lift, ..profile(0.6, 8) };
        assert_eq!(words((2, 2, 1), &at), (Handedness::Achiral, WarpIs::Both), "lift {lift}");
        assert!(matches!(words((3, 1, 1), &at), (Handedness::Left | Handedness::Right, WarpIs::Same)));
    }
}

#[test]
fn plain_windows_have_a_hand_and_their_mirror_image_the_other() {
    let here = assembly(&window("[1, 1, 1]", 2, 2));
    // The same crossings with over and under exchanged.
    let there = assembly(&window("[1, 1, 1]", 2, 2).replace("abc = [1, 1, 1]", "draft = [\".X\", \"X.\"]"));
    let measures = [&here, &there].map(|h| h.assembly_evidence.as_ref().and_then(|e| e.measure.clone()));
    println!("{measures:?}");
    let hands = [here.assembly, there.assembly];
    assert!(hands.contains(&Some(Handedness::Left)) && hands.contains(&Some(Handedness::Right)), "{hands:?}");
    assert_eq!(here.tile, Some(Handedness::Achiral));
}

#[test]
fn windows_with_a_mirror_are_achiral() {
    let hands = assembly(&window("[1, 1, 1]", 3, 2));
    assert_eq!(hands.assembly, Some(Handedness::Achiral), "{:?}", hands.assembly_evidence);
}

#[test]
fn the_answer_survives_json() {
    let hands = hands((3, 1, 1), &profile(0.6, 6));
    println!("{:?}", hands.tiles[0].hand.measure);
    let text = serde_json::to_string(&hands).expect("serializes");
    assert_eq!(serde_json::from_str::<Hands>(&text).expect("reads"), hands);
}
