//! Takes vectors, gives the cone of all directions that make no acute angle with any of them (the polar cone) by its
//! generators. From patch normals: the directions in which a part may start to move; from the differences between two
//! cells: the planes that bound the directions in which one runs into the other.
//!
//! Exact to [`SAME_ANGLE`]: opposite vectors that fail to be so by less count as opposite, and generators that differ
//! by less are given once.

use super::SAME_ANGLE;
use glam::{DMat3, DVec2, DVec3};

/// The directions `sum t_k line_k + sum s_k ray_k` with any t and s >= 0. All unit; rays orthogonal to lines and, where
/// there are three or more, in cyclic order, counter-clockwise seen from their tips.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cone {
    pub lines: Vec<DVec3>,
    pub rays: Vec<DVec3>,
    /// The direction farthest from all the bounding planes, where the cone has an inside.
    pub middle: Option<DVec3>,
}

impl Cone {
    pub fn is_zero(&self) -> bool {
        self.lines.is_empty() && self.rays.is_empty()
    }
}

/// All d with `n . d <= 0` for every n. Vectors of any length; zeros are ignored.
pub fn polar(vectors: impl IntoIterator<Item = DVec3>) -> Cone {
    let units: Vec<DVec3> = vectors.into_iter().filter_map(DVec3::try_normalize).collect();
    if units.is_empty() {
        return Cone { lines: DVec3::AXES.to_vec(), ..Cone::default() };
    }
    let nearest = nearest_to_origin(&units);
    if nearest.point.length() > SAME_ANGLE {
        return roomy(&units, -nearest.point.normalize());
    }
    match *nearest.support.as_slice() {
        [a, b] => flat(&units, (units[a] - units[b]).normalize()),
        [a, b, c] => along_line(&units, plane_normal([units[a], units[b], units[c]])),
        _ => Cone::default(),
    }
}

/// The cone when `middle` is strictly inside: the vectors, projected from the origin on the plane across -middle, have
/// a convex hull whose corners are the bounding planes and whose edges are the extreme rays.
fn roomy(units: &[DVec3], middle: DVec3) -> Cone {
    let axis = -middle;
    let (u, v) = axis.any_orthonormal_pair();
    let lift = |q: DVec2| (axis + u * q.x + v * q.y).normalize();
    let seen = units.iter().map(|n| DVec2::new(n.dot(u), n.dot(v)) / n.dot(axis)).collect();
    let corners = without_twins(super::shadow::hull(seen), |a, b| lift(a).distance(lift(b)));
    let middle = Some(middle);
    match *corners.as_slice() {
        [n] => Cone { lines: pair(lift(n)).to_vec(), rays: vec![-lift(n)], middle },
        [a, b] => {
            let line = lift(a).cross(lift(b)).normalize();
            let rays = vec![-lift(a).cross(line).normalize(), lift(b).cross(line).normalize()];
            Cone {
                lines: vec![line],
                rays: rays.into_iter().map(|r| toward(r, -lift(a), -lift(b))).collect(),
                middle,
            }
        }
        _ => {
            let ray = |k: usize| -lift(corners[k]).cross(lift(corners[(k + 1) % corners.len()])).normalize();
            Cone { lines: vec![], rays: (0..corners.len()).map(ray).collect(), middle }
        }
    }
}

/// `r` or its opposite, whichever lies on the side of `a + b`.
fn toward(r: DVec3, a: DVec3, b: DVec3) -> DVec3 {
    if r.dot(a + b) < 0.0 { -r } else { r }
}

fn pair(n: DVec3) -> [DVec3; 2] {
    let (u, v) = n.any_orthonormal_pair();
    [u, v]
}

/// Drops corners of a closed polygon that lie within [`SAME_ANGLE`] of the one kept before them.
fn without_twins<T: Copy>(corners: Vec<T>, distance: impl Fn(T, T) -> f64) -> Vec<T> {
    let mut out: Vec<T> = Vec::new();
    for c in corners {
        if out.last().is_none_or(|&l| distance(l, c) > SAME_ANGLE) {
            out.push(c);
        }
    }
    while out.len() > 1 && distance(out[0], out[out.len() - 1]) <= SAME_ANGLE {
        out.pop();
    }
    out
}

