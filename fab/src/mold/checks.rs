//! Takes the halves of a mold as read back, and its plan; gives what was measured on them, each with its limit.
//!
//! The sweeps are exact up to round-off (`shadow`); volumes come from the boolean kernel.

use crate::bvh::Bvh;
use crate::mesh::Mesh;
use crate::mold::figures::Figures;
use crate::mold::frame::upright;
use crate::mold::layout::BEYOND;
use crate::mold::plan::Plan;
use crate::mold::ray;
use crate::mold::rigid::{KEY_TIP, Tools, channel};
use crate::mold::shadow::{self, Side};
use crate::mold::tops::Top;
use crate::mold::{Measured, Mold, silicone};
use crate::solid::{NotSolid, Solid, cuboid};
use glam::{DVec2, DVec3};

/// The volume that the cavity may be off, as a share of the part's: the promise of the workshop.
pub const CAVITY_SHARE: f64 = 1e-4;

/// Volumes are taken from corners each of which may be off by one snap: their sum by the surface times that.
fn volume_round_off(surface: f64, snap: f64) -> f64 {
    surface * snap
}

/// What rounding leaves between a channel and the file's is no thicker: a corner goes one snap, and those nearer than four
/// may be united.
const SKIN_IN_SNAPS: f64 = 4.0;

pub struct Halves<'a> {
    pub lower: &'a Mesh,
    pub upper: &'a Mesh,
    /// Side cores with their pulls, in the order in which they leave.
    pub cores: Vec<(&'a Mesh, DVec3)>,
}

impl<'a> Halves<'a> {
    fn all(&self) -> Vec<&'a Mesh> {
        self.cores.iter().map(|c| c.0).chain([self.lower, self.upper]).collect()
    }
}

/// All measurements of a rigid mold.
pub fn rigid(mold: &Mold, h: &Halves) -> Result<Vec<Measured>, NotSolid> {
    let tools = Tools::of(&mold.plan, &mold.figures)?;
    let mut all = volumes(mold, h, &tools)?;
    all.extend(sweeps(mold, h));
    all.extend(channels(mold, h));
    all.push(one_way(&mold.plan, &mold.figures));
    Ok(all)
}

/// A silicone mold, by the board as read back: what both pours around it leave of the part.
pub fn silicone(mold: &Mold, board: &Mesh) -> Result<Vec<Measured>, NotSolid> {
    let [lower, upper] = silicone::pours(&Solid::of(board)?, &mold.plan, &mold.figures)?;
    let (lower, upper) = (lower.mesh(), upper.mesh());
    let h = Halves { lower: &lower, upper: &upper, cores: vec![] };
    let mut all = volumes(mold, &h, &Tools::of(&mold.plan, &mold.figures)?)?;
    all.extend(channels(mold, &h));
    all.push(one_way(&mold.plan, &mold.figures));
    Ok(all)
}

fn volumes(mold: &Mold, h: &Halves, tools: &Tools) -> Result<Vec<Measured>, NotSolid> {
    let part = Solid::of(&mold.part)?;
    let pieces = h.all().into_iter().map(Solid::of).collect::<Result<Vec<_>, _>>()?;
    let block = Solid::of(&cuboid(mold.plan.low, mold.plan.high))?;
    let air = Solid::all(vec![tools.sockets.clone(), tools.above.clone(), tools.bolts.clone()]);
    let matter = Solid::all(pieces.clone());
    // Skins along keys, screws and channels, which rounding leaves, are no cavity; they count in the balance of the block.
    let (low, high) = mold.part.bounds();
    let around = Solid::of(&cuboid(low - BEYOND, high + BEYOND))?.common(&block);
    let channels = mold.plan.sprues.iter().chain(&mold.plan.vents);
    let channels = channels.map(|c| channel(c, SKIN_IN_SNAPS * mold.snap)).collect::<Result<Vec<_>, _>>()?;
    let beside = air.with(&Solid::all(channels));
    let inside = around.minus(&matter).minus(&beside);
    let cavity = inside.volume() + part.common(&beside).volume();
    let area = h.all().iter().map(|m| m.area()).sum::<f64>() + mold.part.area();
    let (volume, round_off) = (part.volume(), volume_round_off(area, mold.snap));
    let channels = block.common(&air).minus(&part).minus(&matter).volume();
    let filled: f64 = pieces.iter().map(|p| p.common(&block).volume()).sum();
    let overlaps = (0..pieces.len())
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .map(|(i, j)| pieces[i].common(&pieces[j]).volume());
    let why = "round-off of the files: surface times one snap";
    Ok(vec![
        Measured::at_most(
            "cavity against part",
            (cavity - volume).abs() / volume * 100.0,
            CAVITY_SHARE * 100.0,
            "%",
            "0.01 % of the part's volume",
        ),
        Measured::at_most(
            "shape of the cavity against the part's, by what only one of them has",
            (inside.minus(&part).volume() + part.minus(&beside).minus(&inside).volume()) / volume * 100.0,
            (CAVITY_SHARE + volume_round_off(mold.part.area(), mold.snap) / volume) * 100.0,
            "%",
            "0.01 % of the part's volume, and round-off",
        ),
        Measured::at_most("overlap of the pieces", overlaps.sum(), round_off, "mm3", why),
        Measured::at_most(
            "what the pieces share with the part",
            pieces.iter().map(|p| p.common(&part).volume()).sum(),
            round_off,
            "mm3",
            why,
        ),
        Measured::at_most(
            "pieces, part and channels against the block",
            (filled + volume + channels - block.volume()).abs(),
            round_off + CAVITY_SHARE * volume,
            "mm3",
            "round-off of the files, and 0.01 % of the cavity",
        ),
    ])
}

