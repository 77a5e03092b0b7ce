//! Takes contact forces as written and the contacts that are there; proves that they lock, or says why not.
//!
//! Theorem, where it answers `exact`: over the rationals the contact rows named have full rank, and there are forces in
//! exact balance on them, each at least `least_force` > 0; so the parts are locked to first order (Stiemke). It also
//! holds for all rows that differ from those written by up to `bound`. Shares no code with `locking`. Not complete: a
//! lock that hangs on less than round-off of its rows is refused.
//!
//! Proof. Let A be the rows, y the forces, D = diag(y), B = D A with columns scaled. r = B^T 1 is what misses balance,
//! summed exactly; s is a proven lower bound of the least singular value of B, so the rank is full. The least solution
//! of B^T e = -r has |e| <= |r| / s. Where that is below 1, the forces y (1 + e) balance exactly and are all at least
//! y (1 - |r| / s) > 0. Rows that are off by E change r by at most |E^T 1| and s by at most |E|.

use super::certificate::{About, Arithmetic, Key, Shown, key, rows};
use super::dyadic::{self, Dyadic};
use super::field::{Residue, ZERO, rank};
use super::order::order;
use super::singular::{Sparse, UP, least_singular};
use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::report::answer::Certificate;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// How far the numbers in a contact row may be from the truth by round-off alone: each part of a unit normal, and each
/// coordinate of a point as a share of the point's largest, by 8 units. A pose costs 4 (three products, three sums), a
/// normal 3 more (squares, root, quotient), its own last digit one.
pub const ROW_ROUND_OFF: f64 = 8.0 * UNIT;

/// Forces as written may miss balance, for each unknown, by this share of all that acts along it, and no more: their own
/// rounding makes one unit of it, the sums of the solve that made them one for each term, of which a part has up to some
/// thousands. What a forger makes of a certificate is not one, even where the lock itself is true.
const BALANCE_ROUND_OFF: f64 = 4096.0 * UNIT;

/// Rows that are off by more are not asked about, so that a product of two changes stays small beside either.
const MOST_OFF: f64 = 1.0 / 1024.0;

/// Half a unit in the last place of 1.
const UNIT: f64 = f64::EPSILON / 2.0;

/// A force with its names looked up.
struct Force {
    a: PartIx,
    b: PartIx,
    n: DVec3,
    p: DVec3,
    size: f64,
}

impl Force {
    fn sides(&self) -> [(PartIx, f64); 2] {
        [(self.a, -1.0), (self.b, 1.0)]
    }
}

/// Where a part's unknowns stand, and about which point and with which length its moments are taken.
#[derive(Clone, Copy)]
struct Frame {
    column: usize,
    centre: DVec3,
    /// A power of two.
    lever: f64,
}

/// Forces of at least 1 on contacts that are there, whose rows lock the parts that are not still.
pub fn certificate(
    asm: &Assembly,
    patches: &[Patch],
    c: &Certificate,
    about: About,
) -> Result<Shown, String> {
    let forces = forces(asm, patches, c)?;
    let width = about.width();
    let frames = frames(asm, &forces, &c.still, width)?;
    let count = frames.iter().flatten().count() * width;
    if c.kind != "self-stress" || c.unknowns != count || c.rank != count {
        let claim = format!("{} of rank {} over {} unknowns", c.kind, c.rank, c.unknowns);
        return Err(format!("{claim} is claimed; a self-stress of rank {count} over {count} is needed"));
    }
    if count == 0 {
        let how = "nothing is free to move".to_string();
        return Ok(Shown { how, rank: Some(0), ..Shown::new(Arithmetic::Exact) });
    }
    let stack = Stack::new(&forces, &frames, width, count);
    let Some(singular) = least_singular(&stack.rows, count) else {
        return Err(no_rank(&forces, &frames, width, count));
    };
    judged(&stack, singular, &forces, count)
}

fn judged(stack: &Stack, singular: f64, forces: &[Force], count: usize) -> Result<Shown, String> {
    let (kept, miss) = (singular - stack.rounding, stack.miss);
    // Not "at least": what is no number must not pass.
    if kept.is_nan() || kept <= 0.0 || miss.is_nan() {
        return Err(format!(
            "the rank stands on the rounding of the check: {singular:.1e} against {:.1e}",
            stack.rounding
        ));
    }
    let share = miss / kept * UP;
    if stack.unbalanced > BALANCE_ROUND_OFF {
        return Err(format!(
            "the forces do not balance: they miss by {:.1e} of themselves, round-off explains {BALANCE_ROUND_OFF:.1e}",
            stack.unbalanced
        ));
    }
    if share >= 1.0 {
        return Err(format!(
            "the forces miss balance by {miss:.1e}, and forces near them that balance exactly are only known to be \
             positive below {kept:.1e}"
        ));
    }
    let bound = (kept - miss) / (stack.turn + stack.spread) / UP;
    if bound.is_nan() || bound <= ROW_ROUND_OFF {
        return Err(format!(
            "the lock stands on round-off: it is shown for rows within {bound:.1e} of those written, their round-off \
             reaches {ROW_ROUND_OFF:.1e}"
        ));
    }
    let bound = bound.min(MOST_OFF);
    let least = forces.iter().map(|f| f.size).fold(f64::INFINITY, f64::min) * (1.0 - share - f64::EPSILON);
    let how = format!(
        "exact forces in balance exist within {share:.1e} (relative) of those written; rank {count} of {count}; \
         proven for all rows within {bound:.1e} of those written"
    );
    Ok(Shown {
        how,
        rank: Some(count),
        least_force: Some(least),
        bound: Some(bound),
        ..Shown::new(Arithmetic::Exact)
    })
}

