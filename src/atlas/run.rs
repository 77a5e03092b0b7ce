//! Takes what the table is to hold, perhaps a shard of it, and a folder; gives the files there, rows appended as found.
//!
//! Promised: the files at the end do not depend on threads, stops and earlier runs. Rows are found in the order of the
//! table as far as threads allow, so small weaves come first.

use super::export::{Files, Final};
use super::journal::{Head, Journal, unwritable};
use super::row::{Row, row};
use super::table::{Ask, Shard, cost, share};
use super::weaves::Abc;
use crate::fault::{Fault, Faults};
use rayon::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// What stands in the folder now.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The rows that were asked for, in order.
    pub rows: Vec<Row>,
    /// How many of them were there before.
    pub found: usize,
    pub files: Vec<PathBuf>,
}

/// How far a run is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// The weave just done.
    pub abc: Abc,
    pub done: usize,
    pub all: usize,
    /// Work done in this run and left, in the same unit; a guess from a + b.
    pub worked: u64,
    pub left: u64,
}

/// A run as its workers share it.
struct Shared<F> {
    journal: Journal,
    progress: Progress,
    told: F,
}

/// Writes the table, or one shard of it, into `folder`, taking up what is there; `told` hears of every row that is added.
pub fn write(
    ask: &Ask,
    shard: Option<Shard>,
    folder: &Path,
    told: impl FnMut(Progress) + Send,
) -> Result<Written, Faults> {
    fs::create_dir_all(folder).map_err(|e| unwritable(folder, &e))?;
    let path = folder.join(shard.map_or("atlas.jsonl".into(), Shard::file));
    let journal = Journal::open(&path, Head::new(ask, shard))?;
    let all = share(ask, shard);
    let left: Vec<Abc> = all.iter().copied().filter(|abc| !journal.rows.contains_key(&abc.rank())).collect();
    let found = all.len() - left.len();
    let start = Progress {
        abc: Abc(0, 0, 0),
        done: found,
        all: all.len(),
        worked: 0,
        left: left.iter().map(|&abc| cost(abc)).sum(),
    };
    let shared = Mutex::new(Shared { journal, progress: start, told });
    left.into_iter().par_bridge().try_for_each(|abc| add(&shared, row(abc, ask)?))?;
    let shared = shared.into_inner().map_err(|_| ours("a row failed"))?;
    let rows = shared.journal.finish()?;
    let wanted: Vec<Row> = all.iter().filter_map(|abc| rows.get(&abc.rank()).cloned()).collect();
    let mut files = vec![path];
    if shard.is_none() {
        files.extend(Files::write(&Final { ask: *ask, rows: &wanted }, folder)?.0);
    }
    Ok(Written { rows: wanted, found, files })
}

fn add<F: FnMut(Progress)>(shared: &Mutex<Shared<F>>, row: Row) -> Result<(), Faults> {
    let mut shared = shared.lock().map_err(|_| ours("another row failed"))?;
    let abc = Abc(row.a, row.b, row.c);
    shared.journal.append(row)?;
    let Progress { done, worked, left, all, .. } = shared.progress;
    let work = cost(abc);
    shared.progress =
        Progress { abc, done: done + 1, all, worked: worked + work, left: left.saturating_sub(work) };
    let progress = shared.progress;
    (shared.told)(progress);
    Ok(())
}

fn ours(what: &str) -> Faults {
    let hint = "please report it; the rows that were found are kept, and the same command goes on".into();
    Fault { file: String::new(), place: None, key: String::new(), what: what.into(), hint }.into()
}
