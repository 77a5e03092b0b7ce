//! Takes dimensions, gives closed polyhedra: prisms, tubes, convex bodies cut by planes, unions of unit cubes.
//!
//! Not promised: that a prism's ring does not cross itself. Lengths in millimetres.

use glam::{DAffine3, DVec2, DVec3};
use std::collections::{BTreeMap, BTreeSet};

/// Polygons over shared points, counter-clockwise from outside; a polygon may be non-convex.
#[derive(Clone, Debug, Default)]
pub struct Poly {
    pub points: Vec<DVec3>,
    pub faces: Vec<Vec<usize>>,
}

impl Poly {
    pub fn moved(mut self, m: DAffine3) -> Poly {
        self.points.iter_mut().for_each(|p| *p = m.transform_point3(*p));
        self
    }

    /// Both as one part.
    pub fn with(mut self, other: Poly) -> Poly {
        let n = self.points.len();
        self.points.extend(other.points);
        self.faces.extend(other.faces.into_iter().map(|f| f.into_iter().map(|i| i + n).collect()));
        self
    }

    /// The same surface, each face of four corners or fewer cut at the middle of its first edge, alone: the neighbor
    /// across keeps its edge whole (a T-junction), and a triangle without area stands on the cut.
    pub fn with_tees(mut self) -> Poly {
        let faces = std::mem::take(&mut self.faces);
        for f in faces {
            if f.len() > 4 {
                self.faces.push(f);
                continue;
            }
            let m = self.points.len();
            self.points.push((self.points[f[0]] + self.points[f[1]]) / 2.0);
            self.faces.extend((1..f.len()).map(|k| vec![m, f[k], f[(k + 1) % f.len()]]));
            self.faces.push(vec![f[0], m, f[0]]);
        }
        self
    }

    /// The same polygons cut into triangles.
    pub fn triangles(&self) -> Vec<[usize; 3]> {
        self.faces.iter().flat_map(|f| ears(f, &self.points)).collect()
    }
}

fn ears(face: &[usize], points: &[DVec3]) -> Vec<[usize; 3]> {
    let n: DVec3 = {
        let o = points[face[0]];
        face.windows(2).map(|w| (points[w[0]] - o).cross(points[w[1]] - o)).sum()
    };
    let turn = |a: usize, b: usize, c: usize| {
        (points[b] - points[a]).cross(points[c] - points[a]).dot(n) / n.length()
    };
    let (mut ring, mut out) = (face.to_vec(), Vec::new());
    while ring.len() > 3 {
        let m = ring.len();
        let ear = |k: &usize| {
            let [a, b, c] = [ring[(k + m - 1) % m], ring[*k], ring[(k + 1) % m]];
            let inside = |p: usize| {
                ![a, b, c].contains(&p)
                    && turn(a, b, p) >= -1e-9
                    && turn(b, c, p) >= -1e-9
                    && turn(c, a, p) >= -1e-9
            };
            turn(a, b, c) > 1e-9 && !ring.iter().any(|&p| inside(p))
        };
        let k = (0..m).find(ear).expect("a ring that does not cross itself has an ear");
        out.push([ring[(k + m - 1) % m], ring[k], ring[(k + 1) % m]]);
        ring.remove(k);
    }
    out.push([ring[0], ring[1], ring[2]]);
    out
}

/// A prism over a counter-clockwise ring, from z = lo to z = hi.
pub fn prism(ring: &[[f64; 2]], lo: f64, hi: f64) -> Poly {
    let n = ring.len();
    let at = |z: f64| ring.iter().map(move |p| DVec3::new(p[0], p[1], z));
    let mut faces = vec![(0..n).rev().collect(), (n..2 * n).collect()];
    faces.extend((0..n).map(|k| vec![k, (k + 1) % n, n + (k + 1) % n, n + k]));
    Poly { points: at(lo).chain(at(hi)).collect(), faces }
}

pub fn block(lo: [f64; 3], hi: [f64; 3]) -> Poly {
    prism(&[[lo[0], lo[1]], [hi[0], lo[1]], [hi[0], hi[1]], [lo[0], hi[1]]], lo[2], hi[2])
}

