//! Takes facets of a mesh that all lean one way along a direction; gives what they sweep over on their way to a plane
//! square to it, in few closed bodies: one for each patch that covers no place of the plane twice.
//!
//! Corners of the mesh stay where they are, so that bodies of one mesh fit each other. Walls along the direction, to
//! round-off, sweep over nothing and are left out. Not promised: the least number of bodies.

use crate::bvh::Bvh;
use crate::cross::pairs;
use crate::mesh::Mesh;
use crate::mold::fill::into;
use crate::mold::frame::upright;
use crate::mold::parting::{Look, looks};
use crate::mold::shadow::{self, flat};
use crate::solid::{NotSolid, Solid};
use glam::{DVec2, DVec3};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// A mesh seen along a direction.
pub struct Seen<'a> {
    mesh: &'a Mesh,
    tree: Bvh,
    along: DVec3,
    /// The mesh turned so that the direction is z.
    turned: Mesh,
    looks: Vec<Look>,
}

/// On which side of its facets a curtain hangs, and how far it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum To {
    /// Along the direction, up to where a point's component along it is this, mm.
    Along(f64),
    /// Against it, down to that.
    Against(f64),
}

impl<'a> Seen<'a> {
    /// `snap`: how far a coordinate may be off, mm.
    pub fn along(mesh: &'a Mesh, along: DVec3, snap: f64) -> Seen<'a> {
        let turn = upright(along);
        let turned = mesh.map(|v| turn * v);
        let looks = looks(&turned, snap);
        Seen { mesh, tree: Bvh::new(mesh), along, turned, looks }
    }

    /// Facets that look this way and are chosen.
    pub fn looking(&self, way: Look, chosen: impl Fn(usize) -> bool) -> Vec<u32> {
        (0..self.looks.len()).filter(|&t| self.looks[t] == way && chosen(t)).map(|t| t as u32).collect()
    }

    /// Curtains begin on their facets.
    pub fn hung_on(&self, facets: &[u32], to: To) -> Result<Vec<Solid>, NotSolid> {
        self.curtains(facets, to, |p| p)
    }

    /// Curtains begin a little inside the matter behind their facets, so that they meet it in volume.
    pub fn rooted(&self, facets: &[u32], to: To) -> Result<Vec<Solid>, NotSolid> {
        let back = match to {
            To::Along(_) => -self.along,
            To::Against(_) => self.along,
        };
        self.curtains(facets, to, |p| p + back * into((self.mesh, &self.tree), p, back))
    }

    fn curtains(
        &self,
        facets: &[u32],
        to: To,
        begin: impl Fn(DVec3) -> DVec3,
    ) -> Result<Vec<Solid>, NotSolid> {
        let patches = patches(&self.turned, &self.mesh.triangles, facets);
        patches.iter().map(|p| Solid::or_nothing(&self.hung(p, to, &begin))).collect()
    }

    /// The body between a patch and the plane.
    fn hung(&self, patch: &[u32], to: To, begin: &impl Fn(DVec3) -> DVec3) -> Mesh {
        let (rings, corners) = sheet(patch.iter().map(|&t| self.mesh.triangles[t as usize]).collect());
        let (along, level) = match to {
            To::Along(level) => (self.along, level),
            To::Against(level) => (-self.along, -level),
        };
        let at: Vec<DVec3> = corners.iter().map(|&v| self.mesh.vertices[v as usize]).collect();
        let n = at.len() as u32;
        let vertices =
            at.iter().map(|&p| begin(p)).chain(at.iter().map(|&p| moved_to(p, along, level))).collect();
        // Patches face away from where they hang to, or towards it: the body is turned out accordingly.
        let outward = rings.first().is_some_and(|&t| self.faces(t.map(|c| at[c as usize]), along));
        let far = |t: &[u32; 3]| [t[0] + n, t[2] + n, t[1] + n];
        let side = |(a, b): (u32, u32)| [[b, a, a + n], [b, a + n, b + n]];
        let walls = border(&rings).into_iter().flat_map(side);
        let all = rings.iter().copied().chain(rings.iter().map(far)).chain(walls);
        let turned = |t: [u32; 3]| if outward { [t[0], t[2], t[1]] } else { t };
        Mesh { vertices, triangles: all.map(turned).collect() }
    }

    fn faces(&self, [a, b, c]: [DVec3; 3], along: DVec3) -> bool {
        (b - a).cross(c - a).dot(along) > 0.0
    }
}

/// A point moved along a unit vector until its component along it is `level`; along an axis exactly.
fn moved_to(p: DVec3, along: DVec3, level: f64) -> DVec3 {
    let k = along.abs().max_position();
    if along[k].abs() < 1.0 {
        return p + along * (level - p.dot(along));
    }
    let mut q = p;
    q[k] = level * along[k];
    q
}

fn edges(t: &[u32; 3]) -> [(u32, u32); 3] {
    [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]
}

fn border(triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let all: BTreeSet<(u32, u32)> = triangles.iter().flat_map(edges).collect();
    all.iter().filter(|(a, b)| !all.contains(&(*b, *a))).copied().collect()
}

/// The triangles over corners of their own, and the vertex of each corner: triangles around a vertex that do not hang
/// together by edges get a corner each, so that every corner is passed by the border once at most.
fn sheet(triangles: Vec<[u32; 3]>) -> (Vec<[u32; 3]>, Vec<u32>) {
    let mut root: Vec<usize> = (0..3 * triangles.len()).collect();
    let mut side: BTreeMap<(u32, u32), (usize, usize)> = BTreeMap::new();
    for (t, tri) in triangles.iter().enumerate() {
        for k in 0..3 {
            side.insert((tri[k], tri[(k + 1) % 3]), (3 * t + k, 3 * t + (k + 1) % 3));
        }
    }
    for (&(a, b), &(from, to)) in &side {
        if let Some(&(back, forth)) = side.get(&(b, a)) {
            join(&mut root, from, forth);
            join(&mut root, to, back);
        }
    }
    let mut number: BTreeMap<usize, u32> = BTreeMap::new();
    let mut corners = Vec::new();
    let mut of = |k: usize, v: u32| {
        *number.entry(find(&mut root, k)).or_insert_with(|| {
            corners.push(v);
            corners.len() as u32 - 1
        })
    };
    let rings =
        triangles.iter().enumerate().map(|(t, tri)| [0, 1, 2].map(|k| of(3 * t + k, tri[k]))).collect();
    (rings, corners)
}

fn join(root: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(root, a), find(root, b));
    root[a.max(b)] = a.min(b);
}

