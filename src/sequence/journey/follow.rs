//! Takes a state and a wish, gives the states reached by following the wish in steps: each step is the nearest motion
//! that the gaps allow, pulled out of what it overlaps, and then checked over its whole length.
//!
//! Sound up to the planner's own check (`path`). Not complete: where the wish meets a wall head on it stops.

use super::Work;
use super::bodies::{Bodies, Poses};
use super::path::{Passes, passes, paths};
use super::program::{MOST_ROWS, Row, SOLVED_WHOLE, Twist, moved, nearest, rows};
use crate::blocking::Touch;

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
        let room = |gap: f64| if gap < 0.0 { gap } else { (gap - keep).max(0.0) };
        let Some(x) = self.solve(at, &found, &scaled, step, room, work) else { return Stepped::Stopped };
        if self.share(&x, &scaled) < STOPPED_SHARE {
            return Stepped::Stopped;
        }
        let mut next = moved(self.bodies, at, &x);
        for _ in 0..MOST_PULLS {
            let (found, deepest) = rows(self.bodies, &next, touch, touch);
            if deepest <= touch / 4.0 {
                break;
            }
            let still = vec![Twist::default(); at.len()];
            let Some(x) = self.solve(&next, &found, &still, step, |gap| gap, work) else {
                return Stepped::TooLong;
            };
            next = moved(self.bodies, &next, &x);
        }
        match passes(self.bodies, &paths(at, &next), touch) {
            Passes::Yes => Stepped::To(next),
            Passes::No => Stepped::TooLong,
        }
    }

    fn solve(
        &self,
        at: &Poses,
        rows: &[Row],
        wish: &[Twist],
        step: f64,
        room: impl Fn(f64) -> f64,
        work: &mut Work,
    ) -> Option<Vec<Twist>> {
        // All rows are looked at in some rounds, the few that may bind are solved for.
        let movable = self.bodies.movable().count();
        work.spent += rows.len() + (rows.len().min(SOLVED_WHOLE) + 12 * movable) * 6 * movable;
        work.programs += 1;
        nearest(self.bodies, at, rows, wish, step, room)
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
