//! Takes a woven spec; gives its pieces in place, one solid for each orbit, and who each facet faces.
//!
//! Promised: pieces of one orbit under the draft's translations share one solid, so geometry costs what the orbits
//! cost. Not promised: that the swatch hangs together or that every piece touches another.

use super::{Assembly, Mobility, Part, PartIx};
use crate::fault::{Fault, Faults};
use crate::sites::{Owner, Site, Sites};
use crate::spec::{HeldSpec, ProfileSpec, Spec, WovenSpec};
use crate::tile::{self, Across, Lattice, Piece, Tile};
use crate::weave::{Kind, Strand, Weave};
use glam::{DAffine3, DVec3};
use std::collections::{BTreeMap, BTreeSet};

/// A woven assembly with what its geometry knows about contacts.
pub struct Woven {
    pub assembly: Assembly,
    /// The piece of each part.
    pub pieces: Vec<Piece>,
    /// What the sites were sampled from.
    pub weave: Weave,
    pub profile: ProfileSpec,
    sites: Sites,
    /// For each solid and facet: its own site and what it faces, in the solid's frame.
    across: Vec<Vec<(Site, Across)>>,
    /// Shift in whole crossings of each part from its solid's frame.
    shifts: Vec<(i32, i32)>,
    /// The parts along each strand: from, to, part.
    along: BTreeMap<Strand, Vec<(i32, i32, PartIx)>>,
}

/// The assembly that a spec describes; `spec` gives faults their place in the file.
pub fn build(spec: &Spec, woven: &WovenSpec) -> Result<Woven, Faults> {
    let pieces = super::layout::pieces(woven);
    let ids = ids(&pieces);
    let held = held(spec, woven, &pieces, &ids)?;
    let profile_fault = |what: String| {
        let hint = "change [profile]: a wider rise or a lower lift keeps a strand clear of itself, more samples follow it closer";
        Faults::from(spec.fault("profile", what, hint))
    };
    let sites = Sites::new(&woven.weave, &woven.profile).map_err(|e| profile_fault(e.to_string()))?;
    let lattice = Lattice::new(&woven.weave.draft);
    let placed: Vec<(Piece, (i32, i32))> = pieces.iter().map(|p| representative(&lattice, *p)).collect();
    let orbits: Vec<Piece> = placed.iter().map(|p| p.0).collect::<BTreeSet<_>>().into_iter().collect();
    let tiles = tile::tiles(&sites, &lattice, &orbits).map_err(|e| profile_fault(e.to_string()))?;
    let parts = ids.into_iter().zip(&placed).zip(held).map(|((id, (piece, shift)), mobility)| {
        let solid = orbits.binary_search(piece).unwrap_or(0);
        let pose = DAffine3::from_translation(DVec3::new(f64::from(shift.0), f64::from(shift.1), 0.0));
        Part { id, solid, pose, mobility }
    });
    let parts = parts.collect();
    let (solids, across) = tiles.into_iter().map(|Tile { solid, across, .. }| (solid, across)).unzip();
    let assembly = Assembly { name: spec.name.clone(), solids, parts, mm_per_unit: woven.pitch_mm };
    let shifts = placed.into_iter().map(|p| p.1).collect();
    let (weave, profile) = (woven.weave.clone(), woven.profile.clone());
    Ok(Woven { along: along(&pieces), assembly, pieces, weave, profile, sites, across, shifts })
}

/// The piece of the same orbit that starts in a representative square, and the shift from it to the piece.
fn representative(lattice: &Lattice, piece: Piece) -> (Piece, (i32, i32)) {
    let (_, shift) = lattice.canonical(piece.start());
    (piece.moved((-shift.0, -shift.1)), shift)
}

/// `weft-J` or `warp-I`, with `/N` along the strand where it has several pieces.
fn ids(pieces: &[Piece]) -> Vec<String> {
    let along = along(pieces);
    let id = |(k, p): (usize, &Piece)| {
        let mates = &along[&p.strand];
        let at = mates.iter().position(|m| m.2.at() == k).unwrap_or(0);
        if mates.len() > 1 { format!("{}/{at}", p.strand) } else { p.strand.to_string() }
    };
    pieces.iter().enumerate().map(id).collect()
}

