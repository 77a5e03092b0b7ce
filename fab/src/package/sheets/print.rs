//! Takes a package's answer; gives the print sheet.
//!
//! Not promised: settings of a slicer beyond those named; whatever is not named is as the machine likes it.

use super::table::{range, short, table, value};
use crate::package::laying::Footing;
use crate::package::{LayingReport, PackageReport, PlateReport};
use crate::process::Process;
use crate::report::RouteReport;

/// `None` where nothing of its own shape is printed.
pub fn sheet(p: &PackageReport) -> Option<String> {
    let printed: Vec<&RouteReport> =
        p.report.routes.iter().filter(|r| p.plates.iter().any(|q| q.process == r.process.name)).collect();
    if printed.is_empty() {
        return None;
    }
    let mut s = format!("# Print sheet: {}\n", p.report.name);
    for r in printed {
        s += &format!("\n## {}: the {}s\n", r.process.title, r.process.route.printed());
        s += &settings(&r.process, r.scale);
        let plates = p.plates.iter().filter(|q| q.process == r.process.name);
        s += &table(&["plate", "bed", "stands on it", "filament"], plates.map(plate));
        let lies = p.layings.iter().filter(|l| r.parts.contains(&l.part));
        let mut lies = lies.peekable();
        if lies.peek().is_none() {
            continue;
        }
        s += "\nHow each lies (parts of the same shape alike):\n";
        let head = [
            "part",
            "down is (in the assembly)",
            "touches the bed, mm2",
            "overhangs, mm2",
            "height, mm",
            "layers",
            "",
        ];
        s += &table(&head, lies.map(|l| laying(l, r.process.print.layer.value)));
    }
    Some(s)
}

fn settings(process: &Process, scale: f64) -> String {
    let p = &process.print;
    let row = |what: &str, value: String, why: &str| vec![what.to_string(), value, why.to_string()];
    let chamfer = p.elephant_foot.value;
    let foot = if chamfer > 0.0 {
        format!("0 (a chamfer of {chamfer} mm is built in)")
    } else {
        "as your machine needs it (none is built in)".to_string()
    };
    let rows = [
        row("scale", "100 %".into(), &format!("{scale:.5} is already applied")),
        row("XY compensation, hole compensation", "0".into(), "the clearance is built in"),
        row("elephant foot compensation", foot, ""),
        row("material", p.material.clone(), ""),
        row("layer", value(&p.layer), &range(&p.layer)),
        row("infill", value(&p.infill), &range(&p.infill)),
        row("supports", p.supports.clone(), ""),
        row("arrange", "no".into(), "the parts stand where they should"),
    ];
    table(&["setting", "value", ""], rows)
}

fn plate(q: &PlateReport) -> Vec<String> {
    let [x, y, z] = q.bed_mm;
    let parts = q.stands.iter().map(|s| s.part.clone()).collect::<Vec<_>>().join(", ");
    let grams = q.grams.map_or("not sliced here".into(), |g| format!("{g:.1} g"));
    vec![format!("`{}`", q.file), format!("{} ({x} x {y} x {z} mm)", q.bed), parts, grams]
}

fn laying(l: &LayingReport, layer: f64) -> Vec<String> {
    let d = l.laying.down;
    let supports = match (l.laying.footing, l.laying.overhang_mm2 > 0.0) {
        (Footing::Tips, _) => "no flat face below: supports and a brim, or a raft",
        (Footing::Leans, _) => "supports below what overhangs, and a brim: it does not stand by itself",
        (Footing::Stands, true) => "supports below what overhangs",
        (Footing::Stands, false) => "no supports",
    };
    vec![
        l.part.clone(),
        format!("({}, {}, {})", short(d.x), short(d.y), short(d.z)),
        format!("{:.1}", l.laying.contact_mm2),
        format!("{:.1}", l.laying.overhang_mm2),
        format!("{:.2}", l.laying.height_mm),
        format!("{:.0}", (l.laying.height_mm / layer).ceil()),
        supports.to_string(),
    ]
}
