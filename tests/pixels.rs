//! What a picture of the page shows, pixel by pixel, against what was meant: the parts put in place by the plan, drawn by
//! a rasteriser of the test's own, in the colours and the light that the page states. The camera's numbers are the
//! page's; that it looks from where it says and has all parts in view is checked apart.
//!
//! Pixels are compared where nothing ends: the same part, smoothly lit, all around. Not compared: edges and lines.

use crate::browser::{Browser, Rgba, bare, shown_plan, swatch};
use glam::{DAffine3, DMat4, DVec3, DVec4};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use weavelock::contact::Joined;
use weavelock::report::draw::mesh::CreaseAngle;
use weavelock::report::draw::{Mesh, palette};
use weavelock::report::moves;
use weavelock::report::page::page;
use weavelock::report::viewer::{Answers, Exhibit, of_assembly};

/// Rounding to a byte on both sides, and f32 normals and powers of the graphics library: a level each.
const LEVELS: u8 = 3;
/// Normals of neighbouring pixels that turn by more than this belong to two sides of an edge: half the crease angle.
const SIDE: f64 = 17.5;
/// A pixel and those around it.
const AROUND: [(i64, i64); 9] =
    [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)];

/// Where the page looks from.
struct Camera {
    see: DMat4,
    eye: DVec3,
    key: DVec3,
    width: usize,
    height: usize,
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().expect("numbers").iter().map(|n| n.as_f64().expect("a number")).collect()
}

impl Camera {
    fn of(browser: &mut Browser) -> Camera {
        let c = browser.ask("weavelock.camera()");
        let vector = |v: &Value| DVec3::from_slice(&numbers(v));
        Camera {
            see: DMat4::from_cols_slice(&numbers(&c["see"])),
            eye: vector(&c["eye"]),
            key: vector(&c["key"]),
            width: c["width"].as_u64().expect("a width") as usize,
            height: c["height"].as_u64().expect("a height") as usize,
        }
    }

    /// Column, row and nearness (1 over the distance along the view) of a point about the scene's middle.
    fn project(&self, p: DVec3) -> DVec3 {
        let q: DVec4 = self.see * p.extend(1.0);
        assert!(q.w > 0.0, "a corner behind the eye: this rasteriser cuts nothing off");
        let (x, y) = (q.x / q.w, q.y / q.w);
        DVec3::new((x + 1.0) / 2.0 * self.width as f64, (1.0 - y) / 2.0 * self.height as f64, 1.0 / q.w)
    }
}

/// A part in place: its mesh with what moves it into the scene, and its colour.
struct Placed {
    mesh: usize,
    pose: DAffine3,
    colour: [u8; 3],
}

/// What is on the table after `done` steps (a share of a step counts), in the scene about `middle`.
fn on_table(joined: &Joined, plan: &Value, done: f64, middle: DVec3) -> BTreeMap<usize, Placed> {
    let asm = &joined.assembly;
    let ids: Vec<&str> = asm.parts.iter().map(|p| p.id.as_str()).collect();
    let read = moves::read(&plan["steps"], &ids).moves;
    let moved = moves::displacements(&read, ids.len(), done);
    let shown: Vec<usize> = match done {
        0.0 => (0..ids.len()).collect(),
        _ => moves::on_table(&read[done.ceil() as usize - 1]).collect(),
    };
    let place = |k: usize| {
        let pose = DAffine3::from_translation(-middle) * moved[k] * asm.parts[k].pose;
        (k, Placed { mesh: asm.parts[k].solid, pose, colour: palette::bytes_of_part(ids[k], k) })
    };
    shown.into_iter().map(place).collect()
}

/// What a pixel shows: which part, where, and its unit normal.
#[derive(Clone, Copy)]
struct Hit {
    part: usize,
    near: f64,
    point: DVec3,
    normal: DVec3,
}

