//! Takes triangles over shared vertices; gives volume, area, bounds, and whether they close.
//!
//! Not promised: that the surface does not cross itself (see `cross`).

use glam::DVec3;
use std::collections::BTreeMap;

/// An indexed triangle mesh, counter-clockwise from outside, in mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

/// Whether each edge lies between exactly two opposite triangles.
#[derive(Clone, Debug, PartialEq)]
pub enum Closure {
    Closed,
    /// The number of edges that do not, and the start of one of them.
    Open {
        edges: usize,
        at: DVec3,
    },
}

/// Counts that tell one closed surface from another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Topology {
    /// Connected pieces of surface.
    pub bodies: usize,
    /// Sum of the handles of all bodies; negative where a vertex pinches two sheets together.
    pub genus: i64,
}

impl Mesh {
    pub fn corners(&self, t: usize) -> [DVec3; 3] {
        self.triangles[t].map(|v| self.vertices[v as usize])
    }

    /// Signed volume in mm3; positive when the triangles face outward. Taken about the middle of the bounding box,
    /// so that a part far from the origin loses no digits.
    pub fn volume(&self) -> f64 {
        let (lo, hi) = self.bounds();
        let o = (lo + hi) / 2.0;
        let six = |t| {
            let [a, b, c] = self.corners(t).map(|p| p - o);
            a.dot(b.cross(c))
        };
        (0..self.triangles.len()).map(six).sum::<f64>() / 6.0
    }

    /// Area in mm2.
    pub fn area(&self) -> f64 {
        (0..self.triangles.len()).map(|t| area(self.corners(t))).sum()
    }

    pub fn bounds(&self) -> (DVec3, DVec3) {
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        self.vertices.iter().fold(start, |(lo, hi), v| (lo.min(*v), hi.max(*v)))
    }

    pub fn closure(&self) -> Closure {
        let open = self.loose_edges();
        match open.first() {
            None => Closure::Closed,
            Some(&(v, _)) => Closure::Open { edges: open.len(), at: self.vertices[v as usize] },
        }
    }

    /// Edges that are not between two opposite triangles, each by its lower and its higher vertex.
    pub fn loose_edges(&self) -> Vec<(u32, u32)> {
        let mut uses: BTreeMap<(u32, u32), (u32, u32)> = BTreeMap::new();
        for t in &self.triangles {
            for k in 0..3 {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                let entry = uses.entry((a.min(b), a.max(b))).or_default();
                if a < b { entry.0 += 1 } else { entry.1 += 1 }
            }
        }
        uses.into_iter().filter(|(_, n)| *n != (1, 1)).map(|(e, _)| e).collect()
    }

    /// Whether every edge is used as often in one direction as in the other, and some more than once: sheets that touch
    /// in an edge.
    pub fn is_pinched(&self) -> bool {
        let mut uses: BTreeMap<(u32, u32), i64> = BTreeMap::new();
        let sides = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
        self.triangles.iter().flat_map(sides).for_each(|e| *uses.entry(e).or_default() += 1);
        let balanced = uses.iter().all(|((a, b), n)| uses.get(&(*b, *a)) == Some(n));
        balanced && uses.values().any(|n| *n > 1)
    }

    /// Bodies and genus of a closed mesh (V - E + F = 2 bodies - 2 genus, with E = 3F / 2).
    pub fn topology(&self) -> Topology {
        let mut root: Vec<usize> = (0..self.vertices.len()).collect();
        for t in &self.triangles {
            let a = find(&mut root, t[0] as usize);
            for v in &t[1..] {
                let b = find(&mut root, *v as usize);
                root[b] = a;
            }
        }
        let mut used = vec![false; root.len()];
        self.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
        let bodies = (0..root.len()).filter(|&v| used[v] && find(&mut root, v) == v).count();
        let (v, f) = (used.iter().filter(|u| **u).count() as i64, self.triangles.len() as i64);
        Topology { bodies, genus: bodies as i64 - (v - f / 2) / 2 }
    }

    /// Signed volume of each connected piece of surface, mm3, in the order of their first triangles: positive around
    /// material, negative around a hollow.
    pub fn shells(&self) -> Vec<f64> {
        let mut root: Vec<usize> = (0..self.vertices.len()).collect();
        for t in &self.triangles {
            for v in &t[1..] {
                let (a, b) = (find(&mut root, t[0] as usize), find(&mut root, *v as usize));
                root[b] = a;
            }
        }
        let (lo, hi) = self.bounds();
        let o = (lo + hi) / 2.0;
        let mut number: BTreeMap<usize, usize> = BTreeMap::new();
        let mut volumes: Vec<f64> = Vec::new();
        for (t, tri) in self.triangles.iter().enumerate() {
            let k = *number.entry(find(&mut root, tri[0] as usize)).or_insert_with(|| {
                volumes.push(0.0);
                volumes.len() - 1
            });
            let [a, b, c] = self.corners(t).map(|p| p - o);
            volumes[k] += a.dot(b.cross(c)) / 6.0;
        }
        volumes
    }

    /// The same mesh with every vertex moved.
    pub fn map(&self, f: impl Fn(DVec3) -> DVec3) -> Mesh {
        Mesh { vertices: self.vertices.iter().map(|&v| f(v)).collect(), triangles: self.triangles.clone() }
    }
}

/// Area of a triangle in mm2.
pub fn area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).length() / 2.0
}

fn find(root: &mut [usize], mut v: usize) -> usize {
    while root[v] != v {
        root[v] = root[root[v]];
        v = root[v];
    }
    v
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub fn cuboid(lo: DVec3, hi: DVec3) -> Mesh {
        let corner = |k: usize| {
            DVec3::from_array(std::array::from_fn(|a| if k >> a & 1 == 1 { hi[a] } else { lo[a] }))
        };
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        Mesh {
            vertices: (0..8).map(corner).collect(),
            triangles: quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect(),
        }
    }

    #[test]
    fn a_box_is_closed_has_its_volume_and_one_body() {
        let m = cuboid(DVec3::splat(1e3), DVec3::splat(1e3) + DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(m.closure(), Closure::Closed);
        assert_eq!(m.topology(), Topology { bodies: 1, genus: 0 });
        assert!((m.volume() - 6.0).abs() < 1e-9 && (m.area() - 22.0).abs() < 1e-9);
    }

    #[test]
    fn a_hollow_box_is_one_solid_with_a_hollow() {
        let mut m = cuboid(DVec3::ZERO, DVec3::splat(3.0));
        let inner = cuboid(DVec3::ONE, DVec3::splat(2.0));
        m.vertices.extend(&inner.vertices);
        m.triangles.extend(inner.triangles.iter().map(|t| [t[0] + 8, t[2] + 8, t[1] + 8]));
        let shells = m.shells();
        assert!((shells[0] - 27.0).abs() < 1e-12 && (shells[1] + 1.0).abs() < 1e-12, "{shells:?}");
    }

    #[test]
    fn a_box_that_lacks_a_triangle_is_open() {
        let mut m = cuboid(DVec3::ZERO, DVec3::ONE);
        m.triangles.pop();
        assert!(matches!(m.closure(), Closure::Open { edges: 3, .. }));
    }
}