/// The cone when it lies in the plane across `normal`: an interval of angles.
fn flat(units: &[DVec3], normal: DVec3) -> Cone {
    let [u, v] = pair(normal);
    let flat = units.iter().map(|n| DVec2::new(n.dot(u), n.dot(v))).filter(|p| p.length() > SAME_ANGLE);
    let mut angles: Vec<f64> = flat.map(DVec2::to_angle).collect();
    angles.sort_by(f64::total_cmp);
    let at = |t: f64| u * t.cos() + v * t.sin();
    let Some((from, to)) = widest_gap(&angles) else {
        return Cone { lines: vec![u, v], ..Cone::default() };
    };
    // Vectors fill the angles from `to` round to `from`; allowed is what keeps a right angle from both.
    let (quarter, half) = (std::f64::consts::FRAC_PI_2, std::f64::consts::PI);
    let (first, last) = (from + quarter, to - quarter);
    let spread = to - from - half;
    if spread < -SAME_ANGLE {
        return Cone::default();
    }
    if spread > SAME_ANGLE && (spread - half).abs() > SAME_ANGLE {
        return Cone { rays: vec![at(first), at(last)], ..Cone::default() };
    }
    let line = vec![at(first)];
    if spread > SAME_ANGLE {
        return Cone { lines: line, rays: vec![-at(from)], middle: None };
    }
    // The gap is half a turn: a line if all vectors are at its two ends, else the ray away from those inside.
    let inside = angles.iter().any(|&t| (t - from).sin().abs() > SAME_ANGLE);
    if inside { Cone { rays: line, ..Cone::default() } } else { Cone { lines: line, ..Cone::default() } }
}

/// The widest gap between neighboring angles, as (from, to) with `to > from`; a single angle leaves a full turn.
fn widest_gap(angles: &[f64]) -> Option<(f64, f64)> {
    let turn = std::f64::consts::TAU;
    let next = |k: usize| if k + 1 < angles.len() { angles[k + 1] } else { angles[0] + turn };
    (0..angles.len()).map(|k| (angles[k], next(k))).max_by(|a, b| (a.1 - a.0).total_cmp(&(b.1 - b.0)))
}

/// The cone when it lies in one line.
fn along_line(units: &[DVec3], line: DVec3) -> Cone {
    let free = |d: DVec3| units.iter().all(|n| n.dot(d) <= SAME_ANGLE);
    match (free(line), free(-line)) {
        (true, true) => Cone { lines: vec![line], ..Cone::default() },
        (true, false) => Cone { rays: vec![line], ..Cone::default() },
        (false, true) => Cone { rays: vec![-line], ..Cone::default() },
        (false, false) => Cone::default(),
    }
}

/// Normal of three vectors that lie in one plane, from the pair farthest from parallel.
fn plane_normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    let longest = [a.cross(b), b.cross(c), c.cross(a)]
        .into_iter()
        .max_by(|x, y| x.length_squared().total_cmp(&y.length_squared()))
        .unwrap_or(DVec3::Z);
    longest.normalize_or(DVec3::Z)
}

/// The point of a convex hull nearest to the origin, and the corners that it is a positive mean of.
struct Nearest {
    point: DVec3,
    support: Vec<usize>,
}

/// Weight below which a corner is no part of a mean: as small as [`SAME_ANGLE`], since it turns the mean by less.
const LEAST_WEIGHT: f64 = SAME_ANGLE;

/// Wolfe's method on unit vectors: a simplex of at most four is moved toward the origin until no vector lies nearer.
/// Each round shortens the distance, so it ends; `ROUNDS` only guards against round-off at the very end.
fn nearest_to_origin(units: &[DVec3]) -> Nearest {
    const ROUNDS: usize = 200;
    let mut best = Nearest { point: units[0], support: vec![0] };
    for _ in 0..ROUNDS {
        let p = best.point;
        let lowest =
            (0..units.len()).min_by(|&a, &b| units[a].dot(p).total_cmp(&units[b].dot(p))).unwrap_or(0);
        if p.length() <= SAME_ANGLE * SAME_ANGLE || p.length_squared() - units[lowest].dot(p) <= f64::EPSILON
        {
            break;
        }
        let mut with = best.support.clone();
        with.push(lowest);
        let next = nearest_of_simplex(units, &with);
        if next.point.length_squared() >= p.length_squared() {
            break;
        }
        best = next;
    }
    best
}

