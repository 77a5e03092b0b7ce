//! Takes cones of directions, gives them as convex sectors of the sphere that can be cut by planes: what is left of the
//! free directions when the blocked ones are taken away.
//!
//! Sectors are closed: an arc or a single direction left between two blocked regions is kept, because parts may slide
//! there. Cuts are exact to [`SAME_ANGLE`]; what is thinner than that is kept as an arc or a direction.

use super::SAME_ANGLE;
use super::cone::{Cone, polar};
use super::shadow::Convex;
use glam::DVec3;

/// The cone of some unit directions less than half a turn apart: one direction, an arc (two), or a convex polygon in
/// cyclic order.
#[derive(Clone, Debug, PartialEq)]
pub struct Sector(Vec<DVec3>);

/// Which side of a plane through the origin to keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Keep {
    /// `n . d <= 0`
    Below,
    /// `n . d >= 0`
    Above,
}

impl Sector {
    pub fn corners(&self) -> &[DVec3] {
        &self.0
    }

    /// A direction inside: the normalized mean of the corners.
    pub fn middle(&self) -> DVec3 {
        self.0.iter().sum::<DVec3>().normalize_or(self.0[0])
    }

    /// What is left on one side; directions in the plane stay on both.
    pub fn cut(&self, n: DVec3, keep: Keep) -> Option<Sector> {
        let sign = if keep == Keep::Below { 1.0 } else { -1.0 };
        let side = |d: DVec3| Some(sign * n.dot(d)).filter(|s| s.abs() > SAME_ANGLE).unwrap_or(0.0);
        let mut left: Vec<DVec3> = Vec::new();
        for (k, &x) in self.0.iter().enumerate() {
            if side(x) <= 0.0 {
                left.push(x);
            }
            let closing = k + 1 == self.0.len();
            if closing && self.0.len() < 3 {
                break;
            }
            let y = self.0[(k + 1) % self.0.len()];
            if side(x) * side(y) < 0.0 {
                left.push((x * side(y).abs() + y * side(x).abs()).normalize());
            }
        }
        sector(left)
    }

    /// The fan of smaller sectors around a direction inside; empty when there is nothing left to divide.
    pub fn split(&self, d: DVec3) -> Vec<Sector> {
        let n = self.0.len();
        let closed = if n < 3 { n.saturating_sub(1) } else { n };
        match n {
            1 => vec![],
            2 => self.0.iter().filter_map(|&r| sector(vec![r, d])).filter(|s| s.0.len() > 1).collect(),
            _ => (0..closed).filter_map(|k| sector(vec![self.0[k], self.0[(k + 1) % n], d])).collect(),
        }
    }
}

/// Drops corners that count as one; None when nothing is left.
fn sector(corners: Vec<DVec3>) -> Option<Sector> {
    let mut out: Vec<DVec3> = Vec::new();
    for c in corners {
        if out.last().is_none_or(|l| l.distance(c) > SAME_ANGLE) {
            out.push(c);
        }
    }
    while out.len() > 1 && out[0].distance(out[out.len() - 1]) <= SAME_ANGLE {
        out.pop();
    }
    (!out.is_empty()).then_some(Sector(out))
}

/// A cone as sectors that cover it.
pub fn sectors(cone: &Cone) -> Vec<Sector> {
    let (l, r) = (&cone.lines, &cone.rays);
    let made = match (l.len(), r.len()) {
        (0, _) => vec![r.clone()],
        (1, 0) => vec![vec![l[0]], vec![-l[0]]],
        (1, 1) => vec![vec![l[0], r[0]], vec![-l[0], r[0]]],
        (1, _) => vec![vec![l[0], r[0], r[1]], vec![-l[0], r[1], r[0]]],
        (2, 0) => quarters(l[0], l[1]).map(|[a, b]| vec![a, b]).to_vec(),
        (2, _) => quarters(l[0], l[1]).map(|[a, b]| vec![a, b, r[0]]).to_vec(),
        _ => [l[2], -l[2]]
            .into_iter()
            .flat_map(|top| quarters(l[0], l[1]).map(|[a, b]| vec![a, b, top]))
            .collect(),
    };
    made.into_iter().filter_map(sector).collect()
}

fn quarters(u: DVec3, v: DVec3) -> [[DVec3; 2]; 4] {
    [[u, v], [v, -u], [-u, -v], [-v, u]]
}

/// An open cone of directions: all d with `n . d > 0` for each of its normals (unit).
#[derive(Clone, Debug, PartialEq)]
pub struct Blocked(pub Vec<DVec3>);

impl Blocked {
    /// The directions that push one side of a patch into the other.
    pub fn by_patch(normal: DVec3) -> Blocked {
        Blocked(vec![normal])
    }

    /// The directions along which convex cell `a` runs into `b`, moved by `step` from a's frame: the cone over their
    /// Minkowski difference. Differences no longer than `touch` are where they touch, and bound nothing.
    pub fn by_cells(a: &Convex, b: &Convex, step: DVec3, touch: f64) -> Blocked {
        let gaps = b.vertices.iter().flat_map(|&q| a.vertices.iter().map(move |&p| q + step - p));
        let dual = polar(gaps.filter(|g| g.length() > touch).map(|g| -g));
        let both = dual.lines.iter().flat_map(|&l| [l, -l]);
        Blocked(both.chain(dual.rays.iter().copied()).collect())
    }

    /// Whether `d` is inside by more than [`SAME_ANGLE`].
    pub fn holds(&self, d: DVec3) -> bool {
        !self.0.is_empty() && self.0.iter().all(|n| n.dot(d) > SAME_ANGLE)
    }

    /// The sector without the blocked directions.
    pub fn taken_from(&self, sector: &Sector) -> Vec<Sector> {
        let mut out = Vec::new();
        let mut rest = Some(sector.clone());
        for &n in &self.0 {
            let Some(now) = rest else { break };
            out.extend(now.cut(n, Keep::Below));
            rest = now.cut(n, Keep::Above);
        }
        out
    }
}
