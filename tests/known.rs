//! Cases whose answers were computed or published elsewhere: verdicts, starts and plans of small swatches.

use crate::support::{joined, starts, tiles, window, words};
use weavelock::assembly::PartIx;
use weavelock::contact::Joined;
use weavelock::locking::check_some;
use weavelock::sequence::{Outcome, Plan, plan, plan_of};
use weavelock::verify::plan::{Checked, check_of};

/// A swatch, the starts of wefts then warps, the words for translation and rigid motions.
struct Known {
    text: fn(u32) -> String,
    starts: &'static [i32],
    words: (&'static str, &'static str),
}

const KNOWN: [Known; 8] = [
    Known { text: |s| window([1, 1, 1], s, 2, 2), starts: &[0, 0, 0, 0], words: ("locked", "locked") },
    Known { text: |s| tiles([1, 1, 1], s, 2, 1, 0), starts: &[0, -1, -1, 0], words: ("free", "free") },
    Known { text: |s| tiles([1, 1, 1], s, 2, 2, 0), starts: &[-2, -1, -1, -2], words: ("locked", "locked") },
    Known {
        text: |s| tiles([2, 2, 1], s, 4, 1, 0),
        starts: &[0, 1, -2, -1, 1, -2, -1, 0],
        words: ("free", "free"),
    },
    Known {
        text: |s| tiles([2, 2, 1], s, 4, 1, 1),
        starts: &[1, -2, -1, 0, -2, -1, 0, 1],
        words: ("locked", "free"),
    },
    Known {
        text: |s| tiles([2, 2, 1], s, 4, 2, 0),
        starts: &[-4, -3, -2, -1, -3, -2, -1, -4],
        words: ("locked", "locked"),
    },
    Known {
        text: |s| tiles([7, 1, 3], s, 8, 1, 0),
        starts: &[0, 3, -2, 1, -4, -1, 2, -3, 3, -2, 1, -4, -1, 2, -3, 0],
        words: ("free", "free"),
    },
    Known {
        text: |s| tiles([7, 1, 3], s, 8, 2, 0),
        starts: &[-8, -5, -2, -7, -4, -1, -6, -3, -5, -2, -7, -4, -1, -6, -3, -8],
        words: ("locked", "locked"),
    },
];

fn verdicts_at(samples: u32) {
    for known in &KNOWN {
        let text = (known.text)(samples);
        let joined = joined(&text);
        assert_eq!(starts(&joined), known.starts, "{text}");
        assert_eq!(words(&joined.assembly, &joined.patches), known.words, "{text}");
    }
}

#[test]
fn verdicts_at_6_samples() {
    verdicts_at(6);
}

#[test]
fn verdicts_at_8_samples() {
    verdicts_at(8);
}

#[test]
fn verdicts_at_12_samples() {
    verdicts_at(12);
}

fn locked(joined: &Joined, parts: &[PartIx]) -> Option<()> {
    (check_some(&joined.assembly, &joined.patches, parts).word() == "locked").then_some(())
}

/// The plan for some parts, held against the checker of plans.
fn planned(joined: &Joined, parts: &[PartIx]) -> Plan<()> {
    let plan = plan_of(&joined.assembly, parts, &joined.patches, |set| locked(joined, set)).expect("cells");
    let checked = check_of(&joined.assembly, parts, &plan);
    assert!(matches!(checked, Checked::Valid { .. }), "{checked:?}\n{plan:#?}");
    plan
}

fn comes_apart_by_single_parts(joined: &Joined, about: &str) {
    let all: Vec<PartIx> = joined.assembly.ids().collect();
    let plan = planned(joined, &all);
    assert_eq!(plan.outcome, Outcome::Assembled, "{about}\n{plan:#?}");
    assert!(plan.steps.iter().all(|s| s.parts.len() == 1), "{about}\n{plan:#?}");
    assert_eq!(plan.steps.len(), all.len() - 1, "{about}");
}

#[test]
fn four_plain_tiles_around_a_hole_need_a_flexible_part() {
    let joined = joined(&window([1, 1, 1], 8, 2, 2));
    let plan = plan(&joined.assembly, &joined.patches, |set| locked(&joined, set)).expect("cells");
    assert_eq!(plan.outcome, Outcome::NeedsFlexible, "{plan:#?}");
    assert!(plan.steps.is_empty(), "nothing can leave: {plan:#?}");
    assert_eq!(plan.stuck.len(), 1);
    assert_eq!(plan.stuck[0].parts.len(), 4);
}

#[test]
fn any_three_of_four_plain_tiles_come_apart() {
    let joined = joined(&window([1, 1, 1], 8, 2, 2));
    for left_out in joined.assembly.ids() {
        let three: Vec<PartIx> = joined.assembly.ids().filter(|&p| p != left_out).collect();
        assert_eq!(check_some(&joined.assembly, &joined.patches, &three).word(), "free");
        assert_eq!(planned(&joined, &three).outcome, Outcome::Assembled, "without {left_out:?}");
    }
}

/// Twill unit tiles, said to come apart too, catch on corner lips at zero clearance: `plan` has their tests.
#[test]
fn plain_unit_tiles_come_apart_one_by_one() {
    let text = tiles([1, 1, 1], 8, 2, 1, 0);
    comes_apart_by_single_parts(&joined(&text), &text);
}

/// Locked by corner lips of a hundredth of the pitch: true at zero clearance, and no workshop could make it.
#[test]
fn three_twill_pieces_are_locked_by_their_corner_lips() {
    let joined = joined(&window([2, 2, 1], 8, 4, 4));
    let part = |id: &str| joined.assembly.ids().find(|&p| joined.assembly.part(p).id == id).expect("an id");
    let three = ["weft-1", "weft-2", "warp-0"].map(part);
    assert_eq!(check_some(&joined.assembly, &joined.patches, &three).word(), "locked");
}
