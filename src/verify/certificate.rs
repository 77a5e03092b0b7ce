//! Takes an assembly, its contacts and a proof as written; says whether the proof holds.
//!
//! Shares no code with `locking`. Rank is exact (modular elimination over the numbers as they are) and stands above
//! round-off; balance and the signs of a motion hold up to a stated round-off, not exactly. Not complete: a lock whose
//! rank hangs on less than round-off is refused.

use super::field::{Residue, ZERO, rank};
use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::report::answer::{Certificate, ForceAnswer, MotionAnswer, Proof, TwistAnswer, Word};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// Which motions a proof is about: translations alone leave out the moments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum About {
    Translations,
    RigidMotions,
}

/// Forces of size up to F over n rows miss balance by no more than this times F n when they are right: a few hundred
/// units of round-off for each term.
const ROUND_OFF: f64 = 1e-13;

/// A motion whose largest speed is 1 may break a row by no more than this, from the round-off of the solves behind it.
const SIGN_ROUND_OFF: f64 = 1e-9;

type Checked = Result<(), String>;

/// Holds the proof against the contacts of these parts.
pub fn proof(asm: &Assembly, patches: &[Patch], proof: &Proof, still: &[String], about: About) -> Checked {
    match (proof.verdict, &proof.certificate, &proof.motion, &proof.gap) {
        (Word::Locked, Some(c), None, None) if c.still == still => certificate(asm, patches, c, about),
        (Word::Locked, Some(_), None, None) => {
            Err("the certificate leaves out other parts than it should".into())
        }
        (Word::Free, None, Some(m), None) => motion(asm, patches, m, still, about),
        (Word::Undecided, None, None, Some(_)) => Ok(()),
        _ => Err("the verdict does not come with the one witness that belongs to it".into()),
    }
}

/// Forces of at least 1 on contacts that are there, in balance on every part that is not still, of full rank.
pub fn certificate(asm: &Assembly, patches: &[Patch], c: &Certificate, about: About) -> Checked {
    let index: BTreeMap<&str, PartIx> = asm.ids().map(|p| (asm.part(p).id.as_str(), p)).collect();
    let contacts: BTreeSet<_> = patches.iter().flat_map(rows).collect();
    let mut unknown = Columns::new(asm, &c.still, about)?;
    let (mut sums, mut largest) = (vec![0.0; unknown.count], 0.0_f64);
    let mut exact = Vec::with_capacity(c.forces.len());
    for (k, f) in c.forces.iter().enumerate() {
        let part =
            |id: &str| index.get(id).copied().ok_or_else(|| format!("force {k}: no part is called `{id}`"));
        let (a, b) = (part(&f.a)?, part(&f.b)?);
        let (n, p) = (DVec3::from_array(f.normal), DVec3::from_array(f.point));
        if !contacts.contains(&key(a, b, n, p)) {
            return Err(format!(
                "force {k}, between `{}` and `{}`, acts where there is no such contact",
                f.a, f.b
            ));
        }
        if !(f.size >= 1.0 && f.size.is_finite()) {
            return Err(format!("force {k} is {}, not at least 1", f.size));
        }
        largest = largest.max(f.size);
        unknown.add(a, -f.size, n, p, &mut sums);
        unknown.add(b, f.size, n, p, &mut sums);
        exact.push(unknown.exact(a, b, n, p));
    }
    let miss = sums.iter().fold(0.0_f64, |m, s| m.max(s.abs())) / unknown.reach();
    let allowed = ROUND_OFF * largest * c.forces.len().max(1) as f64;
    if miss.is_nan() || miss > allowed {
        return Err(format!(
            "the forces do not balance: they miss by {miss:.3e}, round-off explains {allowed:.3e}"
        ));
    }
    standing(&unknown, asm, c, &index)?;
    let found = rank(exact.into_iter(), unknown.count);
    match (found == unknown.count, c.rank == found && c.unknowns == unknown.count) {
        (true, true) => Ok(()),
        (true, false) => Err(format!("rank {} of {} is claimed, {found} is true", c.rank, c.unknowns)),
        (false, _) => Err(format!("the rows have rank {found}, less than the {} unknowns", unknown.count)),
    }
}

