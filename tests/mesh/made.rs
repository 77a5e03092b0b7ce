//! Gives assemblies whose verdict follows from how they are made, in pairs: one that locks, one that does not.
//!
//! Not promised: that they are sensible joinery. Lengths in millimetres, a few tens at most.

use super::files::{Made, MadePart};
use super::poly::{Poly, block, cells, convex, ngon, prism, tube, voxels};
use crate::support::Dice;
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;
use std::f64::consts::PI;

const LOCKED: [&str; 2] = ["locked", "locked"];
const FREE: [&str; 2] = ["free", "free"];
/// No translation, but a turn.
const TURNS: [&str; 2] = ["locked", "free"];

fn part(id: impl Into<String>, held: bool, poly: Poly) -> MadePart {
    MadePart { id: id.into(), poly, held }
}

fn made(name: impl Into<String>, want: [&'static str; 2], parts: Vec<MadePart>) -> Made {
    Made { name: name.into(), parts, want }
}

/// A word for the first of two twins or the second.
fn pick<T>(first: bool, a: T, b: T) -> T {
    if first { a } else { b }
}

/// A tail in a groove slides along it; with a block at each end it does not.
pub fn dovetail(open: bool) -> Made {
    let socket = [[0., 0.], [30., 0.], [30., 20.], [18., 20.], [22., 10.], [8., 10.], [12., 20.], [0., 20.]];
    let tail = [[8., 10.], [22., 10.], [18., 20.], [12., 20.]];
    let mut parts =
        vec![part("socket", true, prism(&socket, 0., 40.)), part("tail", false, prism(&tail, 0., 40.))];
    if !open {
        parts.push(part("front", true, block([0., 0., -5.], [30., 20., 0.])));
        parts.push(part("back", true, block([0., 0., 40.], [30., 20., 45.])));
    }
    made(pick(open, "dovetail-slides", "dovetail-between-stops"), pick(open, FREE, LOCKED), parts)
}

/// A peg with n sides in a hole with n sides slides; between plates it does not.
pub fn peg(n: usize, open: bool) -> Made {
    let (hole, rim) = (ngon(n, 10., 0.3), ngon(n, 20., 0.3));
    let mut parts =
        vec![part("ring", true, tube(&rim, &hole, 0., 30.)), part("peg", false, prism(&hole, 0., 30.))];
    if !open {
        parts.push(part("floor", true, block([-20., -20., -5.], [20., 20., 0.])));
        parts.push(part("lid", true, block([-20., -20., 30.], [20., 20., 35.])));
    }
    made(format!("peg-{n}-{}", pick(open, "slides", "capped")), pick(open, FREE, LOCKED), parts)
}

/// A hole made of n blocks, each beside the next, all held: no pair knows more than one direction of the slide.
pub fn staves(n: usize, open: bool) -> Made {
    let (hole, rim) = (ngon(n, 10., 0.1), ngon(n, 16., 0.1));
    let stave = |k: usize| {
        let j = (k + 1) % n;
        part(format!("stave-{k}"), true, prism(&[hole[k], rim[k], rim[j], hole[j]], 0., 20.))
    };
    let mut parts: Vec<MadePart> = (0..n).map(stave).collect();
    parts.push(part("core", false, prism(&hole, 0., 20.)));
    if !open {
        parts.push(part("floor", true, block([-16., -16., -5.], [16., 16., 0.])));
        parts.push(part("lid", true, block([-16., -16., 20.], [16., 16., 25.])));
    }
    made(format!("staves-{n}-{}", pick(open, "slides", "capped")), pick(open, FREE, LOCKED), parts)
}

/// Two sliders at right angles with a slanted tongue between them: one moves only when the other does.
pub fn slanted_sliders(open: bool) -> Made {
    let (lo, hi) = (0., 10.);
    let bar = |x: [f64; 2], y: [f64; 2]| block([x[0], y[0], lo], [x[1], y[1], hi]);
    let across = [[-5., 0.], [25., 0.], [25., 10.], [15., 10.], [9., 4.], [6., 4.], [12., 10.], [-5., 10.]];
    let along =
        [[6.5, 4.5], [9.5, 4.5], [17., 12.], [20., 12.], [20., 30.], [5., 30.], [5., 12.], [14., 12.]];
    let mut parts = vec![
        part("floor", true, block([-20., -20., -5.], [40., 40., 0.])),
        part("lid", true, block([-20., -20., 10.], [40., 40., 15.])),
        part("below", true, bar([-10., 30.], [-5., 0.])),
        part("above-left", true, bar([-5., 2.], [10., 12.])),
        part("above-right", true, bar([22., 25.], [10., 12.])),
        part("left", true, bar([2., 5.], [14., 30.])),
        part("right", true, bar([20., 23.], [14., 30.])),
        part("across", false, prism(&across, lo, hi)),
        part("along", false, prism(&along, lo, hi)),
    ];
    if !open {
        parts.push(part("stop-left", true, bar([-10., -5.], [0., 10.])));
        parts.push(part("stop-right", true, bar([25., 30.], [0., 10.])));
    }
    made(pick(open, "sliders-slanted", "sliders-slanted-stopped"), pick(open, FREE, LOCKED), parts)
}

/// Three blocks around a point in a triangular frame: all slide along their walls at once, in three directions, or
/// none does. With one corner of the frame filled none can.
pub fn iris(open: bool) -> Made {
    let wall = ngon(3, 30., -PI / 6.); // walls run to the next corner
    let at = |k: usize| DVec3::new(wall[k % 3][0], wall[k % 3][1], 0.);
    // Each block lacks a tenth of its wall at either end.
    let share = |p: DVec3, q: DVec3, t: f64| {
        let x = p.lerp(q, t);
        [x.x, x.y]
    };
    let blade = |k: usize| {
        let (a, b) = (at(k), at(k + 1));
        let ring = [
            share(a, b, 0.1),
            share(a, b, 0.9),
            share(b, DVec3::ZERO, 0.1),
            [0., 0.],
            share(a, DVec3::ZERO, 0.1),
        ];
        part(format!("blade-{k}"), false, prism(&ring, 0., 10.))
    };
    let big = ngon(3, 50., -PI / 6.);
    let mut parts = vec![
        part("frame", true, tube(&big, &wall, 0., 10.)),
        part("floor", true, block([-60., -60., -5.], [60., 60., 0.])),
        part("lid", true, block([-60., -60., 10.], [60., 60., 15.])),
    ];
    parts.extend((0..3).map(blade));
    if !open {
        let (a, b, c) = (at(2), at(0), at(1));
        let fill = [[b.x, b.y], share(b, c, 0.1), share(b, DVec3::ZERO, 0.1), share(b, a, 0.1)];
        parts.push(part("filling", true, prism(&fill, 0., 10.)));
    }
    made(pick(open, "iris", "iris-filled"), pick(open, FREE, LOCKED), parts)
}

/// Blocks whose sides lean in and out by turns, one layer, n by m, the rim held; with straight sides they lift.
pub fn leaning_blocks(n: i32, m: i32, lift: bool) -> Made {
    let lean = pick(lift, 0., 0.3); // tangent of the sides' angle; blocks stay wider than nothing at top and bottom
    let mut parts = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let s = if (i + j) % 2 == 0 { lean } else { -lean };
            let centre = DVec3::new(10. * f64::from(i), 10. * f64::from(j), 0.);
            let side = |n: DVec3| (n, n.dot(centre) + 5.);
            let planes = [
                side(DVec3::new(1., 0., -s)),
                side(DVec3::new(-1., 0., -s)),
                side(DVec3::new(0., 1., s)),
                side(DVec3::new(0., -1., s)),
                (DVec3::Z, 6.),
                (-DVec3::Z, 6.),
            ];
            let rim = i == 0 || j == 0 || i == n - 1 || j == m - 1;
            parts.push(part(format!("b-{i}-{j}"), rim, convex(&planes)));
        }
    }
    made(format!("blocks-{n}x{m}-{}", pick(lift, "straight", "leaning")), pick(lift, FREE, LOCKED), parts)
}

