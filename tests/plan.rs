//! Plans: what must come apart does, what must not does not, and no plan that overlaps is accepted.

mod build;
mod journeys;
mod made;
mod stuck;
mod turns;
mod wanted;
mod woven;

use build::{assembly, cell, cuboid, prism, turned, v};
use glam::DVec3;
use weavelock::assembly::{Assembly, Mobility};
use weavelock::contact::Patch;
use weavelock::sequence::{Motion, Outcome, Plan, Shift, Step, plan};
use weavelock::solid::Cell;
use weavelock::verify::plan::{Checked, Way, by_faces, by_program, check};

type Made = (Assembly, Vec<Patch>);

/// The straight move of a step.
fn shift(step: &mut Step) -> &mut Shift {
    match &mut step.motion {
        Motion::Translation(shift) => shift,
        other => panic!("not straight: {other:?}"),
    }
}

fn planned(made: &Made) -> Plan<()> {
    let p = plan(&made.0, &made.1, |_| None::<()>).expect("sane parts");
    match check(&made.0, &p) {
        Checked::Valid { .. } => p,
        bad => panic!("own plan refused: {bad:?}\n{p:#?}"),
    }
}

/// As many steps as given, at every attitude; returns the plan of the last.
fn comes_apart(made: &Made, steps: usize) -> Plan<()> {
    [0.0, 0.4, 1.1, 2.9]
        .map(|angle| {
            let p = planned(&turned(&made.0, angle));
            assert_eq!(p.outcome, Outcome::Assembled, "turned by {angle}: {p:#?}");
            assert_eq!(p.steps.len(), steps, "turned by {angle}: {p:#?}");
            p
        })
        .into_iter()
        .next_back()
        .expect("four attitudes")
}

fn stays_together(made: &Made, parts: usize) {
    for angle in [0.0, 0.4, 1.1, 2.9] {
        let p = planned(&turned(&made.0, angle));
        assert_eq!(p.outcome, Outcome::NotFound, "turned by {angle}: {p:#?}");
        assert_eq!(p.stuck[0].parts.len(), parts);
        assert_eq!(p.stuck[0].straight_moves, weavelock::sequence::Straight::None, "turned by {angle}");
    }
}

#[test]
fn stacked_boxes() {
    let made = assembly(vec![
        ("low", vec![cuboid([0., 0., 0.], [2., 2., 1.])]),
        ("mid", vec![cuboid([0., 0., 1.], [2., 2., 2.])]),
        ("top", vec![cuboid([0., 0., 2.], [2., 2., 3.])]),
    ]);
    comes_apart(&made, 2);
}

fn along_y(u: f64, w: f64, l: f64) -> DVec3 {
    v(u, l, w)
}

fn dovetail(plug: bool) -> Made {
    let tail = prism(&[[-1., 0.], [1., 0.], [0.5, 1.], [-0.5, 1.]], 0.0, 3.0, along_y);
    let left = prism(&[[-2., 0.], [-1., 0.], [-0.5, 1.], [-2., 1.]], 0.0, 3.0, along_y);
    let right = prism(&[[1., 0.], [2., 0.], [2., 1.], [0.5, 1.]], 0.0, 3.0, along_y);
    let mut socket = vec![left, right, cuboid([-2., 0., -1.], [2., 3., 0.])];
    if plug {
        socket.push(cuboid([-2., -1., -1.], [2., 0., 1.]));
        socket.push(cuboid([-2., 3., -1.], [2., 4., 1.]));
    }
    assembly(vec![("tail", vec![tail]), ("socket", socket)])
}

#[test]
fn dovetail_slides_one_way_only() {
    comes_apart(&dovetail(false), 1);
    let mut p = planned(&dovetail(false));
    assert_eq!(p.steps[0].clear, 0.0);
    assert!(shift(&mut p.steps[0]).direction[1].abs() > 1.0 - 1e-12, "{p:#?}");
}

#[test]
fn dovetail_closed_at_both_ends_stays() {
    stays_together(&dovetail(true), 2);
}