/// The nearest part at each pixel's middle.
fn raster(meshes: &[Mesh], parts: &BTreeMap<usize, Placed>, camera: &Camera) -> Vec<Option<Hit>> {
    let mut seen: Vec<Option<Hit>> = vec![None; camera.width * camera.height];
    for (&part, placed) in parts {
        let mesh = &meshes[placed.mesh];
        let world: Vec<DVec3> = mesh.vertices.iter().map(|v| placed.pose.transform_point3(*v)).collect();
        let flat: Vec<DVec3> = world.iter().map(|p| camera.project(*p)).collect();
        for t in &mesh.triangles {
            let [a, b, c] = t.corners.map(|v| flat[v as usize]);
            let turn = |p: DVec3, q: DVec3, r: DVec3| (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
            // Counter-clockwise from outside turns clockwise where rows run down.
            let area = turn(a, b, c);
            if area >= 0.0 {
                continue;
            }
            let span = |k: fn(DVec3) -> f64, most: usize| {
                let (lo, hi) = (k(a).min(k(b)).min(k(c)), k(a).max(k(b)).max(k(c)));
                (lo - 0.5).ceil().max(0.0) as usize..((hi + 0.5).floor().max(0.0) as usize).min(most)
            };
            for y in span(|p| p.y, camera.height) {
                for x in span(|p| p.x, camera.width) {
                    let p = DVec3::new(x as f64 + 0.5, y as f64 + 0.5, 0.0);
                    let share = [turn(b, c, p), turn(c, a, p), turn(a, b, p)].map(|s| s / area);
                    if share.iter().any(|s| *s < 0.0) {
                        continue;
                    }
                    let near = share[0] * a.z + share[1] * b.z + share[2] * c.z;
                    let at = &mut seen[y * camera.width + x];
                    if at.is_none_or(|h| h.near < near) {
                        // Straight in the scene is straight on the picture only with the distance taken out.
                        let weight: Vec<f64> =
                            share.iter().zip([a, b, c]).map(|(s, corner)| s * corner.z / near).collect();
                        let blend =
                            |of: &dyn Fn(usize) -> DVec3| (0..3).map(|k| of(k) * weight[k]).sum::<DVec3>();
                        let normal = blend(&|k| mesh.normals[t.normals[k] as usize]);
                        let normal = placed.pose.transform_vector3(normal).normalize_or_zero();
                        let point = blend(&|k| world[t.corners[k] as usize]);
                        *at = Some(Hit { part, near, point, normal });
                    }
                }
            }
        }
    }
    seen
}

/// The page's light: sky from above, a key over the viewer's left shoulder, darker toward the rim (`stage.js`).
fn lit(colour: [u8; 3], hit: &Hit, camera: &Camera) -> [u8; 3] {
    let (n, v) = (hit.normal, (camera.eye - hit.point).normalize());
    let (ground, sky) = (DVec3::new(0.34, 0.33, 0.32), DVec3::new(0.62, 0.63, 0.66));
    let key = DVec3::new(0.50, 0.48, 0.44) * n.dot(camera.key).max(0.0);
    let rim = 1.0 - n.dot(v).max(0.0);
    let light = (ground.lerp(sky, 0.5 + 0.5 * n.z) + key) * (1.0 - 0.45 * rim.powi(3));
    let light = light.to_array();
    [0, 1, 2].map(|k| {
        let linear = (f64::from(colour[k]) / 255.0).powf(2.2) * light[k];
        (linear.min(1.0).powf(1.0 / 2.2) * 255.0).round() as u8
    })
}

/// What was found of a part: its pixels that are compared, and those of them that look as meant.
#[derive(Default, Debug)]
struct Found {
    compared: usize,
    right: usize,
}

/// Parts (`None`: the ground) with what was found of them.
type Tally = BTreeMap<Option<usize>, Found>;

fn tally(
    live: &Rgba,
    ground: [u8; 3],
    meshes: &[Mesh],
    parts: &BTreeMap<usize, Placed>,
    camera: &Camera,
) -> Tally {
    assert_eq!((live.width as usize, live.height as usize), (camera.width, camera.height));
    let seen = raster(meshes, parts, camera);
    let at = |x: i64, y: i64| seen[y as usize * camera.width + x as usize];
    let least = SIDE.to_radians().cos();
    let like = |a: &Option<Hit>, b: &Option<Hit>| match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => a.part == b.part && a.normal.dot(b.normal) > least,
        _ => false,
    };
    let mut tally = Tally::new();
    tally.extend(parts.keys().map(|k| (Some(*k), Found::default())));
    for y in 1..camera.height as i64 - 1 {
        for x in 1..camera.width as i64 - 1 {
            let here = at(x, y);
            if !AROUND.iter().all(|(dx, dy)| like(&here, &at(x + dx, y + dy))) {
                continue;
            }
            let meant = here.map_or(ground, |h| lit(parts[&h.part].colour, &h, camera));
            let found = live.colours[y as usize * camera.width + x as usize];
            let entry = tally.entry(here.map(|h| h.part)).or_default();
            entry.compared += 1;
            entry.right += usize::from((0..3).all(|k| meant[k].abs_diff(found[k]) <= LEVELS));
        }
    }
    tally
}

