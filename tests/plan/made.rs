//! Assemblies that straight single moves do not take apart: a twist-lock, a thread, a ring of three, a bent way, a hook.

use super::build::{assembly, cuboid, prism, v};
use super::{Assembly, Made, Mobility, Patch};
use glam::{DAffine3, DQuat, DVec3};
use weavelock::assembly::PartIx;
use weavelock::solid::Cell;

/// A box whose lid has a slot along y, and a bar in it that lies along x under the lid: it leaves only after a quarter
/// turn. `lip`: the width of a rib that hangs from the lid into the bar's way, all the way down; 0: none.
pub fn twist_lock(lip: f64) -> Made {
    let mut case = vec![
        cuboid([-3., -3., 0.], [3., 3., 1.]),
        cuboid([-3., -3., 1.], [-2.5, 3., 2.]),
        cuboid([2.5, -3., 1.], [3., 3., 2.]),
        cuboid([-2.5, -3., 1.], [2.5, -2.5, 2.]),
        cuboid([-2.5, 2.5, 1.], [2.5, 3., 2.]),
        cuboid([-3., -3., 2.], [-0.7, 3., 3.]),
        cuboid([0.7, -3., 2.], [3., 3., 3.]),
        cuboid([-0.7, -3., 2.], [0.7, -2.2, 3.]),
        cuboid([-0.7, 2.2, 2.], [0.7, 3., 3.]),
    ];
    if lip > 0.0 {
        let turned = DQuat::from_rotation_z(0.8);
        let at = |u: f64, w: f64, z: f64| turned * v(u, w, z);
        case.push(prism(&[[1.8, 0.], [2.2, 0.], [2.2, lip], [1.8, lip]], 1.0, 2.0, at));
    }
    let key = vec![cuboid([-2., -0.5, 1.], [2., 0.5, 2.]), cuboid([-0.4, -0.4, 2.], [0.4, 0.4, 5.])];
    assembly(vec![("case", case), ("key", key)])
}

/// The twist lock on a case with chambers for dice, six in a row, which fit them on all sides.
pub fn twist_lock_over_dice(rows: usize) -> Made {
    let lock = twist_lock(0.0).0;
    over_dice(rows, lock.cells(PartIx(0)), vec![("key", lock.cells(PartIx(1)))])
}

/// The ring of three, on its own beside a case with dice.
pub fn ring_beside_dice(rows: usize) -> Made {
    let ring = ring_of_three().0;
    let aside =
        |p| ring.cells(p).iter().map(|c| c.moved(&DAffine3::from_translation(v(0., 20., 0.)))).collect();
    let parts = ring.parts.iter().zip(ring.ids()).map(|(part, p)| (part.id.as_str(), aside(p)));
    over_dice(rows, vec![cuboid([-3., -3., 0.], [3., 3., 1.])], parts.collect())
}

fn over_dice(rows: usize, mut case: Vec<Cell>, others: Vec<(&str, Vec<Cell>)>) -> Made {
    let mut dice = Vec::new();
    for row in 0..rows {
        let z = -2.0 * (row as f64 + 1.0);
        case.push(cuboid([-3., -3., z + 1.], [3., 3., z + 2.]));
        case.push(cuboid([-3., 1., z], [3., 3., z + 1.]));
        case.push(cuboid([-3., -3., z], [3., 0., z + 1.]));
        for column in 0..6 {
            let x = column as f64 - 3.0;
            let between = |lo: f64, hi: f64| cuboid([x + lo, 0., z], [x + hi, 1., z + 1.]);
            case.extend([between(0.0, 0.2), between(0.8, 1.0)]);
            dice.push((format!("die-{row}-{column}"), vec![between(0.2, 0.8)]));
        }
    }
    let low = -2.0 * rows as f64;
    case.push(cuboid([-3., -3., low - 1.], [3., 3., low]));
    let dice = dice.iter().map(|(id, cells): &(String, Vec<Cell>)| (id.as_str(), cells.clone()));
    assembly([("case", case)].into_iter().chain(others).chain(dice).collect())
}

/// Advance of the thread for each turn, and blocks for each turn of its ridge.
pub const LEAD: f64 = 2.0;
const BLOCKS: usize = 24;

