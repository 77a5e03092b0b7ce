//! Takes a spec file; gives what it asks for, or all its faults: which keys stand where, and what both kinds share.
//!
//! Not promised: that a fault is not followed by others that vanish with it.

use super::puzzle::{self, Choice};
use super::reader::{Field, Fields, Reader};
use super::tree::{SyntaxFault, Table};
use super::{FabSpec, Spec, Subject, json, meshes, tree, woven};
use crate::fault::{Faults, quoted};
use crate::input;
use std::collections::BTreeMap;
use std::path::Path;

/// How a spec is written; the keys are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Syntax {
    Toml,
    Json,
    /// XML of a puzzle file; the keys are its own.
    Puzzle,
}

impl Syntax {
    /// A puzzle where the file's name ends in `.xmpuzzle` or its text begins with `<`, JSON where it ends in `.json` or
    /// begins with a brace (no TOML begins with either), else TOML.
    pub fn of(file: &Path, text: &str) -> Syntax {
        let ends = |end: &str| file.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
        let text = text.trim_start_matches('\u{feff}').trim_start();
        if ends("xmpuzzle") || text.starts_with('<') {
            Syntax::Puzzle
        } else if ends("json") || text.starts_with('{') {
            Syntax::Json
        } else {
            Syntax::Toml
        }
    }

    fn tree(self, text: &str) -> (Table, Vec<SyntaxFault>) {
        match self {
            // A puzzle never gets here: `parse` reads it.
            Syntax::Toml | Syntax::Puzzle => tree::toml(text),
            Syntax::Json => json::json(text)
                .map_or_else(|fault| (Table::default(), vec![fault]), |table| (table, Vec::new())),
        }
    }
}

/// Reads a spec file.
pub fn read(path: &Path) -> Result<Spec, Faults> {
    if puzzle::is_named(path) {
        return puzzle::parse(&puzzle::read_text(path)?, path, Choice::default());
    }
    let text = input::text(input::bytes(path)?, path)?;
    parse(&text, path, Syntax::of(path, &text))
}

/// Reads a spec's text; `file` names it in faults, and the files that it names are relative to the folder of `file`.
pub fn parse(text: &str, file: &Path, syntax: Syntax) -> Result<Spec, Faults> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if syntax == Syntax::Puzzle {
        return puzzle::parse(text, file, Choice::default());
    }
    let (table, faults) = syntax.tree(text);
    let mut reader = Reader::new(text, file.to_path_buf(), faults);
    let root = reader.root(&table);
    let parts = whole(&mut reader, &root);
    let ((name, subject, fab), places) = reader.finish(parts)?;
    Ok(Spec { name, subject, fab, file: file.to_path_buf(), places })
}

const WOVEN_KEYS: [&str; 8] = ["name", "weave", "profile", "swatch", "piece", "held", "size", "fab"];
const MESH_KEYS: [&str; 5] = ["name", "part", "contact", "size", "fab"];

/// Keys that someone may write outside of their table.
const HOMES: [(&str, &str); 30] = [
    ("held", "`held` stands in [swatch], in a [[piece]] or [[part]], or at the top before the first table"),
    ("abc", "`abc` belongs in [weave]"),
    ("draft", "`draft` belongs in [weave]"),
    ("wif", "`wif` belongs in [weave]"),
    ("rise", "`rise` belongs in [profile]"),
    ("lift", "`lift` belongs in [profile]"),
    ("cover", "`cover` belongs in [profile]"),
    ("samples", "`samples` belongs in [profile]"),
    ("points", "`points` belongs in [profile]"),
    ("bounds", "`bounds` belongs in [profile]"),
    ("wefts", "`wefts` belongs in [swatch]"),
    ("warps", "`warps` belongs in [swatch]"),
    ("cut", "`cut` belongs in [swatch]"),
    ("repeat", "`repeat` belongs in [swatch]"),
    ("phase", "`phase` belongs in [swatch]"),
    ("weft", "`weft` belongs in [[piece]]"),
    ("warp", "`warp` belongs in [[piece]]"),
    ("from", "`from` belongs in [[piece]]"),
    ("to", "`to` belongs in [[piece]]"),
    ("pitch", "`pitch` belongs in [size] of a woven assembly"),
    ("unit", "`unit` belongs in [size] of an assembly of meshes"),
    ("tolerance", "`tolerance` belongs in [contact] of an assembly of meshes"),
    ("mesh", "`mesh` belongs in [[part]] of an assembly of meshes"),
    ("at", "`at` belongs in [[part]] of an assembly of meshes"),
    ("process", "`process` belongs in [fab]"),
    ("clearance", "`clearance` belongs in [fab]"),
    ("shrinkage", "`shrinkage` belongs in [fab]"),
    ("bed", "`bed` belongs in [fab]"),
    ("elephant_foot", "`elephant_foot` belongs in [fab]"),
    ("flatten", "`flatten` belongs in [fab]"),
];

