//! Promises of molds: pull, parting, halves that leave, high points with vents, prints for silicone, trees, refusals.

#[path = "molds/piped.rs"]
mod piped;
#[path = "molds/second_kernel.rs"]
mod second_kernel;
#[path = "molds/trees.rs"]
mod trees;
#[path = "molds/whole.rs"]
mod whole;

use glam::DVec3;
use std::path::{Path, PathBuf};
use std::process::Command;
use weavelock_fab::files::{Batch, stl};
use weavelock_fab::mesh::Mesh;
use weavelock_fab::mold::figures::Figures;
use weavelock_fab::mold::{Kind, Mold, MoldReport, MoldSpec, Parting, Route, make, write};
use weavelock_fab::report::Severity;
use weavelock_fab::solid::{Solid, cuboid, frustum};

fn spec(name: &str, route: Route) -> MoldSpec {
    MoldSpec::new(name, route, Figures::embedded().unwrap())
}

fn solid(mesh: &Mesh) -> Solid {
    Solid::of(mesh).unwrap()
}

fn scratch(name: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("weavelock-molds-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&dir);
    dir
}

/// The mold written to a folder of its own and measured there; the folder stays only if it is asked for.
fn written(mold: &Mold) -> (MoldReport, PathBuf) {
    let dir = scratch(&mold.name);
    let mut batch = Batch::new(&dir).unwrap();
    let report = write(mold, &mut batch).unwrap();
    batch.commit().unwrap();
    (report, dir)
}

fn measured(mold: &Mold) -> MoldReport {
    let (report, dir) = written(mold);
    std::fs::remove_dir_all(dir).unwrap();
    report
}

fn sound(report: &MoldReport) {
    let errors: Vec<_> = report.findings.iter().filter(|f| f.severity == Severity::Error).collect();
    assert!(errors.is_empty(), "{}: {errors:#?}", report.name);
    assert!(report.measured.len() >= 7 && report.measured.iter().all(|m| m.kept), "{:#?}", report.measured);
    assert!(report.pieces.iter().all(|p| p.watertight), "{:#?}", report.pieces);
}

fn drilled() -> Mesh {
    let block = solid(&cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 50.0)));
    block.minus(&solid(&frustum(DVec3::new(20.0, 15.0, -1.0), 52.0, 5.0, 5.0))).mesh()
}

fn angle() -> Mesh {
    let foot = solid(&cuboid(DVec3::ZERO, DVec3::new(40.0, 10.0, 20.0)));
    foot.with(&solid(&cuboid(DVec3::ZERO, DVec3::new(10.0, 35.0, 20.0)))).mesh()
}

fn ring() -> Mesh {
    let cone = |from: f64, to: f64| solid(&frustum(DVec3::ZERO, 5.0, from, to));
    let half = cone(20.0, 18.0).minus(&cone(10.0, 12.0)).mesh();
    let other = Mesh {
        vertices: half.vertices.iter().map(|v| DVec3::new(v.x, v.y, -v.z)).collect(),
        triangles: half.triangles.iter().map(|t| [t[0], t[2], t[1]]).collect(),
    };
    solid(&half).with(&solid(&other)).mesh()
}

/// A plate of 40 x 40 x 4 mm that waves in both directions by 4 mm: no plane parts it.
fn wavy() -> Mesh {
    const N: u32 = 12;
    let at = |k: u32, lift: f64| {
        let (x, y) = (f64::from(k / (N + 1)) / f64::from(N), f64::from(k % (N + 1)) / f64::from(N));
        DVec3::new(40.0 * x, 40.0 * y, lift + 4.0 * (6.0 * x).sin() * (5.0 * y).cos())
    };
    let m = (N + 1) * (N + 1);
    let mut triangles = vec![];
    let mut quad = |a: u32, b: u32, c: u32, d: u32| triangles.extend([[a, b, c], [a, c, d]]);
    for i in 0..N {
        for j in 0..N {
            let k = i * (N + 1) + j;
            quad(m + k, m + k + N + 1, m + k + N + 2, m + k + 1);
            quad(k, k + 1, k + N + 2, k + N + 1);
        }
        let (front, rear) = (i * (N + 1), i * (N + 1) + N);
        quad(front, front + N + 1, m + front + N + 1, m + front);
        quad(rear + N + 1, rear, m + rear, m + rear + N + 1);
        let (left, right) = (i, N * (N + 1) + i);
        quad(left + 1, left, m + left, m + left + 1);
        quad(right, right + 1, m + right + 1, m + right);
    }
    Mesh { vertices: (0..m).map(|k| at(k, 0.0)).chain((0..m).map(|k| at(k, 4.0))).collect(), triangles }
}

