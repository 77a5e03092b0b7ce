//! Takes a set of parts, gives the motions worth following: what the first-order verdict lets start, and shifts and turns
//! of single parts along and about the axes of the set.
//!
//! Nothing here decides anything.

use super::bodies::Bodies;
use super::program::Twist;
use crate::assembly::Assembly;
use crate::blocking::SAME_ANGLE;
use crate::contact::Patch;
use crate::locking::{Verdict, check_some};
use crate::sequence::field::Set;
use glam::DVec3;

/// Six directions, three and their opposites, that turn with the set: along its contacts where it has some. The one that
/// most patches face across comes first.
pub fn frame(patches: &[Patch], set: &Set) -> Vec<DVec3> {
    let inside = |p: &&Patch| set.contains(&p.a) && set.contains(&p.b);
    let mut faces: Vec<(DVec3, usize)> = Vec::new();
    for p in patches.iter().filter(inside) {
        let same = |f: &&mut (DVec3, usize)| f.0.cross(p.normal).length() <= SAME_ANGLE;
        match faces.iter_mut().find(same) {
            Some(f) => f.1 += 1,
            None => faces.push((p.normal, 1)),
        }
    }
    faces.sort_by_key(|f| std::cmp::Reverse(f.1));
    let z = faces.first().map_or(DVec3::Z, |f| f.0);
    // The next that is far from parallel to it: its part across is worth normalizing.
    let across = faces.iter().map(|f| f.0.reject_from_normalized(z)).find(|n| n.length() > 0.1);
    let fallback = if z.dot(DVec3::X).abs() < 0.9 { DVec3::X } else { DVec3::Y };
    let x = across.unwrap_or_else(|| fallback.reject_from_normalized(z)).normalize();
    let y = z.cross(x);
    vec![z, -z, x, -x, y, -y]
}

/// What the first-order verdict lets start of those that may move, if the set is free by it.
pub fn free(asm: &Assembly, bodies: &Bodies, patches: &[Patch]) -> Option<Vec<Twist>> {
    let Verdict::Free(motion) = check_some(asm, patches, &bodies.parts) else { return None };
    let of = |k: usize| {
        let twist = motion.twists.iter().find(|(p, _)| *p == bodies.parts[k]);
        twist.map_or_else(Twist::default, |(_, t)| Twist {
            shift: t.translation + t.rotation.cross(bodies.centre[k] - t.centre),
            turn: t.rotation,
        })
    };
    let all: Vec<Twist> = (0..bodies.parts.len()).map(of).collect();
    let fixed = bodies.fixed.iter().position(|f| *f)?;
    let seen = |(k, t): (usize, &Twist)| match bodies.fixed[k] {
        true => Twist::default(),
        false => seen_from(bodies, *t, k, all[fixed], fixed),
    };
    scaled(bodies, all.iter().enumerate().map(seen).collect())
}

/// The motion of part k less what the fixed part does.
fn seen_from(bodies: &Bodies, t: Twist, k: usize, fixed: Twist, at: usize) -> Twist {
    let drag = fixed.shift + fixed.turn.cross(bodies.centre[k] - bodies.centre[at]);
    Twist { shift: t.shift - drag, turn: t.turn - fixed.turn }
}

/// So that the largest shift, and turn times lever, is 1; None where nothing moves.
fn scaled(bodies: &Bodies, wish: Vec<Twist>) -> Option<Vec<Twist>> {
    let size = |(t, l): (&Twist, &f64)| t.shift.length().max(t.turn.length() * l);
    let most = wish.iter().zip(&bodies.lever).map(size).fold(0.0, f64::max);
    let unit = |t: Twist| Twist { shift: t.shift / most, turn: t.turn / most };
    (most > 0.0).then(|| wish.into_iter().map(unit).collect())
}

/// Shifts and turns of each part that may move, the others asked to stay (they may be pushed).
pub fn single(bodies: &Bodies, frame: &[DVec3]) -> Vec<Vec<Twist>> {
    let mut out = Vec::new();
    for k in bodies.movable() {
        let turn = |d: &DVec3| Twist { turn: *d / bodies.lever[k], shift: DVec3::ZERO };
        let shift = |d: &DVec3| Twist { shift: *d, turn: DVec3::ZERO };
        for twist in frame.iter().map(shift).chain(frame.iter().map(turn)) {
            let mut wish = vec![Twist::default(); bodies.parts.len()];
            wish[k] = twist;
            out.push(wish);
        }
    }
    out
}
