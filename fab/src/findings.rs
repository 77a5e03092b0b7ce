//! Takes what went wrong or was measured; gives findings: what, where, and what to do about it.

use crate::check::{Check, Outcome};
use crate::gap::{FIT_TOLERANCE, Gap, Verdict};
use crate::ledger::Scale;
use crate::make::crossings;
use crate::mesh::{Closure, Mesh};
use crate::mold::fins::Looked;
use crate::offset::{Failure, Why};
use crate::report::{Finding, PartReport, Place, Report, RouteReport, Severity};
use crate::shave::NotShaved;
use glam::DVec3;

const SMALLER: &str = "take a smaller clearance, a larger pitch, or a shape with thicker walls there";
const CROSSING: &str =
    "take a smaller clearance, and look whether the solid that came in crosses itself there already";
const BODIES: &str = "take a smaller clearance; where the solid that came in has several bodies already, give each an id of its own";
const PINCHED: &str =
    "move the bodies apart or let them overlap; where both sides of the edge are contact, give a clearance";
const CROWDED: &str = "make its mesh anew with fewer triangles, above all where very many meet in one corner";
const OURS: &str = "this is a fault of the program: please report it with the input";

fn error(id: &str, at: Vec<DVec3>, what: String, remedy: &str) -> Finding {
    let place = Place { parts: vec![id.to_string()], at };
    Finding { severity: Severity::Error, place, what, remedy: remedy.to_string() }
}

pub fn of_failure(id: &str, failure: &Failure) -> Finding {
    let what = match failure.why {
        Why::NoRoom => {
            "facets that meet here face each other: no point lies under all of them by the clearance"
        }
        Why::TurnedOver => "the clearance turns a triangle over that no collapse could mend",
        Why::Vanished => "the clearance leaves nothing of this part",
        Why::Lost => "moving the faces would take away more of this part than a layer below them",
        Why::NotSolid => "moving its faces fails, and it can not be carved: what came in is no closed solid",
        Why::TooNear => "the part stays nearer to another than the clearance of both",
    };
    error(id, vec![failure.at], format!("{what}; nothing is written for the part"), SMALLER)
}

/// That a part was carved, what the exact move failed of, and how far below its surface the new one lies at most, mm.
pub fn of_carving(id: &str, failed: &[Finding], deepest: f64) -> Finding {
    let how = format!(
        "it was carved by slabs instead, which go at most {deepest:.3} mm deep, at edges and corners"
    );
    instead(id, failed, &how)
}

/// The same for a part that was eroded on a lattice of that step, mm.
pub fn of_lattice(id: &str, failed: &[Finding], step: f64, deepest: f64) -> Finding {
    let how = format!(
        "it was eroded on a lattice of {step} mm instead: its faces, those that touch nothing too, are rough by as much, and lie at most {deepest:.3} mm deep"
    );
    Finding { severity: Severity::Warning, ..instead(id, failed, &how) }
}

fn instead(id: &str, failed: &[Finding], how: &str) -> Finding {
    let why = failed.first().map_or(String::new(), |f| format!(" ({})", f.what));
    let place = Place {
        parts: vec![id.to_string()],
        at: failed.iter().flat_map(|f| f.place.at.clone()).take(1).collect(),
    };
    Finding {
        severity: Severity::Note,
        place,
        what: format!("moving its faces exactly failed{why}; {how}"),
        remedy: "nothing, where the gaps that were measured do; else a smaller clearance".into(),
    }
}

/// That a print face stays as it was.
pub fn of_shaving(id: &str, why: &NotShaved) -> Finding {
    Finding {
        severity: Severity::Warning,
        place: Place { parts: vec![id.to_string()], at: vec![] },
        what: format!("its print face was left as it is: {why}"),
        remedy: "flatten it with --flatten first, or compensate in the slicer".into(),
    }
}

