//! Takes an NDBG; gives a drawing of the sphere of directions: two half spheres, equal in area, the regions colored by
//! what comes apart there.
//!
//! x to the right and y up in both; the lower half is seen through the upper one. Color is never the only sign: arcs
//! and single directions of their own are drawn thick and named in the legend. Not promised: exact outlines (arcs are
//! drawn by chords of `CHORD` radians).

use super::sheet::{Anchor, Mark, Rgb, Sheet, rectangle};
use crate::blocking::ndbg::Ndbg;
use glam::{DVec2, DVec3};
use std::collections::BTreeSet;

/// Arcs are drawn by chords of this many radians: they leave a disc of 220 pixels by less than a tenth of one.
const CHORD: f64 = 0.05;

/// Radius of a half sphere's disc, its distance from the edges, and the space below, in pixels.
const RADIUS: f64 = 220.0;
const MARGIN: f64 = 50.0;
const LEGEND: f64 = 130.0;

const WIDTH: f64 = 4.0 * RADIUS + 3.0 * MARGIN;
const HEIGHT: f64 = 2.0 * RADIUS + 2.0 * MARGIN + LEGEND;

/// Fill of a graph by its kind; light to dark for more components, all apart from one another in grey, too.
const TIED: Rgb = [195, 200, 208];
const STAYS: Rgb = [156, 195, 230];
const PARTED: [Rgb; 5] = [[253, 227, 173], [248, 182, 92], [233, 131, 47], [189, 90, 28], [111, 45, 12]];
const INK: Rgb = [26, 26, 32];

/// What a graph means to the eye.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// One strongly connected component.
    Tied,
    /// Several, but only held ones could leave.
    Stays,
    /// Something can leave: index into [`PARTED`].
    Parted(usize),
}

impl Kind {
    fn of(ndbg: &Ndbg, graph: usize) -> Kind {
        let g = &ndbg.graphs[graph];
        match (g.components.len(), g.leave.is_empty()) {
            (0 | 1, _) => Kind::Tied,
            (_, true) => Kind::Stays,
            (n, false) => Kind::Parted((n - 2).min(PARTED.len() - 1)),
        }
    }

    fn fill(self) -> Rgb {
        match self {
            Kind::Tied => TIED,
            Kind::Stays => STAYS,
            Kind::Parted(k) => PARTED[k],
        }
    }

    fn words(self) -> String {
        match self {
            Kind::Tied => "all tied together".into(),
            Kind::Stays => "apart, but held".into(),
            Kind::Parted(k) if k + 1 == PARTED.len() => {
                format!("a set can leave; {} or more components", k + 2)
            }
            Kind::Parted(k) => format!("a set can leave; {} components", k + 2),
        }
    }
}

/// The drawing.
pub fn sheet(ndbg: &Ndbg, name: &str) -> Sheet {
    let mut marks = Vec::new();
    faces(&mut marks, ndbg);
    edges(&mut marks, ndbg);
    points(&mut marks, ndbg);
    labels(&mut marks);
    legend(&mut marks, ndbg, name);
    Sheet { width: WIDTH, height: HEIGHT, marks }
}

fn center(upper: bool) -> DVec2 {
    DVec2::new(if upper { MARGIN + RADIUS } else { 2.0 * MARGIN + 3.0 * RADIUS }, MARGIN + RADIUS)
}

/// Where a direction of the upper (or lower) half falls; Lambert's equal-area projection.
fn place(d: DVec3, upper: bool) -> [f64; 2] {
    let flat = d.truncate() / (1.0 + d.z.abs()).sqrt() * RADIUS;
    (center(upper) + DVec2::new(flat.x, -flat.y)).to_array()
}

/// Directions along an edge of the arrangement, from its start to its end.
fn along(ndbg: &Ndbg, edge: usize) -> Vec<DVec3> {
    let e = &ndbg.arrangement.edges[edge];
    let steps = ((e.end - e.start) / CHORD).ceil().max(1.0) as usize;
    let at = |k: usize| ndbg.circles.at(e.circle, e.start + (e.end - e.start) * k as f64 / steps as f64);
    (0..=steps).map(at).collect()
}

fn kind_of_region(ndbg: &Ndbg, region: usize) -> Kind {
    Kind::of(ndbg, ndbg.regions[region].graph)
}

/// Each face lies in one half: the equator is part of every arrangement.
fn faces(marks: &mut Vec<Mark>, ndbg: &Ndbg) {
    for (k, face) in ndbg.arrangement.faces.iter().enumerate() {
        let upper = face.d.z >= 0.0;
        let rim = face.rim.iter().flat_map(|&(e, forward)| {
            let mut points = along(ndbg, e);
            if !forward {
                points.reverse();
            }
            points
        });
        let points = rim.map(|d| place(d, upper)).collect();
        marks.push(Mark::Fill { points, ink: kind_of_region(ndbg, ndbg.region_of[0][k]).fill() });
    }
}

/// Lines over the seams inside a region (its own color), where patches part (thin), and where an arc has a graph of its
/// own (thick), pixels.
const SEAM: f64 = 1.0;
const THIN: f64 = 0.9;
const THICK: f64 = 6.0;

fn edges(marks: &mut Vec<Mark>, ndbg: &Ndbg) {
    let (mut thin, mut thick) = (Vec::new(), Vec::new());
    for (k, e) in ndbg.arrangement.edges.iter().enumerate() {
        let own = ndbg.region_of[1][k];
        let kind = kind_of_region(ndbg, own);
        if [e.left, e.right].map(|f| ndbg.region_of[0][f]) == [own, own] {
            stroke(marks, ndbg, k, kind.fill(), SEAM);
            continue;
        }
        thin.push(k);
        if ndbg.regions[own].dimension == 1 && kind != Kind::Tied {
            thick.push((k, kind));
        }
    }
    thin.into_iter().for_each(|k| stroke(marks, ndbg, k, INK, THIN));
    thick.iter().for_each(|&(k, _)| stroke(marks, ndbg, k, INK, THICK));
    thick.iter().for_each(|&(k, kind)| stroke(marks, ndbg, k, kind.fill(), THICK - 2.0));
}

