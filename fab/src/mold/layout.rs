//! Takes a part in its mold frame, its parting height and its high points; gives where wall, keys, screws, slots, sprue
//! and vents of a two-part mold stand.
//!
//! Not promised: that a screw of that size is strong enough, or that a metal of that kind fills through the sprue.

use crate::bvh::Bvh;
use crate::mesh::Mesh;
use crate::mold::figures::Figures;
use crate::mold::plan::{Channel, Key, Plan};
use crate::mold::ray;
use crate::mold::tops::Top;
use crate::solid::{NotSolid, Solid, cuboid, frustum};
use glam::{DVec2, DVec3};

/// Material left beside a key or screw, mm: two lines of a 0.4 mm nozzle on each side, and as much again.
pub const EDGE: f64 = 2.0;

/// A slot takes the end of a flat screwdriver, mm.
pub const SLOT: DVec3 = DVec3::new(10.0, 3.0, 2.0);

/// The gate is this share of the part's least extent across the pull: narrow enough to be cut off, wide enough to fill.
const GATE_SHARE: f64 = 0.3;

/// What goes through a face reaches this far beyond it, mm, so that no skin is left.
pub const BEYOND: f64 = 1.0;

/// How deep a channel's foot stands in the cavity, mm, where the cavity is thick enough.
const FOOT: f64 = 1.0;

pub fn rim(f: &Figures) -> f64 {
    f.wall.value.max(f.key_diameter.value + 2.0 * EDGE)
}

/// What stands around a cavity, mm.
#[derive(Clone, Copy, Debug)]
pub struct Around {
    /// Beside it, wide enough for keys.
    pub rim: f64,
    /// Above and below it.
    pub wall: f64,
    /// Whether there are screws and slots.
    pub screwed: bool,
}

impl Around {
    pub fn printed(f: &Figures) -> Around {
        Around { rim: rim(f), wall: f.wall.value, screwed: true }
    }

    pub fn silicone(f: &Figures) -> Around {
        let wall = f.silicone_wall.value;
        Around { rim: wall.max(rim(f)), wall, screwed: false }
    }
}

/// Least side of a block: a key between two screws, and slots beside it.
pub fn least_side(f: &Figures) -> f64 {
    f.key_diameter.value + f.bolt.value + 4.0 * EDGE + 2.0 * SLOT.x
}

/// The block around the part.
fn block(part: &Mesh, f: &Figures, a: Around) -> (DVec3, DVec3) {
    let (lo, hi) = part.bounds();
    let around = DVec3::new(a.rim, a.rim, a.wall);
    let (lo, hi) = (lo - around, hi + around);
    let least = least_side(f);
    let wider = ((DVec3::new(least, least, 0.0) - (hi - lo)) / 2.0).max(DVec3::ZERO);
    (lo - wider, hi + wider)
}

pub fn plan(part: &Mesh, parting: f64, tops: &[Top], f: &Figures, a: Around) -> Plan {
    let (mut low, mut high) = block(part, f, a);
    // A key needs its height and a floor on both sides of the parting.
    let room = f.key_height.value + f.key_clearance.value + EDGE;
    low.z = low.z.min(parting - room);
    high.z = high.z.max(parting + room);
    let (inset, middle) = (a.rim / 2.0, (low + high) / 2.0);
    let key = |x: f64, y: f64| Key { at: DVec3::new(x, y, parting) };
    let screw = f.bolt.value / 2.0 + EDGE;
    let (left, right, front, rear) = (low.x + screw, high.x - screw, low.y + screw, high.y - screw);
    let corners = [(left, front), (right, front), (right, rear), (left, rear)].map(DVec2::from);
    let (sprues, vents) = channels(part, parting, tops, high.z, f);
    Plan {
        low,
        high,
        parting,
        keys: vec![key(low.x + inset, middle.y), key(high.x - inset, middle.y), key(middle.x, low.y + inset)],
        bolts: if a.screwed { corners.to_vec() } else { vec![] },
        slots: if a.screwed { slots(low, high, parting, f) } else { vec![] },
        sprues,
        vents,
    }
}

/// Places of a key along its side, shares of the side, in the order in which they are tried.
const ALONG: [f64; 5] = [0.5, 0.3, 0.7, 0.2, 0.8];

