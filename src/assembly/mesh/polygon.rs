//! Takes a planar ring of corners, gives convex facets over the same corners: the ring itself, or triangles.
//!
//! Promised: no triangle is degenerate in the plane of projection (exact predicates). Not promised: fewest
//! pieces.

use super::close::area_vector;
use glam::{DVec2, DVec3};
use robust::{Coord, orient2d};

/// Above so many corners the first ear is taken instead of the best: choosing costs the cube of the count.
const CHOOSY: usize = 200;

/// Convex facets of the ring, or nothing where the ring crosses itself. A corner nearer than `width` to the
/// line of its neighbors counts as flat.
pub(super) fn facets(ring: &[u32], points: &[DVec3], width: f64) -> Option<Vec<Vec<u32>>> {
    let normal = area_vector(ring, points);
    let flat: Vec<DVec2> =
        ring.iter().map(|&i| project(points[i as usize] - points[ring[0] as usize], normal)).collect();
    if is_planar(ring, points, normal, width) && is_convex(&flat, width) {
        return Some(vec![ring.to_vec()]);
    }
    let triangles = ears(&flat, ring)?;
    Some(triangles.into_iter().map(|t| t.map(|k| ring[k]).to_vec()).collect())
}

/// Drops the coordinate along which the normal is longest; the turn of the ring stays counter-clockwise.
pub(crate) fn project(p: DVec3, normal: DVec3) -> DVec2 {
    let a = normal.abs();
    let (u, v, sign) = if a.x >= a.y && a.x >= a.z {
        (p.y, p.z, normal.x)
    } else if a.y >= a.z {
        (p.z, p.x, normal.y)
    } else {
        (p.x, p.y, normal.z)
    };
    if sign < 0.0 { DVec2::new(v, u) } else { DVec2::new(u, v) }
}

fn is_planar(ring: &[u32], points: &[DVec3], normal: DVec3, width: f64) -> bool {
    let (o, n) = (points[ring[0] as usize], normal.normalize_or_zero());
    ring.iter().all(|&i| (points[i as usize] - o).dot(n).abs() <= width)
}

/// Twice the signed area, exact in sign.
fn turn(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let coord = |p: DVec2| Coord { x: p.x, y: p.y };
    orient2d(coord(a), coord(b), coord(c))
}

/// Every corner juts out by more than `width`, and the whole ring lies left of each of its edges.
fn is_convex(flat: &[DVec2], width: f64) -> bool {
    let n = flat.len();
    let juts = |k: usize| {
        let (a, b, c) = (flat[(k + n - 1) % n], flat[k], flat[(k + 1) % n]);
        turn(a, b, c) > width * a.distance(c)
    };
    let left = |k: usize| flat.iter().all(|&p| turn(flat[k], flat[(k + 1) % n], p) >= 0.0);
    n == 3 || (0..n).all(|k| juts(k) && left(k))
}

/// Cuts ears off, the fattest first; indices into the ring.
fn ears(flat: &[DVec2], ids: &[u32]) -> Option<Vec<[usize; 3]>> {
    let mut rest: Vec<usize> = (0..flat.len()).collect();
    let mut out = Vec::with_capacity(flat.len());
    while rest.len() > 3 {
        let at = |k: usize| rest[k % rest.len()];
        let n = rest.len();
        let candidates = (0..n).map(|k| ([at(k + n - 1), at(k), at(k + 1)], k));
        let mut fit = candidates.filter(|(ear, _)| is_ear(ear, &rest, flat, ids));
        let best = if n > CHOOSY {
            fit.next()
        } else {
            fit.max_by(|x, y| fat(x.0, flat).total_cmp(&fat(y.0, flat)))
        };
        let (ear, k) = best?;
        out.push(ear);
        rest.remove(k);
    }
    let last = [rest[0], rest[1], rest[2]];
    (turn(flat[last[0]], flat[last[1]], flat[last[2]]) > 0.0).then(|| out.push(last))?;
    Some(out)
}

/// Area over the square of the longest side: large for good triangles.
fn fat([a, b, c]: [usize; 3], flat: &[DVec2]) -> f64 {
    let [a, b, c] = [flat[a], flat[b], flat[c]];
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
    turn(a, b, c) / longest
}

/// Turns left and holds no other corner, not even on its rim.
fn is_ear(ear: &[usize; 3], rest: &[usize], flat: &[DVec2], ids: &[u32]) -> bool {
    let [a, b, c] = ear.map(|k| flat[k]);
    let holds = |p: DVec2| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
    let own = |k: usize| ear.iter().any(|&e| ids[e] == ids[k]);
    turn(a, b, c) > 0.0 && rest.iter().all(|&k| own(k) || !holds(flat[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[[f64; 2]]) -> Option<Vec<Vec<u32>>> {
        let points: Vec<DVec3> = points.iter().map(|p| DVec3::new(p[0], p[1], 1.0)).collect();
        facets(&(0..points.len() as u32).collect::<Vec<_>>(), &points, 1e-12)
    }

    fn area(points: &[[f64; 2]], facets: &[Vec<u32>]) -> f64 {
        let points: Vec<DVec3> = points.iter().map(|p| DVec3::new(p[0], p[1], 1.0)).collect();
        facets.iter().map(|f| area_vector(f, &points).z / 2.0).sum()
    }

    #[test]
    fn a_convex_ring_stays_whole() {
        assert_eq!(ring(&[[0., 0.], [1., 0.], [1., 1.], [0., 1.]]).unwrap().len(), 1);
    }

    #[test]
    fn corners_on_straight_edges_are_kept_without_degenerate_triangles() {
        let p = [[0., 0.], [1., 0.], [2., 0.], [2., 1.], [2., 2.], [1., 2.], [0., 2.], [0., 1.]];
        let f = ring(&p).unwrap();
        assert_eq!((f.len(), area(&p, &f)), (6, 4.0));
    }

    #[test]
    fn a_comb_is_cut_into_its_area() {
        let p = [
            [0., 0.],
            [5., 0.],
            [5., 3.],
            [4., 3.],
            [4., 1.],
            [3., 1.],
            [3., 3.],
            [2., 3.],
            [2., 1.],
            [1., 1.],
            [1., 3.],
            [0., 3.],
        ];
        let f = ring(&p).unwrap();
        assert_eq!((f.len(), area(&p, &f)), (10, 11.0));
    }

    #[test]
    fn a_bow_tie_is_refused() {
        assert!(ring(&[[0., 0.], [1., 1.], [1., 0.], [0., 1.]]).is_none());
    }
}
