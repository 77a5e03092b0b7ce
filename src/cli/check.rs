//! Takes an assembly in place; asks whether it locks, how firmly, and with more samples where that is asked for.
//!
//! Not promised: any finding of its own; `locking` and `sampling` find.

use super::interlock::told as told_interlock;
use super::load::Placed;
use super::questions;
use super::told::{News, Told, Trouble};
use crate::interlock;
use crate::locking::{Check, Verdict};
use crate::report::answer::{self, CheckAnswer};
use crate::report::content::{Chapter, Column, Table};
use crate::report::words as chapters;
use crate::sampling::{self, Beyond, Refined, Standing, refined};

pub fn check(placed: &Placed, fix: Option<&str>, refine: bool) -> Result<Told, Trouble> {
    let joined = &placed.joined;
    let fix = fix.map(|id| questions::part(joined, id)).transpose()?;
    let check = sampling::checked(joined, fix);
    let levels = refine.then(|| refined(&placed.spec)).transpose()?;
    Ok(told(placed, &check, levels))
}

pub fn told(placed: &Placed, check: &Check, levels: Option<Refined>) -> Told {
    let mut answer = answer::check(&placed.joined, check, placed.source.clone());
    let asm = &placed.joined.assembly;
    let found = interlock::interlock(placed.joined.touching(), check);
    answer = answer::with_interlock(answer, answer::interlock(asm, check, &found));
    if let Some(levels) = levels {
        answer = answer::refined(answer, levels);
    }
    let news = News::of(matches!(check.rigid, Verdict::Locked(_)));
    let mut chapter = with_sampling(chapters::verdict(&placed.joined.assembly, check), &answer);
    chapter.facts.extend(answer.interlock.iter().flat_map(told_interlock));
    Told {
        remarks: answer.remarks.clone(),
        ..Told::new(news, &answer, &answer.name, "Does it lock?", chapter)
    }
}

/// The chapter with the margin, what holds beyond the samples, and the levels.
fn with_sampling(mut chapter: Chapter, a: &CheckAnswer) -> Chapter {
    let mut fact = |name: &str, value: String| chapter.facts.push((name.into(), value));
    fact("margin", margin(&a.sampling.rigid));
    if let Some(error) = a.sampling.chord_error.filter(|e| *e > 0.0) {
        let error = chapters::scientific(error);
        fact("facets' own error", format!("{error} rad at most, against the true curved surfaces"));
    }
    fact("beyond the samples", beyond(a.sampling.rigid.beyond_sampling, &a.sampling.rigid.beyond_why));
    if let Some(refine) = &a.refine {
        fact("under refinement", beyond(refine.stands, &refine.why));
        chapter.tables.extend((!refine.levels.is_empty()).then(|| levels(refine)));
    }
    chapter
}

fn beyond(word: Beyond, why: &str) -> String {
    let word = if word == Beyond::Holds { "holds" } else { "unproven" };
    format!("{word}: {why}")
}

fn margin(s: &Standing) -> String {
    let Some(m) = &s.margin else { return "not computed".into() };
    let lower = m.lower.map_or("lower bound not computed".into(), |l| {
        format!("every normal may be turned by {} rad (proven)", chapters::scientific(l))
    });
    let upper = m.upper.map(|u| format!("; by {} it would fall", chapters::scientific(u)));
    lower + &upper.unwrap_or_default()
}

fn levels(refine: &Refined) -> Table {
    let row = |l: &crate::sampling::Level| {
        let margin = l.margin.map_or("-".into(), chapters::scientific);
        let word = if l.beyond_sampling == Beyond::Holds { "holds" } else { "unproven" };
        vec![
            l.samples.to_string(),
            l.verdict.clone(),
            l.translation.clone(),
            chapters::thousands(l.rows),
            margin,
            l.chord_error.map_or("-".into(), chapters::scientific),
            word.into(),
        ]
    };
    let numbers = ["rows", "margin, rad", "facets' error, rad"].map(Column::numbers);
    let head = [Column::numbers("samples"), Column::words("rigid"), Column::words("translation")];
    let head = head.into_iter().chain(numbers).chain([Column::words("beyond")]).collect();
    Table { caption: "With doubled samples".into(), head, rows: refine.levels.iter().map(row).collect() }
}
