//! Takes two shapes and the symmetries of the draft that should carry one to the other; gives evidence and verdicts.
//!
//! A sense of isometry (proper, improper) is told to exist or not only where solids and draft agree. Where the draft has
//! one, its own map must meet the corners within the resolution of the sites; where it has none, the search on the
//! solids must have found none, not even one that meets in corners alone.

use super::answer::{
    Agreement, Evidence, HandAnswer, Handedness, IsometryAnswer, Measure, SymmetryAnswer, WarpIs,
};
use super::draft::{Reach, Symmetry};
use super::isometry::{self, Found, Search, corner_residual};
use super::moment::{self, PseudoScalar, Triangles};
use super::shape::{Scale, Shape};
use glam::{DAffine3, DMat3, DVec3};

/// The draft's word: its symmetries, and the height of an over above an under.
pub type Drafted<'a> = Option<(&'a [(Symmetry, Reach)], f64)>;

/// Whether isometries of one sense exist.
pub enum Sense {
    Exists,
    Absent,
    Unclear(String),
}

/// What was found, with the verdict for each sense.
pub struct Findings {
    pub evidence: Evidence,
    proper: Sense,
    improper: Sense,
}

/// Isometries from `a` to `b`.
pub fn compare(a: &Shape, b: &Shape, scale: Scale, drafted: Drafted) -> Findings {
    let search = isometry::search(a, b, scale.rounding);
    let draft = drafted.map(|(symmetries, lift)| {
        let answer = |(s, reach): &(Symmetry, Reach)| {
            let residual = corner_residual(a, b, &affine(s, lift), scale.resolution);
            symmetry_answer(s, *reach, residual)
        };
        symmetries.iter().map(answer).collect::<Vec<_>>()
    });
    let sense = |proper| sense(proper, search.as_ref(), draft.as_deref(), scale);
    let (is, is_not) = (sense(true), sense(false));
    let agreement = agreement([&is, &is_not], search.is_some(), draft.is_some());
    let search = search.unwrap_or_default();
    let isometries = search.found.iter().map(isometry_answer).collect();
    let evidence = Evidence {
        isometries,
        draft,
        agreement,
        tried: search.tried,
        within: search.within,
        resolution: scale.resolution,
    };
    Findings { evidence, proper: is, improper: is_not }
}

/// The draft's symmetry as it is told.
pub fn symmetry_answer(s: &Symmetry, reach: Reach, residual: Option<f64>) -> SymmetryAnswer {
    let reach = if reach == Reach::Weave { "weave" } else { "surroundings" };
    SymmetryAnswer { proper: s.is_proper(), map: s.text(), residual, reach: reach.into() }
}

/// What the two sources are to each other; what is unclear with both at hand is a disagreement.
pub fn agreement(senses: [&Sense; 2], searched: bool, drafted: bool) -> Agreement {
    match (searched, drafted) {
        (_, false) => Agreement::SolidsAlone,
        (false, true) => Agreement::DraftAlone,
        _ if senses.iter().any(|s| matches!(s, Sense::Unclear(_))) => Agreement::Disagree,
        _ => Agreement::Agree,
    }
}

pub fn sense(proper: bool, search: Option<&Search>, draft: Option<&[SymmetryAnswer]>, scale: Scale) -> Sense {
    let word = if proper { "proper" } else { "improper" };
    let some = |list: &[Found]| list.iter().any(|f| f.is_proper() == proper);
    let found = search.is_some_and(|s| some(&s.found));
    let best = search.and_then(|s| {
        s.found.iter().filter(|f| f.is_proper() == proper).map(|f| f.residual).reduce(f64::min)
    });
    let loose = search.is_some_and(|s| some(&s.loose));
    let drafted = draft.map(|d| d.iter().filter(|s| s.proper == proper).collect::<Vec<_>>());
    match drafted.as_deref() {
        None | Some([]) if search.is_none() => {
            Sense::Unclear("the solid has too few clear corners to place it by".into())
        }
        // Without a draft the tolerance is the user's: within it points meet; within what errors of that size can add up
        // to, nobody can tell; beyond they do not.
        None if best.is_some_and(|r| r <= scale.rounding) => Sense::Exists,
        None if found => Sense::Unclear(format!(
            "under {word} isometries points miss by {:.3e}: more than the tolerance {:.3e}, less than {:.3e}, to which such \
             errors can add up",
            best.unwrap_or_default(),
            scale.rounding,
            search.map_or(0.0, |s| s.within)
        )),
        None if loose => Sense::Unclear(format!(
            "under {word} isometries all corners meet, but the faces are divided otherwise"
        )),
        Some([]) if found || loose => {
            Sense::Unclear(format!("the solids have {word} isometries, the draft has none"))
        }
        None | Some([]) => Sense::Absent,
        Some(list) if found || list.iter().any(|s| s.residual.is_some()) => Sense::Exists,
        Some(_) => Sense::Unclear(format!(
            "the draft has {word} isometries, but under them corners of the solids miss by more than {:.1e}",
            scale.resolution
        )),
    }
}

