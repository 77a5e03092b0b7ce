//! Takes a package's answer; gives the shrinkage ledger with the fits it leads to, and the sheet of the coupon.
//!
//! Not promised: that figures hold for the machine at hand; that is what the coupon is for.

use super::table::{short, table};
use crate::ledger::Entry;
use crate::package::{CouponReport, PackageReport};
use crate::process::COUPON_MM;
use crate::report::RouteReport;

pub fn sheet(p: &PackageReport) -> String {
    let mut s = format!(
        "# Shrinkage ledger: {}\n\nEach step after the file takes a length L to L (1 - s); the master is larger by the product of 1 / (1 - s).\n",
        p.report.name
    );
    for r in &p.report.routes {
        s += &format!("\n## {} ({})\n", r.process.title, r.process.name);
        let row = |e: &Entry| {
            vec![
                e.step.clone(),
                format!("{} %", short(e.shrinkage_percent)),
                format!("{} to {}", short(e.low_percent), short(e.high_percent)),
                format!("{:.6}", e.factor),
                format!("{:.6}", e.product),
                e.source.clone(),
                e.grade.sign().to_string(),
            ]
        };
        s += &table(
            &["step", "shrinks by", "range", "factor", "product so far", "source", "grade"],
            r.ledger.iter().map(row),
        );
        let (low, high) = r.scale_range;
        s += &format!(
            "\nMaster = {:.6} x finished (from {low:.6} to {high:.6} at the ends of the ranges). Air on each face: {} mm finished, {} mm on the master ({}, grade {}).\n",
            r.scale,
            r.process.clearance.value,
            short(r.process.clearance.value * r.scale),
            r.process.clearance.source,
            r.process.clearance.grade.sign()
        );
        s += &sizes(p, r);
    }
    s + &fits(p)
}

/// What a caliper should find.
fn sizes(p: &PackageReport, r: &RouteReport) -> String {
    let row = |q: &crate::report::PartReport| {
        let size = q.read_back.high? - q.read_back.low?;
        let text = |k: f64| format!("{:.2} x {:.2} x {:.2}", size.x / k, size.y / k, size.z / k);
        Some(vec![q.id.clone(), text(1.0), text(q.scale)])
    };
    let mine = p.report.parts.iter().filter(|q| r.parts.contains(&q.id));
    table(&["part", "master, x y z in the assembly, mm", "finished, mm"], mine.filter_map(row))
}

fn fits(p: &PackageReport) -> String {
    let mut s = "\n## The parts fit\n\nEvery file was read back, taken down to finished size by its own ledger, and the least gap measured between the two.\n".to_string();
    let route = |id: &str| p.report.parts.iter().find(|q| q.id == id).map_or("", |q| q.process.as_str());
    let row = |g: &crate::gap::Gap| {
        vec![
            g.a.clone(),
            route(&g.a).to_string(),
            g.b.clone(),
            route(&g.b).to_string(),
            format!("{:.4}", g.promised_mm),
            format!("{:.4}", g.least_mm),
            format!("{:?}", g.verdict).to_lowercase(),
        ]
    };
    s += &table(
        &["part", "by", "part", "by", "promised, mm", "least gap, mm", ""],
        p.report.gaps.iter().map(row),
    );
    s
}

pub fn coupon(p: &PackageReport) -> String {
    let mut s = format!(
        "# Coupon: measure before you make\n\nThe coupon is drawn at its true size. Print it at 100 % with the settings of the parts, take it through every step that the parts go through (a mold of it, where they are molded), and measure it after each.\n\n1. **Shrinkage.** Both bars of the L are {COUPON_MM} mm long, outside to outside. Measure both cold, take the mean. Where it is not what the table says, make the package again:\n\n       weavelock fab FILE --measured STEP=LENGTH\n\n   with the length in mm after that step, as in `--measured print=59.80`; several steps with commas. In the spec the same is `[fab.shrinkage]` with `print = \"0.33 %\"`.\n2. **Clearance.** Push the key into the notches, number 1 next to the corner. The first in which it slides without force, and does not rattle, is your fit:\n\n       weavelock fab FILE --clearance \"0.25 mm\"\n\n   or `clearance = \"0.25 mm\"` in the spec's `[fab]`.\n",
    );
    let several = p.coupons.len() > 1;
    if several {
        s += "\n`--clearance` without a name holds for every process, `--clearance \"PROCESS=LENGTH\"` for that one alone (`[fab.clearances]` in the spec); likewise `--measured PROCESS:STEP=LENGTH`.\n";
    }
    for CouponReport { process, coupon: c } in &p.coupons {
        let Some(r) = p.report.routes.iter().find(|r| r.process.name == *process) else { continue };
        s += &format!("\n## {}\n", r.process.title);
        let mut length = c.bar_mm;
        let of = if several { format!("{process}:") } else { String::new() };
        let expected = |e: &Entry| {
            length *= 1.0 - e.shrinkage_percent / 100.0;
            vec![
                format!("after {}", e.step),
                format!("{length:.2} mm"),
                format!("`--measured {of}{}=...`", e.step),
            ]
        };
        s += &table(
            &["bar of the L", "expected", "where to put your figure"],
            r.ledger.iter().map(expected).collect::<Vec<_>>(),
        );
        let notch = |n: &crate::coupon::Notch| {
            vec![
                n.number.to_string(),
                format!("{:.2} mm", n.width_mm),
                format!("{} mm", short(n.clearance_mm)),
            ]
        };
        s += &table(&["notch", "width as drawn", "air on each face"], c.notches.iter().map(notch));
        s += &format!(
            "The key is {:.2} mm wide; built in now: {} mm on each face; yours goes into `--clearance \"{}... mm\"`.\n",
            c.key_mm,
            r.process.clearance.value,
            if several { format!("{process}=") } else { String::new() }
        );
    }
    s
}
