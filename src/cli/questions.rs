//! Takes an assembly or a weave; asks one question of the analysis and tells the answer.
//!
//! Not promised: anything beyond what the stage that answers promises.

use super::args::{Common, Repeats};
use super::interlock::told as told_interlock;
use super::load::{self, Placed};
use super::told::{News, Told, Trouble};
use super::words;
use crate::assembly::PartIx;
use crate::atlas::{self, Ask};
use crate::chirality::{
    self,
    answer::{Handedness, Hands, WarpIs},
};
use crate::contact::Joined;
use crate::fault::Fault;
use crate::flex as flexible;
use crate::input;
use crate::interlock;
use crate::locking::{self, Check, Verdict};
use crate::repeats::{self, Search};
use crate::report::answer::{self, Certificate, FlexAnswer, PlanAnswer, RepeatsAnswer, Sealed};
use crate::report::file::write_whole;
use crate::report::words as chapters;
use crate::sequence::clearance::with_clearance;
use crate::sequence::{self, Outcome, Plan, Searched};
use crate::spec::{self, Bounds, ProfileSpec, Shape};
use crate::verify;
use crate::weave::{self, Weave};
use serde::Serialize;
use std::path::{Path, PathBuf};

pub fn check(placed: &Placed, fix: Option<&str>) -> Result<Told, Trouble> {
    let joined = &placed.joined;
    let fix = fix.map(|id| part(joined, id)).transpose()?;
    let check = locking::check(&joined.assembly, &joined.patches, fix);
    Ok(told_check(placed, &check))
}

pub fn told_check(placed: &Placed, check: &Check) -> Told {
    let asm = &placed.joined.assembly;
    let found = interlock::interlock(asm, &placed.joined.patches, check);
    let interlock = answer::interlock(asm, check, &found);
    let answer = answer::check(&placed.joined, check, placed.source.clone());
    let answer = answer::with_interlock(answer, interlock);
    let news = News::of(matches!(check.rigid, Verdict::Locked(_)));
    let mut chapter = chapters::verdict(&placed.joined.assembly, check);
    chapter.facts.extend(answer.interlock.iter().flat_map(told_interlock));
    Told {
        remarks: answer.remarks.clone(),
        ..Told::new(news, &answer, &answer.name, "Does it lock?", chapter)
    }
}

fn part(joined: &Joined, id: &str) -> Result<PartIx, Trouble> {
    let asm = &joined.assembly;
    let all = || asm.parts.iter().map(|p| p.id.as_str()).take(12).collect::<Vec<_>>().join(", ");
    asm.ids().find(|&p| asm.part(p).id == id).ok_or_else(|| {
        argument(format!("no part is called `{id}`"), format!("the parts are {}", all())).into()
    })
}

/// What is wrong with an argument.
fn argument(what: String, hint: String) -> Fault {
    Fault { file: String::new(), place: None, key: String::new(), what, hint }
}

/// The plan for these parts, made with `clearance_mm` of air on each face of a contact. At no clearance each set that
/// stays together comes with the proof of its lock, where it is locked.
pub fn planned(placed: &Placed, of: &[PartIx], clearance_mm: f64) -> PlanAnswer {
    let joined = &placed.joined;
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let found = if clearance_mm > 0.0 {
        with_clearance(asm, patches, clearance_mm / asm.mm_per_unit)
            .map_err(|e| e.to_string())
            .and_then(|made| sequence::plan_of(&made, of, &[], |_| None).map_err(|e| e.to_string()))
    } else {
        sequence::plan_of(asm, of, patches, |set| locked(joined, set)).map_err(|e| e.to_string())
    };
    let (plan, why) = found.map_or_else(|why| (nothing(), Some(why)), |plan| (plan, None));
    let remarks = why.map(|why| format!("no plan was searched: {why}"));
    answer::plan(joined, plan, of, clearance_mm, remarks, placed.source.clone())
}

/// The plan of a search that was not made: not found, an honest answer with its reason among the remarks.
fn nothing() -> Plan<Certificate> {
    Plan {
        outcome: Outcome::NotFound,
        order: sequence::Order::Disassembly,
        steps: Vec::new(),
        stuck: Vec::new(),
        searched: Searched::default(),
        touch: 0.0,
    }
}

