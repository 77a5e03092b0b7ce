//! Takes a set of parts and a direction, gives its directional blocking graph (DBG): a node for each part, an arc from
//! each part to every part that stops it, with a witness; and the sets that can leave.
//!
//! The infinitesimal graph is first order only: a set that no arc holds may still be stopped later on its way.

use super::shadow::View;
use super::sweep::{Meeting, meets};
use super::{SAME_ANGLE, Touch};
use crate::assembly::PartIx;
use crate::contact::Patch;
use glam::DVec3;
use petgraph::Direction;
use petgraph::algo::tarjan_scc;
use petgraph::graph::{DiGraph, NodeIndex};
use std::collections::BTreeMap;

/// Why one part stops another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Witness {
    /// Index of the patch on which one pushes the other at once.
    Patch(usize),
    /// The cells that meet on the way.
    Cells(Meeting),
    /// Both are held: they keep their places to one another.
    Held,
}

/// Nodes are in the order of the parts given.
pub type Dbg = DiGraph<PartIx, Witness>;

fn nodes(parts: &[PartIx]) -> (Dbg, BTreeMap<PartIx, NodeIndex>) {
    let mut graph = Dbg::new();
    let at = parts.iter().map(|&p| (p, graph.add_node(p))).collect();
    (graph, at)
}

/// Arcs where a patch opposes the very start of a motion along the unit direction `d`: one for each such pair, with the
/// patch that opposes it most.
pub fn infinitesimal(parts: &[PartIx], patches: &[Patch], d: DVec3) -> Dbg {
    let (mut graph, at) = nodes(parts);
    let mut most: BTreeMap<(NodeIndex, NodeIndex), (f64, usize)> = BTreeMap::new();
    for (k, patch) in patches.iter().enumerate() {
        let push = patch.normal.dot(d);
        if let (Some(&a), Some(&b)) = (at.get(&patch.a), at.get(&patch.b)) {
            let arc = if push > 0.0 { (a, b) } else { (b, a) };
            let best = most.entry(arc).or_insert((SAME_ANGLE, k));
            if push.abs() > best.0 {
                *best = (push.abs(), k);
            }
        }
    }
    for ((a, b), (push, k)) in most {
        if push > SAME_ANGLE {
            graph.add_edge(a, b, Witness::Patch(k));
        }
    }
    graph
}

/// Arcs where a part, moved along the view's direction to infinity, meets the interior of another.
pub fn finite(view: &View, parts: &[PartIx], touch: Touch) -> Dbg {
    let (mut graph, at) = nodes(parts);
    for &i in parts {
        for &j in parts.iter().filter(|&&j| j != i) {
            if let Some(meeting) = meets(view, i, j, touch) {
                graph.add_edge(at[&i], at[&j], Witness::Cells(meeting));
            }
        }
    }
    graph
}

/// Ties the held parts together, so that no component parts them.
pub fn tie(graph: &mut Dbg, is_held: impl Fn(PartIx) -> bool) {
    let held: Vec<NodeIndex> = graph.node_indices().filter(|&n| is_held(graph[n])).collect();
    for (k, &n) in held.iter().enumerate().filter(|_| held.len() > 1) {
        graph.add_edge(n, held[(k + 1) % held.len()], Witness::Held);
    }
}

/// Strongly connected components with no arc leaving (`Outgoing`: they can move along d) or none entering (`Incoming`:
/// they can move along -d), each sorted, in the order of their first part. The whole set when it is one component.
pub fn loose(graph: &Dbg, none: Direction) -> Vec<Vec<PartIx>> {
    let components = tarjan_scc(graph);
    let of: BTreeMap<NodeIndex, usize> =
        components.iter().enumerate().flat_map(|(k, c)| c.iter().map(move |&n| (n, k))).collect();
    let closed =
        |c: &&Vec<NodeIndex>| c.iter().all(|&n| graph.neighbors_directed(n, none).all(|m| of[&m] == of[&n]));
    let sorted = |c: &Vec<NodeIndex>| {
        let mut parts: Vec<PartIx> = c.iter().map(|&n| graph[n]).collect();
        parts.sort();
        parts
    };
    let mut out: Vec<Vec<PartIx>> = components.iter().filter(closed).map(sorted).collect();
    out.sort();
    out
}