/// A full ring of voussoirs in a held ring: between two plates nothing moves, without them each slides.
pub fn voussoirs(n: usize, open: bool) -> Made {
    let [inner, outer, rim] = [10., 20., 25.].map(|r| ngon(n, r, 0.2));
    let stone = |k: usize| {
        let j = (k + 1) % n;
        part(format!("stone-{k}"), false, prism(&[inner[k], outer[k], outer[j], inner[j]], 0., 12.))
    };
    let mut parts: Vec<MadePart> = (0..n).map(stone).collect();
    parts.push(part("ring", true, tube(&rim, &outer, 0., 12.)));
    if !open {
        parts.push(part("floor", true, block([-25., -25., -5.], [25., 25., 0.])));
        parts.push(part("lid", true, block([-25., -25., 12.], [25., 25., 17.])));
    }
    made(format!("voussoirs-{n}-{}", pick(open, "slide", "between-plates")), pick(open, FREE, LOCKED), parts)
}

/// A wedge between cheeks that lean by a small angle (radians), on a floor, between end plates: where it is wider
/// above it draws out, where it is narrower it does not.
pub fn wedge(lean: f64, draws: bool) -> Made {
    let s = pick(draws, 1., -1.) * lean.tan();
    let x = |z: f64| 5. + s * (z - 10.);
    let ring = [[-x(0.), 0.], [x(0.), 0.], [x(20.), 20.], [-x(20.), 20.]];
    let left = [[-15., 0.], [-x(0.), 0.], [-x(20.), 20.], [-15., 20.]];
    let right = [[x(0.), 0.], [15., 0.], [15., 20.], [x(20.), 20.]];
    let parts = vec![
        part("wedge", false, prism(&ring, 0., 10.)),
        part("left", true, prism(&left, 0., 10.)),
        part("right", true, prism(&right, 0., 10.)),
        part("floor", true, block([-15., -5., 0.], [15., 0., 10.])),
        part("front", true, block([-15., -5., -5.], [15., 20., 0.])),
        part("back", true, block([-15., -5., 10.], [15., 20., 15.])),
    ];
    made(format!("wedge-{lean:e}-{}", pick(draws, "draws", "stays")), pick(draws, FREE, LOCKED), parts)
}

