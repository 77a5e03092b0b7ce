//! Takes a job and its recipe; gives each part on its way to the file: its faces moved, on the master, as f32 can hold it.
//!
//! The exact move first, over coarser and coarser edges; where that fails the part is carved; where that fails too, it is
//! eroded on a lattice. Not promised: that more than one body, or none, is left. A piece with faults is not to be written,
//! and the gaps of the others are measured on their files.

use crate::bvh::Aabb;
use crate::files::{stems, stl};
use crate::findings;
use crate::ledger::Scale;
use crate::make::{MARGIN_IN_SNAPS, Piece, Recipe};
use crate::mesh::Mesh;
use crate::offset::lattice::{Off, eroded};
use crate::offset::{self, Aim, By, Failure, Known, Offset, Why};
use crate::print_face;
use crate::report::Finding;
use crate::shape::{Job, Role, Shape};
use crate::shave::Shaving;
use crate::solid::Solid;
use glam::DVec3;
use rayon::prelude::*;

/// The least altitude of a triangle, in snap distances: snapping moves three corners by one each, so that 4 can not turn
/// a triangle over.
const THINNEST_IN_SNAPS: f64 = 4.0;

/// Where the exact move fails, edges so many times longer are united first, and so many times: 0.02, 0.08, 0.32 and 1.28
/// of the depth. What a weld costs in clearance `relief` mends, and the gap is measured all the same.
const COARSER: (f64, usize) = (4.0, 3);

/// A part that is carved may leave too little room for one that was moved, which is then carved too; so often.
const CARVINGS: usize = 2;

pub(crate) fn pieces(job: &Job, recipe: &Recipe, snap: f64, scales: Vec<Scale>) -> Vec<Piece> {
    let mut known = Known::default();
    let mut aims: Vec<Aim> =
        job.parts.iter().map(|p| aim(recipe.process_of(&p.id).clearance.value, snap)).collect();
    let mut best = attempt(job, &aims, &scales, &mut known);
    for step in 0..COARSER.1 + CARVINGS {
        if best.iter().all(|p| p.faults.is_empty()) {
            break;
        }
        let next: Vec<Aim> =
            aims.iter().zip(&best).map(|(aim, piece)| harder(aim, &piece.faults, step)).collect();
        let mut again = attempt(job, &next, &scales, &mut known);
        tell(&next, &best, &mut again);
        aims = next;
        // What carving says of a part is the last word on it.
        if faulty(&again) < faulty(&best) + usize::from(step >= COARSER.1) {
            best = again;
        }
    }
    for p in 0..best.len() {
        if let Some(piece) = last_resort(job, p, &best, &aims) {
            best[p] = piece;
            alone(p, &mut best);
        }
    }
    shave(job, recipe, &mut best);
    best
}

/// Cuts print faces; parts stay the same solid with those alone that the same is done to.
fn shave(job: &Job, recipe: &Recipe, pieces: &mut [Piece]) {
    let roots: Vec<usize> = pieces.iter().map(|p| p.offset.same_as).collect();
    let shavings: Vec<Option<Shaving>> =
        job.parts.iter().map(|p| print_face::shaving(recipe.process_of(&p.id))).collect();
    for (p, piece) in pieces.iter_mut().enumerate() {
        let done = |q: usize| (roots[q], shavings[q]);
        piece.offset.same_as = (0..p).find(|&q| done(q) == done(p)).unwrap_or(p);
    }
    print_face::shave(job, &shavings, pieces);
}

fn aim(clearance: f64, snap: f64) -> Aim {
    let depth = clearance + MARGIN_IN_SNAPS * snap;
    let weld = depth * offset::REACH;
    Aim { depth, share: clearance + snap, thinnest: THINNEST_IN_SNAPS * snap, weld, by: By::Moving }
}

/// What to try next where that failed.
fn harder(aim: &Aim, faults: &[Finding], step: usize) -> Aim {
    match faults {
        [] => *aim,
        _ if step < COARSER.1 => Aim { weld: aim.weld * COARSER.0, ..*aim },
        _ => Aim { by: By::Carving, ..*aim },
    }
}

fn attempt(job: &Job, aims: &[Aim], scales: &[Scale], known: &mut Known) -> Vec<Piece> {
    let stems = stems(&job.parts.iter().map(|p| p.id.clone()).collect::<Vec<_>>());
    let all: Vec<_> = job.parts.iter().zip(stems).zip(offset::offset(job, aims, known)).zip(scales).collect();
    all.into_par_iter()
        .map(|(((part, stem), offset), scale)| piece(&part.id, stem, offset, scale.clone()))
        .collect()
}

