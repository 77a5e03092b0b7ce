//! Takes the text of a process file; gives its values with all faults of spelling, kind and range.
//!
//! Not promised: that the values make sense together; `sense` looks at that.

use super::library;
use super::sense::{self, Bounds};
use super::{Bed, Cavity, Figure, Grade, Instruction, Print, Process, ProcessError, Route, Step};
use crate::toml_faults::{Cursor, FileFault};

pub(super) fn parse(place: &str, text: &str) -> Result<Process, ProcessError> {
    let mut faults = Vec::new();
    let process = Cursor::parse(text, &mut faults).map(|mut top| process(&mut top));
    faults.sort_by_key(|f| f.line);
    match process {
        Some(process) if faults.is_empty() => Ok(process),
        _ => Err(ProcessError::Faulty { place: place.to_string(), faults }),
    }
}

/// The tables of a list in a file that the program carries; a faulty one is left out, and a test sees that none is.
pub(super) fn list<T>(text: &str, key: &'static str, row: impl Fn(&mut Cursor) -> T) -> Vec<T> {
    let mut faults: Vec<FileFault> = Vec::new();
    let rows = Cursor::parse(text, &mut faults).map(|mut top| top.each(key, row)).unwrap_or_default();
    if faults.is_empty() { rows } else { Vec::new() }
}

pub(super) fn bears(at: &mut Cursor) -> Figure {
    figure(at, "bears", sense::HEAT)
}

fn process(top: &mut Cursor) -> Process {
    let names: Vec<&str> = Route::ALL.iter().map(|r| r.0).collect();
    let (name, title) = (top.text("name"), top.text("title"));
    let word = top.text_of("route", &names);
    let route = Route::ALL.iter().find(|r| r.0 == word).map_or(Route::Print, |r| r.1);
    let material = top.text("material");
    let cavity = match (route, top.has("cavity")) {
        (Route::Print, false) => None,
        _ => Some(top.table("cavity", |t| cavity(t, &material))),
    };
    let line = |t: &mut Cursor| instruction(t, &material, cavity.as_ref());
    let schedule = if top.has("schedule") { top.each("schedule", line) } else { vec![] };
    let process = Process {
        name,
        title,
        route,
        clearance: figure(top, "clearance", sense::CLEARANCE),
        least_wall: figure(top, "least_wall", sense::WALL),
        density: figure(top, "density", sense::DENSITY),
        print: top.table("print", print),
        steps: top.each("step", step),
        material,
        cavity,
        schedule,
    };
    sense::together(top, &process);
    top.refuse_others(
        "a process has name, title, route, material, clearance, least_wall, density, print, cavity, [[step]] and [[schedule]]",
    );
    process
}

fn print(t: &mut Cursor) -> Print {
    let word = t.text("bed");
    let bed = library::bed(&word);
    if let (Err(why), false) = (&bed, word.is_empty()) {
        t.fault("bed", why.clone(), "a name of the list, or three sides in mm");
    }
    let print = Print {
        material: t.text("material"),
        bed: bed.unwrap_or(Bed { name: word, size: [f64::NAN; 3] }),
        supports: t.text("supports"),
        layer: figure(t, "layer", sense::LAYER),
        infill: figure(t, "infill", sense::SHARE),
        density: figure(t, "density", sense::DENSITY),
        elephant_foot: figure(t, "elephant_foot", sense::SHAVING),
        flatten: figure(t, "flatten", sense::SHAVING),
    };
    t.refuse_others("[print] has material, bed, supports, layer, infill, density, elephant_foot and flatten");
    print
}

fn cavity(t: &mut Cursor, poured: &str) -> Cavity {
    let materials = library::materials();
    let names: Vec<&str> = materials.iter().map(|m| m.0.as_str()).collect();
    let material = t.text_of("material", &names);
    let pour = figure(t, "pour", sense::HEAT);
    let bears = materials.into_iter().find(|m| m.0 == material).map(|m| m.1);
    if let Some(bears) = &bears
        && pour.value >= bears.value
    {
        let what = format!(
            "what is poured at {} C finds a cavity of {material}, which bears no more than {} C ({})",
            pour.value, bears.value, bears.source
        );
        let hint = match material.as_str() {
            "investment" => {
                "gypsum breaks down there, and no other investment is known here: take a metal that pours colder"
            }
            _ => "take a cavity that bears it: silicone for wax, investment for metal",
        };
        t.fault("material", what, hint);
    }
    sense::is_liquid(t, "pour", poured, pour.value);
    t.refuse_others("[cavity] has material and pour");
    let bears = bears.unwrap_or_else(|| Figure { value: f64::NAN, ..pour.clone() });
    Cavity { material, pour, bears, liquid: library::liquid(poured) }
}

fn step(t: &mut Cursor) -> Step {
    let name = t.text("name");
    let kind = sense::shrinkage_of(&name);
    let step = Step { shrinkage: figure(t, "shrinkage", kind), name };
    t.refuse_others("a step has name and shrinkage");
    step
}

fn instruction(t: &mut Cursor, material: &str, cavity: Option<&Cavity>) -> Instruction {
    let (stage, what) = (t.text("stage"), t.text("do"));
    let figure = t.has("figure").then(|| {
        t.table("figure", |f| {
            let units: Vec<&str> = sense::SCHEDULE.iter().map(|k| k.unit).collect();
            let unit = f.text_of("unit", &units);
            let kind = sense::SCHEDULE.iter().find(|k| k.unit == unit).copied().unwrap_or(sense::SHARE);
            figure_here(f, "figure", kind)
        })
    });
    let melts = t.has("melts").then(|| t.text("melts"));
    if let Some(melted) = &melts {
        let pour = cavity.filter(|_| melted == material).map(|c| c.pour.value);
        sense::melting(t, melted, figure.as_ref(), pour);
    }
    t.refuse_others("a line of the schedule has stage, do, melts and figure");
    Instruction { stage, what, melts, figure }
}

/// A figure of the workshop below the key, in the bounds of its kind.
pub(crate) fn figure(at: &mut Cursor, key: &'static str, kind: impl Into<Bounds>) -> Figure {
    let kind = kind.into();
    at.table(key, |t| {
        t.text_of("unit", &[kind.unit]);
        figure_here(t, key, kind)
    })
}

fn figure_here(t: &mut Cursor, key: &str, kind: Bounds) -> Figure {
    let [value, low, high] = ["value", "low", "high"]
        .map(|k| t.number_because(k, (kind.least, kind.most), kind.unit, kind.because));
    let grade = match t.text_of("grade", &["S", "2", "I", "M"]).as_str() {
        "S" => Grade::S,
        "2" => Grade::SecondHand,
        "M" => Grade::M,
        _ => Grade::I,
    };
    if !(low <= value && value <= high) && [low, value, high].iter().all(|x| x.is_finite()) {
        let what = format!("{key}: low {low}, value {value}, high {high} are not in order");
        t.fault("value", what, "low <= value <= high");
    }
    let figure = Figure { value, unit: kind.unit, low, high, source: t.text("source"), grade };
    t.refuse_others("a figure has value, unit, low, high, source and grade");
    figure
}