/// Where a key belongs that is unknown where it stands.
pub fn home(key: &str) -> Option<&'static str> {
    HOMES.iter().find(|(name, _)| *name == key).map(|(_, home)| *home)
}

fn whole<'t>(reader: &mut Reader<'t>, root: &Fields<'t>) -> Option<(String, Subject, Option<FabSpec>)> {
    let name = name(reader, root);
    let meshes = reader.get(root, "part");
    let (subject, width) = match &meshes {
        Some(parts) => {
            reader.only(root, &MESH_KEYS, mesh_home);
            (meshes::meshes(reader, root, parts).map(Subject::Meshes), None)
        }
        None => {
            reader.only(root, &WOVEN_KEYS, woven_home);
            let pitch = woven::pitch(reader, root);
            (woven::woven(reader, root, pitch).map(Subject::Woven), pitch)
        }
    };
    let fab = match reader.get(root, "fab") {
        Some(field) => Some(fab(reader, &field, width)?),
        None => None,
    };
    Some((name?, subject?, fab))
}

fn mesh_home(key: &str) -> Option<&'static str> {
    match key {
        "held" => Some("with meshes each [[part]] says `held = true` itself"),
        _ if WOVEN_KEYS.contains(&key) => {
            Some("a file has either a weave or parts: this key goes with [weave], [[part]] stands here too")
        }
        _ => home(key),
    }
}

fn woven_home(key: &str) -> Option<&'static str> {
    match key {
        "contact" => Some("[contact] goes with [[part]]; woven tiles know their contacts exactly"),
        _ => home(key),
    }
}

/// The name, by default the stem of the file's.
fn name<'t>(reader: &mut Reader<'t>, root: &Fields<'t>) -> Option<String> {
    let Some(field) = reader.get(root, "name") else {
        let stem = reader.file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        return Some(stem.unwrap_or_default());
    };
    let name = reader.text(&field, "the name of the assembly")?;
    if name.contains('/') {
        reader.fault(&field, "has a slash", "files are named after it, and they all lie in one folder");
        return None;
    }
    plain_name(reader, &field, name)
}

/// Longest name and id, in bytes, so that a file can be named after it with room for an ending.
const MAX_NAME: usize = 200;

/// A name that may become a file's, an id's slashes standing for folders: refused are control characters, and segments that lead out of a folder.
pub fn plain_name(reader: &mut Reader<'_>, field: &Field, name: &str) -> Option<String> {
    let leads_out = |part: &str| part.trim().is_empty() || part == "." || part == "..";
    let what = if name.len() > MAX_NAME {
        format!("is longer than {MAX_NAME} bytes")
    } else if let Some(sign) = name.chars().find(|c| c.is_control() || matches!(c, '\\' | ':')) {
        format!("has the character {sign:?}")
    } else if name.split('/').any(leads_out) {
        format!("is {}", quoted(name))
    } else {
        return Some(name.to_string());
    };
    reader.fault(field, what, "files are named after it: letters, digits, - and _ are safe");
    None
}

/// Clearances beyond this, in mm, are slips: it is the largest pitch.
const MAX_CLEARANCE_MM: f64 = 10_000.0;