fn forces(asm: &Assembly, patches: &[Patch], c: &Certificate) -> Result<Vec<Force>, String> {
    let index: BTreeMap<&str, PartIx> = asm.ids().map(|p| (asm.part(p).id.as_str(), p)).collect();
    let contacts: BTreeSet<Key> = patches.iter().flat_map(rows).collect();
    let read = |(k, f): (usize, &crate::report::answer::ForceAnswer)| {
        let part =
            |id: &str| index.get(id).copied().ok_or_else(|| format!("force {k}: no part is called `{id}`"));
        let (a, b) = (part(&f.a)?, part(&f.b)?);
        let (n, p) = (DVec3::from_array(f.normal), DVec3::from_array(f.point));
        if !contacts.contains(&key(a, b, n, p)) || !n.is_finite() || !p.is_finite() {
            let between = format!("between `{}` and `{}`", f.a, f.b);
            return Err(format!("force {k}, {between}, acts where there is no such contact"));
        }
        if !(f.size >= 1.0 && f.size.is_finite()) {
            return Err(format!("force {k} is {}, not at least 1", f.size));
        }
        Ok(Force { a, b, n, p, size: f.size })
    };
    c.forces.iter().enumerate().map(read).collect()
}

/// A frame for each part that is not still; parts that touch get columns near each other.
fn frames(
    asm: &Assembly,
    forces: &[Force],
    still: &[String],
    width: usize,
) -> Result<Vec<Option<Frame>>, String> {
    if let Some(id) = still.iter().find(|id| asm.parts.iter().all(|p| p.id != **id)) {
        return Err(format!("no part is called `{id}`"));
    }
    let free: Vec<bool> = asm.parts.iter().map(|p| !still.contains(&p.id)).collect();
    let place = order(&free, forces.iter().map(|f| (f.a.at(), f.b.at())));
    let mut middle = vec![(DVec3::ZERO, 0.0); asm.parts.len()];
    for f in forces {
        for (p, _) in f.sides() {
            middle[p.at()].0 += f.p;
            middle[p.at()].1 += 1.0;
        }
    }
    let centre = |p: usize| if middle[p].1 > 0.0 { middle[p].0 / middle[p].1 } else { DVec3::ZERO };
    let mut far = vec![0.0_f64; asm.parts.len()];
    for f in forces {
        f.sides().iter().for_each(|(p, _)| far[p.at()] = far[p.at()].max((f.p - centre(p.at())).length()));
    }
    let frame = |p: usize| {
        place[p].map(|k| Frame { column: k * width, centre: centre(p), lever: power_of_two(far[p]) })
    };
    Ok((0..asm.parts.len()).map(frame).collect())
}

/// The power of two next below; 1 where there is none.
fn power_of_two(v: f64) -> f64 {
    if v.is_normal() && v > 0.0 { 2f64.powi(v.log2().floor().clamp(-900.0, 900.0) as i32) } else { 1.0 }
}

/// The matrix B in f64, and what is off in it.
struct Stack {
    rows: Vec<Sparse>,
    /// Norm of what rounding can have made of B.
    rounding: f64,
    /// Norm of the change of B, and of its column sums, for each unit that normals and points are off.
    spread: f64,
    turn: f64,
    /// |B^T 1|, from an exact sum, rounded up.
    miss: f64,
    /// Largest part of that, as a share of what acts along its unknown.
    unbalanced: f64,
}

/// An entry of B: its column, its value, what rounding can have made of it, its change for a unit off.
struct Entry {
    column: usize,
    value: f64,
    rounding: f64,
    off: f64,
}

