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

const HEAT_CURED: [&str; 4] = ["heat-cured", "heat cured", "htv", "vulcani"];

pub(super) fn shrinkage_of(step: &str) -> Bounds {
    if step.to_lowercase().contains("silicone") { SILICONE } else { SHRINKAGE }
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
    if HEAT_CURED.iter().any(|w| p.material.to_lowercase().contains(w)) {
        let what = format!("\"{}\" is heat-cured; molds and parts here cure at room temperature", p.material);
        top.fault("material", what, "take platinum-cure or tin-cure RTV silicone");
    }
    if p.route == Route::Print && p.cavity.is_some() {
        top.fault(
            "cavity",
            "a printed part has no cavity".into(),
            "take out [cavity], or choose a route that casts",
        );
    }
}

/// Puts the user's figures in; gives everything that is wrong with them.
pub(super) fn overrule(process: &mut Process, own: &Overrides) -> Vec<FileFault> {
    let mut faults = Vec::new();
    let user = |f: &mut Figure, value: Option<f64>, kind: Bounds, name: &str, faults: &mut Vec<FileFault>| {
        if let Some(value) = value {
            replace(f, value, kind, name, faults);
        }
    };
    user(&mut process.clearance, own.clearance, CLEARANCE, "clearance", &mut faults);
    user(&mut process.print.elephant_foot, own.elephant_foot, SHAVING, "elephant_foot", &mut faults);
    user(&mut process.print.flatten, own.flatten, SHAVING, "flatten", &mut faults);
    for (name, &value) in &own.shrinkage {
        match process.steps.iter_mut().find(|s| s.name == *name) {
            Some(step) => replace(&mut step.shrinkage, value, shrinkage_of(name), name, &mut faults),
            None => faults.push(no_such_step(process, name)),
        }
    }
    for (k, figure) in measured::shrinkages(process, &own.measured, &mut faults) {
        let name = process.steps[k].name.clone();
        check(figure.value, shrinkage_of(&name), &name, &mut faults);
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
        let what = format!("{name} of {value} {} is not possible", kind.unit);
        let why = if kind.because.is_empty() { String::new() } else { format!("; {}", kind.because) };
        let hint = format!("from {} to {} {}{why}", kind.least, kind.most, kind.unit);
        faults.push(FileFault { line: 0, what, hint });
    }
}