/// In the half that the edge lies in; on the equator in both.
fn stroke(marks: &mut Vec<Mark>, ndbg: &Ndbg, edge: usize, ink: Rgb, width: f64) {
    let along = along(ndbg, edge);
    let height = along.iter().map(|d| d.z).sum::<f64>() / along.len() as f64;
    let on_equator = along.iter().all(|d| at_equator(*d));
    for upper in [true, false] {
        if on_equator || (height >= 0.0) == upper {
            let points = along.iter().map(|&d| place(d, upper)).collect();
            marks.push(Mark::Line { points, ink, width });
        }
    }
}

/// So near the equator that the eye sees no difference: a fifth of a pixel.
fn at_equator(d: DVec3) -> bool {
    d.z.abs() < 1e-3
}

/// A dot of this radius, pixels.
fn dot(marks: &mut Vec<Mark>, middle: [f64; 2], radius: f64, ink: Rgb) {
    let corner = |k: u32| {
        let (s, c) = (f64::from(k) * std::f64::consts::TAU / 24.0).sin_cos();
        [middle[0] + radius * c, middle[1] + radius * s]
    };
    marks.push(Mark::Fill { points: (0..24).map(corner).collect(), ink });
}

/// Directions that have a graph of their own.
fn points(marks: &mut Vec<Mark>, ndbg: &Ndbg) {
    for region in ndbg.regions.iter().filter(|r| r.dimension == 0) {
        let kind = Kind::of(ndbg, region.graph);
        let radius = if kind == Kind::Tied { 3.0 } else { 6.0 };
        for upper in [true, false] {
            if at_equator(region.d) || (region.d.z > 0.0) == upper {
                let at = place(region.d, upper);
                dot(marks, at, radius + 1.2, INK);
                dot(marks, at, radius, kind.fill());
            }
        }
    }
}

/// Size of letters, pixels.
const LETTERS: f64 = 14.0;

fn words(marks: &mut Vec<Mark>, at: DVec2, anchor: Anchor, text: impl Into<String>) {
    marks.push(Mark::Words { at: at.to_array(), size: LETTERS, anchor, ink: INK, text: text.into() });
}

fn labels(marks: &mut Vec<Mark>) {
    for upper in [true, false] {
        let o = center(upper);
        let rim = (0..=126).map(|k| {
            let (s, c) = (f64::from(k) * std::f64::consts::TAU / 126.0).sin_cos();
            (o + RADIUS * DVec2::new(c, s)).to_array()
        });
        marks.push(Mark::Line { points: rim.collect(), ink: INK, width: 1.2 });
        let (sign, title) =
            if upper { ("+z", "upper half, z >= 0") } else { ("-z", "lower half, z <= 0, seen through") };
        for way in [DVec2::X, DVec2::Y] {
            let points = vec![(o - 4.0 * way).to_array(), (o + 4.0 * way).to_array()];
            marks.push(Mark::Line { points, ink: INK, width: 1.0 });
        }
        let near = [
            (DVec2::new(18.0, -8.0), sign),
            (DVec2::new(RADIUS + 14.0, 5.0), "+x"),
            (DVec2::new(-RADIUS - 14.0, 5.0), "-x"),
            (DVec2::new(0.0, -RADIUS - 6.0), "+y"),
            (DVec2::new(0.0, RADIUS + 17.0), "-y"),
            (DVec2::new(0.0, RADIUS + 36.0), title),
        ];
        near.into_iter().for_each(|(by, text)| words(marks, o + by, Anchor::Middle, text));
    }
}

fn legend(marks: &mut Vec<Mark>, ndbg: &Ndbg, name: &str) {
    let kinds: BTreeSet<(Kind, u8)> =
        ndbg.regions.iter().map(|r| (Kind::of(ndbg, r.graph), r.dimension)).collect();
    let shapes: BTreeSet<Kind> = kinds.iter().map(|k| k.0).collect();
    let top = 2.0 * RADIUS + 2.0 * MARGIN + 12.0;
    for (k, kind) in shapes.iter().enumerate() {
        let at = DVec2::new(MARGIN + (k % 2) as f64 * (WIDTH / 2.0 - MARGIN), top + (k / 2) as f64 * 23.0);
        let drawn = [(2, "patches"), (1, "arcs"), (0, "single directions")];
        let drawn: Vec<&str> =
            drawn.into_iter().filter(|(d, _)| kinds.contains(&(*kind, *d))).map(|d| d.1).collect();
        marks.push(Mark::Fill { points: rectangle(at.x, at.y, 18.0, 14.0), ink: INK });
        marks.push(Mark::Fill { points: rectangle(at.x + 1.0, at.y + 1.0, 16.0, 12.0), ink: kind.fill() });
        let text = format!("{} ({})", kind.words(), drawn.join(", "));
        words(marks, at + DVec2::new(26.0, 12.0), Anchor::Start, text);
    }
    let count = |k: u8| ndbg.regions.iter().filter(|r| r.dimension == k).count();
    let about = format!(
        "{name}: {} patches, {} arcs, {} single directions; {} distinct blocking graphs.",
        count(2),
        count(1),
        count(0),
        ndbg.graphs.len()
    );
    words(marks, DVec2::new(MARGIN, HEIGHT - 14.0), Anchor::Start, about);
}
