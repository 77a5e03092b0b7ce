//! Takes integer points relative to a cell's own site; gives exact signs and exactly rounded vertices.
//!
//! All arithmetic is on `i128`; nothing here rounds but [`Corner::rounded`], which rounds the exact quotient once.
//! Sound and complete for components up to [`REACH`]; callers keep within it.

use glam::DVec3;
use std::cmp::Ordering;

/// Sites lie on a grid of 2^-20 of a crossing, so that symmetric positions are symmetric exactly.
pub const SITE_BITS: u32 = 20;
/// Vertices are rounded to 2^-40 of a crossing: adding whole crossings (up to 4,096) is then exact in f64.
pub const VERTEX_BITS: u32 = 40;
/// Largest component of a neighbour's position relative to the site, in grid units. With D = REACH the largest sum
/// formed is |t|^2 det + num.t <= 18 D^5 + 54 D^5 = 72 D^5 < 2^127, and num 2^20 + det <= 18 D^4 2^21 < 2^127.
pub const REACH: i64 = 17 << SITE_BITS;

/// A grid point, in units of 2^-[`SITE_BITS`] crossing.
pub type Grid = [i64; 3];

/// A neighbour as the clipper sees it: position relative to the cell's site, and its place in the tie-break.
#[derive(Clone, Copy, Debug)]
pub struct Neighbour {
    pub at: Grid,
    /// Absolute position of the site whose weight is perturbed: the neighbour's own; a mirror image has its original's.
    pub rank: Grid,
}

/// A vertex of the cell of site 0: the point equally far from 0 and three neighbours, as the exact quotient
/// `num / (2 det)`, `det > 0`.
#[derive(Clone, Debug)]
pub struct Corner {
    /// Neighbours (indices of the caller) in an order that makes their determinant positive.
    pub planes: [u32; 3],
    num: [i128; 3],
    det: i128,
    /// The quotient in f64: each component is off by at most 2^-51 of itself.
    pub near: DVec3,
}

pub fn wide(a: Grid) -> [i128; 3] {
    a.map(i128::from)
}

fn dot(a: [i128; 3], b: [i128; 3]) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn det(a: Grid, b: Grid, c: Grid) -> i128 {
    dot(wide(a), cross(wide(b), wide(c)))
}

impl Corner {
    /// The corner on the bisectors of 0 with three neighbours, or none when their normals are linearly dependent.
    pub fn new(planes: [u32; 3], sites: [Grid; 3]) -> Option<Corner> {
        let mut order = [0, 1, 2];
        let mut det = det(sites[0], sites[1], sites[2]);
        match det.cmp(&0) {
            Ordering::Equal => return None,
            Ordering::Less => {
                order.swap(1, 2);
                det = -det;
            }
            Ordering::Greater => {}
        }
        let [a, b, c] = order.map(|k| wide(sites[k]));
        let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
        let (aa, bb, cc) = (dot(a, a), dot(b, b), dot(c, c));
        let num = [0, 1, 2].map(|k| aa * bc[k] + bb * ca[k] + cc * ab[k]);
        let near = DVec3::from_array(num.map(|n| n as f64 / (2 * det) as f64));
        Some(Corner { planes: order.map(|k| planes[k]), num, det, near })
    }

    /// `site + quotient`, rounded once to the nearest multiple of 2^-[`VERTEX_BITS`]: a function of the exact point
    /// alone, so that every cell that shares the vertex finds the same three integers.
    pub fn rounded(&self, site: Grid) -> [i64; 3] {
        let shift = VERTEX_BITS - SITE_BITS;
        let (whole, den) = (1_i128 << shift, 2 * self.det);
        [0, 1, 2].map(|k| {
            let up = (self.num[k] * whole + self.det).div_euclid(den);
            (site[k] << shift) + up as i64
        })
    }