/// A cube with a blind hole in each of three sides that meet: along no way out are all three in line.
fn holed() -> Mesh {
    let mut cube = solid(&cuboid(DVec3::ZERO, DVec3::splat(30.0)));
    let pin = frustum(DVec3::ZERO, 15.0, 4.0, 4.0);
    for map in [|v: DVec3| v, |v: DVec3| DVec3::new(v.z, v.x, v.y), |v: DVec3| DVec3::new(v.y, v.z, v.x)] {
        cube = cube.minus(&solid(&pin.map(|v| map(v + DVec3::new(15.0, 15.0, 20.0)))));
    }
    cube.mesh()
}

/// A weft tile of a swatch of n by n, with clearance, as the program writes it; its centreline lies across y.
fn tile(abc: &str, n: usize) -> Mesh {
    let dir = scratch(&format!("tile-{}", abc.replace(", ", "")));
    std::fs::create_dir_all(&dir).unwrap();
    let text = format!(
        "name = \"tile\"\n[weave]\nabc = [{abc}]\n[profile]\nrise = 0.6\nlift = 1.0\ncover = 1.0\nsamples = 8\n[swatch]\nwefts = {n}\nwarps = {n}\ncut = \"tiles\"\n[size]\npitch = \"20 mm\"\n[fab]\nprocess = \"fdm-pla\"\n"
    );
    std::fs::write(dir.join("tile.toml"), text).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_weavelock"));
    let out = program.current_dir(&dir).args(["fab", "tile.toml", "--out", "out"]).output().unwrap();
    let file = find(&dir.join("out"), "weft-0.mm.stl");
    let file = file.unwrap_or_else(|| panic!("no tile: {}", String::from_utf8_lossy(&out.stderr)));
    let mesh = stl::read(&mut std::fs::File::open(file).unwrap()).unwrap();
    std::fs::remove_dir_all(dir).unwrap();
    mesh
}

fn find(folder: &Path, name: &str) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.map(|e| e.unwrap().path()).collect::<Vec<_>>();
    let here = entries.iter().find(|p| p.file_name().is_some_and(|n| n == name)).cloned();
    here.or_else(|| entries.iter().filter(|p| p.is_dir()).find_map(|p| find(p, name)))
}

#[test]
fn woven_tiles_are_pulled_square_to_their_centreline_and_their_molds_open() {
    for (abc, n) in [("1, 1, 1", 2), ("2, 2, 1", 4)] {
        let mold = make(&tile(abc, n), &spec(&format!("tile-{}", &abc[..1]), Route::Rigid)).unwrap();
        let degrees = mold.pull.direction.y.abs().min(1.0).acos().to_degrees();
        assert!(degrees < 1.0, "[{abc}]: {degrees} degrees off");
        assert!(mold.pull.undercut_reach_mm < 0.04, "{}", mold.pull.undercut_reach_mm);
        sound(&measured(&mold));
    }
}

#[test]
fn plain_shapes_are_parted_by_a_plane_and_leave() {
    for (name, part) in [("drilled", drilled()), ("angle", angle()), ("ring", ring())] {
        let mold = make(&part, &spec(name, Route::Rigid)).unwrap();
        assert!(matches!(mold.parting, Some(Parting::Plane { .. })), "{name}: {:?}", mold.parting);
        assert_eq!((mold.pull.direction.abs(), mold.pull.undercut_mm2), (DVec3::Z, 0.0), "{name}");
        sound(&measured(&mold));
    }
}

/// A millimetre of part in a block of forty: what rounding leaves along keys, screws, channels and the parting is not the
/// cavity's, and there is no skin between the gate's foot and the parting.
#[test]
fn a_tiny_part_keeps_its_cavity() {
    for (name, part) in [("tiny-wavy", wavy()), ("tiny-ring", ring()), ("tiny-angle", angle())] {
        for route in [Route::Rigid, Route::Silicone] {
            let report = measured(&make(&part.map(|v| v * 0.05), &spec(name, route)).unwrap());
            let cavity = report.measured.iter().find(|m| m.of == "cavity against part").unwrap();
            assert!(cavity.value < 0.001, "{name}, {route:?}: {cavity:?}");
        }
    }
}

