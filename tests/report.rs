//! What pictures promise. Shapes are drawn as cubes on a grid.

use glam::{DAffine3, DVec3};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use weavelock::report::draw::mesh::{CreaseAngle, EdgeKind};
use weavelock::report::draw::{
    Background, Colour, Image, Item, Mesh, Opacity, Projection, Scene, Size, View, beside, glyph, palette,
    render, write_png,
};
use weavelock::solid::{Facet, Solid};

const RED: Colour = Colour([0.8, 0.05, 0.05]);
const BLUE: Colour = Colour([0.05, 0.05, 0.8]);

/// The union of unit cubes at these places; faces between two of them are left out, corners shared.
fn cubes(places: &[[i32; 3]]) -> Solid {
    let mut solid = Solid::default();
    let mut index: BTreeMap<[i32; 3], u32> = BTreeMap::new();
    for &place in places {
        for (axis, side) in (0..3).flat_map(|a| [(a, 0), (a, 1)]) {
            let mut step = [0; 3];
            step[axis] = 2 * side - 1;
            if places.contains(&[0, 1, 2].map(|k| place[k] + step[k])) {
                continue;
            }
            let mut corners: Vec<u32> = [(0, 0), (1, 0), (1, 1), (0, 1)]
                .map(|(a, b)| {
                    let mut p = place;
                    p[axis] += side;
                    p[(axis + 1) % 3] += a;
                    p[(axis + 2) % 3] += b;
                    *index.entry(p).or_insert_with(|| {
                        solid.vertices.push(DVec3::from_array(p.map(f64::from)));
                        solid.vertices.len() as u32 - 1
                    })
                })
                .into();
            if side == 0 {
                corners.reverse();
            }
            solid.facets.push(Facet { corners, normal: DVec3::from_array(step.map(f64::from)) });
        }
    }
    solid
}

/// A box with one facet on each side.
fn block(x: f64, y: f64, z: f64) -> Solid {
    let mut solid = cubes(&[[0, 0, 0]]);
    solid.vertices.iter_mut().for_each(|v| *v *= DVec3::new(x, y, z));
    solid
}

fn item(solid: &Solid, colour: Colour) -> Item {
    Item::new(Arc::new(Mesh::of(solid, CreaseAngle::default())), colour)
}

fn scene(items: Vec<Item>) -> Scene {
    Scene { items, view: View::default(), background: Background::Transparent }
}

fn draw(scene: &Scene) -> Image {
    render(scene, Size::new(120, 90).unwrap())
}

fn pixels(image: &Image) -> impl Iterator<Item = (u32, u32, [u8; 4])> + '_ {
    let (w, h) = (image.size().width(), image.size().height());
    (0..h).flat_map(move |y| (0..w).map(move |x| (x, y, image.pixel(x, y).unwrap())))
}

fn middle(image: &Image) -> [u8; 4] {
    image.pixel(image.size().width() / 2, image.size().height() / 2).unwrap()
}

/// A cross of two notched bars and a ghost: touching faces, a hole, a see-through part.
fn puzzle() -> Scene {
    let bar: Vec<[i32; 3]> = (0..6)
        .flat_map(|x| (0..2).flat_map(move |y| (0..2).map(move |z| [x, y, z])))
        .filter(|p| !(p[2] == 1 && (2..4).contains(&p[0])))
        .collect();
    let bar = cubes(&bar);
    let mut across = item(&bar, BLUE);
    let turned = glam::DMat3::from_cols(DVec3::Y, DVec3::X, DVec3::NEG_Z);
    across.pose = DAffine3::from_mat3_translation(turned, DVec3::new(2.0, -2.0, 3.0));
    let mut ghost = item(&block(2.0, 2.0, 4.0), RED);
    ghost.opacity = Opacity::Ghost { alpha: 0.4 };
    scene(vec![item(&bar, RED), across, ghost])
}

#[test]
fn the_same_bytes_with_any_number_of_threads() {
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| draw(&puzzle()).png().unwrap())
    };
    assert_eq!(with(1), with(3));
    assert_eq!(with(1), with(2));
}

#[test]
fn a_face_cut_into_facets_looks_like_one() {
    let whole = draw(&scene(vec![item(&block(3.0, 3.0, 3.0), RED)]));
    let grid: Vec<[i32; 3]> =
        (0..3).flat_map(|x| (0..3).flat_map(move |y| (0..3).map(move |z| [x, y, z]))).collect();
    let cut = draw(&scene(vec![item(&cubes(&grid), RED)]));
    // One step of grey: rounding to bytes may fall on either side of the round-off.
    for ((x, y, a), (_, _, b)) in pixels(&whole).zip(pixels(&cut)) {
        assert!((0..4).all(|k| a[k].abs_diff(b[k]) <= 1), "({x}, {y}): {a:?} {b:?}");
    }
}

