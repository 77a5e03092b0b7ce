//! Takes bytes and a path, gives a file that is there whole or not at all.
//!
//! Not promised: that it survives a power cut between rename and the disk's own flush of the folder.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file that could not be written; nothing is left behind under its name or beside it.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {source}", path.display())]
pub struct WriteError {
    pub path: PathBuf,
    #[source]
    pub source: io::Error,
}

/// Writes beside the target, then renames over it.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let beside = beside(path);
    let written = fill(&beside, bytes).and_then(|()| fs::rename(&beside, path));
    written.map_err(|source| {
        // The first fault is the news; a second one while tidying up would only hide it.
        let _ = fs::remove_file(&beside);
        WriteError { path: path.to_path_buf(), source }
    })
}

fn fill(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// A name in the same folder (a rename must not cross disks), told apart by process so that two runs do not collide.
fn beside(path: &Path) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}
