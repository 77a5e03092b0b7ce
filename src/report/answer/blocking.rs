//! Takes blocking graphs as found, gives the answer of `blocking` as it is written.
//!
//! Not promised: more than the graphs carry; infinitesimal ones are first order.

use super::{Source, ids};
use crate::assembly::{Assembly, PartIx};
use crate::blocking::graph::{Dbg, Witness};
use crate::blocking::ndbg::{Ndbg, NotRun, Reach, components_and_leavers};
use crate::contact::Joined;
use petgraph::visit::EdgeRef;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// At the start of a motion (`infinitesimal`), or on the whole way to infinity (`finite`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ReachWord {
    Infinitesimal,
    Finite,
}

/// Whether every directional blocking graph is strongly connected. That is less than a lock in translation: parts that
/// move in different directions at once are not seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Connected {
    Everywhere,
    NotEverywhere,
    NotRun,
}

/// Why one part stops another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum WitnessAnswer {
    /// Index of the contact patch on which it pushes at once.
    Patch(usize),
    /// Indices of two convex cells that meet on the way, and how far their shadows overlap (model units).
    Cells { moving: usize, still: usize, depth: f64 },
}

/// An arc of a graph: `from`, moved along the direction, is stopped by `to`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ArcAnswer {
    pub from: String,
    pub to: String,
    pub witness: WitnessAnswer,
}

/// The directional blocking graph of one direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DbgAnswer {
    /// Unit vector.
    pub direction: [f64; 3],
    pub arcs: Vec<ArcAnswer>,
    /// Strongly connected components; held parts, which keep their places to one another, are tied together.
    pub components: Vec<Vec<String>>,
    /// The smallest sets that no arc leaves and that hold no held part: each can leave along the direction.
    pub leave: Vec<Vec<String>>,
}

/// A blocking graph of the NDBG.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GraphAnswer {
    /// Places of two parts in `parts`: the first is stopped by the second.
    pub arcs: Vec<[usize; 2]>,
    pub components: Vec<Vec<String>>,
    pub leave: Vec<Vec<String>>,
}

/// A connected set of directions with one blocking graph.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellAnswer {
    /// A unit direction inside.
    pub direction: [f64; 3],
    /// 2: a patch of the sphere; 1: an arc; 0: this direction alone.
    pub dimension: u8,
    /// Index into `graphs`.
    pub graph: usize,
}

/// The non-directional blocking graph: which graph holds where on the sphere of directions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct NdbgAnswer {
    pub graphs: Vec<GraphAnswer>,
    pub cells: Vec<CellAnswer>,
    /// Pairs of cells that bound one another, by index.
    pub beside: Vec<[usize; 2]>,
    /// Directions that differ by less count as one, radians.
    pub resolution: f64,
    /// The widest angle, radians, between two critical directions that were counted as one. Far below
    /// the resolution nothing was decided by it: a finer one gives the same cells.
    pub merged: f64,
}

/// Answer of `blocking`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BlockingAnswer {
    pub verb: String,
    pub name: String,
    pub reach: ReachWord,
    pub parts: Vec<String>,
    pub held: Vec<String>,
    pub strongly_connected: Connected,
    /// The graph of the direction asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dbg: Option<DbgAnswer>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ndbg: Option<NdbgAnswer>,
    /// Why what was asked for is not here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_run: Option<String>,
    /// True where the user stopped it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
    pub remarks: Vec<String>,
    pub source: Source,
}

/// What was found, before it is written.
pub struct Found<'a> {
    pub reach: Reach,
    pub dbg: Option<DbgAnswer>,
    pub ndbg: Option<&'a Result<Ndbg, NotRun>>,
    pub not_run: Option<String>,
}

pub fn blocking(joined: &Joined, found: Found, source: Source) -> BlockingAnswer {
    let asm = &joined.assembly;
    let all: Vec<PartIx> = asm.ids().collect();
    let ndbg = found.ndbg.and_then(|n| n.as_ref().ok());
    let why = found.ndbg.and_then(|n| n.as_ref().err()).map(ToString::to_string);
    BlockingAnswer {
        verb: "blocking".into(),
        name: asm.name.clone(),
        reach: match found.reach {
            Reach::Infinitesimal => ReachWord::Infinitesimal,
            Reach::Finite => ReachWord::Finite,
        },
        parts: ids(asm, &all),
        held: ids(asm, &asm.held().collect::<Vec<_>>()),
        strongly_connected: ndbg.map_or(Connected::NotRun, connected),
        dbg: found.dbg,
        ndbg: ndbg.map(|n| written(asm, n)),
        not_run: found.not_run.or(why),
        stopped: matches!(found.ndbg, Some(Err(NotRun::Stopped))),
        remarks: joined.remarks.clone(),
        source,
    }
}

fn connected(n: &Ndbg) -> Connected {
    if n.connected() == n.graphs.len() { Connected::Everywhere } else { Connected::NotEverywhere }
}

fn sets(asm: &Assembly, sets: &[Vec<PartIx>]) -> Vec<Vec<String>> {
    sets.iter().map(|s| ids(asm, s)).collect()
}

fn written(asm: &Assembly, n: &Ndbg) -> NdbgAnswer {
    let graphs = n.graphs.iter().map(|g| GraphAnswer {
        arcs: g.arcs.iter().map(|(i, j)| [i.at(), j.at()]).collect(),
        components: sets(asm, &g.components),
        leave: sets(asm, &g.leave),
    });
    let cells = n.regions.iter().map(|r| CellAnswer {
        direction: r.d.to_array(),
        dimension: r.dimension,
        graph: r.graph,
    });
    NdbgAnswer {
        graphs: graphs.collect(),
        cells: cells.collect(),
        beside: n.beside.iter().map(|&(a, b)| [a, b]).collect(),
        resolution: n.circles.resolution().near(),
        merged: n.arrangement.merged,
    }
}

/// A graph of one direction, without the ties between held parts.
pub fn dbg(asm: &Assembly, direction: [f64; 3], graph: &Dbg, tied: &Dbg) -> DbgAnswer {
    let held: BTreeSet<PartIx> = asm.held().collect();
    let (components, leave) = components_and_leavers(tied, &held);
    let id = |p: PartIx| asm.part(p).id.clone();
    let arcs = graph.edge_references().filter_map(|e| {
        let witness = match *e.weight() {
            Witness::Patch(k) => WitnessAnswer::Patch(k),
            Witness::Cells(m) => WitnessAnswer::Cells { moving: m.a, still: m.b, depth: m.depth },
            Witness::Held => return None,
        };
        Some(ArcAnswer { from: id(graph[e.source()]), to: id(graph[e.target()]), witness })
    });
    let mut arcs: Vec<ArcAnswer> = arcs.collect();
    let place = |id: &String| asm.parts.iter().position(|p| p.id == *id);
    arcs.sort_by_cached_key(|a| (place(&a.from), place(&a.to)));
    DbgAnswer { direction, arcs, components: sets(asm, &components), leave: sets(asm, &leave) }
}
