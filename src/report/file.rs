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

/// Finds out before the work that ends in a file whether there is a folder for it, and no folder in its place.
pub fn file_can_be_made(path: &Path) -> Result<(), WriteError> {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty());
    let (kind, why) = match folder {
        _ if path.is_dir() || path.file_name().is_none() => {
            (io::ErrorKind::IsADirectory, "this is a folder".into())
        }
        Some(folder) if !folder.exists() => {
            (io::ErrorKind::NotFound, format!("there is no folder {}", folder.display()))
        }
        Some(folder) if !folder.is_dir() => {
            (io::ErrorKind::NotADirectory, format!("{} is no folder", folder.display()))
        }
        _ => return Ok(()),
    };
    Err(WriteError { path: path.to_path_buf(), source: io::Error::new(kind, why) })
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