#[test]
fn creases_are_the_edges_of_a_block_and_none_runs_along_a_round() {
    let creases = |m: &Mesh| m.edges.iter().filter(|e| e.kind == EdgeKind::Crease).count();
    assert_eq!(creases(&Mesh::of(&block(1.0, 2.0, 3.0), CreaseAngle::default())), 12);
    let rod = glyph::arrow(DVec3::ZERO, DVec3::Z * 3.0, 0.1).unwrap();
    let mesh = Mesh::of(&rod, CreaseAngle::default());
    // Tail, neck on the shaft, rim of the head: three rings of 24 edges.
    assert_eq!(creases(&mesh), 72);
    let surfaces: BTreeSet<u32> = mesh.surface.iter().copied().collect();
    assert_eq!(surfaces.len(), 4);
}

#[test]
fn the_nearer_part_covers_the_farther_and_its_outline_is_inked() {
    let mut near = item(&block(1.0, 1.0, 1.0), RED);
    near.offset = DVec3::new(0.0, 0.0, 2.0);
    let mut s = scene(vec![item(&block(1.0, 1.0, 1.0), BLUE), near]);
    s.view = View::PLAN;
    let image = draw(&s);
    let [r, _, b, a] = middle(&image);
    assert!(r > 2 * b && a == 255);
    // The square fills most of the picture's height: four sides of some 80 pixels each.
    let dark = pixels(&image).filter(|(_, _, p)| p[3] > 100 && p[0] < r - r / 4).count();
    assert!(dark > 240, "{dark} dark pixels");
    assert!(pixels(&image).all(|(_, _, p)| p[2] <= p[0].max(60)), "blue shows through");
}

#[test]
fn of_two_faces_in_one_plane_the_first_shows() {
    let mut second = item(&block(2.0, 1.0, 3.0), BLUE);
    second.offset = DVec3::new(-1.0, 0.0, -2.0);
    let mut tilted = scene(vec![item(&block(1.0, 1.0, 1.0), RED), second]);
    // A motion whose round-off takes the faces out of their common plane.
    let by = DAffine3::from_axis_angle(DVec3::new(0.3, -0.7, 0.65).normalize(), 0.1);
    tilted.items.iter_mut().for_each(|i| {
        i.pose = by * DAffine3::from_translation(i.offset);
        i.offset = DVec3::ZERO;
    });
    let alone =
        scene(vec![tilted.items[0].clone(), Item { opacity: Opacity::Hidden, ..tilted.items[1].clone() }]);
    let red = |p: [u8; 4]| p[3] == 255 && p[0] > 2 * p[2].max(30);
    let count = |s: &Scene| pixels(&draw(s)).filter(|(_, _, p)| red(*p)).count();
    // All three sides seen of the small block lie in sides of the large one; all of them must show.
    let (both, one) = (count(&tilted), count(&alone));
    assert!(one > 200 && both * 10 > one * 9, "{both} of {one}");
}

#[test]
fn a_hidden_part_leaves_room_and_a_ghost_lets_light_through() {
    let with = |opacity| {
        let mut part = item(&block(1.0, 1.0, 1.0), RED);
        part.opacity = opacity;
        draw(&scene(vec![part]))
    };
    assert_eq!(middle(&with(Opacity::Solid))[3], 255);
    assert!(pixels(&with(Opacity::Hidden)).all(|(_, _, p)| p[3] == 0));
    let ghost = middle(&with(Opacity::Ghost { alpha: 0.4 }));
    assert_eq!(ghost[3], 102);
    assert!(ghost[0] > 100, "a scene of ghosts alone is lit: {ghost:?}");
}

#[test]
fn every_view_keeps_every_part_inside() {
    for azimuth in [-170.0, 0.0, 45.0] {
        for elevation in [-60.0, 0.0, 90.0] {
            for projection in [Projection::Orthographic, Projection::Perspective { degrees: 60.0 }] {
                let view = View { azimuth, elevation, projection };
                let image = draw(&Scene { view, ..puzzle() });
                let (w, h) = (image.size().width(), image.size().height());
                let edge = |x: u32, y: u32| x == 0 || y == 0 || x == w - 1 || y == h - 1;
                assert!(pixels(&image).all(|(x, y, p)| !edge(x, y) || p[3] == 0), "{view:?}");
                let filled = pixels(&image).filter(|(_, _, p)| p[3] > 0).count();
                assert!(filled * 6 > (w * h) as usize, "{view:?} shows {filled} pixels");
            }
        }
    }
}

#[test]
fn nonsense_draws_nothing_and_does_not_panic() {
    let clear = |s: &Scene| pixels(&draw(s)).all(|(_, _, p)| p[3] == 0);
    assert!(clear(&scene(vec![])));
    assert!(clear(&scene(vec![item(&Solid::default(), RED)])));
    let point = Solid { vertices: vec![DVec3::ONE], ..Solid::default() };
    assert!(clear(&scene(vec![item(&point, RED)])));
    let mut broken = block(1.0, 1.0, 1.0);
    broken.vertices[3].x = f64::NAN;
    broken.facets[0].corners = vec![0, 1, 99];
    broken.facets[1].corners = vec![0];
    draw(&scene(vec![item(&broken, RED)]));
    broken.vertices[2].y = f64::INFINITY;
    draw(&scene(vec![item(&broken, RED)]));
    assert!(Size::new(0, 10).is_err() && Size::new(10, Size::LONGEST + 1).is_err());
    assert!(beside(&[]).is_err());
}

