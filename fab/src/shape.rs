//! Takes closed solids in mm with a role for each facet; gives them checked, or every fault that they have.
//!
//! Not promised: that neighbours really touch, or that a solid does not cross itself (the made one is tested for it).

use crate::ears::triangulate;
use crate::mesh::Mesh;
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;
use std::fmt;

/// A closed polyhedron in mm, in a frame of its own; congruent parts share one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shape {
    pub vertices: Vec<DVec3>,
    pub facets: Vec<Facet>,
}

/// A simple polygon, counter-clockwise seen from outside; one that is not planar is cut into triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// Indices into [`Shape::vertices`].
    pub corners: Vec<u32>,
    /// Unit, outward. Trusted more than the corners: a facet may be smaller than the round-off of its own normal.
    pub normal: DVec3,
}

/// What lies on the other side of a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Another part of the job (its index in [`Job::parts`]): air is left here.
    Contact { with: usize },
    /// Nothing: the facet stays where it is.
    Outer,
}

/// A shape put in its place in the assembly.
#[derive(Clone, Debug)]
pub struct PlacedPart {
    pub id: String,
    /// Index into [`Job::shapes`].
    pub shape: usize,
    /// Rigid motion from the shape's frame to the assembly's, in mm.
    pub pose: DAffine3,
    /// One for each facet of the shape.
    pub roles: Vec<Role>,
}

/// What is to be made: shapes, and where each part stands in the finished assembly.
#[derive(Clone, Debug, Default)]
pub struct Job {
    pub name: String,
    pub shapes: Vec<Shape>,
    pub parts: Vec<PlacedPart>,
}

/// One thing wrong with a job, and where.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Fault {
    /// `part weft-0`, `shape 3, facet 17`, ...
    pub place: String,
    pub what: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.what)
    }
}

/// Largest coordinate that is accepted, in mm: a kilometre. Beyond it the f32 of an STL steps by more than 0.06 mm.
const LARGEST_COORDINATE: f64 = 1e6;

/// How far a unit normal may be from length 1, and a pose's axes from orthonormal: far above the round-off of a dozen
/// products in f64 (1e-15), far below any angle that matters in a workshop.
const UNIT_ROUND_OFF: f64 = 1e-9;

/// How far a corner of a planar facet may stand off its plane, relative to the solid's size. Voronoi vertices are solved from
/// planes and carry a conditioning of up to about 1e6 over f64's 1e-16.
pub const PLANE_ROUND_OFF: f64 = 1e-9;

fn within_reach(v: DVec3) -> bool {
    v.is_finite() && v.abs().max_element() <= LARGEST_COORDINATE
}

impl Shape {
    /// A closed mesh, each triangle a facet. One without area has a normal of no meaning.
    pub fn of(mesh: &Mesh) -> Shape {
        let facet = |t: usize| {
            let [a, b, c] = mesh.corners(t);
            let normal = (b - a).cross(c - a).try_normalize().unwrap_or(DVec3::Z);
            Facet { corners: mesh.triangles[t].to_vec(), normal }
        };
        Shape { vertices: mesh.vertices.clone(), facets: (0..mesh.triangles.len()).map(facet).collect() }
    }

    /// Its facets as triangles.
    pub fn mesh(&self) -> Mesh {
        let triangles = self.facets.iter().flat_map(|f| triangulate(&self.vertices, f)).collect();
        Mesh { vertices: self.vertices.clone(), triangles }
    }

    /// Largest extent of the bounding box, in mm.
    pub fn size(&self) -> f64 {
        let (lo, hi) = self.bounds();
        (hi - lo).max_element().max(0.0)
    }

