//! Takes an assembly with its contacts, and the moves of a plan; gives tables as CSV (RFC 4180), lengths in mm.
//!
//! Not promised: exact areas; they are sums over polygons in f64.

use crate::contact::{Joined, Patch};
use crate::report::moves::{Motion, Move};
use glam::DVec3;
use std::collections::BTreeMap;

/// A file: lines end with CR LF, a cell is quoted where it holds a comma, a quote or a line break.
pub fn csv(head: &[&str], rows: &[Vec<String>]) -> String {
    let cell = |c: &str| match c.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", c.replace('"', "\"\"")),
        false => c.to_string(),
    };
    let line = |cells: Vec<String>| cells.join(",") + "\r\n";
    let first = line(head.iter().map(|c| cell(c)).collect());
    let rest: String = rows.iter().map(|r| line(r.iter().map(|c| cell(c)).collect())).collect();
    first + &rest
}

/// Parts: id, shape, held, volume, box.
pub fn parts(joined: &Joined) -> String {
    let asm = &joined.assembly;
    let mm = asm.mm_per_unit;
    let row = |p: crate::assembly::PartIx| {
        let (lo, hi) = asm
            .vertices(p)
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        let part = asm.part(p);
        let held = part.mobility == crate::assembly::Mobility::Held;
        let volume = asm.solid(p).volume() * mm.powi(3);
        let ends = [lo * mm, hi * mm].into_iter().flat_map(|v| v.to_array());
        let mut row =
            vec![part.id.clone(), (part.solid + 1).to_string(), held.to_string(), volume.to_string()];
        row.extend(ends.map(|x| x.to_string()));
        row
    };
    let head = ["part", "shape", "held", "volume_mm3", "x0_mm", "y0_mm", "z0_mm", "x1_mm", "y1_mm", "z1_mm"];
    csv(&head, &asm.ids().map(row).collect::<Vec<_>>())
}

/// Pairs of parts that touch: patches and area.
pub fn contacts(joined: &Joined) -> String {
    let asm = &joined.assembly;
    let mut pairs: BTreeMap<(u32, u32), (usize, f64)> = BTreeMap::new();
    for p in &joined.patches {
        let sum = pairs.entry((p.a.0.min(p.b.0), p.a.0.max(p.b.0))).or_default();
        *sum = (sum.0 + 1, sum.1 + area(p) * asm.mm_per_unit.powi(2));
    }
    let id = |p: u32| asm.part(crate::assembly::PartIx(p)).id.clone();
    let row = |(&(a, b), (n, area)): (&(u32, u32), &(usize, f64))| {
        vec![id(a), id(b), n.to_string(), area.to_string()]
    };
    csv(&["a", "b", "patches", "area_mm2"], &pairs.iter().map(row).collect::<Vec<_>>())
}

fn area(patch: &Patch) -> f64 {
    let c = &patch.corners;
    let Some(&first) = c.first() else { return 0.0 };
    let fan = c.windows(2).map(|w| (w[0] - first).cross(w[1] - first)).sum::<DVec3>();
    fan.dot(patch.normal).abs() / 2.0
}

/// Steps, from assembled to apart: a row for each motion.
pub fn steps(moves: &[Move], ids: &[&str], mm: f64) -> String {
    let mut rows = Vec::new();
    for (k, step) in moves.iter().enumerate() {
        for mover in &step.movers {
            let parts: Vec<&str> = mover.parts.iter().map(|&p| ids[p]).collect();
            let mut row = vec![(k + 1).to_string(), parts.join(" ")];
            row.extend(numbers(&mover.motion, mm));
            rows.push(row);
        }
    }
    let head =
        ["step", "parts", "kind", "dx", "dy", "dz", "length_mm", "px_mm", "py_mm", "pz_mm", "angle_rad"];
    csv(&head, &rows)
}

fn numbers(motion: &Motion, mm: f64) -> Vec<String> {
    let text = |v: DVec3| v.to_array().map(|x| x.to_string());
    match *motion {
        Motion::Translation { by } => {
            let d = text(by.normalize_or_zero());
            [
                vec!["translation".into()],
                d.to_vec(),
                vec![(by.length() * mm).to_string()],
                vec![String::new(); 4],
            ]
            .concat()
        }
        Motion::Screw { point, axis, angle, advance } => {
            let ends = [vec![(advance * mm).to_string()], text(point * mm).to_vec(), vec![angle.to_string()]]
                .concat();
            [vec!["screw".into()], text(axis).to_vec(), ends].concat()
        }
    }
}
