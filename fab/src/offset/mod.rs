//! Takes shapes in place, which facets are contact, and a depth; gives meshes with those facets moved inward.
//!
//! Sound: every triangle of a facet lies at least the depth below that facet's plane, and never above the plane of a
//! kept one. First order: where facets bend by an angle t it lies up to about depth * t * t / 2 deeper. Not complete:
//! shapes exist that it can not offset; it then says where, and the caller writes nothing.
//!
//! Where the whole of it fails, `carve` is the fallback of the caller.
//!
//! The steps: `body` moves corners, `weld` takes out edges too short to matter, `split` parts corners that have no one
//! place, `settle` collapses what turned over, `relief` parts bodies that are still nearer than the fit.
//!
//! Designs that lost. *Planes intersected anew* (each corner where its three planes meet): at four or more facets the
//! planes miss each other, and short edges turn over. *Uniting coplanar facets first*: not needed, equal planes bind a
//! corner like one plane, and it would give polygons with holes. *Collapsing only what turned over, keeping the planes
//! of vanished facets*: facets of a micrometre point anywhere, and their planes pushed corners by up to 6.5 mm.
//! *Choosing the collapse that leaves the fewest turned triangles*: it likes long edges, and lost whole ridges.

pub mod body;
pub mod carve;
pub mod least;
pub mod relief;
pub mod settle;
pub mod split;
pub mod weld;

use crate::mesh::Mesh;
use crate::shape::{Job, Role, Shape};
use body::Body;
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use settle::Settled;
use std::collections::{BTreeMap, BTreeSet};

/// What the move of a part is to reach, all in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// How far contact facets go inward.
    pub depth: f64,
    /// The part's share of the fit: bodies nearer than the sum of theirs are parted to the sum of their depths; a
    /// little less than those, or round-off would be chased.
    pub share: f64,
    /// Least altitude of a triangle of the result.
    pub thinnest: f64,
    /// Edges shorter than this are united before the move.
    pub weld: f64,
}

/// A part with its contact facets moved inward, in place.
#[derive(Clone, Debug)]
pub struct Offset {
    pub mesh: Mesh,
    pub collapses: usize,
    /// The longest way that a corner went, in mm.
    pub longest_move: f64,
    /// The first part of the job with the same solid, up to its pose; itself where there is none before it.
    pub same_as: usize,
    /// Places where the move failed; empty for a usable mesh.
    pub failures: Vec<Failure>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    pub at: DVec3,
    pub why: Why,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// No point lies deep enough under all facets that meet here: they face each other.
    NoRoom,
    /// A triangle stays turned over.
    TurnedOver,
    /// Nothing is left of the solid.
    Vanished,
    /// More went than a layer below its contact facets: collapses took a piece of it away.
    Lost,
}

/// Edges shorter than this part of the depth are united before the move: for 0.2 mm that is 4 micrometres, a tenth of
/// the finest step that the printers at hand can make. What it costs in clearance, `relief` finds and mends.
pub const REACH: f64 = 0.02;

/// Moves the contact facets of every part inward and parts the bodies to their fits. Parts with the same shape, contact
/// facets and aim are moved once, and stay the same solid: what one of them has to give way by, all of them do, so that any
/// of them fits in the place of any other. Where that fails, each of them is parted alone.
pub fn offset(job: &Job, aims: &[Aim]) -> Vec<Offset> {
    let key = |p: usize| {
        let contact: Vec<bool> = job.parts[p].roles.iter().map(|r| *r != Role::Outer).collect();
        (job.parts[p].shape, contact, [aims[p].depth, aims[p].weld].map(f64::to_bits))
    };
    let mut first: BTreeMap<_, usize> = BTreeMap::new();
    let kinds: Vec<usize> = (0..job.parts.len()).map(|p| *first.entry(key(p)).or_insert(p)).collect();
    let moved: BTreeMap<usize, (Body, Settled)> =
        first.par_iter().map(|((s, c, _), &p)| (p, moved_body(job, *s, c, &aims[p]))).collect();
    let (together, relieved) = parted((job, aims), &moved, &kinds, &kinds);
    let spoilt = |p: &usize| relieved.contains(&kinds[*p]) && !together[*p].failures.is_empty();
    let failed: BTreeSet<usize> = (0..kinds.len()).filter(spoilt).map(|p| kinds[p]).collect();
    let alone = |p: usize| if failed.contains(&kinds[p]) { p } else { kinds[p] };
    let groups: Vec<usize> = (0..kinds.len()).map(alone).collect();
    if groups == kinds { together } else { parted((job, aims), &moved, &kinds, &groups).0 }
}

/// The moved bodies parted to their fits, parts of a group, named by its first, as one; and the groups that had to give way.
fn parted(
    (job, aims): (&Job, &[Aim]),
    moved: &BTreeMap<usize, (Body, Settled)>,
    kinds: &[usize],
    groups: &[usize],
) -> (Vec<Offset>, BTreeSet<usize>) {
    let mut bodies: BTreeMap<usize, Body> = groups.iter().map(|&g| (g, moved[&kinds[g]].0.clone())).collect();
    let poses: Vec<DAffine3> = job.parts.iter().map(|p| p.pose).collect();
    let relieved = relief::relieve(&mut bodies, groups, &poses, aims);
    let result = |p: usize| {
        let (part, group) = (&job.parts[p], groups[p]);
        let shape = &job.shapes[part.shape];
        let least = shape.volume() - most_removed(shape, &part.roles, aims[p].depth);
        // A group of one that nothing was done to is what its kind is, where nothing was done to that.
        let touched = [group, kinds[p]].iter().any(|g| relieved.contains_key(g));
        let same_as = if touched { group } else { kinds[p] };
        let body = bodies[&group].posed(&part.pose);
        finish(&body, &moved[&kinds[p]].1, relieved.get(&group), (same_as, least))
    };
    let offsets = (0..job.parts.len()).into_par_iter().map(result).collect();
    (offsets, relieved.keys().copied().collect())
}

