//! Pictures and files for other programs, as a user asks for them; what is written is read back.

use crate::support;
use crate::support::{joined, ran, window};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use weavelock::assembly::mesh::{Reading, read_mesh};
use weavelock::assembly::{Assembly, PartIx};
use weavelock::report::draw::{Opacity, View, steps};
use weavelock::report::export::{self, glb, ply, step, tables};
use weavelock::report::moves;

/// A free swatch with a plan, small enough for many pictures.
pub const LOOSE: &str = "name = \"loose\"\n[weave]\nabc = [1, 1, 1]\n[profile]\nsamples = 2\n[swatch]\nwefts = 2\nwarps = 4\n\
                     cut = \"tiles\"\nrepeat = 1\n[size]\npitch = \"20 mm\"\n";

fn room(name: &str) -> PathBuf {
    let at = support::room("drawn", name);
    std::fs::write(at.join("loose.toml"), LOOSE).expect("a spec");
    at
}

fn told(at: &Path, verb: &str, more: &[&str]) -> (i32, String) {
    let spec = at.join("loose.toml").display().to_string();
    let args: Vec<&str> = [verb, &spec].into_iter().chain(more.iter().copied()).collect();
    let out = ran(&args);
    (out.status.code().expect("a code"), String::from_utf8_lossy(&out.stderr).into_owned())
}

fn file(at: &Path, name: &str) -> String {
    at.join(name).display().to_string()
}

/// Width and height of a PNG, from its first chunk.
fn size_of(png: &[u8]) -> (u32, u32) {
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
    let word = |k: usize| u32::from_be_bytes(png[k..k + 4].try_into().expect("four bytes"));
    (word(16), word(20))
}

#[test]
fn every_picture_is_drawn_in_both_kinds_the_same_with_any_threads() {
    let at = room("kinds");
    for what in ["tile", "assembly", "exploded", "witness", "step=2"] {
        let png = file(&at, "a.png");
        let (code, said) = told(&at, "draw", &["--what", what, "--size", "160x120", "--out", &png]);
        assert_eq!(code, 0, "{what}: {said}");
        let first = std::fs::read(&png).expect("a picture");
        assert_eq!(size_of(&first), (160, 120));
        told(&at, "draw", &["--what", what, "--size", "160x120", "--threads", "1", "--out", &png]);
        assert_eq!(first, std::fs::read(&png).expect("a picture"), "{what}");
        let svg = file(&at, "a.svg");
        let (code, said) =
            told(&at, "draw", &["--what", what, "--size", "160x120", "--view", "20,30", "--out", &svg]);
        assert_eq!(code, 0, "{what}: {said}");
        let text = std::fs::read_to_string(&svg).expect("a picture");
        let mut reader = quick_xml::Reader::from_str(&text);
        let mut paths = 0;
        loop {
            match reader.read_event().expect("well-formed") {
                quick_xml::events::Event::Eof => break,
                quick_xml::events::Event::Empty(e) if e.name().as_ref() == "path" => paths += 1,
                _ => {}
            }
        }
        assert!(paths > 0, "{what}: no line in the SVG");
    }
}

#[test]
fn what_cannot_be_drawn_is_said_and_nothing_is_written() {
    let at = room("faults");
    for (what, out, code, word) in [
        ("assembly", "a.pdf", 2, ".png"),
        ("instructions", "a.png", 2, ".html"),
        ("step=0", "a.png", 2, "from 1"),
        ("step=99", "a.png", 2, "steps"),
        ("cake", "a.png", 2, "tile"),
    ] {
        let path = file(&at, out);
        let (found, said) = told(&at, "draw", &["--what", what, "--out", &path]);
        assert_eq!(found, code, "{what}: {said}");
        assert!(said.contains(word), "{what}: {said}");
        assert!(!Path::new(&path).exists(), "{what}");
    }
    // A lock has no plan of rigid moves: answered, and nothing drawn.
    std::fs::write(at.join("loose.toml"), LOOSE.replace("\"tiles\"\nrepeat = 1", "\"window\""))
        .expect("a spec");
    let path = file(&at, "a.png");
    assert_eq!(told(&at, "draw", &["--what", "step=1", "--out", &path]).0, 1);
    assert!(!Path::new(&path).exists());
}

