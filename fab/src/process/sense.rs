//! Takes values of a process; refuses those that no workshop can mean, one by one and together, each with the reason.
//!
//! Not promised: that what passes is wise; only that it is possible.

use super::{Figure, Grade, Overrides, Process, Route, library, measured};
use crate::toml_faults::{Cursor, FileFault};
use std::collections::BTreeSet;

/// What a kind of figure may be: its unit, and the values that are not a slip of the pen.
#[derive(Clone, Copy)]
pub(crate) struct Kind {
    pub unit: &'static str,
    pub least: f64,
    pub most: f64,
}

/// The same with the reason why nothing beyond is possible; empty where the range says it.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    pub unit: &'static str,
    pub least: f64,
    pub most: f64,
    pub because: &'static str,
}

impl From<Kind> for Bounds {
    fn from(k: Kind) -> Bounds {
        kind(k.unit, k.least, k.most, "")
    }
}

const fn kind(unit: &'static str, least: f64, most: f64, because: &'static str) -> Bounds {
    Bounds { unit, least, most, because }
}

pub(super) const CLEARANCE: Bounds = kind(
    "mm",
    0.0,
    5.0,
    "wider than 5 mm is no fit, and a negative one is a press fit, which nothing here can promise",
);
pub(super) const WALL: Bounds = kind("mm", 0.01, 50.0, "a wall has a thickness");
pub(super) const DENSITY: Bounds = kind("g/cm3", 0.01, 22.6, "from foam to osmium");
pub(super) const HEAT: Bounds = kind("C", -50.0, 2000.0, "from dry ice to steel");
pub(super) const LAYER: Bounds = kind("mm", 0.001, 2.0, "layers of a printer");
pub(super) const SHARE: Bounds = kind("%", 0.0, 100.0, "");
pub(super) const SHAVING: Bounds = kind("mm", 0.0, 2.0, "more than that is another part");
const SHRINKAGE: Bounds = kind(
    "%",
    -10.0,
    10.0,
    "no step of a casting chain shrinks by more than a few per cent; above a tenth a volume figure was probably meant",
);
/// Twelve parts in a thousand is what tin-cure silicone reaches in the end; heat-cured silicone starts near there.
const SILICONE: Bounds = kind(
    "%",
    -0.1,
    1.2,
    "silicone that cures at room temperature shrinks by 0 to 1.2 %; 1 to 4 % is heat-cured silicone, another material",
);
/// What a line of the schedule may say.
pub(super) const SCHEDULE: [Bounds; 7] = [
    HEAT,
    kind("h", 0.0, 1000.0, ""),
    kind("min", 0.0, 10_000.0, ""),
    kind("g", 0.0, 1000.0, "to 100 g of the other component"),
    kind("kPa", 0.0, 10_000.0, ""),
    SHARE,
    kind("mm", 0.0, 1000.0, ""),
];

/// Words for silicone that cures hot: HTV and LSR are trade names of kinds, HCR the gum that is pressed hot, and peroxide
/// cures at no room's temperature.
const HEAT_CURED: [&str; 12] = [
    "heat-cur",
    "heat cur",
    "hot-cur",
    "hot cur",
    "heat-vulcani",
    "heat vulcani",
    "high temperature vulcani",
    "high-temperature vulcani",
    "peroxide",
    "htv",
    "hcr",
    "lsr",
];

/// The word of a text that names heat-cured silicone.
fn heat_cured(text: &str) -> Option<&'static str> {
    let text = text.to_lowercase();
    let apart = |w: &str| text.split(|c: char| !c.is_alphanumeric()).any(|x| x == w);
    HEAT_CURED.into_iter().find(|w| if w.len() == 3 { apart(w) } else { text.contains(w) })
}

pub(super) fn shrinkage_of(step: &str) -> Bounds {
    if step.to_lowercase().contains("silicone") { SILICONE } else { SHRINKAGE }
}

/// The step in which the part itself is cast of silicone, whatever it is called: the last one.
fn cast_of_silicone(p: &Process) -> Option<usize> {
    let cast = p.route != Route::Print && p.material.to_lowercase().contains("silicone");
    if cast { p.steps.len().checked_sub(1) } else { None }
}

