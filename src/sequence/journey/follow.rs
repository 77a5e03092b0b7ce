//! Takes a state and a wish, gives the states reached by following the wish in steps: each step is the nearest motion
//! that the gaps allow, pulled out of what it overlaps, and then checked over its whole length.
//!
//! Sound up to the planner's own check (`path`). Not complete: where the wish meets a wall head on it stops.

use super::Work;
use super::bodies::{Bodies, Poses};
use super::path::{Passes, passes, paths};
use super::program::{MOST_ROWS, Row, SOLVED_WHOLE, Twist, moved, nearest, rows};
use crate::blocking::Touch;
use glam::DVec3;
use std::collections::BTreeSet;

/// Steps of one wish.
const MOST_STEPS: usize = 200;

/// The longest step, as a share of the smallest lever: with the turn of 15 degrees that divides a right angle.
const LONGEST: f64 = std::f64::consts::PI / 12.0;

/// The shortest, as a share of the longest: 2^-7, about two milliradians: at no clearance a step along a curved contact
/// is off by lever * angle^2 / 8, which is 2^-21 of the lever: half of what counts as touching.
const SHORTEST_SHARE: f64 = 1.0 / 128.0;

/// A step that does less of the wish than this share has stopped.
const STOPPED_SHARE: f64 = 0.02;

/// Pulls out of an overlap before a step is given up: each squares what is left.
const MOST_PULLS: usize = 4;

/// Overlap that a step may start and end with, as a share of what counts as touching: what a file's digits leave of a
/// contact. A part between two walls that are both a digit too near could otherwise not move at all. Pulls go to half of it.
const LEFT_SHARE: f64 = 0.25;

/// How near parts may come where there is room: as a share of the smallest lever.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance(pub f64);

pub struct Follow<'a> {
    pub bodies: &'a Bodies,
    pub touch: Touch,
    /// Kept from walls where a part is not nearer already: room for longer steps.
    pub distance: Distance,
}

impl Follow<'_> {
    fn least_lever(&self) -> f64 {
        self.bodies.movable().map(|k| self.bodies.lever[k]).fold(f64::INFINITY, f64::min)
    }

    /// The states after the first; empty where the wish could not begin. `wish` is scaled so that the largest of its
    /// shifts and of its turns times lever is 1.
    pub fn follow(&self, from: &Poses, wish: &[Twist], work: &mut Work) -> Vec<Poses> {
        let longest = LONGEST * self.least_lever();
        let (mut step, mut at, mut out) = (longest, from.clone(), Vec::new());
        for _ in 0..MOST_STEPS {
            if work.is_spent() {
                break;
            }
            match self.step(&at, wish, step, work) {
                Stepped::To(next) => {
                    out.push(next.clone());
                    at = next;
                    step = (step * 2.0).min(longest);
                }
                Stepped::TooLong if step > longest * SHORTEST_SHARE => step /= 4.0,
                Stepped::TooLong | Stepped::Stopped => break,
            }
        }
        out
    }

    fn step(&self, at: &Poses, wish: &[Twist], step: f64, work: &mut Work) -> Stepped {
        let touch = self.touch.depth();
        let keep = self.distance.0 * self.least_lever();
        let (found, _) = rows(self.bodies, at, 4.0 * step + keep, touch);
        if found.len() > MOST_ROWS {
            // Finding them was the work; a shorter step has fewer.
            work.spent += found.len();
            return Stepped::TooLong;
        }
        let scaled: Vec<Twist> =
            wish.iter().map(|t| Twist { shift: t.shift * step, turn: t.turn * step }).collect();
        let left = LEFT_SHARE * touch;
        let room = |gap: f64| if gap < 0.0 { (gap + left).min(0.0) } else { (gap - keep).max(0.0) };
        let Some(x) = self.solve(self.bodies, at, &found, (&scaled, step), room, work) else {
            return Stepped::Stopped;
        };
        if self.share(&x, &scaled) < STOPPED_SHARE {
            return Stepped::Stopped;
        }
        let Some(next) = self.pulled_out(at, moved(self.bodies, at, &x), step, work) else {
            return Stepped::TooLong;
        };
        match passes(self.bodies, &paths(at, &next), touch) {
            Passes::Yes => Stepped::To(next),
            Passes::No => Stepped::TooLong,
        }
    }

    /// The state with what a step overlapped opened again: by the parts that it moved, or else by all.
    fn pulled_out(&self, at: &Poses, next: Poses, step: f64, work: &mut Work) -> Option<Poses> {
        let next = self.calm(at, next);
        let movers: BTreeSet<usize> = (0..at.len()).filter(|&k| next[k] != at[k]).collect();
        let own = self.pull(&self.bodies.moving(&movers), next.clone(), step, work);
        own.or_else(|| self.pull(self.bodies, next, step, work))
    }

    fn pull(&self, movers: &Bodies, mut next: Poses, step: f64, work: &mut Work) -> Option<Poses> {
        let (touch, left) = (self.touch.depth(), LEFT_SHARE * self.touch.depth());
        let still = vec![Twist::default(); next.len()];
        for pulls in 0..=MOST_PULLS {
            let (found, deepest) = rows(self.bodies, &next, touch, touch);
            if deepest <= left {
                return Some(next);
            }
            if pulls < MOST_PULLS {
                let x = self.solve(movers, &next, &found, (&still, step), |gap| gap + left / 2.0, work)?;
                next = moved(movers, &next, &x);
            }
        }
        None
    }

    /// The same with those parts where they were that moved by less than what may overlap: a plan need not name them.
    fn calm(&self, at: &Poses, next: Poses) -> Poses {
        let left = LEFT_SHARE * self.touch.depth();
        let trembles = |k: usize| {
            let (c, l) = (self.bodies.centre[k], self.bodies.lever[k]);
            let far = |p: DVec3| at[k].transform_point3(p).distance(next[k].transform_point3(p));
            [c, c + DVec3::X * l, c + DVec3::Y * l].into_iter().all(|p| far(p) < left)
        };
        (0..at.len()).map(|k| if trembles(k) { at[k] } else { next[k] }).collect()
    }

    fn solve(
        &self,
        bodies: &Bodies,
        at: &Poses,
        rows: &[Row],
        (wish, step): (&[Twist], f64),
        room: impl Fn(f64) -> f64,
        work: &mut Work,
    ) -> Option<Vec<Twist>> {
        // All rows are looked at in some rounds, the few that may bind are solved for.
        let movable = bodies.movable().count();
        work.spent += rows.len() + (rows.len().min(SOLVED_WHOLE) + 12 * movable) * 6 * movable;
        work.programs += 1;
        nearest(bodies, at, rows, wish, step, room)
    }

    /// How much of the wish a motion does.
    fn share(&self, x: &[Twist], wish: &[Twist]) -> f64 {
        let dot = |a: &[Twist]| -> f64 {
            let own = a.iter().zip(wish).enumerate();
            own.map(|(k, (a, w))| a.shift.dot(w.shift) + a.turn.dot(w.turn) * self.bodies.lever[k].powi(2))
                .sum()
        };
        dot(x) / dot(wish)
    }
}

enum Stepped {
    To(Poses),
    TooLong,
    Stopped,
}
