//! Takes a package's answer; gives the sheet that is read first, and the bill of materials.
//!
//! Not promised: a second reading; what forbids the work stands on top.

use super::table::{short, table};
use crate::package::PackageReport;
use crate::process::Route;
use crate::report::{Finding, Severity};

pub fn sheet(p: &PackageReport) -> String {
    let mut s = format!("# {}\n", p.report.name);
    let errors = p.report.findings.iter().filter(|f| f.severity == Severity::Error).count();
    if errors > 0 {
        s += &format!("\n**Do not make this as it is: {errors} findings forbid it (below).**\n");
    }
    s += "\nEvery file is in millimetres. **Clearance and shrinkage are built in: scale nothing, print at 100 %.**\n";
    s += &routes(p);
    s += &molds(p);
    s += "\n## Order of the work\n\n";
    for (k, step) in steps(p).iter().enumerate() {
        s += &format!("{}. {step}\n", k + 1);
    }
    s += "\nGrades of figures: S the text of the source was seen, 2 second hand, I inferred, M measured for this project, user given by you.\n";
    s += "\n## Findings\n";
    s += &findings(p);
    s += "\n## Files\n\n";
    for (what, why) in FILES {
        s += &format!("- `{what}`: {why}\n");
    }
    s
}

const FILES: [(&str, &str); 8] = [
    (
        "parts/",
        "each part in its place in the assembly, at the size of its master (STL, OBJ, 3MF; STL has no unit, so the name says mm)",
    ),
    ("print/", "plates ready to slice, each part turned and placed on the bed"),
    ("assembly.mm.3mf", "all parts in place as one object, to look at; not there where a clearance is zero"),
    (
        "molds/",
        "molds as STL, their OpenSCAD sources with figures to change, maps and pictures; there where something is cast",
    ),
    ("coupon/", "what is printed first, to measure machine and material"),
    (
        "bill-of-materials.md, ledger.md, checked.md",
        "masses; how each size came about; what was checked and by which program",
    ),
    ("pictures/", "what it should look like"),
    ("package.json", "all of this for a program"),
];

fn routes(p: &PackageReport) -> String {
    let row = |r: &crate::report::RouteReport| {
        vec![
            r.process.title.clone(),
            r.process.material.clone(),
            format!("{} mm", r.process.clearance.value),
            format!("{:.5}", r.scale),
            r.parts.join(", "),
        ]
    };
    table(&["made by", "of", "air on each face", "scale built in", "parts"], p.report.routes.iter().map(row))
}

/// Which mold makes which parts, and how often it is filled.
fn molds(p: &PackageReport) -> String {
    let row = |m: &crate::package::MoldSheet| {
        let words = [m.report.name.clone(), m.parts.join(", ")];
        [words, [m.castings.to_string(), m.pours.to_string()]].concat()
    };
    let head = ["mold", "parts that it makes", "castings at once", "times filled"];
    if p.mold_sheets.is_empty() { String::new() } else { table(&head, p.mold_sheets.iter().map(row)) }
}

fn steps(p: &PackageReport) -> Vec<String> {
    let casts = p.report.routes.iter().any(|r| r.process.route != Route::Print);
    let mut steps = vec![
        "Print the coupon and measure it: [1-coupon.md](1-coupon.md). Where it disagrees with the ledger, make this package again with your figure.".to_string(),
    ];
    if !p.plates.is_empty() {
        steps.push("Print the plates: [2-print.md](2-print.md).".into());
    }
    if casts {
        if !p.mold_sheets.is_empty() {
            steps.push("Print or make the molds: [3-molds.md](3-molds.md).".into());
        }
        steps.push(
            "Cast, in the order of [4-cast.md](4-cast.md); how much to mix and melt: [5-pour.md](5-pour.md)."
                .into(),
        );
    }
    steps.push("Measure the parts against [ledger.md](ledger.md), then put them together.".into());
    steps
}

pub fn findings(p: &PackageReport) -> String {
    if p.report.findings.is_empty() {
        return "\nNone.\n".into();
    }
    let row = |f: &Finding| {
        let at: Vec<String> =
            f.place.at.iter().take(1).map(|v| format!("({:.2}, {:.2}, {:.2})", v.x, v.y, v.z)).collect();
        let place = [f.place.parts.join(", "), at.concat()].join(" ");
        vec![
            format!("{:?}", f.severity).to_lowercase(),
            place.trim().to_string(),
            f.what.clone(),
            f.remedy.clone(),
        ]
    };
    table(&["", "where (mm, finished assembly)", "what", "what to do"], p.report.findings.iter().map(row))
}

pub fn bill(p: &PackageReport) -> String {
    let mut s = format!("# Bill of materials: {}\n", p.report.name);
    let row = |l: &crate::package::bill::Line| {
        vec![
            l.what.clone(),
            l.material.clone(),
            l.count.to_string(),
            if l.volume_cm3 > 0.0 { short(l.volume_cm3) } else { String::new() },
            format!("{:.1}", l.mass_g),
            format!("{:.1}", l.total_g),
            l.note.clone(),
        ]
    };
    let head = ["what", "material", "number", "cm3 each", "g each", "g all", ""];
    s += &table(&head, p.bill.lines.iter().map(row));
    let sliced: Vec<String> = p
        .plates
        .iter()
        .filter_map(|q| Some(format!("- `{}`: {:.1} g of filament, as sliced\n", q.file, q.grams?)))
        .collect();
    s + &sliced.concat()
}
