//! Takes an assembly and the moves of a plan; gives the figure of one step as the parts are put together.
//!
//! Not promised: that a step can be done; the plan says so, and `verify` checks it.

use super::camera::View;
use super::figures::{Figure, extent};
use super::glyph;
use super::hidden::seen;
use super::image::Size;
use super::palette::{self, Colour};
use super::scene::{Item, Opacity, Scene};
use crate::assembly::Assembly;
use crate::report::moves::{self, Motion, Move, Mover, Way, displacements, on_table};
use crate::solid::Solid;
use glam::{DAffine3, DVec3};
use std::collections::BTreeSet;

/// The step that is `number` (from 1) in the order of assembly: what moves stands where it comes from, with an arrow, what
/// it joins in place; parts that are not on the table are left out. Where what moves would be hidden from that view, the
/// parts that stay are seen through.
pub fn step(asm: &Assembly, all: &[Move], number: usize, view: View) -> Option<Figure> {
    let at = all.len().checked_sub(number)?;
    let one = all.get(at)?;
    let before = displacements(all, asm.parts.len(), at as f64);
    let far = displacements(all, asm.parts.len(), (at + 1) as f64);
    let mut scene = Scene::of(asm, view);
    let placed = |k: usize, d: &[DAffine3]| Item { pose: d[k] * asm.parts[k].pose, ..scene.items[k].clone() };
    let mut shown: Vec<usize> = on_table(one).collect();
    shown.sort_unstable();
    let items: Vec<Item> = shown.iter().map(|&k| placed(k, &far)).collect();
    let near: Vec<Item> = one.movers.iter().flat_map(|m| &m.parts).map(|&k| placed(k, &before)).collect();
    scene.items = items;
    let size = extent(&scene);
    let signs = one.movers.iter().flat_map(|m| sign(m, asm, &far, size));
    let signs: Vec<Item> = signs.map(|s| Item::sign(&s, Colour::srgb(palette::MOTION))).collect();
    let arrows = signs.len();
    scene.items.extend(signs);
    // The camera leaves room for where the parts go to.
    scene.items.extend(near.into_iter().map(|i| Item { opacity: Opacity::Hidden, ..i }));
    let movers: BTreeSet<usize> = one.movers.iter().flat_map(|m| &m.parts).copied().collect();
    see_through(&mut scene, &shown, arrows, &movers);
    let ids: Vec<&str> = asm.parts.iter().map(|p| p.id.as_str()).collect();
    let words = moves::told(one, &ids, asm.mm_per_unit, Way::Together);
    Some(Figure {
        name: "step",
        scene,
        alt: format!("Step {number}: {words}, with an arrow."),
        caption: format!("{number}. {words}."),
    })
}

/// Pixels of the small picture on which it is counted how much of the movers is seen.
const COUNTED: (u32, u32) = (240, 180);
/// Of what moves at least one part in this many is to be seen.
const SEEN_PART: usize = 3;
/// What a part keeps that is seen through: with three of them before it a mover still shows by half (0.8 cubed).
const FAINT: f64 = 0.2;

/// Makes what stays faint where it hides what moves, or its arrow; item `k` is part `shown[k]`, after the parts come
/// `signs` arrows.
fn see_through(scene: &mut Scene, shown: &[usize], signs: usize, movers: &BTreeSet<usize>) {
    let (moving, staying): (Vec<usize>, Vec<usize>) =
        (0..shown.len()).partition(|&k| movers.contains(&shown[k]));
    let Ok(size) = Size::new(COUNTED.0, COUNTED.1) else { return };
    let arrows: Vec<usize> = (shown.len()..shown.len() + signs).collect();
    let hidden = |items: &[usize]| {
        let seen = seen(scene, size, items);
        seen.here * SEEN_PART < seen.alone
    };
    if hidden(&moving) || hidden(&arrows) {
        staying.into_iter().for_each(|k| scene.items[k].opacity = Opacity::Ghost { alpha: FAINT });
    }
}

/// Length of an arrow, and the gap before what it pushes, in the scene's longest side; its shaft's radius in its length.
const LENGTH: f64 = 0.22;
const GAP: f64 = 0.025;
const SHAFT: f64 = 0.06;
/// Largest turn that an arrow shows, radians: more would close on itself.
const MOST_TURN: f64 = 4.5;

/// The arrows of a motion, run backward, on what has come by it.
fn sign(mover: &Mover, asm: &Assembly, far: &[DAffine3], size: f64) -> Vec<Solid> {
    let points: Vec<DVec3> = (mover.parts.iter())
        .flat_map(|&k| asm.solid(crate::assembly::PartIx(k as u32)).vertices.iter().map(move |v| (k, v)))
        .map(|(k, v)| (far[k] * asm.parts[k].pose).transform_point3(*v))
        .collect();
    let arrow = match mover.motion {
        Motion::Translation { by } => push(&points, by, size),
        Motion::Screw { point, axis, angle, advance } => {
            let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
            let foot = point + axis * axis.dot(middle - point);
            let bow = points.iter().map(|p| (*p - foot).reject_from(axis).length()).fold(0.0, f64::max) * 0.8;
            let turn = (-angle).clamp(-MOST_TURN, MOST_TURN);
            let bent = glyph::turning_arrow(foot, axis, bow.max(size * 0.05), turn, size * LENGTH * SHAFT);
            return bent.into_iter().chain(push(&points, axis * advance, size)).collect();
        }
    };
    arrow.into_iter().collect()
}

/// An arrow that pushes at the far end of what has come by `away`.
fn push(points: &[DVec3], away: DVec3, size: f64) -> Option<Solid> {
    let along = away.try_normalize()?;
    let middle = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
    let far = points.iter().map(|p| (*p - middle).dot(along)).reduce(f64::max)?;
    let tip = middle + along * (far + size * GAP);
    glyph::arrow(tip + along * size * LENGTH, tip, size * LENGTH * SHAFT)
}
