//! Takes answers as written; gives the chapters that say them in words.
//!
//! Not promised: a word more than the answer carries.

use crate::report::answer::{WeaveAnswer, Word};
use crate::report::content::{Chapter, Tone};
use crate::verify::Verified;
use crate::verify::certificate::{Arithmetic, Shown};

pub fn fact(name: &str, value: impl Into<String>) -> (String, String) {
    (name.into(), value.into())
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
    let proof = |(about, p): (&String, &Shown)| {
        let how = match p.arithmetic {
            Arithmetic::Exact => "exact",
            Arithmetic::RoundOff => "to round-off",
            Arithmetic::None => "no claim",
        };
        let least = p.least_force.map_or(String::new(), |f| format!("; least force {f:.6} or more"));
        fact(about, format!("{how}: {}{least}", p.how))
    };
    let facts = a.proofs.iter().map(proof).collect();
    Chapter {
        tone,
        headline: headline.into(),
        words: vec![format!("{}.", a.why)],
        facts,
        ..Chapter::default()
    }
}