/// A blind square hole with a peg in it, and a lip of the given width around its mouth.
fn mortise(lip: f64) -> Made {
    let wall = |lo: f64, hi: f64, w: f64| {
        vec![
            cuboid([-2., -2., lo], [2., -1. + w, hi]),
            cuboid([-2., 1. - w, lo], [2., 2., hi]),
            cuboid([-2., -1. + w, lo], [-1. + w, 1. - w, hi]),
            cuboid([1. - w, -1. + w, lo], [2., 1. - w, hi]),
        ]
    };
    let mut hole = vec![cuboid([-2., -2., -1.], [2., 2., 0.])];
    hole.extend(wall(0., 2., 0.));
    if lip > 0.0 {
        hole.extend(wall(2., 2.1, lip));
    }
    assembly(vec![("hole", hole), ("peg", vec![cuboid([-1., -1., 0.], [1., 1., 2.])])])
}

#[test]
fn mortise_lets_its_peg_go_and_with_a_lip_does_not() {
    comes_apart(&mortise(0.0), 1);
    stays_together(&mortise(0.01), 2);
    stays_together(&mortise(0.0001), 2);
}

/// The lip is thin (a hundredth) along the way too: a sampled check would jump over it.
#[test]
fn a_plan_through_a_thin_lip_is_refused() {
    let lip = assembly(vec![
        ("block", vec![cuboid([0., 0., 0.], [1., 1., 1.])]),
        ("gate", vec![cuboid([0., 0., 50.], [2., 0.01, 50.01])]),
    ]);
    let open = assembly(vec![
        ("block", vec![cuboid([0., 0., 0.], [1., 1., 1.])]),
        ("gate", vec![cuboid([0., -0.01, 50.], [2., 0., 50.01])]),
    ]);
    let mut p = planned(&open);
    *shift(&mut p.steps[0]) = Shift::new(DVec3::Z, 60.0, 20.0);
    p.steps[0].parts = vec!["block".into()];
    p.steps[0].stays = vec!["gate".into()];
    p.steps[0].clear = 0.0;
    assert!(matches!(check(&open.0, &p), Checked::Valid { .. }));
    match check(&lip.0, &p) {
        Checked::Invalid { step: 0, depth, t, .. } => {
            assert!((depth - 0.005).abs() < 1e-9, "{depth}");
            assert!((49.0..=50.01).contains(&t), "{t}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn hooked_els_part_sideways_only() {
    let hook = |s: f64| {
        let bar = |lo: [f64; 2], hi: [f64; 2]| {
            let (a, b) = ([lo[0].min(hi[0]), lo[1].min(hi[1])], [lo[0].max(hi[0]), lo[1].max(hi[1])]);
            cuboid([a[0], a[1], 0.], [b[0], b[1], 1.])
        };
        vec![bar([0. * s, 0. * s], [3. * s, 1. * s]), bar([2. * s, 1. * s], [3. * s, 2. * s])]
    };
    let a = hook(1.0);
    let b: Vec<Cell> = vec![cuboid([0., 2., 0.], [3., 3., 1.]), cuboid([1., 1., 0.], [2., 2., 1.])];
    let made = assembly(vec![("a", a), ("b", b), ("stop", vec![cuboid([0., 1., 0.], [1., 2., 1.])])]);
    comes_apart(&made, 2);
}

/// Two dovetailed bars in a well: neither can leave alone, both can be lifted out and then slid apart.
fn pair_in_a_well() -> Made {
    let (tail, _) = dovetail(false);
    let mut parts: Vec<(&str, Vec<Cell>)> =
        vec![("tail", tail.solids[0].cells.clone()), ("socket", tail.solids[1].cells.clone())];
    parts.push((
        "well",
        vec![
            cuboid([-3., -1., -2.], [3., 4., -1.]),
            cuboid([-3., -1., -1.], [3., 0., 1.]),
            cuboid([-3., 3., -1.], [3., 4., 1.]),
            cuboid([-3., 0., -1.], [-2., 3., 1.]),
            cuboid([2., 0., -1.], [3., 3., 1.]),
        ],
    ));
    assembly(parts)
}

#[test]
fn a_pair_leaves_its_well_together() {
    let mut made = pair_in_a_well();
    assert_eq!(comes_apart(&made, 2).steps[0].parts, ["well"]);
    made.0.parts[2].mobility = Mobility::Held;
    assert_eq!(comes_apart(&made, 2).steps[0].parts, ["tail", "socket"]);
}

#[test]
fn held_parts_never_move() {
    let mut made = pair_in_a_well();
    for held in [vec![0], vec![1], vec![2], vec![0, 2]] {
        made.0.parts.iter_mut().for_each(|p| p.mobility = Mobility::Free);
        held.iter().for_each(|&k: &usize| made.0.parts[k].mobility = Mobility::Held);
        let p = planned(&made);
        let moved: Vec<&String> = p.steps.iter().flat_map(|s| &s.parts).collect();
        assert!(held.iter().all(|&k| !moved.contains(&&made.0.parts[k].id)), "{held:?}: {p:#?}");
        let expected = if held.len() == 2 { Outcome::NotFound } else { Outcome::Assembled };
        assert_eq!(p.outcome, expected, "{held:?}");
    }
    let free = planned(&pair_in_a_well());
    for step in &free.steps {
        let moved = |id: &String| if step.parts.contains(id) { Mobility::Held } else { Mobility::Free };
        made.0.parts.iter_mut().for_each(|p| p.mobility = moved(&p.id));
        assert!(matches!(check(&made.0, &free), Checked::Invalid { .. }), "a held part moves in the plan");
    }
}

/// A block between a floor and a ceiling that can leave in one direction only, through a far slot just as wide as it.
fn slot(bearing: f64, wider: f64) -> Made {
    let block = cuboid([-1., -1., 0.], [1., 1., 1.]);
    let (s, c) = bearing.sin_cos();
    let half = s.abs() + c.abs() + wider;
    let flat = |u: f64, w: f64, h: f64| v(u * c - w * s, u * s + w * c, h);
    let bar = |lo: [f64; 2], hi: [f64; 2]| {
        prism(&[[lo[0], lo[1]], [hi[0], lo[1]], [hi[0], hi[1]], [lo[0], hi[1]]], 0., 1., flat)
    };
    let ring = vec![
        bar([5., half], [6., 9.]),
        bar([5., -9.], [6., -half]),
        bar([-9., -9.], [-8., 9.]),
        bar([-8., 8.], [5., 9.]),
        bar([-8., -9.], [5., -8.]),
        cuboid([-20., -20., -1.], [20., 20., 0.]),
        cuboid([-20., -20., 1.], [20., 20., 2.]),
    ];
    assembly(vec![("block", vec![block]), ("ring", ring)])
}

#[test]
fn the_one_direction_through_a_tight_slot_is_found() {
    for bearing in [0.0, 0.3, 0.7, 1.234, 2.0, 4.4] {
        let p = comes_apart(&slot(bearing, 0.0), 1);
        assert!(p.steps[0].clear <= 1e-6, "{p:#?}");
        stays_together(&slot(bearing, -0.01), 2);
    }
}

/// Three bars that pass each other in a ring, each hooked on the next: no group leaves by one straight move.
#[test]
fn burr_needs_its_key() {
    let cross = |key: bool| {
        let x = if key {
            vec![cuboid([-3., -1., -1.], [3., 1., 1.])]
        } else {
            vec![
                cuboid([-3., -1., -1.], [3., 1., 1.]),
                cuboid([-3., -2., -2.], [-2.5, 2., 2.]),
                cuboid([2.5, -2., -2.], [3., 2., 2.]),
            ]
        };
        let frame = vec![
            cuboid([-2.5, 1., -2.], [2.5, 2., 2.]),
            cuboid([-2.5, -2., -2.], [2.5, -1., 2.]),
            cuboid([-2.5, -1., 1.], [2.5, 1., 2.]),
            cuboid([-2.5, -1., -2.], [2.5, 1., -1.]),
        ];
        assembly(vec![("bar", x), ("frame", frame)])
    };
    comes_apart(&cross(true), 1);
    stays_together(&cross(false), 2);
}

#[test]
fn a_proof_of_lock_makes_it_need_bending() {
    let made = dovetail(true);
    let p = plan(&made.0, &made.1, |set| Some(set.len())).expect("sane parts");
    assert_eq!((p.outcome, p.stuck[0].lock), (Outcome::NeedsFlexible, Some(2)));
}

#[test]
fn the_same_plan_with_any_number_of_threads() {
    let made = turned(&pair_in_a_well().0, 0.8);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let five = rayon::ThreadPoolBuilder::new().num_threads(5).build().expect("a pool");
    let text = |p: Plan<()>| serde_json::to_string(&p).expect("plain numbers");
    assert_eq!(text(one.install(|| planned(&made))), text(five.install(|| planned(&made))));
}

/// Every field of a step changed by itself.
#[test]
fn a_plan_with_a_number_changed_is_refused() {
    for made in [dovetail(false), mortise(0.0), pair_in_a_well()] {
        let good = planned(&made);
        for k in 0..good.steps.len() {
            let refused = |why: &str, change: &dyn Fn(&mut Step)| {
                let mut bad = good.clone();
                change(&mut bad.steps[k]);
                assert!(matches!(check(&made.0, &bad), Checked::Invalid { .. }), "{why}: {bad:#?}");
            };
            let turn = |by: f64| {
                move |s: &mut Step| {
                    let s = shift(s);
                    let d = DVec3::from_array(s.direction);
                    s.direction = (d + d.any_orthonormal_vector() * by).normalize().to_array();
                }
            };
            refused("turned by a hundredth", &turn(0.01));
            refused("turned the other way", &turn(-0.01));
            if made.0.parts.iter().any(|p| p.id == "peg") {
                refused("reversed", &|s| shift(s).direction = shift(s).direction.map(|x| -x));
            }
            refused("not unit", &|s| shift(s).direction = shift(s).direction.map(|x| x * 1.001));
            refused("short", &|s| {
                let s = shift(s);
                (s.distance, s.distance_mm) = (s.distance * 0.5, s.distance_mm * 0.5);
            });
            refused("other mm", &|s| shift(s).distance_mm *= 1.001);
            refused("clear that is not kept", &|s| s.clear = 0.001);
            refused("unknown part", &|s| s.parts[0] = "nobody".into());
            refused("one part twice", &|s| s.parts.push(s.parts[0].clone()));
            refused("one part less", &|s| drop(s.stays.pop()));
            refused("no number", &|s| shift(s).distance = f64::NAN);
        }
        let mut bad = good.clone();
        bad.steps.pop();
        assert!(matches!(check(&made.0, &bad), Checked::Invalid { .. }), "a step left out");
    }
}

/// Small numbers that look random and are the same every time (xorshift).
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
    }

    fn vector(&mut self) -> DVec3 {
        v(self.roll(), self.roll(), self.roll())
    }

    /// A sheared and turned box: all its faces oblique.
    fn lump(&mut self, at: DVec3) -> Cell {
        let edges = loop {
            let e = [self.vector(), self.vector(), self.vector()];
            if e[0].cross(e[1]).dot(e[2]).abs() > 0.05 {
                break e;
            }
        };
        let unit = cuboid([0.; 3], [1.; 3]);
        let put = |p: &DVec3| at + edges[0] * p.x + edges[1] * p.y + edges[2] * p.z;
        cell(unit.vertices.iter().map(put).collect(), unit.facets)
    }
}

/// The same program by clarabel: maximize the radius over position, time and radius.
fn ball_by_clarabel(moving: &Cell, still: &Cell, way: Way) -> f64 {
    use clarabel::algebra::CscMatrix;
    use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT};
    let d = way.direction;
    let mut rows: Vec<([f64; 5], f64)> =
        moving.planes.iter().map(|&(n, b)| ([n.x, n.y, n.z, -n.dot(d), 1.0], b)).collect();
    rows.extend(still.planes.iter().map(|&(n, b)| ([n.x, n.y, n.z, 0.0, 1.0], b)));
    rows.push(([0., 0., 0., 1., 0.], way.length));
    rows.push(([0., 0., 0., -1., 0.], 0.0));
    let (a, b): (Vec<[f64; 5]>, Vec<f64>) = rows.into_iter().unzip();
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cost = [0., 0., 0., 0., -1.];
    let cones = [NonnegativeConeT(b.len())];
    let (p, a) = (CscMatrix::zeros((5, 5)), CscMatrix::from(&a));
    let mut solver = DefaultSolver::new(&p, &cost, &a, &b, &cones, settings).expect("a sound program");
    solver.solve();
    solver.solution.x[4]
}