/// The nearest point over all faces of a simplex of up to four corners that hold it strictly inside.
fn nearest_of_simplex(units: &[DVec3], simplex: &[usize]) -> Nearest {
    let faces = (1u32..1 << simplex.len()).map(|mask| {
        (0..simplex.len()).filter(|k| mask >> k & 1 == 1).map(|k| simplex[k]).collect::<Vec<_>>()
    });
    faces
        .filter_map(|face| inside_face(units, &face).map(|point| Nearest { point, support: face }))
        .min_by(|a, b| {
            let (la, lb) = (a.point.length_squared(), b.point.length_squared());
            la.total_cmp(&lb).then(a.support.len().cmp(&b.support.len()))
        })
        .unwrap_or(Nearest { point: units[simplex[0]], support: vec![simplex[0]] })
}

/// The foot of the origin on the flat through the corners, if every weight there is positive.
fn inside_face(units: &[DVec3], face: &[usize]) -> Option<DVec3> {
    let o = units[face[0]];
    let edges: Vec<DVec3> = face[1..].iter().map(|&k| units[k] - o).collect();
    let w = match *edges.as_slice() {
        [] => vec![],
        [e] => vec![-o.dot(e) / e.length_squared()],
        [e, f] => {
            let (ee, ef, ff) = (e.dot(e), e.dot(f), f.dot(f));
            let det = ee * ff - ef * ef;
            vec![(ef * o.dot(f) - ff * o.dot(e)) / det, (ef * o.dot(e) - ee * o.dot(f)) / det]
        }
        [e, f, g] => (DMat3::from_cols(e, f, g).inverse() * -o).to_array().to_vec(),
        _ => return None,
    };
    let first = 1.0 - w.iter().sum::<f64>();
    let inside = w.iter().chain([&first]).all(|&x| x > LEAST_WEIGHT);
    inside.then(|| o + edges.iter().zip(&w).map(|(&e, &x)| e * x).sum::<DVec3>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    /// Lines and rays of the polar cone, in several attitudes.
    fn shape(vectors: &[DVec3]) -> (usize, usize) {
        let turned = |k: usize| {
            let by = DQuat::from_scaled_axis(DVec3::new(0.3, -1.1, 0.7) * k as f64);
            let cone = polar(vectors.iter().map(|&v| by * v * (1.0 + k as f64)));
            let all =
                cone.lines.iter().flat_map(|&l| [l, -l]).chain(cone.rays.iter().copied()).chain(cone.middle);
            for d in all {
                assert!(vectors.iter().all(|&v| (by * v).dot(d) <= SAME_ANGLE), "{cone:?}");
            }
            (cone.lines.len(), cone.rays.len())
        };
        let shapes: Vec<_> = (0..5).map(turned).collect();
        assert!(shapes.windows(2).all(|w| w[0] == w[1]), "{shapes:?}");
        shapes[0]
    }

    #[test]
    fn every_kind_of_cone() {
        let [x, y, z] = DVec3::AXES;
        let kinds: [(&[DVec3], (usize, usize)); 13] = [
            (&[], (3, 0)),
            (&[x], (2, 1)),
            (&[x, y], (1, 2)),
            (&[x, -x], (2, 0)),
            (&[x, y, z], (0, 3)),
            (&[x, -x, y], (1, 1)),
            (&[x, -x, y, -y], (1, 0)),
            (&[x, -x, y, z], (0, 2)),
            (&[x, -x, y, -y, z], (0, 1)),
            (&[x, -x, y, -y, z, -z], (0, 0)),
            (&[x, y, -x - y], (1, 0)),
            (&[x, y, z, -x - y - z], (0, 0)),
            (&[x + z, y + z, z - x, z - y, z], (0, 4)),
        ];
        for (vectors, expected) in kinds {
            assert_eq!(shape(vectors), expected, "{vectors:?}");
        }
    }
}
