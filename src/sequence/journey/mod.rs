//! Takes a set of parts that no single straight move takes apart, gives motions that end where one does: straight moves
//! that stop half way, turns, and several parts at once; or how far each part got.
//!
//! Sound up to the planner's own check of each motion over its whole length; `verify` checks again with other code.
//! Not complete: states are tried in order of their number of motions until counted work is used up.

mod bodies;
mod flush;
mod follow;
mod movers;
mod path;
mod program;
mod straight;
mod wishes;

use super::field::{Field, Set};
use super::leave::{Found, leave};
use super::motion::{Motion, Mover, Rigid};
use crate::assembly::{Assembly, PartIx};
use crate::blocking::Touch;
use crate::contact::Patch;
use crate::watch::{All, Stage, Watch};
use bodies::{Bodies, Poses};
use follow::{Distance, Follow};
use glam::{DAffine3, DQuat, DVec3};
use movers::Movers;
use path::{Passes, passes, paths};
use std::collections::{BTreeSet, VecDeque};
pub use wishes::frame;

/// States of straight moves, and of all motions.
const MOST_STRAIGHT: usize = 400;
const MOST_STATES: usize = 160;

/// States of one path that others start from.
const STARTS_OF_PATH: usize = 4;

/// How much finer states are told apart for a look at their ways out than for starting from them.
const FINER: f64 = 32.0;

/// Distances kept from walls, as shares of the smallest lever: none for what fits exactly, a little where there is room.
const DISTANCES: [Distance; 2] = [Distance(0.0), Distance(1.0 / 128.0)];

/// What was done.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    pub states: usize,
    pub programs: usize,
    spent: usize,
    /// What may be spent; half of it may go to straight moves.
    most: usize,
}

impl Work {
    fn is_spent(&self) -> bool {
        self.spent >= self.most
    }

    fn is_half_spent(&self) -> bool {
        self.spent >= self.most / 2
    }
}

/// The motion of several parts, and what they keep.
pub struct Leg {
    pub movers: Vec<(Set, Rigid)>,
    pub clear: f64,
}

/// The way out: motions within the set, and then these parts leave straight.
pub struct Exit {
    pub legs: Vec<Leg>,
    pub parts: Set,
    pub along: DVec3,
    /// The assembly as it stands before the last move, and its contacts.
    pub asm: Assembly,
    pub patches: Vec<Patch>,
}

/// The farthest that a part got.
#[derive(Clone, Copy, Debug)]
pub struct Reached {
    pub part: PartIx,
    /// Of the middle of its box, model units.
    pub shift: DVec3,
    /// Radians, at the place where it turned most.
    pub turn: f64,
}

impl Reached {
    fn farther(&mut self, other: &Reached) {
        if other.shift.length() > self.shift.length() {
            self.shift = other.shift;
        }
        self.turn = self.turn.max(other.turn);
    }
}

pub struct Journey {
    pub exit: Option<Exit>,
    pub reached: Vec<Reached>,
    pub work: Work,
}

/// Looks for a way out of the set, straight moves first.
pub fn journey(field: &Field, set: &Set) -> Journey {
    let parts: Vec<PartIx> = set.iter().copied().collect();
    let frame = wishes::frame(field.patches, set);
    let mut all = Journey { exit: None, reached: at_home(&parts), work: Work::default() };
    for movers in movers::searches(field.asm, field.patches, Bodies::of(field.asm, &parts)) {
        let found = search(field, &frame, &movers);
        all.work.states += found.work.states;
        all.work.programs += found.work.programs;
        all.reached.iter_mut().zip(&found.reached).for_each(|(r, f)| r.farther(f));
        if found.exit.is_some() || field.watch.is_stopped() {
            return Journey { exit: found.exit, ..all };
        }
    }
    all
}

fn at_home(parts: &[PartIx]) -> Vec<Reached> {
    parts.iter().map(|&part| Reached { part, shift: DVec3::ZERO, turn: 0.0 }).collect()
}

