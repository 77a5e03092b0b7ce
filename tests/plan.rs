//! Plans: what must come apart does, what must not does not, and no plan that overlaps is accepted.

mod build {
    //! Assemblies of convex cells, with contacts wherever two faces lie flush.

    use glam::{DAffine3, DQuat, DVec3};
    use weavelock::assembly::{Assembly, Mobility, Part, PartIx};
    use weavelock::contact::Patch;
    use weavelock::solid::{Cell, Facet, Solid};

    pub fn v(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    /// A prism over a convex polygon given counter-clockwise in (u, v), from w0 to w1; `at` puts (u, v, w) in space.
    pub fn prism(outline: &[[f64; 2]], w0: f64, w1: f64, at: impl Fn(f64, f64, f64) -> DVec3) -> Cell {
        let n = outline.len();
        let ring = |w: f64| outline.iter().map(|p| at(p[0], p[1], w)).collect::<Vec<_>>();
        let vertices = [ring(w0), ring(w1)].concat();
        let mut facets: Vec<Vec<u32>> =
            vec![(0..n as u32).rev().collect(), (n as u32..2 * n as u32).collect()];
        facets.extend((0..n).map(|k| [k, (k + 1) % n, (k + 1) % n + n, k + n].map(|i| i as u32).to_vec()));
        cell(vertices, facets)
    }

    /// Facets in either sense, as long as all are in the same.
    pub fn cell(vertices: Vec<DVec3>, mut facets: Vec<Vec<u32>>) -> Cell {
        let middle = vertices.iter().sum::<DVec3>() / vertices.len() as f64;
        let mut planes = Vec::new();
        for f in &mut facets {
            let [a, b, c] = [f[0], f[1], f[2]].map(|k| vertices[k as usize]);
            let n = (b - a).cross(c - a).normalize();
            if n.dot(a - middle) < 0.0 {
                f.reverse();
            }
            let n = if n.dot(a - middle) < 0.0 { -n } else { n };
            planes.push((n, n.dot(a)));
        }
        Cell { vertices, facets, planes }
    }

    pub fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Cell {
        prism(&[[lo[0], lo[1]], [hi[0], lo[1]], [hi[0], hi[1]], [lo[0], hi[1]]], lo[2], hi[2], v)
    }

    /// Facets between two cells of a part are kept: they cancel in the volume.
    fn solid(cells: Vec<Cell>) -> Solid {
        let mut out = Solid::default();
        for c in &cells {
            let base = out.vertices.len() as u32;
            out.vertices.extend(&c.vertices);
            out.facets.extend(
                c.facets
                    .iter()
                    .zip(&c.planes)
                    .map(|(f, p)| Facet { corners: f.iter().map(|k| k + base).collect(), normal: p.0 }),
            );
        }
        out.cells = cells;
        out
    }

    pub fn assembly(parts: Vec<(&str, Vec<Cell>)>) -> (Assembly, Vec<Patch>) {
        let mut asm = Assembly { name: "test".into(), solids: vec![], parts: vec![], mm_per_unit: 20.0 };
        for (k, (id, cells)) in parts.into_iter().enumerate() {
            asm.solids.push(solid(cells));
            let pose = DAffine3::IDENTITY;
            asm.parts.push(Part { id: id.into(), solid: k, pose, mobility: Mobility::Free });
        }
        let patches = contacts(&asm);
        (asm, patches)
    }

    /// All parts turned about an oblique axis and moved.
    pub fn turned(asm: &Assembly, angle: f64) -> (Assembly, Vec<Patch>) {
        let by = DAffine3::from_rotation_translation(
            DQuat::from_axis_angle(v(0.3, -0.7, 0.65).normalize(), angle),
            v(0.7, -1.3, 2.1),
        );
        let mut asm = asm.clone();
        asm.parts.iter_mut().for_each(|p| p.pose = by * p.pose);
        let patches = contacts(&asm);
        (asm, patches)
    }

    pub fn contacts(asm: &Assembly) -> Vec<Patch> {
        let cells: Vec<Vec<Cell>> = asm.ids().map(|p| asm.cells(p)).collect();
        let mut out = Vec::new();
        for a in 0..cells.len() {
            for b in a + 1..cells.len() {
                for (x, y) in cells[a].iter().flat_map(|x| cells[b].iter().map(move |y| (x, y))) {
                    out.extend(flush(x, y).into_iter().map(|(normal, corners)| Patch {
                        a: PartIx(a as u32),
                        b: PartIx(b as u32),
                        normal,
                        corners,
                    }));
                }
            }
        }
        out
    }

    fn flush(x: &Cell, y: &Cell) -> Vec<(DVec3, Vec<DVec3>)> {
        let mut out = Vec::new();
        for (f, &(n, d)) in x.facets.iter().zip(&x.planes) {
            for &(m, e) in &y.planes {
                if (n + m).length() < 1e-9 && (d + e).abs() < 1e-9 {
                    let face: Vec<DVec3> = f.iter().map(|&k| x.vertices[k as usize]).collect();
                    let side = y.planes.iter().filter(|p| p.0.dot(n).abs() < 1.0 - 1e-9);
                    let left = side.fold(face, |poly, &(p, c)| clip(&poly, p, c));
                    if area(&left) > 1e-9 {
                        out.push((n, left));
                    }
                }
            }
        }
        out
    }

    fn clip(poly: &[DVec3], n: DVec3, d: f64) -> Vec<DVec3> {
        let mut out = Vec::new();
        for (k, &a) in poly.iter().enumerate() {
            let b = poly[(k + 1) % poly.len()];
            let (sa, sb) = (n.dot(a) - d, n.dot(b) - d);
            if sa <= 0.0 {
                out.push(a);
            }
            if sa * sb < 0.0 {
                out.push(a.lerp(b, sa / (sa - sb)));
            }
        }
        out
    }

    fn area(poly: &[DVec3]) -> f64 {
        let fan = |w: &[DVec3]| (w[0] - poly[0]).cross(w[1] - poly[0]);
        poly.get(1..).map_or(0.0, |rest| rest.windows(2).map(fan).sum::<DVec3>().length() / 2.0)
    }
}

use build::{assembly, cell, cuboid, prism, turned, v};
use glam::DVec3;
use weavelock::assembly::{Assembly, Mobility};
use weavelock::contact::Patch;
use weavelock::sequence::{Outcome, Plan, plan};
use weavelock::solid::Cell;
use weavelock::verify::plan::{Checked, Way, by_faces, by_program, check};

type Made = (Assembly, Vec<Patch>);

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
    let p = planned(&dovetail(false));
    assert_eq!(p.steps[0].clear, 0.0);
    assert!(p.steps[0].direction[1].abs() > 1.0 - 1e-12, "{p:#?}");
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
    p.steps[0].direction = [0., 0., 1.];
    p.steps[0].parts = vec!["block".into()];
    p.steps[0].stays = vec!["gate".into()];
    (p.steps[0].distance, p.steps[0].distance_mm, p.steps[0].clear) = (60.0, 1200.0, 0.0);
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
            let refused = |why: &str, change: &dyn Fn(&mut weavelock::sequence::Step)| {
                let mut bad = good.clone();
                change(&mut bad.steps[k]);
                assert!(matches!(check(&made.0, &bad), Checked::Invalid { .. }), "{why}: {bad:#?}");
            };
            let turn = |by: f64| {
                move |s: &mut weavelock::sequence::Step| {
                    let d = DVec3::from_array(s.direction);
                    s.direction = (d + d.any_orthonormal_vector() * by).normalize().to_array();
                }
            };
            refused("turned by a hundredth", &turn(0.01));
            refused("turned the other way", &turn(-0.01));
            if made.0.parts.iter().any(|p| p.id == "peg") {
                refused("reversed", &|s| s.direction = s.direction.map(|x| -x));
            }
            refused("not unit", &|s| s.direction = s.direction.map(|x| x * 1.001));
            refused("short", &|s| (s.distance, s.distance_mm) = (s.distance * 0.5, s.distance_mm * 0.5));
            refused("other mm", &|s| s.distance_mm *= 1.001);
            refused("clear that is not kept", &|s| s.clear = 0.001);
            refused("unknown part", &|s| s.parts[0] = "nobody".into());
            refused("one part twice", &|s| s.parts.push(s.parts[0].clone()));
            refused("one part less", &|s| drop(s.stays.pop()));
            refused("no number", &|s| s.distance = f64::NAN);
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

/// Woven assemblies as a file would describe them.
mod woven {
    use super::*;
    use std::path::Path;
    use weavelock::assembly::PartIx;
    use weavelock::contact::{Joined, join};
    use weavelock::locking::{Verdict, check_some};
    use weavelock::sequence::plan_of;
    use weavelock::spec::{Syntax, parse};
    use weavelock::verify::plan::check_of;

