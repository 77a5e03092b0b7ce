//! Takes an answer of `flex`; says whether it holds: cores locked, no smaller set meets them, every set has its plan.
//!
//! Shares no code with the search. The bound is found again by exhaustion over the cores as written; symmetries are held
//! against the parts' vertices. Not checked: that sets called unproven are stuck (nothing is claimed of them), nor that
//! larger minimal sets are all there.

use super::{Proofs, Verified, as_made, digits, locked_alone, parts, plan, rebuild, same, sealed, verified};
use crate::assembly::{Assembly, PartIx};
use crate::contact::Joined;
use crate::fault::Faults;
use crate::report::answer::{FlexAnswer, OrbitAnswer, SymmetryOfParts};
use crate::sequence::Outcome;
use crate::spec::{self, Subject, Syntax};
use glam::{DMat3, DVec3};
use std::collections::BTreeSet;
use std::path::Path;

type Set = BTreeSet<PartIx>;
type Checked = Result<(), String>;

/// Branches looked at before an exhaustion is given up, and the answer with it.
const MOST_BRANCHES: usize = 1 << 22;

/// Vertices of woven tiles are rounded to 2^-40 of a crossing; maps over a thousand crossings carry that to 2^-30.
const SAME_VERTEX: f64 = 1.0 / (1_u64 << 30) as f64;

pub fn answer(a: &FlexAnswer) -> Result<Verified, Faults> {
    let joined = rebuild(&a.source)?;
    let within = within(a)?;
    let good = match a.minimum {
        Some(_) => "cores, bound, sets and plans hold",
        None => "cores, bounds, sets and plans hold; the bounds do not meet",
    };
    Ok(verified(check(&joined, a, within), good.into()))
}

/// Distance within which two vertices count as one.
fn within(a: &FlexAnswer) -> Result<f64, Faults> {
    let file = Path::new(&a.source.file);
    Ok(match spec::parse(&a.source.text, file, Syntax::of(file, &a.source.text))?.subject {
        Subject::Meshes(m) => m.tolerance_mm / m.mm_per_unit,
        Subject::Woven(_) => SAME_VERTEX,
    })
}

fn check(joined: &Joined, a: &FlexAnswer, within: f64) -> Result<Proofs, String> {
    let mut proofs = Proofs::new();
    sealed(&a.checksum, &FlexAnswer { checksum: String::new(), ..a.clone() })?;
    same("verb", a.verb.as_str(), "flex")?;
    if a.clearance_mm > 0.0 && !a.cores.is_empty() {
        return Err("first-order cores say nothing of parts with clearance".into());
    }
    for core in &a.cores {
        let name = core.parts.join(", ");
        let shown = locked_alone(joined, &core.parts, &core.certificate)
            .and_then(|shown| {
                digits::holds(joined, &parts(joined, &core.parts)?, &core.certificate).map(|()| shown)
            })
            .map_err(|why| format!("core {name}: {why}"))?;
        proofs.insert(name, shown);
    }
    let cores: Vec<Set> = a.cores.iter().map(|c| set(joined, &c.parts)).collect::<Result<_, _>>()?;
    bound(&cores, a.lower_bound)?;
    for s in &a.symmetries {
        symmetry(&joined.assembly, s, within)?;
    }
    let planned = as_made(joined, a.clearance_mm)?;
    a.orbits.iter().try_for_each(|o| orbit(joined, &planned, &a.symmetries, o))?;
    claims(joined, a, &cores)?;
    Ok(proofs)
}

fn set(joined: &Joined, ids: &[String]) -> Result<Set, String> {
    let found: Set = parts(joined, ids)?.into_iter().collect();
    same("different parts of a set", ids.len(), found.len())?;
    Ok(found)
}

/// No set of fewer than `claimed` parts meets all cores.
fn bound(cores: &[Set], claimed: usize) -> Checked {
    let Some(less) = claimed.checked_sub(1) else { return Ok(()) };
    let mut found = BTreeSet::new();
    let whole = meeting(cores, less, &mut Set::new(), &mut found, &mut MOST_BRANCHES.clone(), true);
    match (found.first(), whole) {
        (Some(s), _) => Err(format!("{} parts meet all cores, fewer than the bound of {claimed}", s.len())),
        (None, true) => Ok(()),
        (None, false) => Err("the bound could not be found again: too many branches".into()),
    }
}

/// All sets of at most `size` parts that meet the cores (at least one minimal one of each); false when given up.
fn meeting(
    cores: &[Set],
    size: usize,
    chosen: &mut Set,
    found: &mut BTreeSet<Set>,
    left: &mut usize,
    one: bool,
) -> bool {
    if *left == 0 {
        return false;
    }
    *left -= 1;
    let open: Vec<&Set> = cores.iter().filter(|c| c.is_disjoint(chosen)).collect();
    let Some(first) = open.first() else {
        found.insert(chosen.clone());
        return true;
    };
    if disjoint(&open) + chosen.len() > size {
        return true;
    }
    for &p in first.iter() {
        if one && !found.is_empty() {
            return true;
        }
        chosen.insert(p);
        let whole = meeting(cores, size, chosen, found, left, one);
        chosen.remove(&p);
        if !whole {
            return false;
        }
    }
    true
}

