//! Takes pieces as made; cuts and chamfers the print faces of those whose own shape is printed.
//!
//! Congruent pieces are laid on the same face, so that they stay one solid. Not promised: that all of them do; where cutting one
//! there fails it is laid by itself, and is then another solid.

use crate::findings;
use crate::make::Piece;
use crate::package::laying::{Laying, again, lay};
use crate::process::Process;
use crate::shape::Job;
use crate::shave::{self, Shaving};
use rayon::prelude::*;

/// What is taken off parts of a process; `None` where nothing is.
pub fn shaving(process: &Process) -> Option<Shaving> {
    let print = &process.print;
    let what = Shaving { flatten: print.flatten.value, chamfer: print.elephant_foot.value };
    (!what.is_off() && process.route.prints_the_shape()).then_some(what)
}

/// Slice and chamfer of what is printed in the part's own shape; pieces that are alike have the same shaving.
pub fn shave(job: &Job, shavings: &[Option<Shaving>], pieces: &mut [Piece]) {
    let layings = layings(job, pieces, shavings);
    pieces.par_iter_mut().zip(shavings).zip(layings).enumerate().for_each(|(p, ((piece, what), laying))| {
        let (Some(what), Some(laying)) = (what, laying) else { return };
        if piece.offset.same_as == p || !is_cut(*what, &laying, piece) {
            let own = if piece.offset.same_as == p { laying } else { lay(&piece.master) };
            piece.offset.same_as = p;
            cut(*what, &own, piece);
        }
    });
}

/// How sound parts that are shaved lie, congruent ones alike.
fn layings(job: &Job, pieces: &[Piece], shavings: &[Option<Shaving>]) -> Vec<Option<Laying>> {
    let sound = |p: usize| shavings[p].is_some() && pieces[p].faults.is_empty();
    let own = |p: usize| (sound(p) && pieces[p].offset.same_as == p).then(|| lay(&pieces[p].master));
    let firsts: Vec<Option<Laying>> = (0..pieces.len()).into_par_iter().map(own).collect();
    let laying = |p: usize| {
        let (piece, first) = (&pieces[p], pieces[p].offset.same_as);
        match &firsts[first] {
            _ if !sound(p) => None,
            Some(laying) if first == p => Some(*laying),
            Some(laying) => {
                let [there, here] = [first, p].map(|q| job.parts[q].pose.matrix3);
                let down = here * (there.transpose() * laying.down);
                Some(again(&piece.master, &Laying { down, ..*laying }))
            }
            None => Some(lay(&piece.master)),
        }
    };
    (0..pieces.len()).into_par_iter().map(laying).collect()
}

/// Whether the piece was cut so and is sound; else it stays as it was.
fn is_cut(what: Shaving, laying: &Laying, piece: &mut Piece) -> bool {
    let Ok(master) = shave::shaved(&piece.master, laying, what) else { return false };
    let sound = findings::of_mesh(&piece.id, &master, &piece.scale).is_empty();
    if sound {
        (piece.laid, piece.master) = (Some(again(&master, laying)), master);
    }
    sound
}

fn cut(what: Shaving, laying: &Laying, piece: &mut Piece) {
    match shave::shaved(&piece.master, laying, what) {
        Ok(master) => {
            piece.faults.extend(findings::of_mesh(&piece.id, &master, &piece.scale));
            (piece.laid, piece.master) = (Some(again(&master, laying)), master);
        }
        Err(why) => piece.notes.push(findings::of_shaving(&piece.id, &why)),
    }
}