    fn read(text: &str) -> Joined {
        let file = Path::new("woven.toml");
        let spec = parse(text, file, Syntax::of(file, text)).expect("a good file");
        join(&spec).expect("an assembly")
    }

    fn swatch(abc: [i32; 3], size: u32, cut: &str, samples: u32) -> Joined {
        read(&format!(
            "name = 'x'\n[weave]\nabc = {abc:?}\n[profile]\nrise = 0.6\nlift = 1.0\ncover = 1.0\nsamples = {samples}\n\
             [swatch]\nwefts = {size}\nwarps = {size}\ncut = '{cut}'\n[size]\npitch = '20 mm'\n"
        ))
    }

    fn planned(joined: &Joined, parts: &[PartIx]) -> Plan<()> {
        let (asm, patches) = (&joined.assembly, &joined.patches);
        let lock = |set: &[PartIx]| matches!(check_some(asm, patches, set), Verdict::Locked(_)).then_some(());
        let p = plan_of(asm, parts, patches, lock).expect("sane parts");
        match check_of(asm, parts, &p) {
            Checked::Valid { clear, deepest } => assert!(clear == 0.0 && deepest < 1e-9, "{clear} {deepest}"),
            bad => panic!("own plan refused: {bad:?}\n{p:#?}"),
        }
        p
    }