#[test]
fn two_solvers_find_the_same_ball() {
    let mut dice = Dice(7);
    let (mut apart, mut overlap) = (0, 0);
    for _ in 0..2000 {
        let (a, at) = (dice.lump(DVec3::ZERO), dice.vector() * 3.0);
        let b = dice.lump(at);
        let toward = at.normalize() + dice.vector() * 0.5;
        let way = Way { direction: toward.normalize(), length: 3.0 + 3.0 * dice.roll() };
        let ours = by_program(&a, &b, way).expect("solved").radius;
        let theirs = ball_by_clarabel(&a, &b, way);
        assert!((ours - theirs).abs() < 1e-6, "{ours} {theirs}");
        assert!(ours < 0.0 || ours <= by_faces(&a, &b, way) + 1e-12);
        *(if ours < 0.0 { &mut apart } else { &mut overlap }) += 1;
    }
    assert!(apart > 300 && overlap > 300, "{apart} {overlap}");
}

/// The sweep behind the planner against the program behind the check: random lumps, and lumps that share a face.
#[test]
fn sweep_and_program_agree() {
    use weavelock::assembly::PartIx;
    use weavelock::blocking::{Touch, shadow::Shapes, shadow::View, sweep::meets};
    let mut dice = Dice(11);
    let (mut free, mut hit) = (0, 0);
    for round in 0..4000 {
        let a = dice.lump(DVec3::ZERO);
        let b = match round % 3 {
            0 => {
                let at = dice.vector() * 4.0;
                dice.lump(at)
            }
            1 => mirrored(&a, round % a.planes.len()),
            _ => shifted(&a, round % a.planes.len(), &mut dice),
        };
        let start = Way { direction: DVec3::Z, length: 0.0 };
        if by_program(&a, &b, start).expect("solved").radius > 1e-9 {
            continue;
        }
        let slide = a.planes[round % a.planes.len()].0.cross(dice.vector()).normalize();
        let direction = if round % 2 == 0 { slide } else { dice.vector().normalize() };
        let way = Way { direction, length: 20.0 };
        let (asm, _) = assembly(vec![("a", vec![a.clone()]), ("b", vec![b.clone()])]);
        let touch = Touch::of(&asm);
        let shapes = Shapes::of(&asm);
        let meeting = meets(&View::new(&shapes, direction), PartIx(0), PartIx(1), touch);
        let back = meets(&View::new(&shapes, -direction), PartIx(1), PartIx(0), touch);
        assert_eq!(meeting.is_some(), back.is_some(), "law 1");
        let radius = by_program(&a, &b, way).expect("solved").radius;
        match meeting {
            None => assert!(radius <= touch.depth(), "{radius} {direction}"),
            Some(_) => assert!(radius > 1e-9, "{radius} {direction}"),
        }
        *(if meeting.is_some() { &mut hit } else { &mut free }) += 1;
    }
    assert!(free > 500 && hit > 500, "{free} {hit}");
}

