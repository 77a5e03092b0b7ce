//! Takes what `flex` found; gives its answer as it is written.
//!
//! Not promised: more than `flex` does; a minimum is given only where the bounds meet.

use super::{Certificate, Source, certificate, checksum, ids};
use crate::assembly::PartIx;
use crate::contact::Joined;
use crate::cores::{Core, Set};
use crate::flex::symmetry::Symmetry;
use crate::flex::{Ask, Cut, Enough, Flex, Listing, Wanted};
use crate::sequence::Plan;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parts that are locked by themselves: at least one of them must be flexible. Locks of meshes are listed only where they
/// survive every change of the contacts within what the files' digits leave open.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CoreAnswer {
    pub parts: Vec<String>,
    pub certificate: Certificate,
}

/// Sets that symmetries of the assembly carry into one another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OrbitAnswer {
    /// The set that the plan is for.
    pub set: Vec<String>,
    /// All of the orbit, `set` among them.
    pub all: Vec<Vec<String>>,
    /// Takes the parts outside `set` apart.
    pub plan: Plan<()>,
}

/// An isometry of the assembly: x -> linear x + shift, and where it takes each part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SymmetryOfParts {
    /// Rows of the linear part.
    pub linear: [[f64; 3]; 3],
    pub shift: [f64; 3],
    /// Images of the parts, in the order of the parts.
    pub to: Vec<String>,
}

/// Answer of `flex`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FlexAnswer {
    pub verb: String,
    pub name: String,
    /// Fewest flexible parts; null where the bounds do not meet.
    pub minimum: Option<usize>,
    /// Proven by the cores: no smaller set meets them all.
    pub lower_bound: usize,
    /// Size of the smallest set shown to be enough.
    pub upper_bound: usize,
    /// All sets of that size that are enough (`sets_complete` says whether all are named).
    pub sets: Vec<Vec<String>>,
    pub sets_complete: bool,
    /// The sets up to symmetry, each with its plan; with `--minimal` also larger ones from which no part can be left out.
    pub orbits: Vec<OrbitAnswer>,
    /// `smallest` or `minimal`.
    pub wanted: String,
    /// Whether `orbits` names all that were wanted, and if not what ended the search: `complete`, `smallest-complete`,
    /// `work`, `time`, `many`, `stopped` (by the user).
    pub listed: String,
    pub symmetries: Vec<SymmetryOfParts>,
    /// The proof of the lower bound.
    pub cores: Vec<CoreAnswer>,
    /// Sets that no plan took apart although they are not proven locked.
    pub unproven: Vec<Vec<String>>,
    /// Sets of meshes that are locked as written, but not shown to be whatever the files' digits leave open of their contacts:
    /// no bound rests on them.
    #[serde(default)]
    pub doubtful: Vec<Vec<String>>,
    /// Air on each face of a contact, mm; 0: the parts as they touch.
    pub clearance_mm: f64,
    /// Locks and plans tried, each counted as its parts squared and its contact patches.
    pub work: u64,
    /// True where the user stopped the search before it was done: what is told is the best until then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
    pub remarks: Vec<String>,
    pub source: Source,
    pub checksum: String,
}

pub fn flex(joined: &Joined, flex: &Flex, ask: &Ask, source: Source) -> FlexAnswer {
    let asm = &joined.assembly;
    let named = |set: &Set| ids(asm, &set.iter().copied().collect::<Vec<_>>());
    let orbit = |e: &Enough| OrbitAnswer {
        set: named(&e.set),
        all: e.orbit.iter().map(named).collect(),
        plan: e.plan.clone(),
    };
    let smallest = flex.enough.iter().filter(|e| e.set.len() == flex.upper);
    let mut sets: Vec<&Set> = smallest.flat_map(|e| &e.orbit).collect();
    sets.sort();
    let stopped = flex.list == Listing::CutShort(Cut::Stopped);
    let why = stopped.then(|| format!("stopped by the user after {} units of work", flex.work));
    let answer = FlexAnswer {
        verb: "flex".into(),
        name: asm.name.clone(),
        minimum: flex.minimum(),
        lower_bound: flex.lower,
        upper_bound: flex.upper,
        sets: sets.into_iter().map(named).collect(),
        sets_complete: is_complete(flex),
        orbits: flex.enough.iter().map(orbit).collect(),
        wanted: if ask.wanted == Wanted::Smallest { "smallest" } else { "minimal" }.into(),
        listed: listed(flex.list).into(),
        symmetries: flex.symmetries.iter().map(|s| symmetry(joined, s)).collect(),
        cores: flex.cores.iter().map(|c| core(joined, c)).collect(),
        unproven: flex.unproven.iter().map(named).collect(),
        doubtful: flex.doubtful.iter().map(named).collect(),
        clearance_mm: ask.clearance * asm.mm_per_unit,
        work: flex.work,
        stopped,
        remarks: joined.remarks.iter().cloned().chain(why).collect(),
        source,
        checksum: String::new(),
    };
    FlexAnswer { checksum: checksum(&answer), ..answer }
}

/// Every set of the least size that meets all cores is listed: none was left out since no plan was found for it.
fn is_complete(flex: &Flex) -> bool {
    flex.minimum().is_some() && flex.unproven.is_empty() && !matches!(flex.list, Listing::CutShort(_))
}

fn listed(list: Listing) -> &'static str {
    match list {
        Listing::Complete => "complete",
        Listing::SmallestComplete => "smallest-complete",
        Listing::CutShort(Cut::Work) => "work",
        Listing::CutShort(Cut::Time) => "time",
        Listing::CutShort(Cut::Stopped) => "stopped",
        Listing::CutShort(Cut::Many) => "many",
    }
}

fn core(joined: &Joined, c: &Core) -> CoreAnswer {
    let asm = &joined.assembly;
    let named = |set: &Set| set.iter().copied().collect::<Vec<PartIx>>();
    CoreAnswer {
        parts: ids(asm, &named(&c.parts)),
        certificate: certificate(asm, &named(&c.still), &c.stress),
    }
}

fn symmetry(joined: &Joined, s: &Symmetry) -> SymmetryOfParts {
    let rows = s.map.matrix3.transpose();
    SymmetryOfParts {
        linear: [rows.x_axis, rows.y_axis, rows.z_axis].map(|r| r.to_array()),
        shift: s.map.translation.to_array(),
        to: s.to.iter().map(|&k| joined.assembly.parts[k].id.clone()).collect(),
    }
}