/// What keeps a mesh on the master from being written.
pub fn of_mesh(id: &str, master: &Mesh, scale: &Scale) -> Vec<Finding> {
    let mut found = Vec::new();
    if let Closure::Open { edges, at } = master.closure() {
        let pinched = master.is_pinched();
        let what = if pinched {
            "the surface meets itself in an edge, where the part would hang together by nothing; it is not written".to_string()
        } else {
            format!("{edges} edges are not between two opposite triangles; nothing is written for the part")
        };
        found.push(error(id, vec![scale.down(at)], what, if pinched { PINCHED } else { SMALLER }));
        return found;
    }
    match crossings(master).as_deref() {
        Ok([]) => {}
        Ok([c, ..]) => {
            let what = "the surface as made crosses itself; nothing is written for the part".to_string();
            found.push(error(id, vec![scale.down(c.at)], what, CROSSING));
        }
        Err(crowded) => {
            let what = format!("{crowded}; nothing is written for the part");
            found.push(error(id, vec![], what, CROWDED));
        }
    }
    let solids = master.shells().iter().filter(|v| **v > 0.0).count();
    if solids != 1 {
        let what = format!("the part as made is {solids} bodies, not one; nothing is written for it");
        found.push(error(id, vec![], what, BODIES));
    }
    found
}

pub fn of_copy(id: &str, file: &str, same: bool) -> Option<Finding> {
    let what = || format!("{file} read back is not what was written; nothing is left of it");
    (!same).then(|| error(id, vec![], what(), OURS))
}

/// Adds to the report's findings what its gaps, checks and figures say.
pub fn collect(report: &mut Report) {
    let mut found: Vec<Finding> = report.gaps.iter().filter_map(of_gap).collect();
    for part in &report.parts {
        found.extend(part.checks.iter().filter_map(|c| of_check(c, std::slice::from_ref(&part.id))));
    }
    for pair in &report.pair_checks {
        found.extend(of_check(&pair.check, &[pair.a.clone(), pair.b.clone()]));
    }
    found.extend(report.routes.iter().filter_map(|r| of_shrinkage(report, r)));
    found.extend(report.routes.iter().filter_map(of_no_clearance));
    found.extend(of_all_walls(report));
    found.extend(report.parts.iter().filter_map(of_hollows));
    report.findings.extend(found);
    report.findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    let mut seen = std::collections::BTreeSet::new();
    report.findings.retain(|f| seen.insert((f.place.parts.clone(), f.what.clone())));
}

/// Walls of each solid once, with all parts that it is; places are those of the first that was written.
fn of_all_walls(report: &Report) -> Vec<Finding> {
    let mut told = std::collections::BTreeSet::new();
    let mut found = Vec::new();
    for part in report.parts.iter().filter(|p| p.file.is_some()) {
        if told.contains(&part.id) {
            continue;
        }
        let alike = report.alike(&part.id);
        told.extend(alike.iter().cloned());
        let named = |f: Finding| Finding { place: Place { parts: alike.clone(), ..f.place }, ..f };
        found.extend(of_walls(part).into_iter().map(named));
    }
    found
}

fn of_gap(gap: &Gap) -> Option<Finding> {
    let (severity, what, remedy) = match gap.verdict {
        Verdict::Kept => return None,
        Verdict::Short => (
            Severity::Error,
            format!(
                "the least gap is {:.4} mm, promised {:.4}, {:.1e} mm less; neither part is written",
                gap.least_mm,
                gap.promised_mm,
                gap.promised_mm - gap.least_mm
            ),
            SMALLER,
        ),
        Verdict::Crossing => {
            (Severity::Error, "the parts as made cross each other; neither is written".to_string(), SMALLER)
        }
        Verdict::Wide => (
            Severity::Warning,
            format!(
                "the least gap is {:.4} mm, more than {} % above the promised {:.4}",
                gap.least_mm,
                FIT_TOLERANCE * 100.0,
                gap.promised_mm
            ),
            "finer sampling brings the facets of their common patch nearer to one another's planes",
        ),
    };
    let place = Place { parts: vec![gap.a.clone(), gap.b.clone()], at: gap.at.to_vec() };
    Some(Finding { severity, place, what, remedy: remedy.to_string() })
}

fn of_check(check: &Check, parts: &[String]) -> Option<Finding> {
    let (severity, why, remedy) = match &check.outcome {
        Outcome::Passed => return None,
        Outcome::Failed(why) => (Severity::Error, why, "do not make this part before it is clear why"),
        Outcome::NotRun(why) => (Severity::Note, why, "install the program to have this checked"),
    };
    let what = format!("{}, {}: {why}", check.by, check.of);
    let parts = if severity == Severity::Note { vec![] } else { parts.to_vec() };
    Some(Finding { severity, place: Place { parts, at: vec![] }, what, remedy: remedy.to_string() })
}

