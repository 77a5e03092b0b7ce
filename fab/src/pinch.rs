//! Takes a shape of which more than two facets meet in an edge, as where two cubes touch along one; gives it with such
//! edges parted, so that each is between two facets of one wedge of material.
//!
//! The points stay where they are: their numbers are doubled, and where that does not do an edge is halved. Shapes without such edges come back as they are. Not
//! promised: that what is parted can be made; a body that hangs together by an edge alone is told once its file is tried.

use crate::shape::{Facet, Shape};
use glam::DVec3;
use std::collections::BTreeMap;

/// Facets with a directed edge, each with the place of the edge's start among its corners.
type Uses = BTreeMap<(u32, u32), Vec<(usize, usize)>>;

/// Edges of more than two facets parted; edges that are not used as often in both directions are left to the checks.
pub fn parted(shape: &Shape) -> Shape {
    let uses = uses(shape);
    if uses.values().all(|u| u.len() == 1) {
        return shape.clone();
    }
    let first: Vec<usize> =
        shape.facets.iter().scan(0, |n, f| Some(std::mem::replace(n, *n + f.corners.len()))).collect();
    let total = shape.facets.iter().map(|f| f.corners.len()).sum();
    let mut root: Vec<usize> = (0..total).collect();
    for (&(a, b), ours) in uses.iter().filter(|((a, b), _)| a < b) {
        let Some(theirs) = uses.get(&(b, a)).filter(|t| t.len() == ours.len()) else { continue };
        for (p, q) in wedges(shape, (a, b), ours, theirs) {
            let next = |(f, k): (usize, usize)| (f, (k + 1) % shape.facets[f].corners.len());
            let number = |(f, k): (usize, usize)| first[f] + k;
            unite(&mut root, number(p), number(next(q)));
            unite(&mut root, number(next(p)), number(q));
        }
    }
    halved(numbered(shape, &first, &mut root))
}

/// Edges that are still between more than two facets, as where the wedges of an edge hang together around both of its ends:
/// all wedges but one get a corner of their own half way, so that no two share an edge by number.
fn halved(mut shape: Shape) -> Shape {
    let uses = uses(&shape);
    let mut corners: Vec<(usize, usize, u32)> = Vec::new();
    for (&(a, b), ours) in uses.iter().filter(|((a, b), u)| a < b && u.len() > 1) {
        let Some(theirs) = uses.get(&(b, a)).filter(|t| t.len() == ours.len()) else { continue };
        for (p, q) in wedges(&shape, (a, b), ours, theirs).into_iter().skip(1) {
            let middle = shape.vertices.len() as u32;
            shape.vertices.push((shape.vertices[a as usize] + shape.vertices[b as usize]) / 2.0);
            corners.extend([p, q].map(|(f, k)| (f, k + 1, middle)));
        }
    }
    // From behind, so that places before it stay.
    corners.sort_unstable_by(|x, y| y.cmp(x));
    corners.into_iter().for_each(|(f, k, v)| shape.facets[f].corners.insert(k, v));
    shape
}

fn uses(shape: &Shape) -> Uses {
    let mut uses = Uses::new();
    for (f, facet) in shape.facets.iter().enumerate() {
        for (k, &a) in facet.corners.iter().enumerate() {
            let b = facet.corners[(k + 1) % facet.corners.len()];
            uses.entry((a, b)).or_default().push((f, k));
        }
    }
    uses
}

type Use = (usize, usize);

/// Pairs of facets on both sides of the same material: turning about the edge, material begins at a facet that runs
/// against it and ends at the next that runs along it.
fn wedges(shape: &Shape, (a, b): (u32, u32), ours: &[Use], theirs: &[Use]) -> Vec<(Use, Use)> {
    let at = |v: u32| shape.vertices.get(v as usize).copied().unwrap_or_default();
    let axis = (at(b) - at(a)).normalize_or_zero();
    let (x, y) = axis.any_orthonormal_pair();
    let angle = |inward: DVec3| inward.dot(y).atan2(inward.dot(x));
    let along = ours.iter().map(|&u| (angle(shape.facets[u.0].normal.cross(axis)), u));
    let against: Vec<(f64, Use)> =
        theirs.iter().map(|&u| (angle(axis.cross(shape.facets[u.0].normal)), u)).collect();
    let turn = |from: f64, to: f64| (to - from).rem_euclid(std::f64::consts::TAU);
    let mut free = against;
    along
        .filter_map(|(end, p)| {
            let nearest =
                (0..free.len()).min_by(|&i, &j| turn(free[i].0, end).total_cmp(&turn(free[j].0, end)))?;
            Some((p, free.remove(nearest).1))
        })
        .collect()
}

fn find(root: &mut [usize], mut v: usize) -> usize {
    while root[v] != v {
        root[v] = root[root[v]];
        v = root[v];
    }
    v
}

