//! Takes a path that a verb was given for a spec; gives what it is instead, where its name says so, with what to do.
//!
//! Not promised: a look into the file; its ending alone is judged.

use crate::fault::Fault;
use crate::spec::nearest;
use std::path::Path;

/// Endings of what people have at hand beside specs, with what such a file is and how a spec names it.
const KINDS: [(&[&str], &str, &str); 4] = [
    (
        &["stl", "obj", "3mf"],
        "this is one mesh; an assembly is a text file that lists its meshes",
        "write a file as assembly.toml:\n\n    name = \"assembly\"\n    [[part]]\n    mesh = \"FILE\"\n    [[part]]\n    \
         mesh = \"another.stl\"\n    [size]\n    unit = \"mm\"\n",
    ),
    (
        &["wif", "draft"],
        "this is a draft alone; how large and how cut it is woven stands in a spec",
        "`weavelock weave` and `weavelock chirality` take drafts; for more let `weavelock new` write a spec, and put\n\n    \
         [weave]\n    wif = \"FILE\"\n\n  into it (of a drawn draft: draft = [\"X.\", \".X\"])",
    ),
    (
        &[
            "step", "stp", "iges", "igs", "glb", "gltf", "ply", "dae", "fbx", "3dm", "blend", "dxf", "dwg",
            "skp",
        ],
        "files of this kind are not read",
        "save each part as STL, OBJ or 3MF, and list them in a text file; the README shows one",
    ),
    (
        &["html", "htm", "svg", "png", "jpg", "jpeg", "pdf", "csv", "zip", "scad", "gcode"],
        "this is no description of an assembly",
        "a spec is a TOML or JSON file; `weavelock new` writes one",
    ),
];

/// What is wrong with the path, if its name tells; `None`: it may well be a spec.
pub fn instead_of_a_spec(path: &Path) -> Option<Fault> {
    if !path.exists() {
        return absent(path);
    }
    let ending = path.extension()?.to_string_lossy().to_ascii_lowercase();
    let (_, what, hint) = KINDS.iter().find(|k| k.0.contains(&ending.as_str()))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.is_file().then(|| fault(path, what, hint.replace("FILE", &name)))
}

fn absent(path: &Path) -> Option<Fault> {
    let text = path.to_string_lossy();
    if text.starts_with('[') && text.ends_with(']') {
        let hint = "a weave alone goes to `weave`, `chirality` and `repeats`; `weavelock new` writes a file for the others";
        return Some(fault(path, "a file is wanted here", hint.into()));
    }
    let near = neighbour(path)?;
    Some(fault(path, "there is no such file", format!("did you mean {near}?")))
}

/// Names in the folder are looked at up to this count.
const MOST_NAMES: usize = 10_000;

/// The file in the same folder whose name a slip turns into this one.
fn neighbour(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let all = std::fs::read_dir(folder).ok()?.flatten().take(MOST_NAMES);
    let mut names: Vec<String> = all.filter_map(|e| e.file_name().into_string().ok()).collect();
    names.sort_unstable();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let near = nearest(&path.file_name()?.to_string_lossy(), &names)?;
    Some(path.with_file_name(near).display().to_string())
}

fn fault(path: &Path, what: &str, hint: String) -> Fault {
    Fault { file: path.display().to_string(), place: None, key: String::new(), what: what.into(), hint }
}
