//! Blocking graphs: those of the arrangement against a count of cubes in each other's way, against sweeps, under their
//! own laws, and as files read back.

use crate::random::voxels;
use crate::support::Dice;
use glam::{DQuat, DVec3};
use quick_xml::events::Event;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use weavelock::assembly::{Assembly, PartIx};
use weavelock::blocking::Touch;
use weavelock::blocking::graph::{self, pairs};
use weavelock::blocking::ndbg::{Ndbg, Reach, Resolution, ndbg};
use weavelock::blocking::shadow::{Shapes, View};
use weavelock::contact::{Joined, Patch, Slack, Touching, join};
use weavelock::report::answer::{self, Found};
use weavelock::report::graphs::{self, Attributes, Graph, Node};
use weavelock::solid::Cell;
use weavelock::spec::{Syntax, parse};

type Voxel = [i32; 3];
type Arcs = BTreeSet<(usize, usize)>;

/// Cubes by the part that they belong to, as an assembly with cells, turned by `by`.
struct Cubes {
    owner: BTreeMap<Voxel, usize>,
    asm: Assembly,
    patches: Vec<Patch>,
}

fn cubes(owner: BTreeMap<Voxel, usize>, held: &[bool], by: DQuat) -> Cubes {
    let (mut asm, mut patches) = voxels(&owner, held);
    for (k, solid) in asm.solids.iter_mut().enumerate() {
        let own = owner.iter().filter(|(_, o)| **o == k).map(|(v, _)| *v);
        solid.cells = own.map(|v| cube(v, by)).collect();
        solid.vertices.iter_mut().for_each(|v| *v = by * *v);
    }
    for p in &mut patches {
        p.normal = by * p.normal;
        p.corners.iter_mut().for_each(|c| *c = by * *c);
    }
    Cubes { owner, asm, patches }
}

fn cube(v: Voxel, by: DQuat) -> Cell {
    let low = DVec3::from_array(v.map(f64::from));
    let corner = |k: i32| low + DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2));
    let planes = DVec3::AXES.iter().flat_map(|&n| [(by * n, n.dot(low) + 1.0), (by * -n, -n.dot(low))]);
    Cell { vertices: (0..8).map(|k| by * corner(k)).collect(), facets: vec![], planes: planes.collect() }
}

fn random_cubes(seed: u64, by: DQuat) -> Cubes {
    let mut dice = Dice::new(seed);
    let count = 2 + dice.below(3);
    let mut owner = BTreeMap::new();
    for k in 0..12 {
        let at = [k % 3, k / 3 % 2, k / 6];
        // A third of the places stay empty, so that parts also meet after a way.
        if dice.below(3) > 0 {
            owner.insert(at, dice.below(count));
        }
    }
    owner.extend((0..count).map(|p| ([p as i32, 3, 0], p)));
    cubes(owner, &vec![false; count], by)
}

impl Cubes {
    /// Which part runs into which along `d` (in the cubes' own frame): interval by interval, nothing of the program.
    fn truth(&self, d: DVec3, reach: Reach) -> Arcs {
        let mut arcs = Arcs::new();
        for (v, &i) in &self.owner {
            for (w, &j) in self.owner.iter().filter(|(_, j)| **j != i) {
                let gap = [0, 1, 2].map(|c| f64::from(w[c] - v[c]));
                let hits = match reach {
                    Reach::Finite => meets(gap, d),
                    // A shared square pushes at once; edges and corners do not.
                    Reach::Infinitesimal => {
                        gap.iter().map(|g| g.abs()).sum::<f64>() == 1.0
                            && DVec3::from_array(gap).dot(d) > SLACK
                    }
                };
                if hits {
                    arcs.insert((i, j));
                }
            }
        }
        arcs
    }

    fn ndbg(&self, reach: Reach) -> Ndbg {
        ndbg(Touching::exactly(&self.asm, &self.patches), reach).expect("an arrangement")
    }
}

/// A slide along a face is none into it, though the direction's numbers are rounded.
const SLACK: f64 = 1e-9;

