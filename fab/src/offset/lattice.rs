//! Takes a closed mesh in place and surfaces that it is to keep off, each by a distance; gives the mesh less all that is nearer.
//!
//! The last resort of the offset: it needs no plane to be moved and no boolean. Distances are taken on a cubic lattice, and
//! its tetrahedra are cut where they pass zero (marching tetrahedra: Doi and Koide 1991), so what comes out is closed and
//! does not cross itself, whatever goes in. Sound by measurement: all its triangles keep off by the distance and are inside
//! the part, or the cut goes deeper and is measured again. Not exact: faces go in by up to two steps of the lattice more, the
//! kept ones too, and detail and bodies finer than a step are lost. Not promised: that what is left is one body.

use crate::bvh::Bvh;
use crate::cross;
use crate::files::stl;
use crate::mesh::Mesh;
use crate::near::{nearest, on_triangle};
use crate::solid::Solid;
use glam::DVec3;
use rayon::prelude::*;

/// A surface that a part keeps off, and by how much, mm.
pub struct Off {
    pub surface: Mesh,
    pub by: f64,
}

/// What is left, and the step of the lattice, mm.
pub struct Eroded {
    pub mesh: Mesh,
    pub step: f64,
}

/// Points of a lattice, and squares of a step on the surface of the part, each of which makes about four triangles: bounds
/// of some seconds. A part of 50 mm then has steps of half a mm.
const POINTS: f64 = 4_194_304.0;
const SQUARES: f64 = 32_768.0;

/// A step is a part of the least distance to keep: two to resolve a face that goes in by it.
const STEPS: f64 = 2.0;

/// Where an edge of a tetrahedron may be cut, in parts of it: never nearer to its ends than one of 16, so that corners stay
/// apart in f32; and parts of a power of two, so that corners are exact.
const PARTS: f64 = 16.0;

/// How much deeper than asked the cut goes, in steps, from the first that is measured right. On flat faces the first is;
/// the last is the longest edge of a tetrahedron, which no distance can change more along.
const DEEPER: [f64; 5] = [0.125, 0.25, 0.5, 1.0, 1.733];

/// The part less what is nearer to the surfaces than that; `None` where nothing is left.
pub fn eroded(part: &Mesh, off: &[Off]) -> Option<Eroded> {
    let least = off.iter().map(|o| o.by).filter(|by| *by > 0.0).fold(f64::INFINITY, f64::min);
    let lattice = Lattice::around(part, least)?;
    let field = lattice.field(part, off);
    let trees: Vec<Bvh> = off.iter().map(|o| Bvh::new(&o.surface)).collect();
    let whole = Bvh::new(part);
    let right = |mesh: &Mesh| {
        let tree = Bvh::new(mesh);
        let clear = |(o, t): (&Off, &Bvh)| nearest((mesh, &tree), (&o.surface, t)).distance >= o.by;
        off.iter().zip(&trees).all(clear) && cross::between((mesh, &tree), (part, &whole)).is_empty()
    };
    let cut = DEEPER.iter().map(|deeper| lattice.cut(&field, deeper * lattice.step));
    let mesh = cut
        .map_while(|m| Solid::of(&m).ok())
        .flat_map(|s| [s.plain(lattice.step * ROUGH).thick(lattice.step), s.thick(lattice.step)])
        .map(|s| s.mesh())
        .find(|m| !m.triangles.is_empty() && right(m) && stl::is_plain(&stl::snapped(m)))?;
    Some(Eroded { mesh, step: lattice.step })
}

/// Triangles are united where that moves the surface by less than this part of a step; what it costs is measured with the
/// rest.
const ROUGH: f64 = 0.125;

/// Points at multiples of the step, from `low` on.
struct Lattice {
    low: DVec3,
    n: [usize; 3],
    step: f64,
}

impl Lattice {
    /// Around the part with a margin of a step; the step is a power of two. `None` where the part has no size.
    fn around(part: &Mesh, least: f64) -> Option<Lattice> {
        let (lo, hi) = part.bounds();
        let size = (hi - lo).max_element();
        if !(size.is_finite() && size > 0.0) {
            return None;
        }
        let mut step = (least.min(size) / STEPS).log2().floor().exp2();
        loop {
            let low = (lo / step).floor() - DVec3::ONE;
            let n = ((hi / step).ceil() + DVec3::ONE - low) + DVec3::ONE;
            if n.element_product() <= POINTS && part.area() <= SQUARES * step * step {
                return Some(Lattice { low, n: n.to_array().map(|x| x as usize), step });
            }
            step *= 2.0;
        }
    }