fn locked(joined: &Joined, set: &[PartIx]) -> Option<Certificate> {
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let Verdict::Locked(stress) = locking::check_some(asm, patches, set) else { return None };
    let held: Vec<PartIx> = asm.held().filter(|p| set.contains(p)).collect();
    let still = if held.is_empty() { set[..1].to_vec() } else { held };
    Some(answer::certificate(asm, &still, &stress))
}

pub fn plan(placed: &Placed, of: &[String], clearance_mm: f64) -> Result<Told, Trouble> {
    let joined = &placed.joined;
    let mut parts = of.iter().map(|id| part(joined, id.trim())).collect::<Result<Vec<_>, _>>()?;
    if parts.is_empty() {
        parts = joined.assembly.ids().collect();
    }
    parts.sort_unstable();
    parts.dedup();
    Ok(told_plan(placed, &planned(placed, &parts, clearance_mm)))
}

pub fn told_plan(placed: &Placed, answer: &PlanAnswer) -> Told {
    let news = News::of(answer.plan.outcome == Outcome::Assembled);
    let mut chapter = chapters::plan(&placed.joined.assembly, &answer.plan);
    chapter
        .facts
        .insert(0, ("clearance".into(), format!("{} mm on each face of a contact", answer.clearance_mm)));
    Told {
        remarks: answer.remarks.clone(),
        ..Told::new(news, answer, &answer.name, "How it goes together", chapter)
    }
}

pub fn flexed(placed: &Placed) -> Result<FlexAnswer, Trouble> {
    let found = flexible::flex(&placed.joined.assembly, &placed.joined.patches);
    let found = found.map_err(|why| Trouble::Word(format!("error: not searched: {why}\n  hint: flexible parts are found by plans, and plans need parts made of convex cells")))?;
    Ok(answer::flex(&placed.joined, &found, placed.source.clone()))
}

pub fn flex(placed: &Placed) -> Result<Told, Trouble> {
    Ok(told_flex(&flexed(placed)?))
}

pub fn told_flex(answer: &FlexAnswer) -> Told {
    let news = News::of(answer.minimum.is_some());
    let chapter = words::flex(answer);
    Told {
        remarks: answer.remarks.clone(),
        ..Told::new(news, answer, &answer.name, "Flexible parts", chapter)
    }
}

pub fn repeats(asked: &Repeats) -> Result<Told, Trouble> {
    let weave = load::weave(&asked.weave)?;
    let profile = profile(asked)?;
    let search = Search {
        wefts: asked.wefts.unwrap_or(weave.tile.0),
        warps: asked.warps.unwrap_or(weave.tile.0),
        phases: asked.phase.clone(),
        most: asked.most,
    };
    Ok(told_repeats(&repeated(&weave, &asked.weave, &profile, &search)?))
}

pub fn repeated(
    weave: &Weave,
    name: &str,
    profile: &ProfileSpec,
    search: &Search,
) -> Result<RepeatsAnswer, Trouble> {
    let found = repeats::repeats(weave, profile, search)?;
    Ok(answer::repeats(name, &found, load::falls_apart(weave).into_iter().collect()))
}

pub fn told_repeats(answer: &RepeatsAnswer) -> Told {
    let news = News::of(answer.minimal_repeat.is_some());
    let chapter = words::repeats(answer);
    Told { remarks: answer.remarks.clone(), ..Told::new(news, answer, &answer.weave, "Repetition", chapter) }
}

/// The profile of the flags, held to the same bounds as a spec's.
fn profile(asked: &Repeats) -> Result<ProfileSpec, Trouble> {
    let Repeats { rise, lift, cover, samples, .. } = *asked;
    let text = format!(
        "[weave]\nabc = [1, 1, 1]\n[profile]\nrise = {rise:?}\nlift = {lift:?}\ncover = {cover:?}\nsamples = {samples}\n[swatch]\nwefts = 2\nwarps = 2\ncut = \"window\"\n[size]\npitch = \"1 mm\"\n"
    );
    let spec = spec::parse(&text, Path::new("(flags)"), spec::Syntax::Toml)?;
    match spec.subject {
        spec::Subject::Woven(woven) => Ok(woven.profile),
        spec::Subject::Meshes(_) => {
            Ok(ProfileSpec { shape: Shape::Rise(rise), lift, cover, samples, bounds: Bounds::Sandwich })
        }
    }
}