fn unite(root: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(root, a), find(root, b));
    root[a.max(b)] = a.min(b);
}

/// One vertex for each set of corners that were united.
fn numbered(shape: &Shape, first: &[usize], root: &mut [usize]) -> Shape {
    let mut number: BTreeMap<usize, u32> = BTreeMap::new();
    let mut vertices = Vec::new();
    let mut facets = Vec::new();
    for (f, facet) in shape.facets.iter().enumerate() {
        let mut corners = Vec::with_capacity(facet.corners.len());
        for (k, &v) in facet.corners.iter().enumerate() {
            let set = find(root, first[f] + k);
            corners.push(*number.entry(set).or_insert_with(|| {
                vertices.push(shape.vertices.get(v as usize).copied().unwrap_or(DVec3::NAN));
                vertices.len() as u32 - 1
            }));
        }
        facets.push(Facet { corners, normal: facet.normal });
    }
    Shape { vertices, facets }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unit cubes that touch along the upright edge x = y = 1, sharing its two vertices.
    fn two_cubes() -> Shape {
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let normals = [DVec3::NEG_Z, DVec3::Z, DVec3::NEG_Y, DVec3::Y, DVec3::NEG_X, DVec3::X];
        let mut shape = Shape::default();
        for lo in [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0)] {
            let numbers: Vec<u32> = (0..8)
                .map(|k| {
                    let p = lo + DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2));
                    let known = shape.vertices.iter().position(|v| *v == p);
                    known.unwrap_or_else(|| {
                        shape.vertices.push(p);
                        shape.vertices.len() - 1
                    }) as u32
                })
                .collect();
            for (q, normal) in quads.iter().zip(normals) {
                shape.facets.push(Facet { corners: q.iter().map(|&c: &usize| numbers[c]).collect(), normal });
            }
        }
        shape
    }

    #[test]
    fn two_cubes_that_share_an_edge_become_two_closed_bodies() {
        let shape = two_cubes();
        assert_eq!(shape.vertices.len(), 14);
        let parted = parted(&shape);
        assert_eq!(parted.vertices.len(), 16);
        assert!(
            uses(&parted).iter().all(|((a, b), u)| u.len() == 1 && uses(&parted).contains_key(&(*b, *a)))
        );
        let lower: Vec<u32> = parted.facets[..6].iter().flat_map(|f| f.corners.clone()).collect();
        assert!(parted.facets[6..].iter().flat_map(|f| &f.corners).all(|c| !lower.contains(c)));
        assert_eq!(parted.volume(), 2.0);
    }

    /// Cells of a cube of 3 in a ring, of which the first and the last touch in an edge: both ends of the edge are inside the
    /// ring's matter, so doubled numbers alone do not part it.
    fn ring_on_an_edge() -> Shape {
        let cells: Vec<[i32; 3]> =
            vec![[0, 0, 1], [1, 1, 1], [0, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 2], [1, 0, 2], [1, 1, 2]];
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let ways = [[0, 0, -1], [0, 0, 1], [0, -1, 0], [0, 1, 0], [-1, 0, 0], [1, 0, 0]];
        let mut shape = Shape::default();
        for c in &cells {
            for (q, w) in quads.iter().zip(ways) {
                if cells.contains(&[c[0] + w[0], c[1] + w[1], c[2] + w[2]]) {
                    continue;
                }
                let corner = |k: &usize| {
                    let bit = |a: usize| f64::from(c[a] + (*k as i32 >> a & 1));
                    DVec3::new(bit(0), bit(1), bit(2))
                };
                let number = |p: DVec3| {
                    shape.vertices.iter().position(|v| *v == p).unwrap_or_else(|| {
                        shape.vertices.push(p);
                        shape.vertices.len() - 1
                    }) as u32
                };
                let corners = q.iter().map(corner).map(number).collect();
                shape.facets.push(Facet { corners, normal: DVec3::from_array(w.map(f64::from)) });
            }
        }
        shape
    }

    #[test]
    fn an_edge_whose_wedges_hang_together_at_both_ends_is_halved() {
        let shape = ring_on_an_edge();
        assert!(uses(&shape).values().any(|u| u.len() > 1));
        let parted = parted(&shape);
        let uses = uses(&parted);
        assert!(uses.iter().all(|((a, b), u)| u.len() == 1 && uses.contains_key(&(*b, *a))));
        assert!((parted.volume() - 8.0).abs() < 1e-12, "{}", parted.volume());
        assert!(crate::solid::Solid::of(&parted.mesh()).is_ok());
    }

    #[test]
    fn a_shape_without_such_edges_stays_as_it_is() {
        let mut cube = two_cubes();
        cube.facets.truncate(6);
        assert_eq!(parted(&cube), cube);
    }
}