/// A part that is narrower than the narrowest gate is told so.
#[test]
fn a_gate_wider_than_the_part_is_told() {
    let says = |scale: f64| {
        let mold = make(&ring().map(|v| v * scale), &spec("gated", Route::Silicone)).unwrap();
        mold.findings.iter().any(|f| f.severity == Severity::Warning && f.what.starts_with("the gate"))
    };
    assert!(says(0.02) && !says(1.0));
}

#[test]
fn a_plate_that_waves_is_parted_by_steps_and_leaves() {
    let mold = make(&wavy(), &spec("wavy", Route::Rigid)).unwrap();
    assert!(
        matches!(mold.parting, Some(Parting::Stepped { off_mm2, .. }) if off_mm2 > 100.0),
        "{:?}",
        mold.parting
    );
    assert!(mold.tops.len() > 1 && !mold.plan.vents.is_empty(), "{:?}", mold.tops);
    sound(&measured(&mold));
}

/// A bobbin of 24 mm with flanges of 30 mm and a hole along its axis.
fn bobbin() -> Mesh {
    let disc = |z: f64, h: f64, r: f64| solid(&frustum(DVec3::Z * z, h, r, r));
    let body = Solid::all(vec![disc(0.0, 3.0, 15.0), disc(0.0, 24.0, 7.0), disc(21.0, 3.0, 15.0)]);
    body.minus(&disc(-1.0, 26.0, 4.0)).mesh()
}

/// A bracket with a hole in each leg and a blind pocket in its back.
fn bracket() -> Mesh {
    let foot = solid(&cuboid(DVec3::ZERO, DVec3::new(40.0, 30.0, 6.0)));
    let leg = solid(&cuboid(DVec3::ZERO, DVec3::new(6.0, 30.0, 35.0)));
    let drill = frustum(DVec3::new(20.0, 15.0, -1.0), 9.0, 4.0, 4.0);
    let across = frustum(DVec3::new(-22.0, 15.0, -1.0), 9.0, 4.0, 4.0).map(|v| DVec3::new(v.z, v.y, -v.x));
    let pocket = cuboid(DVec3::new(-1.0, 10.0, 10.0), DVec3::new(2.0, 20.0, 14.0));
    foot.with(&leg).minus(&Solid::all(vec![solid(&drill), solid(&across), solid(&pocket)])).mesh()
}

/// A cube with a chamber that only a narrow neck leads to.
fn bottle() -> Mesh {
    let cube = solid(&cuboid(DVec3::ZERO, DVec3::splat(30.0)));
    let chamber = solid(&cuboid(DVec3::splat(6.0), DVec3::splat(24.0)));
    cube.minus(&chamber.with(&solid(&frustum(DVec3::new(15.0, 15.0, 20.0), 12.0, 3.0, 3.0)))).mesh()
}

#[test]
fn what_no_one_pull_frees_gets_side_cores_that_leave_first() {
    for (name, part, most) in [("bobbin", bobbin(), 1), ("bracket", bracket(), 2), ("holed", holed(), 2)] {
        let mold = make(&part, &spec(name, Route::Rigid)).unwrap();
        let cores = mold.pieces.iter().filter(|p| p.kind == Kind::Core).count();
        assert!((1..=most).contains(&cores), "{name}: {cores} cores; {:#?}", mold.findings);
        assert!(mold.maps.half.iter().any(|h| h == "core-1"), "{name}");
        assert!(mold.steps.iter().any(|s| s.does.contains("core-1 along")), "{name}: {:?}", mold.steps);
        let report = measured(&mold);
        assert!(report.measured.iter().any(|m| m.of.starts_with("core-1 leaves the rest")), "{name}");
        sound(&report);
    }
}

/// A core that is turned about does not leave, and the measurements say so.
#[test]
fn a_core_that_is_stuck_is_found_out() {
    let mut mold = make(&bobbin(), &spec("stuck", Route::Rigid)).unwrap();
    let core = mold.pieces.iter_mut().find(|p| p.kind == Kind::Core).unwrap();
    core.pull = -core.pull;
    let missed = measured(&mold).measured.into_iter().filter(|m| !m.kept).map(|m| m.of).collect::<Vec<_>>();
    assert!(missed.iter().any(|m| m.starts_with("core-1 leaves the rest")), "{missed:?}");
}

