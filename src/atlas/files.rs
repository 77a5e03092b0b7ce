//! Takes what the table is to hold and a folder; gives `atlas.jsonl` and `atlas.csv` there, rows appended as found.
//!
//! A run that was stopped is taken up where the file ends: whole rows are kept, a torn last line is found again. Refused:
//! a file whose rows are not the first ones of this table. Not promised: anything about two runs in one folder at a time.

use super::{Ask, Repeated, Row, rows, weaves};
use crate::fault::{Fault, Faults, Place};
use crate::report::file::write_whole;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What stands in the folder now.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    pub rows: Vec<Row>,
    /// Rows that were there before.
    pub found: usize,
    pub files: [PathBuf; 2],
}

/// Columns of the CSV file; `repeats` as `k translation rigid`, several separated by `; `.
const COLUMNS: &str = "a,b,c,family,tile,warp_is,minimal_repeat,most,repeats,note,rise,lift,cover,samples";

/// Writes the table into `folder`, taking up what is there; `each` is told of every row that is added.
pub fn write(ask: &Ask, folder: &Path, mut each: impl FnMut(&Row)) -> Result<Written, Faults> {
    let files = ["atlas.jsonl", "atlas.csv"].map(|name| folder.join(name));
    fs::create_dir_all(folder).map_err(|e| unwritable(folder, &e))?;
    let mut kept = read(ask, &files[0])?;
    let found = kept.len();
    // Both files are written anew up to here: a torn line goes, and the two agree.
    let lines: String = kept.iter().map(line).collect();
    let table: String = kept.iter().map(csv).collect();
    for (file, text) in files.iter().zip([lines, format!("{COLUMNS}\n{table}")]) {
        write_whole(file, text.as_bytes()).map_err(|e| unwritable(file, &e.source))?;
    }
    let mut open = files.each_ref().map(|file| OpenOptions::new().append(true).open(file));
    rows(ask, found, |row| {
        for ((file, path), text) in open.iter_mut().zip(&files).zip([line(&row), csv(&row)]) {
            append(file, &text).map_err(|e| unwritable(path, &e))?;
        }
        each(&row);
        kept.push(row);
        Ok::<(), Faults>(())
    })?;
    Ok(Written { rows: kept, found, files })
}

fn append(file: &mut io::Result<File>, text: &str) -> io::Result<()> {
    match file {
        Ok(file) => file.write_all(text.as_bytes()).and_then(|()| file.flush()),
        Err(e) => Err(io::Error::new(e.kind(), e.to_string())),
    }
}

/// The rows that are there already, checked to be the first of this table.
fn read(ask: &Ask, path: &Path) -> Result<Vec<Row>, Faults> {
    let text = match fs::read(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => return Err(fault(path, None, format!("cannot be read: {e}")).into()),
        Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
    };
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    let expected = weaves(ask.max_n);
    let mut rows = Vec::new();
    for (k, line) in whole.lines().enumerate() {
        let at = Some(Place { line: k + 1, column: 1 });
        let row: Row = serde_json::from_str(line)
            .map_err(|e| fault(path, at, format!("this is no row of an atlas: {e}")))?;
        // A table up to a smaller n is the beginning of this one, a larger one is kept whole.
        let follows = expected.get(k).is_none_or(|&abc| abc == (row.a, row.b, row.c));
        if !follows || row.most != ask.most || row.settings != ask.settings {
            return Err(
                fault(path, at, "this row is of another table (order or settings differ)".into()).into()
            );
        }
        rows.push(row);
    }
    Ok(rows)
}

fn fault(path: &Path, place: Option<Place>, what: String) -> Fault {
    let hint = "name another folder, or move the file away to begin anew".into();
    Fault { file: path.display().to_string(), place, key: String::new(), what, hint }
}

fn unwritable(path: &Path, e: &io::Error) -> Faults {
    let hint =
        "name a folder that can be written, with room on its disk; what was written is taken up again".into();
    let what = format!("cannot be written: {e}");
    Fault { file: path.display().to_string(), place: None, key: String::new(), what, hint }.into()
}

fn line(row: &Row) -> String {
    format!("{}\n", serde_json::to_string(row).unwrap_or_default())
}

fn csv(row: &Row) -> String {
    let word =
        |v: Option<serde_json::Value>| v.and_then(|v| v.as_str().map(String::from)).unwrap_or_default();
    let of = |r: &Repeated| format!("{} {} {}", r.k, r.translation, r.rigid);
    let s = &row.settings;
    let fields = [
        row.a.to_string(),
        row.b.to_string(),
        row.c.to_string(),
        row.family.clone(),
        word(serde_json::to_value(row.tile).ok()),
        word(serde_json::to_value(row.warp_is).ok()),
        row.minimal_repeat.map(|k| k.to_string()).unwrap_or_default(),
        row.most.to_string(),
        row.repeats.iter().map(of).collect::<Vec<_>>().join("; "),
        row.note.clone(),
        s.rise.to_string(),
        s.lift.to_string(),
        s.cover.to_string(),
        s.samples.to_string(),
    ];
    format!("{}\n", fields.map(quoted).join(","))
}

/// A field as RFC 4180 has it.
fn quoted(field: String) -> String {
    if field.contains([',', '"', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field }
}
