//! Takes some parts of an assembly, gives their cells for a search over poses: where each is, what lies between two.
//!
//! Nothing here decides anything. A pose is told as the motion from the part's place in the assembly.

use crate::assembly::{Assembly, PartIx};
use glam::{DAffine3, DVec3};
use std::collections::BTreeSet;

/// A convex cell at the part's place in the assembly.
#[derive(Clone, Debug)]
pub struct Body {
    pub vertices: Vec<DVec3>,
    /// Inside is `n . x <= d`.
    pub planes: Vec<(DVec3, f64)>,
    /// Unit vectors along its edges, each direction once.
    pub edges: Vec<DVec3>,
    pub centre: DVec3,
    /// Of a ball around the centre that holds the cell.
    pub radius: f64,
}

/// The parts of a set.
#[derive(Clone, Debug)]
pub struct Bodies {
    pub parts: Vec<PartIx>,
    pub cells: Vec<Vec<Body>>,
    /// Middle of each part's box.
    pub centre: Vec<DVec3>,
    /// Half the diagonal of each part's box: the length that makes its turns comparable with its shifts.
    pub lever: Vec<f64>,
    /// Which parts may not move: those held, or else the first of the largest.
    pub fixed: Vec<bool>,
}

/// One pose for each part of the set.
pub type Poses = Vec<DAffine3>;

impl Bodies {
    pub fn of(asm: &Assembly, parts: &[PartIx]) -> Bodies {
        let cells: Vec<Vec<Body>> =
            parts.iter().map(|&p| asm.cells(p).into_iter().map(body).collect()).collect();
        let boxes: Vec<(DVec3, DVec3)> = cells
            .iter()
            .map(|cells| crate::blocking::bounds(cells.iter().flat_map(|c| c.vertices.iter().copied())))
            .collect();
        let volume: Vec<f64> = parts.iter().map(|&p| asm.solid(p).volume()).collect();
        let mut fixed: Vec<bool> = parts.iter().map(|&p| asm.held().any(|h| h == p)).collect();
        if !fixed.contains(&true) {
            let largest = (0..parts.len()).max_by(|&a, &b| volume[a].total_cmp(&volume[b]).then(b.cmp(&a)));
            largest.into_iter().for_each(|k| fixed[k] = true);
        }
        Bodies {
            parts: parts.to_vec(),
            centre: boxes.iter().map(|(lo, hi)| (*lo + *hi) / 2.0).collect(),
            lever: boxes.iter().map(|(lo, hi)| (*hi - *lo).length() / 2.0).collect(),
            cells,
            fixed,
        }
    }

    pub fn home(&self) -> Poses {
        vec![DAffine3::IDENTITY; self.parts.len()]
    }

    /// The part's cells in its pose.
    pub fn placed(&self, part: usize, pose: &DAffine3) -> Vec<Body> {
        self.cells[part].iter().map(|c| c.moved(pose)).collect()
    }

    /// The same parts, of which only these places may move.
    pub fn moving(&self, places: &BTreeSet<usize>) -> Bodies {
        let fixed = (0..self.parts.len()).map(|k| self.fixed[k] || !places.contains(&k)).collect();
        Bodies { fixed, ..self.clone() }
    }

    pub fn movable(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.parts.len()).filter(|&k| !self.fixed[k])
    }
}

impl Body {
    pub fn moved(&self, pose: &DAffine3) -> Body {
        let turned = |n: &DVec3| pose.transform_vector3(*n);
        Body {
            vertices: self.vertices.iter().map(|&v| pose.transform_point3(v)).collect(),
            planes: self
                .planes
                .iter()
                .map(|(n, d)| {
                    let m = turned(n);
                    (m, d + m.dot(pose.translation))
                })
                .collect(),
            edges: self.edges.iter().map(turned).collect(),
            centre: pose.transform_point3(self.centre),
            radius: self.radius,
        }
    }

    /// Least of `n . v` over the corners.
    pub fn low(&self, n: DVec3) -> f64 {
        self.vertices.iter().map(|v| n.dot(*v)).fold(f64::INFINITY, f64::min)
    }

    /// The corner farthest along `n`.
    pub fn far(&self, n: DVec3) -> DVec3 {
        let far = self.vertices.iter().max_by(|a, b| n.dot(**a).total_cmp(&n.dot(**b)));
        far.copied().unwrap_or_default()
    }
}

fn body(cell: crate::solid::Cell) -> Body {
    /// Two edges whose directions differ by less (sine squared) are parallel: a cross product of them has no use.
    const PARALLEL: f64 = 1e-12;
    let mut edges: Vec<DVec3> = Vec::new();
    for f in &cell.facets {
        for (k, &a) in f.iter().enumerate() {
            let b = f[(k + 1) % f.len()];
            let e = (cell.vertices[b as usize] - cell.vertices[a as usize]).normalize_or_zero();
            if e != DVec3::ZERO && edges.iter().all(|o| o.cross(e).length_squared() > PARALLEL) {
                edges.push(e);
            }
        }
    }
    let centre = cell.vertices.iter().sum::<DVec3>() / cell.vertices.len().max(1) as f64;
    let radius = cell.vertices.iter().map(|v| v.distance(centre)).fold(0.0, f64::max);
    Body { vertices: cell.vertices, planes: cell.planes, edges, centre, radius }
}

/// What a plane between two cells is fixed to by nature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    First,
    Second,
}

/// A plane between two cells.
#[derive(Clone, Copy, Debug)]
pub struct Between {
    /// Unit, from the first cell to the second.
    pub normal: DVec3,
    /// How far the second lies beyond the first; negative: they overlap by as much along the normal.
    pub gap: f64,
    pub owner: Owner,
}

/// The face that keeps the cells farthest apart; where faces do not part them, also the planes along an edge of each.
pub fn between(x: &Body, y: &Body, touch: f64) -> Between {
    let of_x = x.planes.iter().map(|&(n, d)| Between { normal: n, gap: y.low(n) - d, owner: Owner::First });
    let of_y = y.planes.iter().map(|&(n, d)| Between { normal: -n, gap: x.low(n) - d, owner: Owner::Second });
    let none = Between { normal: DVec3::Z, gap: f64::NEG_INFINITY, owner: Owner::First };
    let best = of_x.chain(of_y).fold(none, |best, b| if b.gap > best.gap { b } else { best });
    if best.gap >= -touch { best } else { by_edges(x, y, best) }
}

fn by_edges(x: &Body, y: &Body, mut best: Between) -> Between {
    for e in &x.edges {
        for n in y.edges.iter().filter_map(|f| e.cross(*f).try_normalize()) {
            for normal in [n, -n] {
                let gap = y.low(normal) + x.low(-normal);
                if gap > best.gap {
                    best = Between { normal, gap, owner: Owner::First };
                }
            }
        }
    }
    best
}