/// Shrinkage that is known less well than the clearance needs.
fn of_shrinkage(report: &Report, route: &RouteReport) -> Option<Finding> {
    let extent = |p: &PartReport| Some((p.read_back.high? - p.read_back.low?).max_element() / p.scale);
    let mine = report.parts.iter().filter(|p| route.parts.contains(&p.id));
    let largest = mine.filter_map(extent).fold(0.0, f64::max);
    let (low, high) = route.scale_range;
    let spread = largest * (high - route.scale).max(route.scale - low) / route.scale / 2.0;
    let clearance = route.process.clearance.value;
    let what = format!(
        "{}: the shrinkage is known so roughly that an end of the longest part may be off by {spread:.2} mm; the clearance is {clearance:.2}",
        route.process.name
    );
    let remedy = "make the coupon first, and give the length that you measure with --measured STEP=MM".into();
    (spread > clearance).then(|| Finding {
        severity: Severity::Warning,
        place: Place { parts: route.parts.clone(), at: vec![] },
        what,
        remedy,
    })
}

fn of_no_clearance(route: &RouteReport) -> Option<Finding> {
    let what = format!(
        "{}: the clearance is zero; rigid parts without air between them are for looking at, they will not go together",
        route.process.name
    );
    let remedy = "give the clearance of the process".into();
    (route.process.clearance.value == 0.0).then(|| Finding {
        severity: Severity::Warning,
        place: Place { parts: route.parts.clone(), at: vec![] },
        what,
        remedy,
    })
}

/// Hollows that nothing can be taken out of.
fn of_hollows(part: &PartReport) -> Option<Finding> {
    let hollows = part.read_back.hollows.filter(|h| *h > 0)?;
    Some(Finding {
        severity: Severity::Warning,
        place: Place { parts: vec![part.id.clone()], at: vec![] },
        what: format!(
            "{hollows} closed hollows: supports, resin and wax stay inside, and a casting needs a core"
        ),
        remedy: "split the part, or open the hollow".into(),
    })
}

/// Walls and edges thinner than the process makes, and slots narrower.
fn of_walls(part: &PartReport) -> Vec<Finding> {
    let finding = |severity, at, what, remedy: &str| Finding {
        severity,
        place: Place { parts: vec![part.id.clone()], at },
        what,
        remedy: remedy.into(),
    };
    let least = part.least_wall_mm;
    let walls = part.wall.unwrap_or_default();
    let thin = walls.thinnest.map(|w| {
        let what = format!(
            "a wall is {:.3} mm thick; {} makes no wall thinner than {least} mm",
            w.thickness_mm, part.process
        );
        finding(
            Severity::Warning,
            w.at.to_vec(),
            what,
            "take a larger pitch, a thicker shape there, or a process with a finer wall",
        )
    });
    let sharp = walls.sharpest.map(|s| {
        let what = format!(
            "an edge of {:.1} degrees: over {:.2} mm from it the part is thinner than {least} mm and will come out blunt",
            s.degrees, s.thin_over_mm
        );
        finding(Severity::Note, vec![s.at], what, "nothing, where a blunt edge does no harm; else a larger pitch or a process with a finer wall")
    });
    let slot = part.slot.map(|s| {
        let what = format!(
            "a slot is {:.3} mm wide over {:.1} mm; faces printed by {} stay apart from {} mm on, so it may close",
            s.thin.thickness_mm,
            s.width_mm,
            part.process,
            2.0 * part.clearance_mm
        );
        let remedy = "widen the slot, or cut it open with a blade after printing; a finer process has a smaller fit";
        finding(Severity::Warning, s.thin.at.to_vec(), what, remedy)
    });
    let left = (part.slots_looked_at == Looked::Some).then(|| {
        let what = "it has more narrow places than were looked at: there may be wider slots".to_string();
        finding(Severity::Note, vec![], what, "make its mesh coarser")
    });
    thin.into_iter().chain(sharp).chain(slot).chain(left).collect()
}
