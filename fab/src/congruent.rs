//! Takes a job; gives the same job with congruent parts sharing one shape, each in its own place: what is made for one of
//! them (a mesh, a mold) then serves them all.
//!
//! Sound: a part is given another's shape only where a proper rigid motion takes every corner to its twin, facet to facet
//! and contact to contact, none farther off than asked; a mirror image is another solid. Not complete: solids whose facets
//! are divided otherwise, of several shells, or past a bound of steps keep shapes of their own.

use crate::shape::{Job, PlacedPart, Role, Shape};
use glam::{DAffine3, DMat3, DVec3};
use std::collections::{BTreeMap, HashMap};

/// Facets visited for each facet of a solid before two solids are given up as different: a solid has few facets that look
/// like its longest, and a wrong start is found out after some edges.
const VISITS: usize = 64;

/// A shape with the facets that are contact.
struct Marked<'a> {
    shape: &'a Shape,
    contact: Vec<bool>,
    /// The facet left of each edge, and the edge's number in it.
    left: HashMap<(u32, u32), (usize, usize)>,
    perimeters: Vec<f64>,
    /// The facet that is longest around.
    longest: usize,
    /// mm3, and mm2.
    volume: f64,
    area: f64,
}

/// How a solid lies on another.
struct Match {
    /// From the first one's frame to the second's.
    motion: DAffine3,
    /// The second's facet for each of the first.
    facets: Vec<usize>,
}

/// The job with each part on the first shape that it is congruent to with its contacts, corners within `off` mm.
pub fn united(job: &Job, off: f64) -> Job {
    let key = |p: &PlacedPart| (p.shape, contacts(p));
    let mut kinds: BTreeMap<(usize, Vec<bool>), usize> = BTreeMap::new();
    let mut firsts: Vec<usize> = Vec::new();
    for (p, part) in job.parts.iter().enumerate() {
        kinds.entry(key(part)).or_insert_with(|| {
            firsts.push(p);
            firsts.len() - 1
        });
    }
    let lies = lies(job, &firsts, off);
    let part = |p: &PlacedPart| match &lies[kinds[&key(p)]] {
        None => p.clone(),
        Some((root, found)) => PlacedPart {
            id: p.id.clone(),
            shape: job.parts[firsts[*root]].shape,
            pose: p.pose * found.motion,
            roles: found.facets.iter().map(|&f| p.roles[f]).collect(),
        },
    };
    Job { name: job.name.clone(), shapes: job.shapes.clone(), parts: job.parts.iter().map(part).collect() }
}

/// For each of these parts the first among them that it is congruent to, and how it lies on it; `None` for that first.
fn lies(job: &Job, firsts: &[usize], off: f64) -> Vec<Option<(usize, Match)>> {
    let count = |k: usize| {
        let part = &job.parts[firsts[k]];
        let (shape, touching) = (&job.shapes[part.shape], part.roles.iter().filter(|r| **r != Role::Outer));
        (shape.facets.len(), shape.vertices.len(), touching.count())
    };
    let mut alike: BTreeMap<(usize, usize, usize), Vec<usize>> = BTreeMap::new();
    (0..firsts.len()).for_each(|k| alike.entry(count(k)).or_default().push(k));
    let mut lies: Vec<Option<(usize, Match)>> = firsts.iter().map(|_| None).collect();
    // What is alone has nothing to be laid on: large meshes are mostly that.
    for group in alike.values().filter(|g| g.len() > 1) {
        let mut roots: Vec<(usize, Marked)> = Vec::new();
        for &k in group {
            let marked = Marked::new(job, &job.parts[firsts[k]]);
            lies[k] = roots.iter().find_map(|(r, root)| Some((*r, matched(root, &marked, off)?)));
            if lies[k].is_none() {
                roots.push((k, marked));
            }
        }
    }
    lies
}

fn contacts(p: &PlacedPart) -> Vec<bool> {
    p.roles.iter().map(|r| *r != Role::Outer).collect()
}