/// Notes what is carved, and for what fault of the move.
fn tell(aims: &[Aim], before: &[Piece], pieces: &mut [Piece]) {
    for ((aim, before), piece) in aims.iter().zip(before).zip(pieces) {
        match aim.by {
            By::Carving if before.notes.is_empty() => {
                piece.notes.push(findings::of_carving(&piece.id, &before.faults, piece.offset.longest_move));
            }
            By::Carving => piece.notes = before.notes.clone(),
            By::Moving => {}
        }
    }
}

/// A faulty piece eroded on a lattice, or what is wrong with that: the last word on it.
fn last_resort(job: &Job, p: usize, pieces: &[Piece], aims: &[Aim]) -> Option<Piece> {
    let failed = &pieces[p];
    if failed.faults.is_empty() {
        return None;
    }
    let part = in_place(job, p, |_| true);
    // What came in wrong is told as that, not made of lattice; but where a body only touches itself, a clearance parts it.
    let came = stl::snapped(&part);
    if !came.is_pinched() && !findings::of_mesh(&failed.id, &came, &failed.scale).is_empty() {
        return None;
    }
    let mut failures = vec![];
    let (mesh, step) = match eroded(&part, &surroundings(job, p, &part, pieces, aims)) {
        Some(left) => (left.mesh, left.step),
        None => (Mesh::default(), 0.0),
    };
    if mesh.triangles.is_empty() {
        let at = part.vertices.iter().sum::<DVec3>() / part.vertices.len().max(1) as f64;
        failures.push(Failure { at, why: Why::Vanished });
    }
    let longest_move = offset::deepest(&mesh, &part);
    let offset = Offset { mesh, collapses: 0, longest_move, same_as: p, failures };
    let mut made = piece(&failed.id, failed.stem.clone(), offset, failed.scale.clone());
    if made.offset.failures.is_empty() {
        made.notes.push(findings::of_lattice(&failed.id, &failed.faults, step, longest_move));
    } else {
        made.faults.truncate(made.offset.failures.len());
    }
    Some(made)
}

/// No other part is the same solid as one that was made anew.
fn alone(p: usize, pieces: &mut [Piece]) {
    let same = |(_, other): &(usize, &mut Piece)| other.offset.same_as == p;
    pieces.iter_mut().enumerate().filter(same).for_each(|(q, other)| other.offset.same_as = q);
}

/// What a part is to keep off: its own contact faces, and the others near it as they are made. Those that are not made yet
/// keep off it in their turn, and for now it leaves them its own depth.
fn surroundings(job: &Job, p: usize, part: &Mesh, pieces: &[Piece], aims: &[Aim]) -> Vec<Off> {
    let faces = Off { surface: in_place(job, p, |r| *r != Role::Outer), by: aims[p].depth };
    let other = |q: usize| match pieces[q].faults[..] {
        [] => Off { surface: pieces[q].offset.mesh.clone(), by: aims[p].depth + aims[q].depth },
        _ => Off { surface: in_place(job, q, |_| true), by: aims[p].depth },
    };
    let place = Aabb::of(part.vertices.iter().copied());
    let near = |o: &Off| place.distance_squared(&Aabb::of(o.surface.vertices.iter().copied())) < o.by.powi(2);
    let others = (0..pieces.len()).filter(|&q| q != p).map(other).filter(near);
    std::iter::once(faces).chain(others).collect()
}

/// Facets of a part with these roles, in the assembly.
fn in_place(job: &Job, p: usize, which: impl Fn(&Role) -> bool) -> Mesh {
    let part = &job.parts[p];
    let shape = &job.shapes[part.shape];
    let facets = shape.facets.iter().zip(&part.roles).filter(|(_, r)| which(r)).map(|(f, _)| f.clone());
    let some = Shape { vertices: shape.vertices.clone(), facets: facets.collect() };
    some.mesh().map(|v| part.pose.transform_point3(v))
}

fn faulty(pieces: &[Piece]) -> usize {
    pieces.iter().filter(|p| !p.faults.is_empty()).count()
}

fn piece(id: &str, stem: String, offset: Offset, scale: Scale) -> Piece {
    let finished = offset.mesh.map(|v| scale.up(v));
    let mut master = stl::snapped(&finished);
    let mut faults = findings::of_mesh(id, &master, &scale);
    if !faults.is_empty() && offset.failures.is_empty() {
        // What f32 can not hold apart is united; where that makes no sound mesh, the first is told.
        let settled = Solid::of(&finished).ok().and_then(|s| stl::settled(&s)).map(|(mesh, _)| mesh);
        if let Some(sound) = settled.filter(|m| findings::of_mesh(id, m, &scale).is_empty()) {
            (master, faults) = (sound, vec![]);
        }
    }
    faults.splice(0..0, offset.failures.iter().map(|f| findings::of_failure(id, f)));
    Piece { id: id.to_string(), stem, scale, offset, laid: None, master, made: None, faults, notes: vec![] }
}
