//! Takes an assembly of closed meshes, gives its contact patches; parts that overlap are refused.
//!
//! Promised: every patch is really there within the tolerance, and its rows are necessary conditions on
//! first-order motion. Not promised: contacts without a unique normal get no row (the safe side for *locked*,
//! not for *free*); they are listed as assumed.

mod cone;
mod direction;
mod flush;
mod known;
mod local;
mod overlap;
mod polygon;
mod shape;
mod touch;

pub use direction::Assumption;
pub use known::Accuracy;
pub use touch::Why;

use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use direction::{Direction, settled};
use flush::Facing;
use glam::DVec3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use rayon::prelude::*;
use shape::Shape;
use touch::{Passed, Touch};

/// What is known of a patch beside its polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facts {
    pub kind: Kind,
    /// No more than this lies between the two surfaces over the patch, in model units.
    pub gap: f64,
    /// Angle between the two surfaces, in radians: measured for faces, a bound for edges, nothing to measure
    /// for points.
    pub tilt: f64,
    /// By how much the normal may be off as far as the files tell, in radians.
    pub known: f64,
}

/// What touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Face on face: three corners or more.
    Face,
    /// An edge along a face or in a groove: two corners.
    Edge,
    /// A vertex, or two edges that cross: one corner.
    Point,
}

/// A place where two parts touch without a normal that could be vouched for: it got no row. That is the safe
/// side for *locked*; a *free* verdict may owe something to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Assumed {
    pub a: PartIx,
    pub b: PartIx,
    /// One point, or the two ends of a stretch, in the assembly's frame.
    pub corners: Vec<DVec3>,
    pub why: Why,
    /// The planes between two convex corners: their normals from `a` to `b` are combinations of these. None where
    /// they are not known.
    pub normals: Vec<DVec3>,
}

/// The contacts of an assembly of meshes; `facts` runs parallel to `patches`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshContacts {
    pub patches: Vec<Patch>,
    pub facts: Vec<Facts>,
    pub assumed: Vec<Assumed>,
    /// For each patch by how much its corners may be off as far as the files tell, in model units.
    pub off: Vec<f64>,
    /// What was made one because it could not be told apart.
    pub settled: Assumption,
}

/// Two parts that share space.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("parts `{a_id}` and `{b_id}` overlap by at least {depth} at [{}, {}, {}]", at.x, at.y, at.z)]
pub struct Overlap {
    pub a: PartIx,
    pub b: PartIx,
    pub a_id: String,
    pub b_id: String,
    /// How far a point of one was found below the surface of the other, or the diameter of a ball found in
    /// both: a lower bound, in model units.
    pub depth: f64,
    pub at: DVec3,
}

/// All pairs of parts that overlap by more than the tolerance; never empty.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", .0.iter().map(Overlap::to_string).collect::<Vec<_>>().join("\n"))]
pub struct ContactFaults(pub Vec<Overlap>);

/// Finds where parts touch. `tolerance` in model units; larger than zero. `accuracy` says for each part how well it
/// is known; a part that it does not reach is taken as exact.
///
/// # Errors
/// All pairs that overlap by more than the tolerance.
pub fn mesh_patches(
    assembly: &Assembly,
    accuracy: &[Accuracy],
    tolerance: f64,
) -> Result<MeshContacts, ContactFaults> {
    let origin = middle(assembly);
    let normals = known::normals(assembly, accuracy, tolerance);
    let shapes: Vec<Shape> =
        assembly.ids().map(|p| Shape::new(assembly, p, origin, &normals.of[p.at()])).collect();
    let pairs = near_pairs(&shapes, tolerance);
    let found: Vec<Result<MeshContacts, Overlap>> = pairs
        .par_iter()
        .map(|&(i, j)| match overlap::overlap(&shapes[i], &shapes[j], tolerance) {
            Some(d) => Err(fault(assembly, &shapes[i], &shapes[j], d, origin)),
            None => Ok(touching(&shapes[i], &shapes[j], origin, tolerance)),
        })
        .collect();
    let (good, bad): (Vec<_>, Vec<_>) = found.into_iter().partition(Result::is_ok);
    let faults: Vec<Overlap> = bad.into_iter().filter_map(Result::err).collect();
    if !faults.is_empty() {
        return Err(ContactFaults(faults));
    }
    let all = good.into_iter().flatten().fold(MeshContacts::default(), |mut all, c| {
        all.patches.extend(c.patches);
        all.facts.extend(c.facts);
        all.assumed.extend(c.assumed);
        all
    });
    let mut all = with_settled_normals(all, tolerance);
    all.settled.turn = all.settled.turn.max(normals.turned);
    all.off = all.patches.iter().map(|p| normals.off[p.a.at()] + normals.off[p.b.at()]).collect();
    Ok(all)
}

