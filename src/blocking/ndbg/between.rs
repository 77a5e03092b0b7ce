//! Takes two parts, gives the directions along which the first runs into the second: a union of open convex cones, and
//! the edges of that union, which are the critical arcs of the pair.
//!
//! Cones from patches are of first order; cones from cells are for the whole way. Exact to the [`Resolution`] (see
//! `union`); the second runs into the first along the opposite directions.

use super::arrangement::{Critical, Piece};
use super::caps::{Ball, Cap};
use super::circles::{Circle, Circles, Resolution};
use super::union::{Bounded, Edge, Union};
use crate::assembly::PartIx;
use crate::blocking::Touch;
use crate::blocking::cone::polar;
use crate::blocking::sector::{Blocked, sectors};
use crate::blocking::shadow::{Convex, Shapes};
use glam::DVec3;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Which parts, which cones block the first from moving through the second, and where their union ends.
#[derive(Clone, Debug)]
pub struct Between {
    pub a: PartIx,
    pub b: PartIx,
    pub cones: Vec<Bounded>,
    pub edges: Vec<Edge>,
    pub everywhere: Everywhere,
}

/// Whether any direction is free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Everywhere {
    Blocked,
    NotBlocked,
}

/// What patches alone say of a pair, before the union's edges are known.
#[derive(Clone, Debug)]
pub struct Start {
    pub a: PartIx,
    pub b: PartIx,
    /// Unit normals from `a` to `b`, each once.
    normals: Vec<DVec3>,
    resolution: Resolution,
}

impl Start {
    /// From the unit normals of the pair's patches, from `a` to `b`.
    pub fn new(a: PartIx, b: PartIx, normals: &[DVec3], resolution: Resolution) -> Start {
        let mut seen = BTreeSet::new();
        let distinct = normals.iter().filter(|n| seen.insert(n.to_array().map(f64::to_bits)));
        Start { a, b, normals: distinct.copied().collect(), resolution }
    }

    pub fn normals(&self) -> &[DVec3] {
        &self.normals
    }

    /// Blocked at the very start. None when the work runs out first.
    pub fn at_the_start(&self, work: &Work) -> Option<Between> {
        let union = self.by_patches();
        work.spend(union.steps)?;
        Some(self.between(&union))
    }

    /// Blocked on the whole way: the cells of the two are in each other's way, too. Cells that are near come first. None
    /// when the work runs out first.
    pub fn on_the_way(&self, shapes: &Shapes, touch: Touch, work: &Work) -> Option<Between> {
        let mut union = self.by_patches();
        // What may be free at all, as caps: a cone that meets none of it adds nothing.
        let free = sectors(&polar(self.normals.iter().copied()));
        let free: Vec<Cap> = free.iter().map(|s| Cap::reaching(s.middle(), s.corners())).collect();
        let ((cells_a, at_a), (cells_b, at_b)) = (shapes.part(self.a), shapes.part(self.b));
        let step = at_b - at_a;
        for (cap, i, j) in by_width(cells_a, cells_b, step) {
            let (a, b) = (&cells_a[i], &cells_b[j]);
            let before = union.steps;
            if free.iter().any(|f| f.meets(&cap)) && !union.holds_all_ways(a, b, step) {
                work.spend(a.vertices.len() * b.vertices.len())?;
                let cone = Bounded::new(Blocked::by_cells(a, b, step, touch.depth()), self.resolution);
                cone.into_iter().for_each(|cone| union.add(cone));
            }
            work.spend(free.len() + union.steps - before)?;
        }
        Some(self.between(&union))
    }

    fn by_patches(&self) -> Union {
        let mut union = Union::new(self.resolution);
        let cones = self.normals.iter().filter_map(|&n| Bounded::new(Blocked::by_patch(n), self.resolution));
        cones.for_each(|cone| union.add(cone));
        union
    }

    fn between(&self, union: &Union) -> Between {
        let closed = polar(self.normals.iter().copied()).is_zero();
        let edges = if closed { Vec::new() } else { union.edges() };
        let cones = union.cones().to_vec();
        // Without an edge it is all of the sphere or nothing.
        let blocked = closed || (edges.is_empty() && !cones.is_empty());
        let everywhere = if blocked { Everywhere::Blocked } else { Everywhere::NotBlocked };
        Between { a: self.a, b: self.b, cones, edges, everywhere }
    }
}