#[test]
fn instructions_have_a_panel_for_each_step() {
    let at = room("sheet");
    let spec = file(&at, "loose.toml");
    let plan = ran(&["plan", &spec, "--json"]).stdout;
    let steps =
        serde_json::from_slice::<Value>(&plan).expect("a plan")["steps"].as_array().expect("steps").len();
    assert!(steps > 1);
    std::fs::write(at.join("plan.json"), plan).expect("written");
    let (out, read) = (file(&at, "a.html"), file(&at, "plan.json"));
    let (code, said) = told(&at, "draw", &["--what", "instructions", "--plan", &read, "--out", &out]);
    assert_eq!(code, 0, "{said}");
    let html = std::fs::read_to_string(&out).expect("a page");
    assert_eq!(html.matches("<li>").count(), steps);
    assert!(!html.contains("<script") && html.contains("default-src"));
}

/// The JSON and the binary chunk of a glTF file, every rule of its container checked (glTF 2.0, section 4.4).
fn opened(bytes: &[u8]) -> (Value, &[u8]) {
    let word = |k: usize| u32::from_le_bytes(bytes[k..k + 4].try_into().expect("four bytes")) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (b"glTF".as_slice(), 2, bytes.len()));
    let json = word(12);
    assert_eq!((&bytes[16..20], json % 4), (b"JSON".as_slice(), 0));
    let at = 20 + json;
    assert_eq!((&bytes[at + 4..at + 8], word(at) % 4), (b"BIN\0".as_slice(), 0));
    assert_eq!(at + 8 + word(at), bytes.len());
    (serde_json::from_slice(&bytes[20..at]).expect("JSON"), &bytes[at + 8..])
}

/// The numbers of an accessor of floats, rows one after the other; bounds are checked where they are stated.
fn numbers(root: &Value, buffer: &[u8], accessor: usize) -> Vec<f32> {
    let a = &root["accessors"][accessor];
    assert_eq!(a["componentType"], json!(5126));
    let width = match a["type"].as_str() {
        Some("SCALAR") => 1,
        Some("VEC3") => 3,
        _ => 4,
    };
    let view = &root["bufferViews"][a["bufferView"].as_u64().expect("a view") as usize];
    let (from, length) = (
        view["byteOffset"].as_u64().expect("a place") as usize,
        view["byteLength"].as_u64().expect("a length") as usize,
    );
    assert!(from % 4 == 0 && from + length <= buffer.len());
    assert_eq!(length, 4 * width * a["count"].as_u64().expect("a count") as usize);
    let read: Vec<f32> = buffer[from..from + length]
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes(b.try_into().expect("four")))
        .collect();
    for (name, pick) in [("min", f32::min as fn(f32, f32) -> f32), ("max", f32::max)] {
        if let Some(bound) = a[name].as_array() {
            assert_eq!(bound.len(), width);
            for (d, stated) in bound.iter().enumerate() {
                let found = read.iter().skip(d).step_by(width).copied().reduce(pick).expect("a row");
                assert_eq!(stated.as_f64().map(|x| x as f32), Some(found), "{name}");
            }
        }
    }
    assert!(read.iter().all(|x| x.is_finite()));
    read
}

fn swatch() -> Assembly {
    joined(&window([1, 1, 1], 4, 2, 2)).assembly
}

/// Two straight moves, a screw, two motions at once.
fn plan(asm: &Assembly) -> moves::Moves {
    let ids: Vec<&str> = asm.parts.iter().map(|p| p.id.as_str()).collect();
    let steps = json!([
        {"parts": [ids[0]], "kind": "translation", "direction": [0.0, 0.6, 0.8], "distance": 2.0, "stays": &ids[1..]},
        {"parts": [ids[1]], "kind": "screw", "point": [1.0, 0.5, 0.0], "axis": [0.0, 0.0, 1.0], "angle": 4.0, "advance": 1.0, "ends": "inside", "stays": &ids[2..]},
        {"parts": &ids[1..3], "kind": "several", "stays": &ids[3..], "motions": [
            {"parts": [ids[1]], "kind": "translation", "direction": [1.0, 0.0, 0.0], "distance": 1.5},
            {"parts": [ids[2]], "kind": "screw", "point": [0.0, 0.0, 0.0], "axis": [1.0, 0.0, 0.0], "angle": -0.5, "advance": 0.0}]},
    ]);
    let read = moves::read(&steps, &ids);
    assert_eq!((read.moves.len(), read.unread.clone()), (3, None));
    read
}