    fn all(joined: &Joined) -> Vec<PartIx> {
        joined.assembly.ids().collect()
    }

    fn by_single_parts(joined: &Joined) {
        let p = planned(joined, &all(joined));
        assert_eq!(p.outcome, Outcome::Assembled, "{p:#?}");
        assert_eq!(p.steps.len(), joined.assembly.parts.len() - 1);
        assert!(p.steps.iter().all(|s| s.parts.len() == 1), "{p:#?}");
    }

    #[test]
    fn plain_unit_tiles_come_apart_one_by_one() {
        for samples in [6, 8, 12] {
            by_single_parts(&swatch([1, 1, 1], 2, "tiles", samples));
        }
    }

    fn pieces(abc: [i32; 3], length: i32, samples: u32, wefts: &[i32], warps: &[i32]) -> Joined {
        let mut text = format!(
            "name = 'x'\n[weave]\nabc = {abc:?}\n[profile]\nsamples = {samples}\n[size]\npitch = '20 mm'\n"
        );
        for (kind, starts) in [("weft", wefts), ("warp", warps)] {
            for (k, s) in starts.iter().enumerate() {
                text += &format!("[[piece]]\n{kind} = {k}\nfrom = {s}\nto = {}\n", s + length);
            }
        }
        read(&text)
    }

    /// Which cut is taken matters: with one choice single parts can go in turn, with another a pair must go first.
    #[test]
    fn nine_crossings_of_plain_tiles_come_apart() {
        by_single_parts(&pieces([1, 1, 1], 2, 8, &[0, -1, 0], &[-1, 0, -1]));
        let twin = pieces([1, 1, 1], 2, 8, &[0, 1, 0], &[1, 0, 1]);
        let p = planned(&twin, &all(&twin));
        assert_eq!((p.outcome, p.steps[0].parts.len()), (Outcome::Assembled, 2), "{p:#?}");
    }

