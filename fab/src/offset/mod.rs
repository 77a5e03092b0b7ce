//! Takes shapes in place, which facets are contact, and a depth; gives meshes with those facets moved inward.
//!
//! Sound: every triangle of a facet lies at least the depth below that facet's plane, and never above the plane of a
//! kept one. First order: where facets bend by an angle t it lies up to about depth * t * t / 2 deeper. Not complete:
//! shapes exist that it can not offset; it then says where, and the caller writes nothing.
//!
//! Where the whole of it fails for a part, the caller asks for it carved: `carve`.
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
pub mod lattice;
pub mod least;
pub mod relief;
pub mod settle;
pub mod split;
pub mod weld;

use crate::mesh::Mesh;
use crate::near::on_triangle;
use crate::shape::{Job, Role, Shape};
use body::Body;
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use relief::{Relief, Standing};
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
    pub by: By,
}

/// How contact facets go inward.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum By {
    /// Their planes are moved.
    Moving,
    /// A block around each is cut off.
    Carving,
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
    /// It can not be carved, as it is no solid.
    NotSolid,
    /// It stays nearer to another part than the fit.
    TooNear,
}

/// Edges shorter than this part of the depth are united before the move: for 0.2 mm that is 4 micrometres, a tenth of
/// the finest step that the printers at hand can make. What it costs in clearance, `relief` finds and mends.
pub const REACH: f64 = 0.02;

/// The start of a part: what has the same shape, contact facets and aim has the same.
type Key = (usize, Vec<bool>, [u64; 2], By);

/// A part with its own faces moved, in the frame of its shape, before any other part is looked at.
#[derive(Clone, Debug)]
struct Start {
    body: Body,
    settled: Settled,
    /// How far below the shape's surface its corners are, where none of them is a corner of the shape, mm.
    deepest: f64,
    failures: Vec<Failure>,
}

/// Starts that were made already, for the next attempt on the same job.
#[derive(Debug, Default)]
pub struct Known(BTreeMap<Key, Start>);

/// Moves the contact facets of every part inward and parts the bodies to their fits. Parts with the same shape, contact
/// facets and aim are moved once, and stay the same solid: what one of them has to give way by, all of them do, so that any
/// of them fits in the place of any other. Where that fails, each of them is parted alone. A part whose own move failed takes
/// no part in the parting: its wrong faces would push others back.
pub fn offset(job: &Job, aims: &[Aim], known: &mut Known) -> Vec<Offset> {
    let keys: Vec<Key> = (0..aims.len()).map(|p| key(job, p, &aims[p])).collect();
    let mut first: BTreeMap<&Key, usize> = BTreeMap::new();
    let kinds: Vec<usize> = keys.iter().enumerate().map(|(p, k)| *first.entry(k).or_insert(p)).collect();
    let new: Vec<(&Key, usize)> = first.into_iter().filter(|(k, _)| !known.0.contains_key(*k)).collect();
    let made: Vec<(Key, Start)> =
        new.into_par_iter().map(|(k, p)| (k.clone(), start(job, k, &aims[p]))).collect();
    known.0.extend(made);
    let starts: Vec<&Start> = keys.iter().map(|k| &known.0[k]).collect();
    let (together, relieved) = parted((job, aims), &starts, &kinds, &kinds);
    let spoilt = |p: &usize| relieved.contains(&kinds[*p]) && !together[*p].failures.is_empty();
    let failed: BTreeSet<usize> = (0..kinds.len()).filter(spoilt).map(|p| kinds[p]).collect();
    let alone = |p: usize| if failed.contains(&kinds[p]) { p } else { kinds[p] };
    let groups: Vec<usize> = (0..kinds.len()).map(alone).collect();
    if groups == kinds { together } else { parted((job, aims), &starts, &kinds, &groups).0 }
}

