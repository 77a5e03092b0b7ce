//! Takes the report on parts and molds; gives the bill of materials: what is printed, what is poured, how much of it.
//!
//! Masses of prints are those of solid plastic: an upper bound; a slicer's figure stands in the checks. Not promised:
//! what is spilled, beyond the tenth that is added to metal.

use super::molds::MoldSheet;
use super::poured::CASTING;
use crate::make::MM3_IN_CM3;
use crate::mold::{Kind as PieceKind, Volume, WrittenPiece};
use crate::process::{Process, Route};
use crate::report::{Report, RouteReport};
use serde::Serialize;

/// Metal that is melted beyond part and sprue: what stays in the crucible and the skimmings.
const METAL_EXTRA: f64 = 1.1;

/// A line of the bill.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    pub what: String,
    pub material: String,
    pub count: usize,
    /// cm3 of one.
    pub volume_cm3: f64,
    /// g of one.
    pub mass_g: f64,
    /// g of all.
    pub total_g: f64,
    pub note: String,
}

/// What a package takes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Bill {
    pub lines: Vec<Line>,
}

struct Kind<'a> {
    first: &'a crate::report::PartReport,
    ids: Vec<&'a str>,
}

/// The bill: parts finished, then what is printed for them, then what is poured.
pub fn bill(report: &Report) -> Bill {
    let lines = report.routes.iter().flat_map(|r| {
        let kinds = kinds(report, r);
        let finished = kinds.iter().map(|k| finished(k, &r.process)).collect::<Vec<_>>();
        let printed =
            kinds.iter().filter(|_| r.process.route != Route::Print && r.process.route.prints_the_shape());
        let printed: Vec<Line> = printed.map(|k| printed_line(k, &r.process)).collect();
        let poured = (r.process.route.is_metal()).then(|| metal(&kinds, &r.process));
        finished.into_iter().chain(printed).chain(poured).collect::<Vec<_>>()
    });
    Bill { lines: lines.collect() }
}

/// Parts of a route that are the same solid, in the order of their first; those that were not written are left out.
fn kinds<'a>(report: &'a Report, route: &'a RouteReport) -> Vec<Kind<'a>> {
    let mut kinds: Vec<Kind> = Vec::new();
    for part in report.parts.iter().filter(|p| p.file.is_some() && route.parts.contains(&p.id)) {
        let same = |k: &&mut Kind| {
            Some(&k.first.id) == part.same_as.as_ref()
                || k.first.same_as.is_some() && k.first.same_as == part.same_as
        };
        match kinds.iter_mut().find(same) {
            Some(kind) => kind.ids.push(&part.id),
            None => kinds.push(Kind { first: part, ids: vec![&part.id] }),
        }
    }
    kinds
}

fn line(what: String, material: &str, count: usize, mm3: f64, density: f64, note: String) -> Line {
    let volume_cm3 = mm3 / MM3_IN_CM3;
    let mass_g = volume_cm3 * density;
    Line {
        what,
        material: material.to_string(),
        count,
        volume_cm3,
        mass_g,
        total_g: mass_g * count as f64,
        note,
    }
}

fn finished(kind: &Kind, process: &Process) -> Line {
    let volume = kind.first.nominal_volume_mm3 - kind.first.removed_mm3;
    let what = format!("finished part: {}", kind.ids.join(", "));
    let note = match process.route {
        Route::Print => "if printed solid".to_string(),
        _ => String::new(),
    };
    line(what, &process.material, kind.ids.len(), volume, process.density.value, note)
}

/// One master makes all castings of a kind; a pattern is lost with each.
fn printed_line(kind: &Kind, process: &Process) -> Line {
    let printed = process.route.printed();
    let count = if process.route == Route::LostPrint { kind.ids.len() } else { 1 };
    let volume = kind.first.read_back.volume_mm3.unwrap_or(kind.first.expected_volume_mm3);
    let what = format!("printed {printed}: {}", kind.first.id);
    line(what, &process.print.material, count, volume, process.print.density.value, "if printed solid".into())
}

