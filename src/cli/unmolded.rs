//! Takes a part that no mold can be begun for, and why; gives what a page shows of it: its closed surfaces, each around
//! material or around a hollow, as an exhibit, a picture and a table.
//!
//! Not promised: that a hollow is all that is wrong; the reason is the mold maker's own.

use super::pictured;
use super::told::Trouble;
use crate::report::content::{Chapter, Column, Picture, Table, Tone};
use crate::report::draw::figures::Figure;
use crate::report::draw::mesh::CreaseAngle;
use crate::report::draw::{Background, Colour, Item, Mesh, Opacity, Scene, Size, View};
use crate::report::viewer::facets::{Buried, Classed, of_classes};
use crate::report::viewer::{Exhibit, Rgb, Scheme};
use std::collections::BTreeMap;
use std::sync::Arc;
use weavelock_fab::mesh::{self, area};

/// A part as it was to be molded, mm.
pub struct Unmolded {
    pub body: mesh::Mesh,
    pub why: String,
}

/// A connected piece of the part's surface.
struct Shell {
    triangles: Vec<usize>,
    /// Negative around a hollow.
    mm3: f64,
}

impl Shell {
    fn is_hollow(&self) -> bool {
        self.mm3 < 0.0
    }

    fn colour(&self) -> Rgb {
        if self.is_hollow() { HOLLOW } else { AROUND_MATERIAL }
    }
}

/// As undercut in the maps of molds: no half reaches a hollow.
const HOLLOW: Rgb = [148, 20, 84];
const AROUND_MATERIAL: Rgb = [166, 210, 236];

/// What is seen through so that the hollow inside shows.
const FAINT: f64 = 0.35;

/// The page's exhibit and chapter of a refusal.
pub fn shown(part: &Unmolded, id: &str) -> Result<(Exhibit, Chapter), Trouble> {
    let shells = shells(&part.body);
    let picture = picture(part, &shells, id).map_err(|e| Trouble::Word(format!("error: a picture: {e}")))?;
    let chapter = Chapter {
        tone: Tone::Bad,
        headline: format!("No mold of {id}."),
        words: vec![sentence(&part.why)],
        pictures: vec![picture],
        tables: vec![table(&part.body, &shells)],
        ..Chapter::default()
    };
    Ok((exhibit(part, &shells, id), chapter))
}

fn sentence(why: &str) -> String {
    let mut letters = why.chars();
    letters.next().map_or(String::new(), |c| format!("{}{}.", c.to_uppercase(), letters.as_str()))
}

/// The connected pieces of surface in the order of their first triangles, with their signed volumes.
fn shells(body: &mesh::Mesh) -> Vec<Shell> {
    let mut shell_of = Vec::new();
    let count = numbered(body, &mut shell_of);
    let mut all: Vec<Shell> = (0..count).map(|_| Shell { triangles: vec![], mm3: 0.0 }).collect();
    for (t, &s) in shell_of.iter().enumerate() {
        all[s].triangles.push(t);
    }
    for shell in &mut all {
        shell.mm3 = alone(body, &shell.triangles).volume();
    }
    all
}

/// Gives each triangle the number of its shell; triangles that share a corner share a shell.
fn numbered(body: &mesh::Mesh, shell_of: &mut Vec<usize>) -> usize {
    let mut at: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (t, corners) in body.triangles.iter().enumerate() {
        corners.iter().for_each(|v| at.entry(*v).or_default().push(t));
    }
    const NONE: usize = usize::MAX;
    *shell_of = vec![NONE; body.triangles.len()];
    let mut count = 0;
    for first in 0..shell_of.len() {
        if shell_of[first] != NONE {
            continue;
        }
        let mut left = vec![first];
        while let Some(t) = left.pop() {
            if shell_of[t] == NONE {
                shell_of[t] = count;
                left.extend(body.triangles[t].iter().flat_map(|v| &at[v]));
            }
        }
        count += 1;
    }
    count
}

fn alone(body: &mesh::Mesh, triangles: &[usize]) -> mesh::Mesh {
    let triangles = triangles.iter().map(|&t| body.triangles[t]).collect();
    mesh::Mesh { vertices: body.vertices.clone(), triangles }
}

