//! Takes an NDBG; gives a drawing of the sphere of directions as SVG: two half spheres, equal in area, the regions
//! colored by what comes apart there.
//!
//! x to the right and y up in both; the lower half is seen through the upper one. Color is never the only sign: arcs
//! and single directions of their own are drawn thick and named in the legend. Not promised: exact outlines (arcs are
//! drawn by chords of [`CHORD`] radians).

use crate::blocking::ndbg::Ndbg;
use glam::{DVec2, DVec3};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Arcs are drawn by chords of this many radians: they leave a disc of 220 pixels by less than a tenth of one.
const CHORD: f64 = 0.05;

/// Radius of a half sphere's disc, its distance from the edges, and the space below, in pixels.
const RADIUS: f64 = 220.0;
const MARGIN: f64 = 50.0;
const LEGEND: f64 = 130.0;

const WIDTH: f64 = 4.0 * RADIUS + 3.0 * MARGIN;
const HEIGHT: f64 = 2.0 * RADIUS + 2.0 * MARGIN + LEGEND;

/// Fill of a graph by its kind; light to dark for more components, all apart from one another in grey, too.
const TIED: &str = "#c3c8d0";
const STAYS: &str = "#9cc3e6";
const PARTED: [&str; 5] = ["#fde3ad", "#f8b65c", "#e9832f", "#bd5a1c", "#6f2d0c"];
const INK: &str = "#1a1a20";

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

    fn fill(self) -> &'static str {
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

