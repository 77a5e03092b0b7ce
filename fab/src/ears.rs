//! Takes a polygon of a shape; gives triangles over its corners, the best-shaped first, so that slivers are few.
//!
//! Sound for simple polygons, convex or not. A polygon that crosses itself still gives triangles, but they overlap.

use crate::shape::Facet;
use glam::DVec3;

/// Cuts a polygon into triangles by taking off its roundest ear, again and again.
pub fn triangulate(vertices: &[DVec3], f: &Facet) -> Vec<[u32; 3]> {
    let mut left = f.corners.clone();
    let mut out = Vec::with_capacity(left.len() - 2);
    while left.len() > 3 {
        let score = |k: usize| ear_score(vertices, &left, k, f.normal);
        let best =
            (0..left.len()).max_by(|&a, &b| score(a).total_cmp(&score(b)).then(b.cmp(&a))).unwrap_or(0);
        out.push(ear(&left, best));
        left.remove(best);
    }
    out.push([left[0], left[1], left[2]]);
    out
}

fn ear(left: &[u32], k: usize) -> [u32; 3] {
    let n = left.len();
    [left[(k + n - 1) % n], left[k], left[(k + 1) % n]]
}

/// Roundness, less where another corner lies in the ear: such an ear is taken only when there is no other.
fn ear_score(vertices: &[DVec3], left: &[u32], k: usize, normal: DVec3) -> f64 {
    let ear = ear(left, k);
    let at = |c: u32| vertices[c as usize];
    let [a, b, c] = ear.map(at);
    let side = |p: DVec3, q: DVec3, x: DVec3| (q - p).cross(x - p).dot(normal) >= 0.0;
    let inside = |x: DVec3| side(a, b, x) && side(b, c, x) && side(c, a, x);
    let blocked = left.iter().any(|v| !ear.contains(v) && inside(at(*v)));
    roundness([a, b, c], normal) - if blocked { 1.0 } else { 0.0 }
}

/// Signed area over the longest side squared: 0 for a sliver, 0.43 for an equilateral triangle.
fn roundness([a, b, c]: [DVec3; 3], normal: DVec3) -> f64 {
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
    (b - a).cross(c - a).dot(normal) / (2.0 * longest.max(f64::MIN_POSITIVE))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_l_is_cut_without_overlap() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let l = [at(0., 0.), at(3., 0.), at(3., 1.), at(1., 1.), at(1., 3.), at(0., 3.)];
        let f = Facet { corners: (0..6).collect(), normal: DVec3::Z };
        let areas = triangulate(&l, &f).into_iter().map(|t| {
            let [a, b, c] = t.map(|v| l[v as usize]);
            (b - a).cross(c - a).z / 2.0
        });
        let areas: Vec<f64> = areas.collect();
        assert!(
            areas.iter().all(|a| *a > 0.0) && (areas.iter().sum::<f64>() - 5.0).abs() < 1e-12,
            "{areas:?}"
        );
    }
}
