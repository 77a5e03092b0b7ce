//! Takes what `flex` found; gives its answer as it is written.
//!
//! Not promised: more than `flex` does; a minimum is given only where the bounds meet.

use super::{Certificate, Source, certificate, ids};
use crate::assembly::PartIx;
use crate::contact::Joined;
use crate::flex::{Flex, Listing};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Parts that are locked by themselves: at least one of them must be flexible.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CoreAnswer {
    pub parts: Vec<String>,
    pub certificate: Certificate,
}

/// Answer of `flex`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FlexAnswer {
    pub verb: String,
    pub name: String,
    /// Fewest flexible parts; null where the bounds do not meet.
    pub minimum: Option<usize>,
    pub lower_bound: usize,
    /// Size of the smallest set shown to be enough.
    pub upper_bound: usize,
    /// All sets of that size that are enough (`sets_complete` says whether all are named).
    pub sets: Vec<Vec<String>>,
    pub sets_complete: bool,
    /// The proof of the lower bound.
    pub cores: Vec<CoreAnswer>,
    /// Sets that no plan took apart although they are not proven locked.
    pub unproven: Vec<Vec<String>>,
    pub remarks: Vec<String>,
    pub source: Source,
}

pub fn flex(joined: &Joined, flex: &Flex, source: Source) -> FlexAnswer {
    let asm = &joined.assembly;
    let named = |set: &std::collections::BTreeSet<PartIx>| ids(asm, &set.iter().copied().collect::<Vec<_>>());
    let core = |c: &crate::flex::Core| {
        let inside: Vec<PartIx> = c.parts.iter().copied().collect();
        let held: Vec<PartIx> = asm.held().filter(|p| inside.contains(p)).collect();
        let still = if held.is_empty() { inside[..1].to_vec() } else { held };
        CoreAnswer { parts: named(&c.parts), certificate: certificate(asm, &still, &c.stress) }
    };
    FlexAnswer {
        verb: "flex".into(),
        name: asm.name.clone(),
        minimum: flex.minimum(),
        lower_bound: flex.lower,
        upper_bound: flex.upper,
        sets: flex.sets.iter().map(named).collect(),
        sets_complete: flex.list == Listing::Complete,
        cores: flex.cores.iter().map(core).collect(),
        unproven: flex.unproven.iter().map(named).collect(),
        remarks: joined.remarks.clone(),
        source,
    }
}
