//! Takes verdicts with their witnesses, gives the chapter that says them in words and numbers.
//!
//! Not promised: a word more than the verdict carries. First order and zero clearance are said wherever they matter.

use super::content::{Chapter, Column, Table, Tone};
use super::steps;
use crate::assembly::{Assembly, PartIx};
use crate::locking::{Check, Freedom, Motion, Stress, Twist, Verdict};
use crate::sequence::lattice::answer::{Counted, Word as Fewest};
use crate::sequence::{Outcome, Plan, Straight, Stuck};
use glam::DVec3;

/// Does it lock, and how do we know?
pub fn verdict(assembly: &Assembly, check: &Check) -> Chapter {
    let mut chapter = match &check.rigid {
        Verdict::Locked(stress) => locked(assembly, check, stress),
        Verdict::Free(motion) => free(assembly, motion),
        Verdict::Undecided(gap) => Chapter {
            tone: Tone::Undecided,
            headline: "Undecided: the numbers carry neither a lock nor a motion.".into(),
            facts: vec![fact("why", &gap.why), fact("gap", scientific(gap.size))],
            ..Chapter::default()
        },
    };
    chapter.facts.push(fact("translations alone", check.translation.word()));
    chapter.facts.push(fact("kept still", still(assembly, check)));
    let about = format!("{} parts, {} contact rows", assembly.parts.len(), thousands(check.rows));
    chapter.facts.push(fact("asked of", about));
    chapter
}

fn locked(assembly: &Assembly, check: &Check, stress: &Stress) -> Chapter {
    let kept = check.held.len() + usize::from(check.fixed.is_some());
    let unknowns = Freedom::Rigid.unknowns() * assembly.parts.len().saturating_sub(kept);
    if unknowns == 0 {
        return nothing_to_move();
    }
    let sizes = || stress.forces.iter().map(|f| f.size);
    let (least, most) = (sizes().fold(f64::INFINITY, f64::min), sizes().fold(0.0, f64::max));
    let forces = match stress.forces.len() {
        0 => "none".into(),
        n => format!("{} contact forces, all pushing, from {least:.3} to {most:.3}", thousands(n)),
    };
    Chapter {
        tone: Tone::Good,
        headline: "Locked: no part can start to move, alone or together with others.".into(),
        words: vec![
            "Proof: the contact forces below push at every contact they name and cancel on every part, and these \
             contacts have full rank. A motion would have to open one of them, which the balance forbids, or slide \
             along all of them, which the rank forbids."
                .into(),
            "This holds to first order and at zero clearance: parts made with clearance have play.".into(),
        ],
        facts: vec![
            fact("self-stress", forces),
            fact("rank", format!("{} of {unknowns}", stress.rank)),
            fact("left unbalanced", format!("{} at most (round-off)", scientific(stress.residual))),
            fact("rank's distance from falling", format!("{} (smallest pivot over largest)", scientific(stress.pivot_ratio))),
        ],
        ..Chapter::default()
    }
}

/// True by the letter, and of no worth: it must not be read as a lock that was found.
fn nothing_to_move() -> Chapter {
    Chapter {
        tone: Tone::Plain,
        headline: "Locked only because nothing may move: every part is kept still.".into(),
        words: vec!["No contact was asked. Add parts, or hold fewer of them.".into()],
        ..Chapter::default()
    }
}

fn free(assembly: &Assembly, motion: &Motion) -> Chapter {
    let moving = movers(motion);
    let further = motion.twists.len() - moving.len();
    let how = if motion.opening > 0.0 {
        "At least one contact opens on the way; none is pressed."
    } else {
        "Every contact only slides; none opens, none is pressed."
    };
    let axes = ["shift x", "shift y", "shift z", "turn x", "turn y", "turn z"];
    let rows = moving.iter().map(|(p, t)| {
        let numbers = [t.translation, t.rotation].map(|v| v.to_array().map(decimal));
        std::iter::once(id(assembly, *p)).chain(numbers.concat()).collect()
    });
    let mut words =
        vec![how.into(), "To first order: whether it comes apart is the plan's answer, not this one.".into()];
    if further > 0 {
        words.push(format!("The witness names {further} more parts, which move by too little to print."));
    }
    Chapter {
        tone: Tone::Bad,
        headline: format!("Free: {} can start to move.", parts(moving.len())),
        words,
        facts: vec![
            fact("fastest opening", format!("{:.4}", motion.opening)),
            fact("worst contact", format!("{} (below 0 by round-off only)", scientific(motion.worst))),
        ],
        tables: vec![Table {
            caption: "Velocity of each part that moves: shift of its reference point, turn about it".into(),
            head: std::iter::once(Column::words("part")).chain(axes.map(Column::numbers)).collect(),
            rows: rows.collect(),
        }],
        ..Chapter::default()
    }
}

/// How does it go together? Steps are told in the order of assembly.
pub fn plan<C>(assembly: &Assembly, plan: &Plan<C>) -> Chapter {
    let searched = [plan.searched.sets, plan.searched.directions, plan.searched.states].map(thousands);
    let touch = format!("overlap up to {} mm", scientific(plan.touch * assembly.mm_per_unit));
    let looked =
        format!("{} sets, {} directions, {} poses on the way", searched[0], searched[1], searched[2]);
    let mut facts: Vec<(String, String)> = plan.counted.iter().flat_map(counted).collect();
    facts.extend([fact("searched", looked), fact("counts as touching", touch)]);
    let steps = (!plan.steps.is_empty()).then(|| steps::table(assembly, plan));
    let tables = steps.into_iter().chain(steps::reached(plan)).collect();
    let mut chapter = Chapter { facts, tables, ..outcome(plan) };
    chapter.words.extend(steps::gives(plan));
    chapter
}

