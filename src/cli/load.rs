//! Takes a path; gives the spec with its text, or the assembly in place.
//!
//! Not promised: anything beyond what `spec` and `contact` promise.

use super::args::PuzzleArgs;
use super::mistaken::instead_of_a_spec;
use super::puzzle;
use super::told::Trouble;
use crate::contact::{self, Joined};
use crate::fault::{Fault, Faults};
use crate::input;
use crate::locking::Check;
use crate::report::answer::Source;
use crate::sampling;
use crate::spec::puzzle::is_named;
use crate::spec::{self, Spec, Subject, Syntax};
use crate::watch::{All, Watch};
use crate::weave::{Hanging, Weave, hangs_together};
use std::path::Path;

/// A spec and where it came from.
pub struct Loaded {
    pub spec: Spec,
    pub source: Source,
    /// What was taken where nothing was said.
    pub remarks: Vec<String>,
    /// Told how far the questions asked about it are.
    pub watch: Watch,
}

/// The assembly of a spec, in place.
pub struct Placed {
    pub spec: Spec,
    pub source: Source,
    pub joined: Joined,
    pub watch: Watch,
}

/// Reads a spec or puzzle file; `asked` goes with the latter.
pub fn spec(file: &Path, asked: &PuzzleArgs, watch: &Watch) -> Result<Loaded, Trouble> {
    if let Some(fault) = instead_of_a_spec(file) {
        return Err(fault.into());
    }
    if is_named(file) {
        return puzzle::loaded(file, asked, watch);
    }
    if asked.some().is_some() {
        return Err(no_puzzle(file).into());
    }
    let text = input::text(input::bytes(file)?, file)?;
    let spec = spec::parse(&text, file, Syntax::of(file, &text))?;
    Ok(Loaded::new(spec, text, watch))
}

/// The example that the program carries.
pub fn example(watch: &Watch) -> Result<Loaded, Faults> {
    let text = include_str!("../../fixtures/examples/plain-2x2.toml").to_string();
    let file = Path::new("plain-2x2.toml");
    let spec = spec::parse(&text, file, Syntax::Toml)?;
    Ok(Loaded::new(spec, text, watch))
}

impl Loaded {
    pub fn new(spec: Spec, text: String, watch: &Watch) -> Loaded {
        let source = Source { file: spec.file.display().to_string(), text };
        Loaded { spec, source, remarks: Vec::new(), watch: watch.clone() }
    }

    pub fn joined(self) -> Result<Placed, Faults> {
        let stage = self.watch.stage("parts and contacts", "", All::Open);
        let mut joined = contact::join(&self.spec)?;
        drop(stage);
        if let Subject::Woven(woven) = &self.spec.subject {
            joined.remarks.extend(falls_apart(&woven.weave));
        }
        joined.remarks.splice(0..0, self.remarks);
        Ok(Placed { spec: self.spec, source: self.source, joined, watch: self.watch })
    }
}

impl Placed {
    pub fn check(&self) -> Check {
        sampling::checked(&self.joined, None)
    }
}

/// A word of warning where the infinite fabric does not hang together.
pub fn falls_apart(weave: &Weave) -> Option<String> {
    match hangs_together(&weave.draft) {
        Hanging::Together => weave.common_divisor().filter(|&d| d > 1).map(|d| {
            format!("c and a + b have the common divisor {d}: the usual theorem is silent, but the weave hangs together")
        }),
        Hanging::FallsApart { lifts } => {
            let names: Vec<String> = lifts.iter().map(ToString::to_string).collect();
            Some(format!("this weave falls apart: {} lift off the rest (one period named)", names.join(", ")))
        }
    }
}

/// A weave given as `[a,b,c]`, as a spec, or as a WIF or drawn draft.
pub fn weave(subject: &str) -> Result<Weave, Faults> {
    let path = Path::new(subject);
    let looks_like_abc = subject.trim_start().starts_with('[') || !path.exists() && subject.contains(',');
    if looks_like_abc {
        return Weave::parse_abc(subject);
    }
    if !is_spec(path) {
        return Weave::read(path);
    }
    let read = |text: String| spec::parse(&text, path, Syntax::of(path, &text));
    match input::bytes(path).and_then(|b| input::text(b, path)).and_then(read)?.subject {
        Subject::Woven(woven) => Ok(woven.weave),
        Subject::Meshes(_) => Err(no_weave(path)),
    }
}

/// Whether a file's name is that of a spec.
pub fn is_spec(path: &Path) -> bool {
    let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    matches!(ending.as_deref(), Some("toml" | "json" | "xmpuzzle"))
}

fn no_puzzle(path: &Path) -> Faults {
    let fault = Fault {
        file: path.display().to_string(),
        place: None,
        key: String::new(),
        what: "this is no puzzle file".into(),
        hint: "--problem, --solution and --unit go with files that end in .xmpuzzle".into(),
    };
    fault.into()
}

fn no_weave(path: &Path) -> Faults {
    let fault = Fault {
        file: path.display().to_string(),
        place: None,
        key: "weave".into(),
        what: "an assembly of meshes has no weave".into(),
        hint: "give a woven spec, a WIF file, a drawn draft or [a,b,c]".into(),
    };
    fault.into()
}
