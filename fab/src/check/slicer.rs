//! Takes a part file; gives PrusaSlicer's word on whether it is one manifold body that needs no repair.
//!
//! It repairs STL in silence, so any count of repairs fails the part, also where it then says `manifold = yes`.

use super::run::{run, version};
use super::{Check, Outcome, check, value_of};
use std::path::Path;

/// What `--info` counts only where it had to mend something.
const REPAIRS: [&str; 6] = [
    "open_edges",
    "edges_fixed",
    "degenerate_facets",
    "facets_removed",
    "facets_reversed",
    "backwards_edges",
];

/// The slicer's name with its version.
pub fn name(program: &str) -> String {
    version(program, "--help").split_whitespace().next().unwrap_or(program).to_string()
}

pub fn part(program: &str, name: &str, file: &Path) -> Check {
    bodies(program, name, file, 1)
}

/// The same for a file of several bodies.
pub fn bodies(program: &str, name: &str, file: &Path, bodies: usize) -> Check {
    check(name, "manifold without repair", verdict(program, file, bodies))
}

/// How a plate is to be sliced.
#[derive(Clone, Debug, PartialEq)]
pub struct Slicing {
    /// mm.
    pub bed: [f64; 3],
    pub layer: f64,
    /// Per cent.
    pub infill: f64,
    /// g/cm3.
    pub density: f64,
}

/// What came of slicing a plate: the check, and the grams of filament where it was sliced.
pub fn plate(
    program: &str,
    name: &str,
    file: &Path,
    slicing: &Slicing,
    scratch: &Path,
) -> (Check, Option<f64>) {
    let out = scratch.join(format!(".slicing-{}.gcode", std::process::id()));
    let sliced = sliced(program, file, slicing, &out);
    let _ = std::fs::remove_file(&out);
    match sliced {
        Ok(grams) => (check(name, "sliced", Ok(())), Some(grams)),
        Err(why) => (check(name, "sliced", Err(why)), None),
    }
}

/// Grams that the G-code's own comment states; nothing that the slicer prints is trusted alone.
fn sliced(program: &str, file: &Path, s: &Slicing, out: &Path) -> Result<f64, Outcome> {
    let [x, y, z] = s.bed;
    let settings = [
        ("--layer-height", s.layer.to_string()),
        ("--fill-density", format!("{}%", s.infill)),
        ("--filament-density", s.density.to_string()),
        ("--bed-shape", format!("0x0,{x}x0,{x}x{y},0x{y}")),
        ("--max-print-height", z.to_string()),
        ("--xy-size-compensation", "0".into()),
        ("--output", out.display().to_string()),
    ];
    let mut arguments = ["--export-gcode", "--dont-arrange", "--support-material"].map(String::from).to_vec();
    settings.into_iter().for_each(|(key, value)| arguments.extend([key.to_string(), value]));
    arguments.push(file.display().to_string());
    let ran = run(program, &arguments)?;
    let failed = |why: String| Err(Outcome::Failed(why));
    if ran.code != Some(0) {
        let said = ran.all();
        let last = said.lines().rev().find(|l| !l.trim().is_empty()).unwrap_or("(nothing)").to_string();
        return failed(format!("it exits {:?}: {last}", ran.code));
    }
    let Ok(code) = std::fs::read_to_string(out) else { return failed("it wrote no G-code".into()) };
    match value_of(&code, "filament used [g]").and_then(|g| g.parse::<f64>().ok()) {
        Some(grams) if grams > 0.0 => Ok(grams),
        other => failed(format!("filament used: {other:?} g")),
    }
}

fn verdict(program: &str, file: &Path, bodies: usize) -> Result<(), Outcome> {
    let ran = run(program, &["--info".into(), file.display().to_string()])?;
    let said = ran.all();
    let failed = |why: String| Err(Outcome::Failed(why));
    if ran.code != Some(0) {
        return failed(format!("it exits {:?}", ran.code));
    }
    if let Some(no) = values(&said, "manifold").find(|v| *v != "yes") {
        return failed(format!("manifold = {no}"));
    }
    let repairs = REPAIRS.iter().flat_map(|k| values(&said, k).map(move |v| (k, v)));
    if let Some((key, count)) = repairs.into_iter().find(|(_, v)| *v != "0") {
        return failed(format!("{key} = {count}"));
    }
    let found: Option<usize> = values(&said, "number_of_parts").map(|v| v.parse::<usize>().ok()).sum();
    match found {
        Some(found) if found == bodies => Ok(()),
        Some(0) | None => failed("number_of_parts is not said".into()),
        Some(found) => failed(format!("number_of_parts = {found}, expected {bodies}")),
    }
}

/// Every value that a key has: each object of a file is told by itself.
fn values<'a>(text: &'a str, key: &str) -> impl Iterator<Item = &'a str> {
    text.lines().filter_map(move |line| value_of(line, key))
}
