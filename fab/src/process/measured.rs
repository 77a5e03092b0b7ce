//! Takes what a user read off the calibration coupon; gives the shrinkage of each step that was measured.
//!
//! Not promised: better than the caliper: 0.02 mm on the coupon's bar is 0.03 %.

use super::{Figure, Grade, Process};
use crate::toml_faults::FileFault;

/// Length of the coupon's bars as drawn, mm: long enough for 0.1 % to be seen with a caliper, short enough for any bed.
pub const COUPON_MM: f64 = 60.0;

/// The coupon's bar after a step, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    pub step: String,
    pub length: f64,
}

impl Measured {
    /// From `print=59.87` or `print=59.87 mm`.
    pub fn parse(text: &str) -> Result<Measured, String> {
        let wrong = || format!("{text:?} is not a step and a length, as in print=59.87");
        let (step, length) = text.split_once('=').ok_or_else(wrong)?;
        let length: f64 = length.trim().trim_end_matches("mm").trim().parse().map_err(|_| wrong())?;
        match step.trim() {
            "" => Err(wrong()),
            step if length.is_finite() => Ok(Measured { step: step.to_string(), length }),
            _ => Err(wrong()),
        }
    }
}

/// Shrinkage in per cent by step, from the length before the step (measured, or by the figures) and after it.
pub(super) fn shrinkages(
    process: &Process,
    all: &[Measured],
    faults: &mut Vec<FileFault>,
) -> Vec<(usize, Figure)> {
    let mut before = COUPON_MM;
    let mut found = Vec::new();
    for (k, step) in process.steps.iter().enumerate() {
        let expected = before * (1.0 - step.shrinkage.value / 100.0);
        let measured = all.iter().find(|m| m.step == step.name);
        if let Some(m) = measured {
            found.push((k, figure(100.0 * (1.0 - m.length / before), m)));
        }
        before = measured.map_or(expected, |m| m.length);
    }
    let steps: Vec<&str> = process.steps.iter().map(|s| s.name.as_str()).collect();
    for m in all.iter().filter(|m| !steps.contains(&m.step.as_str())) {
        faults.push(FileFault {
            line: 0,
            what: format!(
                "the coupon was measured after a step \"{}\" that {} does not have",
                m.step, process.name
            ),
            hint: format!("its steps: {}", steps.join(", ")),
        });
    }
    found
}

/// How a fault calls a step that was measured.
pub(super) fn named(process: &Process, k: usize, all: &[Measured]) -> String {
    let step = &process.steps[k].name;
    let length = all.iter().find(|m| m.step == *step).map_or(f64::NAN, |m| m.length);
    format!("{step}: a bar of {length} mm after it, and so a shrinkage")
}

fn figure(percent: f64, m: &Measured) -> Figure {
    let source =
        format!("measured by the user: {} mm on the coupon's {COUPON_MM} mm bar after {}", m.length, m.step);
    Figure { value: percent, unit: "%", low: percent, high: percent, source, grade: Grade::User }
}
