//! Takes a scene and some of its items; gives how much of them is seen, against how much would be if they were alone.
//!
//! Counted in samples of a small picture. Not promised: a verdict on what a viewer makes of it.

use super::camera::Camera;
use super::image::Size;
use super::layer::{Layer, NOTHING, Stage};
use super::scene::{Opacity, Scene};

/// Samples of a picture, of the items that were asked about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// In the scene, behind what is solid.
    pub here: usize,
    /// Without the rest.
    pub alone: usize,
}

/// What is seen of the items with these numbers.
pub fn seen(scene: &Scene, size: Size, items: &[usize]) -> Seen {
    let camera = Camera::fit(&scene.view, scene.items.iter().flat_map(|i| i.points()), size);
    let stage = Stage::of(scene, &camera, 1);
    let asked = |k: u32| items.contains(&(k as usize));
    let solid = |k: u32| scene.items[k as usize].opacity == Opacity::Solid;
    let count = |keep: &dyn Fn(u32) -> bool| {
        let layer = drawn(&stage, size, keep);
        let hit = layer.nearest.iter().filter(|&&t| t != NOTHING && asked(stage.triangles[t as usize].item));
        hit.count()
    };
    Seen { here: count(&|k| asked(k) || solid(k)), alone: count(&asked) }
}

fn drawn(stage: &Stage, size: Size, keep: &dyn Fn(u32) -> bool) -> Layer {
    let mut layer = Layer::empty(0..size.width() as usize, 0..i64::from(size.height()), stage.tie);
    for (k, f) in stage.triangles.iter().enumerate().filter(|(_, f)| keep(f.item)) {
        layer.draw(k as u32, &f.seen);
    }
    layer
}
