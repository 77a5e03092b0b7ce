//! Takes an assembly in place and the answers about it; gives what a page shows beyond their words: the exhibits, who
//! stops whom along the axes.
//!
//! Not promised: any finding of its own.

use super::blocking::along;
use super::load::Placed;
use super::told::Told;
use crate::blocking::ndbg::Reach;
use crate::report::answer::DbgAnswer;
use crate::report::content::{Answer, Chapter, Column, Format, Picture, Table, Tone};
use crate::report::draw::arcs::{self, Arcs};
use crate::report::moves;
use crate::report::viewer::{self, Answers, Exhibit};
use glam::DVec3;
use serde_json::Value;

/// The answer as JSON, where it was asked for.
pub fn json(told: Option<&Told>) -> Option<Value> {
    told.and_then(|t| serde_json::from_str(&t.json).ok())
}

/// The assembly with what was found about it.
pub fn exhibits(placed: &Placed, answers: &Answers) -> Vec<Exhibit> {
    vec![viewer::of_assembly(&placed.joined, answers)]
}

/// Who stops whom at the very start of a motion along x, y and z; the reverse directions give the reverse arrows.
pub fn blocking(placed: &Placed) -> Answer<Chapter> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let found: Result<Vec<DbgAnswer>, String> =
        axes.iter().map(|d| along(&placed.joined, *d, Reach::Infinitesimal)).collect();
    match found {
        Ok(graphs) => Answer::Given(chapter(placed, &graphs)),
        Err(why) => Answer::not_run(why),
    }
}

fn chapter(placed: &Placed, graphs: &[DbgAnswer]) -> Chapter {
    let connected = graphs.iter().filter(|g| g.components.len() == 1).count();
    let (tone, headline) = match connected {
        3 => (Tone::Plain, "Along x, y and z no group of parts can start to leave the rest."),
        _ => (Tone::Plain, "Along an axis some parts can start to leave the rest."),
    };
    let words = vec![
        "Along z, at the very start of the motion: an arrow runs from a part to a part that stops it. Blue with two \
         heads: each stops the other, for one moving up and the other down; orange: one stops the other alone."
            .into(),
        "Parts that must move in different directions at once are not seen here; the verdict sees them.".into(),
    ];
    let row = |g: &DbgAnswer| {
        let leave = g.leave.iter().map(|s| s.join(", ")).collect::<Vec<_>>().join("; ");
        let whole = g.components.len() == 1;
        let leave = if whole { "none, all hold together".into() } else { short(leave) };
        vec![
            moves::direction(DVec3::from_array(g.direction)),
            g.arcs.len().to_string(),
            g.components.len().to_string(),
            leave,
        ]
    };
    let head = vec![
        Column::words("along"),
        Column::numbers("arrows"),
        Column::numbers("groups that hold together"),
        Column::words("can start that way"),
    ];
    let table = Table {
        caption: "Blocking at the start, along the axes".into(),
        head,
        rows: graphs.iter().map(row).collect(),
    };
    let pictures = graphs.last().and_then(|g| picture(placed, g)).into_iter().collect();
    Chapter { tone, headline: headline.into(), words, tables: vec![table], pictures, ..Chapter::default() }
}

/// Letters of a list of ids before it is cut.
const LONGEST_LIST: usize = 160;

fn short(list: String) -> String {
    match list.char_indices().nth(LONGEST_LIST) {
        Some((at, _)) => format!("{} ...", &list[..at]),
        None => list,
    }
}

fn picture(placed: &Placed, graph: &DbgAnswer) -> Option<Picture> {
    let ids: Vec<&str> = placed.joined.assembly.parts.iter().map(|p| p.id.as_str()).collect();
    if ids.len() > arcs::MOST_DOTS {
        return None;
    }
    let at = |id: &String| ids.iter().position(|i| i == id);
    let component = |id: &&str| graph.components.iter().position(|c| c.iter().any(|i| i == id)).unwrap_or(0);
    let arcs = graph.arcs.iter().filter_map(|a| Some((at(&a.from)?, at(&a.to)?))).collect();
    let drawn = Arcs { component: ids.iter().map(component).collect(), ids, arcs };
    let sheet = arcs::sheet(&drawn)?;
    Some(Picture {
        width: sheet.width as u32,
        height: sheet.height as u32,
        format: Format::Svg(sheet.svg()),
        alt: format!("Who stops whom along z: {} parts, {} arrows.", drawn.ids.len(), drawn.arcs.len()),
        caption: "Along z.".into(),
    })
}