/// Each piece moved out along its pull, without end, in the order in which they leave: what of the part and of the pieces
/// still there it would hit. That they share nothing to begin with is measured by `volumes`.
fn sweeps(mold: &Mold, h: &Halves) -> Vec<Measured> {
    let mut all = Vec::new();
    for (k, (core, pull)) in h.cores.iter().enumerate() {
        let rest: Vec<&Mesh> = h.cores[k + 1..].iter().map(|c| c.0).chain([h.lower, h.upper]).collect();
        let name = core_name(k);
        all.push(hits(mold, format!("{name} leaves the part"), core, &[&mold.part], *pull));
        all.push(hits(mold, format!("{name} leaves the rest of the mold"), core, &rest, *pull));
    }
    let parts = [("upper half", h.upper, DVec3::Z), ("lower half", h.lower, DVec3::NEG_Z)];
    for (name, half, pull) in parts {
        let mut of_part = hits(mold, format!("{name} leaves the part"), half, &[&mold.part], pull);
        if mold.filled_mm3.is_none() {
            let why = "undercut that still snaps out of a rigid mold";
            of_part = Measured::at_most(of_part.of, of_part.value, mold.figures.snap.value, "mm", why);
        }
        all.push(of_part);
    }
    all.push(hits(mold, "upper half leaves the lower".into(), h.upper, &[h.lower], DVec3::Z));
    all
}

/// The name of a side core, from the first that leaves.
pub fn core_name(k: usize) -> String {
    format!("core-{}", k + 1)
}

/// The widest strip of what stands still that a piece would hit on its way.
fn hits(mold: &Mold, what: String, mover: &Mesh, still: &[&Mesh], pull: DVec3) -> Measured {
    let turn = upright(pull);
    let turned = |m: &Mesh| m.map(|v| turn * v);
    let mover = turned(mover);
    let lead = Side::of(&mover, 1.0);
    let (mut width, mut strip) = (0.0f64, 0.0f64);
    for s in still {
        let b = shadow::blocked(&lead, &Side::of(&turned(s), -1.0), mold.snap);
        strip = strip.max(b.strip);
        width = width.max(if b.area > 0.0 { shadow::reach(&b, b.strip) } else { 0.0 });
    }
    Measured::at_most(
        format!("{what}: width that it hits"),
        width,
        strip * 2.0,
        "mm",
        "round-off of the files: the widest strip that a snap of each corner makes",
    )
}

fn channels(mold: &Mold, h: &Halves) -> Vec<Measured> {
    let trees: Vec<(&Mesh, Bvh)> = h.all().into_iter().map(|m| (m, Bvh::new(m))).collect();
    let all = || mold.plan.sprues.iter().chain(&mold.plan.vents);
    let shut = all()
        .filter(|c| {
            trees.iter().any(|(m, t)| ray::any((*m, t), c.foot, DVec3::Z, FLOOR_IN_SNAPS * mold.snap))
        })
        .count();
    let reaches = all().filter(|c| c.foot.z + c.height < mold.plan.high.z - mold.snap).count();
    let airless = mold.tops.iter().filter(|t| !vented(mold, t)).count();
    vec![
        Measured::at_most(
            "channels that do not reach outside",
            (shut + reaches) as f64,
            0.0,
            "channels",
            "a ray along each axis",
        ),
        Measured::at_most(
            "high points without a way out",
            airless as f64,
            0.0,
            "points",
            "a channel over each, or within the vent spacing",
        ),
    ]
}

/// A ray starts on its channel's floor, which the file may have put this many snaps higher.
const FLOOR_IN_SNAPS: f64 = 4.0;

fn vented(mold: &Mold, top: &Top) -> bool {
    let near = |at: DVec3| at.truncate().distance(top.at.truncate()) <= mold.figures.vent_spacing.value;
    mold.plan.sprues.iter().chain(&mold.plan.vents).any(|c| near(c.foot))
}

/// How far the worst-placed key misses its socket when a half is put on turned, at its best: more than a key's tip can
/// slip into a socket.
fn one_way(plan: &Plan, f: &Figures) -> Measured {
    let middle = ((plan.low + plan.high) / 2.0).truncate();
    let keys: Vec<DVec2> = plan.keys.iter().map(|k| k.at.truncate() - middle).collect();
    let miss = |turn: DVec2| {
        let nearest = |k: &DVec2| keys.iter().map(|s| s.distance(turn.rotate(*k))).fold(f64::MAX, f64::min);
        keys.iter().map(nearest).fold(0.0, f64::max)
    };
    let turns = [DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
    let least = turns.into_iter().map(miss).fold(f64::MAX, f64::min);
    let slip = f.key_diameter.value * (1.0 + KEY_TIP) / 2.0 + f.key_clearance.value;
    Measured::at_least(
        "a key misses its socket when a half is put on turned",
        least,
        slip,
        "mm",
        "a key's tip and a socket's mouth do not meet",
    )
}
