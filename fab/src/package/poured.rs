//! Takes a mold and the process that it serves; gives the mold's report with what fills it: the casting with its channels,
//! named by its material, as volume and mass.
//!
//! Masses are by the density of the finished material: what is poured hot is lighter for its volume, so that they are
//! upper bounds. Not promised: what stays in cups and ladles; the bill adds a tenth.

use super::bill::MELT;
use crate::make::MM3_IN_CM3;
use crate::mold::{self, Mold, MoldReport, Volume};
use crate::process::{Process, Route};

/// How the volume of a casting begins; its material follows.
pub const CASTING: &str = "casting with its channels, of ";

/// The tree of wax around patterns of another material, without these.
const BARE_TREE: &str = "wax, runner and gates";

/// What the tree with its patterns takes, as the mold calls it.
const WHOLE_TREE: &str = "wax, tree with patterns";

/// Adds what fills the mold, and weighs a tree's metal by the process; of a tree whose patterns are printed, takes them from
/// its wax. `patterns`: in mm3, all of them.
pub fn add(report: &mut MoldReport, mold: &Mold, process: &Process, patterns: f64) {
    let density = mold.figures.wax_density.value;
    // The mold knows aluminium alone, the process its own metal.
    for metal in report.volumes.iter_mut().filter(|v| v.of == MELT) {
        *metal = weighed(MELT.into(), metal.mm3, process.density.value);
    }
    match (report.route, process.route) {
        (mold::Route::LostWax, Route::LostPrint) => report.volumes.iter_mut().for_each(|v| {
            if v.of == WHOLE_TREE {
                *v = weighed(BARE_TREE.into(), (v.mm3 - patterns).max(0.0), density);
            }
        }),
        (mold::Route::LostWax, _) => {}
        // A silicone mold on the way to metal is filled with wax.
        (_, Route::LostWax) => report.volumes.extend(fills(mold).map(|mm3| of("wax", mm3, density))),
        _ => {
            let (material, density) = (&process.material, process.density.value);
            report.volumes.extend(fills(mold).map(|mm3| of(material, mm3, density)));
        }
    }
}

fn of(material: &str, mm3: f64, density: f64) -> Volume {
    weighed(format!("{CASTING}{material}"), mm3, density)
}

fn weighed(of: String, mm3: f64, density: f64) -> Volume {
    Volume { of, mm3, grams: Some(mm3 / MM3_IN_CM3 * density) }
}

/// The hollow of a mold in mm3. Of a rigid one: cavity and channels. Of silicone: the box less both pours; the air around
/// the keys is in it. `None` where no mold came to be.
fn fills(mold: &Mold) -> Option<f64> {
    let all: f64 = mold.volumes.iter().map(|v| v.mm3).sum();
    match mold.route {
        _ if mold.volumes.is_empty() => None,
        mold::Route::Rigid => Some(all),
        _ => {
            let size = mold.plan.high - mold.plan.low;
            let pours: f64 = mold.volumes.iter().filter(|v| v.grams.is_some()).map(|v| v.mm3).sum();
            Some(size.element_product() - pours)
        }
    }
}