    /// Whether the corner lies nearer to `t` than to site 0. Exact; a tie is broken by weights that are
    /// infinitesimally larger the higher the rank (simulation of simplicity on the lifted coordinate, Edelsbrunner
    /// and Muecke 1990): the same for all cells.
    pub fn is_cut_by(&self, t: &Neighbour, own_rank: Grid, of: impl Fn(u32) -> Neighbour) -> bool {
        let at = DVec3::new(t.at[0] as f64, t.at[1] as f64, t.at[2] as f64);
        let (square, project) = (at.length_squared(), 2.0 * self.near.dot(at));
        let size = square + 2.0 * (self.near * at).abs().element_sum();
        let sign = square - project;
        // `square` is within 2^-52 of exact, `project` within 2^-49 of the sum of its terms' sizes.
        if sign.abs() > size * 2f64.powi(-48) {
            return sign < 0.0;
        }
        let w = wide(t.at);
        match (dot(w, w) * self.det - dot(self.num, w)).cmp(&0) {
            Ordering::Less => true,
            Ordering::Greater => false,
            Ordering::Equal => self.tie_is_cut(t, own_rank, of),
        }
    }

    /// The perturbed sign: with t = sum l_k k over the corner's three neighbours, the weights enter as
    /// e_t - sum l_k e_k - (1 - sum l_k) e_0; the highest rank with a coefficient other than 0 decides.
    fn tie_is_cut(&self, t: &Neighbour, own_rank: Grid, of: impl Fn(u32) -> Neighbour) -> bool {
        let [a, b, c] = self.planes.map(of);
        let share = [det(t.at, b.at, c.at), det(a.at, t.at, c.at), det(a.at, b.at, t.at)];
        let rest = self.det - share.iter().sum::<i128>();
        let mut terms = [
            (t.rank, self.det),
            (a.rank, -share[0]),
            (b.rank, -share[1]),
            (c.rank, -share[2]),
            (own_rank, -rest),
        ];
        terms.sort_by_key(|e| std::cmp::Reverse(e.0));
        let sums = terms.chunk_by(|p, q| p.0 == q.0).map(|g| g.iter().map(|e| e.1).sum::<i128>());
        sums.into_iter().find(|&s| s != 0).is_some_and(|s| s < 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(s: [Grid; 3]) -> Corner {
        Corner::new([0, 1, 2], s).unwrap()
    }

    #[test]
    fn a_corner_is_the_circumcentre() {
        let c = corner([[2, 0, 0], [0, 4, 0], [0, 0, 6]]);
        assert_eq!(c.near, DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(c.rounded([1, 0, 0]), [2 << 20, 2 << 20, 3 << 20]);
    }

    #[test]
    fn a_tie_is_broken_the_same_way_from_every_cell() {
        // The eight corners of a cube are co-spherical. Seen from each of five of them, the others' corner must give
        // one consistent answer: for every four, the fifth is inside for exactly the orderings of one orientation.
        let cube: Vec<Grid> = (0..8).map(|k| [k & 1, (k >> 1) & 1, (k >> 2) & 1].map(|b| b * 2)).collect();
        let answer = |own: usize, three: [usize; 3], t: usize| {
            let rel = |k: usize| [0, 1, 2].map(|d| cube[k][d] - cube[own][d]);
            let of = |k: usize| Neighbour { at: rel(k), rank: cube[k] };
            Corner::new(three.map(|k| k as u32), three.map(rel))
                .map(|c| c.is_cut_by(&of(t), cube[own], |k| of(k as usize)))
        };
        let mut seen = 0;
        for quad in [[0, 1, 2, 4], [0, 3, 5, 6], [1, 2, 4, 7], [0, 1, 2, 7], [3, 5, 6, 7]] {
            for t in (0..8).filter(|t| !quad.contains(t)) {
                let views: Vec<_> = (0..4)
                    .filter_map(|own| {
                        let others: Vec<usize> = (0..4).filter(|&k| k != own).map(|k| quad[k]).collect();
                        answer(quad[own], [others[0], others[1], others[2]], t)
                    })
                    .collect();
                assert!(views.windows(2).all(|w| w[0] == w[1]), "{quad:?} {t}: {views:?}");
                seen += views.len();
            }
        }
        assert!(seen > 30);
    }
}
