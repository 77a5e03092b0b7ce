//! Promises of `weavelock-fab`: clearance, allowance, files, measurements, refusals.

#[path = "fab/large.rs"]
mod large;
#[path = "fab/made.rs"]
mod made_otherwise;
#[path = "fab/shared.rs"]
mod shared;
#[path = "fab/solids.rs"]
mod solids;

use glam::{DAffine3, DVec3};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use weavelock_fab::bvh::Bvh;
use weavelock_fab::check::{
    Outcome, Programs, admesh,
    openscad::{OpenScad, Pair},
    slicer,
};
use weavelock_fab::cross;
use weavelock_fab::files::stl;
use weavelock_fab::gap::{Relation, Verdict};
use weavelock_fab::ledger::Scale;
use weavelock_fab::make::{FabError, Recipe, make};
use weavelock_fab::mesh::{Closure, Mesh};
use weavelock_fab::near;
use weavelock_fab::process::{Overrides, Process, ProcessError, names};
use weavelock_fab::report::{Report, Severity};
use weavelock_fab::shape::{Facet, Job, PlacedPart, Role, Shape};

/// A folder of its own for a test, empty.
fn scratch(name: &str) -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let dir = std::env::temp_dir().join(format!("weavelock-fab-test-{}-{count}-{name}", std::process::id()));
    let _ = fs::remove_dir_all(&dir);
    dir
}

/// FDM in PLA with this clearance, no programs of others.
fn recipe(clearance: f64) -> Recipe {
    let own = Overrides { clearance: Some(clearance), ..Overrides::default() };
    let process = Process::find("fdm-pla").unwrap().with(&own).unwrap();
    Recipe { programs: None, ..Recipe::new(process) }
}

fn made(job: &Job, recipe: &Recipe) -> Report {
    let dir = scratch(&job.name);
    let report = make(job, recipe, &dir).unwrap();
    let _ = fs::remove_dir_all(&dir);
    report
}

fn worst_gap(report: &Report) -> f64 {
    report.gaps.iter().map(|g| g.least_mm / g.promised_mm).fold(f64::INFINITY, f64::min)
}

/// Every part written, closed, of one body; every gap what was promised; the volume gone about clearance x area.
fn all_is_well(job: &Job, clearance: f64) -> Report {
    let report = made(job, &recipe(clearance));
    assert_ne!(report.worst(), Some(Severity::Error), "{}: {:#?}", job.name, report.findings);
    for p in &report.parts {
        assert_eq!(
            (p.read_back.watertight, p.read_back.bodies, p.read_back.genus),
            (Some(true), Some(1), Some(0)),
            "{}",
            p.id
        );
    }
    let neighbours = report.gaps.iter().filter(|g| g.relation == Relation::Neighbours).count();
    assert_eq!(neighbours, job.neighbours().len());
    assert!(report.gaps.iter().all(|g| g.verdict == Verdict::Kept), "{}: {:#?}", job.name, report.gaps);
    assert!(worst_gap(&report) >= 1.0);
    report
}

#[test]
fn a_face_of_a_box_goes_back_by_the_clearance_and_no_other_face_moves() {
    let report = all_is_well(&solids::two_boxes(), 0.2);
    let k = report.scale;
    let lower = &report.parts[0].read_back;
    let high = lower.high.unwrap() / k;
    assert!(high.distance(DVec3::new(20.0, 20.0, 9.8)) < 1e-4, "{high}");
    assert!(lower.low.unwrap().length() < 1e-6);
    let volume = lower.volume_mm3.unwrap() / k.powi(3);
    assert!((volume - 20.0 * 20.0 * 9.8).abs() < 0.01, "{volume}");
}

#[test]
fn every_kind_of_joint_keeps_its_fit() {
    let jobs = [solids::dovetail(), solids::three_around_an_axis(), solids::voxel_hooks(), solids::saddle()];
    for job in &jobs {
        for clearance in [0.05, 0.2, 0.5] {
            let report = all_is_well(job, clearance);
            for p in &report.parts {
                let ratio = p.removed_mm3 / p.clearance_volume_mm3;
                assert!((0.8..1.2).contains(&ratio), "{} {}: {ratio}", job.name, p.id);
            }
        }
    }
}

