//! Assemblies of mesh files: verdicts of fixtures in pairs, of other people's cases, the laws that no frame
//! may break, and files and overlaps that must be refused.

mod files;
mod firm;
mod fixed;
mod kept;
mod made;
mod noisy;
mod poly;

use glam::{DAffine3, DQuat, DVec3};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use weavelock::assembly::mesh::{MeshFaults, Place, Reading, read_mesh};
use weavelock::assembly::{Assembly, Mobility, Part, PartIx, read};
use weavelock::contact::mesh::{Kind, MeshContacts, Why, mesh_patches};
use weavelock::locking;
use weavelock::solid::{Facet, Solid};
use weavelock::spec::{self, Subject};

const TOLERANCE: f64 = 0.001;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn spec_assembly(path: &Path) -> Assembly {
    let spec = spec::read(path).unwrap_or_else(|e| panic!("{e}"));
    let Subject::Meshes(meshes) = &spec.subject else { panic!("{}: no meshes", path.display()) };
    read::assembly(&spec, meshes).unwrap_or_else(|e| panic!("{e}")).assembly
}

fn contacts(assembly: &Assembly) -> MeshContacts {
    mesh_patches(assembly, &[], TOLERANCE).unwrap_or_else(|e| panic!("{}: {e}", assembly.name))
}

/// Words of the translation and the rigid verdict.
fn verdict(assembly: &Assembly, fix: Option<PartIx>) -> [&'static str; 2] {
    let check = locking::check(assembly, &contacts(assembly).patches, fix);
    [check.translation.word(), check.rigid.word()]
}

// --- fixtures in pairs ---

struct Expected {
    verdict: [String; 2],
    twin: String,
}

/// The lines `# expect: translation = ..., rigid = ...` and `# twin: ...` of a fixture.
fn expected(text: &str) -> Expected {
    let after =
        |key: &str| text.lines().find_map(|l| l.strip_prefix(key)).unwrap_or_else(|| panic!("no `{key}`"));
    let words: Vec<String> =
        after("# expect:").split(',').map(|s| s.split('=').nth(1).unwrap().trim().to_owned()).collect();
    Expected { verdict: words.try_into().unwrap(), twin: after("# twin:").trim().to_owned() }
}

fn fixtures() -> BTreeMap<String, PathBuf> {
    let dir = root().join("fixtures/assemblies");
    let files = std::fs::read_dir(dir).unwrap().map(|e| e.unwrap().path());
    let tomls = files.filter(|p| p.extension().is_some_and(|e| e == "toml"));
    tomls.map(|p| (p.file_stem().unwrap().to_string_lossy().into_owned(), p)).collect()
}

#[test]
fn every_fixture_has_its_verdict_and_a_twin_that_says_otherwise() {
    let all = fixtures();
    assert!(all.len() >= 27, "only {} fixtures", all.len());
    let read = |p: &Path| expected(&std::fs::read_to_string(p).unwrap());
    for (name, path) in &all {
        let want = read(path);
        let twin = read(all.get(&want.twin).unwrap_or_else(|| panic!("{name}: no twin {}", want.twin)));
        assert_ne!(want.verdict, twin.verdict, "{name} and its twin say the same");
        assert_eq!(verdict(&spec_assembly(path), None), want.verdict, "{name}");
    }
}

#[test]
fn what_touches_in_the_fixtures() {
    let kinds = |name: &str| {
        let c = contacts(&spec_assembly(&fixtures()[name]));
        let of = |k: Kind| c.facts.iter().filter(|f| f.kind == k).count();
        ([of(Kind::Face), of(Kind::Edge), of(Kind::Point)], c.assumed.len())
    };
    // Base and two flanks; the mouth's edges stand in the corners under the tail's shoulders.
    assert_eq!(kinds("dovetail-open"), ([3, 2, 0], 0));
    assert_eq!(kinds("jack-in-case"), ([0, 0, 6], 0));
    assert_eq!(kinds("knob-in-case"), ([2, 4, 0], 0));
    assert_eq!(kinds("knife-between-knives"), ([0, 0, 2], 0));
    assert_eq!(kinds("bricks-corner-to-corner"), ([0, 0, 0], 1));
}

