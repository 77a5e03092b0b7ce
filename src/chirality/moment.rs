//! Takes solids; gives their volume, centroid and moments, and integrals that change sign under reflection.
//!
//! Exact up to round-off: the integrands are polynomials of degree at most 5, the quadrature is exact for them. Not
//! promised: that one of the integrals differs from 0 for every chiral solid.

use glam::DVec3;

/// The boundary of a body as outward triangles.
pub type Triangles = [[DVec3; 3]];

/// Nodes and weights of the four-point Gauss-Legendre rule on [0, 1], exact up to degree 7.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Volume and centroid.
pub fn centroid(triangles: &Triangles) -> (f64, DVec3) {
    // Tetrahedra from a point near the body: what cancels is no larger than the body.
    let near = triangles.first().map_or(DVec3::ZERO, |t| t[0]);
    let (mut volume, mut first) = (0.0, DVec3::ZERO);
    for t in triangles {
        let [a, b, c] = t.map(|p| p - near);
        let v = a.dot(b.cross(c)) / 6.0;
        volume += v;
        first += v * (a + b + c) / 4.0;
    }
    (volume, near + first / volume)
}

/// Calls `f(point, weight)` so that the weighted sum is the integral over the body of any polynomial of degree <= 5:
/// signed tetrahedra from the origin, each the image of a cube (Duffy's map).
fn integrate(triangles: &Triangles, mut f: impl FnMut(DVec3, f64)) {
    for &[a, b, c] in triangles {
        let det = a.dot(b.cross(c));
        for (u, wu) in GAUSS {
            for (v, wv) in GAUSS {
                for (w, ww) in GAUSS {
                    let p = u * (a + v * ((b - a) + w * (c - b)));
                    f(p, wu * wv * ww * u * u * v * det);
                }
            }
        }
    }
}

/// Powers 0 to 4 of each coordinate.
fn powers(p: DVec3) -> [[f64; 5]; 3] {
    p.to_array().map(|c| [1.0, c, c * c, c * c * c, c * c * c * c])
}

/// Moments of a body about the origin: integrals of x^a y^b z^c, a + b + c at most 4.
struct Moments([[[f64; 5]; 5]; 5]);

/// Exponents (a, b, c) of each order, with their multinomial coefficient.
fn monomials(order: usize) -> impl Iterator<Item = ([usize; 3], f64)> {
    const FACTORIAL: [f64; 5] = [1.0, 1.0, 2.0, 6.0, 24.0];
    (0..=order).flat_map(move |a| {
        (0..=order - a).map(move |b| {
            let c = order - a - b;
            ([a, b, c], FACTORIAL[order] / (FACTORIAL[a] * FACTORIAL[b] * FACTORIAL[c]))
        })
    })
}

impl Moments {
    fn new(triangles: &Triangles) -> Moments {
        let exponents: Vec<[usize; 3]> = (2..=4).flat_map(monomials).map(|m| m.0).collect();
        let mut m = [[[0.0; 5]; 5]; 5];
        integrate(triangles, |p, weight| {
            let [x, y, z] = powers(p);
            for &[a, b, c] in &exponents {
                m[a][b][c] += weight * x[a] * y[b] * z[c];
            }
        });
        Moments(m)
    }

    /// Integral over s of s (s . r)^order.
    fn contracted(&self, order: usize, r: DVec3) -> DVec3 {
        let [x, y, z] = powers(r);
        monomials(order)
            .map(|([a, b, c], times)| {
                let m = &self.0;
                times * x[a] * y[b] * z[c] * DVec3::new(m[a + 1][b][c], m[a][b + 1][c], m[a][b][c + 1])
            })
            .sum()
    }
}

/// A pseudo-scalar of a body: its value, and the integral of the product of the lengths of the determinant's columns (the
/// determinant's own size would be round-off everywhere when two moments agree).
#[derive(Clone, Copy, Debug)]
pub struct PseudoScalar {
    pub name: &'static str,
    /// Positive for `right`.
    pub value: f64,
    pub size: f64,
}

/// With M = integral of s (s . r), Q of s (s . r)^2, C of s (s . r)^3 over the body about its centroid, the integrals
/// over r of the determinants [r, M r, M M r], [r, M r, Q(r)], [r, M r, C(r)]. Rotations leave them alone, reflections
/// change their signs. The first is the integral of x y z in right-handed principal axes in the order of rising
/// moments, times a positive number; it vanishes where two moments agree, as for bodies with a fourfold axis.
pub fn pseudo_scalars(triangles: &Triangles, centroid: DVec3) -> [PseudoScalar; 3] {
    let local: Vec<[DVec3; 3]> = triangles.iter().map(|t| t.map(|p| p - centroid)).collect();
    let moments = Moments::new(&local);
    let mut sums = [(0.0, 0.0); 3];
    integrate(&local, |r, weight| {
        let m = moments.contracted(1, r);
        let third = [moments.contracted(1, m), moments.contracted(2, r), moments.contracted(3, r)];
        for (sum, g) in sums.iter_mut().zip(third) {
            let lengths = r.length() * m.length() * g.length();
            *sum = (sum.0 + weight * r.dot(m.cross(g)), sum.1 + weight.abs() * lengths);
        }
    });
    let names = ["[r, M r, M M r]", "[r, M r, Q(r)]", "[r, M r, C(r)]"];
    [0, 1, 2].map(|k| PseudoScalar { name: names[k], value: sums[k].0, size: sums[k].1 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An irregular tetrahedron, or its mirror image.
    fn body(mirrored: bool) -> Vec<[DVec3; 3]> {
        let v = [[0.0, 0.0, 0.0], [3.0, 0.2, 0.1], [0.3, 2.0, 0.0], [0.5, 0.4, 1.0]].map(DVec3::from_array);
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]].map(|f| f.map(|k: usize| v[k]));
        let z = DVec3::new(1.0, 1.0, -1.0);
        if mirrored { faces.map(|[a, b, c]| [a * z, c * z, b * z]).to_vec() } else { faces.to_vec() }
    }

    #[test]
    fn quadrature_is_exact_on_a_tetrahedron() {
        // Over the tetrahedron 0, e1, e2, e3 the integral of x^a y^b z^c is a! b! c! / (a + b + c + 3)!.
        let mut sum = 0.0;
        integrate(&[[DVec3::X, DVec3::Y, DVec3::Z]], |p, w| sum += w * p.x * p.x * p.y * p.z * p.z);
        assert!((sum - 4.0 / 40_320.0).abs() < 1e-17, "{sum}");
    }

    #[test]
    fn reflection_changes_every_sign_and_rotation_none() {
        let of = |t: &[[DVec3; 3]]| pseudo_scalars(t, centroid(t).1).map(|p| p.value);
        let (here, mirrored) = (body(false), body(true));
        let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, 0.4, 1.1, -2.0);
        let turned: Vec<_> = here.iter().map(|t| t.map(|p| turn * p)).collect();
        for ((a, b), c) in of(&here).into_iter().zip(of(&mirrored)).zip(of(&turned)) {
            assert!(a != 0.0 && (a + b).abs() < 1e-12 * a.abs() && (a - c).abs() < 1e-12 * a.abs());
        }
    }
}
