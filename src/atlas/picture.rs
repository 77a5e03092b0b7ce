//! Takes the rows of a table; gives its picture: a panel for each n, a cell for each weave, coloured by least repetition.
//!
//! Colour never stands alone: every cell says its number. Not promised: what the table does not hold; a cell that is
//! absent is a weave that falls apart or stands elsewhere under an equivalent name.

use super::export::told;
use super::row::{AtPhase, Row};
use super::table::Ask;
use crate::chirality::answer::{Handedness, WarpIs};
use crate::report::draw::sheet::{Anchor, Mark, Rgb, Sheet, rectangle};
use std::collections::BTreeMap;

/// Side of a cell and room around panels, in CSS pixels.
const CELL: f64 = 54.0;
const GAP: f64 = 34.0;
const MARGIN: f64 = 24.0;
/// Room left of a panel for a/b, above it for its name, below it for c.
const LEFT: f64 = 40.0;
const TOP: f64 = 24.0;
const BOTTOM: f64 = 18.0;
/// Width of the sheet: two columns of a page.
const WIDTH: f64 = 1040.0;
const HEADING: f64 = 62.0;
const LEGEND: f64 = 116.0;

const INK: Rgb = [26, 26, 32];
const PALE: Rgb = [255, 255, 255];
const GREY: Rgb = [110, 110, 116];
/// A sequence from light yellow over green to dark blue whose lightness falls all along: it reads in grey, and for every
/// kind of colour vision.
const SEQUENCE: [Rgb; 5] = [[255, 248, 200], [150, 212, 180], [64, 170, 196], [40, 112, 176], [32, 44, 120]];
const NONE: Rgb = [226, 226, 228];

/// The picture.
pub fn sheet(rows: &[Row], ask: &Ask) -> Sheet {
    let mut panels: BTreeMap<u32, Vec<&Row>> = BTreeMap::new();
    rows.iter().for_each(|r| panels.entry(r.n).or_default().push(r));
    let mut marks = heading(ask);
    let (mut x, mut y, mut tall) = (MARGIN, HEADING, 0.0_f64);
    let mut right = WIDTH;
    for (n, rows) in &panels {
        let panel = Panel::of(*n, rows);
        if x > MARGIN && x + panel.width() > WIDTH - MARGIN {
            (x, y, tall) = (MARGIN, y + tall + GAP / 2.0, 0.0);
        }
        marks.extend(panel.marks(x, y));
        x += panel.width() + GAP;
        right = right.max(x);
        tall = tall.max(panel.height());
    }
    let foot = y + tall + GAP;
    marks.extend(legend(foot, ask));
    Sheet { width: right, height: foot + LEGEND, marks }
}

fn words(x: f64, y: f64, size: f64, anchor: Anchor, ink: Rgb, text: impl Into<String>) -> Mark {
    Mark::Words { at: [x, y], size, anchor, ink, text: text.into() }
}

fn heading(ask: &Ask) -> Vec<Mark> {
    let s = &ask.settings;
    let title = "How many unit tiles must be joined in one piece until the cloth locks?";
    let settings = format!(
        "Weaves [a,b,c] that hang together, n = a + b up to {}; swatch of n wefts and n warps; rise {}, lift {}, cover {}, {} samples",
        ask.max_n, s.rise, s.lift, s.cover, s.samples
    );
    vec![
        words(MARGIN, 28.0, 17.0, Anchor::Start, INK, title),
        words(MARGIN, 47.0, 11.0, Anchor::Start, GREY, settings),
    ]
}

/// The weaves of one n: a column for each c, a row for each a.
struct Panel<'a> {
    n: u32,
    rows: &'a [&'a Row],
    columns: Vec<i32>,
    runs: Vec<u32>,
}

