//! Times of the workshop: the mold of a tile, by our geometry and by OpenSCAD from the source that it comes with, and the
//! offsets of a thousand parts. Ratios within one run count; the most memory is what `/usr/bin/time -v` says of the run.

use divan::Bencher;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use weavelock::contact::join;
use weavelock::fabricate;
use weavelock::spec::{Syntax, parse};
use weavelock_fab::files::Batch;
use weavelock_fab::make::{Recipe, make};
use weavelock_fab::mesh::Mesh;
use weavelock_fab::mold::figures::Figures;
use weavelock_fab::mold::{self, MoldSpec, Route};
use weavelock_fab::process::Process;
use weavelock_fab::shape::Job;

fn main() {
    divan::main();
}

fn job(abc: &str, swatch: &str) -> (Job, Vec<Mesh>) {
    let profile = "[profile]\nrise = 0.6\nlift = 1.0\ncover = 1.0\nsamples = 8\n[size]\npitch = \"20 mm\"\n";
    let text = format!("name = \"bench\"\n[weave]\nabc = {abc}\n{profile}[swatch]\n{swatch}");
    let spec = parse(&text, Path::new("bench.toml"), Syntax::Toml).expect("a good file");
    let joined = join(&spec).expect("an assembly");
    (fabricate::job(&joined), fabricate::meshes(&joined.assembly))
}

/// A unit tile as it touches.
fn tile(abc: &str) -> Mesh {
    let (_, meshes) = job(abc, "wefts = 1\nwarps = 1\ncut = \"tiles\"\n");
    meshes.into_iter().next().expect("a tile")
}

fn spec() -> MoldSpec {
    MoldSpec::new("bench", Route::Rigid, Figures::embedded().expect("figures"))
}

fn scratch(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("weavelock-bench-{}-{name}", std::process::id()))
}

/// Both halves of a tile's mold with keys, sprue, vents, pictures and sources, from the mesh. Aim: under 2 s for [2,2,1].
#[divan::bench(args = ["[1, 1, 1]", "[2, 2, 1]", "[7, 1, 3]"], sample_count = 3, sample_size = 1)]
fn mold_of_a_tile(bencher: Bencher, abc: &str) {
    let (part, spec) = (tile(abc), spec());
    bencher.bench(|| mold::make(&part, &spec).expect("a mold"));
}

/// The same two halves of [2,2,1] by OpenSCAD; nothing is timed where that is not installed.
#[divan::bench(sample_count = 2, sample_size = 1)]
fn mold_221_by_openscad(bencher: Bencher) {
    let dir = scratch("openscad");
    let made = mold::make(&tile("[2, 2, 1]"), &spec()).expect("a mold");
    let mut batch = Batch::new(&dir).expect("a folder");
    mold::write(&made, &mut batch).expect("files");
    batch.commit().expect("files in place");
    let half = |name: &str| {
        let mut openscad = Command::new("openscad");
        let define = format!("half=\"{name}\"");
        openscad.current_dir(&dir).args(["-o", "out.stl", "-D", &define, "bench.scad"]);
        openscad.stdout(Stdio::null()).stderr(Stdio::null()).status()
    };
    if half("lower").is_err() {
        eprintln!("not run: openscad is not installed");
    } else {
        bencher.bench_local(|| ["lower", "upper"].map(|h| half(h).is_ok_and(|s| s.success())));
    }
    // What can not be removed stays in the folder for scratch files.
    let _ = std::fs::remove_dir_all(dir);
}

/// 1,024 plain tiles with clearance: offset, written, read back, gaps measured.
#[divan::bench(sample_count = 1, sample_size = 1)]
fn offsets_of_1024_parts(bencher: Bencher) {
    let (job, _) = job("[1, 1, 1]", "wefts = 32\nwarps = 32\ncut = \"tiles\"\n");
    let recipe = Recipe { programs: None, ..Recipe::new(Process::find("fdm-pla").expect("a process")) };
    let dir = scratch("offsets");
    bencher.bench_local(|| make(&job, &recipe, &dir).expect("parts"));
    let _ = std::fs::remove_dir_all(dir);
}