/// The contacts with normals made one that cannot be told apart, and corners moved into the planes of theirs.
fn with_settled_normals(mut all: MeshContacts, tolerance: f64) -> MeshContacts {
    let given = all.patches.iter().zip(&all.facts).map(|(p, f)| {
        // No corner moves by more than twice the tolerance.
        Direction { n: p.normal, known: f.known.min(tolerance / radius(&p.corners)) }
    });
    let (normals, assumption) = settled(&given.collect::<Vec<_>>());
    for (patch, d) in all.patches.iter_mut().zip(normals) {
        if d.n != patch.normal {
            let middle = patch.corners.iter().sum::<DVec3>() / patch.corners.len() as f64;
            patch.corners.iter_mut().for_each(|p| *p -= (*p - middle).dot(d.n) * d.n);
            patch.normal = d.n;
        }
    }
    all.settled = assumption;
    all
}

/// From the middle of the corners to the farthest.
fn radius(corners: &[DVec3]) -> f64 {
    let middle = corners.iter().sum::<DVec3>() / corners.len() as f64;
    corners.iter().map(|p| p.distance(middle)).fold(0.0, f64::max)
}

/// Middle of the assembly's box: coordinates about it are as small as they can be.
fn middle(assembly: &Assembly) -> DVec3 {
    let all = assembly.ids().flat_map(|p| assembly.vertices(p));
    let bounds = shape::around(all);
    if bounds.mins.is_finite() { bounds.center() } else { DVec3::ZERO }
}

/// Pairs whose boxes come within the tolerance, in order.
fn near_pairs(shapes: &[Shape], tolerance: f64) -> Vec<(usize, usize)> {
    let boxes: Vec<Aabb> = shapes.iter().map(|s| s.bounds.loosened(tolerance)).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
    let mut pairs: Vec<(usize, usize)> = boxes
        .iter()
        .enumerate()
        .flat_map(|(i, b)| tree.intersect_aabb(b).map(move |j| (i, j as usize)).collect::<Vec<_>>())
        .filter(|&(i, j)| i < j)
        .collect();
    pairs.sort_unstable();
    pairs
}

fn fault(assembly: &Assembly, a: &Shape, b: &Shape, d: overlap::Depth, origin: DVec3) -> Overlap {
    let id = |s: &Shape| assembly.part(s.part).id.clone();
    Overlap { a: a.part, b: b.part, a_id: id(a), b_id: id(b), depth: d.depth, at: d.at + origin }
}

fn touching(a: &Shape, b: &Shape, origin: DVec3, tolerance: f64) -> MeshContacts {
    let faces = flush::regions(a, b, Facing::Opposed, tolerance);
    let small = touch::touches(a, b, &faces, tolerance);
    let back = |corners: &[DVec3]| corners.iter().map(|&p| p + origin).collect::<Vec<_>>();
    let patch =
        |normal: DVec3, corners: &[DVec3]| Patch { a: a.part, b: b.part, normal, corners: back(corners) };
    let flat = faces.iter().map(|f| {
        (patch(f.normal, &f.corners), Facts { kind: Kind::Face, gap: f.gap, tilt: f.tilt, known: f.known })
    });
    let rest = small.rows.iter().map(|t| (patch(t.normal, &t.corners), small_facts(t, tolerance)));
    let (patches, facts) = flat.chain(rest).unzip();
    let assumed = |q: &Passed| {
        let (corners, normals) = (back(&q.corners), q.normals.clone());
        Assumed { a: a.part, b: b.part, corners, why: q.why, normals }
    };
    let assumed = small.passed.iter().map(assumed).collect();
    MeshContacts { patches, facts, assumed, off: Vec::new(), settled: Assumption::default() }
}

/// An edge that stays within the tolerance of a face over a stretch may lean by that over its length.
fn small_facts(t: &Touch, gap: f64) -> Facts {
    let known = t.known;
    match t.corners[..] {
        [p, q] => Facts { kind: Kind::Edge, gap, tilt: (gap / p.distance(q)).atan(), known },
        _ => Facts { kind: Kind::Point, gap, tilt: 0.0, known },
    }
}
