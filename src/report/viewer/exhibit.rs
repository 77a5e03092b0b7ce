//! Takes an assembly with the answers about it, or a mold in pieces; gives an exhibit: everything that the viewer shows.
//!
//! The plan, the forces and the motion are read from the answers' JSON, as anyone could. Not promised: a picture of what
//! an answer does not hold; what was not run is not there.

use super::colours::{Rgb, Scheme, schemes};
use super::pack::{self, Shape};
use super::signs::{self, Signs};
use crate::assembly::{Assembly, PartIx};
use crate::blocking::bounds;
use crate::blocking::graph::{infinitesimal, pairs};
use crate::contact::Joined;
use crate::report::draw::mesh::CreaseAngle;
use crate::report::draw::{Mesh, palette};
use crate::report::moves::{self, Move, Mover, Moves, Way};
use glam::{DAffine3, DVec3};
use serde::Serialize;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// Answers as JSON; `None`: not asked.
#[derive(Clone, Debug, Default)]
pub struct Answers {
    pub check: Option<Value>,
    pub plan: Option<Value>,
    /// The plan of the parts with the clearance that they are made with.
    pub plan_as_made: Option<Value>,
    pub flex: Option<Value>,
    pub chirality: Option<Value>,
}

/// What can be turned, cut, moved apart and taken apart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Exhibit {
    pub name: String,
    pub mm_per_unit: f64,
    /// World coordinates of the scene's origin.
    pub middle: DVec3,
    /// Of a ball about the origin that holds everything in place.
    pub radius: f64,
    pub shapes: Vec<Shape>,
    pub ids: Vec<String>,
    /// u32: the shape of each part.
    shape_of: String,
    /// f64: twelve to a part, columns.
    poses: String,
    pub schemes: Vec<Scheme>,
    pub plans: Vec<ShownPlan>,
    pub signs: Vec<ShownSigns>,
    /// u32: part, part that it touches, bits of the directions +x -x +y -y +z -z along which that one stops it.
    pub touch: Option<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShownPlan {
    pub name: String,
    /// What the plan comes to, in a sentence.
    pub says: String,
    pub steps: Vec<ShownStep>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShownStep {
    pub movers: Vec<Mover>,
    /// Parts that come onto the table at this step, and that go from it, against the step before (all are there first).
    pub on: Vec<usize>,
    pub off: Vec<usize>,
    pub apart: String,
    pub together: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ShownSigns {
    pub name: &'static str,
    pub says: String,
    pub colour: Rgb,
    pub shape: Shape,
    /// Inside the parts, which are drawn faint so that it is seen.
    pub inside: bool,
}

/// The assembly as it stands.
pub fn of_assembly(joined: &Joined, answers: &Answers) -> Exhibit {
    let asm = &joined.assembly;
    let meshes: Vec<Mesh> = asm.solids.iter().map(|s| Mesh::of(s, CreaseAngle::default())).collect();
    let things: Vec<Thing> =
        asm.parts.iter().map(|p| Thing { id: p.id.clone(), mesh: p.solid, pose: p.pose }).collect();
    let mut exhibit = placed(asm.name.clone(), asm.mm_per_unit, &meshes, &things);
    let longest = longest_side(&meshes, &things);
    exhibit.schemes = schemes(asm, answers);
    exhibit.plans = plans(asm, answers, exhibit.middle);
    exhibit.signs = witness(answers, longest).map(|s| shown(s, exhibit.middle)).into_iter().collect();
    exhibit.touch = touch(joined);
    exhibit
}

/// A piece of a mold: name, mesh in mm, the way it is pulled off (zero: it stays).
pub type MoldPiece = (String, Mesh, DVec3);

/// A mold that opens along its pull, all pieces at once; lengths in mm.
pub fn of_mold(name: &str, pieces: Vec<MoldPiece>) -> Exhibit {
    let (meshes, rest): (Vec<Mesh>, Vec<(String, DVec3)>) =
        pieces.into_iter().map(|(id, mesh, pull)| (mesh, (id, pull))).unzip();
    let thing =
        |(k, (id, _)): (usize, &(String, DVec3))| Thing { id: id.clone(), mesh: k, pose: DAffine3::IDENTITY };
    let things: Vec<Thing> = rest.iter().enumerate().map(thing).collect();
    let mut exhibit = placed(name.to_string(), 1.0, &meshes, &things);
    let colours: Vec<Rgb> = (0..things.len()).map(|k| palette::OTHER[k % palette::OTHER.len()]).collect();
    let legend = colours.iter().copied().zip(exhibit.ids.clone()).collect();
    exhibit.schemes = vec![Scheme { name: "part", legend, colours }];
    let pulls: Vec<DVec3> = rest.iter().map(|r| r.1).collect();
    exhibit.plans = vec![opening(&pulls, exhibit.radius, &exhibit.ids)];
    exhibit
}

fn opening(pulls: &[DVec3], radius: f64, ids: &[String]) -> ShownPlan {
    let moved = |(k, pull): (usize, &DVec3)| {
        let by = pull.try_normalize()? * radius;
        Some(Mover { parts: vec![k], motion: moves::Motion::Translation { by } })
    };
    let movers: Vec<Mover> = pulls.iter().enumerate().filter_map(moved).collect();
    if movers.is_empty() {
        let says = "The pieces as they are used; none is pulled off straight.".into();
        return ShownPlan { name: "Opening".into(), says, steps: vec![] };
    }
    let stays = (0..pulls.len()).filter(|k| pulls[*k] == DVec3::ZERO).collect();
    let one = Move { movers, stays, clear: None, inside: false };
    let all = Moves { moves: vec![one], unread: None };
    let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
    ShownPlan {
        name: "Opening".into(),
        says: "The pieces leave along their pull directions.".into(),
        steps: steps(&all, &ids, 1.0, DVec3::ZERO),
    }
}

/// One part to be shown: its id, its mesh among those given with it, where it is.
pub(super) struct Thing {
    pub id: String,
    pub mesh: usize,
    pub pose: DAffine3,
}

fn points<'a>(meshes: &'a [Mesh], things: &'a [Thing]) -> impl Iterator<Item = DVec3> + 'a {
    things.iter().flat_map(|t| meshes[t.mesh].vertices.iter().map(|v| t.pose.transform_point3(*v)))
}

fn longest_side(meshes: &[Mesh], things: &[Thing]) -> f64 {
    let (lo, hi) = bounds(points(meshes, things));
    Some((hi - lo).max_element()).filter(|s| s.is_finite() && *s > 0.0).unwrap_or(1.0)
}

pub(super) fn placed(name: String, mm_per_unit: f64, meshes: &[Mesh], things: &[Thing]) -> Exhibit {
    let (lo, hi) = bounds(points(meshes, things));
    let middle = if lo.is_finite() { (lo + hi) / 2.0 } else { DVec3::ZERO };
    let shapes: Vec<Shape> = meshes.iter().map(pack::shape).collect();
    let poses = things.iter().flat_map(|t| pack::pose(&t.pose, shapes[t.mesh].centre, middle));
    let radius = points(meshes, things).map(|p| (p - middle).length()).fold(0.0, f64::max);
    Exhibit {
        name,
        mm_per_unit,
        middle,
        radius: if radius > 0.0 { radius } else { 1.0 },
        ids: things.iter().map(|t| t.id.clone()).collect(),
        shape_of: pack::whole(things.iter().map(|t| t.mesh as u32)),
        poses: pack::doubles(poses),
        shapes,
        schemes: Vec::new(),
        plans: Vec::new(),
        signs: Vec::new(),
        touch: None,
    }
}

fn plans(asm: &Assembly, answers: &Answers, middle: DVec3) -> Vec<ShownPlan> {
    let ids: Vec<&str> = asm.parts.iter().map(|p| p.id.as_str()).collect();
    let shown = |name: String, plan: &Value| {
        let all = moves::read(&plan["steps"], &ids);
        let says = outcome(plan, all.unread.as_deref());
        ShownPlan { name, says, steps: steps(&all, &ids, asm.mm_per_unit, middle) }
    };
    let touching = answers.plan.as_ref().map(|p| {
        let air = p["clearance_mm"].as_f64().unwrap_or(0.0);
        shown(
            if air > 0.0 {
                format!("With {air} mm of air on each face")
            } else {
                "Parts as they touch".into()
            },
            p,
        )
    });
    let made = answers.plan_as_made.as_ref().map(|p| {
        let air = p["clearance_mm"].as_f64().unwrap_or(0.0);
        shown(format!("Parts as made, {air} mm of air on each face"), p)
    });
    let flex = answers.flex.as_ref().and_then(|f| f["orbits"].get(0)).map(|orbit| {
        let set = orbit["set"].as_array().into_iter().flatten().filter_map(Value::as_str);
        let set: Vec<&str> = set.collect();
        shown(format!("Without the flexible {}", set.join(", ")), &orbit["plan"])
    });
    // A plan without steps is kept only where it is the answer asked for: it says why there are none.
    let more = made.into_iter().chain(flex).filter(|p| !p.steps.is_empty());
    touching.into_iter().chain(more).collect()
}

fn outcome(plan: &Value, unread: Option<&str>) -> String {
    let steps = plan["steps"].as_array().map_or(0, Vec::len);
    let words = match plan["outcome"].as_str() {
        Some("assembled") => {
            format!("It goes together in {steps} rigid {}.", if steps == 1 { "move" } else { "moves" })
        }
        Some("needs-flexible") => "Not from rigid parts: something must bend.".into(),
        Some("not-found") => "No plan found, and none excluded.".into(),
        _ => "No outcome given.".into(),
    };
    unread.map_or(words.clone(), |why| format!("{words} {why}."))
}

fn steps(all: &Moves, ids: &[&str], mm_per_unit: f64, middle: DVec3) -> Vec<ShownStep> {
    let mut before: BTreeSet<usize> = (0..ids.len()).collect();
    let mut shown = Vec::new();
    for m in &all.moves {
        let now: BTreeSet<usize> = moves::on_table(m).collect();
        let movers = m.movers.iter().map(|v| Mover { motion: about(v.motion, middle), ..v.clone() });
        shown.push(ShownStep {
            movers: movers.collect(),
            on: now.difference(&before).copied().collect(),
            off: before.difference(&now).copied().collect(),
            apart: moves::told(m, ids, mm_per_unit, Way::Apart),
            together: moves::told(m, ids, mm_per_unit, Way::Together),
        });
        before = now;
    }
    shown
}

/// The motion in coordinates about the scene's origin.
fn about(motion: moves::Motion, middle: DVec3) -> moves::Motion {
    match motion {
        moves::Motion::Screw { point, axis, angle, advance } => {
            moves::Motion::Screw { point: point - middle, axis, angle, advance }
        }
        straight => straight,
    }
}

fn witness(answers: &Answers, longest: f64) -> Option<Signs> {
    let check = answers.check.as_ref()?;
    signs::forces(&check["certificate"], longest).or_else(|| signs::motion(&check["motion"], longest))
}

fn shown(signs: Signs, middle: DVec3) -> ShownSigns {
    let colour = if signs.name == "Contact forces" { palette::FORCE } else { palette::MOTION };
    let mut mesh = signs.mesh;
    mesh.vertices.iter_mut().for_each(|v| *v -= middle);
    ShownSigns { name: signs.name, says: signs.says, colour, shape: pack::shape(&mesh), inside: true }
}

/// More pairs that touch than this make the page heavy (12 bytes each, twice): the colouring is left out then.
const MOST_PAIRS: usize = 100_000;

/// Who touches whom, and along which of the six axis directions the one stops the very start of the other.
fn touch(joined: &Joined) -> Option<String> {
    let touching = pairs(&joined.patches);
    if touching.len() > MOST_PAIRS {
        return None;
    }
    let parts: Vec<PartIx> = joined.assembly.ids().collect();
    let mut bits: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for (a, b) in touching.keys() {
        bits.insert((a.0, b.0), 0);
        bits.insert((b.0, a.0), 0);
    }
    for (k, d) in AXES.iter().enumerate() {
        let graph = infinitesimal(&parts, &joined.patches, &touching, *d);
        for e in graph.edge_indices() {
            if let Some((i, j)) = graph.edge_endpoints(e) {
                *bits.entry((graph[i].0, graph[j].0)).or_default() |= 1 << k;
            }
        }
    }
    Some(pack::whole(bits.into_iter().flat_map(|((a, b), mask)| [a, b, mask])))
}

/// The directions of the bits, in order.
pub const AXES: [DVec3; 6] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
