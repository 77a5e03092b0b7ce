//! Takes a ready part; gives its rigid mold in two halves; one that no two free goes on to `more_parts`.
//!
//! Not promised: that zero draft releases by itself; how much of it there is, is said.

use crate::files::stl;
use crate::mesh::Mesh;
use crate::mold::checks::CAVITY_SHARE;
use crate::mold::fill;
use crate::mold::layout::{self, Around};
use crate::mold::make::{self, Cast, Settled, blank, extra, finding, push_all, source};
use crate::mold::parting;
use crate::mold::pictures;
use crate::mold::prepare::Ready;
use crate::mold::rigid::{self, Tools};
use crate::mold::{Extra, Kind, Mold, MoldError, MoldSpec, Parting, Piece, Step, Volume, more_parts, scad};
use crate::report::{Finding, Severity};
use crate::solid::{NotSolid, Solid};
use glam::DVec3;

pub fn mold(part: &Mesh, ready: Ready, spec: &MoldSpec) -> Result<Mold, MoldError> {
    let (filled, grown) = filled(&ready)?;
    if ready.pull.undercut_reach_mm > spec.figures.snap.value && grown.is_none() {
        return more_parts::mold(part, ready, spec);
    }
    let plan = layout::plan(
        &ready.framed.mesh,
        ready.plane.height,
        &ready.tops,
        &spec.figures,
        Around::printed(&spec.figures),
    );
    let mut mold = blank(&ready, spec, plan, spec.figures.draft.value);
    mold.filled_mm3 = grown;
    mold.findings.extend(undercut_finding(&mold, grown));
    let cavity = filled.as_ref().unwrap_or(&ready.solid);
    let below = below(&mold, cavity, &ready)?;
    let tools = rigid::Tools::of(&mold.plan, &spec.figures)?;
    let halves = rigid::halves(cavity, &below, &mold.plan, &tools)?;
    let casts = halves.map(|(name, solid, pull)| Cast { name, kind: Kind::Half, solid, pull });
    let (settled, aside) = rayon::join(|| make::settled(&casts), || aside(&mold, cavity));
    push_all(&mut mold, &casts, settled);
    finish(mold, cavity, aside?, &tools)
}

/// How much wider the steps of the file for OpenSCAD are, mm: so that two that meet in an edge overlap.
const FAT: f64 = 0.02;

/// Everything below the parting surface.
pub fn below(mold: &Mold, cavity: &Solid, ready: &Ready) -> Result<Solid, NotSolid> {
    parting::below((mold.plan.low, mold.plan.high), cavity, &ready.plane, ready.framed.snap, 0.0)
}

/// What needs no piece of the mold, and takes as long as they do.
pub struct Aside {
    /// Everything below a stepped parting, for a file that is read by itself.
    below: Option<(Solid, Settled)>,
    maps: Extra,
}

/// `plain`: the cavity without undercuts.
pub fn aside(mold: &Mold, plain: &Solid) -> Result<Aside, NotSolid> {
    let settled = |s: Option<Solid>| {
        s.map(|s| {
            let mesh = stl::settled(&s);
            (s, mesh)
        })
    };
    let (below, maps) = rayon::join(|| stepped(mold, plain).map(settled), || pictures::maps(mold));
    Ok(Aside { below: below?, maps })
}

/// The rest of a rigid mold that has its pieces: sources, volumes, steps, pictures.
pub fn finish(mut mold: Mold, cavity: &Solid, aside: Aside, tools: &Tools) -> Result<Mold, MoldError> {
    let opened = pictures::opened(&mold);
    mold.pieces.push(source("part", Kind::Part, &mold.part));
    if let Some((solid, settled)) = aside.below {
        make::keep(&mut mold, ("below", Kind::Below), (&solid, settled), DVec3::ZERO, 0);
    }
    mold.findings.extend(draft_finding(&mold));
    mold.extras.push(aside.maps);
    let channels = tools.above.minus(cavity).common(&Solid::of(&mold.part_box())?);
    mold.volumes.push(Volume { of: "cavity".into(), mm3: cavity.volume(), grams: None });
    mold.volumes.push(Volume { of: "channels and slots".into(), mm3: channels.volume(), grams: None });
    mold.steps = steps(&mold);
    match scad::lacking(&mold) {
        None => extra(&mut mold, "scad", scad::rigid),
        Some(what) => {
            let what = format!("there is no OpenSCAD source: {what} has detail that f32 can not hold apart");
            let remedy = "the STL files are whole without it";
            let found = finding(&mold, Severity::Note, vec![], what, remedy);
            mold.findings.push(found);
        }
    }
    mold.extras.push(opened);
    Ok(mold)
}

