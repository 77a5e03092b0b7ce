//! Takes a hidden folder of finished files and the place beside it; moves them there by a note, from which the next run
//! undoes what a killed one had moved.
//!
//! Not promised: anything after a machine stops, where the disk forgets what was written last; the files of the place
//! between a kill and the next run, of which some are new and some old.

use serde::{Deserialize, Serialize};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Where replaced files wait; no file of a package starts with a dot.
pub const ASIDE: &str = ".replaced";

/// The note.
const NOTE: &str = ".moving";

/// What is about to be moved, by names below the hidden folder and the place alike.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Files of the place that go and are not replaced.
    pub go: Vec<String>,
    /// Files that come, whatever stands in their way.
    pub come: Vec<String>,
}

/// Notes in a hidden folder what is about to be moved.
pub fn begin(hidden: &Path, plan: &Plan) -> io::Result<()> {
    let mut file = fs::File::create_new(hidden.join(NOTE))?;
    file.write_all(&serde_json::to_vec(plan)?)?;
    file.sync_all()
}

/// Moves all of it: what stands in the way goes aside first.
pub fn go(hidden: &Path, place: &Path, plan: &Plan) -> Result<(), (PathBuf, io::Error)> {
    for (name, comes) in plan.go.iter().map(|n| (n, false)).chain(plan.come.iter().map(|n| (n, true))) {
        let to = place.join(name);
        let told = |cause| (to.clone(), cause);
        if to.exists() {
            step(&to, &hidden.join(ASIDE).join(name)).map_err(told)?;
        }
        if comes {
            step(&hidden.join(name), &to).map_err(told)?;
        }
    }
    Ok(())
}

fn step(from: &Path, to: &Path) -> io::Result<()> {
    to.parent().map_or(Ok(()), fs::create_dir_all)?;
    fs::rename(from, to)
}

/// All is in its place: from here on nothing is undone.
pub fn done(hidden: &Path) -> io::Result<()> {
    fs::remove_file(hidden.join(NOTE))
}

/// Puts the place back to what it was before anything was moved; without a note nothing was. `Err`: it could not be, and
/// the hidden folder still holds what was replaced.
pub fn undo(hidden: &Path, place: &Path) -> io::Result<()> {
    let note = match fs::read(hidden.join(NOTE)) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
        note => note?,
    };
    // One that was cut short was not yet acted on.
    let Ok(plan) = serde_json::from_slice::<Plan>(&note) else { return Ok(()) };
    // Whoever took the place away does not want it back.
    if !place.is_dir() {
        return Ok(());
    }
    for name in plan.come.iter().filter(|n| !hidden.join(n).exists()) {
        let to = place.join(name);
        if to.exists() {
            fs::remove_file(&to)?;
            prune(place, Path::new(name));
        }
    }
    for name in plan.go.iter().chain(&plan.come) {
        let aside = hidden.join(ASIDE).join(name);
        if aside.exists() {
            step(&aside, &place.join(name))?;
        }
    }
    Ok(())
}

/// Takes away folders of a name that hold nothing any more.
fn prune(place: &Path, name: &Path) {
    for folder in name.ancestors().skip(1).filter(|f| !f.as_os_str().is_empty()) {
        if fs::remove_dir(place.join(folder)).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn all(folder: &Path) -> BTreeMap<String, String> {
        let mut found = BTreeMap::new();
        for path in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                found.extend(all(&path).into_iter().map(|(n, t)| (format!("{name}/{n}"), t)));
                found.insert(name, "folder".into());
            } else {
                found.insert(name, fs::read_to_string(&path).unwrap());
            }
        }
        found
    }

    /// Moving is cut off after every number of renames, as a kill would.
    #[test]
    fn wherever_moving_is_cut_off_the_place_is_as_it_was() {
        let dir = std::env::temp_dir().join(format!("weavelock-moving-{}", std::process::id()));
        let (hidden, place) = (dir.join(".p.7.part"), dir.join("p"));
        let list = |names: &[&str]| names.iter().map(ToString::to_string).collect::<Vec<_>>();
        let plan = Plan { go: list(&["list", "gone"]), come: list(&["new/x", "kept", "a/b", "list"]) };
        let lay_out = || {
            let _ = fs::remove_dir_all(&dir);
            for (folder, names, text) in [
                (&place, vec!["list", "gone", "kept", "a/b", "mine"], "old"),
                (&hidden, vec!["new/x", "kept", "a/b", "list"], "new"),
            ] {
                for name in names {
                    fs::create_dir_all(folder.join(name).parent().unwrap()).unwrap();
                    fs::write(folder.join(name), text).unwrap();
                }
            }
            begin(&hidden, &plan).unwrap();
            all(&place)
        };
        for steps in 0..=8 {
            let before = lay_out();
            cut_off(&hidden, &place, &plan, steps);
            assert!(steps == 0 || all(&place) != before, "{steps}");
            undo(&hidden, &place).unwrap();
            assert_eq!(all(&place), before, "{steps}");
        }
        lay_out();
        go(&hidden, &place, &plan).unwrap();
        done(&hidden).unwrap();
        undo(&hidden, &place).unwrap();
        let now = all(&place);
        assert_eq!(
            [&now["kept"], &now["new/x"], &now["mine"]],
            ["new", "new", "old"],
            "what is done is not undone"
        );
        assert!(!now.contains_key("gone"));
        fs::remove_dir_all(&dir).unwrap();
    }

    /// The first renames of `go`.
    fn cut_off(hidden: &Path, place: &Path, plan: &Plan, steps: usize) {
        let aside = |n: &String| (place.join(n), hidden.join(ASIDE).join(n));
        let mut renames: Vec<(PathBuf, PathBuf)> = plan.go.iter().map(aside).collect();
        for name in &plan.come {
            renames.extend((name != "list" && place.join(name).exists()).then(|| aside(name)));
            renames.push((hidden.join(name), place.join(name)));
        }
        renames.iter().take(steps).for_each(|(from, to)| super::step(from, to).unwrap());
    }
}