fn along(pieces: &[Piece]) -> BTreeMap<Strand, Vec<(i32, i32, PartIx)>> {
    let mut along: BTreeMap<Strand, Vec<_>> = BTreeMap::new();
    for (k, p) in pieces.iter().enumerate() {
        along.entry(p.strand).or_default().push((p.from, p.to, PartIx(k as u32)));
    }
    along.values_mut().for_each(|v| v.sort_unstable());
    along
}

fn held(spec: &Spec, woven: &WovenSpec, pieces: &[Piece], ids: &[String]) -> Result<Vec<Mobility>, Faults> {
    let mobility = |held: bool| if held { Mobility::Held } else { Mobility::Free };
    match &woven.held {
        HeldSpec::None => Ok(vec![Mobility::Free; ids.len()]),
        HeldSpec::Rim => Ok(rim(pieces).into_iter().map(mobility).collect()),
        HeldSpec::Parts(names) => {
            let missing =
                |(k, name): (usize, &String)| (!ids.contains(name)).then(|| no_such_part(spec, k, name, ids));
            let faults: Vec<Fault> = names.iter().enumerate().filter_map(missing).collect();
            Faults(faults).or(ids.iter().map(|id| mobility(names.contains(id))).collect())
        }
    }
}

fn no_such_part(spec: &Spec, k: usize, name: &str, ids: &[String]) -> Fault {
    let some = ids.iter().take(8).cloned().collect::<Vec<_>>().join(", ");
    let more = if ids.len() > 8 { format!(" ... ({} in all)", ids.len()) } else { String::new() };
    let key = if spec.places.get(&format!("swatch.held[{k}]")).is_some() { "swatch.held" } else { "held" };
    spec.fault(
        &format!("{key}[{k}]"),
        format!("no part is called `{name}`"),
        format!("the parts are {some}{more}"),
    )
}

/// The edge of a swatch: its outermost strands of each kind, and the first and last piece of a strand of several.
fn rim(pieces: &[Piece]) -> Vec<bool> {
    let along = along(pieces);
    let range = |kind: Kind| {
        let all = || along.keys().filter(|s| s.kind == kind).map(|s| s.index);
        (all().min(), all().max())
    };
    let (wefts, warps) = (range(Kind::Weft), range(Kind::Warp));
    let at_edge = |(k, p): (usize, &Piece)| {
        let (first, last) = if p.strand.kind == Kind::Weft { wefts } else { warps };
        let mates = &along[&p.strand];
        let end = |m: Option<&(i32, i32, PartIx)>| m.is_some_and(|m| m.2.at() == k);
        let outermost = Some(p.strand.index) == first || Some(p.strand.index) == last;
        outermost || mates.len() > 1 && (end(mates.first()) || end(mates.last()))
    };
    pieces.iter().enumerate().map(at_edge).collect()
}

impl Woven {
    /// The part's sites and those that they face.
    pub fn near(&self, part: PartIx) -> impl Iterator<Item = Site> + '_ {
        let (dx, dy) = self.shifts[part.at()];
        let faced =
            self.across[self.assembly.part(part).solid].iter().filter_map(|(_, across)| match across {
                Across::Site(s) => Some(*s),
                Across::Face(_) => None,
            });
        let faced = faced.map(move |s| Site { x: s.x + dx, y: s.y + dy, ..s });
        faced.chain(tile::of_piece(&self.sites, self.pieces[part.at()]))
    }

    /// For each facet of a part's solid: the part that it touches, if any.
    pub fn faced(&self, part: PartIx) -> impl Iterator<Item = Option<PartIx>> + '_ {
        let (dx, dy) = self.shifts[part.at()];
        self.across[self.assembly.part(part).solid].iter().map(move |(_, across)| match across {
            Across::Site(s) => self.part_of(Site { x: s.x + dx, y: s.y + dy, ..*s }),
            Across::Face(_) => None,
        })
    }

    fn part_of(&self, site: Site) -> Option<PartIx> {
        match self.sites.owner(site) {
            Owner::Strand { strand, crossing } => {
                let mates = self.along.get(&strand)?;
                let next = mates.partition_point(|m| m.0 <= crossing);
                mates[..next].last().filter(|m| crossing < m.1).map(|m| m.2)
            }
            Owner::Plane(_) => None,
        }
    }
}
