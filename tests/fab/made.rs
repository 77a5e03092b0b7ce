//! Parts made otherwise: carved, by several routes, shaved; and what is told of their walls.

use super::*;

/// The exact move makes this tile cross itself: each part is made by the fallback with its gaps kept, or it is told.
#[test]
#[ignore = "half a minute"]
fn where_the_exact_move_fails_a_part_is_carved_or_told() {
    let job = woven("[1, 5, 3]", "wefts = 6\nwarps = 6\ncut = \"tiles\"", 6, 0.0);
    let report = made(&job, &recipe(0.2));
    for p in report.parts.iter().filter(|p| p.file.is_none()) {
        let told = |f: &weavelock_fab::report::Finding| {
            f.severity == Severity::Error && f.place.parts.contains(&p.id) && !f.remedy.is_empty()
        };
        assert!(report.findings.iter().any(told), "{} is not told", p.id);
    }
    assert!(report.parts.iter().any(|p| p.file.is_some()));
}

#[test]
fn parts_by_different_routes_have_their_own_scale_and_fit_when_finished() {
    let job = woven("[1, 1, 1]", "wefts = 2\nwarps = 2\ncut = \"window\"", 6, 0.6);
    let parts =
        [("weft-0", "silicone-platinum"), ("warp-0", "aluminium-lost-wax"), ("warp-1", "wax-injected")]
            .map(|(id, name)| (id.to_string(), Process::find(name).unwrap()));
    let recipe = Recipe { parts: parts.into(), ..recipe(0.2) };
    let report = made(&job, &recipe);
    assert_ne!(report.worst(), Some(Severity::Error), "{:#?}", report.findings);
    let scales: Vec<f64> = report.parts.iter().map(|p| p.scale).collect();
    for (scale, expected) in scales.iter().zip([1.0030, 1.0020, 1.0312, 1.0183]) {
        assert!((scale - expected).abs() < 5e-5, "{scales:?}");
    }
    let clearance = |id: &str| report.parts.iter().find(|p| p.id == id).unwrap().clearance_mm;
    assert_eq!(report.gaps.len(), 6);
    for gap in &report.gaps {
        assert!((gap.promised_mm - clearance(&gap.a) - clearance(&gap.b)).abs() < 1e-12, "{gap:?}");
        assert_eq!(gap.verdict, Verdict::Kept, "{gap:?}");
    }
    assert_eq!(report.routes.len(), 4);
    assert_eq!(report.routes.iter().map(|r| r.ledger.last().unwrap().product).collect::<Vec<_>>(), scales);
}

#[test]
fn a_process_for_a_part_that_is_not_there_is_refused() {
    let parts = [("weft-9".to_string(), Process::find("sla").unwrap())].into();
    let told = make(&solids::two_boxes(), &Recipe { parts, ..recipe(0.2) }, Path::new("never")).unwrap_err();
    assert!(told.to_string().contains("weft-9") && told.to_string().contains("part-0"), "{told}");
    assert!(!Path::new("never").exists());
}

#[test]
fn a_thin_wall_and_a_sharp_edge_are_told_with_their_place() {
    let job = solids::thin_plate();
    let report = made(&job, &recipe(0.4));
    let plate = &report.parts[1];
    let thin = plate.wall.unwrap().thinnest.unwrap();
    // A plate of 1 mm between two blocks loses 0.4 mm on the one face that touches, or on both.
    let size = plate.read_back.high.unwrap() - plate.read_back.low.unwrap();
    let expected = size.min_element() / plate.scale;
    assert!((thin.thickness_mm - expected).abs() < 1e-4, "{thin:?} {expected}");
    assert!(thin.thickness_mm < 0.8);
    let told = report.findings.iter().find(|f| f.what.contains("a wall is")).unwrap();
    assert_eq!((told.severity, told.place.at.len()), (Severity::Warning, 2));
    let dovetail = made(&solids::two_boxes(), &recipe(0.2));
    assert!(
        dovetail
            .parts
            .iter()
            .all(|p| p.wall.unwrap().thinnest.is_none() && p.wall.unwrap().sharpest.is_none())
    );
}

/// Printed faces stay apart by the fit of the process, 0.4 mm: a slot of 0.3 mm may close, one of 0.5 mm stays.
#[test]
fn a_slot_that_may_close_in_print_is_told_with_its_place() {
    let report = made(&solids::slotted(0.3), &recipe(0.2));
    let slot = report.parts[0].slot.unwrap();
    assert!((slot.thin.thickness_mm - 0.3).abs() < 1e-4 && (slot.width_mm - 10.0).abs() < 0.1, "{slot:?}");
    let told: Vec<_> = report.findings.iter().filter(|f| f.what.contains("a slot is 0.300 mm")).collect();
    assert_eq!((told.len(), told[0].severity, told[0].place.at.len()), (1, Severity::Warning, 2));
    assert!(told[0].place.at.iter().all(|p| (p.x - 15.0).abs() < 0.151 && p.z > 9.999), "{told:?}");
    assert_eq!(made(&solids::slotted(0.5), &recipe(0.2)).parts[0].slot, None);
}