fn stepped(mold: &Mold, cavity: &Solid) -> Result<Option<Solid>, NotSolid> {
    let Some(Parting::Stepped { height_mm, off_mm2 }) = mold.parting else { return Ok(None) };
    let plane = parting::Plane { height: height_mm, wrong: off_mm2 };
    parting::below((mold.plan.low, mold.plan.high), cavity, &plane, mold.snap, FAT).map(Some)
}

/// The keys of a mold, in words.
pub fn keys(mold: &Mold) -> String {
    let (f, tip) = (&mold.figures, rigid::KEY_TIP * mold.figures.key_diameter.value);
    let (wide, high, air) = (f.key_diameter.value, f.key_height.value, f.key_clearance.value);
    format!(
        "{} keys fit one way only (cones of {wide} mm at the foot and {tip} mm at the tip, {high} mm high, with {air} mm of air)",
        mold.plan.keys.len()
    )
}

fn steps(mold: &Mold) -> Vec<Step> {
    let (f, plan) = (&mold.figures, &mold.plan);
    let cores: Vec<&Piece> = mold.pieces.iter().filter(|p| p.kind == Kind::Core).collect();
    let names = cores.iter().map(|p| p.name.as_str()).collect::<Vec<_>>().join(", ");
    let prints = if cores.is_empty() { "both halves" } else { "both halves and the side cores" };
    let mut does = vec![
        format!("print {prints}; seal the faces of the cavity, coat them with release agent"),
        format!(
            "close the halves: the {}; screws through the {} holes of {} mm",
            keys(mold),
            plan.bolts.len(),
            f.bolt.value
        ),
        format!(
            "stand it with the upper half on top; pour into the widest hole ({} mm) until it stands in the {} vents of {} mm",
            f.sprue.value,
            plan.vents.len(),
            f.vent.value
        ),
        "when it has cured, take the screws out and pry at the slots: the halves leave straight".to_string(),
    ];
    if !cores.is_empty() {
        does.insert(
            2,
            format!("push the cores in until they sit in their taper: {names}, the last named first"),
        );
        let way = |p: &&Piece| format!("{} along {:.2}", p.name, p.pull);
        let ways = cores.iter().map(way).collect::<Vec<_>>().join(", then ");
        does.insert(
            4,
            format!("when it has cured, pull the cores out straight by their grips, in this order: {ways}"),
        );
    }
    let step =
        |does: String| Step { does, hours: None, celsius: None, source: "geometry of this mold".into() };
    does.into_iter().map(step).collect()
}

/// The part with its undercuts filled, where they are within what the cavity may be off; and how much came to it.
fn filled(ready: &Ready) -> Result<(Option<Solid>, Option<f64>), MoldError> {
    if !ready.blocked.is_real() {
        return Ok((None, Some(0.0)));
    }
    // Worth trying only where the air can be little: its volume is at least that of the overlaps' own columns.
    if ready.pull.undercut_reach_mm > WORTH_FILLING {
        return Ok((None, None));
    }
    let (solid, grown) = fill::fill(&ready.solid, &ready.framed.mesh, &ready.blocked)?;
    let little = grown <= CAVITY_SHARE / 2.0 * ready.solid.volume();
    Ok(if little { (Some(solid), Some(grown)) } else { (None, None) })
}

/// Undercuts wider than this are features, mm, not slips of the facets: a tenth of the finest nozzle.
const WORTH_FILLING: f64 = 0.04;

/// Where the largest undercut facet is.
pub fn worst_undercut(mold: &Mold) -> Vec<DVec3> {
    let worst = mold.maps.undercut_mm2.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    worst.map(|(t, _)| mold.part.corners(t).iter().sum::<DVec3>() / 3.0).into_iter().collect()
}

fn undercut_finding(mold: &Mold, grown: Option<f64>) -> Option<Finding> {
    let at = worst_undercut(mold);
    let (area, wide) = (mold.pull.undercut_mm2, mold.pull.undercut_reach_mm);
    match grown {
        Some(g) if g > 0.0 => Some(finding(
            mold,
            Severity::Note,
            at,
            format!(
                "{area:.4} mm2 of undercut, at most {wide:.4} mm wide, are filled in the cavity ({g:.6} mm3)"
            ),
            "nothing to do: it is below what the cavity may be off",
        )),
        None if area > 0.0 => Some(finding(
            mold,
            Severity::Warning,
            at,
            format!(
                "{area:.3} mm2 of undercut, at most {wide:.3} mm wide, stay: the casting must snap over them"
            ),
            "take the silicone route where the cast material is stiff",
        )),
        _ => None,
    }
}

fn draft_finding(mold: &Mold) -> Option<Finding> {
    let (low, least) = (mold.maps.low_draft_mm2, mold.figures.draft.value);
    (low > 0.0).then(|| {
        let what = format!("{low:.1} mm2 of the part have less than {least} degrees of draft along the pull");
        finding(
            mold,
            Severity::Warning,
            vec![],
            what,
            "use a release agent, or the silicone route, which needs no draft",
        )
    })
}
