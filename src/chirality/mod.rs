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
mod fabric;
pub mod isometry;
mod judge;
mod kin;
mod moment;
mod parts;
mod shape;
pub mod twin;

use crate::contact::{Joined, Origin};
use crate::sites::Coincident;
use crate::spec::{ProfileSpec, Spec, Subject};
use crate::tile::TileError;
use crate::weave::{Draft, Family, Hand, Kind, Weave, family};
use answer::{Agreement, CONVENTION, FindingAnswer, Handedness, Hands, PairAnswer, TileAnswer, WarpIs};
use cloth::{Cloth, Shaped};
use parts::Of;

/// Why there are no tiles to look at.
#[derive(Debug, thiserror::Error)]
pub enum HandsError {
    #[error(transparent)]
    Sites(#[from] Coincident),
    #[error(transparent)]
    Tile(#[from] TileError),
}

/// The hands of the unit tiles of a weave, and of the weave itself.
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
    let names: Vec<Vec<String>> = shaped.iter().map(|s| vec![s.piece.strand.to_string()]).collect();
    let hands: Vec<Handedness> = tiles.iter().map(|t| t.hand.hand).collect();
    let groups = kin::groups(&names, &hands, |i, j| cloth.compare(&shaped[i], &shaped[j]));
    let whole = fabric::cloth(&cloth, &shaped)?;
    let told = tiles.iter().map(|t| &t.hand.evidence).chain(strands.iter().map(|p| &p.evidence));
    let told = told.chain(whole.iter().map(|c| &c.hand.evidence)).map(|e| e.agreement);
    Ok(Hands {
        tile: tiles.first().map(|t| t.hand.hand),
        warp_is: Some(warp_is),
        assembly: whole.as_ref().map(|c| c.hand.hand),
        assembly_is: "endless weave, strands uncut".into(),
        both_hands: Some(groups.both_hands()),
        agreement: told.fold(groups.agreement, Agreement::max),
        findings: findings(&tiles, &strands, whole.as_ref()),
        twill: twill(&weave.draft),
        remarks: several(&tiles, wefts.len()),
        shapes: groups.shapes,
        cloth: whole,
        tiles,
        strands,
        other_phases,
        ..empty()
    })
}

/// Whatever is undecided, with its place.
fn findings(
    tiles: &[TileAnswer],
    strands: &[PairAnswer],
    cloth: Option<&answer::ClothAnswer>,
) -> Vec<FindingAnswer> {
    let of_tiles = tiles.iter().map(|t| (format!("tile of {}", t.strand), &t.hand.why));
    let of_pairs = strands.iter().map(|p| (format!("{} against {}", p.warp, p.weft), &p.why));
    let of_cloth = cloth.map(|c| ("endless weave".to_string(), &c.hand.why));
    let all = of_tiles.chain(of_pairs).chain(of_cloth);
    all.filter_map(|(at, why)| Some(FindingAnswer { at, what: why.clone()? })).collect()
}

/// The hands of an assembly, `joined` from `spec`; of a woven one those of its weave's unit tiles too.
pub fn of_assembly(spec: &Spec, joined: &Joined) -> Result<Hands, HandsError> {
    let assembly = &joined.assembly;
    let of = match (&spec.subject, &joined.origin) {
        (Subject::Woven(woven), Origin::Woven(built)) => parts::of_woven(woven, built, &joined.patches)?,
        (Subject::Meshes(meshes), _) => parts::of_meshes(meshes, assembly, &joined.patches),
        (Subject::Woven(_), Origin::Meshes) => return Ok(Hands { name: assembly.name.clone(), ..empty() }),
    };
    let weave = match &spec.subject {
        Subject::Woven(woven) => of_weave(&woven.weave, &woven.profile)?,
        Subject::Meshes(_) => empty(),
    };
    let Of { whole, parts, shapes, both_hands, neighbours, agreement, findings } = of;
    // Of a woven assembly the unit tiles are told beside; for meshes there is nothing beside.
    let agreement = if weave.tiles.is_empty() { agreement } else { agreement.max(weave.agreement) };
    Ok(Hands {
        name: assembly.name.clone(),
        assembly: Some(whole.hand),
        assembly_is: "parts in place".into(),
        both_hands: Some(both_hands),
        agreement,
        findings: findings.into_iter().chain(weave.findings.iter().cloned()).collect(),
        assembly_evidence: Some(whole),
        parts,
        shapes,
        neighbours,
        ..weave
    })
}

fn empty() -> Hands {
    Hands {
        verb: "chirality".into(),
        name: String::new(),
        tile: None,
        warp_is: None,
        assembly: None,
        assembly_is: String::new(),
        both_hands: None,
        agreement: Agreement::SolidsAlone,
        findings: Vec::new(),
        cloth: None,
        twill: None,
        tiles: Vec::new(),
        strands: Vec::new(),
        other_phases: Vec::new(),
        assembly_evidence: None,
        parts: Vec::new(),
        shapes: Vec::new(),
        neighbours: Vec::new(),
        twin: None,
        convention: CONVENTION.into(),
        remarks: Vec::new(),
    }
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
