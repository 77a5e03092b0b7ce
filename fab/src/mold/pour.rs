//! Takes a ready part; gives the prints for its silicone mold, and what to pour.
//!
//! Not promised: that silicone gives way over every undercut; how wide the widest is, is said.

use crate::mold::layout::{self, Around};
use crate::mold::make::{blank, extra, finding, push, source};
use crate::mold::prepare::Ready;
use crate::mold::two_part::keys;
use crate::mold::{Kind, Mold, MoldError, MoldSpec, Step, Volume, pictures, scad, silicone};
use crate::report::Severity;
use glam::DVec3;

const MM3_IN_CM3: f64 = 1000.0;

/// Mixed beyond the volume of a pour: what stays in cups and on walls.
const SPARE: f64 = 1.1;

pub fn mold(ready: Ready, spec: &MoldSpec) -> Result<Mold, MoldError> {
    let around = Around::silicone(&spec.figures);
    let plan = layout::plan(&ready.framed.mesh, ready.plane.height, &ready.tops, &spec.figures, around);
    let mut mold = blank(&ready, spec, plan, 0.0);
    mold.parting = Some(crate::mold::Parting::Plane { height_mm: ready.plane.height });
    let prints = silicone::prints(&ready.solid, &mold.plan, &spec.figures)?;
    push(&mut mold, "board", Kind::PatternBoard, &prints.board, DVec3::ZERO, 1);
    push(&mut mold, "box-upper", Kind::BoxWall, &prints.upper_wall, DVec3::ZERO, 1);
    push(&mut mold, "box-lower", Kind::BoxWall, &prints.lower_wall, DVec3::ZERO, 1);
    mold.pieces.push(source("part", Kind::Part, &mold.part));
    let [lower, upper] = silicone::pours(&prints.board, &mold.plan, &spec.figures)?;
    for (of, solid) in [("first pour, upper half", &upper), ("second pour, lower half", &lower)] {
        mold.volumes.push(silicone_volume(of, solid.volume(), spec));
    }
    mold.volumes.push(Volume { of: "cavity".into(), mm3: ready.solid.volume(), grams: None });
    if mold.pull.undercut_reach_mm > spec.figures.snap.value {
        let (area, wide) = (mold.pull.undercut_mm2, mold.pull.undercut_reach_mm);
        let what =
            format!("{area:.1} mm2 are undercut, up to {wide:.2} mm wide: the silicone has to bend by that");
        let found = finding(
            &mold,
            Severity::Note,
            vec![],
            what,
            "take a soft silicone, Shore A 10-20; look at thin cores",
        );
        mold.findings.push(found);
    }
    mold.steps = steps(&mold);
    mold.extras.push(pictures::maps(&mold));
    extra(&mut mold, "scad", scad::silicone);
    let pictures = [pictures::prints(&mold), pictures::beside(&mold, &lower.mesh(), &upper.mesh())];
    mold.extras.extend(pictures);
    Ok(mold)
}

fn silicone_volume(of: &str, mm3: f64, spec: &MoldSpec) -> Volume {
    let grams = mm3 / MM3_IN_CM3 * spec.figures.silicone_density.value;
    Volume { of: of.into(), mm3, grams: Some(grams) }
}

fn steps(mold: &Mold) -> Vec<Step> {
    let pour = |k: usize| {
        let v = &mold.volumes[k];
        format!(
            "{:.0} cm3 ({:.0} g, with a tenth to spare)",
            v.mm3 / MM3_IN_CM3,
            v.grams.unwrap_or(0.0) * SPARE
        )
    };
    let does = [
        "print the board and both box walls; smooth the master, coat it with release agent".to_string(),
        "stand the upper box wall on the board within the lip, seal it with clay".to_string(),
        format!("first pour: {}; let it cure as its sheet says", pour(0)),
        "turn all over, stand the lower box wall on the board, seal it".to_string(),
        format!("second pour: {}; let it cure", pour(1)),
        format!("take walls and board away; the two silicone halves close on each other: the {}", keys(mold)),
    ];
    let step =
        |does: String| Step { does, hours: None, celsius: None, source: "geometry of this mold".into() };
    does.into_iter().map(step).collect()
}