/// The sound bodies parted to their fits, parts of a group, named by its first, as one; and the groups that had to give way.
fn parted(
    (job, aims): (&Job, &[Aim]),
    starts: &[&Start],
    kinds: &[usize],
    groups: &[usize],
) -> (Vec<Offset>, BTreeSet<usize>) {
    let sound: Vec<usize> = (0..aims.len()).filter(|&p| starts[p].failures.is_empty()).collect();
    let mut bodies: BTreeMap<usize, Body> =
        sound.iter().map(|&p| (groups[p], starts[p].body.clone())).collect();
    let standing: Vec<Standing> =
        sound.iter().map(|&p| Standing { group: groups[p], pose: job.parts[p].pose, aim: aims[p] }).collect();
    let relief = relief::relieve(&mut bodies, &standing);
    let relieved: BTreeSet<usize> =
        relief.iter().filter(|(_, r)| r.settled.is_some()).map(|(g, _)| *g).collect();
    let result = |p: usize| {
        let group = groups[p];
        // A group of one that nothing was done to is what its kind is, where nothing was done to that.
        let touched = [group, kinds[p]].iter().any(|g| relieved.contains(g));
        let same_as = if touched { group } else { kinds[p] };
        match (bodies.get(&group), relief.get(&group)) {
            (Some(body), Some(relief)) if starts[p].failures.is_empty() => {
                finish(job, (p, &aims[p]), (starts[p], body, relief), same_as)
            }
            _ => {
                let pose = &job.parts[p].pose;
                let failures = posed(starts[p].failures.clone(), pose);
                let collapses = starts[p].settled.collapses;
                Offset::of(&starts[p].body.posed(pose), starts[p], collapses, same_as, failures)
            }
        }
    };
    ((0..job.parts.len()).into_par_iter().map(result).collect(), relieved)
}

/// Failures of a body, where it stands.
fn posed(failures: Vec<Failure>, pose: &DAffine3) -> Vec<Failure> {
    failures.into_iter().map(|f| Failure { at: pose.transform_point3(f.at), ..f }).collect()
}

fn key(job: &Job, p: usize, aim: &Aim) -> Key {
    let contact: Vec<bool> = job.parts[p].roles.iter().map(|r| *r != Role::Outer).collect();
    (job.parts[p].shape, contact, [aim.depth, aim.weld].map(f64::to_bits), aim.by)
}

fn start(job: &Job, (shape, contact, _, by): &Key, aim: &Aim) -> Start {
    let shape = &job.shapes[*shape];
    match by {
        By::Moving => moved(shape, contact, aim),
        By::Carving => carved(shape, contact, aim),
    }
}

fn moved(shape: &Shape, contact: &[bool], aim: &Aim) -> Start {
    let mut body = Body::new(shape, contact, aim.depth);
    weld::weld(&mut body, aim.weld);
    split::split(&mut body);
    let settled = settle::settle(&mut body, aim.thinnest);
    let least = shape.volume() - most_removed(shape, contact, aim.depth);
    let mut failures = [of_moving(&body), of_settling(&settled), of_volume(&body, least)].concat();
    if failures.is_empty() && settled.collapses > 0 {
        failures.extend(of_jumping(shape, contact, aim, &body));
    }
    Start { body, settled, deepest: 0.0, failures }
}

/// A collapse can take a corner along that was no part of the fault. Where one went farther than a move along a flat ridge
/// does, carving is the measure: if it leaves more, the move has lost a piece.
fn of_jumping(shape: &Shape, contact: &[bool], aim: &Aim, body: &Body) -> Option<Failure> {
    let far = body::LONGEST_RUN * aim.depth;
    let at = live(body).find(|c| c.at.distance(c.anchor) > far)?.anchor;
    let carved = carve::carve(shape, contact, aim.depth, aim.thinnest).ok()??;
    (carved.volume() > body.mesh().0.volume()).then_some(Failure { at, why: Why::Lost })
}

/// A carved part as a body: its triangles are faces that nothing moves but the parting from other bodies.
fn carved(shape: &Shape, contact: &[bool], aim: &Aim) -> Start {
    let carving = carve::carve(shape, contact, aim.depth, aim.thinnest);
    let Ok(Some(mesh)) = carving else {
        let body = Body::new(shape, contact, 0.0);
        let failures = of_volume(&body, f64::INFINITY);
        let why = if carving.is_ok() { Why::Vanished } else { Why::NotSolid };
        let failures = failures.into_iter().map(|f| Failure { why, ..f }).collect();
        return Start { body, settled: Settled::default(), deepest: 0.0, failures };
    };
    let body = Body::new(&Shape::of(&mesh), &vec![false; mesh.triangles.len()], aim.depth).as_it_came();
    let deepest = deepest(&mesh, &shape.mesh());
    Start { body, settled: Settled::default(), deepest, failures: vec![] }
}

/// The farthest that a corner of the mesh is from the part's surface, mm.
pub fn deepest(mesh: &Mesh, part: &Mesh) -> f64 {
    let below = |v: &DVec3| {
        let near = |t: usize| v.distance(on_triangle(*v, part.corners(t)));
        (0..part.triangles.len()).map(near).fold(f64::INFINITY, f64::min)
    };
    mesh.vertices.par_iter().map(below).reduce(|| 0.0, f64::max)
}

