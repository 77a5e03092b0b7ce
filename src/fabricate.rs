//! Takes parts in place and their contacts; gives the job for `weavelock-fab`: solids in mm with a role for each facet.
//!
//! Woven facets know whom they face. A mesh facet counts as contact where a patch lies on it; such a facet moves as a
//! whole, so a face that touches in part leaves air in all of it.

use crate::assembly::{Assembly, PartIx};
use crate::blocking::bounds;
use crate::contact::{Joined, Origin, Patch};
use crate::solid::{Facet, Solid};
use glam::{DAffine3, DVec3};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use weavelock_fab::mesh::Mesh;
use weavelock_fab::shape::{self, Job, PlacedPart, Role, Shape};

pub fn job(joined: &Joined) -> Job {
    let asm = &joined.assembly;
    let shapes = asm.solids.iter().map(|s| shape(s, asm.mm_per_unit)).collect();
    let part = |p: PartIx| {
        let pose = asm.part(p).pose;
        let mm = DAffine3 { translation: pose.translation * asm.mm_per_unit, ..pose };
        PlacedPart { id: asm.part(p).id.clone(), shape: asm.part(p).solid, pose: mm, roles: roles(joined, p) }
    };
    Job { name: asm.name.clone(), shapes, parts: asm.ids().map(part).collect() }
}

/// The parts as they touch, in place, in mm.
pub fn meshes(asm: &Assembly) -> Vec<Mesh> {
    let mesh = |p: PartIx| {
        let vertices = asm.vertices(p).map(|v| v * asm.mm_per_unit).collect();
        Mesh { vertices, triangles: asm.solid(p).triangles().collect() }
    };
    asm.ids().map(mesh).collect()
}

fn shape(solid: &Solid, mm: f64) -> Shape {
    let facet = |f: &Facet| shape::Facet { corners: f.corners.clone(), normal: f.normal };
    Shape {
        vertices: solid.vertices.iter().map(|v| *v * mm).collect(),
        facets: solid.facets.iter().map(facet).collect(),
    }
}

fn roles(joined: &Joined, part: PartIx) -> Vec<Role> {
    let role = |with: Option<PartIx>| with.map_or(Role::Outer, |p| Role::Contact { with: p.at() });
    match &joined.origin {
        Origin::Woven(woven) => woven.faced(part).map(role).collect(),
        Origin::Meshes => {
            let own = Near::new(joined.patches.iter().filter_map(|p| facing(p, part)).collect());
            let facets = joined.assembly.solid(part).facets.iter();
            facets.map(|f| role(touched(&joined.assembly, part, f, &own))).collect()
        }
    }
}

/// The patch's other part, and the sign that turns its normal outward from this one.
fn facing(patch: &Patch, part: PartIx) -> Option<(&Patch, PartIx, f64)> {
    match part {
        p if p == patch.a => Some((patch, patch.b, 1.0)),
        p if p == patch.b => Some((patch, patch.a, -1.0)),
        _ => None,
    }
}

/// Patches of a part, found by where they are.
struct Near<'j> {
    patches: Vec<(&'j Patch, PartIx, f64)>,
    /// Over their boxes, each as much wider as the patch may lean off a facet on which one of its corners lies.
    tree: Bvh,
}

impl<'j> Near<'j> {
    fn new(patches: Vec<(&'j Patch, PartIx, f64)>) -> Near<'j> {
        let wide = |(p, ..): &(&Patch, PartIx, f64)| {
            let (lo, hi) = bounds(p.corners.iter().copied());
            let lean = (hi - lo).length() * (2.0 * OFF_PLANE_SHARE).sqrt();
            Aabb::new(lo - lean, hi + lean)
        };
        let boxes: Vec<Aabb> = patches.iter().map(wide).collect();
        Near { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes), patches }
    }

    /// In their order, those that may lie within this distance of the corners' box.
    fn of(&self, corners: &[DVec3], within: f64) -> impl Iterator<Item = (&'j Patch, PartIx, f64)> {
        let (lo, hi) = bounds(corners.iter().copied());
        let mut found: Vec<u32> = self.tree.intersect_aabb(&Aabb::new(lo - within, hi + within)).collect();
        found.sort_unstable();
        found.into_iter().map(|k| self.patches[k as usize])
    }
}

/// How far, as a share of the facet's size, a patch may stand off the facet that it lies on; contacts of meshes are
/// found within a tolerance that is far smaller than a facet.
const OFF_PLANE_SHARE: f64 = 1e-3;

fn touched(asm: &Assembly, part: PartIx, facet: &Facet, patches: &Near) -> Option<PartIx> {
    let (solid, pose) = (asm.solid(part), asm.part(part).pose);
    let corners: Vec<DVec3> =
        facet.corners.iter().map(|&c| pose.transform_point3(solid.vertices[c as usize])).collect();
    let normal = pose.transform_vector3(facet.normal);
    let size = corners.iter().map(|c| (*c - corners[0]).length()).fold(0.0, f64::max);
    let slack = size * OFF_PLANE_SHARE;
    let lies = |patch: &Patch, sign: f64| {
        patch.corners.len() > 2
            && (patch.normal * sign).dot(normal) > 1.0 - OFF_PLANE_SHARE
            && (patch.corners[0] - corners[0]).dot(normal).abs() <= slack
            && overlap(&patch.corners, &corners, normal, slack)
    };
    patches.of(&corners, slack).find(|(p, _, sign)| lies(p, *sign)).map(|(_, with, _)| with)
}

/// Whether two convex polygons of one plane share more than a border of the given width (separating axes).
fn overlap(p: &[DVec3], q: &[DVec3], normal: DVec3, width: f64) -> bool {
    let axes = [p, q].into_iter().flat_map(|poly| {
        (0..poly.len()).map(move |k| normal.cross(poly[(k + 1) % poly.len()] - poly[k]).normalize_or_zero())
    });
    let span = |poly: &[DVec3], axis: DVec3| {
        let along = poly.iter().map(|c| c.dot(axis));
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)))
    };
    axes.filter(|a| *a != DVec3::ZERO).all(|axis| {
        let (a, b) = (span(p, axis), span(q, axis));
        a.1.min(b.1) - a.0.max(b.0) > width
    })
}
