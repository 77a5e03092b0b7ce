//! Takes an assembly and the moves of a plan; gives a binary glTF 2.0 file: a named node for each part, shapes shared by
//! congruent parts, the plan as an animation named "take apart", one second to a step.
//!
//! Lengths in the file are metres and y is up, as the format demands; a root node turns and scales what is below it, so
//! the parts' own nodes are in model units about the assembly's middle with z up. Not promised: more than f32; screws
//! are sampled every `SCREW_STEP` radians and a viewer goes straight between.

use crate::assembly::Assembly;
use crate::report::draw::Mesh;
use crate::report::draw::mesh::CreaseAngle;
use crate::report::draw::palette::{Colour, bytes_of_part};
use crate::report::moves::{Motion, Move, displacements};
use glam::{DAffine3, DQuat, DVec3};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Turn between two samples of a screw, radians: 7.5 degrees, where a chord leaves the arc by a fiftieth of a percent of
/// twice the radius (1 - cos of half of it).
const SCREW_STEP: f64 = std::f64::consts::TAU / 48.0;

/// A file under construction: its buffer, and what describes it.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

// Component types and buffer targets as the specification numbers them.
const U32: u32 = 5125;
const F32: u32 = 5126;
const VERTICES: u32 = 34962;
const CORNERS: u32 = 34963;

impl File {
    fn add(&mut self, bytes: Vec<u8>, target: Option<u32>, accessor: Value) -> usize {
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend(bytes);
        self.views.push(view);
        let mut accessor = accessor;
        accessor["bufferView"] = json!(self.views.len() - 1);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Rows of `N` numbers each; with bounds where the format wants them.
    fn floats<const N: usize>(
        &mut self,
        rows: &[[f64; N]],
        kind: &str,
        target: Option<u32>,
        bounded: bool,
    ) -> usize {
        let narrow: Vec<[f32; N]> = rows.iter().map(|r| r.map(|x| x as f32)).collect();
        let bytes = narrow.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let mut accessor = json!({"componentType": F32, "count": rows.len(), "type": kind});
        if bounded {
            let edge = |pick: fn(f32, f32) -> f32, from: f32| {
                let of = |d: usize| narrow.iter().map(|r| r[d]).fold(from, pick);
                json!((0..N).map(of).collect::<Vec<f32>>())
            };
            accessor["min"] = edge(f32::min, f32::INFINITY);
            accessor["max"] = edge(f32::max, f32::NEG_INFINITY);
        }
        self.add(bytes, target, accessor)
    }

    fn corners(&mut self, corners: &[u32]) -> usize {
        let bytes = corners.iter().flat_map(|k| k.to_le_bytes()).collect();
        let accessor = json!({"componentType": U32, "count": corners.len(), "type": "SCALAR"});
        self.add(bytes, Some(CORNERS), accessor)
    }
}

/// The file's bytes.
pub fn glb(asm: &Assembly, moves: &[Move]) -> Vec<u8> {
    let mut file = File::default();
    let (lo, hi) = asm
        .ids()
        .flat_map(|p| asm.vertices(p))
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
    let middle = if lo.is_finite() { (lo + hi) / 2.0 } else { DVec3::ZERO };
    let shapes: Vec<Shaped> = asm.solids.iter().map(|s| shaped(&mut file, s)).collect();
    let (materials, colours) = materials(asm);
    let (meshes, mesh_of) = meshes(asm, &shapes, &colours);
    let rest: Vec<DAffine3> =
        asm.parts.iter().map(|p| node_pose(&p.pose, shapes[p.solid].centre, middle)).collect();
    let nodes = nodes(asm, &rest, &mesh_of, middle);
    let animation = animation(&mut file, moves, &rest, middle);
    let mut root = json!({
        "asset": {"version": "2.0", "generator": format!("weavelock {}", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"name": asm.name, "nodes": [0]}],
        "nodes": nodes,
        "meshes": meshes,
        "materials": materials,
        "buffers": [{"byteLength": file.bytes.len()}],
        "bufferViews": file.views,
        "accessors": file.accessors,
    });
    if let Some(animation) = animation {
        root["animations"] = json!([animation]);
    }
    packed(&root, file.bytes)
}

/// Header and the two chunks, each filled up to a multiple of four bytes.
fn packed(root: &Value, mut buffer: Vec<u8>) -> Vec<u8> {
    let mut text = root.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let total = 12 + 8 + text.len() + 8 + buffer.len();
    let word = |n: usize| (n as u32).to_le_bytes();
    let mut out = Vec::with_capacity(total);
    out.extend(b"glTF");
    out.extend(word(2));
    out.extend(word(total));
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &buffer)] {
        out.extend(word(chunk.len()));
        out.extend(kind);
        out.extend(chunk);
    }
    out
}