#[test]
fn congruent_parts_share_one_solid_and_it_fits_in_both_poses() {
    let report = all_is_well(&solids::two_boxes_of_one_shape(), 0.2);
    assert_eq!(report.parts[1].same_as.as_deref(), Some("part-0"));
}

#[test]
fn a_shape_with_other_roles_is_another_solid() {
    let mut job = solids::two_boxes_of_one_shape();
    let with_one_more = job.parts[1].roles.iter().position(|r| *r == Role::Outer).unwrap();
    job.parts[1].roles[with_one_more] = Role::Contact { with: 0 };
    assert_eq!(made(&job, &recipe(0.2)).parts[1].same_as, None);
}

#[test]
fn a_clearance_that_eats_a_part_is_an_error_and_writes_no_file_for_it() {
    let job = solids::thin_plate();
    let dir = scratch("thin");
    let report = make(&job, &recipe(0.6), &dir).unwrap();
    assert_eq!(report.worst(), Some(Severity::Error), "{:#?}", report.findings);
    let plate = &report.parts[1];
    assert_eq!((&plate.file, plate.read_back.watertight), (&None, None));
    let finding = report.findings.iter().find(|f| f.severity == Severity::Error).unwrap();
    assert!(finding.place.parts.contains(&"part-1".to_string()) && !finding.remedy.is_empty());
    assert!(!dir.join("part-1.mm.stl").exists() && !dir.join("part-1.mm.obj").exists());
    let _ = fs::remove_dir_all(&dir);
    all_is_well(&job, 0.4);
}

