//! Takes contacts and held parts; gives locked with a self-stress, free with a motion, or undecided with the gap.
//!
//! First order: locked means that no motion can start at zero clearance, free that one can. Sound up to round-off,
//! which is bounded and stated (`verify` re-checks without this module). Not complete: numbers near a boundary give
//! undecided.

mod again;
mod decide;
mod dense;
pub mod digits;
mod factor;
mod interior;
mod many;
pub mod margin;
mod order;
mod reduce;
mod rows;
mod solve;
mod sparse;
mod system;
mod vouch;

pub use decide::{Force, Gap, Motion, ROUND_OFF, Start, Stress, Twist, Verdict, decide, decide_from};
pub use rows::{Freedom, Row, Unknowns, rows};
pub use vouch::{check_loose, vouched};

use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use std::collections::BTreeSet;

/// Both verdicts about an assembly, and what they are about.
#[derive(Clone, Debug)]
pub struct Check {
    pub rigid: Verdict,
    pub translation: Verdict,
    /// Contact rows for rigid motions.
    pub rows: usize,
    pub held: Vec<PartIx>,
    /// The part taken as fixed where none is held; the verdict does not depend on which.
    pub fixed: Option<PartIx>,
}

/// Decides for translations and for rigid motions. Where nothing is held, `fix` (by default the first part) stays.
pub fn check(assembly: &Assembly, patches: &[Patch], fix: Option<PartIx>) -> Check {
    let held: Vec<PartIx> = assembly.held().collect();
    let fixed = held.is_empty().then(|| fix.unwrap_or(PartIx(0)));
    let still: Vec<PartIx> = held.iter().copied().chain(fixed).collect();
    let of = |freedom| {
        let rows = rows(patches, freedom);
        let unknowns = Unknowns::new(assembly, &rows, &still, freedom);
        (decide(&rows, &unknowns), rows.len())
    };
    let (rigid, rows) = of(Freedom::Rigid);
    Check { rigid, translation: of(Freedom::Translation).0, rows, held, fixed }
}

/// The rigid verdict about some of the parts alone, the first of them (or those held) fixed.
pub fn check_some(assembly: &Assembly, patches: &[Patch], parts: &[PartIx]) -> Verdict {
    let among: BTreeSet<PartIx> = parts.iter().copied().collect();
    let inside: Vec<Patch> =
        patches.iter().filter(|p| among.contains(&p.a) && among.contains(&p.b)).cloned().collect();
    let mut still: Vec<PartIx> = assembly.ids().filter(|p| !among.contains(p)).collect();
    let held: Vec<PartIx> = assembly.held().filter(|p| parts.contains(p)).collect();
    if held.is_empty() {
        still.extend(parts.first());
    }
    still.extend(held);
    let rows = rows(&inside, Freedom::Rigid);
    decide(&rows, &Unknowns::new(assembly, &rows, &still, Freedom::Rigid))
}