/// Six plates around a body, held.
fn case(half: f64) -> Vec<MadePart> {
    let name =
        |axis: usize, side: f64| format!("{}-{}", ["x", "y", "z"][axis], pick(side > 0., "high", "low"));
    let cut = |axis: usize, side: f64| {
        let (mut lo, mut hi) = ([-half; 3], [half; 3]);
        if side > 0. {
            (lo[axis], hi[axis]) = (half, half + 3.)
        } else {
            (lo[axis], hi[axis]) = (-half - 3., -half)
        }
        block(lo, hi)
    };
    let all = (0..3).flat_map(|axis| [-1., 1.].map(|side| part(name(axis, side), true, cut(axis, side))));
    all.collect()
}

/// An octahedron in a case touches each wall in a point and turns; a cube in it does not.
pub fn jack(turns: bool) -> Made {
    let signs = [-1., 1.];
    let planes: Vec<(DVec3, f64)> = signs
        .iter()
        .flat_map(|&x| signs.iter().flat_map(move |&y| signs.map(move |z| (DVec3::new(x, y, z), 10.))))
        .collect();
    let mut parts = case(10.);
    parts.push(part("jack", false, if turns { convex(&planes) } else { block([-10.; 3], [10.; 3]) }));
    made(pick(turns, "octahedron-in-case", "cube-in-case"), pick(turns, TURNS, LOCKED), parts)
}

