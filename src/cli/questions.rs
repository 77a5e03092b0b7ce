//! Takes an assembly or a weave; asks one question of the analysis and tells the answer.
//!
//! Not promised: anything beyond what the stage that answers promises.

use super::load::{self, Placed};
use super::preferred;
use super::puzzle;
use super::told::{News, Told, Trouble};
use super::words;
use crate::assembly::PartIx;
use crate::contact::Joined;
use crate::cores::{self, Contacts, Firm, Guard};
use crate::fault::Fault;
use crate::input;
use crate::report::answer::{self, Certificate, PlanAnswer, Sealed};
use crate::report::file::write_whole;
use crate::report::words as chapters;
use crate::sequence::clearance::with_clearance;
use crate::sequence::{self, Ends, Motions, Outcome, Plan, Searched};
use crate::verify;
use crate::weave::{self, Weave};
use std::collections::BTreeSet;
use std::path::Path;

pub fn part(joined: &Joined, id: &str) -> Result<PartIx, Trouble> {
    let asm = &joined.assembly;
    let all = || asm.parts.iter().map(|p| p.id.as_str()).take(12).collect::<Vec<_>>().join(", ");
    asm.ids().find(|&p| asm.part(p).id == id).ok_or_else(|| {
        argument(format!("no part is called `{id}`"), format!("the parts are {}", all())).into()
    })
}

/// What is wrong with an argument.
pub fn argument(what: String, hint: String) -> Fault {
    Fault { file: String::new(), place: None, key: String::new(), what, hint }
}

/// The plan for these parts, made with `clearance_mm` of air on each face of a contact. At no clearance each set that
/// stays together comes with the proof of its lock, where it is locked.
pub fn planned(placed: &Placed, of: &[PartIx], clearance_mm: f64) -> PlanAnswer {
    planned_by(placed, of, clearance_mm, Motions::Any)
}

/// The same by these motions.
pub fn planned_by(placed: &Placed, of: &[PartIx], clearance_mm: f64, motions: Motions) -> PlanAnswer {
    let (joined, watch) = (&placed.joined, &placed.watch);
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let found = puzzle::plan(placed, of, clearance_mm, || {
        if clearance_mm > 0.0 {
            let made =
                with_clearance(asm, patches, clearance_mm / asm.mm_per_unit).map_err(|e| e.to_string())?;
            sequence::plan_watched(&made, of, &[], motions, watch, |_| None).map_err(|e| e.to_string())
        } else {
            sequence::plan_watched(asm, of, patches, motions, watch, |set| locked(joined, set))
                .map_err(|e| e.to_string())
        }
    });
    let (plan, why) = found.map_or_else(|why| (nothing(), Some(why)), |plan| (plan, None));
    let stopped = plan.stopped.then(|| stopped(&plan));
    let remarks = stopped.or(why.map(|why| format!("no plan was searched: {why}")));
    let touching = clearance_mm == 0.0 && !plan.stopped;
    let remarks = remarks.or_else(|| doubtful(joined, &plan).filter(|_| touching));
    let remarks = remarks.or_else(|| cored(joined, &plan).filter(|_| touching));
    answer::plan(joined, plan, of, clearance_mm, remarks, placed.source.clone())
}

/// What to say of a search that the user stopped: counted, since a time would say nothing on another machine.
fn stopped(plan: &Plan<Certificate>) -> String {
    let s = plan.searched;
    let after = match &plan.counted {
        Some(c) => format!("{} positions", c.positions),
        None => format!("{} directions in {} sets and {} poses", s.directions, s.sets, s.states),
    };
    format!(
        "stopped by the user after {after}: what is told is what was found until then, and proves nothing of the rest"
    )
}

/// What to say of sets that stayed together and are locked as written, but not shown to be within the files' digits.
fn doubtful(joined: &Joined, plan: &Plan<Certificate>) -> Option<String> {
    if joined.slack.is_empty() || plan.stopped {
        return None;
    }
    let contacts = Contacts::new(joined.touching());
    let named = |ids: &[String]| {
        joined.assembly.ids().filter(|&p| ids.contains(&joined.assembly.part(p).id)).collect()
    };
    let open = plan.stuck.iter().filter(|s| s.lock.is_none());
    let written: Vec<String> = open
        .filter(|s| cores::locked(&contacts, &named(&s.parts)).is_some())
        .map(|s| s.parts.iter().take(MOST_NAMED).map(String::as_str).collect::<Vec<_>>().join(", "))
        .collect();
    (!written.is_empty()).then(|| {
        format!(
            "locked as written, but not shown to be whatever the files' digits leave open of their contacts, so no proof: {}",
            written.join("; ")
        )
    })
}