#[test]
fn a_png_read_back_has_the_same_pixels() {
    for background in [Background::Transparent, Background::Plain(Colour([1.0; 3]))] {
        let image = draw(&Scene { background, ..puzzle() });
        let bytes = image.png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes)).read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut data).unwrap();
        let channels = info.color_type.samples();
        assert_eq!(channels, if background == Background::Transparent { 4 } else { 3 });
        let read = data.chunks_exact(channels);
        assert!(pixels(&image).zip(read).all(|((_, _, p), q)| p[..channels] == *q));
    }
}

#[test]
fn a_picture_is_written_whole_or_not_at_all() {
    let folder = std::env::temp_dir().join(format!("weavelock-report-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let image = draw(&scene(vec![]));
    let listed = |f: &Path| std::fs::read_dir(f).unwrap().count();
    write_png(&image, &folder.join("a.png")).unwrap();
    assert_eq!(listed(&folder), 1);
    std::fs::create_dir(folder.join("b.png")).unwrap();
    let fault = write_png(&image, &folder.join("b.png")).unwrap_err();
    assert!(fault.to_string().contains("b.png"));
    assert!(write_png(&image, &folder.join("none").join("c.png")).is_err());
    assert_eq!(listed(&folder), 2);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn glyphs_are_closed_and_face_outward() {
    let straight = glyph::arrow(DVec3::ONE, DVec3::new(2.0, -3.0, 1.0), 0.1).unwrap();
    let bent = glyph::turning_arrow(DVec3::ONE, DVec3::new(1.0, 2.0, -1.0), 1.0, -3.0, 0.05).unwrap();
    for solid in glyph::motion(DVec3::ZERO, DVec3::X, DVec3::Z, 2.0).iter().chain([&straight, &bent]) {
        let mut sides: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        for f in &solid.facets {
            for k in 0..f.corners.len() {
                let (a, b) = (f.corners[k], f.corners[(k + 1) % f.corners.len()]);
                *sides.entry((a, b)).or_default() += 1;
                *sides.entry((b, a)).or_default() -= 1;
            }
        }
        assert!(sides.values().all(|&s| s == 0));
        assert!(solid.volume() > 0.0);
    }
    assert!(glyph::arrow(DVec3::X, DVec3::X, 0.1).is_none());
    assert!(glyph::turning_arrow(DVec3::X, DVec3::ZERO, 1.0, 1.0, 0.1).is_none());
    assert!(glyph::turning_arrow(DVec3::X, DVec3::Z, 1.0, f64::NAN, 0.1).is_none());
    assert!(glyph::motion(DVec3::X, DVec3::ZERO, DVec3::ZERO, 1.0).is_empty());
}

/// Full dichromacy as a matrix on linear light (Machado, Oliveira and Fernandes 2009, severity 1).
const SIGHTS: [(&str, [[f64; 3]; 3]); 4] = [
    ("usual", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    (
        "protan",
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    ),
    (
        "deutan",
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
    ),
    (
        "tritan",
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]],
    ),
];

/// CIE L*a*b* (D65) of linear sRGB light.
fn lab(c: [f64; 3]) -> [f64; 3] {
    let m = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
    let xyz = m.map(|r| (0..3).map(|k| r[k] * c[k].clamp(0.0, 1.0)).sum::<f64>());
    let f = |t: f64| if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 };
    let [x, y, z] = [f(xyz[0] / 0.9505), f(xyz[1]), f(xyz[2] / 1.089)];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

#[test]
fn warm_and_cool_stay_apart_for_every_kind_of_colour_vision() {
    for (sight, m) in SIGHTS {
        let seen = |rgb: [u8; 3]| lab(m.map(|r| (0..3).map(|k| r[k] * Colour::srgb(rgb).0[k]).sum()));
        let apart = |a: [u8; 3], b: [u8; 3]| {
            let (a, b) = (seen(a), seen(b));
            (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
        };
        // Ten times the difference of 2.3 that is just seen side by side.
        for (w, c) in palette::WARM.iter().flat_map(|w| palette::COOL.iter().map(move |c| (w, c))) {
            assert!(apart(*w, *c) > 23.0, "{sight}: {w:?} {c:?} {}", apart(*w, *c));
        }
        for family in [palette::WARM, palette::COOL] {
            for k in 0..4 {
                let (a, b) = (family[k], family[(k + 1) % 4]);
                assert!(apart(a, b) > 15.0, "{sight}: {a:?} {b:?} {}", apart(a, b));
            }
        }
    }
    assert_eq!(palette::of_part("weft--1", 0), palette::of_part("weft-3", 9));
    assert_ne!(palette::of_part("weft-0", 0), palette::of_part("warp-0", 0));
    assert_ne!(palette::of_part("weft-0/0", 0), palette::of_part("weft-0/1", 0));
}