/// Bars that lie in notches of each other, all cut from one grid: the first twin can begin with its top bar, the
/// second has a lid.
pub fn notched_bars(open: bool) -> Made {
    let low = cells([0, 0, 0], [7, 2, 2]).filter(|c| !((c[0] == 2 || c[0] == 3 || c[0] == 4) && c[2] == 1));
    let high = cells([2, -3, 0], [5, 5, 2]).filter(|c| !((0..2).contains(&c[1]) && c[2] == 0));
    let mut parts = vec![part("low", true, voxels(low, 4.)), part("high", false, voxels(high, 4.))];
    if !open {
        parts.push(part("lid", true, block([0., -12., 8.], [28., 20., 12.])));
    }
    made(pick(open, "bars-notched", "bars-notched-lid"), pick(open, FREE, LOCKED), parts)
}

/// Sheets with tongues, like a jigsaw's, in one layer: each lifts; between plates, with the rim held, none moves.
pub fn jigsaw(n: i32, open: bool) -> Made {
    let mut parts = Vec::new();
    for i in 0..n {
        for j in 0..n {
            // A cell of 6 x 6 units; a T-shaped tongue of this one in the next one's side.
            let (x, y) = (6 * i, 6 * j);
            let own = |c: &[i32; 3]| c[0].div_euclid(6) == i && c[1].div_euclid(6) == j;
            let tongue_x = |i: i32, j: i32| {
                [[6, 3], [7, 2], [7, 3], [7, 4]].map(|[u, v]| [6 * i + u, 6 * j + v, 0]).into_iter()
            };
            let tongue_y = |i: i32, j: i32| {
                [[2, 6], [1, 7], [2, 7], [3, 7]].map(|[u, v]| [6 * i + u, 6 * j + v, 0]).into_iter()
            };
            let all: std::collections::BTreeSet<[i32; 3]> =
                cells([x, y, 0], [x + 6, y + 6, 1]).filter(own).collect();
            let mut body = all;
            if i + 1 < n {
                body.extend(tongue_x(i, j))
            }
            if j + 1 < n {
                body.extend(tongue_y(i, j))
            }
            if i > 0 {
                tongue_x(i - 1, j).for_each(|c| {
                    body.remove(&c);
                })
            }
            if j > 0 {
                tongue_y(i, j - 1).for_each(|c| {
                    body.remove(&c);
                })
            }
            let rim = i == 0 || j == 0 || i == n - 1 || j == n - 1;
            parts.push(part(format!("p-{i}-{j}"), rim, voxels(body, 2.)));
        }
    }
    if !open {
        let side = f64::from(12 * n);
        parts.push(part("floor", true, block([0., 0., -2.], [side, side, 0.])));
        parts.push(part("lid", true, block([0., 0., 2.], [side, side, 4.])));
    }
    made(format!("jigsaw-{n}-{}", pick(open, "lifts", "pressed")), pick(open, FREE, LOCKED), parts)
}

/// A body in the hollow of another: it fills the hollow, or is shorter by some and moves.
pub fn kernel(loose: bool) -> Made {
    let shell = block([-20.; 3], [20.; 3]);
    let mut hollow = block([-8.; 3], [8.; 3]);
    hollow.faces.iter_mut().for_each(|f| f.reverse());
    let top = pick(loose, 7., 8.);
    let kernel = block([-8.; 3], [8., 8., top]);
    let parts = vec![part("shell", true, shell.with(hollow)), part("kernel", false, kernel)];
    made(pick(loose, "kernel-loose", "kernel-tight"), pick(loose, FREE, LOCKED), parts)
}