/// Whether an open unit cube, moved along d, meets one that lies `gap` away.
fn meets(gap: [f64; 3], d: DVec3) -> bool {
    let (mut from, mut to) = (0.0_f64, f64::INFINITY);
    for (g, rate) in gap.into_iter().zip(d.to_array()) {
        if rate.abs() <= SLACK {
            if g.abs() >= 1.0 {
                return false;
            }
            continue;
        }
        let (a, b) = ((g - 1.0) / rate, (g + 1.0) / rate);
        (from, to) = (from.max(a.min(b)), to.min(a.max(b)));
    }
    from + SLACK < to
}

fn arcs(ndbg: &Ndbg, graph: usize) -> Arcs {
    ndbg.graphs[graph].arcs.iter().map(|(i, j)| (i.at(), j.at())).collect()
}

fn attitudes() -> [DQuat; 2] {
    [DQuat::IDENTITY, DQuat::from_scaled_axis(DVec3::new(0.4, -1.3, 0.8))]
}

/// Directions dense over the sphere, and the axes and diagonals where slides are.
fn probes(dice: &mut Dice) -> Vec<DVec3> {
    let grid =
        (0..27).map(|k| DVec3::new(f64::from(k % 3 - 1), f64::from(k / 3 % 3 - 1), f64::from(k / 9 - 1)));
    let dense = (0..300).map(|_| DVec3::new(dice.signed(), dice.signed(), dice.signed()));
    grid.chain(dense).filter_map(DVec3::try_normalize).collect()
}

/// Every region says what the count of cubes says, and no direction tried has a graph that no region has.
#[test]
fn every_region_is_true_and_none_is_missing() {
    let mut seen = 0;
    for seed in 0..24 {
        for by in attitudes() {
            let made = random_cubes(seed, by);
            for reach in [Reach::Infinitesimal, Reach::Finite] {
                let found = made.ndbg(reach);
                for region in &found.regions {
                    let truth = made.truth(by.inverse() * region.d, reach);
                    assert_eq!(arcs(&found, region.graph), truth, "seed {seed}, {by}, {reach:?}, {region:?}");
                }
                let known: BTreeSet<Arcs> = (0..found.graphs.len()).map(|k| arcs(&found, k)).collect();
                for d in probes(&mut Dice::new(seed)) {
                    let truth = made.truth(d, reach);
                    assert!(
                        known.contains(&truth),
                        "seed {seed}, {by}, {reach:?}: no region has that of {d}"
                    );
                    seen += 1;
                }
                laws(&found, &format!("seed {seed}, {by}, {reach:?}"));
            }
        }
    }
    assert!(seen > 10_000);
}

/// Turned by any angle, an assembly has as many patches, arcs and single directions, and as many graphs.
#[test]
fn turning_changes_no_count() {
    for seed in 0..24 {
        for reach in [Reach::Infinitesimal, Reach::Finite] {
            let counts = attitudes().map(|by| {
                let found = random_cubes(seed, by).ndbg(reach);
                let of = |k: u8| found.regions.iter().filter(|r| r.dimension == k).count();
                ([of(0), of(1), of(2)], found.graphs.len())
            });
            assert_eq!(counts[0], counts[1], "seed {seed}, {reach:?}");
        }
    }
}

/// The laws of `blocking::ndbg`: what blocks at an edge blocks beside it; the opposite direction turns all arcs round.
fn laws(found: &Ndbg, about: &str) {
    let of = |kind: usize, cell: usize| arcs(found, found.regions[found.region_of[kind][cell]].graph);
    for (k, e) in found.arrangement.edges.iter().enumerate() {
        let own = of(1, k);
        assert!([e.left, e.right].iter().all(|&f| own.is_subset(&of(0, f))), "{about}: {e:?}");
        assert!([e.from, e.to].iter().all(|&v| of(2, v).is_subset(&own)), "{about}: {e:?}");
    }
    let known: BTreeSet<Arcs> = (0..found.graphs.len()).map(|k| arcs(found, k)).collect();
    for graph in &known {
        let back: Arcs = graph.iter().map(|&(i, j)| (j, i)).collect();
        assert!(known.contains(&back), "{about}: {graph:?} has no opposite");
    }
}

