//! Takes answers as written; gives the chapters that say them in words.
//!
//! Not promised: a word more than the answer carries.

use crate::atlas::{Row, Written};
use crate::chirality::answer::{Handedness, Hands, TileAnswer, WarpIs};
use crate::report::answer::{WeaveAnswer, Word};
use crate::report::content::{Chapter, Column, Table, Tone};
use crate::verify::Verified;

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

pub fn atlas(written: &Written) -> Chapter {
    let row = |r: &Row| {
        let hand = |h: Option<String>| h.unwrap_or("-".into()).to_lowercase();
        vec![
            format!("[{},{},{}]", r.a, r.b, r.c),
            r.family.clone(),
            hand(r.tile.map(|t| format!("{t:?}"))),
            hand(r.warp_is.map(|w| format!("{w:?}"))),
            r.minimal_repeat.map_or(format!("none up to {}", r.most), |k| k.to_string()),
        ]
    };
    let table = Table {
        caption: "Weaves that hang together; least repetition at phase 0, swatch n x n".into(),
        head: ["weave", "family", "tile", "warp is", "least k"].map(Column::words).to_vec(),
        rows: written.rows.iter().map(row).collect(),
    };
    let headline =
        format!("{} weaves, {} of them found there from before.", written.rows.len(), written.found);
    let words = written.files.iter().map(|f| f.display().to_string()).collect();
    Chapter { headline, words, tables: vec![table], ..Chapter::default() }
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
