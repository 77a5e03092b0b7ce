//! Takes a draft; gives whether the cloth hangs together, else the strands that lift off.
//!
//! Promised: exact, for the infinite fabric. Not promised: anything about a finite swatch or about rigid pieces; that
//! is for `locking` to say.
//!
//! Why a finite graph decides. Draw an arc from each strand to every strand that lies over it. A set of strands lifts
//! off when no strand outside lies over one inside: when no arc leaves it. Such a set, neither empty nor everything,
//! exists exactly when the graph is not strongly connected. In the infinite fabric an arc depends on the two residues
//! alone, and each weft crosses each warp: so all members of a class have arcs to all members of the next, and
//! strands u, v are joined by a path exactly when their classes are joined by a path of at least one arc. In a
//! strongly connected graph of classes (there are at least two, a weft and a warp) each class lies on a cycle, so its
//! members reach one another too. The other way, classes that no arc leaves are strands that no arc leaves.

use super::{Draft, Kind, Strand};
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

/// Whether a fabric hangs together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Hanging {
    Together,
    /// `lifts`: the strands of one period (wefts, then warps) that lie over all others wherever they cross.
    FallsApart {
        lifts: Vec<Strand>,
    },
}

/// Whether the infinite fabric of the draft hangs together.
pub fn hangs_together(draft: &Draft) -> Hanging {
    let graph = covers(draft);
    let components = kosaraju_scc(&graph);
    if components.len() == 1 {
        return Hanging::Together;
    }
    let stays = |component: &Vec<NodeIndex>| {
        component.iter().all(|&u| graph.neighbors(u).all(|v| component.binary_search(&v).is_ok()))
    };
    let sorted = components.into_iter().map(|mut component| {
        component.sort();
        component
    });
    let mut lifts: Vec<Strand> = sorted.filter(stays).flatten().map(|u| graph[u]).collect();
    lifts.sort();
    Hanging::FallsApart { lifts }
}

/// The graph over one period's strands with an arc to each strand that lies over.
fn covers(draft: &Draft) -> DiGraph<Strand, ()> {
    let mut graph = DiGraph::new();
    let wefts: Vec<NodeIndex> = draft.strands(Kind::Weft).map(|s| graph.add_node(s)).collect();
    let warps: Vec<NodeIndex> = draft.strands(Kind::Warp).map(|s| graph.add_node(s)).collect();
    for (j, &weft) in wefts.iter().enumerate() {
        for (i, &warp) in warps.iter().enumerate() {
            match draft.weft_over(j as i32, i as i32) {
                true => graph.add_edge(warp, weft, ()),
                false => graph.add_edge(weft, warp, ()),
            };
        }
    }
    graph
}