#[test]
fn the_print_face_is_flattened_and_chamfered_on_demand() {
    let own = Overrides {
        clearance: Some(0.2),
        elephant_foot: Some(0.3),
        flatten: Some(0.5),
        ..Overrides::default()
    };
    let process = Process::find("fdm-pla").unwrap().with(&own).unwrap();
    let shaved = made(&solids::two_boxes(), &Recipe { programs: None, ..Recipe::new(process) });
    let plain = made(&solids::two_boxes(), &recipe(0.2));
    assert_ne!(shaved.worst(), Some(Severity::Error), "{:#?}", shaved.findings);
    for (s, p) in shaved.parts.iter().zip(&plain.parts) {
        let (size, k) = (p.read_back.high.unwrap() - p.read_back.low.unwrap(), p.scale);
        let foot = {
            let mut sides = size.to_array();
            sides.sort_by(f64::total_cmp);
            [sides[1], sides[2]]
        };
        let rim = 0.3_f64.powi(2) * (foot[0] + foot[1]) - 4.0 / 3.0 * 0.3_f64.powi(3);
        let expected = foot[0] * foot[1] * 0.5 + rim;
        let gone = p.read_back.volume_mm3.unwrap() - s.read_back.volume_mm3.unwrap();
        assert!((gone - expected).abs() < 0.02, "{gone} {expected} {k}");
        assert_eq!(s.read_back.watertight, Some(true));
    }
}

/// A fixture's assembly with this clearance, mm.
fn fixture(name: &str, clearance: f64) -> Report {
    let file = crate::support::root().join("fixtures/assemblies").join(name);
    let spec = weavelock::spec::read(&file).unwrap();
    let joined = weavelock::contact::join(&spec).unwrap();
    made(&weavelock::fabricate::job(&joined), &recipe(clearance))
}

fn carved(report: &Report, id: &str) -> bool {
    let told = |f: &weavelock_fab::report::Finding| {
        f.what.contains("carved by slabs") && f.place.parts.iter().any(|p| p == id)
    };
    report.findings.iter().any(told)
}

/// Pieces of a burr have notches as deep as they are wide: what a clearance takes from each is a layer below the faces that
/// touch and what is beside their edges, and no arm of it.
#[test]
fn a_clearance_takes_no_arm_off_a_burr() {
    for clearance in [0.05, 0.2, 0.8] {
        let report = fixture("burr.toml", clearance);
        assert_ne!(report.worst(), Some(Severity::Error), "{clearance}: {:#?}", report.findings);
        for p in &report.parts {
            let ratio = p.removed_mm3 / p.clearance_volume_mm3;
            assert!((0.9..1.1).contains(&ratio), "{} at {clearance}: {ratio}", p.id);
            // No corner goes farther than the diagonal of a cube of the clearance; the rest is what f32 needs.
            assert!(p.longest_move_mm < clearance * 3f64.sqrt() * 1.01, "{} {}", p.id, p.longest_move_mm);
            assert!(p.read_back.watertight == Some(true) && p.read_back.bodies == Some(1), "{}", p.id);
        }
        assert_eq!(report.gaps.len(), 10);
        assert!(worst_gap(&report) >= 1.0, "{clearance}: {:#?}", report.gaps);
        // Its one corner that must be split can be split at several spokes, of which one keeps every triangle outward.
        assert!(!carved(&report, "green"), "{:#?}", report.findings);
        assert!(carved(&report, "blue"), "if its faces can be moved now, take this line out");
    }
}

/// Parts that meet in an edge alone share no face that a clearance could move; they are parted all the same, whether their
/// own faces were moved or carved.
#[test]
fn parts_that_meet_in_an_edge_keep_their_fit() {
    for name in ["bricks-in-a-corner.toml", "taper-with-draft.toml", "dovetail-open.toml"] {
        for clearance in [0.05, 0.2] {
            let report = fixture(name, clearance);
            assert_ne!(report.worst(), Some(Severity::Error), "{name} {clearance}: {:#?}", report.findings);
            assert!(report.parts.iter().all(|p| p.file.is_some()));
            assert!(worst_gap(&report) >= 1.0, "{name} {clearance}: {:#?}", report.gaps);
        }
    }
}

/// A clearance that leaves nothing is told as that, by the last way that was tried.
#[test]
fn what_vanishes_is_told_as_that() {
    let report = fixture("block-in-case.toml", 3.0);
    assert!(report.parts.iter().all(|p| p.file.is_none()));
    let told = report.findings.iter().filter(|f| f.what.contains("leaves nothing of this part"));
    assert_eq!(told.count(), report.parts.len(), "{:#?}", report.findings);
}

/// An edge of four faces is no fault of the input where a clearance parts them.
#[test]
fn a_part_that_touches_itself_in_an_edge_is_parted_there() {
    for clearance in [0.05, 0.2, 0.8] {
        let report = made(&solids::ring_on_an_edge(), &recipe(clearance));
        assert_ne!(report.worst(), Some(Severity::Error), "{clearance}: {:#?}", report.findings);
        // The bars meet in the edge alone, and both their corners there go back: farther than the fit, so no gap is listed.
        assert!(report.gaps.len() == 2 && worst_gap(&report) >= 1.0, "{:#?}", report.gaps);
        // It stays a ring: one handle.
        assert_eq!(report.parts[0].read_back.genus, Some(1));
        for p in &report.parts {
            let ratio = p.removed_mm3 / p.clearance_volume_mm3;
            assert!((0.8..1.1).contains(&ratio), "{} at {clearance}: {ratio}", p.id);
        }
    }
}
