//! Takes open convex cones of directions; gives the edges of their union: closed arcs of the cones' own great circles,
//! and single directions, that no cone holds. There, and nowhere else, the union begins or ends.
//!
//! A cone holds what lies inside by more than about the resolution (between that and its 1/sqrt 2, see `Stretch`), so
//! two cones that overlap by less leave an edge between them: parts may slide there. Nothing is divided or sampled: each
//! side of each cone is laid off against the others, in one dimension. Cost: the cones that show times all cones.
//!
//! Tried and left: taking cone after cone out of the free directions, as convex sectors. They fall into thousands of
//! slivers (satin tiles: 3,136 pairs of cells a pair of parts, 5,500 sectors, two seconds a pair).

use super::caps::Cap;
use super::circles::Resolution;
use crate::blocking::sector::Blocked;
use crate::blocking::shadow::Convex;
use glam::DVec3;

/// A convex cone with what is asked of it again and again.
#[derive(Clone, Debug)]
pub struct Bounded {
    /// Unit inward normals.
    pub normals: Vec<DVec3>,
    /// Around all of it.
    pub cap: Cap,
    sides: Vec<Side>,
}

#[derive(Clone, Debug)]
struct Side {
    stretch: Stretch,
    ends: [DVec3; 2],
    cap: Cap,
}

/// Directions `middle + t along` (not unit) for t from `from` to `to`, on the great circle across `normal`; all three
/// are unit and at right angles. At most an eighth of a turn to each side, so t is in [-1, 1]: what holds along it is
/// then told by one division, and lengths are known to within sqrt 2.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    normal: DVec3,
    middle: DVec3,
    along: DVec3,
    piece: Piece,
}

/// A closed interval: what no cone holds by more than the tolerance, `from` to `to`, and where that would begin and end
/// without one, at the very crossings of the circles: `start` to `end`, the other way round where cones overlap by less.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    from: f64,
    to: f64,
    start: f64,
    end: f64,
}

impl Piece {
    /// What is left on both sides of an open interval.
    fn without(self, held: Piece) -> impl Iterator<Item = Piece> {
        let before = if held.from < self.to { (held.from, held.start) } else { (self.to, self.end) };
        let after = if held.to > self.from { (held.to, held.end) } else { (self.from, self.start) };
        let before = Piece { to: before.0, end: before.1, ..self };
        let after = Piece { from: after.0, start: after.1, ..self };
        [before, after].into_iter().filter(|p| p.from <= p.to)
    }
}

/// An edge of the union: `from` to `to` the shorter way, counter-clockwise about `normal` or not; a single direction
/// where they are one.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    pub normal: DVec3,
    pub from: DVec3,
    pub to: DVec3,
}

impl Bounded {
    /// None where no direction lies inside by more than the resolution.
    pub fn new(cone: Blocked, resolution: Resolution) -> Option<Bounded> {
        let near = resolution.plane();
        let normals = cone.0;
        let sides: Vec<Side> =
            (0..normals.len()).flat_map(|k| sides_of(&normals, k, near)).map(Side::of).collect();
        let corners: Vec<DVec3> = sides.iter().flat_map(|s| s.ends).collect();
        let sum: DVec3 = if normals.len() == 1 { normals[0] } else { corners.iter().sum() };
        let middle = sum.try_normalize()?;
        let cap = Cap::reaching(middle, &corners);
        normals.iter().all(|n| n.dot(middle) > near).then_some(Bounded { normals, cap, sides })
    }

    /// Whether every way from a point of `a` to one of `b`, moved by `step`, lies inside.
    fn holds_all_ways(&self, a: &Convex, b: &Convex, step: DVec3) -> bool {
        let least = |n: &DVec3| b.vertices.iter().map(|&q| n.dot(q)).fold(f64::INFINITY, f64::min);
        let most = |n: &DVec3| a.vertices.iter().map(|&p| n.dot(p)).fold(f64::NEG_INFINITY, f64::max);
        self.normals.iter().all(|n| least(n) + n.dot(step) > most(n))
    }
}

impl Side {
    fn of(stretch: Stretch) -> Side {
        let ends = [stretch.at(stretch.piece.from), stretch.at(stretch.piece.to)];
        let middle = (ends[0] + ends[1]).normalize();
        Side { stretch, ends, cap: Cap::reaching(middle, &ends) }
    }

    fn part(&self, piece: Piece) -> Side {
        Side::of(Stretch { piece, ..self.stretch })
    }

    fn edge(&self, near: f64) -> Edge {
        let Piece { start, end, .. } = self.stretch.piece;
        let at = |t| self.stretch.at(t);
        let [from, to] =
            if end - start <= near { [at((start + end) / 2.0); 2] } else { [at(start), at(end)] };
        Edge { normal: self.stretch.normal, from, to }
    }

    /// What of it no cone of these holds, and how many were looked at.
    fn left_by<'a>(&self, cones: impl Iterator<Item = &'a Bounded>, near: f64) -> (Vec<Piece>, usize) {
        let mut left = vec![self.stretch.piece];
        let mut looked_at = 0;
        for cone in cones {
            looked_at += 1;
            if cone.cap.meets(&self.cap)
                && let Some(held) = self.stretch.held_by(cone, near)
            {
                left = left.into_iter().flat_map(|piece| piece.without(held)).collect();
                if left.is_empty() {
                    break;
                }
            }
        }
        (left, looked_at)
    }
}

