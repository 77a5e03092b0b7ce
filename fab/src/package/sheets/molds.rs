//! Takes a package's answer; gives the mold sheet: for each mold how it opens, what it is made of, what was measured.
//!
//! Not promised: words for what the mold's own steps and figures do not say.

use super::table::{short, table};
use crate::mold::{Measured, MoldReport, Parting, Route, Step, Volume, WrittenPiece};
use crate::package::{MoldSheet, PackageReport};

/// `None` where there is no mold.
pub fn sheet(p: &PackageReport) -> Option<String> {
    if p.mold_sheets.is_empty() {
        return None;
    }
    let mut s = format!(
        "# Mold sheet: {}\n\nAll files are in `molds/`, in millimetres, scale already applied: print at 100 %, with layer, material and XY compensation 0 as on the print sheet or in the bill. The plates `print/*-molds-plate-*` hold all prints as they lie: halves with the parting face up (the upper one turned over), side cores on their grips; box walls stand as they are; a pattern board carries half of the master on each side: supports below. A pattern board holds the master already; a single master is for a board of your own, or to try the fit.\n",
        p.report.name
    );
    for m in &p.mold_sheets {
        s += &format!(
            "\n## {} ({})\n\nFor: {}. {}\n",
            m.report.name,
            m.process,
            m.parts.join(", "),
            use_of(m)
        );
        s += &mold(&m.report, &m.parts[0]);
        if m.report.route == Route::LostWax {
            s += "\nHeats and times of burnout and pour: [4-cast.md](4-cast.md), by the process.\n";
        }
    }
    Some(s)
}

/// How often a mold is filled, in a sentence.
pub fn use_of(m: &MoldSheet) -> String {
    let same =
        if m.parts.len() > 1 { "One solid, turned and shifted: any of them takes any casting. " } else { "" };
    let spare = match m.castings * m.pours - m.parts.len() {
        0 => String::new(),
        n => format!(", {n} to spare"),
    };
    match (m.report.route, m.castings, m.pours) {
        (Route::LostWax, 1, _) => "The tree holds its pattern.".to_string(),
        (Route::LostWax, n, 1) => format!("{same}The tree holds all {n} patterns."),
        (Route::LostWax, n, t) => format!("{same}{t} trees of {n} patterns each, in a flask each{spare}."),
        (_, 1, 1) => "It is filled once.".to_string(),
        (_, 1, n) => format!("{same}It is made once and filled {n} times."),
        (_, k, 1) => format!("{same}It is filled once, {k} castings at once{spare}."),
        (_, k, n) => format!("{same}It is made once and filled {n} times, {k} castings at once{spare}."),
    }
}

fn mold(m: &MoldReport, first: &str) -> String {
    let d = m.pull.direction;
    let mut s = String::new();
    let opens = format!(
        "\nOpens along ({}, {}, {}) of {first} as it stands in the assembly. {} directions were looked at: {}. Undercut: {} mm2, {} mm deep. Faces with less draft than the {} degrees that are asked for: {} mm2.\n",
        short(d.x),
        short(d.y),
        short(d.z),
        m.pull.candidates,
        m.pull.search,
        short(m.pull.undercut_mm2),
        short(m.pull.undercut_reach_mm),
        short(m.least_draft_deg),
        short(m.low_draft_mm2)
    );
    // A tree does not open.
    if m.route != Route::LostWax {
        s += &opens;
    }
    s += &match &m.parting {
        Some(Parting::Plane { height_mm }) => {
            format!("\nThe halves part in a plane, {} mm above the part's foot.\n", short(*height_mm))
        }
        Some(Parting::Stepped { height_mm, .. }) => format!(
            "\nThe halves part in a stepped surface about {} mm above the part's foot.\n",
            short(*height_mm)
        ),
        None => String::new(),
    };
    let piece = |w: &WrittenPiece| {
        vec![
            format!("`{}`", w.file),
            w.kind.words().to_string(),
            w.copies.to_string(),
            format!("{:.1}", w.volume_mm3 / 1000.0),
        ]
    };
    s += &table(&["file", "", "number", "cm3"], m.pieces.iter().filter(|w| w.copies > 0).map(piece));
    let volume = |v: &Volume| {
        vec![
            v.of.clone(),
            if v.mm3 > 0.0 { format!("{:.2}", v.mm3 / 1000.0) } else { String::new() },
            v.grams.map_or(String::new(), |g| format!("{g:.1}")),
        ]
    };
    if !m.volumes.is_empty() {
        s += &table(&["volume", "cm3", "g"], m.volumes.iter().map(volume));
    }
    let step = |(k, t): (usize, &Step)| {
        let hours = t.hours.map_or(String::new(), |h| format!("{} h", short(h)));
        let heat = t.celsius.map_or(String::new(), |c| format!("{} \u{b0}C", short(c)));
        vec![(k + 1).to_string(), t.does.clone(), hours, heat, t.source.clone()]
    };
    if !m.steps.is_empty() {
        s += &table(&["", "do", "for", "at", "source"], m.steps.iter().enumerate().map(step));
    }
    let measure = |v: &Measured| {
        let kept = if v.kept { "kept" } else { "**missed**" };
        vec![
            v.of.clone(),
            format!("{} {}", short(v.value), v.unit).trim().to_string(),
            format!("{} {}", short(v.limit), v.unit).trim().to_string(),
            kept.to_string(),
        ]
    };
    s += &table(&["measured on the files", "found", "limit", ""], m.measured.iter().map(measure));
    let pictures = m.files.iter().filter(|f| f.ends_with(".png"));
    s += &pictures.map(|f| format!("\n![{f}](molds/{f})\n")).collect::<String>();
    let others = m.files.iter().map(|f| format!("- `molds/{f}`\n")).collect::<String>();
    s + "\n" + &others
}