/// Bounds of a step's shrinkage in its process.
fn shrinkage_in(p: &Process, k: usize) -> Bounds {
    if cast_of_silicone(p) == Some(k) { SILICONE } else { shrinkage_of(&p.steps[k].name) }
}

/// What the keys say only together.
pub(super) fn together(top: &mut Cursor, p: &Process) {
    let mut seen = BTreeSet::new();
    for step in p.steps.iter().filter(|s| !s.name.is_empty()) {
        if !seen.insert(step.name.as_str()) {
            let what = format!("two steps are called \"{}\"", step.name);
            top.fault("step", what, "overrides and the coupon name steps: give each its own name");
        }
    }
    if seen.contains("metal") && seen.iter().any(|s| s.contains("investment")) {
        let hint =
            "take the net figure of the step \"metal\" alone, or call the gross one \"solidification\"";
        let what = "the step \"metal\" is net, with the investment's expansion in it, and there is an investment step too";
        top.fault("step", what.into(), hint);
    }
    silicone(top, p);
    cast(top, p);
}

/// Silicone that is cured hot, by its name or by what it shrinks.
fn silicone(top: &mut Cursor, p: &Process) {
    let of_steps = p.steps.iter().map(|s| ("step", s.name.as_str()));
    for (key, text) in [("title", p.title.as_str()), ("material", &p.material)].into_iter().chain(of_steps) {
        if heat_cured(text).is_some() {
            let what = format!("\"{text}\" is heat-cured; molds and parts here cure at room temperature");
            top.fault(key, what, "take platinum-cure or tin-cure RTV silicone");
        }
    }
    let Some(last) = cast_of_silicone(p).map(|k| &p.steps[k]) else { return };
    let s = last.shrinkage.value;
    // A step that is called silicone was looked at where it was read.
    if !last.name.to_lowercase().contains("silicone")
        && s.is_finite()
        && !(SILICONE.least..=SILICONE.most).contains(&s)
    {
        let what = format!("the step \"{}\" casts silicone, and {s} % is not possible", last.name);
        top.fault("step", what, SILICONE.because);
    }
}

/// What a part is cast in goes by its route, and how, by its schedule.
fn cast(top: &mut Cursor, p: &Process) {
    let cavity = p.cavity.as_ref().map(|c| c.material.as_str());
    let fault = match (p.route, cavity) {
        (Route::Print, Some(_)) => {
            Some(("a printed part has no cavity".into(), "take out [cavity], or choose a route that casts"))
        }
        (Route::Cast, Some(of)) if of != "silicone" => Some((
            format!("the route \"cast\" goes through a silicone mold, and the cavity is {of}"),
            FITTING_ROUTE,
        )),
        (Route::LostWax | Route::LostPrint, Some(of)) if of != "investment" => {
            Some((format!("metal is poured into investment, and the cavity is {of}"), FITTING_ROUTE))
        }
        (Route::CastDirect, Some(of)) if ["silicone", "investment"].contains(&of) => Some((
            format!("the route \"cast-direct\" goes into a printed mold, and the cavity is {of}"),
            FITTING_ROUTE,
        )),
        _ => None,
    };
    if let Some((what, hint)) = fault {
        top.fault("cavity", what, hint);
    }
    if p.route != Route::Print && p.schedule.is_empty() && !top.has("schedule") {
        let hint = "at least one [[schedule]] with stage and do: mix, pour, cure; copy those of a process that comes along";
        top.fault("schedule", "a casting has a schedule, and \"schedule\" is missing".into(), hint);
    }
}

/// What is poured is liquid, where it is known when it is.
pub(super) fn is_liquid(t: &mut Cursor, key: &str, material: &str, celsius: f64) {
    let Some(liquid) = library::liquid(material).filter(|l| celsius < l.low) else { return };
    let what = format!(
        "{material} is to be poured at {celsius} C, and is not liquid below {} C ({}, grade {})",
        liquid.low,
        liquid.source,
        liquid.grade.sign()
    );
    t.fault(
        key,
        what,
        "pour it hotter: some tens of degrees more, so that it fills the mold before it freezes",
    );
}