fn moved_body(job: &Job, shape: usize, contact: &[bool], aim: &Aim) -> (Body, Settled) {
    let mut body = Body::new(&job.shapes[shape], contact, aim.depth);
    weld::weld(&mut body, aim.weld);
    split::split(&mut body);
    let settled = settle::settle(&mut body, aim.thinnest);
    (body, settled)
}

/// Between two moved facets the air has 60 degrees or more; where it has less, what is left is carved. The tangent of half
/// of what is missing to 180: by it, in depths squared for each length of edge, what both take reaches beyond their prisms.
const SHARPEST: f64 = 1.732_050_807_568_877_2;

/// What a move may take, at most, in mm3: the prisms below the contact facets; beside edges, between two of them the kite in
/// the matter, else a half disc, since bodies may be parted there; and at corners a cube of two depths, shared by three facets.
fn most_removed(shape: &Shape, roles: &[Role], depth: f64) -> f64 {
    let contact = |f: usize| roles[f] != Role::Outer;
    let below = |f: usize| shape.facet_area(f) * depth + corners_of(shape, f) / 3.0 * (2.0 * depth).powi(3);
    let prisms: f64 = (0..shape.facets.len()).filter(|&f| contact(f)).map(below).sum();
    let beside = |(f, g, along): (usize, usize, DVec3)| {
        let (n, m) = (shape.facets[f].normal, shape.facets[g].normal);
        let between = match n.cross(m).dot(along) {
            _ if !(contact(f) && contact(g)) => std::f64::consts::FRAC_PI_2,
            s if s < 0.0 => (n.angle_between(m) / 2.0).tan().min(SHARPEST),
            _ => 0.0,
        };
        between * along.length() * depth * depth
    };
    prisms + edges(shape).into_iter().map(beside).sum::<f64>()
}

fn corners_of(shape: &Shape, f: usize) -> f64 {
    shape.facets[f].corners.len() as f64
}

/// The two facets of each edge, and the edge as the first of them runs along it.
fn edges(shape: &Shape) -> Vec<(usize, usize, DVec3)> {
    let ends = |f: usize| {
        let c = &shape.facets[f].corners;
        (0..c.len()).map(move |k| (c[k], c[(k + 1) % c.len()]))
    };
    let all: BTreeMap<(u32, u32), usize> =
        (0..shape.facets.len()).flat_map(|f| ends(f).map(move |e| (e, f))).collect();
    let both = |(&(a, b), &f): (&(u32, u32), &usize)| {
        let g = *all.get(&(b, a)).filter(|_| a < b)?;
        Some((f, g, shape.vertices[b as usize] - shape.vertices[a as usize]))
    };
    all.iter().filter_map(both).collect()
}

/// `same_as` and the least volume that may be left.
fn finish(
    body: &Body,
    settled: &Settled,
    relieved: Option<&Settled>,
    (same_as, least): (usize, f64),
) -> Offset {
    let last = relieved.unwrap_or(settled);
    let live: Vec<&body::Corner> =
        body.corners.iter().zip(&body.star).filter(|(_, s)| !s.is_empty()).map(|(c, _)| c).collect();
    let no_room = live.iter().filter(|c| !c.placed).map(|c| Failure { at: c.anchor, why: Why::NoRoom });
    let turned = last.unsettled.iter().map(|&at| Failure { at, why: Why::TurnedOver });
    let mut failures: Vec<Failure> = no_room.chain(turned).collect();
    let (mesh, _) = body.mesh();
    let left = mesh.volume();
    if left <= 0.0 || left < least {
        let at = live.iter().map(|c| c.anchor).sum::<DVec3>() / live.len().max(1) as f64;
        failures.push(Failure { at, why: if left <= 0.0 { Why::Vanished } else { Why::Lost } });
    }
    let longest_move = live.iter().map(|c| c.at.distance(c.anchor)).fold(0.0, f64::max);
    let collapses = settled.collapses + relieved.map_or(0, |r| r.collapses);
    Offset { mesh, collapses, longest_move, same_as, failures }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shape::Facet;

    /// A cube with the faces named as contact; what may go below them is at least what goes, and far less than the cube.
    #[test]
    fn what_a_move_may_take_holds_what_it_takes() {
        let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) * 10.0;
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let normals = [DVec3::NEG_Z, DVec3::Z, DVec3::NEG_Y, DVec3::Y, DVec3::NEG_X, DVec3::X];
        let facet = |(q, normal): (&[u32; 4], DVec3)| Facet { corners: q.to_vec(), normal };
        let facets: Vec<Facet> = quads.iter().zip(normals).map(facet).collect();
        let cube = Shape { vertices: (0..8).map(corner).collect(), facets };
        let taken = 1000.0 - 9.8f64.powi(3);
        let most = most_removed(&cube, &[Role::Contact { with: 1 }; 6], 0.1);
        assert!(most >= taken && most < 1.1 * taken, "{most} {taken}");
        assert_eq!(edges(&cube).len(), 12);
    }
}
