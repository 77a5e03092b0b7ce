//! Takes an answer of `repeats`; says whether it holds: each row's proof against contacts built again from its spec, and
//! the least k against the rows.
//!
//! Not promised: that the swatches are the ones a reader would choose; each row names its own.

use super::certificate::{self, About, Shown};
use super::{Proofs, Verified, as_made, plan, rebuild, same, sealed, verified};
use crate::assembly::PartIx;
use crate::assembly::layout::pieces;
use crate::fault::Faults;
use crate::repeats::FILE;
use crate::report::answer::repeats::{CaseAnswer, ClassAnswer, ProfileAnswer, RepeatsAnswer, RepeatsRow};
use crate::report::answer::{Source, Word};
use crate::sequence::Outcome;
use crate::spec::{self, Cut, HeldSpec, Layout, Shape, Subject, Syntax, WovenSpec};
use crate::tile::Piece;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::path::Path;

type Checked = Result<(), String>;

/// A row by its name, with what its proof was found true for.
type Told = Result<(String, Shown), String>;

pub fn answer(a: &RepeatsAnswer) -> Result<Verified, Faults> {
    let rows: Vec<&RepeatsRow> = a.table.iter().chain(a.every_size.iter().map(|c| &c.base)).collect();
    let woven: Vec<WovenSpec> = rows.par_iter().map(|r| woven(r)).collect::<Result<_, _>>()?;
    let each: Result<Vec<Told>, Faults> =
        rows.par_iter().zip(&woven).enumerate().map(|(at, (r, w))| row(at, r, w)).collect();
    let each = each?;
    let found = sealed(&a.checksum, &RepeatsAnswer { checksum: String::new(), ..a.clone() })
        .and_then(|()| same("verb", a.verb.as_str(), "repeats"))
        .and_then(|()| one_weave(&woven))
        .and_then(|()| claims(a))
        .and_then(|()| a.every_size.iter().zip(&woven[a.table.len()..]).try_for_each(|(c, w)| class(c, w)))
        .and_then(|()| each.into_iter().collect::<Result<Proofs, String>>());
    let good = format!("the proofs of {} swatches hold, and the least k follows from them", rows.len());
    Ok(verified(found, good))
}

fn woven(r: &RepeatsRow) -> Result<WovenSpec, Faults> {
    let file = Path::new(FILE);
    let spec = spec::parse(&r.spec, file, Syntax::Toml)?;
    let fault = spec.fault("", "the spec of a row is no woven swatch", "give the answer as it was printed");
    match spec.subject {
        Subject::Woven(w) => Ok(w),
        Subject::Meshes(_) => Err(fault.into()),
    }
}

fn one_weave(all: &[WovenSpec]) -> Checked {
    match all.windows(2).all(|w| w[0].weave.draft == w[1].weave.draft) {
        true => Ok(()),
        false => Err("the rows are about different weaves".into()),
    }
}

/// The row says what its spec says, and its proof and plan hold.
fn row(at: usize, r: &RepeatsRow, w: &WovenSpec) -> Result<Told, Faults> {
    let joined = rebuild(&Source { file: FILE.into(), text: r.spec.clone() })?;
    let name = format!("row {at}: k = {}, phase {}, {} x {}", r.k, r.phase, r.swatch.wefts, r.swatch.warps);
    let asm = &joined.assembly;
    let still: Vec<String> = asm.parts.iter().take(1).map(|p| p.id.clone()).collect();
    let checked = (|| -> Result<Shown, String> {
        let (wefts, warps) = (r.swatch.wefts, r.swatch.warps);
        let layout = Layout::Swatch { wefts, warps, cut: Cut::Tiles, repeat: r.k, phase: r.phase };
        same("swatch", &w.layout, &layout)?;
        same("held", &w.held, &HeldSpec::None)?;
        same("profile", &r.profile, &profile(w))?;
        same("parts", r.parts, asm.parts.len())?;
        same("rigid", r.rigid, r.proof.verdict)?;
        let shown = certificate::proof(asm, &joined.patches, &r.proof, &still, About::RigidMotions)?;
        let Some(made) = &r.as_made else { return Ok(shown) };
        match (made.verdict.as_str(), &made.plan) {
            ("not-found", None) => Ok(shown),
            ("comes-apart", Some(p)) => {
                same("outcome of a plan", p.outcome, Outcome::Assembled)?;
                let all: Vec<PartIx> = asm.ids().collect();
                match plan::check_of(&as_made(&joined, made.clearance_mm)?, &all, p) {
                    plan::Checked::Valid { .. } => Ok(shown),
                    plan::Checked::Invalid { step, why, .. } => Err(format!("step {}: {why}", step + 1)),
                    plan::Checked::Undecided { why } => Err(why),
                }
            }
            _ => Err("what is said of the parts as made does not come with what belongs to it".into()),
        }
    })();
    Ok(match checked {
        Ok(shown) => Ok((name, shown)),
        Err(why) => Err(format!("{name}: {why}")),
    })
}

