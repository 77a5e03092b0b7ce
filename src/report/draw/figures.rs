//! Takes an assembly, and what was found about it; gives the figures that page and README show.
//!
//! Not promised: that a figure proves anything; forces and motions are drawn from the certificates as they are given.

use super::camera::{Projection, View};
use super::glyph;
use super::image::Size;
use super::palette::{self, Colour};
use super::render;
use super::scene::{Item, Opacity, Scene};
use crate::assembly::{Assembly, PartIx};
use crate::locking::{Motion, Stress};
use crate::report::content::{Format, Picture};
use crate::report::words::movers;
use glam::DVec3;
use std::io;

/// A scene with its words.
#[derive(Clone, Debug)]
pub struct Figure {
    /// For a file's name: lower case and hyphens.
    pub name: &'static str,
    pub scene: Scene,
    /// What a reader who does not see it is told.
    pub alt: String,
    pub caption: String,
}

impl Figure {
    /// The figure drawn, ready for a page.
    pub fn picture(&self, size: Size) -> Result<Picture, io::Error> {
        Ok(Picture {
            format: Format::Png(render(&self.scene, size).png()?),
            width: size.width(),
            height: size.height(),
            alt: self.alt.clone(),
            caption: self.caption.clone(),
        })
    }
}

/// How far parts move apart in an exploded view, in their distance from the middle: room to see between them.
const APART: DVec3 = DVec3::new(1.3, 1.3, 0.6);
/// What see-through parts keep: one alone, enough to see what it is; all of them, little enough to see three behind one
/// another (0.8 cubed lets half the light through).
const ONE_GHOST: f64 = 0.36;
const ALL_GHOSTS: f64 = 0.2;

/// All parts in place.
pub fn together(assembly: &Assembly) -> Figure {
    Figure {
        name: "together",
        scene: Scene::of(assembly, View::default()),
        alt: format!(
            "{}: {} in place, seen from above at an angle.",
            assembly.name,
            count(assembly.parts.len())
        ),
        caption: "In place.".into(),
    }
}

/// All parts but one, which is see-through; in the same view as [`together`].
pub fn without(assembly: &Assembly, part: PartIx) -> Figure {
    let id = assembly.parts.get(part.at()).map_or("no part", |p| p.id.as_str());
    Figure {
        name: "without",
        scene: Scene::of(assembly, View::default()).with(part, Opacity::Ghost { alpha: ONE_GHOST }),
        alt: format!("{}: the same view with {id} see-through.", assembly.name),
        caption: format!("{id} taken away to show what it holds."),
    }
}

/// Parts moved apart from their common middle.
pub fn exploded(assembly: &Assembly) -> Figure {
    Figure {
        name: "exploded",
        scene: Scene::of(assembly, View::default()).exploded(APART),
        alt: format!("{}: its parts moved apart.", assembly.name),
        caption: "Moved apart, only to show the shapes; no part can go this way unless the plan says so."
            .into(),
    }
}

/// One part alone.
pub fn alone(assembly: &Assembly, part: PartIx) -> Figure {
    let id = assembly.parts.get(part.at()).map_or("no part", |p| p.id.as_str());
    let mut scene = Scene::of(assembly, View::default());
    scene.items = scene.items.get(part.at()).cloned().into_iter().collect();
    Figure { name: "part", scene, alt: format!("The part {id} alone."), caption: format!("{id}.") }
}

/// From straight above, as a draft is drawn.
pub fn plan_view(assembly: &Assembly) -> Figure {
    Figure {
        name: "above",
        scene: Scene::of(assembly, View::PLAN),
        alt: format!("{}: seen from straight above.", assembly.name),
        caption: "From above: x to the right, y up, as in the draft.".into(),
    }
}

/// A motion that can start: an arrow for each part that moves, at its reference point.
pub fn moving(assembly: &Assembly, motion: &Motion) -> Figure {
    let movers = movers(motion);
    let mut scene = faint(assembly);
    let size = extent(&scene) * 0.3;
    // Twists are drawn to one scale; the fastest point a part's own size away fills a sign.
    let speed = |t: DVec3, w: DVec3| t.length().max(w.length() * size / 2.0);
    let fastest =
        movers.iter().map(|(_, t)| speed(t.translation, t.rotation)).fold(f64::MIN_POSITIVE, f64::max);
    for (p, _) in &movers {
        scene = scene.with(*p, Opacity::Ghost { alpha: ONE_GHOST });
    }
    for (_, t) in &movers {
        let length = size * speed(t.translation, t.rotation) / fastest;
        let signs = glyph::motion(t.centre, t.translation, t.rotation, length);
        scene.items.extend(signs.iter().map(|s| Item::sign(s, Colour::srgb(palette::MOTION))));
    }
    let ids: Vec<&str> = movers.iter().map(|(p, _)| assembly.part(*p).id.as_str()).collect();
    Figure {
        name: "motion",
        scene,
        alt: format!(
            "{}: see-through parts with an arrow on each that starts to move: {}.",
            assembly.name,
            ids.join(", ")
        ),
        caption: "The motion that can start: straight arrows shift, bent arrows turn.".into(),
    }
}

/// The largest contact forces of a self-stress, at most [`MOST_FORCES`], each pushing on part `b` of its contact.
pub fn forces(assembly: &Assembly, stress: &Stress) -> Figure {
    let mut scene = faint(assembly);
    let size = extent(&scene) * 0.16;
    let mut largest: Vec<_> = stress.forces.iter().collect();
    largest.sort_by(|a, b| b.size.total_cmp(&a.size));
    largest.truncate(MOST_FORCES);
    let most = largest.first().map_or(1.0, |f| f.size);
    for f in &largest {
        let length = size * (f.size / most).sqrt();
        let tail = f.row.point - f.row.normal * length;
        let sign = glyph::arrow(tail, f.row.point, size * 0.05);
        scene.items.extend(sign.map(|s| Item::sign(&s, Colour::srgb(palette::FORCE))));
    }
    let (shown, all) = (largest.len(), stress.forces.len());
    Figure {
        name: "forces",
        scene,
        alt: format!(
            "{}: see-through parts with arrows for the {shown} largest contact forces.",
            assembly.name
        ),
        caption: format!(
            "The {shown} largest of {all} contact forces in balance; an arrow's length goes with the root of its force."
        ),
    }
}

/// More arrows than this hide each other.
pub const MOST_FORCES: usize = 60;

fn faint(assembly: &Assembly) -> Scene {
    let view = View { projection: Projection::Orthographic, ..View::default() };
    let mut scene = Scene::of(assembly, view);
    scene.items.iter_mut().for_each(|i| i.opacity = Opacity::Ghost { alpha: ALL_GHOSTS });
    scene
}

/// Longest side of the box around all items.
pub(super) fn extent(scene: &Scene) -> f64 {
    let points = || scene.items.iter().flat_map(Item::points);
    let lo = points().fold(DVec3::INFINITY, DVec3::min);
    let hi = points().fold(DVec3::NEG_INFINITY, DVec3::max);
    let longest = (hi - lo).max_element();
    if longest.is_finite() { longest } else { 1.0 }
}

fn count(parts: usize) -> String {
    if parts == 1 { "one part".into() } else { format!("{parts} parts") }
}
