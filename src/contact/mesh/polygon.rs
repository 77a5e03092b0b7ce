//! Takes convex polygons in the plane, gives their intersection, hull, area and least width.
//!
//! Everything here is f64 without exact predicates: results are good to round-off, and callers compare with a
//! tolerance.

use glam::DVec2;

/// Twice the signed area.
pub(super) fn twice_area(p: &[DVec2]) -> f64 {
    let o = p.first().copied().unwrap_or_default();
    p.windows(2).map(|w| (w[0] - o).perp_dot(w[1] - o)).sum()
}

pub(super) fn perimeter(p: &[DVec2]) -> f64 {
    (0..p.len()).map(|k| p[k].distance(p[(k + 1) % p.len()])).sum()
}

/// The part of `p` inside the convex counter-clockwise polygon `window`.
pub(super) fn clipped(p: Vec<DVec2>, window: &[DVec2]) -> Vec<DVec2> {
    (0..window.len()).fold(p, |p, k| {
        let (o, e) = (window[k], window[(k + 1) % window.len()] - window[k]);
        halved(&p, |x| e.perp_dot(x - o))
    })
}

/// Keeps where `side` is not negative; `side` is affine.
fn halved(p: &[DVec2], side: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut out = Vec::with_capacity(p.len() + 1);
    for k in 0..p.len() {
        let (a, b) = (p[k], p[(k + 1) % p.len()]);
        let (s, t) = (side(a), side(b));
        if s >= 0.0 {
            out.push(a);
        }
        if (s > 0.0 && t < 0.0) || (s < 0.0 && t > 0.0) {
            out.push(a + (b - a) * (s / (s - t)));
        }
    }
    out
}

/// Convex hull, counter-clockwise, from its least corner; corners that jut out by no more than `slack` are
/// left out.
pub(super) fn hull(points: impl IntoIterator<Item = DVec2>, slack: f64) -> Vec<DVec2> {
    let mut p: Vec<DVec2> = points.into_iter().collect();
    p.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let lower = chain(p.iter().copied());
    let upper = chain(p.iter().rev().copied());
    let mut ring: Vec<DVec2> = lower.into_iter().chain(upper).collect();
    simplify(&mut ring, slack);
    ring
}

/// One monotone chain without its last point.
fn chain(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut c: Vec<DVec2> = Vec::new();
    for p in points {
        while c.len() >= 2 && (c[c.len() - 1] - c[c.len() - 2]).perp_dot(p - c[c.len() - 2]) <= 0.0 {
            c.pop();
        }
        c.push(p);
    }
    c.pop();
    c
}

/// Removes corners within `slack` of the line of their neighbors, or of the corner before.
fn simplify(ring: &mut Vec<DVec2>, slack: f64) {
    let mut k = 0;
    while ring.len() > 3 && k < ring.len() {
        let n = ring.len();
        let (a, b, c) = (ring[(k + n - 1) % n], ring[k], ring[(k + 1) % n]);
        if (b - a).perp_dot(c - a) <= slack * a.distance(c) || a.distance(b) <= slack {
            ring.remove(k);
        } else {
            k += 1;
        }
    }
}

/// Least distance between two parallel lines that hold the convex polygon.
pub(super) fn width(p: &[DVec2]) -> f64 {
    let across = |k: usize| {
        let (o, e) = (p[k], (p[(k + 1) % p.len()] - p[k]).normalize_or_zero());
        p.iter().map(|&x| e.perp_dot(x - o)).fold(0.0, f64::max)
    };
    let has_length = |k: &usize| p[*k] != p[(*k + 1) % p.len()];
    (0..p.len()).filter(has_length).map(across).reduce(f64::min).unwrap_or(0.0)
}

/// Distance from x to the convex counter-clockwise polygon; zero inside.
pub(super) fn distance(p: &[DVec2], x: DVec2) -> f64 {
    let n = p.len();
    let inside = n > 2 && (0..n).all(|k| (p[(k + 1) % n] - p[k]).perp_dot(x - p[k]) >= 0.0);
    let to_edge = |k: usize| {
        let (a, e) = (p[k], p[(k + 1) % n] - p[k]);
        let t = if e == DVec2::ZERO { 0.0 } else { ((x - a).dot(e) / e.length_squared()).clamp(0.0, 1.0) };
        x.distance(a + t * e)
    };
    if inside { 0.0 } else { (0..n).map(to_edge).fold(f64::INFINITY, f64::min) }
}

/// Joins pieces with disjoint interiors where their union is convex but for `tolerance` on average; fewer
/// pieces, same region.
pub(super) fn joined(mut pieces: Vec<Vec<DVec2>>, tolerance: f64, slack: f64) -> Vec<Vec<DVec2>> {
    if let Some(whole) = union_if_convex(&pieces, tolerance, slack) {
        return vec![whole];
    }
    let mut changed = true;
    while changed {
        changed = false;
        let mut k = 0;
        while k < pieces.len() {
            let partner = (k + 1..pieces.len()).find_map(|j| {
                let near = boxes_touch(&pieces[k], &pieces[j], tolerance);
                let both =
                    near.then(|| union_if_convex(&[pieces[k].clone(), pieces[j].clone()], tolerance, slack));
                both.flatten().map(|u| (j, u))
            });
            match partner {
                Some((j, union)) => {
                    pieces.remove(j);
                    pieces[k] = union;
                    changed = true;
                }
                None => k += 1,
            }
        }
    }
    pieces
}

fn union_if_convex(pieces: &[Vec<DVec2>], tolerance: f64, slack: f64) -> Option<Vec<DVec2>> {
    let whole = hull(pieces.iter().flatten().copied(), slack);
    let covered: f64 = pieces.iter().map(|p| twice_area(p)).sum();
    (twice_area(&whole) - covered <= tolerance * perimeter(&whole)).then_some(whole)
}

fn boxes_touch(p: &[DVec2], q: &[DVec2], reach: f64) -> bool {
    let bounds = |p: &[DVec2]| {
        p.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(lo, hi), &x| (lo.min(x), hi.max(x)))
    };
    let ((a, b), (c, d)) = (bounds(p), bounds(q));
    (a - reach).cmple(d).all() && (c - reach).cmple(b).all()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(x: f64, y: f64, w: f64, h: f64) -> Vec<DVec2> {
        [(x, y), (x + w, y), (x + w, y + h), (x, y + h)].map(|(x, y)| DVec2::new(x, y)).to_vec()
    }

    #[test]
    fn two_halves_join_and_an_ell_does_not() {
        let j = joined(vec![rect(0., 0., 1., 1.), rect(1., 0., 2., 1.)], 1e-6, 1e-12);
        assert_eq!((j.len(), j[0].len()), (1, 4));
        assert_eq!(joined(vec![rect(0., 0., 1., 1.), rect(1., 0., 2., 3.)], 1e-6, 1e-12).len(), 2);
        assert_eq!(joined(vec![rect(0., 0., 1., 1.), rect(5., 0., 1., 1.)], 1e-6, 1e-12).len(), 2);
    }

    #[test]
    fn clipping_width_distance() {
        let c = clipped(rect(0., 0., 2., 2.), &rect(1., 1., 5., 5.));
        assert_eq!((twice_area(&c), width(&c)), (2.0, 1.0));
        assert_eq!(distance(&c, DVec2::new(3.0, 1.5)), 1.0);
        assert!(twice_area(&clipped(rect(0., 0., 1., 1.), &rect(2., 0., 1., 1.))) == 0.0);
    }
}
