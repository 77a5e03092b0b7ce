//! Takes files of shards (or folders of them) and a folder; gives the whole table there, as one run would have written it.
//!
//! Promised: refused, with nothing written, where tables differ, rows conflict or rows are missing; all such faults are
//! told at once. A row that stands in two files with the same content counts once.

use super::export::{Files, Final};
use super::journal::{Head, Rows, fault, json, rank, read, text, unwritable};
use super::row::Row;
use super::run::Written;
use super::table::{Ask, share};
use super::weaves::Abc;
use crate::fault::{Fault, Faults};
use crate::report::file::write_whole;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// A file with what it holds.
type Read = (PathBuf, Head, Rows);

/// Joins these into `folder`.
pub fn merge(inputs: &[PathBuf], folder: &Path) -> Result<Written, Faults> {
    let read = read_all(inputs)?;
    let ask = one_table(&read)?;
    let rows = joined(&read, &ask)?;
    fs::create_dir_all(folder).map_err(|e| unwritable(folder, &e))?;
    let path = folder.join("atlas.jsonl");
    write_whole(&path, text(&Head::new(&ask, None), &rows).as_bytes())
        .map_err(|e| unwritable(&path, &e.source))?;
    let rows: Vec<Row> = rows.into_values().collect();
    let mut files = vec![path];
    files.extend(Files::write(&Final { ask, rows: &rows }, folder)?.0);
    Ok(Written { found: rows.len(), rows, files })
}

const GIVE: &str =
    "give the files atlas.I-of-M.jsonl that `weavelock atlas --shard I/M` wrote, or their folders";

fn read_all(inputs: &[PathBuf]) -> Result<Vec<Read>, Faults> {
    let (mut faults, mut all) = (Vec::new(), Vec::new());
    for input in inputs {
        match files(input) {
            Err(fault) => faults.push(fault),
            Ok(paths) => {
                for path in paths {
                    match read(&path) {
                        Ok(Some((head, rows))) => all.push((path, head, rows)),
                        Ok(None) => faults.push(fault(&path, None, "holds no table".into(), GIVE)),
                        Err(Faults(more)) => faults.extend(more),
                    }
                }
            }
        }
    }
    Faults(faults).or(all)
}

/// The file itself, or the tables of a folder in the order of their names.
fn files(input: &Path) -> Result<Vec<PathBuf>, Fault> {
    let wrong = |what: String| fault(input, None, what, GIVE);
    if !input.is_dir() {
        return if input.is_file() { Ok(vec![input.into()]) } else { Err(wrong("is not there".into())) };
    }
    let entries = fs::read_dir(input).map_err(|e| wrong(format!("cannot be read: {e}")))?;
    let named = |p: &PathBuf| {
        let name = p.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        name.starts_with("atlas.") && name.ends_with(".jsonl")
    };
    let mut found: Vec<PathBuf> = entries.flatten().map(|e| e.path()).filter(named).collect();
    found.sort();
    if found.is_empty() { Err(wrong("this folder holds no atlas.*.jsonl".into())) } else { Ok(found) }
}

fn one_table(read: &[Read]) -> Result<Ask, Faults> {
    let Some((first, head, _)) = read.first() else {
        return Err(fault(Path::new("--merge"), None, "nothing to join".into(), GIVE).into());
    };
    let other = |(path, other, _): &Read| {
        let what = || {
            format!(
                "is another table than {}: {} against {}",
                first.display(),
                json(&other.ask),
                json(&head.ask)
            )
        };
        (other.ask != head.ask || other.atlas != head.atlas)
            .then(|| fault(path, None, what(), "run all shards with the same flags"))
    };
    Faults(read.iter().filter_map(other).collect()).or(head.ask)
}

/// All rows of the table, each once.
fn joined(read: &[Read], ask: &Ask) -> Result<Rows, Faults> {
    let mut faults = Vec::new();
    let mut from: BTreeMap<(u32, u32, i32), (&Path, &Row)> = BTreeMap::new();
    for (path, _, rows) in read {
        for row in rows.values() {
            match from.get(&rank(row)) {
                Some((other, known)) if *known != row => {
                    let name = Abc(row.a, row.b, row.c);
                    let what = format!("its row {name} differs from that of {}", other.display());
                    faults.push(fault(path, None, what, "one of the two is of another version of the program, or was changed; run that shard again"));
                }
                Some(_) => {}
                None => drop(from.insert(rank(row), (path, row))),
            }
        }
    }
    faults.extend(missing(read, ask, |abc| from.contains_key(&abc.rank())));
    let wanted: Vec<Abc> = share(ask, None);
    let rows =
        wanted.iter().filter_map(|abc| from.get(&abc.rank()).map(|(_, row)| (abc.rank(), (*row).clone())));
    Faults(faults).or(rows.collect())
}

/// Names listed of what is missing; the rest is counted.
const MOST_NAMES: usize = 12;

/// A fault that names the rows that no file has, and the shards that should have them.
fn missing(read: &[Read], ask: &Ask, has: impl Fn(Abc) -> bool) -> Option<Fault> {
    let lacking: Vec<Abc> = share(ask, None).into_iter().filter(|&abc| !has(abc)).collect();
    if lacking.is_empty() {
        return None;
    }
    let names: Vec<String> = lacking.iter().take(MOST_NAMES).map(Abc::to_string).collect();
    let more = if lacking.len() > MOST_NAMES {
        format!(" and {} more", lacking.len() - MOST_NAMES)
    } else {
        String::new()
    };
    let what = format!("{} rows are in no file: {}{more}", lacking.len(), names.join(", "));
    let count = read.iter().find_map(|(_, head, _)| head.shard.map(|s| s.count()));
    let hint = match count {
        Some(count) => {
            let all = super::table::deal(&share(ask, None), count as usize);
            let table = share(ask, None);
            let mut shards: Vec<usize> =
                table.iter().zip(all).filter(|(abc, _)| lacking.contains(abc)).map(|(_, s)| s + 1).collect();
            shards.sort_unstable();
            shards.dedup();
            let names: Vec<String> = shards.iter().map(|s| format!("{s}/{count}")).collect();
            format!("run (again) with --shard {}", names.join(", "))
        }
        None => "run the table to its end".into(),
    };
    Some(fault(Path::new("--merge"), None, what, &hint))
}