/// The drawing as an SVG document.
pub fn svg(ndbg: &Ndbg, name: &str) -> String {
    let mut out = String::new();
    let _ = writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" role="img" width="{WIDTH}" height="{HEIGHT}" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="14">"#
    );
    let count = |k: u8| ndbg.regions.iter().filter(|r| r.dimension == k).count();
    let about = format!("{} patches, {} arcs, {} single directions", count(2), count(1), count(0));
    let _ = writeln!(out, "<title>Directions of {}</title>", escaped(name));
    let _ = writeln!(out, "<desc>The sphere of directions by directional blocking graph: {about}.</desc>");
    let _ = writeln!(out, r##"<rect width="100%" height="100%" fill="#ffffff"/>"##);
    faces(&mut out, ndbg);
    edges(&mut out, ndbg);
    points(&mut out, ndbg);
    labels(&mut out);
    legend(&mut out, ndbg, &about);
    out + "</svg>\n"
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// Where a direction of the upper (or lower) half falls; Lambert's equal-area projection.
fn place(d: DVec3, upper: bool) -> DVec2 {
    let flat = d.truncate() / (1.0 + d.z.abs()).sqrt();
    let middle = if upper { MARGIN + RADIUS } else { 2.0 * MARGIN + 3.0 * RADIUS };
    DVec2::new(middle + flat.x * RADIUS, MARGIN + RADIUS - flat.y * RADIUS)
}

/// Directions along an edge of the arrangement, from its start to its end.
fn along(ndbg: &Ndbg, edge: usize) -> Vec<DVec3> {
    let e = &ndbg.arrangement.edges[edge];
    let steps = ((e.end - e.start) / CHORD).ceil().max(1.0) as usize;
    let at = |k: usize| ndbg.circles.at(e.circle, e.start + (e.end - e.start) * k as f64 / steps as f64);
    (0..=steps).map(at).collect()
}

fn path(points: impl Iterator<Item = DVec2>) -> String {
    let mut text = String::new();
    for (k, p) in points.enumerate() {
        let _ = write!(text, "{}{:.2} {:.2}", if k == 0 { "M" } else { "L" }, p.x, p.y);
    }
    text
}

fn kind_of_region(ndbg: &Ndbg, region: usize) -> Kind {
    Kind::of(ndbg, ndbg.regions[region].graph)
}

/// Each face lies in one half: the equator is part of every arrangement.
fn faces(out: &mut String, ndbg: &Ndbg) {
    let _ = writeln!(out, r#"<g id="patches" stroke-width="0.7" stroke-linejoin="round">"#);
    for (k, face) in ndbg.arrangement.faces.iter().enumerate() {
        let fill = kind_of_region(ndbg, ndbg.region_of[0][k]).fill();
        let upper = face.d.z >= 0.0;
        let rim = face.rim.iter().flat_map(|&(e, forward)| {
            let mut points = along(ndbg, e);
            if !forward {
                points.reverse();
            }
            points
        });
        let outline = path(rim.map(|d| place(d, upper)));
        let _ = writeln!(out, r#"<path d="{outline}Z" fill="{fill}" stroke="{fill}"/>"#);
    }
    let _ = writeln!(out, "</g>");
}

/// Thin where patches part, thick where the arc has a graph of its own.
fn edges(out: &mut String, ndbg: &Ndbg) {
    let _ = writeln!(out, r#"<g id="arcs" fill="none" stroke-linecap="round">"#);
    let mut thick = Vec::new();
    for (k, e) in ndbg.arrangement.edges.iter().enumerate() {
        let own = ndbg.region_of[1][k];
        let beside = [e.left, e.right].map(|f| ndbg.region_of[0][f]);
        if beside == [own, own] {
            continue;
        }
        if ndbg.regions[own].dimension == 1 {
            thick.push((k, kind_of_region(ndbg, own)));
        }
        stroke(out, ndbg, k, INK, 0.9);
    }
    for &(k, kind) in thick.iter().filter(|(_, kind)| *kind != Kind::Tied) {
        stroke(out, ndbg, k, INK, 6.0);
        stroke(out, ndbg, k, kind.fill(), 4.0);
    }
    let _ = writeln!(out, "</g>");
}

/// Once in each half that the edge touches.
fn stroke(out: &mut String, ndbg: &Ndbg, edge: usize, color: &str, width: f64) {
    let points = along(ndbg, edge);
    let middle = points[points.len() / 2].z + points[0].z + points[points.len() - 1].z;
    let on_equator = points.iter().all(|d| d.z.abs() < CHORD * CHORD);
    for upper in [true, false] {
        if on_equator || (middle >= 0.0) == upper {
            let line = path(points.iter().map(|&d| place(d, upper)));
            let _ = writeln!(out, r#"<path d="{line}" stroke="{color}" stroke-width="{width}"/>"#);
        }
    }
}

/// Directions that have a graph of their own.
fn points(out: &mut String, ndbg: &Ndbg) {
    let _ = writeln!(out, r#"<g id="directions" stroke="{INK}" stroke-width="1.4">"#);
    for region in ndbg.regions.iter().filter(|r| r.dimension == 0) {
        let kind = Kind::of(ndbg, region.graph);
        let radius = if kind == Kind::Tied { 3.0 } else { 6.0 };
        for upper in [true, false] {
            if region.d.z.abs() < CHORD * CHORD || (region.d.z > 0.0) == upper {
                let p = place(region.d, upper);
                let _ = writeln!(
                    out,
                    r#"<circle cx="{:.2}" cy="{:.2}" r="{radius}" fill="{}"/>"#,
                    p.x,
                    p.y,
                    kind.fill()
                );
            }
        }
    }
    let _ = writeln!(out, "</g>");
}

fn labels(out: &mut String) {
    let _ = writeln!(out, r#"<g id="axes" fill="{INK}" text-anchor="middle">"#);
    let word = |out: &mut String, p: DVec2, text: &str| {
        let _ = writeln!(out, r#"<text x="{:.1}" y="{:.1}">{text}</text>"#, p.x, p.y);
    };
    for upper in [true, false] {
        let o = place(if upper { DVec3::Z } else { DVec3::NEG_Z }, upper);
        let _ = writeln!(
            out,
            r#"<circle cx="{}" cy="{}" r="{RADIUS}" fill="none" stroke="{INK}" stroke-width="1.2"/>"#,
            o.x, o.y
        );
        let (sign, title) = if upper {
            ("+z", "upper half, z &gt;= 0")
        } else {
            ("-z", "lower half, z &lt;= 0, seen through")
        };
        let _ = writeln!(out, r#"<path d="M{} {}h8m-4 -4v8" stroke="{INK}" fill="none"/>"#, o.x - 4.0, o.y);
        word(out, o + DVec2::new(18.0, -8.0), sign);
        word(out, o + DVec2::new(RADIUS + 14.0, 5.0), "+x");
        word(out, o + DVec2::new(-RADIUS - 14.0, 5.0), "-x");
        word(out, o + DVec2::new(0.0, -RADIUS - 6.0), "+y");
        word(out, o + DVec2::new(0.0, RADIUS + 17.0), "-y");
        word(out, o + DVec2::new(0.0, RADIUS + 36.0), title);
    }
    let _ = writeln!(out, "</g>");
}

fn legend(out: &mut String, ndbg: &Ndbg, about: &str) {
    let kinds: BTreeSet<(Kind, u8)> =
        ndbg.regions.iter().map(|r| (Kind::of(ndbg, r.graph), r.dimension)).collect();
    let top = 2.0 * RADIUS + 2.0 * MARGIN + 12.0;
    let _ = writeln!(out, r#"<g id="legend" fill="{INK}">"#);
    let shapes: BTreeSet<Kind> = kinds.iter().map(|k| k.0).collect();
    for (k, kind) in shapes.iter().enumerate() {
        let (x, y) = (MARGIN + (k % 2) as f64 * (WIDTH / 2.0 - MARGIN), top + (k / 2) as f64 * 23.0);
        let has = |d: u8| kinds.contains(&(*kind, d));
        let mut also = Vec::new();
        also.extend((has(2) && (has(1) || has(0))).then_some("patches"));
        also.extend(has(1).then_some("arcs"));
        also.extend(has(0).then_some("single directions"));
        let also = if also.is_empty() { String::new() } else { format!(" ({})", also.join(", ")) };
        let _ = writeln!(
            out,
            r#"<rect x="{x}" y="{}" width="18" height="14" fill="{}" stroke="{INK}"/><text x="{}" y="{}">{}{also}</text>"#,
            y,
            kind.fill(),
            x + 26.0,
            y + 12.0,
            kind.words()
        );
    }
    let _ = writeln!(
        out,
        r#"<text x="{MARGIN}" y="{}">{about}; {} distinct blocking graphs.</text>"#,
        HEIGHT - 14.0,
        ndbg.graphs.len()
    );
    let _ = writeln!(out, "</g>");
}