/// A hollow as the solid that would fill it.
fn filled(body: &mesh::Mesh, shell: &Shell) -> Mesh {
    let mut plug = alone(body, &shell.triangles);
    plug.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    Mesh::of(&pictured::solid(&plug), CreaseAngle::default())
}

/// Pixels, as other figures of a page that stand in a text.
const PICTURE: (u32, u32) = (1000, 520);

fn picture(part: &Unmolded, shells: &[Shell], id: &str) -> Result<Picture, String> {
    let hollows = shells.iter().filter(|s| s.is_hollow()).count();
    let item = |s: &Shell| match s.is_hollow() {
        true => Item::new(Arc::new(filled(&part.body, s)), Colour::srgb(HOLLOW)),
        false => {
            let mesh = Mesh::of(&pictured::solid(&alone(&part.body, &s.triangles)), CreaseAngle::default());
            let opacity = if hollows > 0 { Opacity::Ghost { alpha: FAINT } } else { Opacity::Solid };
            Item { opacity, ..Item::new(Arc::new(mesh), Colour::srgb(AROUND_MATERIAL)) }
        }
    };
    let items = shells.iter().map(item).collect();
    let size = Size::new(PICTURE.0, PICTURE.1).map_err(|e| e.to_string())?;
    let inside = match hollows {
        0 => String::new(),
        1 => ", see-through, with the hollow inside it in dark red".into(),
        n => format!(", see-through, with {n} hollows inside it in dark red"),
    };
    Figure {
        name: "no-mold",
        scene: Scene { items, view: View::default(), background: Background::Transparent },
        alt: format!("{id}{inside}. {}", sentence(&part.why)),
        caption: format!("{id}{inside}."),
    }
    .picture(size)
    .map_err(|e| e.to_string())
}

fn named(k: usize, shell: &Shell) -> String {
    let what = if shell.is_hollow() { "around a hollow" } else { "around material" };
    format!("surface {}, {what}", k + 1)
}

fn exhibit(part: &Unmolded, shells: &[Shell], id: &str) -> Exhibit {
    let mut class_of = vec![0; part.body.triangles.len()];
    for (k, shell) in shells.iter().enumerate() {
        shell.triangles.iter().for_each(|&t| class_of[t] = k);
    }
    let ids: Vec<String> = shells.iter().enumerate().map(|(k, s)| named(k, s)).collect();
    let legend = shells.iter().zip(&ids).map(|(s, id)| (s.colour(), id.clone())).collect();
    let colours = shells.iter().map(Shell::colour).collect();
    let hollows: Vec<Mesh> = shells.iter().filter(|s| s.is_hollow()).map(|s| filled(&part.body, s)).collect();
    let buried = (!hollows.is_empty()).then(|| Buried {
        name: "Hollow inside",
        says: "What is shut in: no half and no core of a mold reaches it.".into(),
        colour: HOLLOW,
        meshes: hollows,
    });
    of_classes(Classed {
        name: format!("why there is no mold of {id}"),
        says: sentence(&part.why),
        mesh: Mesh::of(&pictured::solid(&part.body), CreaseAngle::default()),
        class_of,
        ids,
        schemes: vec![Scheme { name: "material and hollow", legend, colours }],
        ways: vec![],
        ways_say: String::new(),
        buried,
    })
}

fn table(body: &mesh::Mesh, shells: &[Shell]) -> Table {
    let row = |(k, s): (usize, &Shell)| {
        let mm2: f64 = s.triangles.iter().map(|&t| area(body.corners(t))).sum();
        vec![named(k, s), s.triangles.len().to_string(), format!("{mm2:.2}"), format!("{:.2}", s.mm3.abs())]
    };
    let head = vec![
        Column::words("surface"),
        Column::numbers("facets"),
        Column::numbers("mm²"),
        Column::numbers("mm³ inside"),
    ];
    Table { caption: "Surfaces of the part".into(), head, rows: shells.iter().enumerate().map(row).collect() }
}
