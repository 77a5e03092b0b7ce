//! Takes a folder in which files are written beside their places; gives a mark that says so while it goes on, and clears
//! what a killed run left there, after putting back what it had replaced.
//!
//! A mark is a locked file: the system frees the lock of whoever was killed. Not promised: anything where the disk knows
//! no locks; then nothing is marked, and nothing cleared.

use super::moving;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

const START: &str = ".weavelock-";
const END: &str = ".lock";

/// Works that one process has in one folder at a time.
const MOST: usize = 1000;

/// Says that this process writes in a folder. Dropping it takes it away.
#[derive(Debug)]
pub struct Mark {
    path: PathBuf,
    _file: File,
}

/// `None` where no mark can be set.
pub fn mark(folder: &Path) -> Option<Mark> {
    for count in 0..MOST {
        let path = folder.join(format!("{START}{}-{count}{END}", std::process::id()));
        match File::create_new(&path) {
            Ok(file) if file.try_lock().is_ok() => return Some(Mark { path, _file: file }),
            Ok(_) => {
                let _ = fs::remove_file(&path);
                return None;
            }
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            Err(_) => return None,
        }
    }
    None
}

impl Mark {
    /// Lets go of the lock and leaves the file: whoever comes next clears, as after a killed run.
    pub fn leave(self) {
        let path = self.path.clone();
        drop(self);
        let _ = File::create(path);
    }
}

impl Drop for Mark {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.path);
    }
}

/// Removes what runs left that are no more: their marks can be locked. What can not be removed stays.
pub fn clear(folder: &Path) {
    let names = || -> Vec<String> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|e| e.file_name().to_string_lossy().into_owned()).collect()
    };
    for name in names() {
        let Some(of) = name.strip_prefix(START).and_then(|n| n.strip_suffix(END)) else { continue };
        let Some((process, _)) = of.split_once('-') else { continue };
        let path = folder.join(&name);
        if !File::open(&path).is_ok_and(|f| f.try_lock().is_ok()) {
            continue;
        }
        for left in names().iter().filter(|n| is_of(n, process)) {
            let place = folder.join(place_of(left));
            let left = folder.join(left);
            // What a killed run had replaced comes back first; where it can not, it is kept.
            if left.is_dir() && moving::undo(&left, &place).is_err() {
                continue;
            }
            let _ = if left.is_dir() { fs::remove_dir_all(left) } else { fs::remove_file(left) };
        }
        let _ = fs::remove_file(path);
    }
}

/// Whether a name is of something unfinished by a process: `.NAME.PROCESS.part` or `.NAME.PROCESS-COUNT.part`.
fn is_of(name: &str, process: &str) -> bool {
    let stem = name.strip_prefix('.').and_then(|n| n.strip_suffix(".part"));
    let last = stem.and_then(|s| s.rsplit_once('.')).map(|s| s.1);
    last.is_some_and(|l| l.split_once('-').map_or(l, |s| s.0) == process)
}

/// The name of what a hidden folder is to become: `NAME` of `.NAME.PROCESS.part`.
fn place_of(hidden: &str) -> &str {
    let stem = hidden.strip_prefix('.').and_then(|n| n.strip_suffix(".part")).unwrap_or(hidden);
    stem.rsplit_once('.').map_or(stem, |s| s.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_dead_run_left_goes_and_what_a_live_one_writes_stays() {
        let dir = std::env::temp_dir().join(format!("weavelock-stale-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(dir.join(".out.99-.part")).unwrap();
        fs::create_dir_all(dir.join(".out.77.part/parts")).unwrap();
        let own = format!(".mine.{}-0.part", std::process::id());
        for name in [".a.stl.77-3.part", ".weavelock-77-0.lock", ".b.78.part", "c.77.part", &own] {
            fs::write(dir.join(name), "x").unwrap();
        }
        let live = mark(&dir).unwrap();
        clear(&dir);
        let mut names: Vec<String> =
            fs::read_dir(&dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.retain(|n| !n.ends_with(".lock"));
        names.sort();
        let mut kept = vec![".b.78.part".to_string(), own, ".out.99-.part".into(), "c.77.part".into()];
        kept.sort();
        assert_eq!(names, kept);
        drop(live);
        assert!(!fs::read_dir(&dir).unwrap().any(|e| e.unwrap().path().to_string_lossy().ends_with(".lock")));
        fs::remove_dir_all(&dir).unwrap();
    }
}