/// A collar that turns on a round pin of n sides: flat sides jam it. With a gap between all flats and no touch it is free.
pub fn turntable(open: bool) -> Made {
    // Two discs, face on face, between two plates: the middle one turns and shifts.
    let mut parts = vec![
        part("below", true, prism(&ngon(24, 20., 0.), 0., 5.)),
        part("disc", false, prism(&ngon(7, 15., 0.4), 5., 9.)),
        part("above", true, prism(&ngon(24, 20., 0.1), 9., 14.)),
    ];
    if !open {
        let ring = tube(&ngon(7, 22., 0.4), &ngon(7, 15., 0.4), 5., 9.);
        parts.push(part("ring", true, ring));
    }
    made(pick(open, "disc-between-plates", "disc-in-ring"), pick(open, FREE, LOCKED), parts)
}

/// A tiny key of 0.01 mm in a slot of a beam of a metre, and its stop.
pub fn tiny_and_huge(open: bool) -> Made {
    let u = 0.01;
    let beam = [
        [0., 0.],
        [1000., 0.],
        [1000., 10.],
        [500. + u, 10.],
        [500. + u, 10. - u],
        [500., 10. - u],
        [500., 10.],
        [0., 10.],
    ];
    let key = [[500., 10. - u], [500. + u, 10. - u], [500. + u, 10.], [500., 10.]];
    let mut parts = vec![
        part("beam", true, prism(&beam, 0., u)),
        part("key", false, prism(&key, 0., u)),
        part("floor", true, block([499., 9., -1.], [501., 11., 0.])),
        part("lid", true, block([499., 9., u], [501., 11., 1.])),
    ];
    if !open {
        parts.push(part("top", true, block([499., 10., 0.], [501., 11., u])));
    }
    made(pick(open, "tiny-key", "tiny-key-shut"), pick(open, FREE, LOCKED), parts)
}

/// A chain of blocks face to face in a held channel, all free: they slide together along it.
pub fn train(n: usize, open: bool) -> Made {
    let channel =
        [[-10., -5.], [10., -5.], [10., 10.], [5., 10.], [5., 0.], [-5., 0.], [-5., 10.], [-10., 10.]];
    let length = 10. * n as f64;
    let mut parts = vec![
        part("channel", true, prism(&channel, 0., length)),
        part("lid", true, block([-5., 10., 0.], [5., 12., length])),
    ];
    for k in 0..n {
        let z = 10. * k as f64;
        parts.push(part(format!("car-{k}"), false, block([-5., 0., z], [5., 10., z + 10.])));
    }
    parts.push(part("start", true, block([-10., -5., -5.], [10., 10., 0.])));
    if !open {
        parts.push(part("end", true, block([-10., -5., length], [10., 10., length + 5.])));
    }
    made(format!("train-{n}-{}", pick(open, "rolls", "stopped")), pick(open, FREE, LOCKED), parts)
}

/// A screw of facets would jam; a twisted prism in its own hole is locked at once, a straight one slides.
pub fn twisted(open: bool) -> Made {
    let turn = pick(open, 0., 0.2);
    let ring = |r: f64, a: f64| ngon(4, r, a);
    let loft = |outer: bool| {
        let (lo, hi) =
            if outer { (ring(20., 0.), ring(20., turn)) } else { (ring(10., 0.), ring(10., turn)) };
        (lo, hi)
    };
    let triangles = |lo: usize, hi: usize, n: usize, out: bool| -> Vec<Vec<usize>> {
        (0..n)
            .flat_map(|k| {
                let j = (k + 1) % n;
                let pair = [vec![lo + k, lo + j, hi + j], vec![lo + k, hi + j, hi + k]];
                pair.map(|mut f| {
                    if !out {
                        f.reverse()
                    }
                    f
                })
            })
            .collect()
    };
    let at = |ring: &[[f64; 2]], z: f64| ring.iter().map(|p| DVec3::new(p[0], p[1], z)).collect::<Vec<_>>();
    let (pl, ph) = loft(false);
    let mut core = Poly {
        points: [at(&pl, 0.), at(&ph, 20.)].concat(),
        faces: vec![vec![3, 2, 1, 0], vec![4, 5, 6, 7]],
    };
    core.faces.extend(triangles(0, 4, 4, true));
    let (ol, oh) = loft(true);
    let mut nut =
        Poly { points: [at(&ol, 0.), at(&oh, 20.), at(&pl, 0.), at(&ph, 20.)].concat(), faces: vec![] };
    nut.faces.extend(triangles(0, 4, 4, true));
    nut.faces.extend(triangles(8, 12, 4, false));
    for k in 0..4 {
        let j = (k + 1) % 4;
        nut.faces.push(vec![j, k, 8 + k, 8 + j]);
        nut.faces.push(vec![4 + k, 4 + j, 12 + j, 12 + k]);
    }
    made(
        pick(open, "core-straight", "core-twisted"),
        pick(open, FREE, LOCKED),
        vec![part("nut", true, nut), part("core", false, core)],
    )
}