/// The side of a cone on its k-th plane, in stretches.
fn sides_of(normals: &[DVec3], k: usize, near: f64) -> Vec<Stretch> {
    let n = normals[k];
    let (u, v) = n.any_orthonormal_pair();
    let all = [u, v, -u, -v].into_iter();
    let whole = Piece { from: -1.0, to: 1.0, start: -1.0, end: 1.0 };
    let quarters = all.map(|middle| Stretch { normal: n, middle, along: n.cross(middle), piece: whole });
    let others = || normals.iter().enumerate().filter(|&(j, _)| j != k).map(|(_, m)| m);
    quarters.filter_map(|q| others().try_fold(q, |q, &m| q.above(m, near))).collect()
}

impl Stretch {
    fn at(&self, t: f64) -> DVec3 {
        (self.middle + self.along * t).normalize()
    }

    /// The closed part with `m . d >= 0`; a plane that is the stretch's own bounds nothing.
    fn above(mut self, m: DVec3, near: f64) -> Option<Stretch> {
        let (height, slope) = (m.dot(self.middle), m.dot(self.along));
        if height.abs().max(slope.abs()) <= near {
            return Some(self);
        }
        let Piece { mut from, mut to, .. } = self.piece;
        if slope > 0.0 {
            from = from.max(-height / slope);
        } else if slope < 0.0 {
            to = to.min(-height / slope);
        } else if height < 0.0 {
            return None;
        }
        self.piece = Piece { from, to, start: from, end: to };
        (from <= to).then_some(self)
    }

    /// The open interval of t that the cone holds.
    fn held_by(&self, cone: &Bounded, near: f64) -> Option<Piece> {
        let all = f64::NEG_INFINITY..f64::INFINITY;
        let mut held = Piece { from: all.start, to: all.end, start: all.start, end: all.end };
        for m in &cone.normals {
            let (height, slope) = (m.dot(self.middle), m.dot(self.along));
            let (within, at) = (-(height - near) / slope, -height / slope);
            if slope > 0.0 && within > held.from {
                (held.from, held.start) = (within, at);
            } else if slope < 0.0 && within < held.to {
                (held.to, held.end) = (within, at);
            } else if slope == 0.0 && height <= near {
                return None;
            }
            if held.from >= held.to || held.from > self.piece.to || held.to < self.piece.from {
                return None;
            }
        }
        Some(held)
    }
}

/// A union of cones and where it ends, kept while cone after cone comes to it.
#[derive(Clone, Debug)]
pub struct Union {
    resolution: Resolution,
    /// Those that held something that none before them did.
    cones: Vec<Bounded>,
    rim: Vec<Side>,
    /// The cone that held a whole pair of cells last: the next one often lies there, too.
    last: usize,
    /// Sides laid off against cones so far.
    pub steps: usize,
}

impl Union {
    pub fn new(resolution: Resolution) -> Union {
        Union { resolution, cones: Vec::new(), rim: Vec::new(), last: 0, steps: 0 }
    }

    pub fn cones(&self) -> &[Bounded] {
        &self.cones
    }

    pub fn edges(&self) -> Vec<Edge> {
        let near = self.resolution.plane();
        self.rim.iter().map(|side| side.edge(near)).collect()
    }

    /// Whether one cone holds every way from a point of `a` to one of `b`, moved by `step`: found without making theirs.
    pub fn holds_all_ways(&mut self, a: &Convex, b: &Convex, step: DVec3) -> bool {
        let (Some(p), Some(q)) = (a.vertices.first(), b.vertices.first()) else { return false };
        let one = (*q + step - *p).normalize_or_zero();
        let all = |c: &Bounded| {
            c.cap.may_hold(one) && c.normals.iter().all(|n| n.dot(one) > 0.0) && c.holds_all_ways(a, b, step)
        };
        if self.cones.get(self.last).is_some_and(all) {
            return true;
        }
        self.steps += self.cones.len();
        let found = self.cones.iter().position(all);
        self.last = found.unwrap_or(self.last);
        found.is_some()
    }

    /// A cone that ends only where others hold, with no edge of theirs inside, adds nothing and is dropped.
    pub fn add(&mut self, cone: Bounded) {
        let near = self.resolution.plane();
        let around: Vec<&Bounded> = self.cones.iter().filter(|c| c.cap.meets(&cone.cap)).collect();
        let mut shown: Vec<Side> = Vec::new();
        for side in &cone.sides {
            let (left, looked_at) = side.left_by(around.iter().copied(), near);
            self.steps += looked_at;
            shown.extend(left.into_iter().map(|piece| side.part(piece)));
        }
        self.steps += self.cones.len() + self.rim.len();
        let mut hidden = Hidden::Nothing;
        let rim = self.rim.iter().flat_map(|side| {
            let (left, _) = side.left_by(std::iter::once(&cone), near);
            if left == [side.stretch.piece] {
                return vec![side.clone()];
            }
            hidden = Hidden::Some;
            left.into_iter().map(|piece| side.part(piece)).collect()
        });
        let mut rim: Vec<Side> = rim.collect();
        if shown.is_empty() && hidden == Hidden::Nothing && !self.cones.is_empty() {
            return;
        }
        rim.extend(shown);
        self.rim = rim;
        self.cones.push(cone);
    }
}

/// Whether a new cone holds some of the rim.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Hidden {
    Nothing,
    Some,
}
