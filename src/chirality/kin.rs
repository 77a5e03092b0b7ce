//! Takes parts as shapes, and parts that touch; gives groups of one shape up to mirrors, and the hand of each pair.
//!
//! Promised: two parts stand in one group only where an isometry between them was found. Not promised: that parts in two
//! groups differ where it is undecided; that is a finding.

use super::answer::{
    Agreement, BothHands, FindingAnswer, HandAnswer, Handedness, NeighboursAnswer, ShapeAnswer, Touch, WarpIs,
};
use super::judge::Findings;
use crate::assembly::PartIx;
use crate::contact::Patch;
use std::collections::BTreeSet;

/// Shapes in groups, and what could not be decided about them.
pub struct Groups {
    pub shapes: Vec<ShapeAnswer>,
    pub findings: Vec<FindingAnswer>,
    pub agreement: Agreement,
}

/// Groups solids; `names[k]` are the parts of solid k, `compare(i, j)` finds the isometries from i to j.
pub fn groups(
    names: &[Vec<String>],
    hands: &[Handedness],
    compare: impl Fn(usize, usize) -> Findings,
) -> Groups {
    let mut heads: Vec<usize> = Vec::new();
    let mut all = Groups { shapes: Vec::new(), findings: Vec::new(), agreement: Agreement::Agree };
    for k in 0..names.len() {
        if !all.joins(&heads, k, names, &compare) {
            heads.push(k);
            let hand = hands.get(k).copied().unwrap_or(Handedness::Undecided);
            all.shapes.push(ShapeAnswer {
                hand,
                same: names[k].clone(),
                mirrored: Vec::new(),
                residual: 0.0,
            });
        }
    }
    all
}

impl Groups {
    fn joins(
        &mut self,
        heads: &[usize],
        k: usize,
        names: &[Vec<String>],
        compare: impl Fn(usize, usize) -> Findings,
    ) -> bool {
        for (group, &head) in heads.iter().enumerate() {
            let findings = compare(head, k);
            let (kinship, why) = findings.kinship();
            let evidence = &findings.evidence;
            self.agreement = self.agreement.max(evidence.agreement);
            let shape = &mut self.shapes[group];
            let list = match kinship {
                WarpIs::Same | WarpIs::Both => &mut shape.same,
                WarpIs::Mirror => &mut shape.mirrored,
                WarpIs::Different => continue,
                WarpIs::Undecided => {
                    let at = [head, k].map(|k| names[k].first().cloned().unwrap_or_default()).join(" and ");
                    self.findings.push(FindingAnswer { at, what: why.unwrap_or_default() });
                    continue;
                }
            };
            list.extend(names[k].iter().cloned());
            let proper = kinship != WarpIs::Mirror;
            let found = evidence.isometries.iter().filter(|i| i.proper == proper).map(|i| i.residual);
            shape.residual = shape.residual.max(found.reduce(f64::min).unwrap_or(0.0));
            return true;
        }
        false
    }

    pub fn both_hands(&self) -> BothHands {
        match () {
            () if self.shapes.iter().any(|s| !s.mirrored.is_empty()) => BothHands::Needed,
            () if !self.findings.is_empty() => BothHands::Undecided,
            () => BothHands::NotNeeded,
        }
    }
}

/// The pairs of parts that touch, lower first, in order.
pub fn touching(patches: &[Patch]) -> Vec<(PartIx, PartIx)> {
    patches.iter().map(|p| (p.a.min(p.b), p.a.max(p.b))).collect::<BTreeSet<_>>().into_iter().collect()
}

/// A pair as it is told.
pub fn told((a, b): (&str, &str), touch: Touch, hand: &HandAnswer) -> NeighboursAnswer {
    let (a, b) = (a.to_string(), b.to_string());
    NeighboursAnswer {
        a,
        b,
        touch,
        hand: hand.hand,
        agreement: hand.evidence.agreement,
        why: hand.why.clone(),
    }
}
