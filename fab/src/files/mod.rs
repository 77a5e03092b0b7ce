//! Takes bytes and names; gives files that are whole or not there: written beside, then renamed all together.
//!
//! Not promised: that several renames are one; a machine that stops between two of them leaves some of the files.

pub mod moving;
pub mod obj;
pub mod stale;
pub mod stl;

use std::collections::BTreeSet;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that could not be written or read back.
#[derive(Debug, thiserror::Error)]
#[error("can not {action} {}: {cause} (hint: {})", path.display(), hint(cause))]
pub struct FileError {
    pub action: &'static str,
    pub path: PathBuf,
    pub cause: io::Error,
}

fn hint(cause: &io::Error) -> &'static str {
    match cause.kind() {
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
            "choose a folder that you may write to"
        }
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "the disk is full; free some space, nothing was left behind"
        }
        io::ErrorKind::NotADirectory | io::ErrorKind::AlreadyExists => {
            "a file stands where the folder should be"
        }
        io::ErrorKind::IsADirectory => "a folder stands where the file should be",
        io::ErrorKind::NotFound => "a folder on the way to it does not exist",
        _ => "nothing was left behind; try another folder",
    }
}

/// Files written beside their places, not yet in them. Dropping it removes them.
#[derive(Debug)]
pub struct Batch {
    folder: PathBuf,
    /// Folders that were made for this batch, outermost first.
    made: Vec<PathBuf>,
    staged: Vec<(PathBuf, PathBuf)>,
    /// Whoever finds it locked leaves the staged files alone.
    mark: Option<stale::Mark>,
}

impl Batch {
    /// A batch for a folder, which is made where it is missing.
    pub fn new(folder: &Path) -> Result<Batch, FileError> {
        let made: Vec<PathBuf> = folder
            .ancestors()
            .take_while(|p| !p.as_os_str().is_empty() && !p.exists())
            .map(Path::to_path_buf)
            .collect();
        let made = made.into_iter().rev().collect();
        let mut batch = Batch { folder: folder.to_path_buf(), made, staged: vec![], mark: None };
        fs::create_dir_all(folder).map_err(|cause| FileError {
            action: "make folder",
            path: folder.to_path_buf(),
            cause,
        })?;
        stale::clear(folder);
        batch.mark = stale::mark(folder);
        Ok(batch)
    }

    /// Writes a file beside its place; gives the path where it now is.
    pub fn stage(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<PathBuf, FileError> {
        let place = self.folder.join(name);
        let failed = |cause| FileError { action: "write", path: self.folder.join(name), cause };
        let (beside, file) = create_beside(&place).map_err(failed)?;
        self.staged.push((beside.clone(), place.clone()));
        let written = (|| {
            let mut out = BufWriter::new(file);
            write(&mut out)?;
            out.flush()?;
            out.get_ref().sync_all()
        })();
        written.map_err(|cause| FileError { action: "write", path: place, cause })?;
        Ok(beside)
    }

    /// Takes a staged file back.
    pub fn discard(&mut self, name: &str) {
        let place = self.folder.join(name);
        for (beside, _) in self.staged.extract_if(.., |(_, p)| *p == place) {
            let _ = fs::remove_file(beside);
        }
    }

    /// Puts all files in their places.
    pub fn commit(mut self) -> Result<(), FileError> {
        if let Some((_, place)) = self.staged.iter().find(|(_, place)| place.is_dir()) {
            let cause = io::ErrorKind::IsADirectory.into();
            return Err(FileError { action: "write", path: place.clone(), cause });
        }
        while let Some((beside, place)) = self.staged.first().cloned() {
            fs::rename(&beside, &place).map_err(|cause| FileError { action: "write", path: place, cause })?;
            self.staged.remove(0);
        }
        self.made.clear();
        Ok(())
    }
}

impl Drop for Batch {
    /// Removes what was not committed; what can not be removed can not be helped here.
    fn drop(&mut self) {
        for (beside, _) in &self.staged {
            let _ = fs::remove_file(beside);
        }
        drop(self.mark.take());
        for folder in self.made.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

/// A new file beside a place, with a name that nobody has.
fn create_beside(place: &Path) -> io::Result<(PathBuf, fs::File)> {
    let name = place.file_name().unwrap_or_default().to_string_lossy();
    let mut count = 0;
    loop {
        let beside = place.with_file_name(format!(".{name}.{}-{count}.part", std::process::id()));
        match fs::File::create_new(&beside) {
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => count += 1,
            made => return made.map(|file| (beside, file)),
        }
    }
}

/// A file name for each id: letters, digits, `-`, `_` and `.` stay, all else becomes `_`; no two are equal, also where
/// the disk does not tell upper from lower case.
pub fn stems(ids: &[String]) -> Vec<String> {
    let mut taken = BTreeSet::new();
    ids.iter()
        .map(|id| {
            let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
            let stem: String = id.chars().map(plain).take(LONGEST_STEM).collect();
            let stem = if stem.starts_with('.') || stem.is_empty() { format!("_{stem}") } else { stem };
            let name = |k: usize| if k == 1 { stem.clone() } else { format!("{stem}~{k}") };
            let free = (1..).map(name).find(|n| taken.insert(n.to_lowercase()));
            free.unwrap_or(stem)
        })
        .collect()
}

/// Characters of an id in a file name; file systems stop at 255 bytes, and endings are added.
const LONGEST_STEM: usize = 120;

#[cfg(test)]
mod tests {
    use super::*;

    fn scratch(name: &str) -> PathBuf {
        let dir = std::env::temp_dir().join(format!("weavelock-fab-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        dir
    }

    #[test]
    fn a_batch_that_fails_leaves_nothing_not_even_its_folder() {
        let dir = scratch("fails");
        let mut batch = Batch::new(&dir.join("deep")).unwrap();
        batch.stage("a.stl", |w| w.write_all(b"a")).unwrap();
        let full = batch.stage("b.stl", |_| Err(io::ErrorKind::StorageFull.into())).unwrap_err();
        assert!(full.to_string().contains("disk is full"), "{full}");
        drop(batch);
        assert!(!dir.exists());
    }

    #[test]
    fn a_committed_batch_is_all_there_and_nothing_else() {
        let dir = scratch("commits");
        let mut batch = Batch::new(&dir).unwrap();
        batch.stage("a.stl", |w| w.write_all(b"a")).unwrap();
        batch.commit().unwrap();
        let names: Vec<_> = fs::read_dir(&dir).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(names, ["a.stl"]);
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn a_file_where_the_folder_should_be_is_said_so() {
        let dir = scratch("file");
        fs::write(&dir, "x").unwrap();
        let e = Batch::new(&dir).unwrap_err();
        assert!(e.to_string().contains("stands where the folder should be"), "{e}");
        fs::remove_file(&dir).unwrap();
    }

    #[test]
    fn stems_are_plain_and_differ() {
        let ids = ["weft-0/1", "weft-0_1", "WEFT-0_1", "../x", "ü"].map(String::from);
        assert_eq!(stems(&ids), ["weft-0_1", "weft-0_1~2", "WEFT-0_1~3", "_.._x", "_"]);
    }
}