    /// Coarse twill tiles come apart. Finer ones catch on corner lips, about 0.02 of the pitch deep, that lock five
    /// of the eight when there is no clearance at all (found with Qhull and HiGHS too).
    #[test]
    fn twill_unit_tiles_come_apart_unless_lips_lock_them() {
        let at = |samples| pieces([2, 2, 1], 4, samples, &[0, 1, -2, -1], &[1, -2, -1, 0]);
        for coarse in [2, 3].map(at) {
            assert_eq!(planned(&coarse, &all(&coarse)).outcome, Outcome::Assembled);
        }
        let fine = at(8);
        let p = planned(&fine, &all(&fine));
        assert_eq!(p.outcome, Outcome::NeedsFlexible, "{p:#?}");
        assert_eq!(p.stuck[0].parts, ["weft-0", "weft-1", "warp-1", "warp-2", "warp-3"]);
    }

    /// A fiftieth of the pitch is enough to lift every twill tile over the lips, one by one; with half of that
    /// some must go together first.
    #[test]
    fn twill_unit_tiles_with_clearance_come_apart_one_by_one() {
        use weavelock::sequence::clearance::with_clearance;
        let tight = pieces([2, 2, 1], 4, 6, &[0, 1, -2, -1], &[1, -2, -1, 0]);
        let at = |clearance: f64| {
            let loose =
                with_clearance(&tight.assembly, &tight.patches, clearance).expect("something is left");
            let p = plan(&loose, &[], |_| None::<()>).expect("sane parts");
            assert!(matches!(check(&loose, &p), Checked::Valid { .. }), "{:?}", check(&loose, &p));
            p
        };
        let p = at(0.025);
        assert_eq!((p.outcome, p.steps.len()), (Outcome::Assembled, 7));
        assert!(p.steps.iter().all(|s| s.parts.len() == 1 && s.clear > 0.0), "{p:#?}");
        let p = at(0.01);
        assert_eq!(p.outcome, Outcome::Assembled);
        assert!(p.steps[0].parts.len() > 1, "{p:#?}");
    }

    #[test]
    fn no_clearance_changes_nothing_and_too_much_leaves_nothing() {
        use weavelock::sequence::clearance::{NoClearance, with_clearance};
        let joined = swatch([1, 1, 1], 2, "window", 6);
        let (asm, patches) = (&joined.assembly, &joined.patches);
        let same = with_clearance(asm, patches, 0.0).expect("all is left");
        let p = plan(&same, patches, |_| None::<()>).expect("sane parts");
        assert!(matches!(check(&same, &p), Checked::Valid { .. }), "{:?}", check(&same, &p));
        assert_eq!((p.outcome, p.stuck[0].parts.len()), (Outcome::NotFound, 4));
        for wrong in [-0.1, f64::NAN, f64::INFINITY] {
            assert!(matches!(with_clearance(asm, patches, wrong), Err(NoClearance::NoLength(_))));
        }
        assert!(matches!(with_clearance(asm, patches, 5.0), Err(NoClearance::NothingLeft(_))));
    }

    #[test]
    fn a_large_plain_swatch_comes_apart() {
        let joined = swatch([1, 1, 1], 6, "tiles", 6);
        assert_eq!(planned(&joined, &all(&joined)).outcome, Outcome::Assembled);
    }

    #[test]
    fn the_plain_window_is_locked_and_any_three_of_it_come_apart() {
        let joined = swatch([1, 1, 1], 2, "window", 8);
        let p = planned(&joined, &all(&joined));
        assert_eq!(p.outcome, Outcome::NeedsFlexible);
        assert_eq!(
            (p.stuck[0].parts.len(), p.stuck[0].straight_moves),
            (4, weavelock::sequence::Straight::None)
        );
        for left_out in 0..4 {
            let three: Vec<PartIx> = all(&joined).into_iter().filter(|p| p.at() != left_out).collect();
            let p = planned(&joined, &three);
            assert_eq!((p.outcome, p.steps.len()), (Outcome::Assembled, 2), "without {left_out}: {p:#?}");
        }
    }
}
