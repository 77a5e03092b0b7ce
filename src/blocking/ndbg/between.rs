//! Takes two parts, gives the directions along which the first runs into the second: a union of open convex cones, and
//! the closed sectors that are left free, whose edges are the critical arcs of the pair.
//!
//! Cones from patches are of first order; cones from cells are for the whole way. Exact to [`SAME_ANGLE`] (see
//! `sector`); the second runs into the first along the opposite directions.

use super::arrangement::{Critical, Piece};
use super::circles::{Circle, Circles};
use crate::assembly::PartIx;
use crate::blocking::cone::polar;
use crate::blocking::sector::{Blocked, Keep, Sector, sectors};
use crate::blocking::shadow::{Convex, Shapes};
use crate::blocking::{SAME_ANGLE, Touch, bounds};
use glam::DVec3;
use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Which parts, which cones block the first from moving through the second, and what is free.
#[derive(Clone, Debug)]
pub struct Between {
    pub a: PartIx,
    pub b: PartIx,
    pub cones: Vec<Blocked>,
    pub free: Vec<Sector>,
}

impl Between {
    /// From the unit normals of the pair's patches, from `a` to `b`.
    pub fn touching(a: PartIx, b: PartIx, normals: &[DVec3]) -> Between {
        let free = sectors(&polar(normals.iter().copied()));
        let mut seen = BTreeSet::new();
        let distinct = normals.iter().filter(|n| seen.insert(n.to_array().map(f64::to_bits)));
        Between { a, b, cones: distinct.map(|&n| Blocked::by_patch(n)).collect(), free }
    }

    /// What is left free when the cells of the two are in each other's way, too. Cells that are near come first; cones that
    /// take nothing away from what those before left free are dropped. None when the work runs out first.
    pub fn with_cells(mut self, shapes: &Shapes, touch: Touch, work: &Work) -> Option<Between> {
        if self.free.is_empty() {
            return Some(self);
        }
        let ((cells_a, at_a), (cells_b, at_b)) = (shapes.part(self.a), shapes.part(self.b));
        let step = at_b - at_a;
        let balls = |cells: &[Convex]| cells.iter().map(Ball::around).collect::<Vec<_>>();
        let (balls_a, balls_b) = (balls(cells_a), balls(cells_b));
        let all = (0..cells_a.len()).flat_map(|i| (0..cells_b.len()).map(move |j| (i, j)));
        let mut caps: Vec<(Cap, usize, usize)> =
            all.map(|(i, j)| (balls_a[i].toward(&balls_b[j], step), i, j)).collect();
        caps.sort_by(|x, y| y.0.angle.total_cmp(&x.0.angle).then((x.1, x.2).cmp(&(y.1, y.2))));
        let mut around: Vec<Cap> = self.free.iter().map(Cap::around).collect();
        for (cap, i, j) in caps {
            // What a kept cone holds takes nothing away; most small cones lie in wide ones.
            work.spend(self.cones.len())?;
            if self.cones.iter().any(|c| cap.inside(c)) {
                continue;
            }
            work.spend(self.free.len())?;
            let near: Vec<bool> = around.iter().map(|c| cap.meets(c)).collect();
            if near.contains(&true) {
                work.spend(cells_a[i].vertices.len() * cells_b[j].vertices.len())?;
                let cone = Blocked::by_cells(&cells_a[i], &cells_b[j], step, touch.depth());
                self.take(cone, &near, &mut around);
            }
        }
        Some(self)
    }

    /// `near`: the free sectors that the cone may have a direction in common with; `around`: a cap around each.
    fn take(&mut self, cone: Blocked, near: &[bool], around: &mut Vec<Cap>) {
        if never(&cone) {
            return;
        }
        let bitten: Vec<bool> = self.free.iter().zip(near).map(|(s, &n)| n && bites(&cone, s)).collect();
        if !bitten.contains(&true) {
            return;
        }
        let old = std::mem::take(&mut self.free).into_iter().zip(std::mem::take(around));
        for ((sector, cap), bitten) in old.zip(bitten) {
            let (pieces, caps) = if bitten {
                let pieces = cone.taken_from(&sector);
                let caps = pieces.iter().map(Cap::around).collect();
                (pieces, caps)
            } else {
                (vec![sector], vec![cap])
            };
            self.free.extend(pieces);
            around.extend(caps);
        }
        self.cones.push(cone);
    }
}

/// A cone between bounds that face each other holds no direction: a cell without an inside.
fn never(cone: &Blocked) -> bool {
    cone.0.iter().enumerate().any(|(k, n)| cone.0[..k].iter().any(|m| m.distance(-*n) <= SAME_ANGLE))
}

/// A ball around a cell.
struct Ball {
    middle: DVec3,
    radius: f64,
}

impl Ball {
    fn around(cell: &Convex) -> Ball {
        let (lo, hi) = bounds(cell.vertices.iter().copied());
        let middle = (lo + hi) / 2.0;
        let radius = cell.vertices.iter().map(|v| v.distance(middle)).fold(0.0, f64::max);
        Ball { middle, radius }
    }

