//! Takes a verdict's witness as JSON (contact forces, or a motion); gives the arrows that show it, as one mesh.
//!
//! Not promised: all forces; only the largest are drawn, and the words say how many.

use crate::report::draw::figures::MOST_FORCES;
use crate::report::draw::mesh::CreaseAngle;
use crate::report::draw::{Mesh, glyph};
use crate::solid::Solid;
use glam::DVec3;
use serde_json::Value;

/// Arrows as one mesh in world coordinates, with what they mean.
pub struct Signs {
    pub name: &'static str,
    pub says: String,
    pub mesh: Mesh,
}

fn vector(v: &Value) -> Option<DVec3> {
    let n: Vec<f64> = v.as_array()?.iter().map(Value::as_f64).collect::<Option<_>>()?;
    <[f64; 3]>::try_from(n).ok().map(DVec3::from_array)
}

/// The largest contact forces of a self-stress; `size` is the assembly's longest side.
pub fn forces(certificate: &Value, size: f64) -> Option<Signs> {
    let read = |f: &Value| Some((vector(&f["point"])?, vector(&f["normal"])?, f["size"].as_f64()?));
    let mut all: Vec<_> = certificate["forces"].as_array()?.iter().filter_map(read).collect();
    let count = all.len();
    all.sort_by(|a, b| b.2.total_cmp(&a.2));
    all.truncate(MOST_FORCES);
    let most = all.first()?.2;
    let arrow = |(point, normal, force): &(DVec3, DVec3, f64)| {
        let length = size * FORCE_SIZE * (force / most).sqrt();
        glyph::arrow(*point - *normal * length, *point, size * FORCE_SIZE * FORCE_SHAFT)
    };
    let solids: Vec<Solid> = all.iter().filter_map(arrow).collect();
    let says = format!(
        "The {} largest of {count} contact forces in balance; an arrow's length goes with the root of its force.",
        all.len()
    );
    Some(Signs { name: "Contact forces", says, mesh: joined(&solids) })
}

/// Length of the largest force in longest sides of the assembly, and its shaft's radius in that length.
const FORCE_SIZE: f64 = 0.16;
const FORCE_SHAFT: f64 = 0.05;
/// Length of the fastest part's arrow in longest sides of the assembly.
const MOTION_SIZE: f64 = 0.3;

/// The motion that can start, an arrow (straight, bent, or both) on each part that moves.
pub fn motion(motion: &Value, size: f64) -> Option<Signs> {
    let read = |t: &Value| Some((vector(&t["centre"])?, vector(&t["translation"])?, vector(&t["rotation"])?));
    let all: Vec<_> = motion["twists"].as_array()?.iter().filter_map(read).collect();
    let most = size * MOTION_SIZE;
    let speed = |(_, go, turn): &(DVec3, DVec3, DVec3)| go.length().max(turn.length() * most / 2.0);
    let fastest = all.iter().map(speed).fold(0.0, f64::max);
    // What is slower than this share of the fastest would be a dot.
    let seen: Vec<_> = all.iter().filter(|t| speed(t) > fastest * SLOWEST_SHOWN).collect();
    let solids: Vec<Solid> =
        seen.iter().flat_map(|t| glyph::motion(t.0, t.1, t.2, most * speed(t) / fastest)).collect();
    let says = format!(
        "The motion that can start, on {} parts: straight arrows shift, bent arrows turn; velocities, not ways.",
        seen.len()
    );
    (!solids.is_empty()).then(|| Signs { name: "Motion that can start", says, mesh: joined(&solids) })
}

const SLOWEST_SHOWN: f64 = 0.02;

/// All of them as one mesh.
pub fn joined(solids: &[Solid]) -> Mesh {
    let mut whole = Solid::default();
    for s in solids {
        let first = whole.vertices.len() as u32;
        whole.vertices.extend(&s.vertices);
        whole.facets.extend(s.facets.iter().cloned().map(|mut f| {
            f.corners.iter_mut().for_each(|c| *c += first);
            f
        }));
    }
    Mesh::of(&whole, CreaseAngle::default())
}
