//! Takes a shape, tells its form at each vertex, edge and point: flat, convex, reflex or saddle.
//!
//! Not promised: a point nearer than the tolerance to several features is taken to be at the lowest and
//! nearest one.

use super::overlap::{face_distance, segment_distance};
use super::shape::{Face, Shape, around};
use glam::DVec3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use std::collections::BTreeMap;

/// Sine below which two faces count as one plane: round-off of unit normals, with room for features a
/// ten-millionth of the assembly.
const FLAT: f64 = 1e-9;

/// What the solid looks like from a point of its surface, seen close by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// A half-space.
    Flat,
    /// A convex wedge or corner.
    Convex,
    /// All but a convex wedge or corner.
    Reflex,
    /// Anything else, and places where the surface touches itself.
    Saddle,
}

/// Form and distinct outward normals of the faces at a point.
#[derive(Clone, Debug)]
pub(super) struct Local {
    pub form: Form,
    pub normals: Vec<DVec3>,
    /// By how much the worst known of the normals may be off, in radians.
    pub known: f64,
}

pub(super) struct Edge {
    pub ends: [u32; 2],
    pub local: Local,
}

/// Edges and vertices of a shape with their forms.
pub(super) struct Features {
    pub edges: Vec<Edge>,
    /// Parallel to the shape's points; none where no face uses the point.
    pub vertices: Vec<Option<Local>>,
    at_edge: BTreeMap<[u32; 2], usize>,
    tree: Bvh,
}

impl Features {
    pub fn of(points: &[DVec3], faces: &[Face]) -> Features {
        let edges = edges(points, faces);
        let at_edge = edges.iter().enumerate().map(|(k, e)| (e.ends, k)).collect();
        let boxes: Vec<Aabb> =
            edges.iter().map(|e| around(e.ends.iter().map(|&i| points[i as usize]))).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        let vertices = vertices(points.len(), faces, &edges);
        Features { edges, vertices, at_edge, tree }
    }

    /// Edges that are not flat and whose boxes come within `reach` of the given box, in order.
    pub fn edges_near(&self, bounds: &Aabb, reach: f64) -> Vec<usize> {
        let wide = bounds.loosened(reach);
        let near = self.tree.intersect_aabb(&wide).map(|k| k as usize);
        let mut found: Vec<usize> = near.filter(|&k| self.edges[k].local.form != Form::Flat).collect();
        found.sort_unstable();
        found
    }
}

/// The form of the shape at a point of its surface; nothing where the surface is farther than `reach`.
pub(super) fn locate(s: &Shape, p: DVec3, reach: f64) -> Option<&Local> {
    let near = s.faces_near(&around(std::iter::once(p)), reach);
    let faces: Vec<usize> = near.into_iter().filter(|&f| face_distance(s, f, p) <= reach).collect();
    let corners = faces.iter().flat_map(|&f| s.faces[f].corners.iter().copied());
    if let Some(v) = nearest(corners.map(|i| (s.at(i).distance(p), i)), reach) {
        return s.features.vertices[v as usize].as_ref();
    }
    let rims = faces.iter().flat_map(|&f| rim(&s.faces[f]));
    if let Some(e) = nearest(rims.map(|e| (segment_distance(s.at(e[0]), s.at(e[1]), p), e)), reach) {
        return Some(&s.features.edges[s.features.at_edge[&e]].local);
    }
    faces.first().map(|&f| &s.faces[f].local)
}

fn nearest<T: Ord>(candidates: impl Iterator<Item = (f64, T)>, reach: f64) -> Option<T> {
    let close = candidates.filter(|(d, _)| *d <= reach);
    close.min_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1))).map(|(_, t)| t)
}

/// The edges of a face, each from its lower to its higher end.
fn rim(f: &Face) -> impl Iterator<Item = [u32; 2]> + '_ {
    directed(f).map(|(i, j)| [i.min(j), i.max(j)])
}

fn directed(f: &Face) -> impl Iterator<Item = (u32, u32)> + '_ {
    (0..f.corners.len()).map(|k| (f.corners[k], f.corners[(k + 1) % f.corners.len()]))
}