fn fixture(name: &str) -> (PathBuf, Joined) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/assemblies/{name}.toml"));
    let text = std::fs::read_to_string(&file).expect("a fixture");
    let spec = parse(&text, &file, Syntax::Toml).unwrap_or_else(|f| panic!("{f}"));
    (file, join(&spec).unwrap_or_else(|f| panic!("{f}")))
}

fn found(name: &str, reach: Reach) -> (Joined, Ndbg) {
    let joined = fixture(name).1;
    let found = ndbg(joined.touching(), reach).expect("an arrangement");
    (joined, found)
}

/// In every region the graph is the one that sweeps find along its direction, and a set that can leave is stopped by
/// nothing: woven tiles and meshes, oblique and curved.
#[test]
fn regions_agree_with_sweeps() {
    for name in [
        "burr",
        "swirl",
        "dovetail-open",
        "taper-with-draft",
        "woven/basket-quarter",
        "woven/plain-unit-key",
        "woven/twill-unit",
    ] {
        let (joined, found) = found(name, Reach::Finite);
        assert!(
            found.arrangement.merged < found.circles.resolution().plane(),
            "{name}: {}",
            found.arrangement.merged
        );
        let asm = &joined.assembly;
        let (shapes, touch) = (Shapes::of(asm), Touch::of(asm));
        let held: BTreeSet<PartIx> = asm.held().collect();
        for region in &found.regions {
            let view = View::new(&shapes, region.d);
            let mut dbg =
                graph::infinitesimal(&found.parts, &joined.patches, &pairs(&joined.patches), region.d);
            let plain = dbg.clone();
            graph::stop_later(&mut dbg, &view, touch, |i, j| !plain.contains_edge(i, j));
            let swept =
                dbg.edge_indices().filter_map(|e| dbg.edge_endpoints(e)).map(|(i, j)| (dbg[i], dbg[j]));
            let swept: BTreeSet<(PartIx, PartIx)> =
                swept.filter(|(i, j)| !(held.contains(i) && held.contains(j))).collect();
            let graph = &found.graphs[region.graph];
            assert_eq!(graph.arcs.iter().copied().collect::<BTreeSet<_>>(), swept, "{name}: {region:?}");
            for set in &graph.leave {
                assert!(swept.iter().all(|(i, j)| !set.contains(i) || set.contains(j)), "{name}: {set:?}");
            }
        }
    }
}

/// Two planes between a pair, some ten millionths of a radian apart: along the lune between them each part stops the other. Where
/// the file's digits leave that much open, they are one plane.
#[test]
fn planes_are_told_apart_as_far_as_the_digits_go() {
    let owner = BTreeMap::from([([0, 0, 0], 0), ([0, 0, 1], 1)]);
    let Cubes { asm, patches, .. } = cubes(owner, &[false, false], DQuat::from_rotation_x(0.7));
    let tilt = DQuat::from_axis_angle(patches[0].normal.any_orthonormal_vector(), 3e-7);
    let tilted = Patch { normal: tilt * patches[0].normal, ..patches[0].clone() };
    let patches = [patches[0].clone(), tilted];
    let counts = |angle: f64| {
        let slack = [Slack { angle, distance: 0.0 }; 2];
        let known = Touching { slack: &slack, ..Touching::exactly(&asm, &patches) };
        let found = ndbg(known, Reach::Infinitesimal).expect("an arrangement");
        let of = |dimension| found.regions.iter().filter(|r| r.dimension == dimension).count();
        let merged = found.arrangement.merged;
        assert!(
            merged <= found.circles.resolution().near()
                && (angle > 0.0 || merged < Resolution::FINEST.plane()),
            "{merged}"
        );
        [of(2), of(1), of(0)]
    };
    assert_eq!(counts(0.0), [4, 0, 2]);
    assert_eq!(counts(2e-7), [2, 1, 0]);
}