#[test]
fn a_part_goes_as_far_as_the_first_thing_in_its_way() {
    use weavelock::assembly::PartIx;
    use weavelock::blocking::reach::{Reach, reach};
    use weavelock::blocking::{Touch, shadow::Shapes, shadow::View};
    let (asm, _) = assembly(vec![
        ("block", vec![cuboid([0., 0., 0.], [1., 1., 1.])]),
        ("gate", vec![cuboid([0.99, 0., 7.], [2., 1., 8.]), cuboid([0.99, 0., 5.], [2., 1., 6.])]),
    ]);
    for angle in [0.0, 0.7, 2.2] {
        let (asm, _) = turned(&asm, angle);
        let (shapes, touch) = (Shapes::of(&asm), Touch::of(&asm));
        let d = asm.parts[0].pose.transform_vector3(DVec3::Z);
        let far = |d: DVec3| reach(&View::new(&shapes, d), PartIx(0), PartIx(1), touch);
        assert!(matches!(far(d), Reach::Until(t) if (t - 4.0).abs() < 1e-4), "{:?}", far(d));
        assert_eq!(far(-d), Reach::Free);
    }
}

/// The cell mirrored in the plane of one of its faces: both touch on the whole face.
fn mirrored(c: &Cell, face: usize) -> Cell {
    let (n, d) = c.planes[face];
    cell(c.vertices.iter().map(|&p| p - 2.0 * (n.dot(p) - d) * n).collect(), c.facets.clone())
}

/// The same, moved along the face: they touch on a part of it, on an edge or not at all.
fn shifted(c: &Cell, face: usize, dice: &mut Dice) -> Cell {
    let (n, by) = (c.planes[face].0, dice.vector());
    let along = by - n * n.dot(by);
    let m = mirrored(c, face);
    cell(m.vertices.iter().map(|&p| p + along).collect(), m.facets)
}