/// The plan with keys, screws and slots out of the way of side cores, and the channels that stand in the way of one.
/// Keys keep to three sides; `one_way` of the checks tells whether they still fit one way only.
pub fn clear(plan: &Plan, cores: &[Solid], f: &Figures, a: Around) -> Result<(Plan, usize), NotSolid> {
    let hit = |s: &Mesh| -> Result<bool, NotSolid> {
        let s = Solid::of(s)?;
        Ok(cores.iter().any(|c| !c.common(&s).is_empty()))
    };
    let (low, high, up) = (plan.low, plan.high, plan.parting);
    let upright = |at: DVec2, r: f64| frustum(at.extend(low.z), high.z - low.z, r, r);
    let near_key = |k: &DVec2| {
        let r = f.key_diameter.value / 2.0 + f.key_clearance.value + EDGE;
        let reach = f.key_height.value + EDGE;
        frustum(k.extend(up - reach), 2.0 * reach, r, r)
    };
    let inset = a.rim / 2.0;
    let side = |k: usize, share: f64| match k {
        0 => DVec2::new(low.x + inset, low.y + share * (high.y - low.y)),
        1 => DVec2::new(high.x - inset, low.y + share * (high.y - low.y)),
        _ => DVec2::new(low.x + share * (high.x - low.x), low.y + inset),
    };
    let mut keys = Vec::new();
    for k in 0..3 {
        for share in ALONG {
            if !hit(&near_key(&side(k, share)))? {
                keys.push(Key { at: side(k, share).extend(up) });
                break;
            }
        }
    }
    let free = |s: &Mesh| hit(s).map(|h| !h);
    let mut kept = Plan { keys, bolts: vec![], slots: vec![], ..plan.clone() };
    for &b in &plan.bolts {
        if free(&upright(b, f.bolt.value / 2.0 + EDGE))? {
            kept.bolts.push(b);
        }
    }
    for &s in &plan.slots {
        if free(&cuboid(s.0, s.1))? {
            kept.slots.push(s);
        }
    }
    let mut shut = 0;
    for c in plan.sprues.iter().chain(&plan.vents) {
        let r = c.below.max(c.above) / 2.0;
        shut += usize::from(hit(&frustum(c.foot + DVec3::Z * FOOT, c.height - FOOT, r, r))?);
    }
    Ok((kept, shut))
}

/// One in the middle of the side without a key, one beside the key across from it.
fn slots(low: DVec3, high: DVec3, parting: f64, f: &Figures) -> Vec<(DVec3, DVec3)> {
    let middle = (low.x + high.x) / 2.0;
    let beside = middle - f.key_diameter.value / 2.0 - EDGE - SLOT.x;
    let slot = |x: f64, from: f64, to: f64| {
        (DVec3::new(x, from, parting), DVec3::new(x + SLOT.x, to, parting + SLOT.z))
    };
    vec![
        slot(middle - SLOT.x / 2.0, high.y - SLOT.y, high.y + BEYOND),
        slot(beside, low.y - BEYOND, low.y + SLOT.y),
    ]
}

/// A sprue for each body at its highest point (of points equally high, the one over most matter), vents for the others.
fn channels(
    part: &Mesh,
    parting: f64,
    tops: &[Top],
    up_to: f64,
    f: &Figures,
) -> (Vec<Channel>, Vec<Channel>) {
    let tree = Bvh::new(part);
    let (lo, hi) = part.bounds();
    let gate = f.sprue.value.min(GATE_SHARE * (hi - lo).truncate().min_element()).max(f.vent.value);
    let channel = |at: DVec3, below: f64, above: f64| {
        let thick =
            ray::first((part, &tree), at - DVec3::Z * FOOT_STEP, DVec3::NEG_Z, 0.0).map_or(FOOT, |h| h.at);
        let foot = at - DVec3::Z * depth(FOOT.min(thick / 2.0), at.z - parting);
        Channel { foot, height: up_to - foot.z, below, above }
    };
    let whole = |t: &&Top| t.prominence.is_infinite();
    let sprues: Vec<Channel> =
        tops.iter().filter(whole).map(|t| channel(t.at, gate, f.sprue.value)).collect();
    let mut taken: Vec<DVec3> = sprues.iter().map(|s| s.foot).collect();
    let mut vents = Vec::new();
    for t in tops.iter().filter(|t| !whole(t)) {
        if taken.iter().all(|p| p.truncate().distance(t.at.truncate()) >= f.vent_spacing.value) {
            taken.push(t.at);
            vents.push(channel(t.at, f.vent.value, f.vent.value));
        }
    }
    (sprues, vents)
}

/// The depth of a foot below a top that is `up` above the parting plane, both mm: as it is, or half way to the plane where it
/// would come near that. A channel wider than the part there would leave a skin between its foot and the plane.
fn depth(deep: f64, up: f64) -> f64 {
    if (up - deep).abs() < up / 2.0 { up / 2.0 } else { deep }
}

/// How far below a high point the thickness is measured from, mm, so that the ray does not meet the ceiling itself.
const FOOT_STEP: f64 = 1e-3;