impl<'a> Panel<'a> {
    fn of(n: u32, rows: &'a [&'a Row]) -> Panel<'a> {
        let span = |of: &dyn Fn(&Row) -> i32| {
            let all = || rows.iter().map(|r| of(r));
            all().min().unwrap_or(0)..=all().max().unwrap_or(0)
        };
        let columns = span(&|r| r.c).collect();
        let runs = span(&|r| r.a as i32).rev().map(|a| a as u32).collect();
        Panel { n, rows, columns, runs }
    }

    fn width(&self) -> f64 {
        LEFT + self.columns.len() as f64 * CELL
    }

    fn height(&self) -> f64 {
        TOP + self.runs.len() as f64 * CELL + BOTTOM
    }

    fn marks(&self, x: f64, y: f64) -> Vec<Mark> {
        let (left, top) = (x + LEFT, y + TOP);
        let bottom = top + self.runs.len() as f64 * CELL;
        let mut marks = vec![words(left, y + 15.0, 13.0, Anchor::Start, INK, format!("n = {}", self.n))];
        for (k, c) in self.columns.iter().enumerate() {
            let middle = left + (k as f64 + 0.5) * CELL;
            marks.push(words(middle, bottom + 13.0, 11.0, Anchor::Middle, GREY, format!("c = {c}")));
        }
        for (k, a) in self.runs.iter().enumerate() {
            let base = top + (k as f64 + 0.5) * CELL + 4.0;
            marks.push(words(left - 6.0, base, 11.0, Anchor::End, GREY, format!("{a}/{}", self.n - a)));
        }
        for row in self.rows {
            let at = |found: Option<usize>| found.unwrap_or(0) as f64 * CELL;
            let column = at(self.columns.iter().position(|c| *c == row.c));
            let line = at(self.runs.iter().position(|a| *a == row.a));
            marks.extend(cell(row, left + column, top + line));
        }
        marks
    }
}

/// Colour of a repetition, and of what is written on it.
fn colours(least: Option<u32>) -> (Rgb, Rgb) {
    match least {
        None => (NONE, INK),
        Some(k) => {
            let k = (k.max(1) as usize - 1).min(SEQUENCE.len() - 1);
            (SEQUENCE[k], if k >= 3 { PALE } else { INK })
        }
    }
}

/// The largest of the least repetitions over all phases; none where some phase has none.
fn worst(phases: &[AtPhase]) -> Option<u32> {
    phases.iter().map(|p| p.least).collect::<Option<Vec<u32>>>()?.into_iter().max()
}

/// The repetitions over all phases: one number, or from which to which.
fn range(phases: &[AtPhase]) -> String {
    let mut all: Vec<String> = phases.iter().map(told).collect();
    all.sort();
    all.dedup();
    match &all[..] {
        [] => "?".into(),
        [only] => only.clone(),
        _ if all.iter().any(|k| k == "?" || k == "-") => all.join(","),
        [first, .., last] => format!("{first}-{last}"),
    }
}

fn cell(row: &Row, x: f64, y: f64) -> Vec<Mark> {
    let side = CELL - 3.0;
    let (ground, ink) = colours(worst(&row.by_phase));
    let mut marks = vec![Mark::Fill { points: rectangle(x, y, side, side), ink: ground }];
    if worst(&row.by_phase).is_none() {
        marks.extend(hatch(x, y, side));
    }
    marks.push(words(x + side / 2.0, y + 31.0, 18.0, Anchor::Middle, ink, range(&row.by_phase)));
    marks.extend(hand(row.tile, x + 9.0, y + 10.0, ink));
    marks.push(words(x + side - 4.0, y + 13.0, 10.0, Anchor::End, ink, kin(row.warp_is)));
    if let Some(flexible) = row.flexible.minimum {
        marks.push(words(x + side - 4.0, y + 42.0, 8.0, Anchor::End, ink, format!("f{flexible}")));
    }
    marks.extend(strip(&row.by_phase, x, y + side - 7.0, side));
    if matches!(row.assembly, Some(Handedness::Left | Handedness::Right)) {
        marks.push(frame(x, y, side));
    }
    marks
}

fn frame(x: f64, y: f64, side: f64) -> Mark {
    let mut points = rectangle(x + 1.0, y + 1.0, side - 2.0, side - 2.0);
    points.push(points[0]);
    Mark::Line { points, ink: INK, width: 2.0 }
}

fn hatch(x: f64, y: f64, side: f64) -> Vec<Mark> {
    let line = |k: usize| {
        let d = side * k as f64 / 4.0;
        let points = if k <= 4 {
            vec![[x, y + d], [x + d, y]]
        } else {
            vec![[x + d - side, y + side], [x + side, y + d - side]]
        };
        Mark::Line { points, ink: [190, 190, 194], width: 0.8 }
    };
    (1..8).map(line).collect()
}