#[test]
fn crossing_edges_push_along_their_common_perpendicular() {
    let a = spec_assembly(&fixtures()["knife-between-knives"]);
    let c = contacts(&a);
    let got: Vec<_> = c.patches.iter().map(|p| (p.a.0, p.b.0, p.normal, p.corners.clone())).collect();
    let z = |h: f64| vec![DVec3::new(0.0, 0.0, h)];
    assert_eq!(got, [(0, 1, DVec3::Z, z(2.0)), (0, 2, -DVec3::Z, z(-2.0))]);
}

// --- other people's cases ---

fn case(name: &str, held: &[&str]) -> Option<Assembly> {
    let dir = root().join("../shared/cases/topolite").join(name);
    let Ok(files) = std::fs::read_dir(&dir) else {
        println!("skipped: no {} beside this repository", dir.display());
        return None;
    };
    let mut files: Vec<PathBuf> = files.map(|e| e.unwrap().path()).collect();
    files.sort();
    let solids: Vec<Solid> = files.iter().map(|f| mesh(f).unwrap_or_else(|e| panic!("{e}"))).collect();
    let id = |f: &PathBuf| f.file_stem().unwrap().to_string_lossy().into_owned();
    Some(placed(
        solids.into_iter().zip(files.iter().map(id)).map(|(s, id)| (id, s, DAffine3::IDENTITY)).collect(),
        held,
    ))
}

fn mesh(path: &Path) -> Result<Solid, MeshFaults> {
    read_mesh(path, Reading { mm_per_unit: 1.0, tolerance: TOLERANCE }).map(|m| m.solid)
}

fn placed(parts: Vec<(String, Solid, DAffine3)>, held: &[&str]) -> Assembly {
    let mut a = Assembly { name: "test".into(), solids: vec![], parts: vec![], mm_per_unit: 1.0 };
    for (id, solid, pose) in parts {
        let mobility = if held.contains(&id.as_str()) { Mobility::Held } else { Mobility::Free };
        a.parts.push(Part { id, solid: a.solids.len(), pose, mobility });
        a.solids.push(solid);
    }
    assert_eq!(a.held().count(), held.len());
    a
}

const CASES: [(&str, &[&str], &str); 7] = [
    ("bunny", &["part_1", "part_2"], "locked"),
    ("bunny", &["part_1"], "free"),
    ("cube9", &["part_1", "part_2"], "locked"),
    ("cube9", &["part_1"], "free"),
    ("roof", &["Boundary"], "locked"),
    ("frame14", &["piece0"], "free"),
    ("between-bars-3", &["piece0", "piece1"], "free"),
];

#[test]
fn cases_of_others_have_their_known_verdicts() {
    for (name, held, want) in CASES {
        let Some(a) = case(name, held) else { return };
        assert_eq!(verdict(&a, None), [want; 2], "{name} held {held:?}");
    }
}

#[test]
fn with_nothing_held_the_verdict_does_not_depend_on_the_part_that_is_fixed() {
    let Some(a) = case("cube9", &[]) else { return };
    let patches = contacts(&a).patches;
    for p in a.ids() {
        assert_eq!(locking::check(&a, &patches, Some(p)).rigid.word(), "free", "{}", a.part(p).id);
    }
}

// --- laws ---

fn moved(a: &Assembly, m: DAffine3) -> Assembly {
    let mut b = a.clone();
    b.parts.iter_mut().for_each(|p| p.pose = m * p.pose);
    b
}