fn search(field: &Field, frame: &[DVec3], movers: &Movers) -> Journey {
    let mut search = Search {
        asm: field.asm,
        patches: field.patches,
        bodies: &movers.bodies,
        touch: field.touch,
        nodes: vec![],
        seen: BTreeSet::new(),
        reached: at_home(&movers.bodies.parts),
        work: Work { most: movers.most, ..Work::default() },
        watch: &field.watch,
    };
    let begin = |what, most: usize| field.watch.stage(what, "poses", All::AtMost(most as u64));
    let straight = begin("moves that stop half way", MOST_STRAIGHT);
    let exit = search.straight(frame, &straight);
    drop(straight);
    let turning = begin("turns and joint motions", MOST_STATES);
    let exit = exit.or_else(|| search.turning(frame, &turning));
    Journey { exit, reached: search.reached, work: search.work }
}

/// A state, and how it was reached.
struct Node {
    poses: Poses,
    /// The node before, and the states between.
    from: Option<usize>,
    between: Vec<Poses>,
}

struct Search<'a> {
    asm: &'a Assembly,
    patches: &'a [Patch],
    bodies: &'a Bodies,
    touch: Touch,
    nodes: Vec<Node>,
    seen: BTreeSet<(u64, Vec<i64>)>,
    reached: Vec<Reached>,
    work: Work,
    watch: &'a Watch,
}

/// A straight exit: which parts of the set, which way.
type Way = (Set, DVec3);

