//! Takes a ready part; gives its lost-wax tree with flask, and what to mix, melt and burn.
//!
//! Not promised: a sound casting; see `wax`.

use crate::mold::figures::Figures;
use crate::mold::make::{blank, extra, finding, push, source};
use crate::mold::plan::Plan;
use crate::mold::prepare::{Ready, unfit};
use crate::mold::wax::{self, Section, Tree};
use crate::mold::{Kind, Measured, Mold, MoldError, MoldSpec, Step, Volume, grown, scad};
use crate::process::Figure;
use crate::report::{Finding, Severity};
use crate::solid::{NotSolid, Solid, frustum};
use glam::DVec3;
use std::f64::consts::PI;

const MM3_IN_CM3: f64 = 1000.0;

/// Wall of the flask's tube, mm: 3 mm steel.
pub const FLASK_WALL: f64 = 3.0;

pub fn mold(ready: Ready, spec: &MoldSpec) -> Result<Mold, MoldError> {
    let f = &spec.figures;
    let mut mold = blank(&ready, spec, Plan::default(), 0.0);
    mold.parting = None;
    let balls = wax::balls(&mold.part);
    let gate = wax::thickest(&mold.part, &balls)
        .ok_or_else(|| unfit("no straight gate reaches the part from outside", "divide the part"))?;
    let tree = wax::tree(&mold.part, &gate, spec.count, f)?;
    mold.castings = tree.places.len();
    push(&mut mold, "tree", Kind::Tree, &tree.solid, DVec3::ZERO, 1);
    let flask = flask(&tree, f)?;
    push(&mut mold, "flask", Kind::Flask, &flask, DVec3::ZERO, 1);
    mold.pieces.push(source("part", Kind::Part, &tree.lying));
    mold.measured = feeding(&tree, &gate, &balls, f);
    let missed: Vec<String> = mold.measured.iter().filter(|m| !m.kept).map(said).collect();
    for what in missed {
        let remedy = "give a larger feed_area or runner, or a second gate at the place named";
        let at: Vec<DVec3> =
            wax::hot_spots(&balls, &gate, f.modulus_step.value).iter().map(|s| s.at).take(1).collect();
        let found = finding(&mold, Severity::Warning, at, what, remedy);
        mold.findings.push(found);
    }
    mold.findings.extend(too_high(&mold, &tree, f));
    mold.volumes = volumes(&tree, spec);
    mold.steps = steps(&mold, &tree, f);
    extra(&mut mold, "scad", |m| scad::tree(m, &tree));
    let picture = grown::opened(&mold, &tree, &flask, FLASK_WALL)?;
    mold.extras.push(picture);
    Ok(mold)
}

/// A flask of one row of patterns that is higher than the oven takes.
fn too_high(mold: &Mold, tree: &Tree, f: &Figures) -> Option<Finding> {
    let (_, low, high) = wax::flask(tree, f);
    let (height, most) = (high - low, f.flask_height.value);
    (height > most).then(|| {
        let what = format!(
            "the flask is {height:.0} mm high; {most} mm are taken to fit ({})",
            f.flask_height.source
        );
        finding(
            mold,
            Severity::Warning,
            vec![],
            what,
            "look whether your oven takes it, or make the part smaller",
        )
    })
}

fn said(m: &Measured) -> String {
    format!("{}: {:.3} {}, wanted {:.3} ({})", m.of, m.value, m.unit, m.limit, m.because)
}

fn flask(tree: &Tree, f: &Figures) -> Result<Solid, NotSolid> {
    let (radius, low, high) = wax::flask(tree, f);
    let tube = |r: f64, low: f64, high: f64| Solid::of(&frustum(DVec3::Z * low, high - low, r, r));
    Ok(tube(radius + FLASK_WALL, low, high)?.minus(&tube(radius, low - 1.0, high + 1.0)?))
}

/// Relative: a volume and an area summed over up to a million triangles in f64, each sum good to a million halves of an ulp.
const MODULUS_ROUND_OFF: f64 = 1e6 * f64::EPSILON;