/// A prism with a hole: both rings counter-clockwise, corner k of one beside corner k of the other.
pub fn tube(outer: &[[f64; 2]], inner: &[[f64; 2]], lo: f64, hi: f64) -> Poly {
    let n = outer.len();
    let at = |ring: &[[f64; 2]], z: f64| ring.iter().map(|p| DVec3::new(p[0], p[1], z)).collect::<Vec<_>>();
    let points = [at(outer, lo), at(outer, hi), at(inner, lo), at(inner, hi)].concat();
    let faces = (0..n).flat_map(|k| {
        let j = (k + 1) % n;
        let [a, b, c, d] = [0, n, 2 * n, 3 * n];
        [
            vec![a + k, a + j, b + j, b + k],
            vec![c + j, c + k, d + k, d + j],
            vec![b + k, b + j, d + j, d + k],
            vec![a + j, a + k, c + k, c + j],
        ]
    });
    Poly { points, faces: faces.collect() }
}

/// A regular polygon with its corners at radius r, the first one at angle `start` (radians).
pub fn ngon(n: usize, r: f64, start: f64) -> Vec<[f64; 2]> {
    let angle = |k: usize| start + std::f64::consts::TAU * k as f64 / n as f64;
    (0..n).map(|k| [r * angle(k).cos(), r * angle(k).sin()]).collect()
}

/// The convex body of all x with n . x <= d: corners where three planes meet. Coordinates of a few tens.
pub fn convex(planes: &[(DVec3, f64)]) -> Poly {
    const SAME: f64 = 1e-9; // far above round-off of such coordinates, far below any edge made here
    let mut points: Vec<DVec3> = Vec::new();
    for i in 0..planes.len() {
        for j in 0..i {
            for k in 0..j {
                let [(a, d), (b, e), (c, f)] = [planes[i], planes[j], planes[k]];
                let det = a.dot(b.cross(c));
                if det.abs() < SAME {
                    continue;
                }
                let p = (b.cross(c) * d + c.cross(a) * e + a.cross(b) * f) / det;
                let inside = planes.iter().all(|&(n, d)| n.dot(p) <= d + SAME);
                if inside && points.iter().all(|q| q.distance(p) > SAME) {
                    points.push(p);
                }
            }
        }
    }
    let faces = planes.iter().filter_map(|&(n, d)| {
        let mut on: Vec<usize> = (0..points.len()).filter(|&k| (n.dot(points[k]) - d).abs() < SAME).collect();
        let middle = on.iter().map(|&k| points[k]).sum::<DVec3>() / on.len() as f64;
        let (u, v) = n.normalize().any_orthonormal_pair();
        let angle =
            |k: usize| DVec2::new((points[k] - middle).dot(u), (points[k] - middle).dot(v)).to_angle();
        on.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)));
        (on.len() > 2).then(|| outward(on, &points, n))
    });
    Poly { faces: faces.collect(), points }
}

fn outward(mut ring: Vec<usize>, points: &[DVec3], n: DVec3) -> Vec<usize> {
    let [a, b, c] = [points[ring[0]], points[ring[1]], points[ring[2]]];
    if (b - a).cross(c - a).dot(n) < 0.0 {
        ring.reverse();
    }
    ring
}

/// The union of cubes with edges of `size`, each given by its least corner; one square for each free side.
pub fn voxels(cells: impl IntoIterator<Item = [i32; 3]>, size: f64) -> Poly {
    let cells: BTreeSet<[i32; 3]> = cells.into_iter().collect();
    let mut index: BTreeMap<[i32; 3], usize> = BTreeMap::new();
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for cell in &cells {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut beside = *cell;
                beside[axis] += 2 * side - 1;
                if cells.contains(&beside) {
                    continue;
                }
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut square = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[a, b]| {
                    let mut p = *cell;
                    p[axis] += side;
                    p[u] += a;
                    p[v] += b;
                    *index.entry(p).or_insert_with(|| {
                        points.push(DVec3::from_array(p.map(f64::from)) * size);
                        points.len() - 1
                    })
                });
                if side == 0 {
                    square.reverse();
                }
                faces.push(square.to_vec());
            }
        }
    }
    Poly { points, faces }
}

/// The cells of a box, from lo up to but not including hi.
pub fn cells(lo: [i32; 3], hi: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    (lo[0]..hi[0]).flat_map(move |x| (lo[1]..hi[1]).flat_map(move |y| (lo[2]..hi[2]).map(move |z| [x, y, z])))
}