/// A line of the schedule at whose heat a material is liquid; `pour`: at what it goes into the cavity, where it is that.
pub(super) fn melting(t: &mut Cursor, material: &str, figure: Option<&Figure>, pour: Option<f64>) {
    let Some(heat) = figure.filter(|f| f.unit == HEAT.unit) else {
        let what = format!("a line melts {material}, and has no figure in {}", HEAT.unit);
        return t.fault("melts", what, "give the line its figure, or take out melts");
    };
    is_liquid(t, "figure", material, heat.value);
    if let Some(pour) = pour.filter(|p| p.is_finite() && heat.value.is_finite() && *p != heat.value) {
        let what = format!(
            "the schedule pours {material} at {} C, and the cavity is said to be filled at {pour} C",
            heat.value
        );
        t.fault("figure", what, "give the same figure here and in [cavity.pour]");
    }
}

const FITTING_ROUTE: &str =
    "cast-direct: PLA, PETG, ABS or resin; cast: silicone; lost-wax and lost-print: investment";

/// Puts the user's figures in; gives everything that is wrong with them.
pub(super) fn overrule(process: &mut Process, own: &Overrides) -> Vec<FileFault> {
    let mut faults = Vec::new();
    let user = |f: &mut Figure, value: Option<f64>, kind: Bounds, name: &str, faults: &mut Vec<FileFault>| {
        if let Some(value) = value {
            replace(f, value, kind, name, faults);
        }
    };
    let kinds: Vec<Bounds> = (0..process.steps.len()).map(|k| shrinkage_in(process, k)).collect();
    let clearance = own.clearances.get(&process.name).copied().or(own.clearance);
    user(&mut process.clearance, clearance, CLEARANCE, "clearance", &mut faults);
    user(&mut process.print.elephant_foot, own.elephant_foot, SHAVING, "elephant_foot", &mut faults);
    user(&mut process.print.flatten, own.flatten, SHAVING, "flatten", &mut faults);
    for (name, &value) in &own.shrinkage {
        match process.steps.iter_mut().zip(&kinds).find(|(s, _)| s.name == *name) {
            Some((step, kind)) => replace(&mut step.shrinkage, value, *kind, name, &mut faults),
            None => faults.push(no_such_step(process, name)),
        }
    }
    for (k, figure) in measured::shrinkages(process, &own.measured, &mut faults) {
        check(figure.value, kinds[k], &measured::named(process, k, &own.measured), &mut faults);
        process.steps[k].shrinkage = figure;
    }
    match own.bed.as_deref().map(library::bed) {
        Some(Ok(bed)) => process.print.bed = bed,
        Some(Err(what)) => {
            faults.push(FileFault { line: 0, what, hint: "a name of the list, or three sides in mm".into() });
        }
        None => {}
    }
    faults
}

fn no_such_step(process: &Process, name: &str) -> FileFault {
    FileFault {
        line: 0,
        what: format!("shrinkage is given for a step \"{name}\" that {} does not have", process.name),
        hint: format!(
            "its steps: {}",
            process.steps.iter().map(|s| &s.name[..]).collect::<Vec<_>>().join(", ")
        ),
    }
}

fn replace(figure: &mut Figure, value: f64, kind: Bounds, name: &str, faults: &mut Vec<FileFault>) {
    check(value, kind, name, faults);
    // The user knows his workshop: his figure has no range but itself.
    *figure = Figure {
        value,
        unit: kind.unit,
        low: value,
        high: value,
        source: "given by the user".into(),
        grade: Grade::User,
    };
}

fn check(value: f64, kind: Bounds, name: &str, faults: &mut Vec<FileFault>) {
    if !(kind.least..=kind.most).contains(&value) {
        // No caliper and no scale knows more digits.
        let shown = if value.is_finite() { (value * 1e4).round() / 1e4 } else { value };
        let what = format!("{name} of {shown} {} is not possible", kind.unit);
        let why = if kind.because.is_empty() { String::new() } else { format!("; {}", kind.because) };
        let hint = format!("from {} to {} {}{why}", kind.least, kind.most, kind.unit);
        faults.push(FileFault { line: 0, what, hint });
    }
}