fn feeding(tree: &Tree, gate: &Section, balls: &[(usize, Section)], f: &Figures) -> Vec<Measured> {
    let (m, step) = (tree.moduli, f.modulus_step.value);
    // A gate is made for just this step: round-off of the ratio does not miss it.
    let kept = step * (1.0 - MODULUS_ROUND_OFF);
    let why = "what feeds must freeze later";
    let hot = wax::hot_spots(balls, gate, step).len() as f64;
    vec![
        Measured::at_least("modulus of the gate over the pattern's", m.gate / m.pattern, kept, "", why),
        Measured::at_least("modulus of the runner over the gate's", m.runner / m.gate, kept, "", why),
        Measured::at_most(
            "diameter of the runner",
            tree.runner,
            f.runner.high.max(f.runner.value),
            "mm",
            "the most of its range; a heavier one freezes long after the parts",
        ),
        Measured::at_most(
            "places thicker than the gate's section",
            hot,
            0.0,
            "places",
            "a hot spot that nothing feeds shrinks",
        ),
        Measured::at_least(
            "investment between tree and flask",
            f.flask_wall.value,
            15.0,
            "mm",
            "15-20 mm keep a flask from cracking",
        ),
    ]
}

fn grams(mm3: f64, density: &Figure) -> Option<f64> {
    Some(mm3 / MM3_IN_CM3 * density.value)
}

fn volumes(tree: &Tree, spec: &MoldSpec) -> Vec<Volume> {
    let f = &spec.figures;
    let (radius, low, high) = wax::flask(tree, f);
    let wax = tree.solid.volume();
    let room = PI * radius * radius * (high - low) - wax;
    let slurry = grams(room, &f.investment_density).unwrap_or(0.0);
    let powder = slurry / (1.0 + f.water.value / 100.0);
    let metal = wax * (1.0 + f.metal_extra.value / 100.0);
    let of = |of: &str, mm3: f64, grams: Option<f64>| Volume { of: of.into(), mm3, grams };
    vec![
        of("wax, tree with patterns", wax, grams(wax, &f.wax_density)),
        of("investment, mixed", room, Some(slurry)),
        of("investment powder", 0.0, Some(powder)),
        of("water", (slurry - powder) * MM3_IN_CM3, Some(slurry - powder)),
        of("metal to melt", metal, grams(metal, &f.metal_density)),
    ]
}

fn steps(mold: &Mold, tree: &Tree, f: &Figures) -> Vec<Step> {
    let mass = |k: usize| mold.volumes[k].grams.unwrap_or(0.0);
    let by_geometry =
        |does: String| Step { does, hours: None, celsius: None, source: "geometry of this tree".into() };
    let heat = |does: &str, t: &Figure, h: Option<&Figure>| Step {
        does: does.into(),
        hours: h.map(|h| h.value),
        celsius: Some(t.value),
        source: h.map_or(t.source.clone(), |h| format!("{}; time {}", t.source, h.source)),
    };
    let fill: Vec<String> = tree.levels.iter().map(|(z, n)| format!("{n} at {z:.0} mm")).collect();
    vec![
        by_geometry(format!(
            "wax the patterns, all of one shape, to a runner of {:.1} mm by gates of {:.1} mm; they fill from the foot: {}",
            tree.runner,
            tree.gate,
            fill.join(", ")
        )),
        by_geometry(format!(
            "sift {:.0} g of powder into {:.0} g of water, mix, take the air out, fill the flask with the cup on its base",
            mass(2),
            mass(3)
        )),
        heat("melt the wax out, mouth down", &f.dewax, Some(&f.dewax_time)),
        heat("burn out", &f.burnout, Some(&f.burnout_time)),
        heat(
            "let the flask cool to the heat at which it is cast, and hold it there until it is even",
            &f.flask_heat,
            None,
        ),
        heat(&format!("melt {:.0} g and pour", mass(4)), &f.metal_heat, None),
    ]
}