    fn at(&self, [x, y, z]: [usize; 3]) -> DVec3 {
        (self.low + DVec3::new(x as f64, y as f64, z as f64)) * self.step
    }

    /// How far each point is inside the part and beyond what it keeps off, mm; exact within two steps of zero, beyond that
    /// only the sign is. Layer by layer in z.
    fn field(&self, part: &Mesh, off: &[Off]) -> Vec<f64> {
        let layer = self.n[0] * self.n[1];
        let mut field = vec![0.0; layer * self.n[2]];
        field.par_chunks_mut(layer).enumerate().for_each(|(z, values)| {
            values.fill(self.band());
            self.lower(values, z, part, 0.0);
            self.sign(values, z, part);
            off.iter().for_each(|o| self.lower(values, z, &o.surface, o.by));
        });
        field
    }

    /// Distances beyond it are not told apart: above two of the longest edge of a tetrahedron.
    fn band(&self) -> f64 {
        4.0 * self.step
    }

    /// Values of a layer lowered to the distance from the surface less `by`.
    fn lower(&self, values: &mut [f64], z: usize, surface: &Mesh, by: f64) {
        let height = self.at([0, 0, z]).z;
        let reach = by + self.band();
        for t in 0..surface.triangles.len() {
            let corners = surface.corners(t);
            let [lo, hi] =
                [corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2])];
            if height < lo.z - reach || height > hi.z + reach {
                continue;
            }
            let (xs, ys) =
                (self.range(0, lo.x - reach, hi.x + reach), self.range(1, lo.y - reach, hi.y + reach));
            for y in ys {
                for x in xs.clone() {
                    let p = self.at([x, y, z]);
                    let value = &mut values[y * self.n[0] + x];
                    *value = value.min(p.distance(on_triangle(p, corners)) - by);
                }
            }
        }
    }

    /// Numbers of the points between two coordinates.
    fn range(&self, axis: usize, from: f64, to: f64) -> std::ops::Range<usize> {
        let number = |x: f64| (x / self.step - self.low[axis]).max(0.0);
        let from = number(from).ceil() as usize;
        from..(number(to).floor() as usize + 1).min(self.n[axis])
    }

    /// Distances to the part's surface made negative outside. Along a row the side changes only where both distances
    /// together reach from point to point; a row begins outside.
    fn sign(&self, values: &mut [f64], z: usize, part: &Mesh) {
        for (y, row) in values.chunks_mut(self.n[0]).enumerate() {
            let (mut inside, mut before) = (false, f64::INFINITY);
            for (x, value) in row.iter_mut().enumerate() {
                if before + *value <= self.step * (1.0 + ROUND_OFF) {
                    inside = cross::encloses(part, self.at([x, y, z]));
                }
                before = *value;
                *value = if inside { *value } else { -*value };
            }
        }
    }

    /// The surface where the field is `level`.
    fn cut(&self, field: &[f64], level: f64) -> Mesh {
        let cells = |z: usize| {
            let rows = (0..self.n[1] - 1).flat_map(move |y| (0..self.n[0] - 1).map(move |x| [x, y, z]));
            rows.flat_map(|cell| self.cut_cell(field, level, cell)).collect::<Vec<_>>()
        };
        let triangles: Vec<[Cut; 3]> = (0..self.n[2] - 1).into_par_iter().flat_map_iter(cells).collect();
        let mut cuts: Vec<Cut> = triangles.iter().flatten().copied().collect();
        cuts.par_sort_unstable();
        cuts.dedup();
        let number = |c: &Cut| cuts.binary_search(c).unwrap_or_default() as u32;
        Mesh {
            vertices: cuts.iter().map(|c| self.place(c)).collect(),
            triangles: triangles.iter().map(|t| t.map(|c| number(&c))).collect(),
        }
    }

    fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.n[1] + y) * self.n[0] + x
    }

    /// Triangles in the six tetrahedra around a diagonal of a cell.
    fn cut_cell(&self, field: &[f64], level: f64, cell: [usize; 3]) -> Vec<[Cut; 3]> {
        let corner = |k: usize| std::array::from_fn(|a| cell[a] + (k >> a & 1));
        let values: [f64; 8] = std::array::from_fn(|k| field[self.index(corner(k))] - level);
        if values.iter().all(|v| *v > 0.0) || values.iter().all(|v| *v <= 0.0) {
            return vec![];
        }
        let cut = |i: usize, o: usize| {
            let part = (PARTS * values[i] / (values[i] - values[o])).floor().clamp(1.0, PARTS - 1.0);
            Cut { inside: self.index(corner(i)), outside: self.index(corner(o)), part: part as u8 }
        };
        let ways = [[1, 3], [3, 2], [2, 6], [6, 4], [4, 5], [5, 1]];
        ways.into_iter().flat_map(|[a, b]| self.cut_tetrahedron([0, a, b, 7], &values, cut)).collect()
    }

    fn cut_tetrahedron(
        &self,
        corners: [usize; 4],
        values: &[f64; 8],
        cut: impl Fn(usize, usize) -> Cut,
    ) -> Vec<[Cut; 3]> {
        let (inside, outside): (Vec<usize>, Vec<usize>) = corners.iter().partition(|&&k| values[k] > 0.0);
        let triangles = match (&inside[..], &outside[..]) {
            (&[a], &[b, c, d]) => vec![[cut(a, b), cut(a, c), cut(a, d)]],
            (&[b, c, d], &[a]) => vec![[cut(b, a), cut(c, a), cut(d, a)]],
            (&[a, b], &[c, d]) => {
                vec![[cut(a, c), cut(a, d), cut(b, d)], [cut(a, c), cut(b, d), cut(b, c)]]
            }
            _ => vec![],
        };
        triangles.into_iter().map(|t| self.outward(t)).collect()
    }

    /// A plane through three cut edges has all the inside on one side, so any of the edges tells which way is out.
    fn outward(&self, t: [Cut; 3]) -> [Cut; 3] {
        let [a, b, c] = t.map(|c| self.place(&c));
        let out = self.at(self.cell(t[0].outside)) - self.at(self.cell(t[0].inside));
        if (b - a).cross(c - a).dot(out) > 0.0 { t } else { [t[0], t[2], t[1]] }
    }

    fn cell(&self, k: usize) -> [usize; 3] {
        [k % self.n[0], k / self.n[0] % self.n[1], k / (self.n[0] * self.n[1])]
    }

    fn place(&self, c: &Cut) -> DVec3 {
        let [from, to] = [c.inside, c.outside].map(|k| self.at(self.cell(k)));
        from + (to - from) * (f64::from(c.part) / PARTS)
    }
}

