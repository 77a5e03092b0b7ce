//! Takes a set of parts none of which can leave alone, gives a group that can leave together by one straight move, or
//! says that no group can, or that the search gave up.
//!
//! In a direction whose blocking graph is strongly connected nothing can leave; the arcs of a spanning in-tree and
//! out-tree keep it so in the whole intersection of their cones, which is taken away at once. Opposite directions have
//! transposed graphs, so half the sphere is enough. Sound; `Never` is complete as in `leave`.

use super::field::{Field, Set};
use super::leave::landmarks;
use crate::assembly::PartIx;
use crate::blocking::SAME_ANGLE;
use crate::blocking::cone::{Cone, polar};
use crate::blocking::graph::{Dbg, Witness, component_of, infinitesimal, loose, stop_later, tie};
use crate::blocking::sector::{Blocked, Sector, sectors};
use crate::blocking::shadow::View;
use glam::DVec3;
use petgraph::Direction;
use petgraph::graph::{EdgeReference, NodeIndex};
use petgraph::visit::EdgeRef;
use std::collections::VecDeque;

/// Blocking graphs made for one set before giving up.
const MOST_GRAPHS: usize = 300;

#[derive(Clone, Debug)]
pub enum Group {
    /// These leave along this unit direction; none of them is held.
    Leaves {
        parts: Set,
        along: DVec3,
    },
    Never,
    GaveUp,
}

/// What was found, and how many blocking graphs were made.
pub struct GroupSearch {
    pub group: Group,
    pub tried: usize,
}

pub fn group(field: &Field, set: &Set, prefer: &[DVec3]) -> GroupSearch {
    let parts: Vec<PartIx> = set.iter().copied().collect();
    let mut tried = Vec::new();
    for d in prefer.iter().copied().chain(hints(field, set)) {
        if tried.len() < MOST_GRAPHS && is_new(&tried, d) && !field.watch.is_stopped() {
            tried.push(d);
            if let Some(found) = parting(field, set, &dbg(field, &parts, d), d) {
                return GroupSearch { group: found, tried: tried.len() };
            }
        }
    }
    let mut left: VecDeque<Sector> = half_sphere(field, set).into();
    while let Some(sector) = left.pop_front() {
        let d = sector.middle();
        if tried.len() >= MOST_GRAPHS || field.watch.is_stopped() {
            return GroupSearch { group: Group::GaveUp, tried: tried.len() };
        }
        tried.push(d);
        let graph = dbg(field, &parts, d);
        if let Some(found) = parting(field, set, &graph, d) {
            return GroupSearch { group: found, tried: tried.len() };
        }
        let blocked = kept_together(field, &graph, d);
        left.extend(if blocked.holds(d) { blocked.taken_from(&sector) } else { sector.split(d) });
    }
    GroupSearch { group: Group::Never, tried: tried.len() }
}

/// Opposite directions count as one.
fn is_new(tried: &[DVec3], d: DVec3) -> bool {
    tried.iter().all(|t| t.distance(d) > SAME_ANGLE && t.distance(-d) > SAME_ANGLE)
}

/// First-order arcs, and finite ones between components that those leave apart: enough to know the components.
fn dbg(field: &Field, parts: &[PartIx], d: DVec3) -> Dbg {
    let mut graph = infinitesimal(parts, field.patches, &field.pairs, d);
    tie(&mut graph, |p| field.is_held(p));
    let of = component_of(&graph);
    if of.iter().any(|&k| k != of[0]) {
        let view = View::new(&field.shapes, d);
        stop_later(&mut graph, &view, field.touch, |i, j| of[i.index()] != of[j.index()]);
    }
    graph
}

/// Directions in which single parts, or pairs of neighbors, may start to move.
fn hints(field: &Field, set: &Set) -> Vec<DVec3> {
    let single = |&p: &PartIx| Set::from([p]);
    let pair = |&p: &PartIx| {
        let beside: Set = field.sides(&single(&p), set).map(|s| s.other).filter(|&q| q > p).collect();
        beside.into_iter().map(move |q| Set::from([p, q])).collect::<Vec<_>>()
    };
    let groups = set.iter().map(single).chain(set.iter().flat_map(pair));
    let cone = |g: Set| {
        let rest = set.difference(&g).copied().collect();
        polar(field.sides(&g, &rest).map(|s| s.normal))
    };
    groups.map(cone).flat_map(|c| landmarks(&c).collect::<Vec<_>>()).collect()
}

