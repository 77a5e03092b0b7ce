//! Takes an assembly in place; gives its hand, its parts' hands and groups, and the hands of pairs that touch.
//!
//! Promised for woven assemblies: what translations of the weave join is looked at once, so the cost follows the orbits.
//! Not promised: anything about parts that only come near each other.

use super::answer::{
    Agreement, BothHands, FindingAnswer, HandAnswer, Handedness, NeighboursAnswer, PartAnswer, ShapeAnswer,
    Touch,
};
use super::cloth::{self, Cloth, Shaped};
use super::draft::{Near, Set};
use super::judge::{self, Findings};
use super::kin;
use super::shape::{Scale, Shape};
use crate::assembly::woven::Woven;
use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::sites::Coincident;
use crate::spec::{MeshSpec, WovenSpec};
use crate::tile::Piece;
use glam::DAffine3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Everything about an assembly.
pub struct Of {
    pub whole: HandAnswer,
    pub parts: Vec<PartAnswer>,
    pub shapes: Vec<ShapeAnswer>,
    pub both_hands: BothHands,
    pub neighbours: Vec<NeighboursAnswer>,
    pub agreement: Agreement,
    pub findings: Vec<FindingAnswer>,
}

pub fn of_meshes(spec: &MeshSpec, assembly: &Assembly, patches: &[Patch]) -> Of {
    let tolerance = spec.tolerance_mm / spec.mm_per_unit;
    let scale = Scale { rounding: tolerance, resolution: tolerance };
    let shapes: Vec<Shape> =
        assembly.solids.par_iter().map(|s| Shape::new([(s, DAffine3::IDENTITY)], scale)).collect();
    let hands: Vec<HandAnswer> = shapes.par_iter().map(|s| judge::hand(s, scale, None)).collect();
    let whole = judge::hand(&whole(assembly, scale), scale, None);
    let compare = |i: usize, j: usize| judge::compare(&shapes[i], &shapes[j], scale, None);
    let pair = |&(a, b): &(PartIx, PartIx)| {
        let hand = judge::hand(&some(assembly, &[a, b], scale), scale, None);
        kin::told(ids(assembly, a, b), Touch::Meshes, &hand)
    };
    let neighbours = kin::touching(patches).par_iter().map(pair).collect();
    gathered(assembly, whole, &hands, compare, neighbours)
}

pub fn of_woven(spec: &WovenSpec, built: &Woven, patches: &[Patch]) -> Result<Of, Coincident> {
    let cloth = Cloth::new(&spec.weave, &spec.profile)?;
    let assembly = &built.assembly;
    let scale = cloth::scale(&assembly.solids, &spec.profile);
    let near: Vec<Near> = assembly.ids().map(|p| built.near(p).collect()).collect();
    let all: Near = near.iter().flatten().copied().collect();
    let set = Set { pieces: &built.pieces, near: &all };
    let symmetries = cloth.symmetries(set, set);
    let whole = judge::hand(&whole(assembly, scale), scale, Some((&symmetries, spec.profile.lift)));
    // Parts of one solid are translates of each other: any of them stands for all.
    let placed = |k: usize| {
        let p = assembly.ids().find(|&p| assembly.part(p).solid == k)?;
        let part = assembly.part(p);
        Some(cloth.placed(built.pieces[p.at()], &assembly.solids[k], part.pose, near[p.at()].clone()))
    };
    let shaped: Vec<Shaped> = (0..assembly.solids.len()).filter_map(placed).collect();
    let hands: Vec<HandAnswer> = shaped.par_iter().map(|s| cloth.hand(s)).collect();
    let compare = |i: usize, j: usize| cloth.compare(&shaped[i], &shaped[j]);
    let neighbours = neighbours(&cloth, built, patches, &near);
    Ok(gathered(assembly, whole, &hands, compare, neighbours))
}

