//! Takes a package's answer; gives the cast schedule and the pour sheet.
//!
//! Not promised: volumes of sprues, boxes and flasks where no mold was made for the part.

use super::molds::use_of;
use super::table::{range, short, table, value};
use crate::make::MM3_IN_CM3;
use crate::mold::Volume;
use crate::package::{MoldSheet, PackageReport};
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
                "\nPoured at {} into {}, which bears {} ({}, grade {}){}.\n",
                value(&c.pour),
                c.material,
                value(&c.bears),
                c.bears.source,
                c.bears.grade.sign(),
                liquid(r)
            );
        }
        let own = p.mold_sheets.iter().filter(|m| m.process == r.process.name);
        let line =
            |m: &MoldSheet| format!("- {}: for {}. {}\n", m.report.name, m.parts.join(", "), use_of(m));
        s += &format!("\n{}", own.map(line).collect::<String>());
        s += &schedule(&r.process.schedule);
    }
    if !p.mold_sheets.is_empty() {
        s += "\nWhat is done with one mold (boxes and their pours, tree, flask), step by step: [3-molds.md](3-molds.md).\n";
    }
    s += &format!("\nMolds: {}.\n", p.report.molds_note);
    Some(s)
}

/// From what heat on what is poured is liquid, in a sentence.
fn liquid(r: &RouteReport) -> String {
    let known = r.process.cavity.as_ref().and_then(|c| c.liquid.as_ref());
    let said = |f: &crate::process::Figure| {
        let (material, grade) = (&r.process.material, f.grade.sign());
        let upto =
            if f.high > f.low { format!(", by its grade up to {} \u{b0}C", f.high) } else { String::new() };
        format!("; {material} is liquid from {} \u{b0}C{upto} ({}, grade {grade})", f.low, f.source)
    };
    known.map_or(String::new(), said)
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
            s += &format!(
                "\n{}, with sprues, runners and boxes, for {}. {}\n",
                m.report.name,
                m.parts.join(", "),
                use_of(m)
            );
            let head = ["volume", "cm3", "g", "times", "g in all"];
            s += &table(&head, m.report.volumes.iter().map(|v| volume(m, v)));
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

/// What is poured once and with each filling; a cavity without a mass is only to compare with.
fn volume(m: &MoldSheet, v: &Volume) -> Vec<String> {
    let times = m.times(v);
    let cm3 = if v.mm3 > 0.0 { short(v.mm3 / MM3_IN_CM3) } else { String::new() };
    let grams = |times: usize| v.grams.map_or(String::new(), |g| format!("{:.1}", g * times as f64));
    let count = v.grams.map_or(String::new(), |_| times.to_string());
    vec![v.of.clone(), cm3, grams(1), count, grams(times)]
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
