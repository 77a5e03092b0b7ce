//! Takes answers as written; gives the chapters that say them in words.
//!
//! Not promised: a word more than the answer carries.

use crate::report::answer::{FlexAnswer, RepeatsAnswer, WeaveAnswer, Word};
use crate::report::content::{Chapter, Column, Table, Tone};
use crate::verify::Verified;

fn fact(name: &str, value: impl Into<String>) -> (String, String) {
    (name.into(), value.into())
}

pub fn flex(a: &FlexAnswer) -> Chapter {
    let headline = match (a.minimum, a.upper_bound) {
        (Some(0), _) => "No part needs to be flexible: all go together rigidly.".to_string(),
        (Some(1), _) => "One flexible part is needed, and is enough.".to_string(),
        (Some(n), _) => format!("{n} flexible parts are needed, and are enough."),
        (None, upper) => {
            format!("Between {} and {upper} flexible parts: the bounds do not meet.", a.lower_bound)
        }
    };
    let why = a.cores.iter().map(|c| {
        format!(
            "{} are locked among themselves ({} forces in balance), so one of them must give.",
            c.parts.join(", "),
            c.certificate.forces.len()
        )
    });
    let mut words: Vec<String> = why.collect();
    if !a.unproven.is_empty() {
        words.push(format!(
            "{} sets came apart by no plan that was looked for, and are not proven locked.",
            a.unproven.len()
        ));
    }
    let some: Vec<String> = a.sets.iter().take(8).map(|s| s.join(" + ")).collect();
    let more = if a.sets.len() > 8 { format!(" ... ({} in all)", a.sets.len()) } else { String::new() };
    let complete = if a.sets_complete { "" } else { " (more may exist)" };
    let facts = if a.upper_bound > 0 {
        vec![fact("enough", format!("{}{more}{complete}", some.join("; ")))]
    } else {
        vec![]
    };
    let tone = if a.minimum.is_some() { Tone::Good } else { Tone::Undecided };
    Chapter { tone, headline, words, facts, ..Chapter::default() }
}

pub fn repeats(a: &RepeatsAnswer) -> Chapter {
    let (tone, headline) = match a.minimal_repeat {
        Some(1) => (Tone::Good, format!("Unit tiles of {} lock by themselves.", a.weave)),
        Some(k) => {
            (Tone::Good, format!("Tiles of {} lock when {k} periods are joined in one piece.", a.weave))
        }
        None => (Tone::Bad, format!("No repetition up to {} locks.", a.searched)),
    };
    let row = |r: &crate::report::answer::RepeatsRow| {
        vec![
            r.k.to_string(),
            r.phase.to_string(),
            format!("{} x {}", r.swatch.wefts, r.swatch.warps),
            word(r.translation).into(),
            word(r.rigid).into(),
            r.witness.clone(),
        ]
    };
    let head = ["translation", "rigid", "witness"].map(Column::words);
    let table = Table {
        caption: "Swatches tried".into(),
        head: [Column::numbers("k"), Column::numbers("phase"), Column::words("swatch")]
            .into_iter()
            .chain(head)
            .collect(),
        rows: a.table.iter().map(row).collect(),
    };
    let words =
        vec!["The answer is about these swatches; a larger one or another cut may have another.".into()];
    Chapter { tone, headline, words, tables: vec![table], ..Chapter::default() }
}

fn word(w: Word) -> &'static str {
    match w {
        Word::Locked => "locked",
        Word::Free => "free",
        Word::Undecided => "undecided",
    }
}

pub fn weave(a: &WeaveAnswer, figure: String) -> Chapter {
    let hand = a.hand.as_ref().map_or(String::new(), |h| format!(" {h}"));
    let (tone, headline) = if a.hangs_together {
        (Tone::Good, format!("A {}{hand} weave; it hangs together.", a.family))
    } else {
        (Tone::Bad, format!("It falls apart: {} lift off the rest.", a.lifts.join(", ")))
    };
    let float = |v: Option<u32>| v.map_or("none or endless".to_string(), |n| n.to_string());
    let facts = vec![
        fact("period", format!("{} warps x {} wefts", a.period[0], a.period[1])),
        fact(
            "longest weft floats",
            format!("over {}, under {}", float(a.floats.weft_over), float(a.floats.weft_under)),
        ),
        fact(
            "longest warp floats",
            format!("over {}, under {}", float(a.floats.warp_over), float(a.floats.warp_under)),
        ),
    ];
    let figure = figure.lines().map(str::to_string).collect();
    Chapter { tone, headline, facts, figure, ..Chapter::default() }
}

/// The verdict of a check that was told; undecided where it cannot be read.
pub fn verdict_word(json: &str) -> Word {
    let read = serde_json::from_str::<crate::report::answer::CheckAnswer>(json);
    read.map_or(Word::Undecided, |a| a.rigid.verdict)
}

pub fn verified(a: &Verified) -> Chapter {
    let (tone, headline) = if a.valid { (Tone::Good, "Valid.") } else { (Tone::Bad, "Not valid.") };
    Chapter { tone, headline: headline.into(), words: vec![format!("{}.", a.why)], ..Chapter::default() }
}
