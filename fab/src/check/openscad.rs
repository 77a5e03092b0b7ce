//! Takes part files; gives OpenSCAD's word on each volume, and on whether two neighbours share any.
//!
//! Its exit code is not enough: it exits 0 over an open or crossing mesh and leaves the part out. A pass needs exit 0, no
//! line that starts with ERROR, WARNING or EXPORT-, and the expected volume in the file that comes out.

use super::run::{run, version};
use super::{Check, Outcome, check};
use crate::files::stl;
use crate::mesh::Mesh;
use crate::solid::Solid;
use glam::DVec3;
use rayon::prelude::*;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

const GATE: &str = include_str!("../../scad/gate.scad");

/// The far cube, in mm3.
const CUBE: f64 = 1.0;

/// How far OpenSCAD's volume may be from ours, relative: the figure of the workshop's pass rules.
pub const VOLUME_TOLERANCE: f64 = 0.001;

/// How far beyond the part the cube stands, in mm: enough that nothing of it is near.
const ASIDE: f64 = 10.0;

/// Two files that are looked at together, each with the factor that takes it to finished size.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    pub files: [&'a Path; 2],
    pub factors: [f64; 2],
}

/// OpenSCAD, its source written out. Dropping it removes the folder.
pub struct OpenScad {
    program: String,
    name: String,
    folder: PathBuf,
    runs: AtomicUsize,
}

impl Drop for OpenScad {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

impl OpenScad {
    /// Puts the gate's source into a new folder below `scratch`.
    pub fn new(program: &str, scratch: &Path) -> io::Result<OpenScad> {
        let name = |k: usize| scratch.join(format!("weavelock-openscad-{}-{k}", std::process::id()));
        let mut free = (0..).map(name).skip_while(|f| f.exists());
        let folder = free.next().unwrap_or_else(|| name(0));
        fs::create_dir(&folder)?;
        fs::write(folder.join("gate.scad"), GATE)?;
        Ok(OpenScad {
            program: program.to_string(),
            name: version(program, "--version"),
            folder,
            runs: AtomicUsize::new(0),
        })
    }

    /// Whether OpenSCAD finds the volume (mm3) that we do. `high`: upper corner of the part's box.
    pub fn volume(&self, file: &Path, expected: f64, high: DVec3) -> Check {
        let verdict =
            quoted(file).and_then(|f| self.gate(&[format!("part={f}")], beyond(high))).and_then(|out| {
                let found = out.volume() - CUBE;
                let off = (found - expected).abs() / expected.abs().max(f64::MIN_POSITIVE);
                if off <= VOLUME_TOLERANCE {
                    return Ok(());
                }
                Err(Outcome::Failed(format!("it finds {found:.3} mm3, expected {expected:.3}")))
            });
        check(&self.name, "volume", verdict)
    }

    /// Whether the two parts of each pair share no volume. `high`: upper corner of the box of all.
    ///
    /// Many pairs go into one run, where each part is read once; only where something comes out, or the run fails, is
    /// each pair of it asked about alone.
    pub fn apart(&self, pairs: &[Pair], datum: DVec3, high: DVec3) -> Vec<Check> {
        let share = pairs.len().div_ceil(rayon::current_num_threads()).clamp(1, MOST_PAIRS);
        let of_run = |pairs: &[Pair]| match self.share_nothing(pairs, datum, high) {
            Ok(()) => vec![Ok(()); pairs.len()],
            Err(why) if pairs.len() == 1 => vec![Err(why)],
            Err(_) => {
                pairs.iter().map(|p| self.share_nothing(std::slice::from_ref(p), datum, high)).collect()
            }
        };
        let verdicts: Vec<_> = pairs.par_chunks(share).flat_map_iter(of_run).collect();
        verdicts.into_iter().map(|v| check(&self.name, "shares no volume", v)).collect()
    }