/// `width`: of a strand, in mm, where strands are what is made.
fn fab<'t>(reader: &mut Reader<'t>, field: &Field<'t>, width: Option<f64>) -> Option<FabSpec> {
    let fields = reader.table(field)?;
    reader.only(
        &fields,
        &["process", "clearance", "clearances", "shrinkage", "parts", "bed", "elephant_foot", "flatten"],
        home,
    );
    let process = match reader.get(&fields, "process") {
        Some(field) => process(reader, &field),
        None => reader.lacks(&fields, "process", "is missing", "name a process, as in process = \"fdm-pla\""),
    };
    let clearance = reader.get(&fields, "clearance").map(|field| clearance(reader, &field, width));
    let clearances_mm = match reader.get(&fields, "clearances") {
        Some(field) => clearances(reader, &field, width),
        None => Some(BTreeMap::new()),
    };
    let shrinkage = match reader.get(&fields, "shrinkage") {
        Some(field) => shrinkage(reader, &field),
        None => Some(BTreeMap::new()),
    };
    let clearance_mm = match clearance {
        Some(read) => Some(read?),
        None => None,
    };
    let parts = match reader.get(&fields, "parts") {
        Some(field) => part_processes(reader, &field),
        None => Some(BTreeMap::new()),
    };
    let bed = match reader.get(&fields, "bed") {
        Some(field) => Some(reader.text(&field, "a bed's name, or \"250 x 210 x 220 mm\"")?.to_string()),
        None => None,
    };
    let [elephant_foot_mm, flatten_mm] =
        ["elephant_foot", "flatten"].map(|key| shaving(reader, &fields, key));
    Some(FabSpec {
        process: process?,
        clearance_mm,
        clearances_mm: clearances_mm?,
        shrinkage: shrinkage?,
        parts: parts?,
        bed,
        elephant_foot_mm: elephant_foot_mm?,
        flatten_mm: flatten_mm?,
    })
}

/// More than this, in mm, taken off a print face is another part.
const MAX_SHAVING_MM: f64 = 2.0;

/// `Some(None)` where it is not asked for.
fn shaving<'t>(reader: &mut Reader<'t>, fields: &Fields<'t>, key: &str) -> Option<Option<f64>> {
    match reader.get(fields, key) {
        Some(field) => {
            reader.length(&field, 0.0..=MAX_SHAVING_MM, "it is taken off the print face").map(Some)
        }
        None => Some(None),
    }
}

/// Parts that may have a process of their own; a swatch has as many at most.
const MAX_NAMED_PARTS: usize = 100_000;

fn part_processes<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<BTreeMap<String, String>> {
    let fields = reader.table(field)?;
    if fields.keys().count() > MAX_NAMED_PARTS {
        reader.fault(field, format!("names more than {MAX_NAMED_PARTS} parts"), "an id and its process each");
        return None;
    }
    let mut all = Some(BTreeMap::new());
    for id in fields.keys() {
        let name = reader.get(&fields, id).and_then(|field| process(reader, &field));
        all = all.zip(name).map(|(mut all, name)| {
            all.insert(id.to_string(), name);
            all
        });
    }
    all
}

fn process<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<String> {
    let hint = "name a process, as in \"fdm-pla\"";
    let name = reader.text(field, hint)?.to_string();
    if name.trim().is_empty() {
        reader.fault(field, "is empty", hint);
        return None;
    }
    Some(name)
}

fn clearance<'t>(reader: &mut Reader<'t>, field: &Field<'t>, width: Option<f64>) -> Option<f64> {
    match width {
        Some(pitch) => {
            let why =
                "it is taken off each face, and a strand is one pitch wide: half of that leaves nothing";
            reader.length(field, 0.0..pitch / 2.0, why)
        }
        None => reader.length(field, 0.0..=MAX_CLEARANCE_MM, "it is taken off each face"),
    }
}

/// Of single processes, by name.
fn clearances<'t>(
    reader: &mut Reader<'t>,
    field: &Field<'t>,
    width: Option<f64>,
) -> Option<BTreeMap<String, f64>> {
    let fields = reader.table(field)?;
    let mut all = Some(BTreeMap::new());
    for name in fields.keys() {
        let mm = reader.get(&fields, name).and_then(|field| clearance(reader, &field, width));
        all = all.zip(mm).map(|(mut all, mm)| {
            all.insert(name.to_string(), mm);
            all
        });
    }
    all
}

/// Steps from the file to the finished part; a chain has four.
const MAX_STEPS: usize = 100;

fn shrinkage<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<BTreeMap<String, f64>> {
    let fields = reader.table(field)?;
    if fields.keys().count() > MAX_STEPS {
        reader.fault(
            field,
            format!("has more than {MAX_STEPS} steps"),
            "a step is one process after another",
        );
        return None;
    }
    let mut steps = Some(BTreeMap::new());
    for step in fields.keys() {
        let why = "no step known shrinks by more than 5 %; beyond 20 % it is a slip";
        let share = reader.get(&fields, step).and_then(|field| reader.share(&field, 0.0..=20.0, why));
        steps = steps.zip(share).map(|(mut steps, share)| {
            steps.insert(step.to_string(), share);
            steps
        });
    }
    steps
}
