//! Takes the steps of a process; gives the factor by which the master is larger than the finished part, with its
//! ledger, and scales about a stated datum.
//!
//! Not promised: that shrinkage is the same in all directions. Each entry says what is known of its figure.

use crate::process::{Grade, Process};
use glam::DVec3;
use serde::Serialize;

/// One step: a length L becomes L (1 - s), so the master is larger by 1 / (1 - s).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Entry {
    pub step: String,
    pub shrinkage_percent: f64,
    pub low_percent: f64,
    pub high_percent: f64,
    pub factor: f64,
    /// Of this step and all before it.
    pub product: f64,
    pub source: String,
    pub grade: Grade,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// K, the product of 1 / (1 - s).
    pub factor: f64,
    /// K at the low and the high ends of all ranges.
    pub range: (f64, f64),
    /// The point of the assembly that scaling leaves where it is, in mm.
    pub datum: DVec3,
    pub ledger: Vec<Entry>,
}

impl Scale {
    pub fn of(process: &Process, datum: DVec3) -> Scale {
        let mut so_far = 1.0;
        let entry = |s: &crate::process::Step| {
            so_far *= growth(s.shrinkage.value);
            Entry {
                step: s.name.clone(),
                shrinkage_percent: s.shrinkage.value,
                low_percent: s.shrinkage.low,
                high_percent: s.shrinkage.high,
                factor: growth(s.shrinkage.value),
                product: so_far,
                source: s.shrinkage.source.clone(),
                grade: s.shrinkage.grade,
            }
        };
        let ledger: Vec<Entry> = process.steps.iter().map(entry).collect();
        let product = |f: fn(&Entry) -> f64| ledger.iter().map(|e| growth(f(e))).product::<f64>();
        let range = (product(|e| e.low_percent), product(|e| e.high_percent));
        Scale { factor: product(|e| e.shrinkage_percent), range, datum, ledger }
    }

    /// From the finished part to the master, in mm.
    pub fn up(&self, p: DVec3) -> DVec3 {
        self.datum + (p - self.datum) * self.factor
    }

    /// From the master to the finished part, in mm.
    pub fn down(&self, p: DVec3) -> DVec3 {
        self.datum + (p - self.datum) / self.factor
    }
}

fn growth(percent: f64) -> f64 {
    1.0 / (1.0 - percent / 100.0)
}
