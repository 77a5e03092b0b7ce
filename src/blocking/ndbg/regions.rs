//! Takes the arrangement of critical directions and the pairs of parts, gives regions: connected sets of directions with
//! one blocking graph, and the graphs, each once.
//!
//! Exact where the arrangement is. Graphs are in the order of their arcs, regions in that of dimension and place.

use super::arrangement::Arrangement;
use super::between::{Numbered, On, Place};
use super::circles::Circles;
use super::{MOST_ARCS, Ndbg, NotRun};
use crate::assembly::{Assembly, PartIx};
use crate::blocking::graph::{Dbg, Witness, loose, tie};
use glam::DVec3;
use petgraph::algo::tarjan_scc;
use petgraph::unionfind::UnionFind;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// A directional blocking graph.
#[derive(Clone, Debug)]
pub struct Graph {
    /// Which ordered pairs block, two bits for each pair.
    pub(super) bits: Vec<u64>,
    /// From a part to each that stops it. Held parts keep their places to one another; that is no arc.
    pub arcs: Vec<(PartIx, PartIx)>,
    /// Strongly connected components, held parts tied together; each sorted, in the order of their first part.
    pub components: Vec<Vec<PartIx>>,
    /// Smallest sets that can leave: components without an arc out of them, without a held part.
    pub leave: Vec<Vec<PartIx>>,
}

/// A connected set of directions with one graph.
#[derive(Clone, Debug)]
pub struct Region {
    /// A unit direction inside.
    pub d: DVec3,
    /// 2: an open patch of the sphere (with what joins it); 1: an arc; 0: a single direction.
    pub dimension: u8,
    pub graph: usize,
}

/// Two bits for each pair: the first runs into the second, the second into the first.
pub(super) fn bits(pairs: &[Numbered], place: Place) -> Vec<u64> {
    let mut bits = vec![0; pairs.len().div_ceil(32)];
    for (k, pair) in pairs.iter().enumerate() {
        let [there, back] = pair.stops(place);
        bits[k / 32] |= (u64::from(there) | u64::from(back) << 1) << (k % 32 * 2);
    }
    bits
}

/// Faces, then edges, then vertices, in one numbering.
fn places(circles: &Circles, arr: &Arrangement) -> Vec<Place> {
    let faces = arr.faces.iter().map(|f| Place { d: f.d, on: On::Nothing });
    let edges = arr.edges.iter().map(|e| {
        let d = circles.at(e.circle, (e.start + e.end) / 2.0);
        Place { d, on: if e.shared { On::Crossing } else { On::Circle(e.circle) } }
    });
    let vertices = arr.vertices.iter().map(|&d| Place { d, on: On::Crossing });
    faces.chain(edges).chain(vertices).collect()
}

/// Cells that bound one another: an edge and its faces, a vertex and its edges.
fn bounds(arr: &Arrangement) -> Vec<(usize, usize)> {
    let (f, e) = (arr.faces.len(), arr.edges.len());
    let mut out = Vec::with_capacity(4 * e);
    for (k, arc) in arr.edges.iter().enumerate() {
        out.extend([arc.left, arc.right].map(|face| (face, f + k)));
        out.extend([arc.from, arc.to].map(|v| (f + k, f + e + v)));
    }
    out
}

