//! Takes where parts touch; answers which groups of parts can start to move among which others.
//!
//! Sound up to the round-off of `locking`; nothing is asked about more than [`MOST_UNKNOWNS`]. What an answer costs is
//! counted, the same on every machine and with any number of threads.

use super::Set;
use crate::assembly::{Mobility, PartIx};
use crate::contact::{Loose, Patch, Slack, Touching};
use crate::locking::digits::{self, Within, rows_with_slack};
use crate::locking::{Freedom, Row, Stress, Unknowns, Verdict, decide, rows, vouched};
use std::sync::atomic::{AtomicU64, Ordering};

/// More unknowns than this are not asked about together: two thousand parts, some seconds each time.
pub const MOST_UNKNOWNS: usize = 12_288;

pub struct Contacts<'a> {
    pub touching: Touching<'a>,
    rows: Vec<Row>,
    /// Of each row.
    slack: Vec<Slack>,
    patch: Vec<u32>,
    /// Numbers of the rows of each part, rising.
    of: Vec<Vec<usize>>,
    unknowns: Unknowns,
    work: AtomicU64,
}

impl<'a> Contacts<'a> {
    pub fn new(touching: Touching<'a>) -> Contacts<'a> {
        let Touching { assembly, patches, .. } = touching;
        let (rows, slack) = rows_with_slack(patches, touching.slack, Freedom::Rigid);
        let patch = patches.iter().zip(0..).flat_map(|(p, k)| p.corners.iter().map(move |_| k)).collect();
        let mut of = vec![Vec::new(); assembly.parts.len()];
        for (k, row) in rows.iter().enumerate() {
            of[row.a.at()].push(k);
            of[row.b.at()].push(k);
        }
        let all: Vec<PartIx> = assembly.ids().collect();
        let unknowns = Unknowns::new(assembly, &rows, &all, Freedom::Rigid);
        Contacts { touching, rows, slack, patch, of, unknowns, work: AtomicU64::new(0) }
    }

    /// What all answers so far cost: see [`Contacts::pay`].
    pub fn work(&self) -> u64 {
        self.work.load(Ordering::Relaxed)
    }

    /// Counts a lock or a plan: pairs of parts that may move, and the contact patches on them.
    pub fn pay(&self, parts: usize, patches: usize) {
        self.work.fetch_add((parts * parts + patches) as u64, Ordering::Relaxed);
    }

    /// Contact patches among these parts.
    pub fn patches_among(&self, set: &Set) -> usize {
        self.patches_of(&self.numbers(set, set))
    }

    fn patches_of(&self, rows: &[usize]) -> usize {
        rows.chunk_by(|&j, &k| self.patch[j] == self.patch[k]).count()
    }

    /// The rows between the moving parts, and between them and those that stand still.
    pub fn rows(&self, moving: &Set, among: &Set) -> Vec<&Row> {
        self.numbers(moving, among).into_iter().map(|k| &self.rows[k]).collect()
    }

    fn numbers(&self, moving: &Set, among: &Set) -> Vec<usize> {
        let mut found = Vec::new();
        for p in moving {
            found.extend(self.of[p.at()].iter().copied().filter(|&k| {
                let (a, b) = (self.rows[k].a, self.rows[k].b);
                let other = if a == *p { b } else { a };
                // A row between two moving parts counts once.
                among.contains(&other) && (other > *p || !moving.contains(&other))
            }));
        }
        found.sort_unstable();
        found
    }

    /// Parts that a part touches, some more than once.
    pub fn beside(&self, p: PartIx) -> impl Iterator<Item = PartIx> + '_ {
        self.of[p.at()]
            .iter()
            .map(move |&k| if self.rows[k].a == p { self.rows[k].b } else { self.rows[k].a })
    }

    pub fn is_held(&self, p: PartIx) -> bool {
        self.touching.assembly.part(p).mobility == Mobility::Held
    }

    /// The verdict of the rows alone about rigid motions of `moving`, each part by itself, while the rest of `among`
    /// stands still and all others are not there; none beyond [`MOST_UNKNOWNS`].
    pub fn by_rows(&self, moving: &Set, among: &Set) -> Option<Verdict> {
        (moving.len() * Freedom::Rigid.unknowns() <= MOST_UNKNOWNS).then(|| self.decided(moving, among, &[]))
    }

    fn decided(&self, moving: &Set, among: &Set, more: &[Row]) -> Verdict {
        let numbers = self.numbers(moving, among);
        self.pay(moving.len(), self.patches_of(&numbers));
        let rows: Vec<Row> = numbers.into_iter().map(|k| self.rows[k]).chain(more.iter().copied()).collect();
        decide(&rows, &self.unknowns(moving))
    }

    /// As [`Contacts::by_rows`]; a motion also keeps contacts without a normal of their own, and a lock that the files'
    /// digits leave open is undecided.
    pub fn verdict(&self, moving: &Set, among: &Set) -> Option<Verdict> {
        let near: Vec<&Loose> = self.touching.loose.iter().filter(|l| between(l, moving, among)).collect();
        let with = |planes: &[Patch]| self.decided(moving, among, &rows(planes, Freedom::Rigid));
        let verdict = vouched(&near, self.by_rows(moving, among)?, with);
        let open = match &verdict {
            Verdict::Locked(stress) => matches!(self.within(moving, among, stress), Within::Open(_)),
            _ => false,
        };
        Some(if open { Verdict::Undecided(digits::open(&self.slack)) } else { verdict })
    }

    /// What becomes of a lock within the files' digits.
    pub fn within(&self, moving: &Set, among: &Set, stress: &Stress) -> Within {
        if self.touching.slack.is_empty() {
            return Within::Survives;
        }
        let numbers = self.numbers(moving, among);
        let rows: Vec<Row> = numbers.iter().map(|&k| self.rows[k]).collect();
        let slack: Vec<Slack> = numbers.iter().map(|&k| self.slack[k]).collect();
        digits::within(&rows, &self.unknowns(moving), &slack, stress)
    }

    fn unknowns(&self, moving: &Set) -> Unknowns {
        let width = Freedom::Rigid.unknowns();
        let mut column = vec![None; self.of.len()];
        for (k, p) in moving.iter().enumerate() {
            column[p.at()] = Some(k * width);
        }
        Unknowns { column, count: moving.len() * width, ..self.unknowns.clone() }
    }

    pub fn centre(&self, p: PartIx) -> glam::DVec3 {
        self.unknowns.centre[p.at()]
    }

    /// Model units; makes turns comparable with shifts.
    pub fn lever(&self) -> f64 {
        self.unknowns.lever.iter().copied().fold(f64::MIN_POSITIVE, f64::max)
    }
}

/// Whether a contact is among these parts, and one of its two may move.
fn between(l: &Loose, moving: &Set, among: &Set) -> bool {
    among.contains(&l.a) && among.contains(&l.b) && (moving.contains(&l.a) || moving.contains(&l.b))
}
