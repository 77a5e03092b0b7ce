//! Takes files one by one; gives a folder that appears whole or not at all.
//!
//! Everything is written into a folder beside, which is renamed in the end. Where the folder is there already its other
//! files stay; a file of the same name is never replaced unasked. Not promised: that a run which is killed while files
//! are moved into a folder that is there leaves either all or none of them: the list is not there then, and the next run
//! into a folder beside it puts back what was, and clears what it left.

use crate::files::{FileError, moving, stale};
use std::collections::BTreeSet;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Whether files that are there may be replaced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Replace {
    Never,
    /// With `--force`.
    Allowed,
}

/// A folder being filled. Dropping it removes what is in it.
#[derive(Debug)]
pub struct Folder {
    place: PathBuf,
    beside: PathBuf,
    replace: Replace,
    /// The file that lists the package.
    list: String,
    /// Whether the hidden folder holds what could not be put back.
    keep: bool,
    /// Folders that were made on the way to it, outermost first.
    made: Vec<PathBuf>,
    /// Whoever finds it locked leaves the hidden folder alone.
    mark: Option<stale::Mark>,
}

fn failed(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> FileError {
    let path = path.to_path_buf();
    move |cause| FileError { action, path, cause }
}

impl Folder {
    /// Starts a folder; refuses at once where the list of a package lies there already.
    pub fn new(place: &Path, replace: Replace, list: &str) -> Result<Folder, FileError> {
        let absolute = std::path::absolute(place).map_err(failed("make folder", place))?;
        let parent = absolute.parent().unwrap_or(Path::new("/")).to_path_buf();
        // First: a killed run may have taken the list aside.
        stale::clear(&parent);
        if replace == Replace::Never && place.join(list).exists() {
            return Err(there(&place.join(list)));
        }
        if place.exists() && !place.is_dir() {
            return Err(failed("make folder", place)(io::ErrorKind::NotADirectory.into()));
        }
        let made: Vec<PathBuf> =
            parent.ancestors().take_while(|p| !p.exists()).map(Path::to_path_buf).collect();
        let name = absolute.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let beside = parent.join(format!(".{name}.{}.part", std::process::id()));
        let made: Vec<PathBuf> = made.into_iter().rev().collect();
        let list = list.to_string();
        let mut folder = Folder { place: absolute, beside, replace, list, keep: false, made, mark: None };
        // One that a killed run of the same number left is nobody's.
        let _ = fs::remove_dir_all(&folder.beside);
        // The mark comes first: whoever is killed after it is cleared.
        fs::create_dir_all(&parent).map_err(failed("make folder", place))?;
        folder.mark = stale::mark(&parent);
        fs::create_dir_all(&folder.beside).map_err(failed("make folder", place))?;
        Ok(folder)
    }

    /// Where files are until the end.
    pub fn path(&self) -> &Path {
        &self.beside
    }

    /// Writes a file, its folders too.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), FileError> {
        let (path, shown) = (self.beside.join(name), self.place.join(name));
        let written = (|| {
            path.parent().map_or(Ok(()), fs::create_dir_all)?;
            let mut file = fs::File::create_new(&path)?;
            file.write_all(bytes)?;
            file.sync_all()
        })();
        written.map_err(failed("write", &shown))
    }

    /// All files so far, by their names below the folder, sorted.
    pub fn names(&self) -> Result<Vec<String>, FileError> {
        let mut names = Vec::new();
        let mut todo = vec![self.beside.clone()];
        while let Some(folder) = todo.pop() {
            for entry in fs::read_dir(&folder).map_err(failed("read", &folder))? {
                let path = entry.map_err(failed("read", &folder))?.path();
                match path.is_dir() {
                    true => todo.push(path),
                    false => names.push(self.below(&path)),
                }
            }
        }
        names.sort();
        Ok(names)
    }

    fn below(&self, path: &Path) -> String {
        let inside = path.strip_prefix(&self.beside).unwrap_or(path);
        inside.components().map(|c| c.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
    }

    /// Puts the folder in its place. `stale`: files of an earlier package, which go where they are not written anew.
    pub fn commit(mut self, stale: &[String]) -> Result<(), FileError> {
        if !self.place.exists() {
            fs::rename(&self.beside, &self.place).map_err(failed("make folder", &self.place))?;
            self.made.clear();
            return Ok(());
        }
        let names = self.names()?;
        if self.replace == Replace::Never
            && let Some(name) = names.iter().find(|n| self.place.join(n).exists())
        {
            return Err(there(&self.place.join(name)));
        }
        if let Some(folder) = names.iter().map(|n| self.place.join(n)).find(|p| p.is_dir()) {
            return Err(failed("write", &folder)(io::ErrorKind::IsADirectory.into()));
        }
        self.merge(names, stale)?;
        self.made.clear();
        Ok(())
    }

    /// Moves files into a folder that is there; what stood in their way is kept aside until all are in.
    fn merge(&mut self, names: Vec<String>, stale: &[String]) -> Result<(), FileError> {
        let plan = self.plan(names, stale);
        moving::begin(&self.beside, &plan).map_err(failed("write", &self.place))?;
        let moved = moving::go(&self.beside, &self.place, &plan)
            .and_then(|()| moving::done(&self.beside).map_err(|cause| (self.place.clone(), cause)));
        // What can not be moved back stays aside, with its note, for the next run.
        self.keep = moved.is_err() && moving::undo(&self.beside, &self.place).is_err();
        moved.map_err(|(path, cause)| FileError { action: "write", path, cause })
    }

    /// The list goes first and comes last: a folder without it is no package.
    fn plan(&self, mut come: Vec<String>, stale: &[String]) -> moving::Plan {
        let new: BTreeSet<&String> = come.iter().collect();
        let listed = new.contains(&self.list).then(|| self.list.clone());
        let go = listed.into_iter().chain(stale.iter().filter(|n| !new.contains(n)).cloned()).collect();
        come.sort_by_key(|n| *n == self.list);
        moving::Plan { go, come }
    }
}

fn there(path: &Path) -> FileError {
    FileError {
        action: "write",
        path: path.to_path_buf(),
        cause: io::Error::other("it is there already, and is replaced only with --force"),
    }
}

impl Drop for Folder {
    /// Removes what was not committed; what can not be removed can not be helped here.
    fn drop(&mut self) {
        if self.keep {
            // The mark stays, unlocked: the next run puts back what it can.
            self.mark.take().into_iter().for_each(stale::Mark::leave);
            return;
        }
        let _ = fs::remove_dir_all(&self.beside);
        drop(self.mark.take());
        for folder in self.made.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scratch(name: &str) -> PathBuf {
        let dir = std::env::temp_dir().join(format!("weavelock-folder-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        dir
    }

    #[test]
    fn a_folder_appears_whole_and_is_not_replaced_unasked() {
        let dir = scratch("whole");
        let out = dir.join("a/out");
        let make = |replace, text: &str, names: &[&str], stale: &[String]| {
            let list = if names.contains(&"list.json") { "list.json" } else { "no list" };
            let folder = Folder::new(&out, replace, list)?;
            names.iter().try_for_each(|n| folder.write(n, text.as_bytes()))?;
            assert!(text != "one" || !out.exists());
            folder.commit(stale)
        };
        make(Replace::Never, "one", &["list.json", "x/y"], &[]).unwrap();
        let again = make(Replace::Never, "two", &["list.json"], &[]).unwrap_err();
        assert!(again.to_string().contains("--force"), "{again}");
        fs::write(out.join("mine"), "mine").unwrap();
        let other = make(Replace::Never, "three", &["other", "mine"], &[]).unwrap_err();
        assert!(other.to_string().contains("mine") && !out.join("other").exists(), "{other}");
        make(Replace::Allowed, "four", &["list.json", "z"], &["x/y".to_string()]).unwrap();
        let read = |n: &str| fs::read_to_string(out.join(n)).ok();
        assert_eq!(
            ["list.json", "z", "mine", "x/y"].map(read),
            [Some("four".into()), Some("four".into()), Some("mine".into()), None]
        );
        let names: Vec<_> = fs::read_dir(dir.join("a")).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(names, ["out"], "nothing is left beside");
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn what_is_not_committed_leaves_nothing_not_even_folders_on_the_way() {
        let dir = scratch("dropped");
        let folder = Folder::new(&dir.join("b/out"), Replace::Never, "list.json").unwrap();
        folder.write("x", b"x").unwrap();
        drop(folder);
        assert!(!dir.exists());
    }
}
