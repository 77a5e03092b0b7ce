//! Takes contacts; gives the keys: smallest groups that can start to move while everything else stands still.
//!
//! Groups of one part are asked, then of two that touch, and so on, each number of parts wholly or not at all, within a
//! budget. A key moves as it is said to (sound); that no other is there holds up to the number of parts stated. Only
//! connected groups are asked: of two halves that do not touch, each moves without the other.

use crate::assembly::PartIx;
use crate::blocking::cone::polar;
use crate::cores::{Contacts, MOST_UNKNOWNS, Set};
use crate::locking::{Freedom, Motion, Row, Twist, Verdict};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Groups asked before giving up on larger ones: a few milliseconds each.
pub const MOST_GROUPS: usize = 1024;

/// A direction breaks a row by no more than this when it is kept: what `verify` grants a motion's signs.
const SIGN_ROUND_OFF: f64 = 1e-9;

/// A larger group than this is not shrunk part by part.
const MOST_SHRUNK: usize = 48;

/// Extreme directions of the cone along which a group can start to move as one body: any sum of rays, and of lines either
/// way. Unit vectors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Directions {
    pub lines: Vec<DVec3>,
    pub rays: Vec<DVec3>,
}

/// Whether a smaller group inside can move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Least {
    /// None can: every smaller one was asked.
    Shown,
    NotShown,
}

#[derive(Clone, Debug)]
pub struct Key {
    pub parts: Set,
    pub motion: Motion,
    /// None where a direction is too near a contact's plane to be told from blocked.
    pub directions: Option<Directions>,
    pub least: Least,
}

/// Which keys are all found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Complete {
    #[default]
    All,
    /// Those of up to so many parts.
    UpTo(usize),
}

#[derive(Clone, Debug, Default)]
pub struct Keys {
    pub found: Vec<Key>,
    /// Groups asked about.
    pub asked: usize,
    pub complete: Complete,
    pub undecided: Vec<Set>,
}

/// `tied` parts (two or more held) do not move. Where all is locked there is nothing to ask.
pub fn keys(contacts: &Contacts, all: &Set, tied: &Set, verdict: &Verdict) -> Keys {
    let mut keys = Keys::default();
    if matches!(verdict, Verdict::Locked(_)) {
        return keys;
    }
    let may: Set = all.difference(tied).copied().collect();
    let budget = MOST_GROUPS.max(may.len());
    let most = if tied.is_empty() { all.len().saturating_sub(1) } else { may.len() };
    let mut groups: BTreeSet<Set> = may.iter().map(|&p| Set::from([p])).collect();
    let mut size = 0;
    while size < most && !groups.is_empty() {
        if keys.asked + groups.len() > budget {
            keys.complete = Complete::UpTo(size);
            break;
        }
        groups = keys.ask(contacts, all, groups);
        groups = grown(contacts, &may, &groups, &keys.found, budget + 1);
        size += 1;
    }
    if let (true, Verdict::Free(motion)) = (keys.found.is_empty(), verdict) {
        keys.found.extend(shrunk(contacts, all, tied, motion));
    }
    keys
}

impl Keys {
    /// Those of the groups that can not move.
    fn ask(&mut self, contacts: &Contacts, all: &Set, groups: BTreeSet<Set>) -> BTreeSet<Set> {
        let groups: Vec<Set> = groups.into_iter().collect();
        self.asked += groups.len();
        let verdicts: Vec<_> = groups.par_iter().map(|g| contacts.verdict(g, all)).collect();
        let mut stay = BTreeSet::new();
        for (group, verdict) in groups.into_iter().zip(verdicts) {
            match verdict {
                Some(Verdict::Free(motion)) => {
                    self.found.push(key(contacts, all, group, motion, Least::Shown));
                }
                Some(Verdict::Locked(_)) => drop(stay.insert(group)),
                Some(Verdict::Undecided(_)) | None => self.undecided.push(group),
            }
        }
        stay
    }
}

