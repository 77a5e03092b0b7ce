//! Takes a scene and a size; gives an SVG: the shading as an embedded image, outlines and creases over it as vectors.
//!
//! Promised: the same bytes every time; a line runs where a facet that meets the edge is seen beside it (by identity of
//! the facet in the samples there, not by distance). Not promised: ends finer than a sample, of which two go to a pixel.

use super::camera::Camera;
use super::image::Size;
use super::ink::Pens;
use super::layer::{Layer, NOTHING, Stage};
use super::mesh::{Edge, EdgeKind, Mesh};
use super::paint::{Pen, render_with};
use super::palette::INK;
use super::scene::{Item, Opacity, Scene};
use crate::report::viewer::base64;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::io;

/// Samples along a pixel's side for what is seen.
const FINE: usize = 2;
/// Longest side in pixels: the samples of 4,096 x 4,096 pixels take 800 MB, and vectors scale anyway.
pub const LONGEST: u32 = 4096;

/// The SVG; `title` is what a reader who does not see it is told.
pub fn svg(scene: &Scene, size: Size, title: &str) -> io::Result<String> {
    if size.width().max(size.height()) > LONGEST {
        let what = format!("an SVG is drawn up to {LONGEST} pixels to a side; it scales to any size");
        return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    }
    let (w, h) = (size.width(), size.height());
    let image = base64(&render_with(scene, size, Pen::None).png()?);
    let title = title.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let ink = format!("#{:02x}{:02x}{:02x}", INK[0], INK[1], INK[2]);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\">\n\
         <title>{title}</title>\n<image width=\"{w}\" height=\"{h}\" href=\"data:image/png;base64,{image}\"/>\n\
         <g fill=\"none\" stroke=\"{ink}\" stroke-linecap=\"round\">\n"
    );
    for stroke in strokes(scene, size) {
        let Stroke { width, strength, path } = stroke;
        let _ = writeln!(
            out,
            "<path stroke-width=\"{width:.2}\" stroke-opacity=\"{strength:.2}\" d=\"{path}\"/>"
        );
    }
    out.push_str("</g>\n</svg>\n");
    Ok(out)
}

/// Lines of one width and strength.
struct Stroke {
    width: f64,
    strength: f64,
    path: String,
}

/// How much of the surface a crease's ink covers, as in the images.
const CREASE_INK: f64 = 0.6;

fn strokes(scene: &Scene, size: Size) -> Vec<Stroke> {
    let camera = Camera::fit(&scene.view, scene.items.iter().flat_map(|i| i.points()), size);
    let stage = Stage::of(scene, &camera, FINE);
    let pens = Pens::of(size.width().min(size.height()), 1);
    let solid = layer(&stage, size, |i| scene.items[i as usize].opacity == Opacity::Solid);
    let mut all = Vec::new();
    let is_solid = |i: &Item| i.opacity == Opacity::Solid;
    let numbers = |keep: &dyn Fn(&Item) -> bool| -> Vec<u32> {
        (0u32..).zip(&scene.items).filter(|(_, i)| keep(i)).map(|(k, _)| k).collect()
    };
    let page = Page { scene, camera: &camera, stage: &stage, pens };
    all.extend(page.lines(&solid, &numbers(&is_solid), 1.0));
    let ghosts = numbers(&|i| matches!(i.opacity, Opacity::Ghost { .. }));
    let lines_of = |&k: &u32| {
        let Opacity::Ghost { alpha } = scene.items[k as usize].opacity else { return vec![] };
        let mut own = alone(&stage, size, k);
        own.hide_behind(&solid);
        page.lines(&own, &[k], alpha.clamp(0.0, 1.0).sqrt()).into()
    };
    let drawn: Vec<Vec<Stroke>> = ghosts.par_iter().map(lines_of).collect();
    all.extend(drawn.into_iter().flatten());
    all.retain(|s| !s.path.is_empty());
    all
}

/// What is seen of one item where no other is, in a window that holds it with a sample to spare on each side.
fn alone(stage: &Stage, size: Size, item: u32) -> Layer {
    let (all, own) = (&stage.triangles, stage.of_item(item));
    let (mut lo, mut hi) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    for p in all[own.clone()].iter().flat_map(|f| f.seen) {
        (lo, hi) = (lo.min(p.truncate()), hi.max(p.truncate()));
    }
    let most = [size.width(), size.height()].map(|n| i64::from(n) * FINE as i64);
    // Nothing is seen of an item without triangles: its window is empty (infinite bounds end at the picture's border).
    let span = |lo: f64, hi: f64, most: i64| {
        let from = (lo.floor() - 1.0).clamp(0.0, most as f64) as i64;
        from..((hi.ceil() + 1.0).clamp(0.0, most as f64) as i64).max(from)
    };
    let (columns, rows) = (span(lo.x, hi.x, most[0]), span(lo.y, hi.y, most[1]));
    let mut layer = Layer::empty(columns.start as usize..columns.end as usize, rows, stage.tie);
    for k in own {
        layer.draw(k as u32, &all[k].seen);
    }
    layer
}

