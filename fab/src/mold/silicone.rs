//! Takes a part in its mold frame with its parting plane and a plan; gives the print for a silicone mold: a board with
//! the master's upper half on its top and the lower half on its underside, keys and channels with it, and a box wall for
//! each pour.
//!
//! The board keeps the halves apart by its thickness; the silicone halves, put together without it, leave the part.
//! Undercuts are allowed: silicone gives way. Not promised: that it gives way everywhere without tearing.

use crate::files::stl::grid_place;
use crate::mold::figures::Figures;
use crate::mold::layout::{BEYOND, EDGE};
use crate::mold::plan::Plan;
use crate::mold::rigid::{channel, key};
use crate::solid::{NotSolid, Solid, cuboid};
use glam::DVec3;

/// A lip around the box walls keeps them in place: its height and width, mm.
pub const LIP: f64 = 3.0;

/// Half the board's thickness: so much that the dents of the keys leave a floor, and then on the files' grid. Part and
/// parting are on that grid, and stay on it when a half is moved by this: nothing is rounded between the two pours.
pub fn lift(f: &Figures) -> f64 {
    grid_place((f.key_height.value + f.key_clearance.value + EDGE).max(f.wall.value) / 2.0)
}

/// Everything that is printed.
pub struct Prints {
    pub board: Solid,
    pub upper_wall: Solid,
    pub lower_wall: Solid,
}

pub fn prints(part: &Solid, plan: &Plan, f: &Figures) -> Result<Prints, NotSolid> {
    let lift = DVec3::Z * lift(f);
    let all =
        |solids: Vec<Result<Solid, NotSolid>>| Ok(Solid::all(solids.into_iter().collect::<Result<_, _>>()?));
    let (lo, hi, c) = (plan.low, plan.high, plan.parting);
    let above = Solid::of(&cuboid(lo.with_z(c), hi))?;
    let below = Solid::of(&cuboid(lo, hi.with_z(c)))?;
    let cones: Solid = all(plan.keys.iter().map(|k| key(k.at, f, f.key_clearance.value)).collect())?;
    let dents: Solid = all(plan.keys.iter().map(|k| key(k.at, f, 0.0)).collect())?;
    let channels: Solid = all(plan.sprues.iter().chain(&plan.vents).map(|c| channel(c, 0.0)).collect())?;
    // Channels stand on the board where they come down beside the part.
    let channels = channels.common(&Solid::of(&cuboid(lo.with_z(c), hi + DVec3::Z * BEYOND))?);
    let outer = DVec3::new(1.0, 1.0, 0.0) * (f.wall.value + f.key_clearance.value + LIP);
    let plate = Solid::of(&cuboid(lo.with_z(c) - lift - outer, hi.with_z(c) + lift + outer))?;
    let master = part.common(&above).with(&cones.common(&above)).with(&channels).moved(lift);
    let master = master.with(&part.common(&below).moved(-lift));
    let board = plate
        .with(&master)
        .minus(&dents.common(&above.with(&below)).moved(-lift))
        .with(&lips(plan, f, lift)?);
    Ok(Prints {
        board,
        upper_wall: wall(plan, f, c, hi.z)?.moved(lift),
        lower_wall: wall(plan, f, lo.z, c)?.moved(-lift),
    })
}

/// A box without floor and lid around the pour.
fn wall(plan: &Plan, f: &Figures, from: f64, to: f64) -> Result<Solid, NotSolid> {
    let out = DVec3::new(1.0, 1.0, 0.0) * f.wall.value;
    let whole = cuboid(plan.low.with_z(from) - out, plan.high.with_z(to) + out);
    let inside = cuboid(plan.low.with_z(from - BEYOND), plan.high.with_z(to + BEYOND));
    Ok(Solid::of(&whole)?.minus(&Solid::of(&inside)?))
}

fn lips(plan: &Plan, f: &Figures, lift: DVec3) -> Result<Solid, NotSolid> {
    let near = DVec3::new(1.0, 1.0, 0.0) * (f.wall.value + f.key_clearance.value);
    let outer = near + DVec3::new(LIP, LIP, 0.0);
    let tall = lift + DVec3::Z * LIP;
    let at = |v: DVec3| v.with_z(plan.parting);
    let ring = Solid::of(&cuboid(at(plan.low) - outer - tall, at(plan.high) + outer + tall))?;
    let tall = tall + DVec3::Z * BEYOND;
    Ok(ring.minus(&Solid::of(&cuboid(at(plan.low) - near - tall, at(plan.high) + near + tall))?))
}

/// What both pours become around a board (as written), with the board taken away: lower and upper silicone half.
pub fn pours(board: &Solid, plan: &Plan, f: &Figures) -> Result<[Solid; 2], NotSolid> {
    let lift = DVec3::Z * lift(f);
    let (lo, hi, c) = (plan.low, plan.high, plan.parting);
    let below = Solid::of(&cuboid(lo - lift, hi.with_z(c) - lift))?;
    let above = Solid::of(&cuboid(lo.with_z(c) + lift, hi + lift))?;
    // The dents are filled by the lower pour.
    let dents =
        Solid::all(plan.keys.iter().map(|k| key(k.at, f, 0.0)).collect::<Result<_, _>>()?).moved(-lift);
    let dents = dents.common(&Solid::of(&cuboid(lo.with_z(c) - lift, hi.with_z(c) + lift))?);
    Ok([below.with(&dents).minus(board).moved(lift), above.minus(board).moved(-lift)])
}