/// Each fixture with the twin that must say the opposite.
#[test]
fn twins_leave_and_stay() {
    let leaves = |name: &str, reach| found(name, reach).1.graphs.iter().any(|g| !g.leave.is_empty());
    for reach in [Reach::Infinitesimal, Reach::Finite] {
        for (free, kept) in
            [("dovetail-open", "dovetail-stopped"), ("burr", "burr-keyed"), ("sleeve", "sleeve-collared")]
        {
            assert!(leaves(free, reach), "{free} {reach:?}");
            assert!(!leaves(kept, reach), "{kept} {reach:?}");
        }
    }
    // A slide is a single direction: both ways along the dovetail's groove, and no other.
    let (_, slide) = found("dovetail-open", Reach::Finite);
    let free: Vec<_> = slide.regions.iter().filter(|r| !slide.graphs[r.graph].leave.is_empty()).collect();
    assert_eq!(free.len(), 2);
    assert!(
        free.iter().all(|r| r.dimension == 0 && r.d.distance(DVec3::Y * r.d.y.signum()) < 1e-12),
        "{free:?}"
    );
}

/// Three parts that only move in three directions at once: tied together along every direction, yet free.
#[test]
fn strongly_connected_everywhere_is_less_than_locked() {
    let (joined, swirl) = found("swirl", Reach::Infinitesimal);
    assert_eq!(swirl.connected(), swirl.graphs.len());
    let check = weavelock::locking::check(&joined.assembly, &joined.patches, None);
    assert_eq!(check.translation.word(), "free");
}

/// Id, whether directed, the data of each node, and the arcs.
type ReadGraph = (String, bool, Vec<Vec<String>>, Vec<[String; 2]>);

/// Nodes and edges of every graph in a GraphML file, as another program would read it.
fn read_graphml(bytes: &[u8]) -> Vec<ReadGraph> {
    let text = std::str::from_utf8(bytes).expect("UTF-8");
    let mut reader = quick_xml::Reader::from_str(text);
    let mut out: Vec<ReadGraph> = Vec::new();
    loop {
        match reader.read_event().expect("well-formed XML") {
            Event::Start(e) | Event::Empty(e) => {
                let get = |key: &str| {
                    let a = e.try_get_attribute(key).expect("attributes")?;
                    Some(quick_xml::escape::unescape(&a.value).expect("entities").into_owned())
                };
                let inside = e.name().as_ref().to_string();
                match inside.as_str() {
                    "graph" => out.push((
                        get("id").expect("id"),
                        get("edgedefault").as_deref() == Some("directed"),
                        vec![],
                        vec![],
                    )),
                    "node" => out.last_mut().expect("a graph").2.push(vec![get("id").expect("id")]),
                    "edge" => out
                        .last_mut()
                        .expect("a graph")
                        .3
                        .push([get("source").expect("source"), get("target").expect("target")]),
                    _ => {}
                }
            }
            Event::Eof => return out,
            _ => {}
        }
    }
}

/// Ids as DOT has them, unescaped.
fn dot_strings(line: &str) -> Vec<String> {
    let (mut out, mut now, mut open, mut chars) = (Vec::new(), String::new(), false, line.chars());
    while let Some(c) = chars.next() {
        match c {
            '\\' if open => now.extend(chars.next()),
            '"' if open => {
                out.push(std::mem::take(&mut now));
                open = false;
            }
            '"' => open = true,
            c if open => now.push(c),
            _ => {}
        }
    }
    assert!(!open, "an open string in {line}");
    out
}