fn layer(stage: &Stage, size: Size, keep: impl Fn(u32) -> bool) -> Layer {
    let (w, h) = (size.width() as usize * FINE, i64::from(size.height()) * FINE as i64);
    let mut layer = Layer::empty(0..w, 0..h, stage.tie);
    for (k, f) in stage.triangles.iter().enumerate().filter(|(_, f)| keep(f.item)) {
        layer.draw(k as u32, &f.seen);
    }
    layer
}

struct Page<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    stage: &'a Stage,
    pens: Pens,
}

impl Page<'_> {
    /// The seen stretches of the edges of some items: outlines, then creases.
    fn lines(&self, layer: &Layer, items: &[u32], strength: f64) -> [Stroke; 2] {
        let (mut outline, mut crease) = (String::new(), String::new());
        for &k in items {
            let item = &self.scene.items[k as usize];
            let around = around(&item.mesh);
            for edge in &item.mesh.edges {
                let path = match self.drawn(item, edge) {
                    Some(Kind::Outline) => &mut outline,
                    Some(Kind::Crease) => &mut crease,
                    None => continue,
                };
                // A facet may be finer than a sample: any that meets an end of the edge shows that it is seen.
                let [a, b] = edge.ends.map(|v| &around[v as usize]);
                let near = Near { item: k, facets: a.union(b).copied().collect() };
                self.stretches(layer, edge, &near, path);
            }
        }
        [
            Stroke { width: self.pens.outline * 2.0, strength, path: outline },
            Stroke { width: self.pens.crease * 2.0, strength: strength * CREASE_INK, path: crease },
        ]
    }

    /// A line where the surface turns away from the viewer, or where two seen facets meet at a crease.
    fn drawn(&self, item: &Item, edge: &Edge) -> Option<Kind> {
        let ends = edge.ends.map(|v| item.place(item.mesh.vertices[v as usize]));
        let middle = self.camera.project((ends[0] + ends[1]) / 2.0);
        let along = self.camera.ray(middle.x, middle.y).1;
        let front =
            edge.facets.map(|f| item.pose.transform_vector3(item.mesh.facets[f as usize]).dot(along) < 0.0);
        match (front, edge.kind) {
            ([false, false], _) => None,
            ([true, true], EdgeKind::Crease) if edge.facets[0] != edge.facets[1] => Some(Kind::Crease),
            ([true, true], EdgeKind::Smooth) => None,
            _ => Some(Kind::Outline),
        }
    }

    /// Adds the stretches of an edge beside which one of the facets near it is seen.
    fn stretches(&self, layer: &Layer, edge: &Edge, near: &Near, path: &mut String) {
        let item = &self.scene.items[near.item as usize];
        let [a, b] = edge.ends.map(|v| self.camera.project(item.place(item.mesh.vertices[v as usize])));
        let steps = ((b - a).truncate().length() * FINE as f64).ceil().max(1.0) as usize;
        let at = |s: usize| a + (b - a) * (s as f64 / steps as f64);
        let mut from: Option<usize> = None;
        for s in 0..=steps + 1 {
            let seen = s <= steps && self.seen(layer, near, at(s));
            match (from, seen) {
                (None, true) => from = Some(s),
                (Some(f), false) => {
                    let (p, q) = (at(f), at(s - 1));
                    if f + 1 < s || steps == 1 {
                        let _ = write!(path, "M{:.1} {:.1}L{:.1} {:.1}", p.x, p.y, q.x, q.y);
                    }
                    from = None;
                }
                _ => {}
            }
        }
    }

    fn seen(&self, layer: &Layer, near: &Near, p: DVec3) -> bool {
        let (x, y) = ((p.x * FINE as f64).floor() as i64, (p.y * FINE as f64).floor() as i64);
        let own = |cell: u32| {
            let f = &self.stage.triangles[cell as usize];
            let facet = self.scene.items[f.item as usize].mesh.triangles[f.triangle as usize].facet;
            f.item == near.item && near.facets.contains(&facet)
        };
        (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy))).any(|(x, y)| {
            let cell = usize::try_from(x).ok().and_then(|x| layer.at(x, y)).map(|k| layer.nearest[k]);
            cell.is_some_and(|cell| cell != NOTHING && own(cell))
        })
    }
}

/// Facets of an item that meet an edge or one of its ends.
struct Near {
    item: u32,
    facets: Vec<u32>,
}

/// The facets around each vertex.
fn around(mesh: &Mesh) -> Vec<BTreeSet<u32>> {
    let mut all = vec![BTreeSet::new(); mesh.vertices.len()];
    for edge in &mesh.edges {
        edge.ends.iter().for_each(|v| all[*v as usize].extend(edge.facets));
    }
    all
}

#[derive(Clone, Copy)]
enum Kind {
    Outline,
    Crease,
}
