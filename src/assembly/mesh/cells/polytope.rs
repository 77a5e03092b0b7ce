//! Takes a convex polytope and a plane, gives its two halves.
//!
//! Corners within `width` of the plane count as on it, so no half is thinner than that. Not promised:
//! exactness beyond round-off for the corners that a cut makes.

use crate::solid::Cell;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// Unit normal and offset: inside is `n . x <= d`.
pub(crate) type Plane = (DVec3, f64);

pub(crate) fn height((n, d): Plane, p: DVec3) -> f64 {
    n.dot(p) - d
}

/// The box between two corners.
pub(super) fn cuboid(lo: DVec3, hi: DVec3) -> Cell {
    let corner =
        |k: usize| DVec3::new([lo.x, hi.x][k & 1], [lo.y, hi.y][k >> 1 & 1], [lo.z, hi.z][k >> 2 & 1]);
    let facets = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let planes = vec![
        (-DVec3::X, -lo.x),
        (DVec3::X, hi.x),
        (-DVec3::Y, -lo.y),
        (DVec3::Y, hi.y),
        (-DVec3::Z, -lo.z),
        (DVec3::Z, hi.z),
    ];
    Cell { vertices: (0..8).map(corner).collect(), facets: facets.map(|f| f.to_vec()).to_vec(), planes }
}

/// The parts of the cell below and above the plane; a missing one has no corner beyond `width`.
pub(crate) fn halves(cell: &Cell, plane: Plane, width: f64) -> (Option<Cell>, Option<Cell>) {
    let heights: Vec<f64> = cell.vertices.iter().map(|&p| height(plane, p)).collect();
    let above = heights.iter().any(|&h| h > width);
    let below = heights.iter().any(|&h| h < -width);
    match (below, above) {
        (true, true) => {
            let up: Vec<f64> = heights.iter().map(|h| -h).collect();
            (half(cell, plane, &heights, width), half(cell, (-plane.0, -plane.1), &up, width))
        }
        (_, false) => (Some(cell.clone()), None),
        (false, true) => (None, Some(cell.clone())),
    }
}

/// The half with negative heights, closed by a facet in the plane.
fn half(cell: &Cell, plane: Plane, heights: &[f64], width: f64) -> Option<Cell> {
    let mut made = Half { cell, heights, width, new: BTreeMap::new(), out: Cell::default() };
    let mut rim: Vec<u32> = Vec::new();
    for (facet, &own) in cell.facets.iter().zip(&cell.planes) {
        let ring = made.clipped(facet, &mut rim);
        if ring.len() > 2 && ring.iter().any(|i| !rim.contains(i)) {
            made.out.facets.push(ring);
            made.out.planes.push(own);
        }
    }
    rim.sort_unstable();
    rim.dedup();
    if rim.len() > 2 {
        let lid = around(&made.out.vertices, rim, plane.0);
        made.out.facets.push(lid);
        made.out.planes.push(plane);
    }
    (made.out.facets.len() > 3).then(|| used_only(made.out))
}

/// A half in the making; `new` numbers its corners by the old corner or the cut edge that they come from.
struct Half<'a> {
    cell: &'a Cell,
    heights: &'a [f64],
    width: f64,
    new: BTreeMap<(u32, u32), u32>,
    out: Cell,
}

impl Half<'_> {
    /// The facet's part below; corners on the plane are noted in `rim`.
    fn clipped(&mut self, facet: &[u32], rim: &mut Vec<u32>) -> Vec<u32> {
        let mut ring = Vec::with_capacity(facet.len() + 1);
        for k in 0..facet.len() {
            let (a, b) = (facet[k], facet[(k + 1) % facet.len()]);
            let (h, g) = (self.heights[a as usize], self.heights[b as usize]);
            if h <= self.width {
                ring.push(self.corner(a));
                if h >= -self.width {
                    rim.extend(ring.last());
                }
            }
            if (h > self.width && g < -self.width) || (h < -self.width && g > self.width) {
                ring.push(self.cut(a.min(b), a.max(b)));
                rim.extend(ring.last());
            }
        }
        ring
    }

    fn corner(&mut self, a: u32) -> u32 {
        let p = self.cell.vertices[a as usize];
        self.number((a, a), p)
    }

    fn cut(&mut self, a: u32, b: u32) -> u32 {
        let (h, g) = (self.heights[a as usize], self.heights[b as usize]);
        let p = self.cell.vertices[a as usize].lerp(self.cell.vertices[b as usize], h / (h - g));
        self.number((a, b), p)
    }

    fn number(&mut self, key: (u32, u32), p: DVec3) -> u32 {
        let out = &mut self.out.vertices;
        *self.new.entry(key).or_insert_with(|| {
            out.push(p);
            out.len() as u32 - 1
        })
    }
}