#[test]
fn what_no_pull_frees_is_refused_for_a_rigid_mold_and_made_in_silicone() {
    let rigid = make(&bottle(), &spec("bottle", Route::Rigid)).unwrap();
    assert!(rigid.pieces.is_empty() && rigid.pull.undercut_mm2 > 100.0, "{:?}", rigid.pull);
    assert!(rigid.findings.iter().any(|f| f.severity == Severity::Error && f.remedy.contains("silicone")));
    assert!(rigid.extras.iter().any(|e| e.name.ends_with(".png") && e.bytes.len() > 1000));
    sound(&measured(&make(&bottle(), &spec("bottle", Route::Silicone)).unwrap()));
}

/// The measurements tell a mold that is wrong: a half that stands aside, and one that has lost its vents.
#[test]
fn a_wrong_mold_is_found_out() {
    let good = make(&wavy(), &spec("spoilt", Route::Rigid)).unwrap();
    let missed =
        |m: &Mold| measured(m).measured.iter().filter(|m| !m.kept).map(|m| m.of.clone()).collect::<Vec<_>>();
    let mut aside = good.clone();
    let half = aside.pieces.iter_mut().find(|p| p.name == "lower").unwrap();
    half.mesh = half.mesh.map(|v| v + DVec3::X * 0.5);
    let said = missed(&aside).join("; ");
    assert!(said.contains("shape of the cavity") && said.contains("share with the part"), "{said}");
    let mut shut = good.clone();
    let half = shut.pieces.iter_mut().find(|p| p.name == "upper").unwrap();
    let lid = cuboid(good.plan.low.with_z(good.plan.high.z - 0.5), good.plan.high);
    half.mesh = solid(&half.mesh).with(&solid(&lid)).mesh();
    assert!(missed(&shut).join("; ").contains("channels that do not reach outside"));
    let mut forgotten = good;
    forgotten.plan.vents.clear();
    assert!(missed(&forgotten).join("; ").contains("high points without a way out"));
}

/// A slot of 0.1 mm in a block: the half that forms it has a fin that no printer makes. One of 3 mm is its good twin.
#[test]
fn a_fin_that_the_printer_can_not_make_is_told_with_its_place() {
    let slotted = |wide: f64| {
        let slot = cuboid(DVec3::new(15.0, -1.0, 10.0), DVec3::new(15.0 + wide, 21.0, 21.0));
        solid(&cuboid(DVec3::ZERO, DVec3::new(30.0, 20.0, 20.0))).minus(&solid(&slot)).mesh()
    };
    let fins = |wide: f64| {
        let report = measured(&make(&slotted(wide), &spec("slotted", Route::Rigid)).unwrap());
        let told: Vec<_> =
            report.findings.into_iter().filter(|f| f.what.contains("has a fin of 0.10 mm")).collect();
        let fins: Vec<_> = report.pieces.into_iter().filter_map(|p| p.fin).collect();
        assert_eq!(told.len(), fins.len());
        assert!(told.iter().all(|f| f.severity == Severity::Warning && f.remedy.contains("slot")));
        (told, fins)
    };
    let (told, found) = fins(0.1);
    assert!(!found.is_empty() && found.iter().all(|f| (f.thin.thickness_mm - 0.1).abs() < 1e-4), "{found:?}");
    let at = told.iter().flat_map(|f| &f.place.at);
    assert!(at.into_iter().all(|p| p.x > 14.999 && p.x < 15.101 && p.z > 9.999), "{told:#?}");
    assert!(fins(3.0).1.is_empty());
}

#[test]
fn a_gang_mold_has_a_sprue_for_each_cavity() {
    let order = MoldSpec { count: 3, ..spec("gang", Route::Rigid) };
    let mold = make(&angle(), &order).unwrap();
    assert_eq!(mold.plan.sprues.len(), 3);
    assert!((mold.part.volume() - 3.0 * angle().volume()).abs() < 1e-2);
    sound(&measured(&mold));
}