/// The mirror image in x = 0: solids and poses both, so that poses stay proper.
fn mirrored(a: &Assembly) -> Assembly {
    let flip = DVec3::new(-1.0, 1.0, 1.0);
    let m = DAffine3::from_scale(flip);
    let mut b = a.clone();
    for s in &mut b.solids {
        s.vertices.iter_mut().for_each(|v| *v *= flip);
        s.facets.iter_mut().for_each(|f| {
            f.corners.reverse();
            f.normal *= flip;
        });
    }
    b.parts.iter_mut().for_each(|p| p.pose = m * p.pose * m);
    b
}

fn renumbered(a: &Assembly) -> Assembly {
    let mut b = a.clone();
    b.parts.reverse();
    b
}

/// Area of all faces that touch: however it is cut into patches.
fn touching_area(a: &Assembly) -> f64 {
    let fan = |c: &[DVec3]| {
        (1..c.len() - 1).map(|k| (c[k] - c[0]).cross(c[k + 1] - c[0]).length() / 2.0).sum::<f64>()
    };
    contacts(a).patches.iter().filter(|p| p.corners.len() > 2).map(|p| fan(&p.corners)).sum()
}

/// Numbers of edge, point and assumed contacts.
fn small(a: &Assembly) -> [usize; 3] {
    let c = contacts(a);
    let of = |k: Kind| c.facts.iter().filter(|f| f.kind == k).count();
    [of(Kind::Edge), of(Kind::Point), c.assumed.len()]
}

#[test]
fn turning_mirroring_renumbering_and_distance_change_nothing() {
    let turn = DAffine3::from_rotation_translation(
        DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.234),
        DVec3::new(3.0, -4.0, 5.0),
    );
    let far = DAffine3::from_translation(DVec3::new(1e6, -1e6, 2e6));
    for (name, path) in fixtures() {
        let a = spec_assembly(&path);
        let (area, few, want) = (touching_area(&a), small(&a), verdict(&a, None));
        let variants =
            [("turned", moved(&a, turn)), ("far", moved(&a, far)), ("both", moved(&a, far * turn))];
        let more = [("mirrored", mirrored(&a)), ("renumbered", renumbered(&a))];
        for (how, b) in variants.into_iter().chain(more) {
            assert!((touching_area(&b) - area).abs() < 1e-6 * area.max(1.0), "{name} {how}");
            assert_eq!(small(&b), few, "{name} {how}");
            assert_eq!(verdict(&b, None), want, "{name} {how}");
        }
    }
}

#[test]
fn the_same_bytes_with_one_thread_and_with_many() {
    let a = spec_assembly(&fixtures()["panel-in-frame"]);
    let with = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| format!("{:?}", contacts(&a)))
    };
    assert_eq!(with(1), with(5));
}

// --- bricks dropped on each other at random, against another program's distance ---

/// The distance between brick `a` and brick `b`, posed, as parry finds it.
fn parry_distance(half: [DVec3; 2], pose: [DAffine3; 2]) -> f64 {
    use parry3d_f64::{math::Pose, query, shape::Cuboid};
    let at = |m: &DAffine3| Pose::from_parts(m.translation, DQuat::from_mat3(&m.matrix3));
    let [a, b] = half.map(Cuboid::new);
    query::distance(&at(&pose[0]), &a, &at(&pose[1]), &b).unwrap().distance
}

fn share(seed: &mut u64) -> f64 {
    (noise(seed) % 1_000_000) as f64 / 1e6
}

fn direction(seed: &mut u64) -> DVec3 {
    let v = DVec3::new(share(seed), share(seed), share(seed)) * 2.0 - 1.0;
    if v.length() > 0.1 && v.length() < 1.0 { v.normalize() } else { direction(seed) }
}