pub fn weave(subject: &str, svg: Option<&Path>, wif: Option<&Path>) -> Result<Told, Trouble> {
    let weave = load::weave(subject)?;
    if let Some(path) = svg {
        write_whole(path, weave::svg(&weave.draft).as_bytes())?;
    }
    if let Some(path) = wif {
        write_whole(path, weave::to_wif(&weave.draft, subject).as_bytes())?;
    }
    Ok(told_weave(&weave, subject))
}

/// Columns that a draft may fill: those of the terminal summary less its indent.
const FIGURE_WIDTH: usize = 96;

pub fn told_weave(weave: &Weave, name: &str) -> Told {
    let answer = answer::weave(weave);
    let chapter = words::weave(&answer, weave::terminal(&weave.draft, FIGURE_WIDTH));
    Told::new(News::of(answer.hangs_together), &answer, name, "The weave", chapter)
}

pub fn verify(file: &Path) -> Result<Told, Trouble> {
    let text = input::text(input::answer_bytes(file)?, file)?;
    let sealed: Sealed = serde_json::from_str(&text).map_err(|e| {
        let hint = "give the JSON that `weavelock check --json` or `plan --json` printed".to_string();
        Fault {
            file: file.display().to_string(),
            place: None,
            key: String::new(),
            what: format!("this is no answer that can be verified: {e}"),
            hint,
        }
    })?;
    let verified = verify::answer(&sealed)?;
    let chapter = words::verified(&verified);
    Ok(Told::new(News::of(verified.valid), &verified, &file.display().to_string(), "Verify", chapter))
}

pub fn chirality(subject: &str) -> Result<Told, Trouble> {
    let path = Path::new(subject);
    if load::is_spec(path) {
        return told_chirality(&load::spec(path)?.joined()?);
    }
    let weave = load::weave(subject)?;
    let remarks = load::falls_apart(&weave);
    let hands = chirality::of_weave(&weave, &atlas::Settings::default().profile()).map_err(hands_fault)?;
    let mut told = told_hands(&Hands { name: subject.into(), ..hands });
    told.remarks.extend(remarks);
    Ok(told)
}

pub fn told_chirality(placed: &Placed) -> Result<Told, Trouble> {
    let hands = chirality::of_assembly(&placed.spec, &placed.joined).map_err(hands_fault)?;
    Ok(told_hands(&hands))
}

fn hands_fault(e: chirality::HandsError) -> Trouble {
    argument(e.to_string(), "change rise, lift, cover or samples".into()).into()
}

fn told_hands(hands: &Hands) -> Told {
    let undecided = [hands.tile, hands.assembly].contains(&Some(Handedness::Undecided));
    let news = News::of(!undecided && hands.warp_is != Some(WarpIs::Undecided));
    Told {
        remarks: hands.remarks.clone(),
        ..Told::new(news, hands, &hands.name, "Hands", words::hands(hands))
    }
}

pub fn atlas(max_n: u32, out: &Path, common: &Common) -> Result<Told, Trouble> {
    let ask = Ask::new(max_n);
    let all = atlas::weaves(max_n).len();
    let written = atlas::write(&ask, out, |row| {
        if !common.quiet {
            eprintln!("[{},{},{}] of {all} weaves", row.a, row.b, row.c);
        }
    })?;
    let answer = AtlasAnswer { verb: "atlas", rows: &written.rows, files: &written.files };
    Ok(Told::new(News::Good, &answer, &format!("weaves up to n = {max_n}"), "Atlas", words::atlas(&written)))
}

#[derive(Serialize)]
struct AtlasAnswer<'a> {
    verb: &'static str,
    rows: &'a [atlas::Row],
    files: &'a [PathBuf],
}
