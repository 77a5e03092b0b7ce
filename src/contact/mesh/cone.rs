//! Takes the outward normals of two convex corners that touch in a point, gives the planes that separate them
//! there.
//!
//! The polar of a convex cone is spanned by its outward normals, so the separating normals are the common
//! directions of one polar and the other's negative. Not promised: corners with more than [`MOST`] facets are
//! not decided.

use glam::DVec3;

/// Which planes through the point keep the two corners apart.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Separation {
    /// Exactly one, with this unit normal from the first to the second.
    One(DVec3),
    /// A whole fan of planes: no unique normal. Their normals are combinations of these.
    Many(Vec<DVec3>),
    /// None within round-off: the corners reach into each other by less than the tolerance.
    None,
    /// More facets than are looked at.
    Undecided,
}

/// Error of a unit direction computed from coordinates about the assembly's middle: features a ten-millionth
/// of its size still have directions this good (f64 round-off 1e-16 over 1e-7).
const ROUND_OFF: f64 = 1e-9;

/// Separating normals within this angle (radians) are one: on a lever of a thousand tolerances the difference
/// moves a point by a thousandth of a tolerance.
const ONE: f64 = 1e-6;

/// The search takes the fourth power of the number of facets.
const MOST: usize = 12;

pub(super) fn separation(a: &[DVec3], b: &[DVec3]) -> Separation {
    if a.len() > MOST || b.len() > MOST {
        return Separation::Undecided;
    }
    let b: Vec<DVec3> = b.iter().map(|n| -n).collect();
    let common = extreme(a, &b);
    match common.first() {
        None => Separation::None,
        Some(first) if common.iter().all(|n| n.distance(*first) <= ONE) => {
            Separation::One(common.iter().sum::<DVec3>().normalize())
        }
        Some(_) => Separation::Many(common),
    }
}

/// Directions in both cones, its extreme ones among them.
fn extreme(a: &[DVec3], b: &[DVec3]) -> Vec<DVec3> {
    let own = a.iter().filter(|n| spans(b, **n)).chain(b.iter().filter(|n| spans(a, **n))).copied();
    let crossing = pairs(a).flat_map(|m| pairs(b).map(move |n| m.cross(n)));
    let crossing = crossing.filter(|d| d.length() > ROUND_OFF).flat_map(|d| [d.normalize(), -d.normalize()]);
    let all = own.chain(crossing.filter(|&d| spans(a, d) && spans(b, d)));
    all.fold(Vec::new(), |mut all: Vec<DVec3>, n| {
        if all.iter().all(|m| m.distance(n) > ROUND_OFF) {
            all.push(n);
        }
        all
    })
}

/// Unit normals of the planes through two directions each.
fn pairs(g: &[DVec3]) -> impl Iterator<Item = DVec3> + Clone + '_ {
    let all = g.iter().enumerate().flat_map(|(k, p)| g[..k].iter().map(move |q| p.cross(*q)));
    all.filter(|n| n.length() > ROUND_OFF).map(DVec3::normalize)
}

/// Whether x is a non-negative combination of the directions: of three of them, two, or one (Caratheodory).
fn spans(g: &[DVec3], x: DVec3) -> bool {
    let one = g.iter().any(|n| n.distance(x) <= ROUND_OFF);
    let two = |(k, p): (usize, &DVec3)| g[..k].iter().any(|q| between(*p, *q, x));
    let three = |(k, p): (usize, &DVec3)| {
        g[..k].iter().enumerate().any(|(j, q)| g[..j].iter().any(|r| inside(*p, *q, *r, x)))
    };
    one || g.iter().enumerate().any(two) || g.iter().enumerate().any(three)
}

fn between(p: DVec3, q: DVec3, x: DVec3) -> bool {
    let n = p.cross(q);
    let l = n.length();
    l > ROUND_OFF
        && (x.dot(n) / l).abs() <= ROUND_OFF
        && p.cross(x).dot(n) >= -ROUND_OFF * l
        && x.cross(q).dot(n) >= -ROUND_OFF * l
}

fn inside(p: DVec3, q: DVec3, r: DVec3, x: DVec3) -> bool {
    let det = p.dot(q.cross(r));
    let parts = [x.dot(q.cross(r)), x.dot(r.cross(p)), x.dot(p.cross(q))];
    det.abs() > ROUND_OFF && parts.iter().all(|c| c / det >= -ROUND_OFF)
}

#[cfg(test)]
mod tests {
    use super::*;
    const X: DVec3 = DVec3::X;
    const Y: DVec3 = DVec3::Y;
    const Z: DVec3 = DVec3::Z;

    #[test]
    fn crossing_edges_have_one_plane() {
        let roof = [(X + Z).normalize(), (-X + Z).normalize()];
        let keel = [(Y - Z).normalize(), (-Y - Z).normalize()];
        let Separation::One(n) = separation(&roof, &keel) else { panic!() };
        assert!(n.distance(Z) < 1e-12);
    }

    #[test]
    fn parallel_edges_and_two_box_corners_have_many() {
        let roof = [(X + Z).normalize(), (-X + Z).normalize()];
        let keel = [(X - Z).normalize(), (-X - Z).normalize()];
        let many = |a: &[DVec3], b: &[DVec3]| match separation(a, b) {
            Separation::Many(n) => n,
            other => panic!("{other:?}"),
        };
        assert_eq!(many(&roof, &keel).len(), 2);
        assert_eq!(many(&[X, Y, Z], &[-X, -Y, -Z]), [X, Y, Z]);
    }

    #[test]
    fn a_corner_beside_an_edge_in_its_plane_has_one() {
        // A box corner with an edge along x in the top plane of a block whose rim runs along y.
        let Separation::One(n) = separation(&[X, Y, -Z], &[X, Z]) else { panic!() };
        assert!(n.distance(-Z) < 1e-12);
    }

    #[test]
    fn corners_that_reach_into_each_other_have_none() {
        assert_eq!(separation(&[X, Z], &[X, Z]), Separation::None);
    }
}