/// All families, both twins of each.
pub fn all() -> Vec<Made> {
    let both = |f: &dyn Fn(bool) -> Made| [f(true), f(false)];
    [
        Vec::from(both(&dovetail)),
        [3, 6, 24].iter().flat_map(|&n| both(&|o| peg(n, o))).collect(),
        [5, 8].iter().flat_map(|&n| both(&|o| staves(n, o))).collect(),
        both(&slanted_sliders).into(),
        both(&iris).into(),
        both(&|w| leaning_blocks(5, 5, w)).into(),
        both(&|o| voussoirs(8, o)).into(),
        [1e-1, 1e-2, 1e-3].iter().flat_map(|&a| both(&|d| wedge(a, d))).collect(),
        both(&jack).into(),
        both(&notched_bars).into(),
        both(&|o| jigsaw(3, o)).into(),
        both(&kernel).into(),
        both(&turntable).into(),
        both(&|o| train(6, o)).into(),
        both(&twisted).into(),
        both(&tiny_and_huge).into(),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// The assembly with everything moved.
pub fn far(m: Made, by: f64) -> Made {
    let shift = DAffine3::from_translation(DVec3::new(by, -by, by));
    let parts = m.parts.into_iter().map(|p| MadePart { poly: p.poly.moved(shift), ..p }).collect();
    Made { name: format!("{}-far", m.name), parts, ..m }
}

/// A cube of n x n x n cells cut at random into pieces that hang together; the first is held. The verdict is not
/// known from how it is made.
pub fn cut_cube(n: i32, pieces: usize, dice: &mut Dice) -> Made {
    let all: Vec<[i32; 3]> = cells([0; 3], [n; 3]).collect();
    let mut owner: BTreeMap<[i32; 3], usize> = BTreeMap::new();
    for (piece, &k) in dice.shuffled(all.len()).iter().take(pieces).enumerate() {
        owner.insert(all[k], piece);
    }
    while owner.len() < all.len() {
        let open: Vec<([i32; 3], usize)> = all
            .iter()
            .filter(|c| !owner.contains_key(*c))
            .flat_map(|c| sides(*c).into_iter().filter_map(|d| owner.get(&d).map(|o| (*c, *o))))
            .collect();
        let (cell, piece) = open[dice.below(open.len())];
        owner.insert(cell, piece);
    }
    let part = |p: usize| {
        let own = owner.iter().filter(|(_, o)| **o == p).map(|(c, _)| *c);
        part(format!("p{p}"), p == 0, voxels(own, 5.))
    };
    made(format!("cut-cube-{n}-{pieces}"), ["?", "?"], (0..pieces).map(part).collect())
}

fn sides(c: [i32; 3]) -> Vec<[i32; 3]> {
    let step = |axis: usize, by: i32| {
        let mut d = c;
        d[axis] += by;
        d
    };
    (0..3).flat_map(|axis| [step(axis, -1), step(axis, 1)]).collect()
}