/// Pixels of a part below which it is not judged: rounding may move an edge into the few of a part that is all but hidden.
const FEW: usize = AROUND.len();

/// Parts that do not look as meant: of the pixels compared, half or more are wrong.
fn wrong(tally: &Tally) -> Vec<Option<usize>> {
    let judged = tally.iter().filter(|(_, f)| f.compared >= FEW);
    judged.filter(|(_, f)| 2 * f.right <= f.compared).map(|(k, _)| *k).collect()
}

/// The page at rest after `done` steps, compared with what was meant.
fn looked_at(browser: &mut Browser, joined: &Joined, exhibit: &Exhibit, plan: &Value, done: f64) -> Tally {
    browser.ask(&format!("weavelock.go({done}); weavelock.state.left = 'none'; 0"));
    // Until it rests, and the picture at rest is on the screen.
    browser.ask("new Promise((r) => setTimeout(r, 400))");
    browser.ask("weavelock.state.moving = false; weavelock.draw(); weavelock.frame(false); 0");
    browser.ask("new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(() => r(0))))");
    let ground = browser
        .ask("getComputedStyle(document.querySelector('.stage')).backgroundColor.match(/\\d+/g).map(Number)");
    let ground: Vec<u8> = numbers(&ground).iter().map(|n| *n as u8).collect();
    let camera = Camera::of(browser);
    let meshes: Vec<Mesh> =
        joined.assembly.solids.iter().map(|s| Mesh::of(s, CreaseAngle::default())).collect();
    let parts = on_table(joined, plan, done, exhibit.middle);
    let live = browser.canvas();
    tally(&live, [ground[0], ground[1], ground[2]], &meshes, &parts, &camera)
}

/// That the camera looks from where the first view is said to, with every part in the picture, and fills most of it.
fn first_view_is_as_said(browser: &mut Browser, joined: &Joined, middle: DVec3) {
    browser.ask("weavelock.go(0); 0");
    let camera = Camera::of(browser);
    let (a, e) = (-62f64.to_radians(), 38f64.to_radians());
    let from = DVec3::new(e.cos() * a.cos(), e.cos() * a.sin(), e.sin());
    assert!((camera.eye.normalize() - from).length() < 1e-6, "{}", camera.eye);
    let asm = &joined.assembly;
    let points = asm.parts.iter().flat_map(|p| {
        asm.solids[p.solid].vertices.iter().map(|v| camera.project(p.pose.transform_point3(*v) - middle))
    });
    let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (lo, hi) = points.fold(none, |(lo, hi), p| (lo.min(p), hi.max(p)));
    let size = DVec3::new(camera.width as f64, camera.height as f64, f64::INFINITY);
    assert!(lo.min_element() >= 0.0 && hi.cmple(size).all(), "{lo} {hi}");
    let share = ((hi - lo) / size).truncate();
    assert!(share.max_element() > 0.5, "the parts fill {share} of the picture");
}

