//! Takes a file's path and the head of its table; gives the rows that are there and a place to append more.
//!
//! Promised: a row is there whole or not at all, however the program ends: each is written in one piece with its line end
//! and flushed to the disk before the next, and a torn last line is cut off when the file is opened again. Rows stand in
//! the order in which they were found; `finish` puts them in the table's. A second run on the same file is refused where
//! the system has file locks. Not promised: anything about files changed by others.

use super::row::Row;
use super::table::{Ask, Shard};
use super::weaves::Abc;
use crate::fault::{Fault, Faults, Place};
use crate::report::file::write_whole;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// First line of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Version of the file's form.
    pub atlas: u32,
    pub shard: Option<Shard>,
    pub ask: Ask,
}

/// The form that is written here.
const FORM: u32 = 2;

impl Head {
    pub fn new(ask: &Ask, shard: Option<Shard>) -> Head {
        Head { atlas: FORM, shard, ask: *ask }
    }
}

/// Rows in the order of the table.
pub type Rows = BTreeMap<(u32, u32, i32), Row>;

/// A file that rows are appended to.
pub struct Journal {
    path: PathBuf,
    file: File,
    head: Head,
    pub rows: Rows,
}

impl Journal {
    /// Opens or begins the file; rows of a table that agrees but for its size are kept.
    pub fn open(path: &Path, head: Head) -> Result<Journal, Faults> {
        let old =
            OpenOptions::new().create(true).append(true).open(path).map_err(|e| unwritable(path, &e))?;
        lock(&old, path)?;
        let rows = match read(path)? {
            Some((found, rows)) => {
                same(path, &found, &head)?;
                rows
            }
            None => Rows::new(),
        };
        // A torn line goes, and the head says what is asked for now; the new file is locked before it gets its name.
        write_whole(path, text(&head, &rows).as_bytes()).map_err(|e| unwritable(path, &e.source))?;
        let file = OpenOptions::new().append(true).open(path).map_err(|e| unwritable(path, &e))?;
        lock(&file, path)?;
        Ok(Journal { path: path.into(), file, head, rows })
    }

    pub fn append(&mut self, row: Row) -> Result<(), Faults> {
        let line = line(&row);
        let written = self.file.write_all(line.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|e| unwritable(&self.path, &e))?;
        self.rows.insert(rank(&row), row);
        Ok(())
    }

    /// The file with its rows in the order of the table.
    pub fn finish(self) -> Result<Rows, Faults> {
        write_whole(&self.path, text(&self.head, &self.rows).as_bytes())
            .map_err(|e| unwritable(&self.path, &e.source))?;
        Ok(self.rows)
    }
}

pub fn rank(row: &Row) -> (u32, u32, i32) {
    Abc(row.a, row.b, row.c).rank()
}

/// The file's text.
pub fn text(head: &Head, rows: &Rows) -> String {
    let head = serde_json::to_string(head).unwrap_or_default();
    std::iter::once(format!("{head}\n")).chain(rows.values().map(line)).collect()
}

fn line(row: &Row) -> String {
    format!("{}\n", serde_json::to_string(row).unwrap_or_default())
}

fn lock(file: &File, path: &Path) -> Result<(), Faults> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => {
            let hint = "wait until it ends, stop it, or name another folder";
            Err(fault(path, None, "another run is writing this table".into(), hint).into())
        }
        // Where the system has no locks there is nothing to hold.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}

const ANEW: &str = "name another folder with --out, or move the file away to begin anew";

/// Head and rows of a file; none where it does not exist or ends before its head does.
pub fn read(path: &Path) -> Result<Option<(Head, Rows)>, Faults> {
    let text = match fs::read(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(fault(path, None, format!("cannot be read: {e}"), ANEW).into()),
        Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
    };
    // What follows the last line end was being written when the program was stopped.
    let Some(end) = text.rfind('\n') else { return Ok(None) };
    let mut lines = text[..end].lines().enumerate();
    let at = |k: usize| Some(Place { line: k + 1, column: 1 });
    let wrong = |k, what: &str, e: serde_json::Error| fault(path, at(k), format!("{what}: {e}"), ANEW);
    let Some((k, first)) = lines.next() else { return Ok(None) };
    let head: Head = serde_json::from_str(first)
        .map_err(|e| wrong(k, "this is no head of an atlas of this program", e))?;
    let mut rows = Rows::new();
    for (k, line) in lines {
        let row: Row = serde_json::from_str(line).map_err(|e| wrong(k, "this is no row of an atlas", e))?;
        let name = Abc(row.a, row.b, row.c);
        if rows.insert(name.rank(), row).is_some() {
            return Err(fault(path, at(k), format!("{name} has a row already"), ANEW).into());
        }
    }
    Ok(Some((head, rows)))
}

fn same(path: &Path, found: &Head, asked: &Head) -> Result<(), Faults> {
    let what = if found.atlas != asked.atlas {
        format!("was written in form {}, this program writes form {}", found.atlas, asked.atlas)
    } else if found.shard != asked.shard {
        "holds another shard".into()
    } else if !asked.ask.agrees(&found.ask) || (asked.shard.is_some() && found.ask != asked.ask) {
        format!("is another table: it was asked for {}", json(&found.ask))
    } else {
        return Ok(());
    };
    Err(fault(path, None, what, ANEW).into())
}

pub fn json(ask: &Ask) -> String {
    serde_json::to_string(ask).unwrap_or_default()
}

pub fn fault(path: &Path, place: Option<Place>, what: String, hint: &str) -> Fault {
    Fault { file: path.display().to_string(), place, key: String::new(), what, hint: hint.into() }
}

pub fn unwritable(path: &Path, e: &io::Error) -> Faults {
    let hint = "name a folder that can be written, with room on its disk; what was written is taken up again";
    fault(path, None, format!("cannot be written: {e}"), hint).into()
}
