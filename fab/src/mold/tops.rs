//! Takes a cavity in its pouring orientation (z up); gives its local high points, where air stays unless it has a way out.
//!
//! Found on the surface: two high points count as one where the surface joins them above the saddle. Air can only join
//! through the cavity in more ways than along its wall, so none is missed; one too many may be named.

use crate::mesh::{Mesh, area};
use glam::DVec3;

/// A local high point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Top {
    /// On the ceiling, or in the middle of it where it is flat.
    pub at: DVec3,
    /// Height above the saddle to a higher point, mm; infinite for the highest of a body.
    pub prominence: f64,
}

/// Points within this height of a high point belong to its flat, mm: a tenth of the least prominence that matters.
const FLAT: f64 = 0.05;

/// The high points that stand up at least `prominence` mm, highest first.
pub fn tops(cavity: &Mesh, prominence: f64) -> Vec<Top> {
    let around = Around::of(cavity);
    let mut peaks = around.peaks(cavity, prominence);
    peaks.sort_by(|a, b| cavity.vertices[b.0].z.total_cmp(&cavity.vertices[a.0].z).then(a.0.cmp(&b.0)));
    let top = |(v, prominence)| Top { at: around.middle(cavity, v), prominence };
    peaks.into_iter().filter(|p| around.ceiling(cavity, p.0)).map(top).collect()
}

/// Triangles around each vertex.
struct Around(Vec<Vec<u32>>);

impl Around {
    fn of(mesh: &Mesh) -> Around {
        let mut around = vec![vec![]; mesh.vertices.len()];
        for (t, corners) in mesh.triangles.iter().enumerate() {
            corners.iter().for_each(|&v| around[v as usize].push(t as u32));
        }
        Around(around)
    }

    fn neighbours<'a>(&'a self, mesh: &'a Mesh, v: usize) -> impl Iterator<Item = usize> + 'a {
        let corners = self.0[v].iter().flat_map(|&t| mesh.triangles[t as usize]);
        corners.map(|n| n as usize).filter(move |n| *n != v)
    }

    /// Highest vertex of each region that stands up by itself, with its prominence: regions grow from above and the
    /// lower of two that meet ends there.
    fn peaks(&self, mesh: &Mesh, least: f64) -> Vec<(usize, f64)> {
        let z = |v: usize| mesh.vertices[v].z;
        let mut order: Vec<usize> = (0..mesh.vertices.len()).filter(|&v| !self.0[v].is_empty()).collect();
        order.sort_by(|&a, &b| z(b).total_cmp(&z(a)).then(a.cmp(&b)));
        let mut root: Vec<Option<usize>> = vec![None; mesh.vertices.len()];
        let mut found = Vec::new();
        for &v in &order {
            root[v] = Some(v);
            for n in self.neighbours(mesh, v) {
                if root[n].is_none() {
                    continue;
                }
                let (a, b) = (find(&mut root, v), find(&mut root, n));
                let (high, low) = if (z(a), b) > (z(b), a) { (a, b) } else { (b, a) };
                if high != low {
                    root[low] = Some(high);
                    if z(low) - z(v) >= least {
                        found.push((low, z(low) - z(v)));
                    }
                }
            }
        }
        let whole: Vec<usize> = order.into_iter().filter(|&v| root[v] == Some(v)).collect();
        found.extend(whole.into_iter().map(|v| (v, f64::INFINITY)));
        found
    }

    /// Whether matter is below: some facet around looks up. Under an arch the surface peaks, but the air is outside.
    fn ceiling(&self, mesh: &Mesh, v: usize) -> bool {
        self.0[v].iter().any(|&t| normal_z(mesh, t) > 0.0)
    }

    /// The middle of the flat around a peak where that lies on it, else of its largest triangle, else the peak itself.
    fn middle(&self, mesh: &Mesh, peak: usize) -> DVec3 {
        let flat = self.flat(mesh, peak);
        let middle = |t: u32| mesh.corners(t as usize).iter().sum::<DVec3>() / 3.0;
        let size = |t: u32| area(mesh.corners(t as usize));
        let whole: f64 = flat.iter().map(|&t| size(t)).sum();
        let Some(&largest) = flat.iter().max_by(|a, b| size(**a).total_cmp(&size(**b))) else {
            return mesh.vertices[peak];
        };
        let centre = flat.iter().map(|&t| middle(t) * size(t)).sum::<DVec3>() / whole;
        let on = flat.iter().find_map(|&t| above(mesh.corners(t as usize), centre));
        on.unwrap_or_else(|| middle(largest))
    }

    /// Triangles around the peak whose corners all lie within [`FLAT`] of it.
    fn flat(&self, mesh: &Mesh, peak: usize) -> Vec<u32> {
        let floor = mesh.vertices[peak].z - FLAT;
        let mut seen = std::collections::BTreeSet::new();
        let mut todo = vec![peak];
        let mut reached = std::collections::BTreeSet::from([peak]);
        while let Some(v) = todo.pop() {
            for &t in &self.0[v] {
                let high = mesh.corners(t as usize).iter().all(|c| c.z >= floor);
                if high && normal_z(mesh, t) > 0.0 && seen.insert(t) {
                    let corners = mesh.triangles[t as usize].map(|c| c as usize);
                    todo.extend(corners.into_iter().filter(|c| reached.insert(*c)));
                }
            }
        }
        seen.into_iter().collect()
    }
}

fn normal_z(mesh: &Mesh, t: u32) -> f64 {
    let [a, b, c] = mesh.corners(t as usize);
    (b - a).cross(c - a).z
}

/// The point of a triangle above or below `p`, where there is one.
pub fn above([a, b, c]: [DVec3; 3], p: DVec3) -> Option<DVec3> {
    let cross = |u: DVec3, v: DVec3| u.x * v.y - u.y * v.x;
    let whole = cross(b - a, c - a);
    let (u, v) = (cross(p - a, c - a) / whole, cross(b - a, p - a) / whole);
    (whole != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0)
        .then(|| p.with_z(a.z + u * (b.z - a.z) + v * (c.z - a.z)))
}

fn find(root: &mut [Option<usize>], mut v: usize) -> usize {
    while let Some(up) = root[v].filter(|up| *up != v) {
        root[v] = root[up];
        v = up;
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::{Solid, cuboid};

    #[test]
    fn a_box_has_one_top_in_the_middle_of_its_lid() {
        let t = tops(&cuboid(DVec3::ZERO, DVec3::new(4.0, 2.0, 1.0)), 0.5);
        assert_eq!(t, [Top { at: DVec3::new(2.0, 1.0, 1.0), prominence: f64::INFINITY }]);
    }

    #[test]
    fn two_towers_have_two_tops_and_the_arch_between_them_none() {
        let bits = [
            cuboid(DVec3::ZERO, DVec3::new(2.0, 2.0, 9.0)),
            cuboid(DVec3::new(8.0, 0.0, 0.0), DVec3::new(10.0, 2.0, 8.0)),
            cuboid(DVec3::new(1.0, 0.0, 4.0), DVec3::new(9.0, 2.0, 6.0)),
        ];
        let t = tops(&Solid::all(bits.iter().map(|b| Solid::of(b).unwrap()).collect()).mesh(), 0.5);
        let heights: Vec<(f64, f64)> = t.iter().map(|t| (t.at.z, t.prominence)).collect();
        assert_eq!(heights, [(9.0, f64::INFINITY), (8.0, 2.0)]);
    }
}