    /// All that comes out is the cube.
    fn share_nothing(&self, pairs: &[Pair], datum: DVec3, high: DVec3) -> Result<(), Outcome> {
        let at = beyond(high);
        let names = pairs.iter().map(|p| {
            let [a, b] = p.files;
            let [s, t] = p.factors;
            Ok(format!("[{},{},{s},{t}]", quoted(a)?, quoted(b)?))
        });
        let names: Vec<String> = names.collect::<Result<_, Outcome>>()?;
        let datum = format!("datum=[{},{},{}]", datum.x, datum.y, datum.z);
        let out = self.gate(&[format!("pairs=[{}]", names.join(",")), datum], at)?;
        let Some(shared) = out.vertices.iter().find(|v| v.cmplt(at).any()) else {
            let found = out.volume();
            return if (found - CUBE).abs() < VOLUME_TOLERANCE { Ok(()) } else { Err(no_cube(found)) };
        };
        let volume = out.volume() - CUBE;
        let place = format!("({:.3}, {:.3}, {:.3})", shared.x, shared.y, shared.z);
        Err(Outcome::Failed(format!("they share {volume:.6} mm3, at {place}")))
    }

    /// Whether a source, with a variable set, makes the solid that is in a file: the same volume, and nothing that only
    /// one of the two has, both to `VOLUME_TOLERANCE`. `expected`: volume in the file, mm3.
    pub fn same(&self, source: &Path, define: &str, file: &Path, expected: f64) -> Check {
        let verdict = self.run(source, &[define.to_string()]).and_then(|theirs| {
            let off = (theirs.volume() - expected).abs() / expected;
            if off > VOLUME_TOLERANCE {
                return Err(Outcome::Failed(format!(
                    "it makes {:.3} mm3, ours is {expected:.3}",
                    theirs.volume()
                )));
            }
            let apart = differs(&theirs, file).map_err(Outcome::Failed)?;
            if apart <= VOLUME_TOLERANCE * expected {
                return Ok(());
            }
            Err(Outcome::Failed(format!("{apart:.3} mm3 are in one of the two solids only")))
        });
        check(&self.name, "makes the same solid from the source", verdict)
    }

    fn gate(&self, what: &[String], at: DVec3) -> Result<Mesh, Outcome> {
        let cube = format!("at=[{},{},{}]", at.x, at.y, at.z);
        self.run(&self.folder.join("gate.scad"), &[what, &[cube]].concat())
    }

    fn run(&self, source: &Path, defines: &[String]) -> Result<Mesh, Outcome> {
        let out = self.out();
        let mut arguments = ["--hardwarnings", "--export-format", "binstl", "-o"].map(String::from).to_vec();
        arguments.push(out.display().to_string());
        for define in defines {
            arguments.extend(["-D".to_string(), define.clone()]);
        }
        arguments.push(source.display().to_string());
        let ran = run(&self.program, &arguments)?;
        let said = ran.all();
        let bad = said.lines().find(|l| ["ERROR", "WARNING", "EXPORT-"].iter().any(|w| l.starts_with(w)));
        match (bad, ran.code) {
            (Some(line), _) => Err(Outcome::Failed(line.to_string())),
            (None, Some(0)) => read(&out),
            (None, code) => Err(Outcome::Failed(format!("it exits {code:?}: {}", last_line(&said)))),
        }
    }

    /// A file name of its own for each run.
    fn out(&self) -> PathBuf {
        self.folder.join(format!("{}.stl", self.runs.fetch_add(1, Ordering::Relaxed)))
    }
}

/// Volume that only one of two solids has, mm3.
fn differs(theirs: &Mesh, file: &Path) -> Result<f64, String> {
    let ours = fs::File::open(file).and_then(|mut f| stl::read(&mut f)).map_err(|e| e.to_string())?;
    let (a, b) = (
        Solid::of(theirs).map_err(|e| format!("its solid: {e}"))?,
        Solid::of(&ours).map_err(|e| format!("ours: {e}"))?,
    );
    Ok(a.minus(&b).volume() + b.minus(&a).volume())
}

/// Pairs in one run: a dozen seconds of work for parts of two thousand triangles, and far from the time limit.
const MOST_PAIRS: usize = 32;

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