/// A bolt with a ridge of blocks on a helix of two turns, closed below, and a nut that has one finger between them.
pub fn thread() -> Made {
    let slope = (LEAD / (std::f64::consts::TAU * 1.25)).atan();
    let on_helix = |turn: f64, height: f64, size: [f64; 3]| -> Cell {
        let q = DQuat::from_rotation_z(turn) * DQuat::from_rotation_x(slope);
        let at = |u: f64, w: f64, z: f64| q * v(u, w, z) + v(0., 0., height);
        let [far, half, thick] = size;
        prism(&[[1.0, -half], [far, -half], [far, half], [1.0, half]], -thick / 2.0, thick / 2.0, at)
    };
    let mut bolt = vec![cuboid([-0.6, -0.6, -2.0], [0.6, 0.6, 6.]), cuboid([-3., -3., -3.], [3., 3., -2.])];
    for k in 0..2 * BLOCKS {
        let turn = std::f64::consts::TAU * k as f64 / BLOCKS as f64;
        bolt.push(on_helix(turn, LEAD * k as f64 / BLOCKS as f64, [1.5, 0.12, 0.6]));
    }
    let ring = [
        cuboid([-2.5, -2.5, 0.7], [2.5, -1.7, 1.3]),
        cuboid([-2.5, 1.7, 0.7], [2.5, 2.5, 1.3]),
        cuboid([-2.5, -1.7, 0.7], [-1.7, 1.7, 1.3]),
        cuboid([1.7, -1.7, 0.7], [2.5, 1.7, 1.3]),
    ];
    // Between the first and the second turn, over the start of the helix.
    let finger = on_helix(0.0, LEAD / 2.0, [1.7, 0.2, 0.8]);
    let mut nut = ring.to_vec();
    nut.push(finger);
    let (mut asm, patches) = assembly(vec![("bolt", bolt), ("nut", nut)]);
    asm.parts[0].mobility = Mobility::Held;
    (asm, patches)
}

/// Corners of the ring of three.
pub fn corner(k: usize) -> DVec3 {
    let angle = std::f64::consts::TAU * k as f64 / 3.0;
    v(angle.cos(), angle.sin(), 0.0) * (6.0 / 3.0_f64.sqrt())
}

/// Three parts in a ring: each holds the tongue of the one before in a tunnel along their side of a triangle, so each
/// pair can only slide along its own side, and all three must move at once.
pub fn ring_of_three() -> Made {
    let part = |k: usize| {
        let bar = |from: DVec3, to: DVec3, side: [f64; 2], up: [f64; 2]| {
            let along = (to - from).normalize();
            let across = DVec3::Z.cross(along);
            let length = (to - from).length();
            let at = |u: f64, w: f64, z: f64| from + along * u + across * w + DVec3::Z * z;
            prism(&[[0., side[0]], [length, side[0]], [length, side[1]], [0., side[1]]], up[0], up[1], at)
        };
        let toward = |a: usize, b: usize, l: f64| corner(a) + (corner(b) - corner(a)).normalize() * l;
        let (next, last) = ((k + 1) % 3, (k + 2) % 3);
        let tongue = bar(toward(k, next, 1.), toward(k, next, 4.), [-0.2, 0.2], [-0.2, 0.2]);
        let (far, near) = (toward(last, k, 3.), toward(last, k, 5.));
        let wall = |side, up| bar(far, near, side, up);
        vec![
            tongue,
            wall([-0.4, -0.2], [-0.4, 0.4]),
            wall([0.2, 0.4], [-0.4, 0.4]),
            wall([-0.2, 0.2], [-0.4, -0.2]),
            wall([-0.2, 0.2], [0.2, 0.4]),
        ]
    };
    assembly(vec![("a", part(0)), ("b", part(1)), ("c", part(2))])
}

/// A block in a channel with two bends: up a little, sideways, and up again.
pub fn two_bends() -> Made {
    let bar = |x0: f64, x1: f64, z0: f64, z1: f64| cuboid([x0, 0., z0], [x1, 1., z1]);
    let walls = vec![
        bar(-1., 0., -1., 2.),
        bar(1., 2., -1., 1.),
        bar(0., 1., -1., 0.),
        bar(-1., 1., 2., 5.),
        bar(2., 3., -1., 5.),
        cuboid([-1., -1., -1.], [3., 0., 5.]),
        cuboid([-1., 1., -1.], [3., 2., 5.]),
    ];
    held(assembly(vec![("block", vec![bar(0., 1., 0., 1.)]), ("maze", walls)]), 1)
}

/// The same assembly with one part held.
pub fn held((mut asm, patches): (Assembly, Vec<Patch>), part: usize) -> Made {
    asm.parts[part].mobility = Mobility::Held;
    (asm, patches)
}

/// A cover with a tab under an overhang at one end and a wall at the other: it can neither be lifted nor pulled, but it
/// can be swung up about its tab and then drawn out.
pub fn hook() -> Made {
    let bar = |x0: f64, x1: f64, z0: f64, z1: f64| cuboid([x0, 0., z0], [x1, 1., z1]);
    let case = vec![
        bar(-1.0, -0.6, -0.6, 0.6),
        bar(-0.6, 0., 0.3, 0.6),
        bar(-0.6, 0.3, -0.6, -0.3),
        bar(0.3, 4., -0.6, 0.),
        bar(4., 4.5, -0.6, 0.5),
        cuboid([-1., -1., -0.6], [4.5, 0., 4.]),
        cuboid([-1., 1., -0.6], [4.5, 2., 4.]),
    ];
    let cover = vec![bar(0.05, 3.95, 0., 0.2), bar(-0.45, 0.05, 0., 0.2)];
    held(assembly(vec![("cover", cover), ("case", case)]), 1)
}