/// Where an edge between lattice points is cut, in sixteenths from the one inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Cut {
    inside: usize,
    outside: usize,
    part: u8,
}

/// Of two distances and their sum, relative: far above f64's, so that no change of side is missed.
const ROUND_OFF: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::cuboid;
    use crate::mesh::{Closure, Topology};

    /// Half a millimetre off the lid of a box, the other faces kept: at most two steps more all around.
    #[test]
    fn a_box_keeps_off_a_lid() {
        let part = cuboid(DVec3::splat(0.01), DVec3::new(10.0, 8.0, 6.0));
        let lid = cuboid(DVec3::new(-5.0, -5.0, 6.0), DVec3::new(15.0, 15.0, 9.0));
        let left = eroded(&part, &[Off { surface: lid, by: 0.5 }]).unwrap();
        assert_eq!(left.step, 0.25);
        assert_eq!(
            (left.mesh.closure(), left.mesh.topology()),
            (Closure::Closed, Topology { bodies: 1, genus: 0 })
        );
        let ((lo, hi), more) = (left.mesh.bounds(), 2.0 * left.step);
        assert!(hi.z <= 5.5 && hi.z >= 5.5 - more, "{hi}");
        assert!(lo.min_element() >= 0.01 && lo.max_element() <= 0.01 + more, "{lo}");
        assert!(crate::files::stl::is_plain(&left.mesh));
    }

    #[test]
    fn where_all_is_too_near_nothing_is_left() {
        let part = cuboid(DVec3::ZERO, DVec3::new(10.0, 10.0, 0.9));
        assert!(eroded(&part, &[Off { surface: part.clone(), by: 0.5 }]).is_none());
    }
}