/// Between two moved facets the air has 60 degrees or more; where it has less, what is left is carved. The tangent of half
/// of what is missing to 180: by it, in depths squared for each length of edge, what both take reaches beyond their prisms.
const SHARPEST: f64 = 1.732_050_807_568_877_2;

/// What a move may take, at most, in mm3: the prisms below the contact facets; beside edges, between two of them the kite in
/// the matter, else a half disc, since bodies may be parted there; and at corners a cube of two depths, shared by three facets.
fn most_removed(shape: &Shape, contact: &[bool], depth: f64) -> f64 {
    let contact = |f: usize| contact[f];
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

/// A part that took part in the parting, its body in the frame of its shape. Where it was pushed back, all its faces may dip
/// by a depth.
fn finish(
    job: &Job,
    (p, aim): (usize, &Aim),
    (start, body, relief): (&Start, &Body, &Relief),
    same_as: usize,
) -> Offset {
    let mut failures: Vec<Failure> =
        relief.near.iter().map(|&at| Failure { at, why: Why::TooNear }).collect();
    let collapses = start.settled.collapses + relief.settled.as_ref().map_or(0, |s| s.collapses);
    let part = &job.parts[p];
    if let Some(settled) = &relief.settled {
        let before = &job.shapes[part.shape];
        let all = vec![true; before.facets.len()];
        let carved = start.body.mesh().0.volume().min(before.volume());
        let least = carved - most_removed(before, &all, aim.depth);
        failures.extend([of_moving(body), of_settling(settled), of_volume(body, least)].concat());
        failures.extend(dragged(aim, settled, &start.body, body));
    }
    Offset::of(&body.posed(&part.pose), start, collapses, same_as, posed(failures, &part.pose))
}

/// A corner that collapses of the parting took along farther than a move along a flat ridge goes; of a carved part, whose
/// slivers have planes of no meaning, any corner that went so far.
fn dragged(aim: &Aim, settled: &Settled, before: &Body, after: &Body) -> Option<Failure> {
    let went = |(a, b): &(&body::Corner, &body::Corner)| {
        (settled.collapses > 0 || aim.by == By::Carving)
            && a.at.distance(b.at) > body::LONGEST_RUN * aim.depth
    };
    let lives = after.corners.iter().zip(&after.star).map(|(c, s)| (c, !s.is_empty()));
    let both = before.corners.iter().zip(lives).filter(|(_, (_, lives))| *lives).map(|(a, (b, _))| (a, b));
    both.into_iter().find(went).map(|(a, _)| Failure { at: a.at, why: Why::Lost })
}

impl Offset {
    fn of(body: &Body, start: &Start, collapses: usize, same_as: usize, failures: Vec<Failure>) -> Offset {
        let longest_move = live(body).map(|c| c.at.distance(c.anchor)).fold(start.deepest, f64::max);
        Offset { mesh: body.mesh().0, collapses, longest_move, same_as, failures }
    }
}

fn live(body: &Body) -> impl Iterator<Item = &body::Corner> {
    body.corners.iter().zip(&body.star).filter(|(_, s)| !s.is_empty()).map(|(c, _)| c)
}

fn of_moving(body: &Body) -> Vec<Failure> {
    live(body).filter(|c| !c.placed).map(|c| Failure { at: c.anchor, why: Why::NoRoom }).collect()
}

fn of_settling(settled: &Settled) -> Vec<Failure> {
    settled.unsettled.iter().map(|&at| Failure { at, why: Why::TurnedOver }).collect()
}

/// Less than the least volume that may be left.
fn of_volume(body: &Body, least: f64) -> Vec<Failure> {
    let left = body.mesh().0.volume();
    let why = match left {
        v if v <= 0.0 => Why::Vanished,
        v if v < least => Why::Lost,
        _ => return vec![],
    };
    let (sum, count) = live(body).fold((DVec3::ZERO, 0.0_f64), |(s, n), c| (s + c.anchor, n + 1.0));
    vec![Failure { at: sum / count.max(1.0), why }]
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
        let most = most_removed(&cube, &[true; 6], 0.1);
        assert!(most >= taken && most < 1.1 * taken, "{most} {taken}");
        assert_eq!(edges(&cube).len(), 12);
    }
}