impl<'a> Marked<'a> {
    fn new(job: &'a Job, part: &PlacedPart) -> Marked<'a> {
        let shape = &job.shapes[part.shape];
        let edges = |f: usize| (0..shape.facets[f].corners.len()).map(move |k| (f, k));
        let left: HashMap<(u32, u32), (usize, usize)> =
            (0..shape.facets.len()).flat_map(edges).map(|(f, k)| (edge(shape, f, k), (f, k))).collect();
        let long = |(a, b): (u32, u32)| shape.vertices[a as usize].distance(shape.vertices[b as usize]);
        let around = |f: usize| edges(f).map(|(f, k)| long(edge(shape, f, k))).sum();
        let facets = 0..shape.facets.len();
        let perimeters: Vec<f64> = facets.clone().map(around).collect();
        let longest = facets.clone().max_by(|&f, &g| perimeters[f].total_cmp(&perimeters[g])).unwrap_or(0);
        let area = facets.map(|f| shape.facet_area(f)).sum();
        Marked { shape, contact: contacts(part), left, perimeters, longest, volume: shape.volume(), area }
    }

    fn sides(&self, f: usize) -> usize {
        self.shape.facets[f].corners.len()
    }

    fn corner(&self, f: usize, k: usize) -> u32 {
        self.shape.facets[f].corners[k % self.sides(f)]
    }

    fn at(&self, v: u32) -> DVec3 {
        self.shape.vertices[v as usize]
    }

    /// The facet beyond an edge, and the edge's number there.
    fn beyond(&self, f: usize, k: usize) -> Option<(usize, usize)> {
        self.left.get(&(self.corner(f, k + 1), self.corner(f, k))).copied()
    }

    fn looks_like(&self, f: usize, other: &Marked, g: usize) -> bool {
        self.sides(f) == other.sides(g) && self.contact[f] == other.contact[g]
    }
}

fn edge(shape: &Shape, f: usize, k: usize) -> (u32, u32) {
    let c = &shape.facets[f].corners;
    (c[k], c[(k + 1) % c.len()])
}

/// The proper rigid motion that lays `a` on `b`, of as many facets and corners, if one is found.
fn matched(a: &Marked, b: &Marked, off: f64) -> Option<Match> {
    // A layer of what each may be off, all over.
    if (a.volume - b.volume).abs() > 2.0 * off * (a.area + b.area) {
        return None;
    }
    let longest = a.longest;
    // Each end of each edge may be off.
    let slack = 2.0 * off * a.sides(longest) as f64;
    let near =
        |g: &usize| a.looks_like(longest, b, *g) && (b.perimeters[*g] - a.perimeters[longest]).abs() <= slack;
    let starts = (0..b.shape.facets.len()).filter(near);
    let mut visits = VISITS * a.shape.facets.len();
    for (g, turn) in starts.flat_map(|g| (0..b.sides(g)).map(move |turn| (g, turn))) {
        if let Some(twins) = walked((a, b), (longest, g, turn), off, &mut visits)
            && let Some(motion) = motion(a, b, &twins.corners, off)
        {
            return Some(Match { motion, facets: twins.facets });
        }
        if visits == 0 {
            return None;
        }
    }
    None
}

struct Twins {
    facets: Vec<usize>,
    /// Pairs of corners, by those of the first solid.
    corners: BTreeMap<u32, u32>,
}

/// From one pair of facets over all their neighbours: the twins of all facets and corners, or `None` where the solids
/// differ. Facets are gone around in the same sense in both, so that no mirror image is found.
fn walked(
    (a, b): (&Marked, &Marked),
    (first, on, turn): (usize, usize, usize),
    off: f64,
    visits: &mut usize,
) -> Option<Twins> {
    let mut twin: Vec<Option<(usize, usize)>> = vec![None; a.shape.facets.len()];
    let (mut corners, mut back) = (BTreeMap::new(), BTreeMap::new());
    let mut todo = vec![first];
    twin[first] = Some((on, turn));
    while let Some(f) = todo.pop() {
        let (g, turn) = twin[f]?;
        *visits = visits.checked_sub(1)?;
        for k in 0..a.sides(f) {
            let (u, v) = (a.corner(f, k), b.corner(g, k + turn));
            let (next_u, next_v) = (a.corner(f, k + 1), b.corner(g, k + 1 + turn));
            let longer = a.at(u).distance(a.at(next_u)) - b.at(v).distance(b.at(next_v));
            let one_to_one = *corners.entry(u).or_insert(v) == v && *back.entry(v).or_insert(u) == u;
            if !one_to_one || longer.abs() > 2.0 * off {
                return None;
            }
            let (f_next, k_next) = a.beyond(f, k)?;
            let (g_next, j_next) = b.beyond(g, (k + turn) % b.sides(g))?;
            if !a.looks_like(f_next, b, g_next) {
                return None;
            }
            let n = a.sides(f_next);
            let turned = (g_next, (j_next + n - k_next) % n);
            match twin[f_next] {
                None => {
                    twin[f_next] = Some(turned);
                    todo.push(f_next);
                }
                Some(known) if known != turned => return None,
                Some(_) => {}
            }
        }
    }
    let facets = twin.into_iter().map(|t| t.map(|t| t.0)).collect::<Option<Vec<_>>>()?;
    Some(Twins { facets, corners })
}

/// The motion that takes a frame of three far corners to that of their twins, if it takes every corner to its own.
fn motion(a: &Marked, b: &Marked, twins: &BTreeMap<u32, u32>, off: f64) -> Option<DAffine3> {
    let far = |from: &dyn Fn(DVec3) -> f64| {
        twins.iter().max_by(|x, y| from(a.at(*x.0)).total_cmp(&from(a.at(*y.0)))).map(|(u, v)| (*u, *v))
    };
    let first = twins.iter().next().map(|(u, _)| a.at(*u))?;
    let p = far(&|x| x.distance(first))?;
    let q = far(&|x| x.distance(a.at(p.0)))?;
    let along = a.at(q.0) - a.at(p.0);
    let r = far(&|x| (x - a.at(p.0)).cross(along).length())?;
    let from = frame([p.0, q.0, r.0].map(|v| a.at(v)))?;
    let to = frame([p.1, q.1, r.1].map(|v| b.at(v)))?;
    let motion = to * from.inverse();
    let near = |(u, v): (&u32, &u32)| motion.transform_point3(a.at(*u)).distance(b.at(*v)) <= off;
    twins.iter().all(near).then_some(motion)
}

/// Right-handed: the origin between the first two points, x along them, the third in the plane of x and y.
fn frame([p, q, r]: [DVec3; 3]) -> Option<DAffine3> {
    let x = (q - p).try_normalize()?;
    let y = ((r - p) - x * (r - p).dot(x)).try_normalize()?;
    Some(DAffine3::from_mat3_translation(DMat3::from_cols(x, y, x.cross(y)), (p + q) / 2.0))
}
