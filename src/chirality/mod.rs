//! Takes a weave or an assembly; gives the hands of tile, strands and assembly, from the solids and from the draft.
//!
//! Sound: `achiral`, `left`, `right` and `warp_is` are told only where the search on the solids (complete up to round-off)
//! and the symmetries of the draft agree; else the answer is undecided and states both. For meshes there is no draft and
//! the user's tolerance stands for round-off. Not promised: that every chiral shape can be named left or right.
//!
//! Tiles are cut at phase 0, where the strand comes up, wefts and warps alike. One cut corresponds to the other: a weft
//! tile of `[a,b,c]` reads a overs, b unders; read backwards and upside down that is b overs, a unders, which is the warp
//! tile from where it comes up. So no other phase of the warp need be tried there: what carries a weft tile to another
//! cut of the warp can be followed by that reversal. Drafts with several runs in a period may differ; where phase 0 finds
//! nothing, the other cuts that the draft allows are tried and told as `other_phases`, apart from `warp_is`.

pub mod answer;
mod cloth;
pub mod draft;
pub mod isometry;
mod judge;
mod moment;
mod shape;

use crate::assembly::Assembly;
use crate::contact::{Joined, Origin};
use crate::sites::Coincident;
use crate::spec::{ProfileSpec, Spec, Subject, WovenSpec};
use crate::tile::{Piece, TileError};
use crate::weave::{Draft, Family, Hand, Kind, Weave, family};
use answer::{CONVENTION, HandAnswer, Handedness, Hands, PairAnswer, PartAnswer, TileAnswer, WarpIs};
use cloth::{Cloth, Shaped};
use shape::{Scale, Shape};

/// Why there are no tiles to look at.
#[derive(Debug, thiserror::Error)]
pub enum HandsError {
    #[error(transparent)]
    Sites(#[from] Coincident),
    #[error(transparent)]
    Tile(#[from] TileError),
}

/// The hands of the unit tiles of a weave.
pub fn of_weave(weave: &Weave, profile: &ProfileSpec) -> Result<Hands, HandsError> {
    let cloth = Cloth::new(weave, profile)?;
    let shaped = cloth.shaped(&cloth.units())?;
    let tiles: Vec<TileAnswer> = shaped.iter().map(|s| cloth.tile_answer(s)).collect();
    let (wefts, warps): (Vec<&Shaped>, Vec<&Shaped>) =
        shaped.iter().partition(|s| s.piece.strand.kind == Kind::Weft);
    let pairs = warps.iter().flat_map(|warp| wefts.iter().map(|weft| cloth.pair_answer(weft, warp, 0)));
    let strands: Vec<PairAnswer> = pairs.collect();
    let warp_is = cloth::overall(&strands, wefts.len());
    let mut other_phases = Vec::new();
    if warp_is == WarpIs::Different {
        for warp in &warps {
            other_phases.extend(cloth.other_phases(&wefts, warp)?);
        }
    }
    let remarks = several(&tiles, wefts.len());
    let twill = twill(&weave.draft);
    Ok(Hands {
        tile: tiles.first().map(|t| t.hand.hand),
        warp_is: Some(warp_is),
        twill,
        tiles,
        strands,
        other_phases,
        remarks,
        ..empty()
    })
}

/// The hands of an assembly, `joined` from `spec`; of a woven one those of its weave's unit tiles too.
pub fn of_assembly(spec: &Spec, joined: &Joined) -> Result<Hands, HandsError> {
    let assembly = &joined.assembly;
    let name = assembly.name.clone();
    match (&spec.subject, &joined.origin) {
        (Subject::Woven(woven), Origin::Woven(built)) => {
            let (whole, parts) = woven_hands(woven, assembly, &built.pieces)?;
            let hands = of_weave(&woven.weave, &woven.profile)?;
            Ok(Hands { name, assembly: Some(whole.hand), assembly_evidence: Some(whole), parts, ..hands })
        }
        (Subject::Meshes(meshes), _) => {
            let tolerance = meshes.tolerance_mm / meshes.mm_per_unit;
            let scale = Scale { rounding: tolerance, resolution: tolerance };
            let whole = judge::hand(&whole(assembly, scale), scale, None);
            let alone = |k: usize| {
                judge::hand(
                    &Shape::new([(&assembly.solids[k], glam::DAffine3::IDENTITY)], scale),
                    scale,
                    None,
                )
            };
            let solids: Vec<Handedness> = (0..assembly.solids.len()).map(|k| alone(k).hand).collect();
            let parts = parts(assembly, &solids);
            Ok(Hands { name, assembly: Some(whole.hand), assembly_evidence: Some(whole), parts, ..empty() })
        }
        (Subject::Woven(_), Origin::Meshes) => Ok(Hands { name, ..empty() }),
    }
}

fn empty() -> Hands {
    Hands {
        verb: "chirality".into(),
        name: String::new(),
        tile: None,
        warp_is: None,
        assembly: None,
        twill: None,
        tiles: Vec::new(),
        strands: Vec::new(),
        other_phases: Vec::new(),
        assembly_evidence: None,
        parts: Vec::new(),
        convention: CONVENTION.into(),
        remarks: Vec::new(),
    }
}

fn woven_hands(
    woven: &WovenSpec,
    assembly: &Assembly,
    pieces: &[Piece],
) -> Result<(HandAnswer, Vec<PartAnswer>), Coincident> {
    let cloth = Cloth::new(&woven.weave, &woven.profile)?;
    let scale = cloth::scale(&assembly.solids, &woven.profile);
    let symmetries = cloth.symmetries(pieces, pieces);
    let whole = judge::hand(&whole(assembly, scale), scale, Some((&symmetries, woven.profile.lift)));
    // Parts of one solid are translates of each other: any of them stands for all.
    let one = |k: usize| assembly.parts.iter().zip(pieces).find(|(part, _)| part.solid == k);
    let hand = |k: usize| {
        one(k).map(|(part, &piece)| cloth.hand(&cloth.placed(piece, &assembly.solids[k], part.pose)).hand)
    };
    let solids: Vec<Handedness> =
        (0..assembly.solids.len()).map(|k| hand(k).unwrap_or(Handedness::Undecided)).collect();
    Ok((whole, parts(assembly, &solids)))
}

fn whole(assembly: &Assembly, scale: Scale) -> Shape {
    Shape::new(assembly.parts.iter().map(|p| (&assembly.solids[p.solid], p.pose)), scale)
}

fn parts(assembly: &Assembly, solids: &[Handedness]) -> Vec<PartAnswer> {
    let answer = |p: &crate::assembly::Part| PartAnswer { id: p.id.clone(), hand: solids[p.solid] };
    assembly.parts.iter().map(answer).collect()
}

fn twill(draft: &Draft) -> Option<Hand> {
    match family(draft) {
        Family::Twill { hand, .. } => Some(hand),
        _ => None,
    }
}

/// A word where `tile` does not speak for all wefts.
fn several(tiles: &[TileAnswer], wefts: usize) -> Vec<String> {
    let more = |n: usize| {
        format!("the draft has {n} different weft tiles; `tile` is that of weft 0, `tiles` has all")
    };
    (wefts > 1).then(|| more(wefts)).into_iter().filter(|_| !tiles.is_empty()).collect()
}
