//! Takes a part in its mold frame, its cavity, what lies below the parting, and a plan; gives the two halves.
//!
//! Promised by construction: on every upright line the lower half lies below the upper. Whether they leave the part is
//! measured on the files.

use crate::mold::figures::Figures;
use crate::mold::layout::BEYOND;
use crate::mold::plan::{Channel, Plan};
use crate::solid::{NotSolid, Solid, cuboid, frustum, turned};
use glam::{DVec2, DVec3};

/// A key narrows to this share of its diameter: 27 degrees of draft for one half as high as wide.
pub const KEY_TIP: f64 = 0.5;

/// A sprue or vent, grown by `air` on its side and at its foot.
pub fn channel(c: &Channel, air: f64) -> Result<Solid, NotSolid> {
    let widening = (c.above - c.below) / c.height;
    let (below, above) = (c.below / 2.0 + air, (c.above + widening * BEYOND) / 2.0 + air);
    Solid::of(&frustum(c.foot - DVec3::Z * air, c.height + BEYOND + air, below, above))
}

fn bolt(plan: &Plan, at: DVec2, d: f64) -> Result<Solid, NotSolid> {
    let height = plan.high.z - plan.low.z + 2.0 * BEYOND;
    Solid::of(&frustum(at.extend(plan.low.z - BEYOND), height, d / 2.0, d / 2.0))
}

/// A key's body, grown by `air` on all sides; it is rooted `BEYOND` below the parting.
pub fn key(at: DVec3, f: &Figures, air: f64) -> Result<Solid, NotSolid> {
    let (r, h) = (f.key_diameter.value / 2.0, f.key_height.value);
    Solid::of(&turned(at, &[(-BEYOND, r + air), (0.0, r + air), (h + air, r * KEY_TIP + air)]))
}

/// The tools that cut each half.
pub struct Tools {
    pub keys: Solid,
    pub sockets: Solid,
    pub bolts: Solid,
    /// Sprues, vents, slots: in the upper half alone.
    pub above: Solid,
}

impl Tools {
    pub fn of(plan: &Plan, f: &Figures) -> Result<Tools, NotSolid> {
        let all = |s: Vec<Result<Solid, NotSolid>>| Ok(Solid::all(s.into_iter().collect::<Result<_, _>>()?));
        let slot = |s: &(DVec3, DVec3)| Solid::of(&cuboid(s.0, s.1));
        Ok(Tools {
            keys: all(plan.keys.iter().map(|k| key(k.at, f, 0.0)).collect())?,
            sockets: all(plan.keys.iter().map(|k| key(k.at, f, f.key_clearance.value)).collect())?,
            bolts: all(plan.bolts.iter().map(|&b| bolt(plan, b, f.bolt.value)).collect())?,
            above: all(plan
                .sprues
                .iter()
                .chain(&plan.vents)
                .map(|c| channel(c, 0.0))
                .chain(plan.slots.iter().map(slot))
                .collect())?,
        })
    }
}

/// Name, solid and pull of each half.
pub fn halves(
    cavity: &Solid,
    below: &Solid,
    plan: &Plan,
    tools: &Tools,
) -> Result<[(&'static str, Solid, DVec3); 2], NotSolid> {
    let block = Solid::of(&cuboid(plan.low, plan.high))?;
    // The cavity, much the finest, last: each operation goes through all of both solids.
    let lower = || below.with(&tools.keys).minus(&tools.bolts).minus(cavity);
    let upper = || {
        let cut = Solid::all(vec![tools.sockets.clone(), tools.bolts.clone(), tools.above.clone()]);
        block.minus(below).minus(&cut).minus(cavity)
    };
    let (lower, upper) = rayon::join(lower, upper);
    Ok([("lower", lower, DVec3::NEG_Z), ("upper", upper, DVec3::Z)])
}