    /// Lowest and highest corner of the bounding box, in mm.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        self.vertices.iter().fold(start, |(lo, hi), v| (lo.min(*v), hi.max(*v)))
    }

    /// Signed volume in mm3; positive when the facets face outward.
    pub fn volume(&self) -> f64 {
        let (lo, hi) = self.bounds();
        let (o, point) = ((lo + hi) / 2.0, |c: u32| self.vertices[c as usize]);
        let cone = |f: &Facet| {
            let from = point(f.corners[0]);
            let fan =
                f.corners[1..].windows(2).map(|w| (from - o).dot((point(w[0]) - o).cross(point(w[1]) - o)));
            fan.sum::<f64>() / 6.0
        };
        self.facets.iter().map(cone).sum()
    }

    /// Area of a facet in mm2.
    pub fn facet_area(&self, f: usize) -> f64 {
        let Facet { corners, normal } = &self.facets[f];
        let point = |c: u32| self.vertices[c as usize];
        let from = point(corners[0]);
        corners[1..]
            .windows(2)
            .map(|w| (point(w[0]) - from).cross(point(w[1]) - from))
            .sum::<DVec3>()
            .dot(*normal)
            / 2.0
    }

    /// The same solid with facets that are not planar cut into triangles, and for each new facet the old one.
    pub fn planar(&self) -> (Shape, Vec<usize>) {
        let (mut facets, mut from) = (vec![], vec![]);
        let off = PLANE_ROUND_OFF * self.size();
        for (k, f) in self.facets.iter().enumerate() {
            let parts = if self.is_planar(f, off) { vec![f.clone()] } else { self.cut(f) };
            from.extend(parts.iter().map(|_| k));
            facets.extend(parts);
        }
        (Shape { vertices: self.vertices.clone(), facets }, from)
    }

    fn is_planar(&self, f: &Facet, off: f64) -> bool {
        let heights = f.corners.iter().map(|&c| f.normal.dot(self.vertices[c as usize]));
        let (lo, hi) = heights.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        hi - lo <= off
    }

    fn cut(&self, f: &Facet) -> Vec<Facet> {
        let facet = |t: [u32; 3]| {
            let [a, b, c] = t.map(|v| self.vertices[v as usize]);
            Facet { corners: t.to_vec(), normal: (b - a).cross(c - a).try_normalize().unwrap_or(f.normal) }
        };
        triangulate(&self.vertices, f).into_iter().map(facet).collect()
    }

    fn faults(&self, at: &str) -> Vec<Fault> {
        let fault = |what: String| Fault { place: at.to_string(), what };
        if self.facets.len() < 4 {
            return vec![fault(format!("{} facets do not enclose a volume", self.facets.len()))];
        }
        if let Some(v) = self.vertices.iter().position(|v| !within_reach(*v)) {
            return vec![fault(format!("vertex {v} is not a finite point within {LARGEST_COORDINATE} mm"))];
        }
        let size = self.size();
        let mut faults: Vec<Fault> =
            (0..self.facets.len()).filter_map(|f| self.facet_fault(f, size, at)).collect();
        if faults.is_empty() {
            faults.extend(self.open_edge().map(fault));
        }
        if faults.is_empty() && self.volume() <= 0.0 {
            faults.push(fault("is inside out: its volume is not positive".into()));
        }
        faults
    }

    fn facet_fault(&self, f: usize, size: f64, at: &str) -> Option<Fault> {
        let Facet { corners, normal } = &self.facets[f];
        let what = if corners.len() < 3 {
            "has fewer than three corners".to_string()
        } else if let Some(c) = corners.iter().find(|&&c| c as usize >= self.vertices.len()) {
            format!("names vertex {c} of {}", self.vertices.len())
        } else if !normal.is_finite() || (normal.length() - 1.0).abs() > UNIT_ROUND_OFF {
            format!("has a normal of length {}", normal.length())
        } else if self.facet_area(f) < -PLANE_ROUND_OFF * size.powi(2) {
            "has its corners clockwise, seen against its normal".to_string()
        } else {
            return None;
        };
        Some(Fault { place: format!("{at}, facet {f}"), what })
    }

    /// An edge that is not shared by exactly two opposite facets.
    fn open_edge(&self) -> Option<String> {
        let mut uses: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for f in &self.facets {
            for (k, &a) in f.corners.iter().enumerate() {
                *uses.entry((a, f.corners[(k + 1) % f.corners.len()])).or_default() += 1;
            }
        }
        let (&(a, b), _) = uses.iter().find(|&(&(a, b), &n)| n != 1 || uses.get(&(b, a)) != Some(&1))?;
        let p = self.vertices[a as usize];
        Some(format!(
            "is not closed: edge {a}-{b} at ({:.3}, {:.3}, {:.3}) mm is not between exactly two opposite facets",
            p.x, p.y, p.z
        ))
    }
}