/// A little square for each phase, coloured by its own repetition.
fn strip(phases: &[AtPhase], x: f64, y: f64, side: f64) -> Vec<Mark> {
    if phases.len() < 2 {
        return Vec::new();
    }
    let wide = (side - 6.0) / phases.len() as f64;
    let ground = Mark::Fill { points: rectangle(x + 2.5, y - 0.5, side - 5.0, 5.0), ink: PALE };
    let square = |(k, p): (usize, &AtPhase)| {
        let points = rectangle(x + 3.0 + k as f64 * wide + 0.25, y, (wide - 0.5).max(0.5), 4.0);
        Mark::Fill { points, ink: colours(p.least).0 }
    };
    std::iter::once(ground).chain(phases.iter().enumerate().map(square)).collect()
}

/// A triangle that points to the hand, a ring for achiral, a question mark.
fn hand(hand: Option<Handedness>, x: f64, y: f64, ink: Rgb) -> Vec<Mark> {
    let r = 4.5;
    let triangle = |side: f64| {
        vec![Mark::Fill {
            points: vec![[x + side * r, y], [x - side * r, y - r], [x - side * r, y + r]],
            ink,
        }]
    };
    match hand {
        Some(Handedness::Left) => triangle(-1.0),
        Some(Handedness::Right) => triangle(1.0),
        Some(Handedness::Achiral) => {
            let point = |k: usize| {
                let t = std::f64::consts::TAU * k as f64 / 24.0;
                [x + 0.8 * r * t.cos(), y + 0.8 * r * t.sin()]
            };
            vec![Mark::Line { points: (0..=24).map(point).collect(), ink, width: 1.3 }]
        }
        _ => vec![words(x, y + 4.0, 10.0, Anchor::Middle, ink, "?")],
    }
}

fn kin(warp: Option<WarpIs>) -> &'static str {
    match warp {
        Some(WarpIs::Same) => "s",
        Some(WarpIs::Mirror) => "m",
        Some(WarpIs::Both) => "b",
        Some(WarpIs::Different) => "d",
        Some(WarpIs::Undecided) | None => "?",
    }
}

fn legend(y: f64, ask: &Ask) -> Vec<Mark> {
    let text =
        |x: f64, line: usize, t: &str| words(x, y + 22.0 * line as f64 + 14.0, 11.0, Anchor::Start, INK, t);
    let mut marks = Vec::new();
    let mut x = MARGIN;
    for k in 1..=ask.most.min(SEQUENCE.len() as u32) {
        marks.push(Mark::Fill { points: rectangle(x, y, 26.0, 18.0), ink: colours(Some(k)).0 });
        marks.push(words(x + 13.0, y + 14.0, 12.0, Anchor::Middle, colours(Some(k)).1, k.to_string()));
        x += 30.0;
    }
    marks.push(Mark::Fill { points: rectangle(x, y, 26.0, 18.0), ink: NONE });
    marks.push(words(x + 13.0, y + 14.0, 12.0, Anchor::Middle, INK, "-"));
    let none = format!("least k that locks, the worst phase; - none up to {}, ? undecided", ask.most);
    marks.push(text(x + 36.0, 0, &none));
    marks.push(text(MARGIN, 1, "Strip below: the least k at phase 0, 1, ... n-1.  Lower right, f2: two flexible parts are the fewest for the n x n window."));
    marks.extend(hand(Some(Handedness::Left), MARGIN + 6.0, y + 54.0, INK));
    marks.push(text(MARGIN + 16.0, 2, "left"));
    marks.extend(hand(Some(Handedness::Right), MARGIN + 62.0, y + 54.0, INK));
    marks.push(text(MARGIN + 72.0, 2, "right"));
    marks.extend(hand(Some(Handedness::Achiral), MARGIN + 124.0, y + 54.0, INK));
    marks.push(text(MARGIN + 134.0, 2, "achiral unit tile.  The warp's tile is the weft's:  s  same, turned;  m  mirrored;  b  both;  d  different."));
    marks.push(frame(MARGIN, y + 67.0, 16.0));
    marks.push(text(MARGIN + 24.0, 3, "the endless weave is chiral (no frame: achiral or undecided).  No cell: it falls apart, or stands under an equivalent name."));
    marks
}