/// Full rank over the rationals may be owed to the rounding of the rows: a slide that is not along the axes has rounded
/// normals. So the rank must also stand above round-off: elimination with full pivoting on the rows' Gram matrix,
/// moments about the middle of each part's forces, may meet no pivot that round-off could have made.
fn standing(unknown: &Columns, asm: &Assembly, c: &Certificate, index: &BTreeMap<&str, PartIx>) -> Checked {
    let acting = |f: &ForceAnswer| [(index[f.a.as_str()], -1.0), (index[f.b.as_str()], 1.0)];
    let mut middle = vec![(DVec3::ZERO, 0.0); asm.parts.len()];
    for f in &c.forces {
        for (p, _) in acting(f) {
            middle[p.at()].0 += DVec3::from_array(f.point);
            middle[p.at()].1 += 1.0;
        }
    }
    let arm = |f: &ForceAnswer, p: PartIx| DVec3::from_array(f.point) - middle[p.at()].0 / middle[p.at()].1;
    let lever = c.forces.iter().flat_map(|f| acting(f).map(|(p, _)| arm(f, p).length())).fold(0.0, f64::max);
    let lever = if lever > 0.0 { lever } else { 1.0 };
    let n = unknown.count;
    let mut gram = vec![0.0; n * n];
    for f in &c.forces {
        let mut entries = Vec::with_capacity(12);
        for (p, sign) in acting(f) {
            let Some(first) = unknown.first[p.at()] else { continue };
            let (force, moment) =
                (DVec3::from_array(f.normal), arm(f, p).cross(DVec3::from_array(f.normal)) / lever);
            let values = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
            entries.extend(
                values.into_iter().take(unknown.width).enumerate().map(|(k, v)| (first + k, v * sign)),
            );
        }
        for &(i, v) in &entries {
            entries.iter().for_each(|&(j, w)| gram[i * n + j] += v * w);
        }
    }
    let ratio = least_pivot(gram, n);
    let noise = PIVOT_ROUND_OFF * (n + c.forces.len()) as f64;
    if ratio > noise {
        return Ok(());
    }
    Err(format!(
        "the rank stands on round-off: its least pivot is {ratio:.1e} of the largest, noise reaches {noise:.1e}"
    ))
}

/// A pivot of a Gram matrix of m rows and n columns is off by up to m + n units of round-off of the largest; a factor
/// 16 for the rows themselves, which are rounded too.
const PIVOT_ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// Least pivot over the largest, of elimination with the largest diagonal entry first.
fn least_pivot(mut g: Vec<f64>, n: usize) -> f64 {
    let mut left: Vec<usize> = (0..n).collect();
    let (mut first, mut least) = (0.0_f64, 1.0_f64);
    while let Some(at) =
        (0..left.len()).max_by(|&a, &b| g[left[a] * n + left[a]].total_cmp(&g[left[b] * n + left[b]]))
    {
        let k = left.swap_remove(at);
        let pivot = g[k * n + k];
        first = if first == 0.0 { pivot } else { first };
        if pivot.is_nan() || pivot <= 0.0 {
            return 0.0;
        }
        least = least.min(pivot / first);
        for &i in &left {
            let by = g[i * n + k] / pivot;
            if by != 0.0 {
                left.iter().for_each(|&j| g[i * n + j] -= by * g[k * n + j]);
            }
        }
    }
    least
}

type Key = (PartIx, PartIx, [u64; 3], [u64; 3]);

fn key(a: PartIx, b: PartIx, n: DVec3, p: DVec3) -> Key {
    (a, b, n.to_array().map(f64::to_bits), p.to_array().map(f64::to_bits))
}

fn rows(patch: &Patch) -> impl Iterator<Item = Key> + '_ {
    patch.corners.iter().map(|&p| key(patch.a, patch.b, patch.normal, p))
}

/// Where each part's unknowns stand; moments are about the origin of the assembly, not about the parts' centres, so
/// that nothing but the rows is shared with whoever made the proof.
struct Columns {
    first: Vec<Option<usize>>,
    width: usize,
    count: usize,
    /// Largest distance of a point from the origin: moments are compared with forces over it.
    far: f64,
}

