//! Takes contacts with rows and contacts whose normal is not unique; gives verdicts that hold whichever normal counts.
//!
//! Locked stands without the latter: fewer rows, more motions. A motion is kept only if each loose contact lets it
//! pass: two convex corners stay apart when one of the planes between them does. Sound up to round-off. Not complete:
//! where a motion does not pass, the plane that it breaks least is taken for a row, one choice of many.

use super::{Check, Gap, Motion, ROUND_OFF, Twist, Verdict, check};
use crate::assembly::{Assembly, PartIx};
use crate::contact::{Loose, Patch};
use glam::DVec3;

/// As [`check`], with contacts that have no unique normal.
pub fn check_loose(assembly: &Assembly, patches: &[Patch], loose: &[Loose], fix: Option<PartIx>) -> Check {
    let first = check(assembly, patches, fix);
    let loose: Vec<&Loose> = loose.iter().collect();
    let with = |planes: &[Patch]| check(assembly, &[patches, planes].concat(), fix);
    let translation = vouched(&loose, first.translation.clone(), |planes| with(planes).translation);
    let rigid = vouched(&loose, first.rigid.clone(), |planes| with(planes).rigid);
    Check { translation, rigid, ..first }
}

/// The verdict where a motion keeps these contacts too; `with` decides with some of their planes as contacts.
pub fn vouched(loose: &[&Loose], mut verdict: Verdict, with: impl Fn(&[Patch]) -> Verdict) -> Verdict {
    let mut planes = Vec::new();
    // Each round takes at least one loose contact for good.
    for round in 0..=loose.len() {
        let motion = match &verdict {
            Verdict::Free(motion) => motion,
            _ if round == 0 => return verdict,
            _ => break,
        };
        let broken: Vec<Patch> = loose.iter().filter_map(|l| broken(l, motion)).collect();
        if broken.is_empty() {
            return verdict;
        }
        planes.extend(broken);
        verdict = with(&planes);
    }
    let why = "free if contacts without a unique normal give way; no motion was found that they let pass";
    Verdict::Undecided(Gap { why: why.into(), size: f64::NAN })
}

/// The plane that a motion breaks least, as a contact, if it breaks all.
fn broken(loose: &Loose, motion: &Motion) -> Option<Patch> {
    let way = |n: &DVec3| {
        let opening = |p: &DVec3| n.dot(velocity(motion, loose.b, *p) - velocity(motion, loose.a, *p));
        loose.corners.iter().map(opening).fold(f64::INFINITY, f64::min)
    };
    let best = loose.normals.iter().max_by(|m, n| way(m).total_cmp(&way(n)))?;
    let patch = Patch { a: loose.a, b: loose.b, normal: *best, corners: loose.corners.clone() };
    (way(best) < -ROUND_OFF).then_some(patch)
}

/// Velocity of a point of the part; the motion's largest component is 1.
fn velocity(motion: &Motion, part: PartIx, point: DVec3) -> DVec3 {
    let twist = motion.twists.iter().find(|(p, _)| *p == part);
    twist.map_or(DVec3::ZERO, |(_, t): &(PartIx, Twist)| t.translation + t.rotation.cross(point - t.centre))
}
