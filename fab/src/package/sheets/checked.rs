//! Takes a package's answer; gives the sheet of what was checked, and by which program.
//!
//! Not promised: anything about what is said to be not run.

use super::start::findings;
use super::table::table;
use crate::check::{Check, Outcome};
use crate::package::PackageReport;
use crate::report::PartReport;

pub fn sheet(p: &PackageReport) -> String {
    let mut s =
        format!("# What was checked: {}\n\n## By weavelock, on the files as written\n", p.report.name);
    let row = |q: &PartReport| {
        let r = &q.read_back;
        let wall = match (q.file.is_some(), q.wall.and_then(|w| w.thinnest)) {
            (false, _) => "-".to_string(),
            (true, Some(w)) => format!("{:.3}", w.thickness_mm),
            (true, None) => format!("none under {}", q.least_wall_mm),
        };
        vec![
            q.id.clone(),
            q.file.clone().unwrap_or("not written".into()),
            r.watertight.map_or("-".into(), |w| if w { "yes".into() } else { "no".into() }),
            r.bodies.map_or("-".into(), |b| b.to_string()),
            r.hollows.map_or("-".into(), |b| b.to_string()),
            r.genus.map_or("-".into(), |g| g.to_string()),
            r.triangles.map_or("-".into(), |t| t.to_string()),
            r.volume_mm3.map_or("-".into(), |v| format!("{v:.2}")),
            wall,
        ]
    };
    let head = [
        "part",
        "file",
        "watertight",
        "bodies",
        "hollows",
        "handles",
        "triangles",
        "volume, mm3",
        "thinnest wall, mm",
    ];
    s += &table(&head, p.report.parts.iter().map(row));
    s += "\nEach was read back and is bit for bit what was meant, does not cross itself, and keeps its gaps (ledger.md).\n\n## By other programs\n";
    let rows = others(p);
    s += &if rows.is_empty() {
        "\n*Not run*: OpenSCAD, PrusaSlicer, ADMesh. `weavelock fab --check` asks those that are installed.\n"
            .to_string()
    } else {
        table(&["what", "program", "looked at", "answer"], rows)
    };
    s + "\n## Findings\n" + &findings(p)
}

fn others(p: &PackageReport) -> Vec<Vec<String>> {
    let parts = p.report.parts.iter().flat_map(|q| q.checks.iter().map(|c| row(&q.id, c)));
    let pairs = p.report.pair_checks.iter().map(|q| row(&format!("{} and {}", q.a, q.b), &q.check));
    let plates = p.plates.iter().flat_map(|q| q.checks.iter().map(|c| row(&q.file, c)));
    let whole = p.assembly.iter().flat_map(|a| a.checks.iter().map(|c| row(&a.file, c)));
    let molds = p.report.molds.iter().flat_map(|m| m.checks.iter().map(|c| row(&m.file, c)));
    parts.chain(pairs).chain(plates).chain(whole).chain(molds).collect()
}

fn row(what: &str, check: &Check) -> Vec<String> {
    let answer = match &check.outcome {
        Outcome::Passed => "passed".to_string(),
        Outcome::Failed(why) => format!("**failed**: {why}"),
        Outcome::NotRun(why) => format!("*not run*: {why}"),
    };
    vec![what.to_string(), check.by.clone(), check.of.clone(), answer]
}