fn loaded(browser: &mut Browser, joined: &Joined, plan: &Value, change: impl Fn(&mut Exhibit)) -> Exhibit {
    let answers = Answers { plan: Some(plan.clone()), ..Answers::default() };
    let truth = of_assembly(joined, &answers);
    let mut shown = truth.clone();
    change(&mut shown);
    browser.load(&page(&bare(vec![shown], vec![])));
    truth
}

fn as_meant(wefts: u32, warps: u32, after: &[f64], closer: &[f64]) {
    let Some(mut browser) = Browser::with_webgl() else { return };
    let joined = swatch(wefts, warps);
    let plan = shown_plan(&joined);
    let exhibit = loaded(&mut browser, &joined, &plan, |_| ());
    first_view_is_as_said(&mut browser, &joined, exhibit.middle);
    let views = after.iter().map(|d| (*d, 1.0)).chain(closer.iter().map(|z| (0.0, *z)));
    for (done, zoom) in views {
        browser.ask(&format!("weavelock.state.view.zoom = {zoom}; 0"));
        let found = looked_at(&mut browser, &joined, &exhibit, &plan, done);
        let (compared, right) = found.values().fold((0, 0), |(c, r), f| (c + f.compared, r + f.right));
        let parts = found.values().filter(|f| f.compared >= FEW).count();
        println!(
            "{} parts after {done} steps, {zoom} times as near: {right} of {compared} pixels as meant, {parts} parts compared",
            wefts * warps
        );
        assert_eq!(wrong(&found), vec![], "after {done} steps, {zoom} times as near");
        assert!(parts > 1 && compared > 0, "nothing was compared");
    }
    assert_eq!(browser.complaints(), Vec::<String>::new());
}

#[test]
fn pixels_of_twenty_parts_are_as_meant() {
    as_meant(2, 10, &[0.0, 1.0, 3.5, 17.0, 18.5, 19.0], &[3.0]);
}

#[test]
#[ignore = "ten seconds of software WebGL"]
fn pixels_of_two_hundred_parts_are_as_meant() {
    as_meant(10, 20, &[0.0, 1.5, 100.0, 199.0], &[3.0]);
}

#[test]
#[ignore = "half a minute of software WebGL"]
fn pixels_of_two_thousand_parts_are_as_meant() {
    as_meant(40, 50, &[0.0, 1.5, 1000.0], &[3.0]);
}

#[test]
fn a_wrong_colour_a_missing_part_and_one_that_stayed_are_seen() {
    let Some(mut browser) = Browser::with_webgl() else { return };
    let joined = swatch(2, 10);
    let plan = shown_plan(&joined);
    let ids: Vec<&str> = joined.assembly.parts.iter().map(|p| p.id.as_str()).collect();
    // A part on top that the first view shows well, and the shade of its strand's neighbour.
    let part = 7;
    let other = palette::bytes_of_part(ids[part + 1], part + 1);
    assert_ne!(other, palette::bytes_of_part(ids[part], part));
    let truth = loaded(&mut browser, &joined, &plan, |e| e.schemes[0].colours[part] = other);
    let found = looked_at(&mut browser, &joined, &truth, &plan, 0.0);
    assert_eq!(wrong(&found), vec![Some(part)], "a wrong colour");

    let mut gone = plan.clone();
    let stays = gone["steps"][0]["stays"].as_array_mut().expect("ids");
    stays.retain(|id| id != ids[part]);
    loaded(&mut browser, &joined, &gone, |_| ());
    let found = looked_at(&mut browser, &joined, &truth, &plan, 1.0);
    assert!(wrong(&found).contains(&Some(part)), "a missing part: {:?}", wrong(&found));

    let mut stayed = plan.clone();
    stayed["steps"][0]["distance"] = json!(0.0);
    loaded(&mut browser, &joined, &stayed, |_| ());
    let found = looked_at(&mut browser, &joined, &truth, &plan, 1.0);
    assert!(wrong(&found).contains(&Some(0)), "a part that stayed: {:?}", wrong(&found));
}