/// Round-off of f32 on lengths of a few units, through a quaternion.
const NARROW: f64 = 1e-5;

#[test]
fn a_glb_has_a_named_node_for_each_part_and_ends_where_the_plan_ends() {
    let asm = swatch();
    let all = plan(&asm);
    let bytes = glb::glb(&asm, &all.moves);
    let (root, buffer) = opened(&bytes);
    assert_eq!(root["asset"]["version"], json!("2.0"));
    let nodes = root["nodes"].as_array().expect("nodes");
    for (k, part) in asm.parts.iter().enumerate() {
        assert_eq!(nodes[k + 1]["name"], json!(part.id));
        let mesh = &root["meshes"][nodes[k + 1]["mesh"].as_u64().expect("a mesh") as usize];
        let place = mesh["primitives"][0]["attributes"]["POSITION"].as_u64().expect("positions") as usize;
        assert!(!numbers(&root, buffer, place).is_empty());
    }
    let ends = moves::displacements(&all.moves, asm.parts.len(), 3.0);
    let animation = &root["animations"][0];
    for channel in animation["channels"].as_array().expect("channels") {
        let sampler = &animation["samplers"][channel["sampler"].as_u64().expect("a sampler") as usize];
        let of = |name: &str| numbers(&root, buffer, sampler[name].as_u64().expect("an accessor") as usize);
        let times = of("input");
        assert!(times.windows(2).all(|w| w[0] < w[1]) && times[0] == 0.0 && times.last() == Some(&3.0));
        if channel["target"]["path"] == json!("translation") {
            let part = channel["target"]["node"].as_u64().expect("a node") as usize - 1;
            let rows = of("output");
            assert_eq!(rows.len(), times.len() * 3);
            // From first to last, the middle of the part goes as the plan says.
            let centre = asm.centre(PartIx(part as u32));
            let meant = ends[part].transform_point3(centre) - centre;
            let last = rows.len() - 3;
            let gone = |d: usize| f64::from(rows[last + d]) - f64::from(rows[d]);
            let off = (0..3).map(|d| (gone(d) - meant[d]).abs()).fold(0.0, f64::max);
            assert!(off < NARROW, "{}: {off}", asm.parts[part].id);
        }
    }
    assert_eq!(animation["channels"].as_array().expect("channels").len(), 6);
    assert!(opened(&glb::glb(&asm, &[])).0["animations"].is_null());
}

#[test]
fn meshes_come_back_as_they_were_written() {
    let asm = swatch();
    let all: Vec<PartIx> = asm.ids().collect();
    let volume: f64 = all.iter().map(|&p| asm.solid(p).volume() * asm.mm_per_unit.powi(3)).sum();
    let near = |found: f64, what: &str| {
        assert!((found / volume - 1.0).abs() < NARROW, "{what}: {found} for {volume}")
    };
    let text = String::from_utf8(export::obj(&asm, &all)).expect("text");
    assert_eq!(text.lines().filter(|l| l.starts_with("g ")).count(), 4);
    // Polygons are read by the reader of assemblies, a file for each part.
    let at = room("read");
    let read_obj = |p: &PartIx| {
        let path = at.join(format!("{}.obj", p.0));
        std::fs::write(&path, export::obj(&asm, &[*p])).expect("written");
        read_mesh(&path, Reading { mm_per_unit: 1.0, tolerance: 0.001 }).expect("an OBJ").solid.volume()
    };
    near(all.iter().map(read_obj).sum(), "OBJ");
    let stl = export::stl(&asm, &all);
    near(weavelock_fab::files::stl::read(&mut std::io::Cursor::new(stl)).expect("an STL").volume(), "STL");
    let read = weavelock_fab::threemf::read(&export::threemf(&asm, &all).expect("3MF")).expect("3MF");
    assert_eq!(read.len(), 4);
    near(read.iter().map(|m| m.volume()).sum(), "3MF");
    let bytes = export::ply(&asm, &all);
    let back = ply::read(&bytes).expect("a PLY");
    assert_eq!(back.parts, asm.parts.iter().map(|p| p.id.clone()).collect::<Vec<_>>());
    assert_eq!(back.faces.len(), asm.parts.iter().map(|p| asm.solids[p.solid].facets.len()).sum::<usize>());
    assert_eq!(ply::write(&back), bytes);
    assert!(ply::read(&bytes[..bytes.len() - 1]).is_err());
}