fn find(root: &mut [usize], mut k: usize) -> usize {
    while root[k] != k {
        root[k] = root[root[k]];
        k = root[k];
    }
    k
}

/// Facets in sets that hang together and cover no place twice in projection on x-y.
fn patches(turned: &Mesh, triangles: &[[u32; 3]], facets: &[u32]) -> Vec<Vec<u32>> {
    let apart = overlapping(turned, facets);
    let beside = neighbours(triangles, facets);
    let mut free: BTreeSet<u32> = (0..facets.len() as u32).collect();
    let mut all = Vec::new();
    while let Some(&first) = free.first() {
        let mut taken = BTreeSet::from([first]);
        let mut next = VecDeque::from([first]);
        free.remove(&first);
        while let Some(f) = next.pop_front() {
            for &g in &beside[f as usize] {
                if free.contains(&g) && apart[g as usize].iter().all(|h| !taken.contains(h)) {
                    free.remove(&g);
                    taken.insert(g);
                    next.push_back(g);
                }
            }
        }
        all.push(taken.into_iter().map(|f| facets[f as usize]).collect());
    }
    all
}

/// For each facet (by its place in `facets`) those that share an edge with it.
fn neighbours(triangles: &[[u32; 3]], facets: &[u32]) -> Vec<Vec<u32>> {
    let of = |f: &u32| triangles[*f as usize];
    let mut side: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for (k, f) in facets.iter().enumerate() {
        side.extend(edges(&of(f)).map(|e| (e, k as u32)));
    }
    facets
        .iter()
        .map(|f| edges(&of(f)).iter().filter_map(|(a, b)| side.get(&(*b, *a)).copied()).collect())
        .collect()
}