/// The smallest group that the graph lets go along d or -d.
fn parting(field: &Field, set: &Set, graph: &Dbg, d: DVec3) -> Option<Group> {
    let along = loose(graph, Direction::Outgoing).into_iter().map(|g| (g, d));
    let back = loose(graph, Direction::Incoming).into_iter().map(|g| (g, -d));
    let both = along.chain(back).filter(|(g, _)| g.len() < set.len());
    let may = both.map(|(g, d)| {
        let group: Set = g.into_iter().collect();
        let rest: Set = set.difference(&group).copied().collect();
        let has_held = |s: &Set| s.iter().any(|&p| field.is_held(p));
        match (has_held(&group), has_held(&rest)) {
            (true, _) => (rest, -d),
            (false, false) if rest.len() < group.len() => (rest, -d),
            _ => (group, d),
        }
    });
    let size = |s: &Set| (s.len(), s.iter().map(|&p| field.volume(p)).sum::<f64>());
    let best = may.min_by(|(a, _), (b, _)| {
        let ((na, va), (nb, vb)) = (size(a), size(b));
        na.cmp(&nb).then(va.total_cmp(&vb)).then(a.cmp(b))
    });
    best.map(|(parts, along)| Group::Leaves { parts, along })
}

/// Four sectors that cover a half sphere, in a frame that turns with the assembly where it has patches.
fn half_sphere(field: &Field, set: &Set) -> Vec<Sector> {
    let mut normals = field.sides(set, set).map(|s| s.normal);
    let z = normals.next().unwrap_or(DVec3::Z);
    let x = normals
        .map(|n| n.reject_from_normalized(z))
        .find(|n| n.length() > SAME_ANGLE.sqrt())
        .map_or_else(|| z.any_orthonormal_vector(), DVec3::normalize);
    sectors(&Cone { lines: vec![x, z.cross(x)], rays: vec![z], middle: None })
}

/// Directions around d in which the graph is known to stay strongly connected.
fn kept_together(field: &Field, graph: &Dbg, d: DVec3) -> Blocked {
    let arcs: Vec<Arc> = graph.edge_references().map(|e| arc(field, graph, e, d)).collect();
    let Some(root) = graph.node_indices().next() else { return Blocked(vec![]) };
    let ways = [Direction::Outgoing, Direction::Incoming];
    let trees = ways.into_iter().flat_map(|way| spanning(graph.node_count(), &arcs, root, way));
    Blocked(trees.flat_map(|a| a.blocked.0.iter().copied()).collect())
}

/// An arc, the directions in which it is there, and how far inside them d is, in radians to first order.
struct Arc {
    from: NodeIndex,
    to: NodeIndex,
    blocked: Blocked,
    margin: f64,
}

fn arc(field: &Field, graph: &Dbg, e: EdgeReference<Witness>, d: DVec3) -> Arc {
    let (from, to) = (e.source(), e.target());
    let blocked = match *e.weight() {
        Witness::Held => Blocked(vec![]),
        Witness::Patch(k) => {
            let n = field.patches[k].normal;
            Blocked::by_patch(if n.dot(d) > 0.0 { n } else { -n })
        }
        Witness::Cells(m) => field.blocked(graph[from], m.a, graph[to], m.b),
    };
    let margin = blocked.0.iter().map(|n| n.dot(d)).fold(1.0, f64::min);
    Arc { from, to, blocked, margin }
}

/// The tree from (or to) the root that always takes the arc with the widest margin next.
fn spanning(nodes: usize, arcs: &[Arc], root: NodeIndex, way: Direction) -> Vec<&Arc> {
    let mut inside = vec![false; nodes];
    inside[root.index()] = true;
    let mut tree = Vec::new();
    while tree.len() + 1 < nodes {
        let ends = |a: &Arc| if way == Direction::Outgoing { (a.from, a.to) } else { (a.to, a.from) };
        let open = arcs.iter().filter(|a| inside[ends(a).0.index()] && !inside[ends(a).1.index()]);
        let Some(widest) = open.max_by(|a, b| a.margin.total_cmp(&b.margin)) else { break };
        inside[ends(widest).1.index()] = true;
        tree.push(widest);
    }
    tree
}