fn profile(w: &WovenSpec) -> ProfileAnswer {
    let rise = match w.profile.shape {
        Shape::Rise(rise) => Some(rise),
        Shape::Points(_) => None,
    };
    ProfileAnswer { rise, lift: w.profile.lift, cover: w.profile.cover, samples: w.profile.samples }
}

/// The least k of each case and of all follows from the rows: locked there, free at some phase at every smaller k.
fn claims(a: &RepeatsAnswer) -> Checked {
    for c in &a.cases {
        same("least k of a case", c.minimal_repeat, least(a, c))?;
    }
    let cases: Option<Vec<u32>> = a.cases.iter().map(|c| c.minimal_repeat).collect();
    let most = cases.and_then(|c| c.into_iter().max());
    let all = most.filter(|&k| a.cases.iter().all(|c| locked(a, c, k)));
    same("least k", a.minimal_repeat, all.filter(|_| !a.stopped))
}

fn least(a: &RepeatsAnswer, c: &CaseAnswer) -> Option<u32> {
    let k = (1..=c.searched).find(|&k| locked(a, c, k))?;
    let free = |r: &RepeatsRow, j: u32| {
        (r.k, r.swatch) == (j, c.swatch) && r.profile == c.profile && r.rigid == Word::Free
    };
    (1..k).all(|j| a.table.iter().any(|r| free(r, j))).then_some(k)
}

/// Every phase of the case has a locked row at this k.
fn locked(a: &RepeatsAnswer, c: &CaseAnswer, k: u32) -> bool {
    let is = |r: &RepeatsRow, phase: i32| {
        (r.k, r.phase, r.swatch) == (k, phase, c.swatch)
            && r.profile == c.profile
            && r.rigid == Word::Locked
            && r.as_made.is_none()
    };
    !c.phases.is_empty() && c.phases.iter().all(|&p| a.table.iter().any(|r| is(r, p)))
}

/// The swatch grown by whole pieces is made of translates of itself that share a part, both ways.
fn class(c: &ClassAnswer, w: &WovenSpec) -> Checked {
    let (k, tile) = (c.base.k, w.weave.tile);
    same("step of a class", c.step, [k * tile.1, k * tile.0])?;
    let size = [c.base.swatch.wefts, c.base.swatch.warps];
    if (0..2).any(|d| size[d] <= c.step[d] || size[d] > 2 * c.step[d]) {
        return Err("the smallest swatch of a class is longer than a piece, and no longer than two".into());
    }
    if c.holds != "locked" {
        return Ok(());
    }
    same("verdict of a class", c.base.rigid, Word::Locked)?;
    let of = |wefts: u32, warps: u32| -> BTreeSet<Piece> {
        let layout = Layout::Swatch { wefts, warps, cut: Cut::Tiles, repeat: k, phase: c.base.phase };
        pieces(&WovenSpec { layout, ..w.clone() }).into_iter().collect()
    };
    let [h, v] = [size[1] + c.step[1], size[0] + c.step[0]];
    let (right, up) = ((c.step[1] as i32, 0), (0, c.step[0] as i32));
    let grown = [
        (of(size[0], size[1]), of(size[0], h), right),
        (of(size[0], size[1]), of(v, size[1]), up),
        (of(v, size[1]), of(v, h), right),
    ];
    for (small, large, by) in grown {
        let moved: BTreeSet<Piece> = small.iter().map(|p| p.moved(by)).collect();
        if small.is_disjoint(&moved) || small.union(&moved).copied().collect::<BTreeSet<_>>() != large {
            return Err("a class grows by no translate that shares a part".into());
        }
    }
    Ok(())
}