impl Columns {
    fn new(asm: &Assembly, still: &[String], about: About) -> Result<Columns, String> {
        let width = if about == About::Translations { 3 } else { 6 };
        if let Some(id) = still.iter().find(|id| asm.parts.iter().all(|p| p.id != **id)) {
            return Err(format!("no part is called `{id}`"));
        }
        let mut count = 0;
        let first = asm.parts.iter().map(|p| {
            (!still.contains(&p.id)).then(|| {
                count += width;
                count - width
            })
        });
        let first = first.collect();
        Ok(Columns { first, width, count, far: 1.0 })
    }

    fn add(&mut self, part: PartIx, force: f64, n: DVec3, p: DVec3, sums: &mut [f64]) {
        let Some(c) = self.first[part.at()] else { return };
        self.far = self.far.max(p.length());
        let (f, m) = (n * force, p.cross(n) * force);
        for (k, v) in [f.x, f.y, f.z, m.x, m.y, m.z].into_iter().take(self.width).enumerate() {
            sums[c + k] += v;
        }
    }

    fn reach(&self) -> f64 {
        if self.width == 3 { 1.0 } else { self.far }
    }

    /// The row exactly, the cross product taken in the field.
    fn exact(&self, a: PartIx, b: PartIx, n: DVec3, p: DVec3) -> Vec<Residue> {
        let (n, p) = (n.to_array().map(Residue::of), p.to_array().map(Residue::of));
        let moment = |i: usize, j: usize| p[i].times(n[j]).minus(p[j].times(n[i]));
        let values = [n[0], n[1], n[2], moment(1, 2), moment(2, 0), moment(0, 1)];
        let mut row = vec![ZERO; self.count];
        for (part, negative) in [(a, true), (b, false)] {
            let Some(c) = self.first[part.at()] else { continue };
            for (k, &v) in values.iter().take(self.width).enumerate() {
                row[c + k] = if negative { ZERO.minus(v) } else { v };
            }
        }
        row
    }
}

/// A motion that is none of standing still, keeps still parts still, and breaks no contact row.
fn motion(asm: &Assembly, patches: &[Patch], m: &MotionAnswer, still: &[String], about: About) -> Checked {
    let twists: BTreeMap<&str, &TwistAnswer> = m.twists.iter().map(|t| (t.part.as_str(), t)).collect();
    if let Some(id) = twists.keys().find(|id| still.iter().any(|s| s == *id)) {
        return Err(format!("`{id}` may not move"));
    }
    if let Some(id) = twists.keys().find(|id| asm.parts.iter().all(|p| p.id != **id)) {
        return Err(format!("no part is called `{id}`"));
    }
    let velocity = |part: PartIx, p: DVec3| {
        twists.get(asm.part(part).id.as_str()).map_or(DVec3::ZERO, |t| {
            let [v, w, c] = [t.translation, t.rotation, t.centre].map(DVec3::from_array);
            v + w.cross(p - c)
        })
    };
    if about == About::Translations && m.twists.iter().any(|t| t.rotation != [0.0; 3]) {
        return Err("a translation does not turn".into());
    }
    let speed =
        asm.ids().flat_map(|p| asm.vertices(p).map(move |v| (p, v))).map(|(p, v)| velocity(p, v).length());
    let speed = speed.fold(0.0, f64::max);
    if !(speed > 0.0 && speed.is_finite()) {
        return Err("nothing moves".into());
    }
    let (mut worst, mut widest) = (0.0_f64, 0.0_f64);
    for patch in patches {
        for &p in &patch.corners {
            let opening = patch.normal.dot(velocity(patch.b, p) - velocity(patch.a, p)) / speed;
            if opening < -SIGN_ROUND_OFF {
                let (a, b) = (&asm.part(patch.a).id, &asm.part(patch.b).id);
                return Err(format!(
                    "`{a}` and `{b}` approach each other at {p}, at {:.3e} of the top speed",
                    -opening
                ));
            }
            (worst, widest) = (worst.min(opening), widest.max(opening));
        }
    }
    match (m.kind.as_str(), widest > SIGN_ROUND_OFF) {
        ("opens", true) | ("slides", false) => Ok(()),
        _ => {
            Err(format!("it is said to be a motion that {}, but the widest opening is {widest:.3e}", m.kind))
        }
    }
}