#[test]
fn the_one_row_of_two_bricks_that_just_touch_is_the_way_apart() {
    let (mut seed, mut edges, mut points) = (0x1234_5678_9abc_def1, 0, 0);
    for round in 0..300 {
        let half = [(); 2].map(|_| DVec3::new(share(&mut seed), share(&mut seed), share(&mut seed)) + 0.5);
        let turn = [(); 2].map(|_| DQuat::from_axis_angle(direction(&mut seed), 6.0 * share(&mut seed)));
        let way = direction(&mut seed);
        let posed = |shift: DVec3| {
            [DAffine3::from_quat(turn[0]), DAffine3::from_rotation_translation(turn[1], shift)]
        };
        // From clear to touching by halving: the gap left is far below the tolerance.
        let (mut near, mut far) = (0.0, 10.0);
        while far - near > 1e-9 {
            let middle = (near + far) / 2.0;
            if parry_distance(half, posed(way * middle)) > 0.0 { far = middle } else { near = middle }
        }
        let pose = posed(way * far);
        let parts = [0, 1].map(|k| (["a", "b"][k].to_owned(), brick(-half[k], half[k]), pose[k]));
        // A tolerance near the gap that is left: within a wider one a second corner may touch as well.
        let c = mesh_patches(&placed(parts.to_vec(), &[]), &[], 1e-6).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(c.patches.len() + c.assumed.len(), 1, "round {round}: {c:?}");
        let n = c.patches[0].normal;
        let apart = parry_distance(half, posed(way * far + 0.01 * n));
        assert!((apart - 0.01).abs() < 1e-7, "round {round}: {apart} along {n}");
        let local = pose[1].inverse().transform_point3(c.patches[0].corners[0]);
        let on_rim = (local.abs() - half[1]).abs().to_array().iter().filter(|d| **d < 1e-6).count();
        if on_rim == 2 { edges += 1 } else { points += 1 }
    }
    println!("{edges} edges crossed, {points} corners on faces");
    assert!(edges > 50 && points > 50);
}

// --- overlaps ---

fn brick(lo: DVec3, hi: DVec3) -> Solid {
    let corner = |k: usize| DVec3::select(glam::BVec3::new(k & 1 > 0, k & 2 > 0, k & 4 > 0), hi, lo);
    let sides: [([u32; 4], DVec3); 6] = [
        ([0, 4, 6, 2], -DVec3::X),
        ([1, 3, 7, 5], DVec3::X),
        ([0, 1, 5, 4], -DVec3::Y),
        ([2, 6, 7, 3], DVec3::Y),
        ([0, 2, 3, 1], -DVec3::Z),
        ([4, 5, 7, 6], DVec3::Z),
    ];
    let facets = sides.map(|(corners, normal)| Facet { corners: corners.to_vec(), normal }).to_vec();
    Solid { vertices: (0..8).map(corner).collect(), facets, ..Solid::default() }
}

fn pair(a: Solid, b: Solid, pose: DAffine3) -> Assembly {
    placed(vec![("a".into(), a, DAffine3::IDENTITY), ("b".into(), b, pose)], &[])
}

fn unit() -> Solid {
    brick(DVec3::ZERO, DVec3::ONE)
}

#[test]
fn overlaps_are_refused_with_both_names_and_the_depth() {
    let at = |x: f64, y: f64, z: f64| DAffine3::from_translation(DVec3::new(x, y, z));
    let bar = brick(DVec3::new(-3.0, 0.3, 0.3), DVec3::new(3.0, 0.7, 0.7));
    let inner = brick(DVec3::splat(0.4), DVec3::splat(0.6));
    let cases = [
        ("pushed in by 0.01", pair(unit(), unit(), at(0.0, 0.0, 0.99)), 0.01),
        ("the same brick twice", pair(unit(), unit(), DAffine3::IDENTITY), 0.5),
        ("a bar right through", pair(unit(), bar, DAffine3::IDENTITY), 0.3),
        ("one wholly inside", pair(unit(), inner.clone(), DAffine3::IDENTITY), 0.4),
        ("the other way round", pair(inner, unit(), DAffine3::IDENTITY), 0.4),
        ("a corner", pair(unit(), unit(), at(0.98, 0.97, 0.96)), 0.02),
    ];
    for (what, a, depth) in cases {
        let faults = mesh_patches(&a, &[], TOLERANCE).err().unwrap_or_else(|| panic!("{what}: not seen")).0;
        assert_eq!(faults.len(), 1, "{what}");
        let f = &faults[0];
        assert_eq!((f.a_id.as_str(), f.b_id.as_str()), ("a", "b"));
        assert!(f.depth >= 0.5 * depth && f.depth <= 1.01 * depth, "{what}: {} of {depth}", f.depth);
        assert!(f.to_string().contains("`a` and `b`"));
    }
}