fn edges(points: &[DVec3], faces: &[Face]) -> Vec<Edge> {
    let mut sides: BTreeMap<[u32; 2], [Vec<usize>; 2]> = BTreeMap::new();
    for (k, f) in faces.iter().enumerate() {
        directed(f)
            .for_each(|(i, j)| sides.entry([i.min(j), i.max(j)]).or_default()[usize::from(i > j)].push(k));
    }
    let edge = |(ends, side): ([u32; 2], [Vec<usize>; 2])| {
        let along = points[ends[1] as usize] - points[ends[0] as usize];
        let normals = side.iter().flatten().map(|&k| faces[k].normal);
        let form = match &side {
            [l, r] if l.len() == 1 && r.len() == 1 => dihedral(faces[l[0]].normal, faces[r[0]].normal, along),
            _ => Form::Saddle,
        };
        let known = worst(faces, side.iter().flatten());
        Edge { ends, local: Local { form, normals: distinct(normals), known } }
    };
    sides.into_iter().map(edge).collect()
}

fn worst<'a>(faces: &[Face], of: impl IntoIterator<Item = &'a usize>) -> f64 {
    of.into_iter().map(|&k| faces[k].known).fold(0.0, f64::max)
}

/// The form of an edge from the normals to its left and right, seen along it from outside.
fn dihedral(left: DVec3, right: DVec3, along: DVec3) -> Form {
    let turn = left.cross(right);
    match (turn.length() <= FLAT, left.dot(right) > 0.0, turn.dot(along) > 0.0) {
        (true, true, _) => Form::Flat,
        (true, false, _) => Form::Saddle,
        (false, _, true) => Form::Convex,
        (false, _, false) => Form::Reflex,
    }
}

fn distinct(normals: impl Iterator<Item = DVec3>) -> Vec<DVec3> {
    normals.fold(Vec::new(), |mut all, n| {
        if all.iter().all(|m: &DVec3| m.distance(n) > FLAT) {
            all.push(n);
        }
        all
    })
}

fn vertices(count: usize, faces: &[Face], edges: &[Edge]) -> Vec<Option<Local>> {
    let mut around: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (k, f) in faces.iter().enumerate() {
        f.corners.iter().for_each(|&i| around[i as usize].push(k));
    }
    let mut spokes: Vec<Vec<Form>> = vec![Vec::new(); count];
    for e in edges {
        e.ends.iter().for_each(|&i| spokes[i as usize].push(e.local.form));
    }
    let vertex = |i: usize| {
        let normals = distinct(around[i].iter().map(|&k| faces[k].normal));
        let form = if fans(i as u32, &around[i], faces) == 1 { corner(&spokes[i]) } else { Form::Saddle };
        let known = worst(faces, &around[i]);
        (!around[i].is_empty()).then_some(Local { form, normals, known })
    };
    (0..count).map(vertex).collect()
}

/// The form of a corner from the forms of its edges.
fn corner(spokes: &[Form]) -> Form {
    let has = |f: Form| spokes.contains(&f);
    match (has(Form::Convex), has(Form::Reflex), has(Form::Saddle)) {
        (_, _, true) | (true, true, _) => Form::Saddle,
        (true, false, _) => Form::Convex,
        (false, true, _) => Form::Reflex,
        (false, false, _) => Form::Flat,
    }
}

/// Into how many fans, each connected over edges at the vertex, its faces fall.
fn fans(v: u32, faces_at: &[usize], faces: &[Face]) -> usize {
    let beside = |k: usize| {
        let c = &faces[k].corners;
        let at = c.iter().position(|&i| i == v).unwrap_or(0);
        [c[(at + 1) % c.len()], c[(at + c.len() - 1) % c.len()]]
    };
    let mut left: Vec<[u32; 2]> = faces_at.iter().map(|&k| beside(k)).collect();
    let mut fans = 0;
    while let Some(first) = left.pop() {
        fans += 1;
        let mut rim = first.to_vec();
        while let Some(k) = left.iter().position(|s| s.iter().any(|i| rim.contains(i))) {
            rim.extend(left.swap_remove(k));
        }
    }
    fans
}