/// What to say of locked cores in sets that are not locked as a whole: of parts that no step has taken from their places.
fn cored(joined: &Joined, plan: &Plan<Certificate>) -> Option<String> {
    let asm = &joined.assembly;
    let moved: BTreeSet<&String> =
        plan.steps.iter().filter(|s| s.ends == Ends::Inside).flat_map(|s| &s.parts).collect();
    let contacts = Contacts::new(joined.touching());
    let at_home = |ids: &[String]| {
        let own = |p: &PartIx| ids.contains(&asm.part(*p).id) && !moved.contains(&asm.part(*p).id);
        asm.ids().filter(own).collect()
    };
    let open = plan.stuck.iter().filter(|s| s.lock.is_none());
    let cores = open.flat_map(|s| cores::largest(&contacts, &at_home(&s.parts), Guard::With).largest);
    let firm = cores.filter(|c| c.firm == Firm::Holds);
    let named: Vec<String> = firm
        .map(|c| c.parts.iter().map(|&p| asm.part(p).id.as_str()).collect::<Vec<_>>().join(", "))
        .collect();
    (!named.is_empty()).then(|| {
        format!(
            "locked among themselves, so no order of rigid moves takes these apart at zero clearance (`check` proves it \
             as cores): {}",
            named.join("; and ")
        )
    })
}

/// Parts of a set that are named in a remark.
const MOST_NAMED: usize = 8;

/// The plan of a search that was not made: not found, an honest answer with its reason among the remarks.
fn nothing() -> Plan<Certificate> {
    Plan {
        outcome: Outcome::NotFound,
        order: sequence::Order::Disassembly,
        steps: Vec::new(),
        stuck: Vec::new(),
        searched: Searched::default(),
        touch: 0.0,
        counted: None,
        stopped: false,
    }
}

/// The proof that a set that stayed together is locked, where it holds whatever the files' digits leave open.
pub fn locked(joined: &Joined, set: &[PartIx]) -> Option<Certificate> {
    let contacts = Contacts::new(joined.touching());
    let core = cores::locked(&contacts, &set.iter().copied().collect())?;
    let core = cores::firm(&contacts, core).filter(|c| c.firm == Firm::Holds)?;
    let still: Vec<PartIx> = core.still.iter().copied().collect();
    Some(answer::certificate(&joined.assembly, &still, &core.stress))
}

pub fn plan(
    placed: &Placed,
    of: &[String],
    clearance_mm: f64,
    wanted: &preferred::Asked,
) -> Result<Told, Trouble> {
    let joined = &placed.joined;
    let mut parts = of.iter().map(|id| part(joined, id.trim())).collect::<Result<Vec<_>, _>>()?;
    if parts.is_empty() {
        parts = joined.assembly.ids().collect();
    }
    parts.sort_unstable();
    parts.dedup();
    Ok(told_plan(placed, &preferred::applied(placed, planned(placed, &parts, clearance_mm), wanted)?))
}

pub fn told_plan(placed: &Placed, answer: &PlanAnswer) -> Told {
    let news = News::of(answer.plan.outcome == Outcome::Assembled);
    let mut chapter = chapters::plan(&placed.joined.assembly, &answer.plan);
    chapter
        .facts
        .insert(0, ("clearance".into(), format!("{} mm on each face of a contact", answer.clearance_mm)));
    answer.preferences.iter().for_each(|p| preferred::tell(&mut chapter, p));
    Told {
        remarks: answer.remarks.clone(),
        ..Told::new(news, answer, &answer.name, "How it goes together", chapter)
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
        let hint =
            "give the JSON that `weavelock` printed with --json for `check`, `plan`, `repeats` or `flex`"
                .to_string();
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