#[test]
fn less_than_the_tolerance_is_contact_and_more_is_air() {
    let at = |z: f64| pair(unit(), unit(), DAffine3::from_translation(DVec3::new(0.0, 0.0, z)));
    for (z, patches) in [(0.9995, 1), (1.0, 1), (1.0005, 1), (1.002, 0)] {
        assert_eq!(contacts(&at(z)).patches.len(), patches, "{z}");
    }
}

// --- convex cells ---

#[test]
fn cells_fill_every_fixture_and_lie_inside() {
    for (name, path) in fixtures() {
        for (k, solid) in spec_assembly(&path).solids.iter().enumerate() {
            assert!(!solid.cells.is_empty(), "{name}: solid {k} has no cells");
            let bounds = |p: &dyn Fn(DVec3) -> f64| {
                solid.vertices.iter().map(|&v| p(v)).fold(f64::NEG_INFINITY, f64::max)
            };
            for cell in &solid.cells {
                for &(n, d) in &cell.planes {
                    let far = cell.vertices.iter().map(|v| n.dot(*v) - d).fold(f64::NEG_INFINITY, f64::max);
                    assert!(far.abs() < 1e-6, "{name}: a plane stands {far} off its cell");
                }
                for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                    let reach = cell.vertices.iter().map(|v| v.dot(axis)).fold(f64::NEG_INFINITY, f64::max);
                    assert!(reach <= bounds(&|v| v.dot(axis)) + 1e-6, "{name}");
                }
            }
        }
    }
}

#[test]
fn plans_are_found_for_what_slides_out_and_none_for_what_is_locked() {
    for (name, steps) in
        [("dovetail-open", 1), ("panel-without-rail", 1), ("taper-with-draft", 1), ("dovetail-stopped", 0)]
    {
        let a = spec_assembly(&fixtures()[name]);
        let plan = weavelock::sequence::plan(&a, &contacts(&a).patches, |_| None::<()>)
            .unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(plan.steps.len(), steps, "{name}: {:?}", plan.outcome);
        let checked = weavelock::verify::plan::check(&a, &plan);
        println!("{name}: {:?} {} steps; check {checked:?}", plan.outcome, plan.steps.len());
    }
}

// --- broken files ---