/// Corners of a convex planar polygon in counter-clockwise order seen against the normal.
pub(super) fn around(points: &[DVec3], mut ring: Vec<u32>, normal: DVec3) -> Vec<u32> {
    let middle = ring.iter().map(|&i| points[i as usize]).sum::<DVec3>() / ring.len() as f64;
    let (u, v) = normal.any_orthonormal_pair();
    let angle = |i: u32| {
        let r = points[i as usize] - middle;
        r.dot(v).atan2(r.dot(u))
    };
    ring.sort_by(|&i, &j| angle(i).total_cmp(&angle(j)).then(i.cmp(&j)));
    ring
}

/// Convex hull of points in the plane, counter-clockwise, as indices; corners that jut out by no more than
/// `width` are left out.
pub(super) fn hull(p: &[DVec2], width: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&i, &j| p[i].x.total_cmp(&p[j].x).then(p[i].y.total_cmp(&p[j].y)));
    let mut ring = chain(p, order.iter().copied());
    ring.extend(chain(p, order.iter().rev().copied()));
    let mut k = 0;
    while ring.len() > 3 && k < ring.len() {
        let [a, b, c] = [k + ring.len() - 1, k, k + 1].map(|k| p[ring[k % ring.len()]]);
        if (b - a).perp_dot(c - a) <= width * a.distance(c) {
            ring.remove(k);
        } else {
            k += 1;
        }
    }
    ring
}

/// Lower chain of a hull without its last point.
fn chain(p: &[DVec2], order: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut c: Vec<usize> = Vec::new();
    for i in order {
        while let [.., a, b] = c[..] {
            if (p[b] - p[a]).perp_dot(p[i] - p[a]) > 0.0 {
                break;
            }
            c.pop();
        }
        c.push(i);
    }
    c.pop();
    c
}

/// The cell without corners that no facet uses.
pub(super) fn used_only(cell: Cell) -> Cell {
    let mut new = vec![u32::MAX; cell.vertices.len()];
    let mut out = Cell { vertices: Vec::new(), ..cell };
    for i in out.facets.iter_mut().flatten() {
        if new[*i as usize] == u32::MAX {
            new[*i as usize] = out.vertices.len() as u32;
            out.vertices.push(cell.vertices[*i as usize]);
        }
        *i = new[*i as usize];
    }
    out
}

/// Volume and surface of a cell.
pub(super) fn measure(cell: &Cell) -> (f64, f64) {
    let o = cell.vertices.first().copied().unwrap_or_default();
    cell.facets.iter().fold((0.0, 0.0), |(volume, surface), f| {
        let at = |k: usize| cell.vertices[f[k] as usize] - o;
        let area: DVec3 =
            (1..f.len() - 1).map(|k| (at(k) - at(0)).cross(at(k + 1) - at(0))).sum::<DVec3>() / 2.0;
        (volume + at(0).dot(area) / 3.0, surface + area.length())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_add_up_and_stay_closed() {
        let cell = cuboid(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
        let n = DVec3::new(1.0, 2.0, -0.3).normalize();
        let (below, above) = halves(&cell, (n, n.dot(DVec3::new(0.5, 1.0, 1.4))), 1e-12);
        let volumes = [below, above].map(|h| measure(&h.unwrap()).0);
        assert!((volumes[0] + volumes[1] - 6.0).abs() < 1e-12 && volumes.iter().all(|&v| v > 1.0));
    }

    #[test]
    fn a_plane_through_an_edge_cuts_no_slivers() {
        let cell = cuboid(DVec3::ZERO, DVec3::ONE);
        let n = DVec3::new(1.0, -1.0, 0.0).normalize();
        let (below, above) = halves(&cell, (n, 0.0), 1e-12);
        assert_eq!(below.map(|c| c.facets.len()), Some(5));
        assert_eq!(above.map(|c| c.vertices.len()), Some(6));
        assert_eq!(halves(&cell, (DVec3::X, 1.0), 1e-12).1, None);
    }
}