fn gathered(
    assembly: &Assembly,
    whole: HandAnswer,
    hands: &[HandAnswer],
    compare: impl Fn(usize, usize) -> Findings,
    neighbours: Vec<NeighboursAnswer>,
) -> Of {
    let mut names = vec![Vec::new(); assembly.solids.len()];
    assembly.parts.iter().for_each(|p| names[p.solid].push(p.id.clone()));
    let words: Vec<Handedness> = hands.iter().map(|h| h.hand).collect();
    let groups = kin::groups(&names, &words, compare);
    let part = |p: &crate::assembly::Part| PartAnswer { id: p.id.clone(), hand: words[p.solid] };
    let told = hands.iter().map(|h| h.evidence.agreement).chain(neighbours.iter().map(|n| n.agreement));
    let agreement = told.fold(groups.agreement.max(whole.evidence.agreement), Agreement::max);
    let both_hands = groups.both_hands();
    let mut findings = groups.findings;
    let named = hands.iter().zip(&names).map(|(h, n)| (n.first().cloned().unwrap_or_default(), &h.why));
    let pairs = neighbours.iter().map(|n| (format!("{} and {}", n.a, n.b), &n.why));
    let all = std::iter::once(("the assembly".to_string(), &whole.why)).chain(named).chain(pairs);
    findings.extend(all.filter_map(|(at, why)| Some(FindingAnswer { at, what: why.clone()? })));
    let parts = assembly.parts.iter().map(part).collect();
    Of { whole, parts, shapes: groups.shapes, both_hands, neighbours, agreement, findings }
}

/// The hands of pairs; pairs that a translation of the weave joins have one hand.
fn neighbours(cloth: &Cloth, built: &Woven, patches: &[Patch], near: &[Near]) -> Vec<NeighboursAnswer> {
    let assembly = &built.assembly;
    let pieces = |(a, b): (PartIx, PartIx)| [built.pieces[a.at()], built.pieces[b.at()]];
    let key = |pair: (PartIx, PartIx)| {
        let [a, b] = pieces(pair);
        let (_, (dx, dy)) = cloth.lattice.canonical(a.start());
        [a, b].map(|p| p.moved((-dx, -dy)))
    };
    let touching = kin::touching(patches);
    let mut first: BTreeMap<[Piece; 2], (PartIx, PartIx)> = BTreeMap::new();
    for &pair in &touching {
        first.entry(key(pair)).or_insert(pair);
    }
    let hand = |(key, &pair): (&[Piece; 2], &(PartIx, PartIx))| {
        let scale = cloth::scale([assembly.solid(pair.0), assembly.solid(pair.1)], cloth.profile);
        let both: Near = near[pair.0.at()].union(&near[pair.1.at()]).copied().collect();
        let own = pieces(pair);
        let set = Set { pieces: &own, near: &both };
        let symmetries = cloth.symmetries(set, set);
        let shape = some(assembly, &[pair.0, pair.1], scale);
        (*key, judge::hand(&shape, scale, Some((&symmetries, cloth.profile.lift))))
    };
    let hands: BTreeMap<[Piece; 2], HandAnswer> =
        first.iter().collect::<Vec<_>>().into_par_iter().map(hand).collect();
    let told = |&pair: &(PartIx, PartIx)| {
        let [a, b] = pieces(pair);
        let touch = match () {
            () if a.strand.kind != b.strand.kind => Touch::Crossing,
            () if a.strand == b.strand => Touch::EndToEnd,
            () => Touch::Beside,
        };
        hands.get(&key(pair)).map(|hand| kin::told(ids(assembly, pair.0, pair.1), touch, hand))
    };
    touching.iter().filter_map(told).collect()
}

fn ids(assembly: &Assembly, a: PartIx, b: PartIx) -> (&str, &str) {
    (&assembly.part(a).id, &assembly.part(b).id)
}

/// All parts in place.
pub fn whole(assembly: &Assembly, scale: Scale) -> Shape {
    some(assembly, &assembly.ids().collect::<Vec<_>>(), scale)
}

fn some(assembly: &Assembly, parts: &[PartIx], scale: Scale) -> Shape {
    let chosen: BTreeSet<PartIx> = parts.iter().copied().collect();
    Shape::new(chosen.into_iter().map(|p| (assembly.solid(p), assembly.part(p).pose)), scale)
}