/// Names of entities as the schema spells them, of those that are written.
const ENTITIES: [&str; 23] = [
    "CARTESIAN_POINT",
    "DIRECTION",
    "AXIS2_PLACEMENT_3D",
    "VERTEX_POINT",
    "VECTOR",
    "LINE",
    "EDGE_CURVE",
    "ORIENTED_EDGE",
    "EDGE_LOOP",
    "FACE_OUTER_BOUND",
    "PLANE",
    "ADVANCED_FACE",
    "CLOSED_SHELL",
    "MANIFOLD_SOLID_BREP",
    "UNCERTAINTY_MEASURE_WITH_UNIT",
    "ADVANCED_BREP_SHAPE_REPRESENTATION",
    "APPLICATION_CONTEXT",
    "APPLICATION_PROTOCOL_DEFINITION",
    "PRODUCT_CONTEXT",
    "PRODUCT",
    "PRODUCT_DEFINITION_FORMATION",
    "PRODUCT_DEFINITION_CONTEXT",
    "PRODUCT_DEFINITION",
];

/// Every entity named is there, each edge is run once each way, and the corners are the parts' own.
#[test]
fn a_step_file_has_a_closed_solid_for_each_part() {
    let mut asm = swatch();
    let all: Vec<PartIx> = asm.ids().collect();
    let text = String::from_utf8(step::step(&asm, &all).expect("closed")).expect("text");
    let entities: std::collections::BTreeMap<&str, &str> =
        text.lines().filter(|l| l.starts_with('#')).filter_map(|l| l.split_once('=')).collect();
    let others = ["PRODUCT_DEFINITION_SHAPE", "SHAPE_DEFINITION_REPRESENTATION", ""];
    for body in entities.values() {
        let kind = body.split('(').next().expect("a name");
        assert!(ENTITIES.contains(&kind) || others.contains(&kind), "{kind}");
        let named =
            body.split('#').skip(1).map(|r| r.split(|c: char| !c.is_ascii_digit()).next().expect("digits"));
        named.for_each(|n| assert!(entities.contains_key(format!("#{n}").as_str()), "#{n} in {body}"));
    }
    let of = |kind: &str| entities.values().filter(|b| b.starts_with(kind)).copied().collect::<Vec<_>>();
    let facets: usize = asm.parts.iter().map(|p| asm.solids[p.solid].facets.len()).sum();
    let vertices: usize = asm.parts.iter().map(|p| asm.solids[p.solid].vertices.len()).sum();
    assert_eq!(of("MANIFOLD_SOLID_BREP('weft-").len() + of("MANIFOLD_SOLID_BREP('warp-").len(), 4);
    assert_eq!((of("ADVANCED_FACE").len(), of("VERTEX_POINT").len()), (facets, vertices));
    let runs = of("ORIENTED_EDGE");
    assert_eq!(runs.len(), 2 * of("EDGE_CURVE").len());
    assert_eq!(runs.iter().filter(|r| r.ends_with(".T.);")).count() * 2, runs.len());
    asm.solids[0].facets.pop();
    let refused = step::step(&asm, &all).expect_err("open");
    assert!(asm.parts.iter().any(|p| p.id == refused.part));
}

#[test]
fn tables_have_a_row_for_each_part_contact_and_motion() {
    let joined = joined(&window([1, 1, 1], 4, 2, 2));
    let asm = &joined.assembly;
    let ids: Vec<&str> = asm.parts.iter().map(|p| p.id.as_str()).collect();
    let rows = |text: &str| text.split_terminator("\r\n").map(|l| l.split(',').count()).collect::<Vec<_>>();
    assert_eq!(rows(&tables::parts(&joined)), vec![10; 5]);
    let pairs: std::collections::BTreeSet<_> =
        joined.patches.iter().map(|p| (p.a.min(p.b), p.a.max(p.b))).collect();
    assert_eq!(rows(&tables::contacts(&joined)), vec![4; pairs.len() + 1]);
    assert_eq!(rows(&tables::steps(&plan(asm).moves, &ids, 20.0)), vec![11; 5]);
    assert_eq!(tables::csv(&["a"], &[vec!["x,\"y\"".into()]]), "a\r\n\"x,\"\"y\"\"\"\r\n");
}

