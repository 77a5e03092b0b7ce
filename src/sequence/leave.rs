//! Takes a set of parts and the rest, gives a direction along which the set can leave by one straight move, or says that
//! there is none, or that the search gave up.
//!
//! The free directions are the polar cone of the patch normals less the cones that pairs of cells block. They are
//! searched without sampling: a direction is tried, what stops it takes its whole cone away, and so on until a
//! direction is free or none is left. `Along` is sound (each direction is swept against every part of the rest);
//! `Never` holds for directions farther than `SAME_ANGLE` from the edge of every blocked cone.

use super::field::{Field, Set};
use crate::blocking::SAME_ANGLE;
use crate::blocking::cone::{Cone, polar};
use crate::blocking::sector::{Blocked, Sector, sectors};
use crate::blocking::shadow::View;
use glam::DVec3;
use std::collections::VecDeque;

/// Directions tried for one set before giving up: woven parts need fewer than ten, and each try costs about as much
/// as one sweep against every neighbor.
const MOST_TRIES: usize = 400;

/// Sectors looked at for one set before giving up: fifty pieces for each try.
const MOST_SECTORS: usize = 50 * MOST_TRIES;

/// What was found for a set, and how many directions were tried.
#[derive(Clone, Debug)]
pub struct Search {
    pub found: Found,
    pub tried: usize,
}

#[derive(Clone, Debug)]
pub enum Found {
    /// Unit direction.
    Along(DVec3),
    /// No straight move to infinity, as long as all of `because` stay.
    Never { because: Set },
    /// Not found in `MOST_TRIES`, or before a stop; worth a new try when one of `because` has gone.
    GaveUp { because: Set },
}

/// Directions in `prefer` that are free come first, then the middle of the cone of first-order free directions, its
/// lines, its rays, and what else is left.
pub fn leave(field: &Field, moving: &Set, rest: &Set, prefer: &[DVec3]) -> Search {
    let mut because: Set = field.sides(moving, rest).map(|s| s.other).collect();
    let normals = || field.sides(moving, rest).map(|s| s.normal);
    let cone = polar(normals());
    let mut tries = Tries { field, moving, rest, because: &mut because, tried: Vec::new(), cut: Vec::new() };
    let preferred = prefer.iter().copied().filter(|d| normals().all(|n| n.dot(*d) <= SAME_ANGLE));
    let named = preferred.chain(landmarks(&cone)).take_while(|_| !field.watch.is_stopped());
    let found = named.into_iter().find(|&d| tries.is_free(d));
    let end = found.map_or_else(|| tries.exhaust(sectors(&cone).into()), End::Free);
    let tried = tries.tried.len();
    let found = match end {
        End::Free(d) => Found::Along(d),
        End::NoneLeft => Found::Never { because },
        End::OutOfTries => Found::GaveUp { because },
    };
    Search { found, tried }
}

/// The directions of a cone that have a name.
pub fn landmarks(cone: &Cone) -> impl Iterator<Item = DVec3> + '_ {
    let lines = cone.lines.iter().flat_map(|&l| [l, -l]);
    cone.middle.into_iter().chain(lines).chain(cone.rays.iter().copied())
}

struct Tries<'s, 'a> {
    field: &'s Field<'a>,
    moving: &'s Set,
    rest: &'s Set,
    because: &'s mut Set,
    tried: Vec<DVec3>,
    cut: Vec<Blocked>,
}

impl Tries<'_, '_> {
    fn is_free(&mut self, d: DVec3) -> bool {
        if self.tried.iter().any(|t| t.distance(d) <= SAME_ANGLE) || self.cut.iter().any(|b| b.holds(d)) {
            return false;
        }
        self.tried.push(d);
        let stopped = self.field.stopped(&View::new(&self.field.shapes, d), self.moving, self.rest);
        let Some((by, blocked)) = stopped else { return true };
        self.because.insert(by);
        self.cut.push(blocked);
        false
    }

    /// First in, first out, so that wide sectors come before their own pieces.
    fn exhaust(&mut self, mut left: VecDeque<Sector>) -> End {
        for _ in 0..MOST_SECTORS {
            if self.field.watch.is_stopped() {
                return End::OutOfTries;
            }
            let Some(sector) = left.pop_front() else { return End::NoneLeft };
            let d = sector.middle();
            let known = |cut: &[Blocked]| cut.iter().position(|b| b.holds(d));
            if known(&self.cut).is_none() {
                if self.tried.len() >= MOST_TRIES {
                    return End::OutOfTries;
                }
                if self.is_free(d) {
                    return End::Free(d);
                }
            }
            match known(&self.cut) {
                Some(k) => left.extend(self.cut[k].taken_from(&sector)),
                None => left.extend(sector.split(d)),
            }
        }
        End::OutOfTries
    }
}

/// How the search through all sectors ended.
enum End {
    Free(DVec3),
    NoneLeft,
    OutOfTries,
}
