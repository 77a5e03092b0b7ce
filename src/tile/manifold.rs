//! Takes a solid; says whether its boundary is a closed, oriented 2-manifold of genus 0, in one body.
//!
//! Combinatorial and complete: edges, links of vertices, Euler's formula. Not promised: that facets do not cut each
//! other in space; for unions of Voronoi cells they cannot.

use crate::solid::Solid;
use glam::DVec3;
use std::collections::HashMap;

/// What is wrong with a boundary, and where.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotASolid {
    #[error("it has no facets")]
    Empty,
    #[error("it meets itself along the edge from {0} to {1}")]
    Edge(DVec3, DVec3),
    #[error("it meets itself in the point {0}")]
    Vertex(DVec3),
    #[error("Euler's number is {0}, but 2 for a body without holes")]
    Genus(i64),
}

/// Closed, oriented, manifold at every vertex, Euler's number 2.
pub fn check(solid: &Solid) -> Result<(), NotASolid> {
    let next = half_edges(solid)?;
    let mut fans: HashMap<u32, u32> = HashMap::new();
    for f in &solid.facets {
        for &v in &f.corners {
            *fans.entry(v).or_default() += 1;
        }
    }
    let used = fans.len() as i64;
    one_fan_a_vertex(solid, &next, &fans)?;
    let euler = used - next.len() as i64 / 2 + solid.facets.len() as i64;
    match (solid.facets.len(), euler) {
        (0, _) => Err(NotASolid::Empty),
        (_, 2) => Ok(()),
        (_, e) => Err(NotASolid::Genus(e)),
    }
}

/// Directed edge (a, b) -> the corner before a in its facet; an error unless each has its opposite, once.
fn half_edges(solid: &Solid) -> Result<HashMap<(u32, u32), u32>, NotASolid> {
    let mut before = HashMap::new();
    let at = |v: u32| solid.vertices[v as usize];
    for f in &solid.facets {
        let n = f.corners.len();
        for k in 0..n {
            let (a, b, last) = (f.corners[k], f.corners[(k + 1) % n], f.corners[(k + n - 1) % n]);
            if before.insert((a, b), last).is_some() {
                return Err(NotASolid::Edge(at(a), at(b)));
            }
        }
    }
    match before.keys().filter(|(a, b)| !before.contains_key(&(*b, *a))).min() {
        Some(&(a, b)) => Err(NotASolid::Edge(at(a), at(b))),
        None => Ok(before),
    }
}

/// Turning around a vertex from facet to facet passes all of its facets.
fn one_fan_a_vertex(
    solid: &Solid,
    before: &HashMap<(u32, u32), u32>,
    fans: &HashMap<u32, u32>,
) -> Result<(), NotASolid> {
    let mut turned: HashMap<u32, u32> = HashMap::new();
    for &(a, b) in before.keys() {
        if turned.contains_key(&a) {
            continue;
        }
        let (mut to, mut count) = (b, 0);
        loop {
            count += 1;
            // The facet of (a, to) comes to a from `before`; the next facet around a leaves along that edge.
            to = before[&(a, to)];
            if to == b || count > fans[&a] {
                break;
            }
        }
        turned.insert(a, count);
    }
    let pinched = turned.iter().filter(|(v, n)| fans[v] != **n).map(|(v, _)| *v).min();
    pinched.map_or(Ok(()), |v| Err(NotASolid::Vertex(solid.vertices[v as usize])))
}
