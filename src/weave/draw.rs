//! Takes a draft; gives it drawn as text for a terminal.
//!
//! x (warps) runs to the right and y (wefts) up, so weft 0 stands lowest. Not promised: a draft wider or higher than
//! the room is drawn in part, and the drawing says so.

use super::Draft;

/// Crossings that a drawing shows at least, each way, where the room allows: a single repeat of plain weave says little.
const SHOWN_AT_LEAST: u32 = 8;

/// Crossings of a draft that a picture shows, each way, and whether one whole repeat is among them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Extent {
    pub wefts: u32,
    pub warps: u32,
}

impl Extent {
    /// Whole repeats, as many as show [`SHOWN_AT_LEAST`] crossings, cut at `most` wefts and warps.
    pub fn of(draft: &Draft, most: (u32, u32)) -> Extent {
        let shown = |period: u32, most: u32| (SHOWN_AT_LEAST.div_ceil(period) * period).min(most);
        Extent { wefts: shown(draft.wefts(), most.0), warps: shown(draft.warps(), most.1) }
    }

    pub fn holds_repeat(self, draft: &Draft) -> bool {
        draft.wefts() <= self.wefts && draft.warps() <= self.warps
    }
}

/// Width of the weft numbers at the left, of one crossing, and of the frame's two sides, in characters.
const LABEL: usize = 5;
const CROSSING: usize = 2;
const FRAME: usize = 2;

/// Wefts that fit a screen.
const MOST_WEFTS: u32 = 64;

/// The draft drawn in lines of at most `width` characters (at least enough for one crossing): `══` where the weft
/// passes over, `┃┃` where the warp does, one repeat in a frame.
pub fn terminal(draft: &Draft, width: usize) -> String {
    let room = width.saturating_sub(LABEL + FRAME) / CROSSING;
    let extent = Extent::of(draft, (MOST_WEFTS, room.max(1).min(u32::MAX as usize) as u32));
    let inside = draft.warps().min(extent.warps);
    let framed = |left: char, right: char| {
        let bar = "─".repeat(inside as usize * CROSSING);
        format!("{:LABEL$}{left}{bar}{right}\n", "")
    };
    let mut lines = String::new();
    for j in (0..extent.wefts).rev() {
        if j + 1 == draft.wefts() {
            lines += &framed('┌', '┐');
        }
        lines += &row(draft, j, extent, inside);
    }
    lines += &framed('└', '┘');
    lines + &numbers(extent, inside) + &legend(draft, extent)
}

fn row(draft: &Draft, j: u32, extent: Extent, inside: u32) -> String {
    let side = if j < draft.wefts() { '│' } else { ' ' };
    let cells = |range: std::ops::Range<u32>| -> String {
        range.map(|i| if draft.weft_over(j as i32, i as i32) { "══" } else { "┃┃" }).collect()
    };
    let line = format!("{j:>4} {side}{}{side}{}", cells(0..inside), cells(inside..extent.warps));
    line.trim_end().to_string() + "\n"
}

/// The last two digits of each warp's number.
fn numbers(extent: Extent, inside: u32) -> String {
    let digits =
        |range: std::ops::Range<u32>| -> String { range.map(|i| format!("{:>2}", i % 100)).collect() };
    format!("{:LABEL$} {} {}", "", digits(0..inside), digits(inside..extent.warps)).trim_end().to_string()
        + "\n"
}

fn legend(draft: &Draft, extent: Extent) -> String {
    let (wefts, warps) = (draft.wefts(), draft.warps());
    let part = if extent.holds_repeat(draft) { "" } else { " (only a part is drawn)" };
    let repeat = format!("one repeat, {wefts} wefts x {warps} warps, is framed{part}");
    format!("══ weft over   ┃┃ warp over   weft numbers run up; {repeat}\n")
}
