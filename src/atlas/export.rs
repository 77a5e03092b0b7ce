//! Takes a table that is whole; gives its files: CSV, JSON, and the picture as SVG and PNG.
//!
//! Promised: the same table gives the same bytes. Not promised: that the CSV holds everything; the verdicts behind each
//! least repetition stand in the JSON.

use super::journal::unwritable;
use super::picture::sheet;
use super::row::{AtPhase, Row};
use super::table::Ask;
use crate::fault::Faults;
use crate::report::file::write_whole;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A whole table; its JSON file is this.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Final<'a> {
    pub ask: Ask,
    pub rows: &'a [Row],
}

/// What was written, in order.
pub struct Files(pub Vec<PathBuf>);

impl Files {
    pub fn write(table: &Final, folder: &Path) -> Result<Files, Faults> {
        let picture = sheet(table.rows, &table.ask);
        let all = [
            ("atlas.csv", csv(table).into_bytes()),
            ("atlas.json", json(table).into_bytes()),
            ("atlas.svg", picture.svg().into_bytes()),
            ("atlas.png", picture.png().map_err(|e| unwritable(folder, &e))?),
        ];
        let put = |(name, bytes): (&str, Vec<u8>)| {
            let path = folder.join(name);
            write_whole(&path, &bytes).map_err(|e| unwritable(&path, &e.source))?;
            Ok(path)
        };
        Ok(Files(all.into_iter().map(put).collect::<Result<_, Faults>>()?))
    }
}

fn json(table: &Final) -> String {
    serde_json::to_string_pretty(table).unwrap_or_default() + "\n"
}

/// Columns of the CSV file. `repeat_by_phase`: from phase 0 on, `-` where none up to `most` locks, `?` where one is
/// undecided. `equivalents`: other names of the cloth, with how they follow.
const COLUMNS: &str = "a,b,c,n,family,tile,warp_is,assembly,minimal_repeat,repeat_by_phase,most,flexible_minimum,\
flexible_lower,flexible_upper,flexible_status,release_clearance_low,release_clearance_high,release_clearance_status,\
equivalents,note,rise,lift,cover,samples";

fn csv(table: &Final) -> String {
    let rows: String =
        table.rows.iter().map(|r| fields(r, &table.ask).map(quoted).join(",") + "\n").collect();
    format!("{COLUMNS}\n{rows}")
}

fn fields(row: &Row, ask: &Ask) -> [String; 24] {
    let word = |v: Result<serde_json::Value, _>| {
        v.ok().and_then(|v: serde_json::Value| v.as_str().map(String::from)).unwrap_or_default()
    };
    let or_empty = |v: Option<String>| v.unwrap_or_default();
    let number = |v: Option<usize>| or_empty(v.map(|v| v.to_string()));
    let length = |v: Option<f64>| or_empty(v.map(|v| v.to_string()));
    let (f, r, s) = (&row.flexible, &row.release_clearance, &ask.settings);
    let phases: Vec<String> = row.by_phase.iter().map(told).collect();
    let others: Vec<String> = row.equivalents.iter().map(|e| format!("{} {}", e.abc, e.by.word())).collect();
    [
        row.a.to_string(),
        row.b.to_string(),
        row.c.to_string(),
        row.n.to_string(),
        row.family.clone(),
        word(serde_json::to_value(row.tile)),
        word(serde_json::to_value(row.warp_is)),
        word(serde_json::to_value(row.assembly)),
        or_empty(row.minimal_repeat.map(|k| k.to_string())),
        phases.join(" "),
        ask.most.to_string(),
        number(f.minimum),
        number(f.lower_bound),
        number(f.upper_bound),
        f.status.word().into(),
        length(r.low),
        length(r.high),
        r.status.word().into(),
        others.join("; "),
        row.note.clone(),
        s.rise.to_string(),
        s.lift.to_string(),
        s.cover.to_string(),
        s.samples.to_string(),
    ]
}

/// Least k at a phase, `-` or `?`.
pub fn told(at: &AtPhase) -> String {
    let undecided = at.tried.last().is_some_and(|t| t.rigid == "undecided");
    at.least.map_or(if undecided { "?" } else { "-" }.into(), |k| k.to_string())
}

/// A field as RFC 4180 has it.
fn quoted(field: String) -> String {
    if field.contains([',', '"', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field }
}