fn metal(kinds: &[Kind], process: &Process) -> Line {
    let mm3 = kinds
        .iter()
        .map(|k| (k.first.nominal_volume_mm3 - k.first.removed_mm3) * k.ids.len() as f64)
        .sum::<f64>();
    let note = "parts and a tenth; the tree's runner and gates come on top (see the molds)".to_string();
    line(MELT.into(), &process.material, 1, mm3 * METAL_EXTRA, process.density.value, note)
}

/// What is mixed beyond the pour: what stays in cup and on stick.
const POUR_EXTRA: f64 = 1.1;

/// What the molds take, after the parts: their prints, and all that is mixed and melted for them. Where every part of a
/// process has its tree, the trees' metal stands instead of the parts'.
pub fn add_molds(bill: &mut Bill, report: &Report, molds: &[MoldSheet]) {
    for route in &report.routes {
        let own: Vec<&MoldSheet> = molds.iter().filter(|m| m.process == route.process.name).collect();
        let treed = |id: &String| own.iter().any(|m| m.parts.contains(id) && melts(m));
        if route.process.route.is_metal() && route.parts.iter().all(treed) {
            bill.lines.retain(|l| l.what != MELT || l.material != route.process.material);
        }
        bill.lines.extend(own.iter().flat_map(|m| mold_lines(m, &route.process)));
    }
}

/// What is melted for a tree, or for parts without one.
pub const MELT: &str = "metal to melt";

fn melts(m: &MoldSheet) -> bool {
    m.report.volumes.iter().any(|v| v.of == MELT)
}

fn mold_lines(m: &MoldSheet, process: &Process) -> Vec<Line> {
    let print = &process.print;
    let printed = m.report.pieces.iter().filter(|p| {
        p.copies > 0
            && matches!(
                p.kind,
                PieceKind::Half | PieceKind::Core | PieceKind::PatternBoard | PieceKind::BoxWall
            )
    });
    let print_line = |p: &WrittenPiece| {
        let what = format!("printed {}: {}", p.kind.words(), p.file);
        line(what, &print.material, p.copies, p.volume_mm3, print.density.value, "if printed solid".into())
    };
    printed.map(print_line).chain(m.report.volumes.iter().filter_map(|v| pour_line(m, v, process))).collect()
}

/// What is bought for a volume: its material, how much more than the volume, why, and how often.
struct Bought<'a> {
    material: &'a str,
    extra: f64,
    note: &'static str,
    count: usize,
}

/// `None` for what is no purchase: volumes that nothing is weighed for, wax of patterns (that of the tree has it), and the
/// mix of powder and water, which stand for themselves.
fn bought<'a>(m: &'a MoldSheet, v: &'a Volume, process: &'a Process) -> Option<Bought<'a>> {
    let one = |material, extra, note| Some(Bought { material, extra, note, count: m.times(v) });
    if let Some(material) = v.of.strip_prefix(CASTING) {
        let note = "a pour each, with a tenth to spare";
        let bought = Bought { material, extra: POUR_EXTRA, note, count: m.times(v) };
        return (process.route != Route::LostWax).then_some(bought);
    }
    match v.of.as_str() {
        "investment, mixed" => None,
        MELT => one(&process.material, 1.0, "tree and a tenth"),
        of if of.contains("pour") => one("mold silicone", POUR_EXTRA, "with a tenth to spare"),
        of if of.starts_with("wax") => one("wax", 1.0, ""),
        of => one(of, 1.0, ""),
    }
}

fn pour_line(m: &MoldSheet, v: &Volume, process: &Process) -> Option<Line> {
    let b = bought(m, v, process)?;
    let mass_g = v.grams? * b.extra;
    Some(Line {
        what: format!("{}: {}", m.report.name, v.of),
        material: b.material.to_string(),
        count: b.count,
        volume_cm3: v.mm3 / MM3_IN_CM3 * b.extra,
        mass_g,
        total_g: mass_g * b.count as f64,
        note: b.note.to_string(),
    })
}
