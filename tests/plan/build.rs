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
    let mut facets: Vec<Vec<u32>> = vec![(0..n as u32).rev().collect(), (n as u32..2 * n as u32).collect()];
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