/// For each facet those that it shares area with in projection, beyond round-off.
fn overlapping(turned: &Mesh, facets: &[u32]) -> Vec<Vec<u32>> {
    let ring = |k: u32| {
        let mut p = turned.corners(facets[k as usize] as usize).map(flat).to_vec();
        if (p[1] - p[0]).perp_dot(p[2] - p[0]) < 0.0 {
            p.swap(1, 2);
        }
        p
    };
    let plane = Mesh {
        vertices: turned.vertices.iter().map(|v| v.with_z(0.0)).collect(),
        triangles: facets.iter().map(|&f| turned.triangles[f as usize]).collect(),
    };
    let (lo, hi) = plane.bounds();
    let thin = lo.abs().max(hi.abs()).max_element() * CLIP_ROUND_OFF;
    let around = |p: &[DVec2]| (0..3).map(|k| p[k].distance(p[(k + 1) % 3])).sum::<f64>();
    let tree = Bvh::new(&plane);
    let mut found = vec![Vec::new(); facets.len()];
    pairs((&plane, &tree), (&plane, &tree), &mut |s, t| {
        if s < t {
            let (p, q) = (ring(s), ring(t));
            let strip = thin * (around(&p) + around(&q));
            if shadow::area(&shadow::clip(p, q)) > strip {
                found[s as usize].push(t);
                found[t as usize].push(s);
            }
        }
    });
    found
}

/// Clipping puts a corner off by a few roundings of f64 of the coordinates: 16 of 2^-53 bound its dozen operations.
const CLIP_ROUND_OFF: f64 = 16.0 / 9_007_199_254_740_992.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::{cuboid, frustum};

    fn solid(m: &Mesh) -> Solid {
        Solid::of(m).unwrap()
    }

    #[test]
    fn a_table_hangs_down_in_one_body_for_each_height() {
        let low = solid(&cuboid(DVec3::ZERO, DVec3::new(4.0, 4.0, 1.0)));
        let table = low.with(&solid(&cuboid(DVec3::new(1.0, 1.0, 0.5), DVec3::new(2.0, 2.0, 3.0)))).mesh();
        let seen = Seen::along(&table, DVec3::Z, 1e-9);
        let up = seen.looking(Look::Up, |_| true);
        let hung = seen.hung_on(&up, To::Against(-1.0)).unwrap();
        assert_eq!(hung.len(), 2);
        assert!((Solid::all(hung).volume() - 34.0).abs() < 1e-9, "16 x 2 and 1 x 2 on it");
    }

    #[test]
    fn a_slanting_way_keeps_the_prism_of_its_projection() {
        let part = cuboid(DVec3::ZERO, DVec3::ONE);
        let d = DVec3::new(1.0, 2.0, 2.0) / 3.0;
        let seen = Seen::along(&part, d, 1e-9);
        let down = seen.looking(Look::Down, |_| true);
        let hung = Solid::all(seen.hung_on(&down, To::Along(5.0)).unwrap());
        // What is below the lid: the projected area 5/3 times the mean way from the lower faces.
        let faces: f64 =
            [d.x, d.y, d.z].iter().map(|c| c * (5.0 - (1.0 - c / 1.0 + d.element_sum() - 1.0) / 2.0)).sum();
        assert!((hung.volume() - faces).abs() < 1e-9, "{} {faces}", hung.volume());
    }

    /// A spiral ramp covers its place twice: it comes in two patches.
    #[test]
    fn what_winds_above_itself_comes_in_more_bodies() {
        let at = |k: i32, r: f64| (DVec2::from_angle(f64::from(k) * 0.5) * r).extend(f64::from(k) * 0.4);
        let vertices = (0..20).flat_map(|k| [at(k, 1.0), at(k, 3.0)]).collect();
        let triangles =
            (0..19u32).flat_map(|k| [[2 * k, 2 * k + 1, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 2]]);
        let ramp = Mesh { vertices, triangles: triangles.collect() };
        let seen = Seen::along(&ramp, DVec3::Z, 1e-9);
        let hung = seen.hung_on(&seen.looking(Look::Up, |_| true), To::Against(-1.0)).unwrap();
        assert_eq!(hung.len(), 2);
    }

    #[test]
    fn a_ring_hangs_around_its_hole() {
        let ring =
            solid(&frustum(DVec3::ZERO, 2.0, 3.0, 3.0)).minus(&solid(&frustum(-DVec3::Z, 4.0, 1.0, 1.0)));
        let mesh = ring.mesh();
        let seen = Seen::along(&mesh, DVec3::Z, 1e-9);
        let hung = seen.rooted(&seen.looking(Look::Up, |_| true), To::Along(4.0)).unwrap();
        assert_eq!(hung.len(), 1);
        let whole = Solid::all(hung).with(&ring);
        assert!((whole.volume() - 2.0 * ring.volume()).abs() < 1e-9, "{}", whole.volume());
    }
}