/// Accessors of a solid's mesh about its own centre.
struct Shaped {
    centre: DVec3,
    positions: usize,
    normals: usize,
    corners: usize,
}

fn shaped(file: &mut File, solid: &crate::solid::Solid) -> Shaped {
    let mesh = Mesh::of(solid, CreaseAngle::default());
    let centre = solid.centre();
    let mut index: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    let (mut positions, mut normals, mut corners) = (Vec::new(), Vec::new(), Vec::new());
    for t in &mesh.triangles {
        for (&v, &n) in t.corners.iter().zip(&t.normals) {
            let next = index.len() as u32;
            corners.push(*index.entry((v, n)).or_insert_with(|| {
                positions.push((mesh.vertices[v as usize] - centre).to_array());
                // A corner between opposite faces has no normal of its own; any unit vector keeps the file valid.
                normals.push(mesh.normals[n as usize].try_normalize().unwrap_or(DVec3::Z).to_array());
                next
            }));
        }
    }
    Shaped {
        centre,
        positions: file.floats(&positions, "VEC3", Some(VERTICES), true),
        normals: file.floats(&normals, "VEC3", Some(VERTICES), false),
        corners: file.corners(&corners),
    }
}

/// One material for each colour in use, and the material of each part.
fn materials(asm: &Assembly) -> (Vec<Value>, Vec<usize>) {
    let mut known: Vec<[u8; 3]> = Vec::new();
    let of: Vec<usize> = (asm.parts.iter().enumerate())
        .map(|(k, p)| {
            let colour = bytes_of_part(&p.id, k);
            known.iter().position(|c| *c == colour).unwrap_or_else(|| {
                known.push(colour);
                known.len() - 1
            })
        })
        .collect();
    let material = |c: &[u8; 3]| {
        let Colour([r, g, b]) = Colour::srgb(*c);
        json!({
            "name": format!("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]),
            "pbrMetallicRoughness": {"baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8},
        })
    };
    (known.iter().map(material).collect(), of)
}

/// A mesh for each shape in each of its colours, and the mesh of each part.
fn meshes(asm: &Assembly, shapes: &[Shaped], colours: &[usize]) -> (Vec<Value>, Vec<usize>) {
    let mut known: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut meshes = Vec::new();
    let of = asm.parts.iter().zip(colours).map(|(p, &colour)| {
        *known.entry((p.solid, colour)).or_insert_with(|| {
            let s = &shapes[p.solid];
            meshes.push(json!({
                "name": format!("shape-{}", p.solid + 1),
                "primitives": [{
                    "attributes": {"POSITION": s.positions, "NORMAL": s.normals},
                    "indices": s.corners, "material": colour,
                }],
            }));
            meshes.len() - 1
        })
    });
    let of = of.collect();
    (meshes, of)
}

/// Pose of a part's node: its mesh is about its own centre, the nodes about the middle of all.
fn node_pose(pose: &DAffine3, centre: DVec3, middle: DVec3) -> DAffine3 {
    DAffine3 { matrix3: pose.matrix3, translation: pose.transform_point3(centre) - middle }
}

fn turn(pose: &DAffine3) -> DQuat {
    DQuat::from_mat3(&pose.matrix3).normalize()
}

/// The root turns z up to y up and scales to metres; node `k + 1` is part `k`.
fn nodes(asm: &Assembly, rest: &[DAffine3], mesh_of: &[usize], middle: DVec3) -> Vec<Value> {
    let metres = asm.mm_per_unit / 1000.0;
    let up = DQuat::from_rotation_x(-std::f64::consts::FRAC_PI_2);
    let root = json!({
        "name": asm.name,
        "children": (1..=asm.parts.len()).collect::<Vec<_>>(),
        "translation": (up * middle * metres).to_array(),
        "rotation": up.to_array(),
        "scale": [metres, metres, metres],
    });
    let part = |(k, p): (usize, &crate::assembly::Part)| {
        json!({
            "name": p.id,
            "mesh": mesh_of[k],
            "translation": rest[k].translation.to_array(),
            "rotation": turn(&rest[k]).to_array(),
        })
    };
    std::iter::once(root).chain(asm.parts.iter().enumerate().map(part)).collect()
}

/// Seconds at which a part's node has a key: the ends of the steps in which it moves, and samples of its screws.
fn times(moves: &[Move], part: usize) -> Vec<f64> {
    let mut times = vec![0.0];
    for (k, step) in moves.iter().enumerate() {
        let Some(mover) = step.movers.iter().find(|m| m.parts.contains(&part)) else { continue };
        let count = match mover.motion {
            Motion::Translation { .. } => 1,
            Motion::Screw { angle, .. } => (angle.abs() / SCREW_STEP).ceil().max(1.0) as usize,
        };
        times.extend((0..=count).map(|s| k as f64 + s as f64 / count as f64));
    }
    times.push(moves.len() as f64);
    times.dedup();
    times
}

fn animation(file: &mut File, moves: &[Move], rest: &[DAffine3], middle: DVec3) -> Option<Value> {
    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    let about = |d: DAffine3| DAffine3::from_translation(-middle) * d * DAffine3::from_translation(middle);
    for (part, &placed) in rest.iter().enumerate() {
        let own: Vec<Move> = moves.iter().map(|m| only(m, part)).collect();
        let keys = times(moves, part);
        if keys.len() <= 2 && own.iter().all(|m| m.movers.is_empty()) {
            continue;
        }
        let poses: Vec<DAffine3> =
            keys.iter().map(|t| about(displacements(&own, 1, *t)[0]) * placed).collect();
        let input = file.floats(&keys.iter().map(|t| [*t]).collect::<Vec<_>>(), "SCALAR", None, true);
        let shifts: Vec<[f64; 3]> = poses.iter().map(|p| p.translation.to_array()).collect();
        let shifts = file.floats(&shifts, "VEC3", None, false);
        let turns = file.floats(&steady(poses.iter().map(turn)), "VEC4", None, false);
        for (path, output) in [("translation", shifts), ("rotation", turns)] {
            samplers.push(json!({"input": input, "output": output, "interpolation": "LINEAR"}));
            let target = json!({"node": part + 1, "path": path});
            channels.push(json!({"sampler": samplers.len() - 1, "target": target}));
        }
    }
    let name = "take apart";
    (!channels.is_empty()).then(|| json!({"name": name, "samplers": samplers, "channels": channels}))
}

/// A step as this part alone sees it, as part 0.
fn only(step: &Move, part: usize) -> Move {
    let movers = step.movers.iter().filter(|m| m.parts.contains(&part));
    let movers = movers.map(|m| crate::report::moves::Mover { parts: vec![0], motion: m.motion });
    Move { movers: movers.collect(), stays: Vec::new(), clear: None, inside: step.inside }
}

/// Of the two quaternions of each turn the one nearer to the one before, so that nothing spins on the way.
fn steady(turns: impl Iterator<Item = DQuat>) -> Vec<[f64; 4]> {
    let mut last: Option<DQuat> = None;
    turns
        .map(|q| {
            let q = if last.is_some_and(|l| l.dot(q) < 0.0) { -q } else { q };
            last = Some(q);
            q.to_array()
        })
        .collect()
}