    /// A cap of the sphere that holds every direction along which this ball meets the other, moved by `step`.
    fn toward(&self, other: &Ball, step: DVec3) -> Cap {
        let way = other.middle + step - self.middle;
        let sine = (self.radius + other.radius) / way.length();
        let angle = if sine < 1.0 { sine.asin() } else { PI };
        Cap { middle: way.normalize_or(DVec3::Z), angle }
    }
}

/// The directions within an angle (radians) of a middle.
struct Cap {
    middle: DVec3,
    angle: f64,
}

impl Cap {
    /// Whether all directions of the cap lie inside the cone.
    fn inside(&self, cone: &Blocked) -> bool {
        self.angle < PI / 2.0 && cone.0.iter().all(|n| n.dot(self.middle) > self.angle.sin() + SAME_ANGLE)
    }

    /// A convex sector lies in the cap about its middle that reaches its farthest corner.
    fn around(sector: &Sector) -> Cap {
        let middle = sector.middle();
        let angle = sector.corners().iter().map(|c| c.angle_between(middle)).fold(0.0, f64::max);
        Cap { middle, angle }
    }

    /// Whether two caps may have a direction in common: never wrong when it says no.
    fn meets(&self, other: &Cap) -> bool {
        let both = self.angle + other.angle + SAME_ANGLE;
        both >= PI || self.middle.dot(other.middle) >= both.cos()
    }
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

/// Whether the open cone and the sector have a direction in common.
fn bites(cone: &Blocked, sector: &Sector) -> bool {
    let beyond = |n: &DVec3| sector.corners().iter().all(|c| n.dot(*c) <= 0.0);
    if cone.0.iter().any(beyond) {
        return false;
    }
    let rest = cone.0.iter().try_fold(sector.clone(), |s, &n| s.cut(n, Keep::Above));
    rest.is_some_and(|s| cone.0.iter().all(|n| n.dot(s.middle()) > SAME_ANGLE))
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
    /// A crossing, or the end of an arc: on every circle within [`super::NEAR`].
    Crossing,
}

impl Place {
    fn opposite(self) -> Place {
        Place { d: -self.d, on: self.on }
    }

    fn inside(self, f: &Facet) -> bool {
        let height = f.normal.dot(self.d);
        match self.on {
            On::Nothing => height > 0.0,
            On::Circle(c) => f.circle != c && height > 0.0,
            On::Crossing => height > super::NEAR,
        }
    }
}

/// The cones of a pair with their circles numbered.
#[derive(Clone, Debug)]
pub struct Numbered {
    pub a: PartIx,
    pub b: PartIx,
    cones: Vec<Vec<Facet>>,
    /// No direction is free, either way.
    everywhere: bool,
}

impl Numbered {
    pub fn new(between: &Between, circles: &mut Circles) -> Numbered {
        let mut facet = |&normal: &DVec3| Facet { normal, circle: circles.number(normal) };
        let cones = between.cones.iter().map(|c| c.0.iter().map(&mut facet).collect()).collect();
        Numbered { a: between.a, b: between.b, cones, everywhere: between.free.is_empty() }
    }

    /// Whether `a` runs into `b`, and whether `b` runs into `a`, when it moves along the direction.
    pub fn stops(&self, place: Place) -> [bool; 2] {
        [place, place.opposite()]
            .map(|p| self.everywhere || self.cones.iter().any(|c| c.iter().all(|f| p.inside(f))))
    }

    fn facets(&self) -> impl Iterator<Item = &Facet> {
        self.cones.iter().flatten()
    }

    /// Where the pair's blocking may change: edges of its free sectors that lie on a facet of a cone, and sectors that
    /// are one direction. More than that may be among them.
    pub fn candidates(&self, free: &[Sector], circles: &mut Circles) -> Critical {
        let mut found = Critical::default();
        for sector in free {
            let corners = sector.corners();
            if let [only] = corners {
                found.points.push(*only);
            }
            let closed = corners.len() > 2;
            for k in 0..if closed { corners.len() } else { corners.len() - 1 } {
                let (p, q) = (corners[k], corners[(k + 1) % corners.len()]);
                let circle = self.facet_through(p, q).or_else(|| {
                    // Not bounded by a facet: a cut of ours; but an arc that is free alone is critical all along.
                    let n = p.cross(q).try_normalize()?;
                    (!closed).then(|| circles.number(n))
                });
                if let Some(c) = circle {
                    found.arcs.entry(c).or_default().push(Piece::between(circles, c, p, q));
                }
            }
        }
        found.with_opposites()
    }

    /// The circle of the facet that both directions lie on, if there is one.
    fn facet_through(&self, p: DVec3, q: DVec3) -> Option<Circle> {
        let off = |f: &Facet| f.normal.dot(p).abs().max(f.normal.dot(q).abs());
        let on = self.facets().map(|f| (off(f), f.circle)).filter(|o| o.0 <= super::NEAR);
        on.min_by(|x, y| x.0.total_cmp(&y.0)).map(|o| o.1)
    }
}