/// How many moves along the axes, as puzzlers count them.
fn counted(c: &Counted) -> Vec<(String, String)> {
    let fewest = match c.fewest {
        Fewest::Proven => "the fewest for each set from where it stands: proven by search",
        Fewest::NotProven => "not proven to be the fewest",
    };
    let level = c.level.iter().map(|level| fact("level", format!("{level} ({fewest})")));
    let kept = c.kept.iter().map(|k| {
        let looked = match k.within_moves {
            None => {
                "every position that moves along the axes reach was looked at, none lets parts leave".into()
            }
            Some(moves) if k.looked_at == "stopped" => {
                format!("stopped by the user after looking at all positions within {moves} moves")
            }
            Some(moves) => format!("the search gave up after looking at all positions within {moves} moves"),
        };
        fact("stay together", format!("{}: {looked}", k.parts.join(", ")))
    });
    let together =
        c.together.iter().map(|set| fact("one group", format!("{}: need not be parted", set.join(", "))));
    let positions = fact("positions", thousands(c.positions));
    level.chain([fact("moves", c.moves.to_string())]).chain(together).chain(kept).chain([positions]).collect()
}

/// The headline of a plan, and why there is none.
fn outcome<C>(plan: &Plan<C>) -> Chapter {
    let stuck = sets(plan, |_| true);
    let (tone, headline, why) = match plan.outcome {
        Outcome::Assembled => {
            let moves = if plan.steps.is_empty() { "nothing to move".into() } else { steps::count(plan) };
            (Tone::Good, format!("It goes together without force: {moves}."), None)
        }
        Outcome::NeedsFlexible => (
            Tone::Bad,
            "Not from rigid parts: something must bend.".into(),
            Some(format!(
                "Locked by themselves: {}. No motion can start there, so no order of rigid moves takes these parts \
                 apart or puts them together at zero clearance.",
                sets(plan, |s| s.lock.is_some())
            )),
        ),
        Outcome::NotFound => {
            let searched = plan.searched.states + plan.searched.programs > 0;
            let excluded = plan.stuck.iter().all(|s| s.straight_moves == Straight::None);
            let why = if plan.stopped {
                "Stopped by the user before the search was done."
            } else if plan.counted.is_some() {
                "What was looked at on their lattice is told below; turns are not excluded."
            } else if searched {
                "Looked at were single straight moves, straight moves that stop half way, turns and joint motions, until \
                 the counted work was used up; how far each part got is told below."
            } else if excluded {
                "No group of them can leave by one straight move. None was found to begin a turn or a move that stops half \
                 way: in large sets only single parts, and parts with all that they touch, are asked."
            } else {
                "The search gave up before every straight move was excluded."
            };
            (
                Tone::Undecided,
                "No plan found, and none excluded.".into(),
                Some(format!("Stuck: {stuck}. {why}")),
            )
        }
    };
    Chapter { tone, headline, words: why.into_iter().collect(), ..Chapter::default() }
}

/// The sets that stayed together, of those that `keep` picks.
fn sets<C>(plan: &Plan<C>, keep: impl Fn(&Stuck<C>) -> bool) -> String {
    plan.stuck.iter().filter(|s| keep(s)).map(|s| s.parts.join(", ")).collect::<Vec<_>>().join("; and ")
}

fn still(assembly: &Assembly, check: &Check) -> String {
    match check.fixed {
        Some(p) => format!(
            "{}, as the place to look from (nothing is held; the verdict is the same for any part)",
            id(assembly, p)
        ),
        None => {
            format!("{} (held)", check.held.iter().map(|&p| id(assembly, p)).collect::<Vec<_>>().join(", "))
        }
    }
}

fn id(assembly: &Assembly, p: PartIx) -> String {
    assembly.part(p).id.clone()
}

fn fact(name: &str, value: impl Into<String>) -> (String, String) {
    (name.into(), value.into())
}

fn parts(n: usize) -> String {
    if n == 1 { "one part".into() } else { format!("{n} parts together") }
}

/// Digits after the point of a velocity, and the least one that they show.
const PLACES: usize = 3;
const LEAST_PRINTED: f64 = 0.5e-3;

/// The twists of a motion that are not zero as printed.
pub(in crate::report) fn movers(motion: &Motion) -> Vec<(PartIx, Twist)> {
    let shown = |v: DVec3| v.abs().max_element() >= LEAST_PRINTED;
    motion.twists.iter().filter(|(_, t)| shown(t.translation) || shown(t.rotation)).copied().collect()
}

pub(super) fn decimal(x: f64) -> String {
    let text = format!("{x:.PLACES$}");
    // A minus zero would be read as a direction.
    if x.abs() < LEAST_PRINTED { text.trim_start_matches('-').into() } else { text }
}

/// Two digits and a power of ten, as in 3.1e-13.
pub fn scientific(x: f64) -> String {
    format!("{x:.1e}")
}

/// A count with its thousands apart.
pub fn thousands(n: usize) -> String {
    let digits = n.to_string();
    let head = (digits.len() - 1) % 3 + 1;
    let groups = digits.as_bytes()[head..].chunks(3).map(|g| String::from_utf8_lossy(g));
    std::iter::once(digits[..head].into()).chain(groups).collect::<Vec<_>>().join(",")
}