impl Findings {
    /// How `b` follows from `a`, and why that is undecided where it is.
    pub fn kinship(&self) -> (WarpIs, Option<String>) {
        match (&self.proper, &self.improper) {
            (Sense::Unclear(why), _) | (_, Sense::Unclear(why)) => (WarpIs::Undecided, Some(why.clone())),
            (Sense::Exists, Sense::Exists) => (WarpIs::Both, None),
            (Sense::Exists, Sense::Absent) => (WarpIs::Same, None),
            (Sense::Absent, Sense::Exists) => (WarpIs::Mirror, None),
            (Sense::Absent, Sense::Absent) => (WarpIs::Different, None),
        }
    }
}

/// The hand of a shape.
pub fn hand(shape: &Shape, scale: Scale, drafted: Drafted) -> HandAnswer {
    let Findings { evidence, improper, .. } = compare(shape, shape, scale, drafted);
    let (hand, measure, why) = match improper {
        Sense::Exists => (Handedness::Achiral, None, None),
        Sense::Unclear(why) => (Handedness::Undecided, None, Some(why)),
        Sense::Absent => named(shape, scale),
    };
    HandAnswer { hand, measure, why, evidence }
}

/// How many integrals over the body enter a pseudo-scalar as factors, at most (M three times, and the outer one).
const FACTORS: f64 = 4.0;

/// The hand of a chiral shape: the sign of the first pseudo-scalar that is more than round-off.
pub fn named(shape: &Shape, scale: Scale) -> (Handedness, Option<Measure>, Option<String>) {
    let (scalars, round_off) = scalars(shape, scale);
    let part = |p: &PseudoScalar| if p.size > 0.0 { p.value / p.size } else { 0.0 };
    let Some(p) = scalars.iter().find(|p| part(p).abs() > round_off) else {
        let why = "chiral, but the error of the points could turn the sign of every pseudo-scalar, so the hand has no \
                   name; for meshes a smaller tolerance may give it one"
            .into();
        return (Handedness::Undecided, None, Some(why));
    };
    let hand = if p.value > 0.0 { Handedness::Right } else { Handedness::Left };
    (hand, Some(Measure { integrand: p.name.into(), value: part(p), round_off }), None)
}

/// The pseudo-scalars of a shape, and how far each may be off, in its size.
pub fn scalars(shape: &Shape, scale: Scale) -> ([PseudoScalar; 3], f64) {
    let (volume, centroid) = moment::centroid(&shape.triangles);
    // A boundary that is off by e changes an integral over the body by e times one over the boundary: relative to the
    // body's about e area / volume.
    let round_off = FACTORS * scale.rounding * area(&shape.triangles) / volume;
    (moment::pseudo_scalars(&shape.triangles, centroid), round_off)
}

fn area(triangles: &Triangles) -> f64 {
    triangles.iter().map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum()
}

pub fn isometry_answer(found: &Found) -> IsometryAnswer {
    let rows = found.map.matrix3.transpose();
    IsometryAnswer {
        proper: found.is_proper(),
        linear: [rows.x_axis, rows.y_axis, rows.z_axis].map(|r| r.to_array()),
        shift: found.map.translation.to_array(),
        residual: found.residual,
    }
}

/// A symmetry of the weave in space; an over at height `lift`, an under at 0.
pub fn affine(s: &Symmetry, lift: f64) -> DAffine3 {
    let sign = |against: bool| if against { -1.0 } else { 1.0 };
    let (u, v) = if s.exchange { (DVec3::Y, DVec3::X) } else { (DVec3::X, DVec3::Y) };
    let rows = [sign(s.against[0]) * u, sign(s.against[1]) * v, sign(s.upside_down) * DVec3::Z];
    let up = if s.upside_down { lift } else { 0.0 };
    let shift = DVec3::new(f64::from(s.shift[0]), f64::from(s.shift[1]), up);
    DAffine3::from_mat3_translation(DMat3::from_cols(rows[0], rows[1], rows[2]).transpose(), shift)
}
