//! Takes a part of an assembly; gives the mold for it, as it opens: a figure, and exhibits for a page.
//!
//! The part is molded as it touches, without clearance or shrinkage: to see whether and how it opens. `fab` makes the
//! mold for use.

use super::load::Placed;
use super::make::{self, Checkers, Wish};
use super::mold_map;
use super::questions::argument;
use super::told::Trouble;
use super::unmolded::{self, Unmolded};
use crate::assembly::PartIx;
use crate::report::content::{Chapter, Tone};
use crate::report::draw::figures::Figure;
use crate::report::draw::mesh::CreaseAngle;
use crate::report::draw::{Background, Colour, Item, Mesh, Scene, View, palette};
use crate::report::viewer::{self, Exhibit};
use clap::ValueEnum;
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;
use weavelock_fab::mesh;
use weavelock_fab::mold::figures::Figures;
use weavelock_fab::mold::{self, Mold, MoldError, MoldSpec, Piece, Route};
use weavelock_fab::process;
use weavelock_fab::report::Report;

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoldRoute {
    /// Two printed halves
    Rigid,
    /// A master on its parting board, boxes for two pours
    Silicone,
    /// A tree in a flask
    LostWax,
}

/// The mold, or the part of which none can be begun with the reason.
fn made(placed: &Placed, part: PartIx, route: MoldRoute) -> Result<Result<Mold, Unmolded>, Trouble> {
    let asm = &placed.joined.assembly;
    let word = |e: &dyn std::fmt::Display| Trouble::Word(format!("error: {e}"));
    let solid = asm.solid(part);
    let vertices = solid.vertices.iter().map(|v| *v * asm.mm_per_unit).collect();
    let body = mesh::Mesh { vertices, triangles: solid.triangles().collect() };
    let route = match route {
        MoldRoute::Rigid => Route::Rigid,
        MoldRoute::Silicone => Route::Silicone,
        MoldRoute::LostWax => Route::LostWax,
    };
    let figures = Figures::embedded().map_err(|e| word(&e))?;
    match mold::make(&body, &MoldSpec::new(&asm.part(part).id, route, figures)) {
        Ok(mold) => Ok(Ok(mold)),
        Err(MoldError::Input(what, hint)) => Ok(Err(Unmolded { body, why: format!("{what} ({hint})") })),
        Err(e) => Err(word(&e)),
    }
}

/// The pieces that are made; others stand for the OpenSCAD sources alone.
fn made_pieces(mold: &Mold) -> impl Iterator<Item = &Piece> {
    mold.pieces.iter().filter(|p| p.copies > 0)
}

/// Why there are no pieces.
fn refused(mold: &Mold) -> String {
    let found: Vec<String> = mold.findings.iter().map(|f| format!("{} ({})", f.what, f.remedy)).collect();
    format!("no mold: {}", found.join("; "))
}

/// The mold opened along its pull, the part between; `Err` in words where there is none.
pub fn figure(placed: &Placed, part: PartIx, route: MoldRoute) -> Result<Result<Figure, String>, Trouble> {
    let mold = match made(placed, part, route)? {
        Ok(mold) if mold.pieces.is_empty() => return Ok(Err(refused(&mold))),
        Ok(mold) => mold,
        Err(none) => return Ok(Err(format!("no mold: {}", none.why))),
    };
    let (lo, hi) = mold.part.bounds();
    let gap = (hi - lo).max_element() * OPEN;
    let item = |k: usize, m: &mesh::Mesh, offset: DVec3| {
        let colour = Colour::srgb(palette::OTHER[k % palette::OTHER.len()]);
        Item { offset, ..Item::new(Arc::new(drawn(m)), colour) }
    };
    let mut items = vec![item(0, &mold.part, DVec3::ZERO)];
    items.extend(made_pieces(&mold).enumerate().map(|(k, p)| item(k + 1, &p.mesh, p.pull * gap)));
    let id = &placed.joined.assembly.part(part).id;
    Ok(Ok(Figure {
        name: "mold",
        scene: Scene { items, view: View::default(), background: Background::Transparent },
        alt: format!("The mold of {id}, opened along its pull, with the part between."),
        caption: format!("{id}: {} pieces, opened.", made_pieces(&mold).count()),
    }))
}

/// How far a piece is pulled off, in the part's longest side.
const OPEN: f64 = 0.8;

/// The mold and its map of draft and undercut as exhibits, with what was measured; without a mold the map alone.
pub fn exhibits(placed: &Placed, part: PartIx, route: MoldRoute) -> Result<(Vec<Exhibit>, Chapter), Trouble> {
    let id = &placed.joined.assembly.part(part).id;
    let mold = match made(placed, part, route)? {
        Ok(mold) => mold,
        Err(none) => {
            let (exhibit, chapter) = unmolded::shown(&none, id)?;
            return Ok((vec![exhibit], chapter));
        }
    };
    let map = mold_map::map(&mold, id).map_err(|e| Trouble::Word(format!("error: a picture: {e}")))?;
    let (mut shown, mut chapter) = match mold.pieces.is_empty() {
        true => (vec![], no_mold(&mold, id)),
        false => (vec![opened(&mold, id)], told(&mold, id)),
    };
    shown.push(map.exhibit);
    chapter.facts.splice(0..0, pulled(&mold));
    chapter.pictures.push(map.picture);
    chapter.tables.push(map.table);
    Ok((shown, chapter))
}

/// Shapes whose molds a run shows; the package has all of them.
const MOST_SHAPES: usize = 3;

