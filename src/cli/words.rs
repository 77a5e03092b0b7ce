//! Takes answers as written; gives the chapters that say them in words.
//!
//! Not promised: a word more than the answer carries.

use crate::chirality::answer::{Handedness, Hands, TileAnswer, WarpIs};
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

pub fn hands(a: &Hands) -> Chapter {
    let tile = a.tile.map(|t| match t {
        Handedness::Achiral => "The unit tile is its own mirror image.".to_string(),
        Handedness::Undecided => "The hand of the unit tile is undecided.".into(),
        hand => format!("The unit tile is chiral: a {} one.", lower(hand)),
    });
    let warp = a.warp_is.map(|w| match w {
        WarpIs::Same => "The warp tile is the weft tile, turned.",
        WarpIs::Mirror => "The warp tile is the weft tile's mirror image: the assembly needs both hands.",
        WarpIs::Both => "The warp tile is the weft tile, turned or mirrored alike: one tile serves both.",
        WarpIs::Different => "The warp tile is another tile than the weft's.",
        WarpIs::Undecided => "How the warp tile follows from the weft's is undecided.",
    });
    let assembly = a.assembly.map(|h| ("the assembly".to_string(), lower(h)));
    let twill = a.twill.map(|h| ("the twill's diagonal".to_string(), format!("{h:?}")));
    let found = |t: &TileAnswer| {
        let (all, proper) =
            (&t.hand.evidence.isometries, t.hand.evidence.isometries.iter().filter(|i| i.proper).count());
        fact(
            &format!("isometries of {}", t.strand),
            format!("{proper} proper, {} improper, found on the solid", all.len() - proper),
        )
    };
    let headline =
        tile.or_else(|| a.assembly.map(|h| format!("The assembly is {}.", lower(h)))).unwrap_or_default();
    let words =
        warp.map(str::to_string).into_iter().chain([format!("Convention: {}.", a.convention)]).collect();
    let facts = assembly.into_iter().chain(twill).chain(a.tiles.iter().map(found)).collect();
    Chapter { headline, words, facts, ..Chapter::default() }
}

fn lower(hand: Handedness) -> String {
    format!("{hand:?}").to_lowercase()
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
