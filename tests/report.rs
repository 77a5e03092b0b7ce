//! What the report stage promises: pictures, page, terminal text. Shapes are drawn as cubes on a grid.

use glam::{DAffine3, DVec3};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;
use weavelock::report::content::{Align, Answer, Chapter, Column, Format, Picture, Table, Tone};
use weavelock::report::draw::mesh::{CreaseAngle, EdgeKind};
use weavelock::report::draw::{
    Background, Colour, Image, Item, Mesh, Opacity, Projection, Scene, Size, View, beside, glyph, palette,
    render, write_png,
};
use weavelock::report::page::{PageInput, page};
use weavelock::report::text::{Columns, Ink, Summary, write};
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
    for azimuth in [-170.0, -62.0, 0.0, 45.0, 131.0] {
        for elevation in [-60.0, 0.0, 38.0, 90.0] {
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

/// A string that would break out of every context it might land in.
const NASTY: &str = "<script>alert(\"1\")</script>' & \u{1b}[31m \u{202e}";

fn nasty() -> Chapter {
    Chapter {
        tone: Tone::Bad,
        headline: NASTY.into(),
        words: vec![NASTY.into()],
        facts: vec![(NASTY.into(), NASTY.into())],
        tables: vec![Table {
            caption: NASTY.into(),
            head: vec![Column::words(NASTY), Column::numbers("n")],
            rows: vec![
                vec![NASTY.into(), "1".into(), "more than the head".into()],
                vec![],
                vec![NASTY.into()],
            ],
        }],
        pictures: vec![Picture {
            format: Format::Svg(NASTY.into()),
            width: 3,
            height: 2,
            alt: NASTY.into(),
            caption: NASTY.into(),
        }],
        figure: vec![NASTY.into()],
    }
}

fn input() -> PageInput {
    let given = || Answer::Given(nasty());
    let png = |bytes: &[u8]| Picture { format: Format::Png(bytes.into()), ..nasty().pictures.remove(0) };
    PageInput {
        title: NASTY.into(),
        lead: NASTY.into(),
        pictures: vec![png(b"foobar"), png(b"fooba"), png(b"foob"), png(b"")],
        draft: given(),
        verdict: given(),
        plan: given(),
        flexible: Answer::not_run(NASTY),
        repeats: given(),
        chirality: Answer::not_run("not asked"),
        parts: Answer::Given(Chapter { pictures: vec![], ..nasty() }),
        ledger: given(),
        findings: Answer::Given(Chapter::default()),
        limits: vec![NASTY.into()],
    }
}

/// Tags of the page in order, without their angle brackets.
fn tags(html: &str) -> Vec<&str> {
    html.split('<').skip(1).map(|t| t.split('>').next().unwrap()).collect()
}

#[test]
fn a_page_is_well_formed_whatever_its_strings_say() {
    let html = page(&input());
    let mut open = Vec::new();
    for tag in tags(&html) {
        let name = tag.split([' ', '\n']).next().unwrap();
        if let Some(closed) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed));
        } else if !["!DOCTYPE", "meta", "img"].contains(&name) {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
    assert!(!html.contains(['\u{1b}', '\u{202e}']));
}

#[test]
fn a_page_stands_alone() {
    let html = page(&input());
    let tags = tags(&html);
    assert!(tags.iter().all(|t| !t.starts_with("script") && !t.starts_with("link") && !t.contains("://")));
    assert!(html.contains("default-src &#39;none&#39;"));
    assert!(!html.contains("url(") && !html.contains("@import"));
    for t in tags.iter().filter(|t| t.starts_with("img")) {
        assert!(t.contains(" src=\"data:image/") && t.contains(" alt=\"&lt;script"), "{t}");
    }
    assert_eq!(html, page(&input()));
}

#[test]
fn a_page_can_be_heard_and_walked_by_keyboard() {
    let html = page(&input());
    let tags = tags(&html);
    let ids: Vec<&str> = tags.iter().filter_map(|t| t.split(" id=\"").nth(1)?.split('"').next()).collect();
    let unique: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(ids.len(), unique.len());
    for t in &tags {
        let named = |attr: &str| t.split(attr).nth(1).and_then(|r| r.split('"').next());
        let targets = [named(" href=\"#"), named(" aria-labelledby=\"")];
        assert!(targets.into_iter().flatten().all(|id| unique.contains(id)), "{t}");
        assert!(!t.starts_with("th") || t.contains("scope=") || *t == "thead", "{t}");
    }
    for landmark in ["header", "nav ", "main ", "footer"] {
        assert_eq!(tags.iter().filter(|t| t.starts_with(landmark)).count(), 1, "{landmark}");
    }
    assert_eq!(tags.iter().filter(|t| t.starts_with("h1")).count(), 1);
}

#[test]
fn what_was_not_run_is_said_on_the_page_and_never_looks_passed() {
    let html = page(&input());
    assert_eq!(html.matches("<strong>Not run.</strong>").count(), 2);
    assert_eq!(html.matches("(not run)").count(), 2);
}

#[test]
fn pictures_are_embedded_as_base64() {
    let html = page(&input());
    // The examples of RFC 4648, section 10.
    for code in ["base64,Zm9vYmFy\"", "base64,Zm9vYmE=\"", "base64,Zm9vYg==\"", "base64,\""] {
        assert!(html.contains(code), "{code}");
    }
}

fn summary() -> Summary {
    let chapter = Chapter {
        tone: Tone::Good,
        headline: "Locked: no part can start to move, alone or together with others.".into(),
        words: vec!["Forces balance on every part, and the rows that they act on have full rank.".into()],
        facts: vec![("rank".into(), "18 of 18".into()), ("self-stress".into(), "44 forces".into())],
        tables: vec![Table {
            caption: String::new(),
            head: vec![Column::words("part"), Column { title: "volume".into(), align: Align::Right }],
            rows: vec![vec!["weft-0".into(), "15.1".into()], vec!["warp-10".into(), "7.25".into()]],
        }],
        ..Chapter::default()
    };
    Summary {
        title: "plain-2x2".into(),
        lead: "Four strands, two by two.".into(),
        chapters: vec![
            ("Lock".into(), Answer::Given(chapter)),
            ("Repeats".into(), Answer::not_run("not built yet")),
        ],
        closing: vec!["Files are in out/.".into()],
    }
}

#[test]
fn the_terminal_shows_names_and_columns_aligned() {
    let text = write(&summary(), Ink::Plain, Columns::default());
    let expected = "\
plain-2x2
Four strands, two by two.

Lock
  ✓ Locked: no part can start to move, alone or together with others.
  Forces balance on every part, and the rows that they act on have full rank.

  rank          18 of 18
  self-stress   44 forces

  part      volume
  weft-0      15.1
  warp-10     7.25

Repeats
  not run: not built yet

Files are in out/.
";
    assert_eq!(text, expected);
}

#[test]
fn no_line_is_longer_than_asked_for() {
    let chapters = vec![("Nasty".into(), Answer::Given(nasty()))];
    let nasty = Summary { lead: "words ".repeat(90), chapters, ..summary() };
    for width in 29..130 {
        for s in [&summary(), &nasty] {
            let text = write(s, Ink::Plain, Columns(width));
            let figure = |l: &str| l.contains("alert");
            let too_long = text.lines().find(|l| l.chars().count() > width && !figure(l));
            assert_eq!(too_long, None, "at {width}");
        }
    }
    assert!(!write(&summary(), Ink::Plain, Columns(0)).is_empty());
}

#[test]
fn only_our_own_colours_reach_the_terminal() {
    let nasty = Summary { chapters: vec![("x".into(), Answer::Given(nasty()))], ..summary() };
    assert!(!write(&nasty, Ink::Plain, Columns::default()).contains(['\u{1b}', '\u{202e}']));
    let coloured = write(&nasty, Ink::Colour, Columns::default());
    let codes: BTreeSet<&str> =
        coloured.split('\u{1b}').skip(1).map(|c| c.split('m').next().unwrap()).collect();
    let ours = BTreeSet::from(["[0", "[1", "[2", "[1;31", "[1;34"]);
    assert!(codes.is_subset(&ours), "{codes:?}");
    let plain: String =
        coloured.split('\u{1b}').map(|c| c.split_once('m').map_or(c, |(_, rest)| rest)).collect();
    assert_eq!(
        plain.matches("script").count(),
        write(&nasty, Ink::Plain, Columns::default()).matches("script").count()
    );
}