/// The molds of what is cast, one for each shape: exhibits for the page, and what is said of them; `None`: nothing is cast.
pub fn of_cast(placed: &Placed, made: &Report) -> (Vec<Exhibit>, Option<Chapter>) {
    let asm = &placed.joined.assembly;
    let cast = made.routes.iter().filter_map(|r| Some((r, by_process(r.process.route)?)));
    let mut shapes: BTreeMap<usize, (PartIx, MoldRoute)> = BTreeMap::new();
    for (route, mold) in cast {
        for part in asm.ids().filter(|p| route.parts.contains(&asm.part(*p).id)) {
            shapes.entry(asm.part(part).solid).or_insert((part, mold));
        }
    }
    let (mut shown, mut chapters) = (vec![], vec![]);
    for (part, route) in shapes.values().take(MOST_SHAPES) {
        match exhibits(placed, *part, *route) {
            Ok((exhibits, mut chapter)) => {
                let id = &asm.part(*part).id;
                chapter.facts.iter_mut().for_each(|f| f.0 = format!("{id}: {}", f.0));
                shown.extend(exhibits);
                chapters.push(chapter);
            }
            // A shape that no mold can be made of must not take the rest of the run with it.
            Err(why) => chapters.push(Chapter {
                tone: Tone::Bad,
                headline: format!("No mold of {} was made.", asm.part(*part).id),
                words: vec![why.to_string()],
                ..Chapter::default()
            }),
        }
    }
    (shown, together(chapters, shapes.len()))
}

/// The mold that a part's process asks for: the one given, else the spec's. Without a word of either, and where the spec
/// prints the part, two printed halves.
pub fn route(placed: &Placed, part: PartIx, process: Option<&str>) -> Result<MoldRoute, Trouble> {
    let wish = Wish { process: process.map(str::to_string), ..Wish::default() };
    let recipe = make::recipe(placed, &wish, Checkers::None)?;
    let id = &placed.joined.assembly.part(part).id;
    let own = recipe.parts.get(id).filter(|_| process.is_none()).unwrap_or(&recipe.process);
    match (by_process(own.route), process) {
        (Some(route), _) => Ok(route),
        (None, None) => Ok(MoldRoute::Rigid),
        (None, Some(name)) => {
            let hint =
                "name one that casts, such as silicone-platinum or pu-resin; `weavelock processes` lists all";
            Err(argument(format!("{name} prints the part itself: it needs no mold"), hint.into()).into())
        }
    }
}

fn by_process(route: process::Route) -> Option<MoldRoute> {
    match route {
        process::Route::Print => None,
        process::Route::CastDirect => Some(MoldRoute::Rigid),
        process::Route::Cast | process::Route::LostWax => Some(MoldRoute::Silicone),
        process::Route::LostPrint => Some(MoldRoute::LostWax),
    }
}

/// One chapter for all; a single one stays as it is.
fn together(mut chapters: Vec<Chapter>, shapes: usize) -> Option<Chapter> {
    if chapters.len() < 2 {
        return chapters.pop();
    }
    let bad = chapters.iter().any(|c| c.tone == Tone::Bad);
    let mut all = Chapter {
        tone: if bad { Tone::Bad } else { Tone::Plain },
        headline: format!(
            "{shapes} shapes are cast; {} of their molds are shown, the package has all.",
            chapters.len()
        ),
        ..Chapter::default()
    };
    for c in chapters {
        all.words.push(c.headline);
        all.words.extend(c.words);
        all.facts.extend(c.facts);
        all.tables.extend(c.tables);
        all.pictures.extend(c.pictures);
    }
    Some(all)
}

fn no_mold(mold: &Mold, id: &str) -> Chapter {
    let headline = format!("No mold of {id} by this route.");
    Chapter { tone: Tone::Bad, headline, words: vec![refused(mold)], ..Chapter::default() }
}

fn opened(mold: &Mold, id: &str) -> Exhibit {
    let mut pieces = vec![(id.to_string(), drawn(&mold.part), DVec3::ZERO)];
    pieces.extend(made_pieces(mold).map(|p| (p.name.clone(), drawn(&p.mesh), p.pull)));
    viewer::of_mold(&format!("mold of {id}"), pieces)
}

/// The pull, and what stands in its way.
fn pulled(mold: &Mold) -> Vec<(String, String)> {
    let (pull, least) = (mold.pull.direction, mold.figures.draft.value);
    let of_the_part = format!("({:.3}, {:.3}, {:.3}) in the part's frame", pull.x, pull.y, pull.z);
    vec![
        ("pull".into(), of_the_part),
        ("directions looked at".into(), mold.pull.candidates.to_string()),
        ("undercut".into(), format!("{:.2} mm², hidden from both halves", mold.pull.undercut_mm2)),
        (format!("draft under {least}°"), format!("{:.2} mm²", mold.maps.low_draft_mm2)),
    ]
}

fn told(mold: &Mold, id: &str) -> Chapter {
    let kept = |kept: bool| if kept { "kept" } else { "not kept" };
    let measured = mold.measured.iter().map(|m| {
        let value = format!("{:.4} {} (limit {:.4}, {})", m.value, m.unit, m.limit, kept(m.kept));
        (m.of.clone(), value)
    });
    Chapter {
        tone: Tone::Plain,
        headline: format!(
            "A mold of {id} in {} pieces; choose it in the 3D view to see it open.",
            made_pieces(mold).count()
        ),
        words: mold.findings.iter().map(|f| format!("{} ({})", f.what, f.remedy)).collect(),
        facts: measured.collect(),
        ..Chapter::default()
    }
}

fn drawn(mesh: &mesh::Mesh) -> Mesh {
    Mesh::of(&super::pictured::solid(mesh), CreaseAngle::default())
}
