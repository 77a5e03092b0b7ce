//! Takes parts in place and their patches; gives the non-directional blocking graph (NDBG, Wilson and Latombe) for
//! translations: the sphere of directions cut into regions, each with one directional blocking graph (DBG).
//!
//! Over the arrangement of all critical directions, none sampled; infinitesimal or for the whole way. Directions
//! nearer to one another than the [`Resolution`] count as one: round-off, or what the digits of a file leave open. How
//! far apart those were that did is told; where that is round-off too, every sign is the exact one.
//! Cost: about the square of the critical arcs; budgets are stated and what exceeds them is not run.
//!
//! Tried and left: whole great circles instead of arcs (a 2 x 2 window has thousands on the whole way, most of them
//! critical nowhere); one arrangement of the edges of all free sectors (60,000 crossings for eight strands); an
//! arrangement for each pair first, of those edges. Now the edges of each union of cones are found as such, one
//! dimension at a time (`union`): each is critical, none is left out.
//!
//! Laws (tested):
//! 1. What stops a part along a direction stops it along all directions near by: a graph on an edge or at a vertex has
//!    no arc that the graphs around it lack.
//! 2. The graph of -d is that of d with all arcs turned round.
//! 3. Turning the assembly turns the regions and changes no graph.

pub mod arrangement;
pub mod between;
pub mod caps;
pub mod circles;
mod regions;
pub mod union;

pub use regions::{Graph, Region, components_and_leavers};

use super::Touch;
use super::graph::pairs;
use super::shadow::Shapes;
use crate::assembly::{Assembly, Mobility, PartIx};
use crate::contact::{Patch, Touching};
use crate::watch::{All, Watch};
use arrangement::{Arrangement, Critical, NoArrangement, arrangement};
use between::{Between, Numbered, On, Place, Start, Work};
use circles::Circles;
pub use circles::Resolution;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Which blocking: at the very start of a motion, or on the whole way to infinity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    Infinitesimal,
    Finite,
}

/// Pairs of cells, counted once for congruent pairs of parts, beyond this are not put into each other's way: each costs up to 100 microseconds.
pub const MOST_CELL_PAIRS: usize = 500_000;

/// Steps of the free sectors' making beyond this are not taken: each costs some nanoseconds, a bite out of a sector
/// some microseconds.
pub const MOST_STEPS: usize = 1_000_000_000;

/// Arcs of all distinct graphs together beyond this are not kept: some hundred megabytes as an answer.
pub const MOST_ARCS: usize = 20_000_000;

/// Why there is no NDBG.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotRun {
    #[error("part `{0}` is not made of convex cells, which blocking on the whole way needs")]
    NoCells(String),
    #[error("{found} pairs of cells, more than the {MOST_CELL_PAIRS} that are looked at")]
    TooManyCells { found: usize },
    #[error("more than {MOST_STEPS} steps to find what the pairs of parts leave free")]
    TooManySteps,
    #[error("{found} arcs in all blocking graphs, more than the {MOST_ARCS} that are kept")]
    TooManyArcs { found: usize },
    #[error("stopped by the user")]
    Stopped,
    #[error(transparent)]
    NoArrangement(#[from] NoArrangement),
}

/// The sphere of directions in regions.
#[derive(Clone, Debug)]
pub struct Ndbg {
    pub parts: Vec<PartIx>,
    pub held: Vec<PartIx>,
    pub graphs: Vec<Graph>,
    /// Largest dimension first.
    pub regions: Vec<Region>,
    /// Regions that bound one another, lower number first.
    pub beside: Vec<(usize, usize)>,
    pub circles: Circles,
    pub arrangement: Arrangement,
    /// The region of each face, edge and vertex of the arrangement.
    pub region_of: [Vec<usize>; 3],
    pairs: Vec<Numbered>,
}

/// The NDBG of all parts.
pub fn ndbg(known: Touching<'_>, reach: Reach) -> Result<Ndbg, NotRun> {
    ndbg_watched(known, reach, &Watch::default())
}

/// The same, watched: there is nothing before all pairs are known, so a stopped one is not run. As fine as the digits
/// allow; once more at the coarsest resolution where directions lie too near one another for that.
pub fn ndbg_watched(known: Touching<'_>, reach: Reach, watch: &Watch) -> Result<Ndbg, NotRun> {
    match at_resolution(known, reach, Resolution::of(known.slack), watch) {
        Err(NotRun::NoArrangement(NoArrangement::TooNear { .. })) => {
            at_resolution(known, reach, Resolution::COARSEST, watch)
        }
        found => found,
    }
}

fn at_resolution(
    known: Touching<'_>,
    reach: Reach,
    resolution: Resolution,
    watch: &Watch,
) -> Result<Ndbg, NotRun> {
    let found = match reach {
        Reach::Infinitesimal => at_the_start(known, resolution)?,
        Reach::Finite => finite(known, resolution, watch)?,
    };
    if watch.is_stopped() {
        return Err(NotRun::Stopped);
    }
    let _stage = watch.stage("cutting the sphere of directions", "", All::Open);
    let mut circles = Circles::new(resolution);
    let mut all = Critical::default();
    for between in &found {
        all.join(between::critical(between, &mut circles));
    }
    let pairs = found.iter().map(|between| Numbered::new(between, &mut circles)).collect();
    let arrangement = arrangement(&mut circles, all)?;
    regions::regions(known.assembly, pairs, circles, arrangement)
}