impl Job {
    /// Everything that is wrong with the job, in the order of shapes and parts; empty for a sound one.
    pub fn faults(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        if self.parts.is_empty() {
            faults.push(Fault { place: "job".into(), what: "has no parts".into() });
        }
        for (s, shape) in self.shapes.iter().enumerate() {
            faults.extend(shape.faults(&format!("shape {s}")));
        }
        let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
        for (p, part) in self.parts.iter().enumerate() {
            faults.extend(self.part_fault(p));
            if let Some(first) = seen.insert(&part.id, p) {
                let what = format!("parts {first} and {p} have the same id");
                faults.push(Fault { place: format!("part {}", part.id), what });
            }
        }
        faults
    }

    fn part_fault(&self, p: usize) -> Option<Fault> {
        let part = &self.parts[p];
        let m = part.pose.matrix3;
        let rigid = (m * m.transpose() - glam::DMat3::IDENTITY)
            .to_cols_array()
            .iter()
            .all(|x| x.abs() < UNIT_ROUND_OFF);
        let what = match self.shapes.get(part.shape) {
            None => format!("names shape {} of {}", part.shape, self.shapes.len()),
            Some(s) if s.facets.len() != part.roles.len() => {
                format!("has {} roles for {} facets", part.roles.len(), s.facets.len())
            }
            Some(_) if !rigid || m.determinant() <= 0.0 || !within_reach(part.pose.translation) => {
                "has a pose that is not a proper rigid motion".into()
            }
            Some(_) => self.role_fault(p)?,
        };
        Some(Fault { place: format!("part {}", part.id), what })
    }

    fn role_fault(&self, p: usize) -> Option<String> {
        self.parts[p].roles.iter().enumerate().find_map(|(f, role)| match *role {
            Role::Contact { with } if with == p => Some(format!("touches itself on facet {f}")),
            Role::Contact { with } if with >= self.parts.len() => {
                Some(format!("touches part {with} of {} on facet {f}", self.parts.len()))
            }
            _ => None,
        })
    }

    /// The same job with facets that are not planar cut into triangles, each with the role of its facet.
    pub fn planar(&self) -> Job {
        let cut: Vec<(Shape, Vec<usize>)> = self.shapes.iter().map(Shape::planar).collect();
        let part = |p: &PlacedPart| {
            let roles = cut[p.shape].1.iter().map(|&f| p.roles[f]).collect();
            PlacedPart { roles, ..p.clone() }
        };
        let parts = self.parts.iter().map(part).collect();
        Job { name: self.name.clone(), shapes: cut.iter().map(|c| c.0.clone()).collect(), parts }
    }

    /// Pairs of parts with a common contact facet, each once, in order.
    pub fn neighbours(&self) -> Vec<(usize, usize)> {
        let touching = |(p, part): (usize, &PlacedPart)| {
            let with = move |r: &Role| match *r {
                Role::Contact { with } => Some((p.min(with), p.max(with))),
                Role::Outer => None,
            };
            part.roles.iter().filter_map(with).collect::<Vec<_>>()
        };
        let all: std::collections::BTreeSet<_> = self.parts.iter().enumerate().flat_map(touching).collect();
        all.into_iter().collect()
    }
}