impl Search<'_> {
    fn begin(&mut self) -> VecDeque<usize> {
        let poses = self.bodies.home();
        self.nodes = vec![Node { poses, from: None, between: vec![] }];
        self.seen.clear();
        VecDeque::from([0])
    }

    /// Straight moves that stop half way, fewest first.
    fn straight(&mut self, frame: &[DVec3], stage: &Stage) -> Option<Exit> {
        let grain = 32.0 * self.touch.depth();
        let mut open = self.begin();
        self.is_new(&self.bodies.home(), grain);
        while let Some(at) = open.pop_front() {
            for poses in self.after_slides(at, frame) {
                stage.reach(self.nodes.len());
                if self.nodes.len() >= MOST_STRAIGHT || self.work.is_half_spent() {
                    return None;
                }
                if self.watch.is_stopped() {
                    return None;
                }
                if !self.is_new(&poses, grain) {
                    continue;
                }
                let node = self.push(poses, at, vec![]);
                if let Some(way) = self.way_out(&self.nodes[node].poses.clone()) {
                    return Some(self.exit(node, way));
                }
                open.push_back(node);
            }
        }
        None
    }

    fn push(&mut self, poses: Poses, from: usize, between: Vec<Poses>) -> usize {
        self.note(&poses);
        self.work.states += 1;
        self.nodes.push(Node { poses, from: Some(from), between });
        self.nodes.len() - 1
    }

    fn after_slides(&mut self, at: usize, frame: &[DVec3]) -> Vec<Poses> {
        let poses = self.nodes[at].poses.clone();
        let (asm, patches) = self.standing(&poses);
        let field = Field::new(&asm, &patches, self.watch);
        let all = self.all();
        let mut out = Vec::new();
        for group in self.groups(&patches) {
            if self.work.is_half_spent() || self.watch.is_stopped() {
                break;
            }
            let moving: Set = group.iter().map(|&k| self.bodies.parts[k]).collect();
            let rest: Set = all.difference(&moving).copied().collect();
            self.work.spent += self.pairs(&group);
            for slide in straight::slides(&field, &moving, &rest, frame) {
                for &stop in &slide.stops {
                    let by = DAffine3::from_translation(slide.along * stop);
                    let mut next = poses.clone();
                    group.iter().for_each(|&k| next[k] = by * next[k]);
                    out.push(next);
                }
            }
        }
        out
    }

    /// About how many pairs of cells a move of the group looks at, times its directions.
    fn pairs(&self, group: &[usize]) -> usize {
        let cells = |k: usize| self.bodies.cells[k].len();
        let rest: usize = (0..self.bodies.parts.len()).filter(|k| !group.contains(k)).map(cells).sum();
        16 * rest * group.iter().map(|&k| cells(k)).sum::<usize>()
    }

    /// Single parts, and pairs that touch.
    fn groups(&self, patches: &[Patch]) -> Vec<Vec<usize>> {
        let movable: Vec<usize> = self.bodies.movable().collect();
        let place = |p: PartIx| self.bodies.parts.iter().position(|&q| q == p);
        let pairs: BTreeSet<(usize, usize)> = patches
            .iter()
            .filter_map(|p| Some((place(p.a)?, place(p.b)?)))
            .filter(|(a, b)| movable.contains(a) && movable.contains(b))
            .collect();
        let pairs = pairs.into_iter().filter(|_| movable.len() > 2).map(|(a, b)| vec![a, b]);
        movable.iter().map(|&k| vec![k]).chain(pairs).collect()
    }

    /// All motions: straight ones and wishes that are followed.
    fn turning(&mut self, frame: &[DVec3], stage: &Stage) -> Option<Exit> {
        let grain = self.bodies.movable().map(|k| self.bodies.lever[k]).fold(f64::INFINITY, f64::min) / 32.0;
        // Its own half, however far the last straight state went over the other.
        self.work.spent = self.work.spent.min(self.work.most / 2);
        let mut open = self.begin();
        self.is_new(&self.bodies.home(), grain);
        while let Some(at) = open.pop_front() {
            let poses = self.nodes[at].poses.clone();
            let first = if at == 0 { wishes::free(self.asm, self.bodies, self.patches) } else { None };
            let wishes = first.into_iter().chain(wishes::single(self.bodies, frame));
            for (wish, distance) in wishes.flat_map(|w| DISTANCES.map(|d| (w.clone(), d))) {
                stage.reach(self.nodes.len());
                if self.nodes.len() >= MOST_STATES || self.work.is_spent() || self.watch.is_stopped() {
                    return None;
                }
                let follow = Follow { bodies: self.bodies, touch: self.touch, distance };
                let path = follow.follow(&poses, &wish, &mut self.work);
                if let Some(exit) = self.along(at, &path, grain, &mut open) {
                    return Some(exit);
                }
            }
        }
        None
    }

    /// The states of a path: an exit from one, or a few more to start from.
    fn along(&mut self, at: usize, path: &[Poses], grain: f64, open: &mut VecDeque<usize>) -> Option<Exit> {
        let every = path.len().div_ceil(STARTS_OF_PATH).max(1);
        for (k, poses) in path.iter().enumerate() {
            self.note(poses);
            // A way out may be as narrow as it likes, so states that are hardly new are looked at too.
            if !self.is_new(poses, grain / FINER) {
                continue;
            }
            let way = self.way_out(poses);
            let starts = (k + 1) % every == 0 || k + 1 == path.len();
            if way.is_none() && !(starts && self.is_new(poses, grain)) {
                continue;
            }
            let node = self.push(poses.clone(), at, path[..k].to_vec());
            match way {
                Some(way) => return Some(self.exit(node, way)),
                None => open.push_back(node),
            }
        }
        None
    }

    /// The first part that can leave straight from here.
    fn way_out(&mut self, poses: &Poses) -> Option<Way> {
        let (asm, patches) = self.standing(poses);
        let field = Field::new(&asm, &patches, self.watch);
        let all = self.all();
        self.bodies.movable().find_map(|k| {
            let moving = Set::from([self.bodies.parts[k]]);
            let rest: Set = all.difference(&moving).copied().collect();
            self.work.spent += self.pairs(&[k]);
            match leave(&field, &moving, &rest, &[]).found {
                Found::Along(d) => Some((moving, d)),
                _ => None,
            }
        })
    }

    fn all(&self) -> Set {
        self.bodies.parts.iter().copied().collect()
    }

    /// The assembly with its parts in these poses, and its flush contacts: those of parts that may not move are as before.
    fn standing(&self, poses: &Poses) -> (Assembly, Vec<Patch>) {
        let mut asm = self.asm.clone();
        for (p, pose) in self.bodies.parts.iter().zip(poses) {
            asm.parts[p.at()].pose = *pose * asm.parts[p.at()].pose;
        }
        let placed: Vec<_> = poses.iter().enumerate().map(|(k, pose)| self.bodies.placed(k, pose)).collect();
        let fixed =
            |p: PartIx| self.bodies.parts.iter().position(|&q| q == p).is_some_and(|k| self.bodies.fixed[k]);
        let mut patches: Vec<Patch> =
            self.patches.iter().filter(|c| fixed(c.a) && fixed(c.b)).cloned().collect();
        for a in 0..placed.len() {
            for b in (a + 1..placed.len()).filter(|&b| !(self.bodies.fixed[a] && self.bodies.fixed[b])) {
                let (x, y) = ((self.bodies.parts[a], &placed[a][..]), (self.bodies.parts[b], &placed[b][..]));
                patches.extend(flush::flush(x, y, self.touch.depth()));
            }
        }
        (asm, patches)
    }

    /// False where a state so near was seen before.
    fn is_new(&mut self, poses: &Poses, grain: f64) -> bool {
        let key = poses.iter().enumerate().flat_map(|(k, pose)| {
            let (c, l) = (self.bodies.centre[k], self.bodies.lever[k]);
            let marks = [c, c + DVec3::X * l, c + DVec3::Y * l].map(|p| pose.transform_point3(p));
            marks.into_iter().flat_map(move |p| (p / grain).round().to_array()).map(|x| x as i64)
        });
        self.seen.insert((grain.to_bits(), key.collect()))
    }

    fn note(&mut self, poses: &Poses) {
        for ((pose, c), r) in poses.iter().zip(&self.bodies.centre).zip(&mut self.reached) {
            let shift = pose.transform_point3(*c) - *c;
            let angle = DQuat::from_mat3(&pose.matrix3).normalize().to_axis_angle().1;
            let turn = angle.min(std::f64::consts::TAU - angle);
            r.farther(&Reached { shift, turn, ..*r });
        }
    }

    /// The way from home to a node and out, in few legs.
    fn exit(&self, node: usize, (parts, along): Way) -> Exit {
        let mut states: Vec<Poses> = vec![];
        let mut at = Some(node);
        while let Some(k) = at {
            states.push(self.nodes[k].poses.clone());
            states.extend(self.nodes[k].between.iter().rev().cloned());
            at = self.nodes[k].from;
        }
        states.reverse();
        let legs = self.legs(&states);
        let (asm, patches) = self.standing(&self.nodes[node].poses);
        Exit { legs, parts, along, asm, patches }
    }

    /// As few screws as pass: from each state to the last that one screw reaches.
    fn legs(&self, states: &[Poses]) -> Vec<Leg> {
        let (mut legs, mut at) = (Vec::new(), 0);
        while at + 1 < states.len() {
            let direct = |&to: &usize| {
                passes(self.bodies, &paths(&states[at], &states[to]), self.touch.depth()) == Passes::Yes
            };
            let to = (at + 2..states.len()).rev().find(direct).unwrap_or(at + 1);
            legs.extend(self.leg(&states[at], &states[to]));
            at = to;
        }
        legs
    }

    fn leg(&self, from: &Poses, to: &Poses) -> Option<Leg> {
        let paths = paths(from, to);
        let mut movers: Vec<(Set, Rigid)> = Vec::new();
        for (k, path) in paths.iter().enumerate() {
            let Some(rigid) = path.rigid(self.asm.mm_per_unit) else { continue };
            match movers.iter_mut().find(|(_, m)| *m == rigid) {
                Some((set, _)) => drop(set.insert(self.bodies.parts[k])),
                None => movers.push((Set::from([self.bodies.parts[k]]), rigid)),
            }
        }
        let clear = path::kept(self.bodies, &paths, self.touch.depth());
        (!movers.is_empty()).then_some(Leg { movers, clear })
    }
}

/// The motion of a leg as it is written.
pub fn written(leg: &Leg, ids: impl Fn(&Set) -> Vec<String>) -> Motion {
    match leg.movers.as_slice() {
        [(_, Rigid::Translation(shift))] => Motion::Translation(*shift),
        [(_, Rigid::Screw(screw))] => Motion::Screw(*screw),
        movers => Motion::Several {
            motions: movers
                .iter()
                .map(|(parts, motion)| Mover { parts: ids(parts), motion: *motion })
                .collect(),
        },
    }
}