impl Stack {
    fn new(forces: &[Force], frames: &[Option<Frame>], width: usize, count: usize) -> Stack {
        // A power of two for all forces alike: nothing changes but the range.
        let top = power_of_two(forces.iter().map(|f| f.size).fold(0.0, f64::max));
        let all: Vec<Vec<Entry>> = forces.iter().map(|f| entries(f, frames, width, f.size / top)).collect();
        let mut diagonal = vec![0.0; count];
        all.iter().flatten().for_each(|e| diagonal[e.column] += e.value * e.value);
        let scale: Vec<f64> = diagonal.iter().map(|d| 1.0 / power_of_two(d.sqrt())).collect();
        let (mut rounding, mut spread, mut sums) = (0.0, 0.0, vec![0.0; count]);
        for e in all.iter().flatten() {
            rounding += (e.rounding * scale[e.column]).powi(2);
            spread += (e.off * scale[e.column]).powi(2);
            sums[e.column] += e.off * scale[e.column];
        }
        let mut acting = vec![0.0; count];
        all.iter().flatten().for_each(|e| acting[e.column] += e.value.abs() * scale[e.column]);
        let norm = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt() * UP;
        let miss: Vec<f64> =
            miss(forces, frames, width, count).iter().zip(&scale).map(|(m, s)| m * s / top).collect();
        let share = |(m, a): (&f64, f64)| if *m > 0.0 { m / a } else { 0.0 };
        let unbalanced = miss.iter().zip(acting).map(share).fold(0.0, f64::max);
        let row = |r: &Vec<Entry>| r.iter().map(|e| (e.column, e.value * scale[e.column])).collect();
        Stack {
            rows: all.iter().map(row).collect(),
            rounding: rounding.sqrt() * UP,
            spread: spread.sqrt() * UP,
            turn: norm(&sums),
            miss: norm(&miss),
            unbalanced,
        }
    }
}

/// A row of B: the force times normal and moment on both sides.
fn entries(f: &Force, frames: &[Option<Frame>], width: usize, size: f64) -> Vec<Entry> {
    let far = f.p.abs().max_element();
    let mut row = Vec::with_capacity(2 * width);
    for (part, sign) in f.sides() {
        let Some(frame) = frames[part.at()] else { continue };
        let arm = f.p - frame.centre;
        let by = size / frame.lever;
        for k in 0..width {
            // A normal's part: one product. A moment's: an arm, a product on either side, their difference, a product.
            let entry = |value: f64, terms: f64, rounding: f64, off: f64| Entry {
                column: frame.column + k,
                value: value * sign,
                rounding: rounding * UNIT * terms + f64::MIN_POSITIVE,
                off,
            };
            row.push(if k < 3 {
                entry(size * f.n[k], size * f.n[k].abs(), 2.0, size)
            } else {
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let terms = (arm[i] * f.n[j]).abs() + (arm[j] * f.n[i]).abs();
                let off = arm[i].abs() + arm[j].abs() + far * (f.n[i].abs() + f.n[j].abs() + 2.0 * MOST_OFF);
                entry(by * (arm[i] * f.n[j] - arm[j] * f.n[i]), by * terms, 8.0, by * off * UP)
            });
        }
    }
    row
}

/// What the forces miss balance by, for each unknown, summed exactly and rounded up.
fn miss(forces: &[Force], frames: &[Option<Frame>], width: usize, count: usize) -> Vec<f64> {
    let mut sums = vec![Dyadic::zero(); count];
    let mut levers = vec![1.0; count];
    for f in forces {
        let size = Dyadic::of(f.size);
        let n = dyadic::vector(f.n).map(|v| v.times(&size));
        for (part, sign) in f.sides() {
            let Some(frame) = frames[part.at()] else { continue };
            let centre = dyadic::vector(frame.centre);
            let point = dyadic::vector(f.p);
            let arm = [0, 1, 2].map(|k| point[k].clone().minus(&centre[k]));
            let all = n.iter().cloned().chain(dyadic::cross(&arm, &n));
            for (k, v) in all.take(width).enumerate() {
                let at = frame.column + k;
                let old = std::mem::replace(&mut sums[at], Dyadic::zero());
                sums[at] = if sign > 0.0 { old.plus(&v) } else { old.minus(&v) };
                levers[at] = if k < 3 { 1.0 } else { frame.lever };
            }
        }
    }
    sums.iter().zip(levers).map(|(s, l)| s.size_above() / l).collect()
}

/// Steps of the modular elimination that are borne, only to say more about a certificate that is refused.
const MOST_STEPS: f64 = 1e9;

/// Why no bound of the least singular value was found, as far as the exact rank tells.
fn no_rank(forces: &[Force], frames: &[Option<Frame>], width: usize, count: usize) -> String {
    let short = format!("the rows named were not shown to have rank {count}, the number of unknowns");
    if forces.len() as f64 * (count as f64).powi(2) > MOST_STEPS {
        return short;
    }
    let found = rank(forces.iter().map(|f| residues(f, frames, width, count)), count);
    if found < count {
        return format!("the rows have rank {found}, less than the {count} unknowns");
    }
    format!("{short}: as written they have it, but by less than round-off")
}

/// The row in the field; moments about the origin, which does not change the rank.
fn residues(f: &Force, frames: &[Option<Frame>], width: usize, count: usize) -> Vec<Residue> {
    let (n, p) = (f.n.to_array().map(Residue::of), f.p.to_array().map(Residue::of));
    let moment = |i: usize, j: usize| p[i].times(n[j]).minus(p[j].times(n[i]));
    let values = [n[0], n[1], n[2], moment(1, 2), moment(2, 0), moment(0, 1)];
    let mut row = vec![ZERO; count];
    for (part, sign) in f.sides() {
        let Some(frame) = frames[part.at()] else { continue };
        for (k, &v) in values.iter().take(width).enumerate() {
            row[frame.column + k] = if sign < 0.0 { ZERO.minus(v) } else { v };
        }
    }
    row
}