#[test]
fn files_read_back_as_they_were_written() {
    let (joined, found) = found("burr", Reach::Finite);
    let source = crate::support::source("burr.toml", "");
    let all = Ok(found);
    let answer = answer::blocking(
        &joined,
        Found { reach: Reach::Finite, dbg: None, ndbg: Some(&all), not_run: None },
        source,
    );
    let mut made = graphs::graphs(&answer);
    // Names that both formats must escape.
    let node = |id: &str| Node { id: id.into(), attributes: Attributes::from([("label", id.to_string())]) };
    let odd = vec![node("a \"b\" \\ <c> & d"), node("Größe 'x'")];
    made.push(Graph { id: "odd".into(), directed: true, nodes: odd, edges: vec![(0, 1, vec![])] });
    let read = read_graphml(&graphs::graphml(&made).expect("XML"));
    assert_eq!(read.len(), made.len());
    for (graph, (id, directed, nodes, edges)) in made.iter().zip(&read) {
        assert_eq!((id, *directed), (&graph.id, graph.directed));
        let ids: Vec<Vec<String>> = graph.nodes.iter().map(|n| vec![n.id.clone()]).collect();
        assert_eq!(nodes, &ids);
        let ends: Vec<[String; 2]> =
            graph.edges.iter().map(|(i, j, _)| [*i, *j].map(|k| graph.nodes[k].id.clone())).collect();
        assert_eq!(edges, &ends);
    }
    let dot = graphs::dot(&made);
    let lines: Vec<&str> = dot.lines().collect();
    let count = |sign: &str| lines.iter().filter(|l| l.contains(sign)).count();
    assert_eq!(count("\" -- \""), made[0].edges.len());
    assert_eq!(count("\" -> \""), made[1..].iter().map(|g| g.edges.len()).sum::<usize>());
    assert_eq!(dot_strings(lines[lines.len() - 4])[0], "a \"b\" \\ <c> & d");
    assert_eq!(lines.iter().filter(|l| l.ends_with('{')).count(), made.len());
}

fn ran(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_weavelock")).args(args).output().expect("the program starts")
}

#[test]
fn the_verb_answers_and_writes() {
    let (file, _) = fixture("burr");
    let file = file.display().to_string();
    let room = Path::new(env!("CARGO_TARGET_TMPDIR")).join("blocking");
    std::fs::create_dir_all(&room).expect("a folder");
    let paths = ["b.dot", "b.graphml", "b.svg", "b.png"].map(|n| room.join(n).display().to_string());
    let out = ran(&[
        "blocking",
        &file,
        "--json",
        "--dot",
        &paths[0],
        "--graphml",
        &paths[1],
        "--sphere",
        &paths[2],
    ]);
    assert_eq!(out.status.code(), Some(0));
    let answer: serde_json::Value = serde_json::from_slice(&out.stdout).expect("JSON");
    assert_eq!(answer["strongly_connected"], "not-everywhere");
    let graphs = answer["ndbg"]["graphs"].as_array().expect("graphs").len();
    assert_eq!(graphs, 26, "each octant, edge and corner of the three planes has its own");
    assert_eq!(read_graphml(&std::fs::read(&paths[1]).expect("a file")).len(), graphs + 1);
    assert!(std::fs::read_to_string(&paths[2]).expect("a file").starts_with("<svg"));
    assert_eq!(ran(&["blocking", &file, "-q", "--sphere", &paths[3]]).status.code(), Some(0));
    assert!(std::fs::read(&paths[3]).expect("a file").starts_with(b"\x89PNG"));

    let one = ran(&["blocking", &file, "--json", "--finite", "--direction", "-2,0,0"]);
    let answer: serde_json::Value = serde_json::from_slice(&one.stdout).expect("JSON");
    assert_eq!(answer["dbg"]["direction"], serde_json::json!([-1.0, 0.0, 0.0]));
    assert_eq!(answer["dbg"]["leave"], serde_json::json!([["red", "blue", "green", "white"]]));
    assert!(answer.get("ndbg").is_none());
    for bad in ["0,0,0", "1,2", "x,0,0", "nan,0,1", "inf,0,0"] {
        assert_eq!(ran(&["blocking", &file, "--direction", bad]).status.code(), Some(2), "{bad}");
    }
    let nowhere = room.join("no/such/folder/b.dot").display().to_string();
    assert_eq!(ran(&["blocking", &file, "-q", "--dot", &nowhere]).status.code(), Some(2));
}