#[test]
fn the_same_job_gives_the_same_bytes_with_any_number_of_threads() {
    let (job, recipe) = (solids::saddle(), recipe(0.2));
    let run = |threads: usize| {
        let dir = scratch(&format!("threads-{threads}"));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let report = pool.install(|| make(&job, &recipe, &dir)).unwrap();
        let bytes: Vec<Vec<u8>> =
            report.parts.iter().map(|p| fs::read(p.file.as_ref().unwrap()).unwrap()).collect();
        let _ = fs::remove_dir_all(&dir);
        (bytes, format!("{:?}", report.gaps))
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn a_folder_that_can_not_be_is_told_and_leaves_nothing() {
    let file = scratch("is-a-file");
    fs::write(&file, "x").unwrap();
    let error = make(&solids::two_boxes(), &recipe(0.2), &file.join("out")).unwrap_err();
    assert!(matches!(error, FabError::File(_)) && error.to_string().contains("hint"), "{error}");
    fs::remove_file(&file).unwrap();
}

#[test]
fn all_faults_of_a_job_are_told_at_once() {
    let mut job = solids::two_boxes();
    job.shapes[0].facets.pop();
    job.shapes[1].vertices[3].x = f64::NAN;
    job.parts[1].id = "part-0".into();
    let Err(FabError::Job(faults)) = make(&job, &recipe(0.2), Path::new("never")) else { panic!("accepted") };
    let told = faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    for word in ["shape 0", "not closed", "shape 1", "vertex 3", "roles", "same id"] {
        assert!(told.contains(word), "{word} in {told}");
    }
    assert!(!Path::new("never").exists());
}

#[test]
fn the_chain_of_the_workshop_gives_its_factor() {
    let step = |name: &str, s: f64| {
        format!(
            "[[step]]\nname = \"{name}\"\nshrinkage = {{ value = {s}, unit = \"%\", low = 0, high = {s}, source = \"x\", grade = \"S\" }}\n"
        )
    };
    let pla = include_str!("../fab/processes/fdm-pla.toml");
    let head = &pla[..pla.find("[[step]]").unwrap()];
    let steps =
        [("print", 0.2), ("silicone", 0.1), ("wax", 1.5), ("metal", 1.25)].map(|(n, s)| step(n, s)).concat();
    let process = Process::parse("chain.toml", &format!("{head}{steps}")).unwrap();
    let scale = Scale::of(&process, DVec3::new(1.0, 2.0, 3.0));
    assert!((scale.factor - 1.0312).abs() < 5e-5, "{}", scale.factor);
    assert_eq!(scale.up(scale.datum), scale.datum);
    assert!(scale.down(scale.up(DVec3::ONE)).distance(DVec3::ONE) < 1e-15);
    assert_eq!(scale.ledger.len(), 4);
}

#[test]
fn processes_that_come_along_are_sound_and_others_are_refused_with_all_faults() {
    assert!(names().all(|n| Process::find(n).is_ok()));
    let poured = Process::find("wax-poured").unwrap().schedule;
    let step = |word: &str| poured.iter().position(|i| i.what.contains(word)).unwrap();
    assert!(step("warm the mold") < step("Pour the wax"));
    let text = include_str!("../fab/processes/fdm-pla.toml");
    let bad = text
        .replace("value = 0.2\n", "value = 80\n")
        .replace("value = 0.8", "value = -0.8")
        .replace("title", "titel");
    let Err(ProcessError::Faulty { faults, .. }) = Process::parse("bad.toml", &bad) else {
        panic!("accepted")
    };
    let told = faults.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    for word in [
        "80 % is not possible",
        "-0.8 mm is not possible",
        "\"title\" is missing",
        "unknown key \"titel\"",
        "hint",
    ] {
        assert!(told.contains(word), "{word} in {told}");
    }
    let line = bad.lines().position(|l| l.contains("titel")).unwrap() + 1;
    assert!(faults.iter().any(|f| f.line == line && f.what.contains("titel")), "{told}");
    let unknown = Process::find("fdm-plaa").unwrap_err().to_string();
    assert!(unknown.contains("fdm-pla, fdm-petg"), "{unknown}");
    let own = Overrides {
        clearance: Some(-1.0),
        shrinkage: [("print".into(), 80.0), ("cast".into(), 1.0)].into(),
        ..Overrides::default()
    };
    let told = Process::find("sla").unwrap().with(&own).unwrap_err().to_string();
    assert_eq!(told.lines().count(), 3, "{told}");
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/meshes").join(format!("{name}.stl"))
}

fn read(name: &str) -> Mesh {
    stl::read(&mut fs::File::open(fixture(name)).unwrap()).unwrap()
}

#[test]
fn bad_meshes_are_seen_and_the_good_twin_is_not() {
    let seen = |name: &str| {
        let mesh = read(name);
        let crosses = !cross::within(&mesh, &Bvh::new(&mesh)).is_ok_and(|found| found.is_empty());
        (mesh.closure() == Closure::Closed, crosses, mesh.topology().bodies, mesh.volume() > 0.0)
    };
    assert_eq!(seen("cube"), (true, false, 1, true));
    assert!(!seen("cube-open").0 && !seen("cube-flipped-facet").0 && !seen("cube-t-junction").0);
    assert_eq!(seen("cube-inside-out"), (true, false, 1, false));
    assert_eq!(seen("cubes-crossing"), (true, true, 2, true));
    assert_eq!(seen("cubes-apart"), (true, false, 2, true));
    assert_eq!(seen("cube-lid-through-floor"), (true, true, 1, true));
}

#[test]
fn programs_of_others_fail_bad_meshes_and_pass_the_good_one_or_are_not_run() {
    let dir = scratch("programs");
    fs::create_dir_all(&dir).unwrap();
    let programs = Programs::default();
    let scad = OpenScad::new(&programs.openscad, &dir).unwrap();
    let outcomes = |name: &str| {
        let (file, mesh) = (fixture(name), read(name));
        let high = mesh.bounds().1;
        [
            scad.volume(&file, 1000.0, high),
            slicer::part(&programs.slicer, "slicer", &file),
            admesh::part(&programs.admesh, "admesh", &file),
        ]
        .map(|c| c.outcome)
    };
    for (good, bad) in outcomes("cube").into_iter().zip(outcomes("cube-open")) {
        match good {
            Outcome::NotRun(why) => println!("skipped: {why}"),
            good => assert!(good == Outcome::Passed && matches!(bad, Outcome::Failed(_)), "{good:?} {bad:?}"),
        }
    }
    for name in ["cube-flipped-facet", "cube-t-junction"] {
        assert!(!outcomes(name).contains(&Outcome::Passed), "{name}: {:?}", outcomes(name));
    }
    // OpenSCAD turns it right in silence; that is why nobody is asked alone.
    assert!(!outcomes("cube-inside-out")[1..].contains(&Outcome::Passed));
    drop(scad);
    assert_eq!(fs::read_dir(&dir).unwrap().count(), 0);
    let _ = fs::remove_dir_all(&dir);
}

#[test]
fn a_program_that_is_absent_is_not_run_never_passed() {
    let none = "weavelock-no-such-program".to_string();
    let programs = Programs { openscad: none.clone(), slicer: none.clone(), admesh: none };
    let report = made(&solids::two_boxes(), &Recipe { programs: Some(programs), ..recipe(0.2) });
    let all = report.parts.iter().flat_map(|p| &p.checks).chain(report.pair_checks.iter().map(|p| &p.check));
    assert!(all.clone().count() == 7 && all.clone().all(|c| matches!(c.outcome, Outcome::NotRun(_))));
    assert_eq!(report.worst(), Some(Severity::Note));
}

#[test]
fn openscad_agrees_on_a_dovetail_and_sees_parts_that_overlap() {
    let report = made(&solids::dovetail(), &Recipe { programs: Some(Programs::default()), ..recipe(0.2) });
    let all = report.parts.iter().flat_map(|p| &p.checks).chain(report.pair_checks.iter().map(|p| &p.check));
    for c in all {
        match &c.outcome {
            Outcome::NotRun(why) => println!("skipped: {why}"),
            outcome => assert_eq!(*outcome, Outcome::Passed, "{} {}", c.by, c.of),
        }
    }
    let dir = scratch("overlap");
    fs::create_dir_all(&dir).unwrap();
    let scad = OpenScad::new(&Programs::default().openscad, &dir).unwrap();
    let (cube, two) = (fixture("cube"), fixture("cubes-apart"));
    let pairs = [(&*cube, &*cube), (&*cube, &*two)];
    let pairs = pairs.map(|(a, b)| Pair { files: [a, b], factors: [1.0; 2] });
    let same = scad.apart(&pairs, DVec3::ZERO, DVec3::splat(30.0)).swap_remove(0).outcome;
    assert!(
        matches!(&same, Outcome::NotRun(_))
            || matches!(&same, Outcome::Failed(w) if w.contains("share 1000")),
        "{same:?}"
    );
    drop(scad);
    let _ = fs::remove_dir_all(&dir);
}

/// Distances of two meshes by our tree, by trying all pairs, and by parry.
#[test]
fn distances_agree_with_brute_force_and_with_parry() {
    let job = solids::saddle();
    let report = {
        let dir = scratch("distances");
        let report = make(&job, &recipe(0.2), &dir).unwrap();
        let meshes: Vec<Mesh> = report
            .parts
            .iter()
            .map(|p| stl::read(&mut fs::File::open(p.file.as_ref().unwrap()).unwrap()).unwrap())
            .collect();
        let _ = fs::remove_dir_all(&dir);
        meshes
    };
    let (a, b) = (&report[0], &report[1]);
    let ours = near::nearest((a, &Bvh::new(a)), (b, &Bvh::new(b))).distance;
    let pairs = (0..a.triangles.len()).flat_map(|s| (0..b.triangles.len()).map(move |t| (s, t)));
    let brute = pairs
        .map(|(s, t)| near::triangles(a.corners(s), b.corners(t)).distance)
        .fold(f64::INFINITY, f64::min);
    assert_eq!(ours, brute);
    let trimesh =
        |m: &Mesh| parry3d_f64::shape::TriMesh::new(m.vertices.clone(), m.triangles.clone()).unwrap();
    let stay = parry3d_f64::math::Pose::IDENTITY;
    let parry = parry3d_f64::query::distance(&stay, &trimesh(a), &stay, &trimesh(b)).unwrap().distance;
    assert!((ours - parry).abs() < 1e-9, "{ours} {parry}");
}

/// The woven assembly of a spec as a job, in mm.
fn woven(abc: &str, swatch: &str, samples: u32, rise: f64) -> Job {
    let text = format!(
        "name = \"woven\"\n[weave]\nabc = {abc}\n[profile]\nrise = {rise}\nsamples = {samples}\n[swatch]\n{swatch}\n[size]\npitch = \"20 mm\"\n"
    );
    let spec = weavelock::spec::parse(&text, Path::new("woven.toml"), weavelock::spec::Syntax::Toml).unwrap();
    let weavelock::spec::Subject::Woven(subject) = &spec.subject else { panic!("not woven") };
    let woven = weavelock::assembly::woven::build(&spec, subject).unwrap();
    let assembly = &woven.assembly;
    let mm = assembly.mm_per_unit;
    let facet = |f: &weavelock::solid::Facet| Facet { corners: f.corners.clone(), normal: f.normal };
    let shape = |s: &weavelock::solid::Solid| Shape {
        vertices: s.vertices.iter().map(|&v| v * mm).collect(),
        facets: s.facets.iter().map(facet).collect(),
    };
    let part = |p: weavelock::assembly::PartIx| {
        let part = assembly.part(p);
        let pose = DAffine3 { translation: part.pose.translation * mm, ..part.pose };
        let role = |with: Option<weavelock::assembly::PartIx>| {
            with.map_or(Role::Outer, |w| Role::Contact { with: w.at() })
        };
        PlacedPart { id: part.id.clone(), shape: part.solid, pose, roles: woven.faced(p).map(role).collect() }
    };
    Job {
        name: format!("{abc} {samples} {rise}"),
        shapes: assembly.solids.iter().map(shape).collect(),
        parts: assembly.ids().map(part).collect(),
    }
}

#[test]
fn woven_tiles_keep_their_fit_within_a_hundredth() {
    let tiles = |n: u32| format!("wefts = {n}\nwarps = {n}\ncut = \"tiles\"");
    let window = "wefts = 2\nwarps = 2\ncut = \"window\"".to_string();
    for (abc, swatch, samples) in [
        ("[1, 1, 1]", &window, 6),
        ("[1, 1, 1]", &window, 12),
        ("[2, 2, 1]", &tiles(4), 8),
        ("[7, 1, 3]", &tiles(8), 6),
    ] {
        all_is_well(&woven(abc, swatch, samples, 0.6), 0.2);
    }
}

/// A square wave has corners whose facets face one another (one place for each side), a triangular one has none.
#[test]
fn woven_tiles_of_any_rise_can_be_made() {
    for rise in [0.0, 0.3, 1.0] {
        all_is_well(&woven("[3, 1, 1]", "wefts = 4\nwarps = 4\ncut = \"tiles\"", 6, rise), 0.2);
    }
}

#[test]
fn programs_of_others_pass_the_plain_tiles() {
    let job = woven("[1, 1, 1]", "wefts = 2\nwarps = 2\ncut = \"window\"", 6, 0.6);
    let report = made(&job, &Recipe { programs: Some(Programs::default()), ..recipe(0.2) });
    let of_parts = report.parts.iter().flat_map(|p| p.checks.iter());
    for c in of_parts.chain(report.pair_checks.iter().map(|p| &p.check)) {
        match &c.outcome {
            Outcome::NotRun(why) => println!("skipped: {why}"),
            outcome => assert_eq!(*outcome, Outcome::Passed, "{} {}", c.by, c.of),
        }
    }
}

/// Every fifth `[a,b,c]` up to n = 8, each in one of four rises: every part is made and keeps its gap, or a finding says
/// which is not, and what to do.
#[test]
#[ignore = "minutes"]
fn tiles_of_the_atlas_range_are_made_or_told() {
    let all = (2..=8_i32).flat_map(|n| (1..n).flat_map(move |a| (1..n).map(move |c| (a, n - a, c))));
    let mut whole = 0;
    for (k, (a, b, c)) in all.enumerate().filter(|(k, _)| k % 5 == 0) {
        let swatch = format!("wefts = {0}\nwarps = {0}\ncut = \"tiles\"", a + b);
        let job = woven(&format!("[{a},{b},{c}]"), &swatch, 6, [0.0, 0.3, 0.6, 1.0][k / 5 % 4]);
        for clearance in [0.2, 3.0] {
            let report = made(&job, &recipe(clearance));
            if report.worst() != Some(Severity::Error) {
                assert!(worst_gap(&report) >= 1.0, "{} at {clearance} mm", job.name);
                whole += usize::from(clearance < 1.0);
                continue;
            }
            for p in report.parts.iter().filter(|p| p.file.is_none()) {
                let told = |f: &&weavelock_fab::report::Finding| {
                    f.place.parts.contains(&p.id) && !f.remedy.is_empty()
                };
                assert!(report.findings.iter().any(|f| told(&f)), "{}: {} is not told", job.name, p.id);
            }
            println!("{} at {clearance} mm: not wholly made", job.name);
        }
    }
    assert!(whole > 0, "no tile was made");
}