#[test]
fn broken_meshes_are_refused_with_file_place_and_hint() {
    let dir = root().join("fixtures/meshes");
    type Wanted = (&'static str, &'static str, fn(&Place) -> bool);
    let wanted: [Wanted; 14] = [
        ("broken-crosses-itself.obj", "another face of the same shell", |p| matches!(p, Place::Edge(..))),
        ("broken-package.3mf", "no 3MF package", |p| *p == Place::File),
        ("broken-open.obj", "open", |p| matches!(p, Place::Edge(..))),
        ("broken-flipped-face.obj", "one faces inward", |p| matches!(p, Place::Edge(..))),
        ("broken-inside-out.obj", "inside out", |p| matches!(p, Place::Edge(..))),
        ("broken-zero-thickness.obj", "without thickness", |p| matches!(p, Place::File)),
        ("broken-three-faces-on-an-edge.obj", "open", |p| matches!(p, Place::Edge(..))),
        ("broken-face-twice.obj", "2 times", |p| matches!(p, Place::Edge(..))),
        ("broken-nan.obj", "finite", |p| *p == Place::Line(3)),
        ("broken-text.stl", "neither ASCII STL", |p| matches!(p, Place::Byte(_))),
        ("broken-truncated.stl", "12 triangles need 684 bytes", |p| matches!(p, Place::Byte(_))),
        ("broken-claims-too-much.stl", "4294967295 triangles", |p| matches!(p, Place::Byte(_))),
        ("broken-nan.stl", "finite", |p| *p == Place::Face(5)),
        ("broken-bow-tie.obj", "crosses itself", |p| matches!(p, Place::Edge(..))),
    ];
    for (file, what, place) in wanted {
        let faults = mesh(&dir.join(file)).err().unwrap_or_else(|| panic!("{file} was taken")).0;
        let hit = faults.iter().find(|f| f.what.contains(what));
        let hit = hit.unwrap_or_else(|| panic!("{file}: {faults:?}"));
        assert!(place(&hit.place) && hit.file.ends_with(file) && !hit.hint.is_empty(), "{hit:?}");
    }
    let listed = wanted.map(|w| w.0);
    let there = std::fs::read_dir(&dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    for file in there.filter(|f| f.starts_with("broken")) {
        assert!(listed.contains(&file.as_str()), "{file} is not tried");
    }
}

/// What numerals and lines are made of.
const GLYPHS: &[u8] = b"0123456789.-e /\n";

/// A small generator of its own (xorshift): the same bytes every run.
fn noise(seed: &mut u64) -> usize {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    *seed as usize
}

#[test]
fn no_damage_to_a_file_makes_a_reader_panic_and_what_is_taken_is_closed() {
    let dir = root().join("fixtures/assemblies/parts");
    let work = std::env::temp_dir().join(format!("weavelock-damaged-{}", std::process::id()));
    std::fs::create_dir_all(&work).unwrap();
    let (mut seed, mut refused, mut taken) = (0x9e37_79b9_7f4a_7c15, 0, 0);
    for name in ["dovetail-tail.obj", "jack.stl", "left-stop.stl", "block.3mf", "panel-strips.obj"] {
        let whole = std::fs::read(dir.join(name)).unwrap();
        for _ in 0..300 {
            let mut bytes = whole.clone();
            for _ in 0..1 + noise(&mut seed) % 4 {
                let at = noise(&mut seed) % bytes.len();
                match noise(&mut seed) % 4 {
                    0 => bytes.truncate(at.max(1)),
                    1 => bytes[at] = noise(&mut seed) as u8,
                    2 => bytes[at] = GLYPHS[noise(&mut seed) % GLYPHS.len()],
                    _ => drop(bytes.drain(at..(at + 7).min(bytes.len()))),
                }
                if bytes.is_empty() {
                    break;
                }
            }
            let file = work.join(name);
            std::fs::write(&file, &bytes).unwrap();
            match mesh(&file) {
                Ok(solid) => {
                    assert!(solid.volume() > 0.0, "{name}");
                    taken += 1;
                }
                Err(faults) => {
                    assert!(!faults.0.is_empty());
                    refused += 1;
                }
            }
        }
    }
    std::fs::remove_dir_all(&work).unwrap();
    println!("{refused} refused, {taken} taken");
    assert!(refused > 300 && taken > 30, "{refused} {taken}");
}

#[test]
fn odd_but_sound_meshes_are_taken_with_a_remark() {
    let dir = root().join("fixtures/meshes");
    let read = |f: &str| read_mesh(&dir.join(f), Reading { mm_per_unit: 1.0, tolerance: TOLERANCE });
    for (file, remark) in [
        ("odd-two-bodies.obj", "2 bodies"),
        ("odd-touches-itself.obj", "touches itself along 1 edges"),
        ("odd-inner-wall.obj", "1 walls inside"),
        ("odd-hollow.obj", "1 hollows"),
    ] {
        let mesh = read(file).unwrap_or_else(|e| panic!("{e}"));
        assert!(mesh.remarks.iter().any(|r| r.contains(remark)), "{file}: {:?}", mesh.remarks);
    }
}

#[test]
fn every_listed_reason_for_no_row_is_a_different_word() {
    let a = spec_assembly(&fixtures()["bricks-corner-to-corner"]);
    assert_eq!(contacts(&a).assumed[0].why, Why::ManyNormals);
}