pub(super) fn regions(
    asm: &Assembly,
    pairs: Vec<Numbered>,
    circles: Circles,
    arr: Arrangement,
) -> Result<Ndbg, NotRun> {
    let places = places(&circles, &arr);
    let found: Vec<Vec<u64>> = places.par_iter().map(|&p| bits(&pairs, p)).collect();
    let distinct: BTreeSet<&Vec<u64>> = found.iter().collect();
    let number: BTreeMap<&Vec<u64>, usize> = distinct.into_iter().enumerate().map(|(k, b)| (b, k)).collect();
    let graph_of: Vec<usize> = found.iter().map(|b| number[b]).collect();
    let graphs: Vec<Vec<u64>> = number.keys().map(|b| (*b).clone()).collect();
    let arcs = graphs.iter().flatten().map(|w| w.count_ones() as usize).sum();
    if arcs > MOST_ARCS {
        return Err(NotRun::TooManyArcs { found: arcs });
    }
    let graphs = graphs.into_par_iter().map(|b| graph(asm, &pairs, b)).collect();
    let bounds = bounds(&arr);
    let mut joined = UnionFind::<usize>::new(places.len());
    for &(x, y) in bounds.iter().filter(|&&(x, y)| graph_of[x] == graph_of[y]) {
        joined.union(x, y);
    }
    let of = joined.into_labeling();
    // The first cell of a region is one of its largest dimension: faces come first.
    let mut first: BTreeMap<usize, usize> = BTreeMap::new();
    for (cell, &label) in of.iter().enumerate() {
        first.entry(label).or_insert(cell);
    }
    let mut heads: Vec<usize> = first.values().copied().collect();
    heads.sort_unstable();
    let (f, e) = (arr.faces.len(), arr.edges.len());
    let rank: BTreeMap<usize, usize> = heads.iter().enumerate().map(|(k, &h)| (of[h], k)).collect();
    let region = |&cell: &usize| {
        let dimension = if cell < f { 2 } else { u8::from(cell < f + e) };
        Region { d: places[cell].d, dimension, graph: graph_of[cell] }
    };
    let region_of: Vec<usize> = of.iter().map(|label| rank[label]).collect();
    let beside: BTreeSet<(usize, usize)> = bounds
        .iter()
        .map(|&(x, y)| (region_of[x].min(region_of[y]), region_of[x].max(region_of[y])))
        .filter(|(x, y)| x != y)
        .collect();
    Ok(Ndbg {
        parts: asm.ids().collect(),
        held: asm.held().collect(),
        graphs,
        regions: heads.iter().map(region).collect(),
        beside: beside.into_iter().collect(),
        region_of: [&region_of[..f], &region_of[f..f + e], &region_of[f + e..]].map(<[usize]>::to_vec),
        circles,
        arrangement: arr,
        pairs,
    })
}

fn graph(asm: &Assembly, pairs: &[Numbered], bits: Vec<u64>) -> Graph {
    let mut arcs = Vec::new();
    for (k, pair) in pairs.iter().enumerate() {
        let both = bits[k / 32] >> (k % 32 * 2) & 3;
        arcs.extend((both & 1 == 1).then_some((pair.a, pair.b)));
        arcs.extend((both & 2 == 2).then_some((pair.b, pair.a)));
    }
    arcs.sort_unstable();
    let held: BTreeSet<PartIx> = asm.held().collect();
    let (components, leave) = parted(asm, &held, &arcs);
    Graph { bits, arcs, components, leave }
}

type Sets = Vec<Vec<PartIx>>;

fn parted(asm: &Assembly, held: &BTreeSet<PartIx>, arcs: &[(PartIx, PartIx)]) -> (Sets, Sets) {
    let mut dbg = Dbg::new();
    let nodes: Vec<_> = asm.ids().map(|p| dbg.add_node(p)).collect();
    for &(i, j) in arcs {
        dbg.add_edge(nodes[i.at()], nodes[j.at()], Witness::Held);
    }
    tie(&mut dbg, |p| held.contains(&p));
    components_and_leavers(&dbg, held)
}

/// Strongly connected components, and those that can leave: none of their parts is held, and they are not all there is.
pub fn components_and_leavers(dbg: &Dbg, held: &BTreeSet<PartIx>) -> (Sets, Sets) {
    let mut components: Sets = tarjan_scc(dbg)
        .into_iter()
        .map(|c| {
            let mut parts: Vec<PartIx> = c.into_iter().map(|n| dbg[n]).collect();
            parts.sort_unstable();
            parts
        })
        .collect();
    components.sort();
    let mut leave = loose(dbg, petgraph::Direction::Outgoing);
    leave.retain(|c| c.len() < dbg.node_count() && c.iter().all(|p| !held.contains(p)));
    (components, leave)
}
