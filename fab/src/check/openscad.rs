//! Takes part files; gives OpenSCAD's word on each volume, and on whether two neighbours share any.
//!
//! Its exit code is not enough: it exits 0 over an open or crossing mesh and leaves the part out. A pass needs exit 0, no
//! line that starts with ERROR, WARNING or EXPORT-, and the expected volume in the file that comes out.

use super::run::{run, version};
use super::{Check, Outcome, check};
use crate::files::stl;
use crate::mesh::Mesh;
use glam::DVec3;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

const GATE: &str = include_str!("../../scad/gate.scad");

/// The far cube, in mm3.
const CUBE: f64 = 1.0;

/// How far OpenSCAD's volume may be from ours, relative: the figure of the workshop's pass rules.
const VOLUME_TOLERANCE: f64 = 0.001;

/// How far beyond the part the cube stands, in mm: enough that nothing of it is near.
const ASIDE: f64 = 10.0;

/// OpenSCAD, its source written out. Dropping it removes the folder.
pub struct OpenScad {
    program: String,
    name: String,
    folder: PathBuf,
}

impl Drop for OpenScad {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

impl OpenScad {
    /// Puts the gate's source into a folder of its own below `scratch`.
    pub fn new(program: &str, scratch: &Path) -> io::Result<OpenScad> {
        let folder = scratch.join(format!(".openscad-{}", std::process::id()));
        fs::create_dir_all(&folder)?;
        fs::write(folder.join("gate.scad"), GATE)?;
        Ok(OpenScad { program: program.to_string(), name: version(program, "--version"), folder })
    }

    /// Whether OpenSCAD finds the volume (mm3) that we do. `high`: upper corner of the part's box.
    pub fn volume(&self, file: &Path, expected: f64, high: DVec3) -> Check {
        let verdict = self.gate(file, None, beyond(high)).and_then(|out| {
            let found = out.volume() - CUBE;
            let off = (found - expected).abs() / expected.abs().max(f64::MIN_POSITIVE);
            if off <= VOLUME_TOLERANCE {
                return Ok(());
            }
            Err(Outcome::Failed(format!("it finds {found:.3} mm3, expected {expected:.3}")))
        });
        check(&self.name, "volume", verdict)
    }

    /// Whether two parts share no volume: all that comes out is the cube.
    pub fn apart(&self, a: &Path, b: &Path, high: DVec3) -> Check {
        let at = beyond(high);
        let verdict = self.gate(a, Some(b), at).and_then(|out| {
            let Some(shared) = out.vertices.iter().find(|v| v.cmplt(at).any()) else {
                let found = out.volume();
                return if (found - CUBE).abs() < VOLUME_TOLERANCE { Ok(()) } else { Err(no_cube(found)) };
            };
            let volume = out.volume() - CUBE;
            Err(Outcome::Failed(format!(
                "they share {volume:.6} mm3, at ({:.3}, {:.3}, {:.3})",
                shared.x, shared.y, shared.z
            )))
        });
        check(&self.name, "shares no volume", verdict)
    }

    fn gate(&self, a: &Path, b: Option<&Path>, at: DVec3) -> Result<Mesh, Outcome> {
        let stem = |p: &Path| p.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let out = self.folder.join(format!("{}+{}.stl", stem(a), b.map(stem).unwrap_or_default()));
        let mut arguments: Vec<String> =
            ["--hardwarnings", "--export-format", "binstl", "-o"].map(String::from).to_vec();
        arguments.push(out.display().to_string());
        let place = format!("at=[{},{},{}]", at.x, at.y, at.z);
        for define in
            [format!("a={}", quoted(a)?), format!("b={}", b.map_or(Ok("\"\"".into()), quoted)?), place]
        {
            arguments.extend(["-D".to_string(), define]);
        }
        arguments.push(self.folder.join("gate.scad").display().to_string());
        let ran = run(&self.program, &arguments)?;
        let said = ran.all();
        let bad = said.lines().find(|l| ["ERROR", "WARNING", "EXPORT-"].iter().any(|w| l.starts_with(w)));
        match (bad, ran.code) {
            (Some(line), _) => Err(Outcome::Failed(line.to_string())),
            (None, Some(0)) => read(&out),
            (None, code) => Err(Outcome::Failed(format!("it exits {code:?}: {}", last_line(&said)))),
        }
    }
}

fn no_cube(found: f64) -> Outcome {
    Outcome::Failed(format!("the cube that should come out alone has {found} mm3"))
}

fn read(out: &Path) -> Result<Mesh, Outcome> {
    let mesh = fs::File::open(out).and_then(|mut f| stl::read(&mut f));
    let _ = fs::remove_file(out);
    mesh.map_err(|e| Outcome::Failed(format!("it wrote no readable file: {e}")))
}

/// Whole millimetres, so that the cube's corners are exact in f32.
fn beyond(high: DVec3) -> DVec3 {
    (high + DVec3::splat(ASIDE)).ceil()
}

fn last_line(text: &str) -> &str {
    text.lines().rev().find(|l| !l.trim().is_empty()).unwrap_or("(nothing)")
}

/// An absolute path as an OpenSCAD string.
fn quoted(path: &Path) -> Result<String, Outcome> {
    let no = |e: io::Error| Outcome::NotRun(format!("{}: {e}", path.display()));
    let full = std::path::absolute(path).map_err(no)?;
    let text = full.to_str().ok_or_else(|| Outcome::NotRun(format!("{} is not UTF-8", path.display())))?;
    Ok(format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"")))
}