/// All pairs of cells, those that are in each other's way along the most directions first.
fn by_width(a: &[Convex], b: &[Convex], step: DVec3) -> Vec<(Cap, usize, usize)> {
    let balls = |cells: &[Convex]| cells.iter().map(Ball::around).collect::<Vec<_>>();
    let (balls_a, balls_b) = (balls(a), balls(b));
    let all = (0..a.len()).flat_map(|i| (0..b.len()).map(move |j| (i, j)));
    let mut caps: Vec<(Cap, usize, usize)> =
        all.map(|(i, j)| (balls_a[i].toward(&balls_b[j], step), i, j)).collect();
    caps.sort_by(|x, y| y.0.angle.total_cmp(&x.0.angle).then((x.1, x.2).cmp(&(y.1, y.2))));
    caps
}

/// Steps that may still be taken: a free sector looked at, or a difference between two corners. Shared among threads;
/// whether it runs out depends on their sum alone, so not on their order.
pub struct Work(AtomicUsize);

impl Work {
    pub fn new(most: usize) -> Work {
        Work(AtomicUsize::new(most))
    }

    /// None when fewer are left.
    fn spend(&self, steps: usize) -> Option<()> {
        let less = |left: usize| left.checked_sub(steps);
        let spent = self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, less);
        spent.is_ok().then_some(())
    }
}

/// A facet of a blocking cone: its unit normal, and the number of its circle.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    pub normal: DVec3,
    pub circle: Circle,
}

/// A direction, and what it lies on by construction, so that no sign there is taken from round-off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    pub d: DVec3,
    pub on: On,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum On {
    /// No critical circle.
    Nothing,
    Circle(Circle),
    /// A crossing, or the end of an arc: on every circle as near as the resolution tells.
    Crossing,
}

impl Place {
    fn opposite(self) -> Place {
        Place { d: -self.d, on: self.on }
    }

    fn inside(self, f: &Facet, near: f64) -> bool {
        let height = f.normal.dot(self.d);
        match self.on {
            On::Nothing => height > 0.0,
            On::Circle(c) => f.circle != c && height > 0.0,
            On::Crossing => height > near,
        }
    }
}

/// The cones of a pair with their circles numbered.
#[derive(Clone, Debug)]
pub struct Numbered {
    pub a: PartIx,
    pub b: PartIx,
    cones: Vec<(Cap, Vec<Facet>)>,
    everywhere: Everywhere,
    near: f64,
}

impl Numbered {
    pub fn new(between: &Between, circles: &mut Circles) -> Numbered {
        let mut facet = |&normal: &DVec3| Facet { normal, circle: circles.number(normal) };
        let cones = between.cones.iter().map(|c| (c.cap, c.normals.iter().map(&mut facet).collect()));
        let (cones, near) = (cones.collect(), circles.resolution().near());
        Numbered { a: between.a, b: between.b, cones, everywhere: between.everywhere, near }
    }

    /// Whether `a` runs into `b`, and whether `b` runs into `a`, when it moves along the direction.
    pub fn stops(&self, place: Place) -> [bool; 2] {
        let held = |p: Place| {
            let near = self.cones.iter().filter(|(cap, _)| cap.may_hold(p.d));
            near.map(|(_, facets)| facets).any(|facets| facets.iter().all(|f| p.inside(f, self.near)))
        };
        [place, place.opposite()].map(|p| self.everywhere == Everywhere::Blocked || held(p))
    }
}

/// Where the pair's blocking changes, either way: the edges of the union and their opposites.
pub fn critical(between: &Between, circles: &mut Circles) -> Critical {
    let mut found = Critical::default();
    for edge in &between.edges {
        if edge.from == edge.to {
            found.points.push(edge.from);
        } else {
            let c = circles.number(edge.normal);
            found.arcs.entry(c).or_default().push(Piece::between(circles, c, edge.from, edge.to));
        }
    }
    found.with_opposites()
}