/// Pairs that touch, but two held ones, which keep their places.
fn at_the_start(known: Touching<'_>, resolution: Resolution) -> Result<Vec<Between>, NotRun> {
    let work = Work::new(MOST_STEPS);
    let touching = pairs(known.patches);
    let pairs: Vec<_> = touching.iter().filter(|((a, b), _)| !both_held(known.assembly, *a, *b)).collect();
    let made: Option<Vec<Between>> = pairs
        .into_par_iter()
        .map(|(&(a, b), of)| start(known.patches, (a, b), of, resolution).at_the_start(&work))
        .collect();
    made.ok_or(NotRun::TooManySteps)
}

fn start(patches: &[Patch], (a, b): (PartIx, PartIx), of: &[usize], resolution: Resolution) -> Start {
    let normals: Vec<DVec3> = of.iter().map(|&k| patches[k].normal).collect();
    Start::new(a, b, &normals, resolution)
}

fn both_held(asm: &Assembly, a: PartIx, b: PartIx) -> bool {
    [a, b].iter().all(|&p| asm.part(p).mobility == Mobility::Held)
}

/// Every pair of parts, but two held ones, which keep their places.
fn finite(known: Touching<'_>, resolution: Resolution, watch: &Watch) -> Result<Vec<Between>, NotRun> {
    let asm = known.assembly;
    if let Some(p) = asm.parts.iter().find(|p| asm.solids[p.solid].cells.is_empty()) {
        return Err(NotRun::NoCells(p.id.clone()));
    }
    let parts: Vec<PartIx> = asm.ids().collect();
    let all = parts.iter().flat_map(|&a| parts[a.at() + 1..].iter().map(move |&b| (a, b)));
    let all: Vec<_> = all.filter(|&(a, b)| !both_held(asm, a, b)).collect();
    let (shapes, depth) = (Shapes::of(asm), Touch::of(asm));
    let touching = pairs(known.patches);
    let of = |pair: (PartIx, PartIx)| touching.get(&pair).map_or(&[][..], Vec::as_slice);
    let starts: Vec<Start> =
        all.iter().map(|&pair| start(known.patches, pair, of(pair), resolution)).collect();
    let keys: Vec<Congruent> = starts.iter().map(|start| congruent(start, &shapes)).collect();
    let mut first: BTreeMap<&Congruent, usize> = BTreeMap::new();
    for (k, key) in keys.iter().enumerate() {
        first.entry(key).or_insert(k);
    }
    let cells = |p: PartIx| asm.solid(p).cells.len();
    let pairs = first.values().map(|&k| cells(all[k].0) * cells(all[k].1));
    let count = pairs.fold(0, usize::saturating_add);
    if count > MOST_CELL_PAIRS {
        return Err(NotRun::TooManyCells { found: count });
    }
    let work = Work::new(MOST_STEPS);
    let stage = watch.stage("what pairs of parts leave free", "pairs", All::Just(first.len() as u64));
    let made: Option<BTreeMap<&Congruent, Between>> = first
        .into_par_iter()
        .map(|(key, k)| {
            if watch.is_stopped() {
                return None;
            }
            let between = starts[k].on_the_way(&shapes, depth, &work)?;
            stage.add(1);
            Some((key, between))
        })
        .collect();
    let made = made.ok_or(if watch.is_stopped() { NotRun::Stopped } else { NotRun::TooManySteps })?;
    drop(stage);
    Ok(all.iter().zip(&keys).map(|(&(a, b), key)| Between { a, b, ..made[key].clone() }).collect())
}

/// Solids in orientation, the way from one to the other and the normals of their patches, to the last bit: pairs that
/// agree in all of them have the same free directions.
type Congruent = ([usize; 2], [u64; 3], BTreeSet<[u64; 3]>);

fn congruent(pair: &Start, shapes: &Shapes) -> Congruent {
    let bits = |v: DVec3| v.to_array().map(f64::to_bits);
    let step = shapes.part(pair.b).1 - shapes.part(pair.a).1;
    let normals = pair.normals().iter().map(|&n| bits(n));
    ([pair.a, pair.b].map(|p| shapes.shape(p)), bits(step), normals.collect())
}

impl Ndbg {
    /// The number of the graph along a unit direction that lies on no critical arc; none for a graph that no region has.
    pub fn graph_along(&self, d: DVec3) -> Option<usize> {
        let bits = regions::bits(&self.pairs, Place { d, on: On::Nothing });
        self.graphs.binary_search_by(|g| g.bits.cmp(&bits)).ok()
    }

    /// Graphs that some directions have in which the parts are one strongly connected component.
    pub fn connected(&self) -> usize {
        self.graphs.iter().filter(|g| g.components.len() == 1).count()
    }
}