#[test]
fn export_writes_what_the_ending_says() {
    let at = room("export");
    for name in ["a.glb", "a.3mf", "a.ply", "a.obj", "a.stl", "a.step", "a.wif"] {
        let (code, said) = told(&at, "export", &["--still", "--out", &file(&at, name)]);
        assert_eq!(code, 0, "{name}: {said}");
        assert!(at.join(name).is_file(), "{name}");
    }
    // The draft comes back from the WIF file.
    let draft = |subject: &str| {
        let out = ran(&["weave", subject, "--json"]);
        serde_json::from_slice::<Value>(&out.stdout).expect("an answer")["draft"].clone()
    };
    assert_eq!(draft(&file(&at, "a.wif")), draft(&file(&at, "loose.toml")));
    let (code, _) = told(&at, "export", &["--as", "csv", "--out", &file(&at, "tables")]);
    assert_eq!(code, 0);
    for name in ["parts", "contacts", "steps"] {
        assert!(at.join("tables").join(format!("{name}.csv")).is_file(), "{name}");
    }
    let (code, _) = told(&at, "export", &["--as", "obj", "--out", &file(&at, "parts")]);
    assert_eq!((code, std::fs::read_dir(at.join("parts")).expect("a folder").count()), (0, 8));
}

/// The class of each facet is seen, named and summed on the page: in 3D, as a picture and in a table.
#[test]
fn a_page_with_a_mold_has_its_map_of_draft_and_undercut() {
    let at = room("draft-map");
    let (_, said) = told(&at, "report", &["--mold", "weft-0/0", "--out", &file(&at, "page.html"), "--quiet"]);
    let html = std::fs::read_to_string(at.join("page.html")).unwrap_or_else(|e| panic!("{e}: {said}"));
    let start = html.find("id=\"viewer-data\">").expect("data") + "id=\"viewer-data\">".len();
    let end = start + html[start..].find("</script>").expect("an end");
    let data: Value = serde_json::from_str(&html[start..end]).expect("JSON");
    let map = &data["exhibits"][2];
    assert_eq!(map["name"], json!("draft and undercut of weft-0/0"));
    let legend = map["schemes"][0]["legend"].as_array().expect("a legend");
    assert_eq!(legend.len(), 4);
    // "draft over 10°: 12.3 mm² (45.6 %)": the shares of all classes make the whole surface.
    let share = |l: &Value| {
        let words = l[1].as_str().expect("words");
        let from = words.rfind('(').expect("a share") + 1;
        words[from..].trim_end_matches(" %)").parse::<f64>().expect("a number")
    };
    let all: f64 = legend.iter().map(share).sum();
    // Each of four is rounded to a tenth.
    assert!((all - 100.0).abs() <= 0.2 + 1e-9, "{all} %");
    let count = |k: usize| {
        data["exhibits"][k]["shapes"]
            .as_array()
            .into_iter()
            .flatten()
            .map(|s| s["triangles"].as_u64().expect("a count"))
            .collect::<Vec<_>>()
    };
    // Every facet of the part as it lies in the mold is in one class.
    assert_eq!(count(2).iter().sum::<u64>(), count(1)[0]);
    assert!(html.contains("Draft and undercut") && html.contains("% of the surface"));
}

/// A knob in its case: where it moves, the case is seen through; where the case moves, nothing is.
#[test]
fn what_hides_a_mover_is_seen_through() {
    let parts = crate::support::root().join("fixtures/assemblies/parts");
    let part = |name: &str| format!("[[part]]\nmesh = {:?}\n", parts.join(name).display().to_string());
    let joined = joined(&format!("{}held = true\n{}", part("case.obj"), part("knob.obj")));
    let ids: Vec<&str> = joined.assembly.parts.iter().map(|p| p.id.as_str()).collect();
    let faint = |mover: &str, stays: &str, by: f64| {
        let step = json!([{"parts": [mover], "kind": "translation", "direction": [0.0, 0.0, 1.0], "distance": by, "distance_mm": by, "clear": 0.0, "ends": "inside", "stays": [stays]}]);
        let read = moves::read(&step, &ids);
        let figure = steps::step(&joined.assembly, &read.moves, 1, View::default()).expect("a step");
        figure.scene.items[..2].iter().map(|i| matches!(i.opacity, Opacity::Ghost { .. })).collect::<Vec<_>>()
    };
    assert_eq!(faint("knob", "case", 0.1), [true, false]);
    assert_eq!(faint("case", "knob", 20.0), [false, false]);
}
