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
use rayon::prelude::*;
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

/// The patches of each pair of touching parts, by index.
pub type Pairs = BTreeMap<(PartIx, PartIx), Vec<usize>>;

pub fn pairs(patches: &[Patch]) -> Pairs {
    let mut pairs = Pairs::new();
    for (k, p) in patches.iter().enumerate() {
        pairs.entry((p.a, p.b)).or_default().push(k);
    }
    pairs
}

/// Arcs where a patch opposes the very start of a motion along the unit direction `d`: one for each such pair, with the
/// patch that opposes it most.
pub fn infinitesimal(parts: &[PartIx], patches: &[Patch], pairs: &Pairs, d: DVec3) -> Dbg {
    let (mut graph, at) = nodes(parts);
    for ((a, b), of) in pairs {
        let (Some(&a), Some(&b)) = (at.get(a), at.get(b)) else { continue };
        for (from, to, sign) in [(a, b, 1.0), (b, a, -1.0)] {
            let push = |k: usize| sign * patches[k].normal.dot(d);
            let most = of.iter().copied().max_by(|&k, &l| push(k).total_cmp(&push(l)));
            if let Some(k) = most.filter(|&k| push(k) > SAME_ANGLE) {
                graph.add_edge(from, to, Witness::Patch(k));
            }
        }
    }
    graph
}

/// Arcs where a part, moved along the view's direction to infinity, meets the interior of another.
pub fn finite(view: &View, parts: &[PartIx], touch: Touch) -> Dbg {
    let mut graph = nodes(parts).0;
    stop_later(&mut graph, view, touch, |_, _| true);
    graph
}

/// Adds the finite arcs between those nodes that `ask` names.
pub fn stop_later(
    graph: &mut Dbg,
    view: &View,
    touch: Touch,
    ask: impl Fn(NodeIndex, NodeIndex) -> bool + Sync,
) {
    let nodes: Vec<NodeIndex> = graph.node_indices().collect();
    let stopped = |i: NodeIndex| -> Vec<(NodeIndex, NodeIndex, Meeting)> {
        let others = nodes.iter().filter(|&&j| j != i && ask(i, j));
        others.filter_map(|&j| meets(view, graph[i], graph[j], touch).map(|m| (i, j, m))).collect()
    };
    let found: Vec<Vec<_>> = nodes.par_iter().map(|&i| stopped(i)).collect();
    for (i, j, m) in found.into_iter().flatten() {
        graph.add_edge(i, j, Witness::Cells(m));
    }
}

/// The number of each node's strongly connected component.
pub fn component_of(graph: &Dbg) -> Vec<usize> {
    let mut of = vec![0; graph.node_count()];
    for (k, component) in tarjan_scc(graph).iter().enumerate() {
        component.iter().for_each(|n| of[n.index()] = k);
    }
    of
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
    let (components, of) = (tarjan_scc(graph), component_of(graph));
    let closed = |c: &&Vec<NodeIndex>| {
        c.iter().all(|&n| graph.neighbors_directed(n, none).all(|m| of[m.index()] == of[n.index()]))
    };
    let sorted = |c: &Vec<NodeIndex>| {
        let mut parts: Vec<PartIx> = c.iter().map(|&n| graph[n]).collect();
        parts.sort();
        parts
    };
    let mut out: Vec<Vec<PartIx>> = components.iter().filter(closed).map(sorted).collect();
    out.sort();
    out
}
