//! Takes a package's answer; gives the cast schedule and the pour sheet.
//!
//! Not promised: volumes of sprues, boxes and flasks where no mold was made for the part.

use super::table::{range, short, table, value};
use crate::make::MM3_IN_CM3;
use crate::package::PackageReport;
use crate::process::{Instruction, Route};
use crate::report::RouteReport;

fn cast(p: &PackageReport) -> Vec<&RouteReport> {
    p.report.routes.iter().filter(|r| r.process.route != Route::Print).collect()
}

/// The schedule in order; `None` where nothing is cast.
pub fn sheet(p: &PackageReport) -> Option<String> {
    let routes = cast(p);
    if routes.is_empty() {
        return None;
    }
    let mut s = format!("# Cast schedule: {}\n", p.report.name);
    for r in routes {
        s += &format!("\n## {} ({})\n\nParts: {}.\n", r.process.title, r.process.name, r.parts.join(", "));
        if let Some(c) = &r.process.cavity {
            s += &format!(
                "\nPoured at {} into {}, which bears {} ({}, grade {}).\n",
                value(&c.pour),
                c.material,
                value(&c.bears),
                c.bears.source,
                c.bears.grade.sign()
            );
        }
        s += &schedule(&r.process.schedule);
    }
    if !p.mold_sheets.is_empty() {
        s += "\nWhat is done with one mold (boxes and their pours, tree, flask), step by step: [3-molds.md](3-molds.md).\n";
    }
    s += &format!("\nMolds: {}\n", p.report.molds_note);
    Some(s)
}

fn schedule(lines: &[Instruction]) -> String {
    let row = |(k, i): (usize, &Instruction)| {
        let f = i.figure.as_ref();
        vec![
            (k + 1).to_string(),
            i.stage.clone(),
            i.what.clone(),
            f.map(value).unwrap_or_default(),
            f.map(range).unwrap_or_default(),
            f.map(|f| format!("{} ({})", f.source, f.grade.sign())).unwrap_or_default(),
        ]
    };
    table(&["", "stage", "do", "figure", "range", "source (grade)"], lines.iter().enumerate().map(row))
}

/// How much is poured into each cavity and melted in all.
pub fn pour(p: &PackageReport) -> Option<String> {
    let routes = cast(p);
    if routes.is_empty() {
        return None;
    }
    let mut s = format!(
        "# Pour sheet: {}\n\nFirst what each mold takes, then the parts alone: what fills sprues, runners and boxes is in the first only.\n",
        p.report.name
    );
    for r in routes {
        s += &format!("\n## {}\n", r.process.title);
        for m in p.mold_sheets.iter().filter(|m| m.process == r.process.name && !m.report.volumes.is_empty())
        {
            s += &format!("\n{}, with sprues, runners and boxes:\n", m.report.name);
            let grams = |v: &crate::mold::Volume| v.grams.map_or(String::new(), |g| format!("{g:.1}"));
            let cm3 =
                |v: &crate::mold::Volume| if v.mm3 > 0.0 { short(v.mm3 / MM3_IN_CM3) } else { String::new() };
            let row = |v: &crate::mold::Volume| vec![v.of.clone(), cm3(v), grams(v)];
            s += &table(&["volume", "cm3", "g"], m.report.volumes.iter().map(row));
        }
        let parts = p.report.parts.iter().filter(|q| q.file.is_some() && r.parts.contains(&q.id));
        let row = |q: &crate::report::PartReport| {
            let cm3 = (q.nominal_volume_mm3 - q.removed_mm3) / MM3_IN_CM3;
            let cavity = q.read_back.volume_mm3.unwrap_or(q.expected_volume_mm3) / MM3_IN_CM3;
            vec![q.id.clone(), short(cavity), short(cm3), format!("{:.1}", q.mass_g)]
        };
        let head = ["part", "master, cm3", "finished, cm3", &format!("{}, g", r.process.material)];
        s += &table(&head, parts.map(row));
        s += &metal(p, r);
    }
    Some(s)
}

/// Of all parts and trees of a route together.
fn metal(p: &PackageReport, r: &RouteReport) -> String {
    let melted = |l: &&crate::package::bill::Line| {
        l.what.ends_with(crate::package::bill::MELT) && l.material == r.process.material
    };
    let lines: Vec<_> = p.bill.lines.iter().filter(melted).collect();
    let notes: std::collections::BTreeSet<&str> = lines.iter().map(|l| l.note.as_str()).collect();
    let total: f64 = lines.iter().map(|l| l.total_g).sum();
    let note = notes.into_iter().collect::<Vec<_>>().join("; ");
    if lines.is_empty() {
        String::new()
    } else {
        format!("\nMetal to melt in all: {total:.1} g of {} ({note}).\n", r.process.material)
    }
}