/// Groups with one more part that touches them, without those that hold a key.
fn grown(contacts: &Contacts, may: &Set, groups: &BTreeSet<Set>, keys: &[Key], most: usize) -> BTreeSet<Set> {
    let more = |g: &Set| -> Vec<Set> {
        let beside: Set = g.iter().flat_map(|&p| contacts.beside(p)).collect();
        let new = beside.into_iter().filter(|p| may.contains(p) && !g.contains(p));
        new.map(|p| g.iter().copied().chain([p]).collect()).collect()
    };
    let all = groups.iter().flat_map(more);
    all.filter(|g: &Set| keys.iter().all(|k| !k.parts.is_subset(g))).take(most).collect()
}

fn key(contacts: &Contacts, all: &Set, parts: Set, motion: Motion, least: Least) -> Key {
    let rows = contacts.rows(&parts, all);
    let directions = directions(&rows, &parts);
    let straight = directions.as_ref().and_then(|d| straight(contacts, &rows, &parts, d));
    Key { motion: straight.unwrap_or(motion), parts, directions, least }
}

/// Toward the group's outside, for each row that it shares with parts that stand still.
fn outward(rows: &[&Row], group: &Set) -> Vec<DVec3> {
    let sides = rows.iter().filter(|r| group.contains(&r.a) != group.contains(&r.b));
    sides.map(|r| if group.contains(&r.a) { r.normal } else { -r.normal }).collect()
}

fn directions(rows: &[&Row], group: &Set) -> Option<Directions> {
    let outward = outward(rows, group);
    let cone = polar(outward.iter().copied());
    let fits = |d: DVec3| outward.iter().all(|n| n.dot(d) <= SIGN_ROUND_OFF);
    let all = cone.lines.iter().flat_map(|&l| [l, -l]).chain(cone.rays.iter().copied());
    all.into_iter().all(fits).then_some(Directions { lines: cone.lines, rays: cone.rays })
}

/// A shift of the whole group, where it has one: easier to follow than a motion with turns in it.
fn straight(contacts: &Contacts, rows: &[&Row], group: &Set, to: &Directions) -> Option<Motion> {
    let all = || to.lines.iter().chain(&to.rays);
    let d = match (to.lines.first(), to.rays.is_empty()) {
        (Some(&line), true) => line,
        (_, false) => to.rays.iter().sum::<DVec3>().try_normalize().or_else(|| all().next().copied())?,
        _ => return None,
    };
    let openings = outward(rows, group).into_iter().map(|n| -n.dot(d)).collect::<Vec<_>>();
    let (least, most) = openings.iter().fold((0.0_f64, 0.0_f64), |(l, m), &o| (l.min(o), m.max(o)));
    let twist = |p: PartIx| Twist { translation: d, rotation: DVec3::ZERO, centre: contacts.centre(p) };
    let opening = if most > SIGN_ROUND_OFF { most } else { 0.0 };
    (least >= -SIGN_ROUND_OFF).then(|| Motion {
        twists: group.iter().map(|&p| (p, twist(p))).collect(),
        opening,
        worst: -least,
    })
}

/// The parts that a motion moves, less what need not move, one by one.
fn shrunk(contacts: &Contacts, all: &Set, tied: &Set, motion: &Motion) -> Option<Key> {
    let mut parts = movers(motion);
    let mut motion = motion.clone();
    let small = parts.len() <= MOST_SHRUNK && parts.len() * Freedom::Rigid.unknowns() <= MOST_UNKNOWNS;
    let mut tried = small;
    for p in parts.clone().into_iter().filter(|_| small) {
        if !parts.contains(&p) || parts.len() == 1 {
            continue;
        }
        let less: Set = parts.iter().copied().filter(|&q| q != p).collect();
        match contacts.verdict(&less, all) {
            Some(Verdict::Free(m)) => (parts, motion) = (movers(&m), m),
            Some(Verdict::Locked(_)) => {}
            _ => tried = false,
        }
    }
    let least = if tried { Least::Shown } else { Least::NotShown };
    (!parts.is_empty() && parts.is_disjoint(tied)).then(|| key(contacts, all, parts, motion, least))
}

/// Parts that move at all: a twist is exactly zero, or it is part of the motion.
fn movers(motion: &Motion) -> Set {
    let moves = |t: &Twist| t.translation != DVec3::ZERO || t.rotation != DVec3::ZERO;
    motion.twists.iter().filter(|(_, t)| moves(t)).map(|(p, _)| *p).collect()
}