/// How many of these, taken in order, share no part with those taken before: each needs a part of its own.
fn disjoint(sets: &[&Set]) -> usize {
    let mut taken = Set::new();
    let mut count = 0;
    for s in sets {
        if s.is_disjoint(&taken) {
            taken.extend(s.iter());
            count += 1;
        }
    }
    count
}

/// Each part's boundary vertices meet those of its image, and no two parts have one image.
fn symmetry(asm: &Assembly, s: &SymmetryOfParts, within: f64) -> Checked {
    same("images of a symmetry", s.to.len(), asm.parts.len())?;
    let rows = s.linear.map(DVec3::from_array);
    let linear = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
    let shift = DVec3::from_array(s.shift);
    let mut images = Set::new();
    for p in asm.ids() {
        let id = &s.to[p.at()];
        let q = asm.ids().find(|&q| asm.part(q).id == *id).ok_or(format!("no part is called `{id}`"))?;
        images.insert(q);
        same("mobility of an image", asm.part(p).mobility, asm.part(q).mobility)?;
        let (own, mut other) = (boundary(asm, p), boundary(asm, q));
        same("vertices of an image", own.len(), other.len())?;
        other.sort_by(|a, b| a.x.total_cmp(&b.x));
        let met = |x: DVec3| {
            let y = linear * x + shift;
            let from = other.partition_point(|v| v.x < y.x - within);
            other[from..].iter().take_while(|v| v.x <= y.x + within).any(|v| v.distance(y) <= within)
        };
        if !own.into_iter().all(met) {
            return Err(format!("a symmetry does not carry `{}` to `{id}`", asm.part(p).id));
        }
    }
    same("different images of a symmetry", images.len(), asm.parts.len())
}

fn boundary(asm: &Assembly, p: PartIx) -> Vec<DVec3> {
    let (solid, pose) = (asm.solid(p), asm.part(p).pose);
    let corners: BTreeSet<u32> = solid.facets.iter().flat_map(|f| f.corners.iter().copied()).collect();
    corners.into_iter().map(|k| pose.transform_point3(solid.vertices[k as usize])).collect()
}

/// The plan takes the rest apart, and the orbit is what the symmetries make of the set.
fn orbit(joined: &Joined, planned: &Assembly, symmetries: &[SymmetryOfParts], o: &OrbitAnswer) -> Checked {
    let asm = &joined.assembly;
    let flexible = set(joined, &o.set)?;
    let name = o.set.join(", ");
    let rest: Vec<PartIx> = asm.ids().filter(|p| !flexible.contains(p)).collect();
    same("outcome of a plan", o.plan.outcome, Outcome::Assembled)?;
    match plan::check_of(planned, &rest, &o.plan) {
        plan::Checked::Valid { .. } => {}
        plan::Checked::Invalid { step, why, .. } => {
            return Err(format!("without {name}: step {}: {why}", step + 1));
        }
        plan::Checked::Undecided { why } => return Err(format!("without {name}: {why}")),
    }
    let image = |s: &SymmetryOfParts| -> Result<Set, String> {
        set(joined, &flexible.iter().map(|p| s.to[p.at()].clone()).collect::<Vec<_>>())
    };
    let made: BTreeSet<Set> = symmetries.iter().map(image).collect::<Result<_, _>>()?;
    let told: BTreeSet<Set> = o.all.iter().map(|ids| set(joined, ids)).collect::<Result<_, _>>()?;
    if made != told {
        return Err(format!("the orbit of {name} is not what the symmetries make of it"));
    }
    Ok(())
}

/// What is said of bounds and sets follows from cores and orbits.
fn claims(joined: &Joined, a: &FlexAnswer, cores: &[Set]) -> Checked {
    let least = a.orbits.iter().map(|o| o.set.len()).min().ok_or("no set is shown to be enough")?;
    same("upper bound", a.upper_bound, least)?;
    same("minimum", a.minimum, (a.lower_bound == least).then_some(least))?;
    let told: BTreeSet<Set> = a.sets.iter().map(|ids| set(joined, ids)).collect::<Result<_, _>>()?;
    let smallest = a.orbits.iter().filter(|o| o.set.len() == least).flat_map(|o| &o.all);
    let shown: BTreeSet<Set> = smallest.map(|ids| set(joined, ids)).collect::<Result<_, _>>()?;
    if told != shown {
        return Err("the sets are not those of the orbits".into());
    }
    if !a.sets_complete {
        return Ok(());
    }
    let mut all = BTreeSet::new();
    let whole = meeting(cores, least, &mut Set::new(), &mut all, &mut MOST_BRANCHES.clone(), false);
    match (a.minimum, whole, all.iter().find(|s| !told.contains(*s))) {
        (None, ..) => Err("the sets are complete only where the bounds meet".into()),
        (_, false, _) => Err("that all sets are named could not be found again: too many branches".into()),
        (_, true, Some(_)) => Err("a set of this size meets all cores and is not named".into()),
        (_, true, None) => Ok(()),
    }
}
