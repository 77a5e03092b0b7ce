//! Takes a draft; gives a picture of it as SVG: the strands as interlaced bands, and beside them the point paper.
//!
//! x (warps) runs to the right and y (wefts) up, as in the assembly seen from above. Color is never the only sign:
//! wefts run across, warps along. Not promised: a draft of more than [`MOST`] crossings each way is drawn in part, and
//! the caption says so.

use super::Draft;
use super::draw::Extent;
use std::fmt::Write;

/// Crossings drawn each way: beyond, a crossing is too small to see on a page.
const MOST: u32 = 64;

/// Side of a crossing, width of a strand, and of the shade beside one that lies over, in pixels.
const CELL: u32 = 24;
const BAND: u32 = 18;
const SHADE: u32 = 3;

/// Half a crossing around each panel: there the strands go on.
const MARGIN: u32 = CELL / 2;

/// Height of the captions below, in pixels.
const CAPTION: u32 = 44;

/// Blue, orange and vermilion of Okabe and Ito's palette, which people with any color vision tell apart; edges darker.
const WARP: (&str, &str) = ("#56b4e9", "#0b4a6f");
const WEFT: (&str, &str) = ("#e69f00", "#6b4a00");
const FRAME: &str = "#d55e00";

/// The draft as an SVG document.
pub fn svg(draft: &Draft) -> String {
    let extent = Extent::of(draft, (MOST, MOST));
    let (width, height) = (CELL * extent.warps + 2 * MARGIN, CELL * extent.wefts + 2 * MARGIN);
    let total = (2 * width + CELL).max(LEAST_WIDTH);
    let mut out = String::new();
    let _ = writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" role="img" width="{total}" height="{0}" viewBox="0 0 {total} {0}">"#,
        height + CAPTION
    );
    let _ = writeln!(out, "<title>{}</title>", title(draft));
    let _ = writeln!(
        out,
        "<desc>Rows of the draft, weft 0 first, X: weft over warp. {}</desc>",
        words(draft, extent)
    );
    let _ = writeln!(out, r##"<rect width="100%" height="100%" fill="#ffffff"/>"##);
    let _ = writeln!(out, r#"<g id="bands">"#);
    bands(&mut out, draft, extent);
    let _ = writeln!(out, "</g>\n<g id=\"point-paper\" transform=\"translate({} 0)\">", width + CELL);
    point_paper(&mut out, draft, extent);
    let _ = writeln!(out, "</g>");
    captions(&mut out, draft, extent, height);
    out + "</svg>\n"
}

/// Room for the captions, in pixels.
const LEAST_WIDTH: u32 = 520;

fn title(draft: &Draft) -> String {
    format!("Draft of {} wefts x {} warps", draft.wefts(), draft.warps())
}

fn words(draft: &Draft, extent: Extent) -> String {
    if extent.holds_repeat(draft) { draft.rows().join(" ") } else { "Only a part is drawn.".into() }
}

/// The top edge of weft `j`'s row.
fn top(extent: Extent, j: u32) -> u32 {
    MARGIN + CELL * (extent.wefts - 1 - j)
}

fn bands(out: &mut String, draft: &Draft, extent: Extent) {
    let (width, height) = (CELL * extent.warps + 2 * MARGIN, CELL * extent.wefts + 2 * MARGIN);
    for i in 0..extent.warps {
        upright(out, MARGIN + CELL * i, 0, height);
    }
    for j in 0..extent.wefts {
        across(out, 0, top(extent, j), width);
    }
    for (j, i) in (0..extent.wefts).flat_map(|j| (0..extent.warps).map(move |i| (j, i))) {
        let (x, y) = (MARGIN + CELL * i, top(extent, j));
        match draft.weft_over(j as i32, i as i32) {
            true => shade_warp(out, x, y),
            false => {
                upright(out, x, y, CELL);
                shade_weft(out, x, y);
            }
        }
    }
    frame(out, draft, extent);
}

/// A stretch of warp in the column that starts at `x`.
fn upright(out: &mut String, x: u32, y: u32, length: u32) {
    let (left, right) = (x + (CELL - BAND) / 2, x + (CELL + BAND) / 2);
    let (fill, edge) = WARP;
    let _ = writeln!(out, r#"<rect x="{left}" y="{y}" width="{BAND}" height="{length}" fill="{fill}"/>"#);
    let _ = writeln!(out, r#"<path d="M{left} {y}v{length}M{right} {y}v{length}" stroke="{edge}"/>"#);
}

/// A stretch of weft in the row that starts at `y`.
fn across(out: &mut String, x: u32, y: u32, length: u32) {
    let (upper, lower) = (y + (CELL - BAND) / 2, y + (CELL + BAND) / 2);
    let (fill, edge) = WEFT;
    let _ = writeln!(out, r#"<rect x="{x}" y="{upper}" width="{length}" height="{BAND}" fill="{fill}"/>"#);
    let _ = writeln!(out, r#"<path d="M{x} {upper}h{length}M{x} {lower}h{length}" stroke="{edge}"/>"#);
}

/// The shade of a weft on the warp below it.
fn shade_warp(out: &mut String, x: u32, y: u32) {
    let (left, gap) = (x + (CELL - BAND) / 2, (CELL - BAND) / 2);
    for at in [y + gap - SHADE, y + gap + BAND] {
        shade(out, left, at, BAND, SHADE);
    }
}

/// The shade of a warp on the weft below it.
fn shade_weft(out: &mut String, x: u32, y: u32) {
    let (upper, gap) = (y + (CELL - BAND) / 2, (CELL - BAND) / 2);
    for at in [x + gap - SHADE, x + gap + BAND] {
        shade(out, at, upper, SHADE, BAND);
    }
}

fn shade(out: &mut String, x: u32, y: u32, width: u32, height: u32) {
    let _ = writeln!(
        out,
        r##"<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="#000000" fill-opacity="0.35"/>"##
    );
}

/// A square for each crossing, filled where the weft passes over.
fn point_paper(out: &mut String, draft: &Draft, extent: Extent) {
    for (j, i) in (0..extent.wefts).flat_map(|j| (0..extent.warps).map(move |i| (j, i))) {
        let fill = if draft.weft_over(j as i32, i as i32) { "#222222" } else { "#ffffff" };
        let (x, y) = (MARGIN + CELL * i, top(extent, j));
        let square = format!(r#"<rect x="{x}" y="{y}" width="{CELL}" height="{CELL}""#);
        let _ = writeln!(out, r##"{square} fill="{fill}" stroke="#999999"/>"##);
    }
    frame(out, draft, extent);
}

/// A frame around one repeat, from weft 0 and warp 0.
fn frame(out: &mut String, draft: &Draft, extent: Extent) {
    if !extent.holds_repeat(draft) {
        return;
    }
    let (width, height) = (CELL * draft.warps(), CELL * draft.wefts());
    let y = top(extent, draft.wefts() - 1);
    let rect = format!(r#"<rect x="{MARGIN}" y="{y}" width="{width}" height="{height}" fill="none""#);
    let _ = writeln!(out, r#"{rect} stroke="{FRAME}" stroke-width="3"/>"#);
}

fn captions(out: &mut String, draft: &Draft, extent: Extent, below: u32) {
    let size = format!("one repeat, {} wefts x {} warps", draft.wefts(), draft.warps());
    let framed = if extent.holds_repeat(draft) { "is framed" } else { "is larger than this picture" };
    let lines = [
        format!("Wefts (orange) run across, warps (blue) upright; {size}, {framed}."),
        "Right: filled where the weft passes over. Weft 0 is the lowest row, warp 0 the left column."
            .to_string(),
    ];
    for (line, y) in lines.iter().zip([below + 14, below + 32]) {
        let _ = writeln!(
            out,
            r##"<text x="{MARGIN}" y="{y}" font-family="sans-serif" font-size="11" fill="#222222">{line}</text>"##
        );
    }
}