#[test]
fn the_solids_around_a_part_form_its_cavity() {
    let part = cuboid(DVec3::ZERO, DVec3::new(30.0, 20.0, 10.0));
    let slab = |lo: [f64; 3], hi: [f64; 3]| cuboid(DVec3::from(lo), DVec3::from(hi));
    let around = vec![
        slab([-9.0, -9.0, -9.0], [0.0, 29.0, 19.0]),
        slab([29.5, -9.0, -9.0], [39.0, 29.0, 19.0]),
        slab([-9.0, -9.0, -9.0], [39.0, 0.0, 19.0]),
        slab([-9.0, 20.0, -9.0], [39.0, 29.0, 19.0]),
    ];
    let order = MoldSpec { surroundings: around.clone(), ..spec("direct", Route::Rigid) };
    let mold = make(&part, &order).unwrap();
    assert!((mold.part.volume() - 29.5 * 20.0 * 10.0).abs() < 1e-2, "{}", mold.part.volume());
    sound(&measured(&mold));
    let all_over = vec![slab([-9.0; 3], [39.0; 3])];
    assert!(make(&part, &MoldSpec { surroundings: all_over, ..order }).is_err());
}

#[test]
fn a_tree_carries_its_patterns_and_says_what_to_mix_and_melt() {
    let order = MoldSpec { count: 5, ..spec("tree", Route::LostWax) };
    let mold = make(&drilled(), &order).unwrap();
    let report = measured(&mold);
    let tree = report.pieces.iter().find(|p| p.kind == Kind::Tree).unwrap();
    assert!(tree.bodies == 1 && tree.volume_mm3 > 5.0 * drilled().volume(), "{tree:?}");
    let grams = |of: &str| mold.volumes.iter().find(|v| v.of == of).and_then(|v| v.grams).unwrap();
    assert!((grams("metal to melt") - tree.volume_mm3 / 1000.0 * 2.7 * 1.1).abs() < 0.1);
    assert!((grams("water") / grams("investment powder") - 0.4).abs() < 1e-9);
    assert!(mold.steps.iter().any(|s| s.celsius == Some(730.0) && !s.source.is_empty()));
}

/// A thick part asks for a runner that is wider than the figure: it gets it, and the modulus rises all the way.
#[test]
fn the_runner_grows_with_what_it_feeds() {
    let brick = cuboid(DVec3::ZERO, DVec3::new(80.0, 60.0, 28.0));
    let mold = make(&brick, &spec("brick", Route::LostWax)).unwrap();
    let of = |what: &str| mold.measured.iter().find(|m| m.of.starts_with(what)).unwrap();
    assert!(of("modulus of the runner").kept && of("modulus of the gate").kept, "{:?}", mold.measured);
    assert!(of("diameter of the runner").value > 20.0, "{:?}", of("diameter of the runner"));
}

#[test]
fn what_can_not_be_molded_is_refused_with_a_hint() {
    let cube = || cuboid(DVec3::ZERO, DVec3::splat(20.0));
    let mut open = cube();
    open.triangles.pop();
    let mut inside_out = cube();
    inside_out.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let mut nan = cube();
    nan.vertices[0].x = f64::NAN;
    let two = solid(&cube()).with(&solid(&cube().map(|v| v + DVec3::X * 50.0))).mesh();
    let hollow = solid(&cube()).minus(&solid(&cube().map(|v| v * 0.5 + 5.0))).mesh();
    let refused = |part: &Mesh, order: &MoldSpec| make(part, order).unwrap_err().to_string();
    let order = spec("bad", Route::Rigid);
    for (part, word) in [
        (open, "not between two opposite"),
        (inside_out, "outward"),
        (nan, "finite"),
        (two, "several bodies"),
        (hollow, "hollow"),
        (Mesh::default(), "no triangles"),
        (Mesh { triangles: vec![[0, 1, 2]; 300_001], ..cube() }, "up to 300000"),
    ] {
        let said = refused(&part, &order);
        assert!(said.contains(word) && said.contains("hint"), "{word}: {said}");
    }
    assert!(refused(&cube(), &MoldSpec { count: 0, ..order.clone() }).contains("count"));
    assert!(refused(&cube(), &MoldSpec { pull: Some(DVec3::ZERO), ..order }).contains("pull"));
}

#[test]
fn the_same_part_gives_the_same_bytes() {
    let bytes = || {
        let (_, dir) = written(&make(&wavy(), &spec("twice", Route::Rigid)).unwrap());
        let mut files: Vec<PathBuf> = std::fs::read_dir(&dir).unwrap().map(|e| e.unwrap().path()).collect();
        files.sort();
        let all: Vec<Vec<u8>> = files.iter().map(|f| std::fs::read(f).unwrap()).collect();
        std::fs::remove_dir_all(dir).unwrap();
        all
    };
    let first = bytes();
    assert!(first.len() > 5 && first == bytes());
}
