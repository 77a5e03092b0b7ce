//! Takes the meshes on their masters; gives what is printed of them and of their molds: each part alone, plates, the
//! assembly, coupons.
//!
//! Promised: every mesh of a 3MF is what was checked as STL, turned and shifted, rounded to f32, still closed, with every
//! item in the positive octant. Not promised: that a slicer keeps the places on a plate when it is told to arrange.

use super::laying::lay;
use super::{AssemblyReport, Attachment, CouponReport, LayingReport, PackageReport, PlateReport, low, plate};
use crate::coupon::Coupon;
use crate::files::{stems, stl};
use crate::make::Output;
use crate::mesh::{Closure, Mesh};
use crate::mold::Kind as PieceKind;
use crate::mold::frame::upright;
use crate::process::Process;
use crate::report::{Finding, Place, RouteReport, Severity};
use crate::threemf::{self, Build, Model, Object};
use glam::DVec3;
use rayon::prelude::*;
use std::io;

/// How each written part whose own shape is printed lies on the bed; congruent parts of one route lie alike.
pub fn layings(output: &Output) -> Vec<LayingReport> {
    let parts = &output.report.parts;
    let own: Vec<usize> = (0..parts.len())
        .filter(|&p| output.masters[p].is_some() && printed(output, p) && kind_of(output, p) == p)
        .collect();
    let lay_one = |&p: &usize| {
        let mesh = output.masters[p].as_ref()?;
        Some(LayingReport { part: parts[p].id.clone(), laying: output.laid[p].unwrap_or_else(|| lay(mesh)) })
    };
    own.par_iter().filter_map(lay_one).collect()
}

fn route_of(output: &Output, p: usize) -> Option<&RouteReport> {
    let id = &output.report.parts[p].id;
    output.report.routes.iter().find(|r| r.parts.contains(id))
}

fn printed(output: &Output, p: usize) -> bool {
    route_of(output, p).is_some_and(|r| r.process.route.prints_the_shape())
}

/// The first written part with the same solid, by the same process.
pub fn kind_of(output: &Output, p: usize) -> usize {
    let parts = &output.report.parts;
    let root = |q: usize| parts[q].same_as.as_deref().unwrap_or(&parts[q].id);
    let same = |q: &usize| {
        output.masters[*q].is_some() && root(*q) == root(p) && parts[*q].process == parts[p].process
    };
    (0..p).find(same).unwrap_or(p)
}

pub fn stem(output: &Output, p: usize) -> String {
    let file = output.report.parts[p].file.as_deref().unwrap_or("part.mm.stl");
    file.trim_start_matches("parts/").trim_end_matches(".mm.stl").to_string()
}

fn grounded(mesh: &Mesh) -> Mesh {
    let down = low(mesh);
    stl::snapped_closed(&mesh.map(|v| v - down))
}

/// Each part alone as 3MF, beside its STL.
pub fn parts(output: &Output, package: &mut PackageReport) -> Vec<Attachment> {
    let files = (0..output.masters.len()).filter_map(|p| {
        let mesh = grounded(output.masters[p].as_ref()?);
        let id = &output.report.parts[p].id;
        let name = format!("parts/{}.mm.3mf", stem(output, p));
        let model = Model {
            title: id.clone(),
            description: format!("Scale {} already applied.", output.report.parts[p].scale),
            objects: vec![Object { name: id.clone(), mesh }],
            build: Build::Items(vec![(0, DVec3::ZERO, id.clone())]),
        };
        Some((name, model))
    });
    files.collect::<Vec<_>>().into_iter().filter_map(|(name, model)| packed(&name, &model, package)).collect()
}

/// The package's bytes, read back; a finding where they are not what they should be.
fn packed(name: &str, model: &Model, package: &mut PackageReport) -> Option<Attachment> {
    let sound = model.objects.iter().all(|o| o.mesh.closure() == Closure::Closed);
    let meshes: Vec<&Mesh> = model.objects.iter().map(|o| &o.mesh).collect();
    let back = |bytes: &Vec<u8>| -> io::Result<bool> {
        Ok(threemf::read(bytes)?.iter().collect::<Vec<_>>() == meshes)
    };
    let written = threemf::write(model).and_then(|bytes| Ok((back(&bytes)?, bytes)));
    let why = match written {
        Ok((true, bytes)) if sound => return Some(Attachment { name: name.to_string(), bytes }),
        Ok((false, _)) => "read back it is not what was written".to_string(),
        Ok(_) => "rounding to f32 opened a mesh".to_string(),
        Err(e) => e.to_string(),
    };
    package.report.findings.push(Finding {
        severity: Severity::Error,
        place: Place::default(),
        what: format!("{name} was not written: {why}"),
        remedy: "use the STL files, and report this with the input".into(),
    });
    None
}

/// The plates of every route whose parts are printed.
pub fn plates(output: &Output, package: &mut PackageReport) -> Vec<Attachment> {
    let routes: Vec<&RouteReport> =
        output.report.routes.iter().filter(|r| r.process.route.prints_the_shape()).collect();
    let names = stems(&routes.iter().map(|r| r.process.name.clone()).collect::<Vec<_>>());
    routes.iter().zip(names).flat_map(|(r, name)| plates_of(output, r, &name, package)).collect()
}

/// A thing to be printed: the index of its kind's first part, and the id that it is for.
struct Thing {
    kind: usize,
    part: String,
}

/// A master serves all parts of its kind; parts and patterns are printed one for each.
fn things(output: &Output, route: &RouteReport) -> Vec<Thing> {
    let once = matches!(route.process.route.printed(), "master");
    let mine = |p: &usize| output.masters[*p].is_some() && route.parts.contains(&output.report.parts[*p].id);
    let all = (0..output.masters.len()).filter(mine);
    let thing = |p: usize| Thing { kind: kind_of(output, p), part: output.report.parts[p].id.clone() };
    all.filter(|&p| !once || kind_of(output, p) == p).map(thing).collect()
}

fn plates_of(
    output: &Output,
    route: &RouteReport,
    name: &str,
    package: &mut PackageReport,
) -> Vec<Attachment> {
    let things = things(output, route);
    let mut kinds: Vec<usize> = things.iter().map(|t| t.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let id = |k: usize| output.report.parts[k].id.clone();
    let load = Load {
        process: &route.process,
        stem: if route.process.route.printed() == "master" { format!("{name}-masters") } else { name.into() },
        scale: route.scale,
        solids: kinds.iter().map(|&k| (id(k), turned(output, package, k))).collect(),
        things: things.into_iter().map(|t| (kinds.binary_search(&t.kind).unwrap_or(0), t.part)).collect(),
        remedy: "name a larger bed with --bed, or take a smaller pitch",
    };
    loaded(&load, package)
}

/// What stands on the plates of a process.
struct Load<'a> {
    process: &'a Process,
    /// Of the files' names.
    stem: String,
    scale: f64,
    /// Different solids as they lie on the bed, lowest corner at the origin, by name.
    solids: Vec<(String, Mesh)>,
    /// What is printed: the index of its solid, and what it is for.
    things: Vec<(usize, String)>,
    /// Where one is too large for the bed.
    remedy: &'static str,
}

fn loaded(load: &Load, package: &mut PackageReport) -> Vec<Attachment> {
    let bed = &load.process.print.bed;
    let size = |t: &(usize, String)| (load.solids[t.0].1.bounds().1, t.1.clone());
    let sizes: Vec<(DVec3, String)> = load.things.iter().map(size).collect();
    let arranged = plate::arrange(&sizes, bed);
    for &k in &arranged.too_large {
        package.report.findings.push(too_large(&sizes[k], load));
    }
    let mut files = Vec::new();
    for (k, stands) in arranged.plates.into_iter().enumerate() {
        let file = format!("print/{}-plate-{}.mm.3mf", load.stem, k + 1);
        let of: Vec<usize> = stands.iter().map(|s| load.things[s.thing].0).collect();
        files.extend(packed(&file, &model(load, k + 1, &stands, &of, &package.report.name), package));
        let shown = stands.iter().zip(&of);
        package.plates.push(PlateReport {
            shown: shown.map(|(s, &u)| (s.part.clone(), load.solids[u].1.map(|v| v + s.at))).collect(),
            file,
            process: load.process.name.clone(),
            bed: bed.name.clone(),
            bed_mm: bed.size,
            stands,
            grams: None,
            checks: vec![],
        });
    }
    files
}

/// A plate as 3MF; `of`: the solid of each thing that stands on it.
fn model(load: &Load, number: usize, stands: &[plate::Stand], of: &[usize], title: &str) -> Model {
    let mut used = of.to_vec();
    used.sort_unstable();
    used.dedup();
    let object = |&u: &usize| Object { name: load.solids[u].0.clone(), mesh: load.solids[u].1.clone() };
    let item = |(s, u): (&plate::Stand, &usize)| (used.binary_search(u).unwrap_or(0), s.at, s.part.clone());
    Model {
        title: format!("{title} plate {number}"),
        description: format!("Scale {} already applied: print at 100 %.", load.scale),
        objects: used.iter().map(object).collect(),
        build: Build::Items(stands.iter().zip(of).map(item).collect()),
    }
}

/// A piece of a mold to be printed, in the mold's frame.
pub struct MoldPrint {
    pub process: String,
    /// Of its file.
    pub name: String,
    pub kind: PieceKind,
    pub pull: DVec3,
    pub copies: usize,
    pub mesh: Mesh,
}

/// The plates of all that is printed of molds, for each process its own.
pub fn mold_plates(prints: &[MoldPrint], package: &mut PackageReport) -> Vec<Attachment> {
    let routes = package.report.routes.clone();
    let names = stems(&routes.iter().map(|r| r.process.name.clone()).collect::<Vec<_>>());
    let mut files = Vec::new();
    for (route, name) in routes.iter().zip(names) {
        let own: Vec<&MoldPrint> = prints.iter().filter(|p| p.process == route.process.name).collect();
        let things = |(k, p): (usize, &&MoldPrint)| vec![(k, p.name.clone()); p.copies];
        let load = Load {
            process: &route.process,
            stem: format!("{name}-molds"),
            scale: route.scale,
            solids: own.iter().map(|p| (p.name.clone(), as_printed(p))).collect(),
            things: own.iter().enumerate().flat_map(things).collect(),
            remedy: "name a larger bed with --bed, take a smaller pitch, or cast a shorter part",
        };
        files.extend(loaded(&load, package));
    }
    files
}

/// On the bed: halves with the parting face up, cores on their grips, the long side along the bed's.
fn as_printed(p: &MoldPrint) -> Mesh {
    let mesh = match p.kind {
        PieceKind::Half if p.pull.z > 0.0 => p.mesh.map(|v| DVec3::new(v.x, -v.y, -v.z)),
        PieceKind::Core => {
            let turn = upright(-p.pull);
            p.mesh.map(|v| turn * v)
        }
        _ => p.mesh.clone(),
    };
    let (lo, hi) = mesh.bounds();
    let long = hi - lo;
    grounded(&if long.y > long.x { mesh.map(|v| DVec3::new(v.y, -v.x, v.z)) } else { mesh })
}

/// The mesh as it lies on the bed, its lowest corner at the origin.
fn turned(output: &Output, package: &PackageReport, kind: usize) -> Mesh {
    let id = &output.report.parts[kind].id;
    let laying = package.layings.iter().find(|l| l.part == *id);
    let mesh = output.masters[kind].clone().unwrap_or_default();
    laying.map_or(mesh.clone(), |l| grounded(&mesh.map(|v| l.laying.turn * v)))
}

fn too_large((size, part): &(DVec3, String), load: &Load) -> Finding {
    let bed = &load.process.print.bed;
    let [x, y, z] = bed.size;
    Finding {
        severity: Severity::Error,
        place: Place { parts: vec![part.clone()], at: vec![] },
        what: format!(
            "lies on {:.1} x {:.1} x {:.1} mm; the bed {} takes {x} x {y} x {z} mm less {} mm around; it is on no plate",
            size.x,
            size.y,
            size.z,
            bed.name,
            plate::SPACING
        ),
        remedy: load.remedy.into(),
    }
}

/// The assembly as one object with components: a slicer may move items, never components.
pub fn assembly(output: &Output, package: &mut PackageReport) -> Vec<Attachment> {
    let written: Vec<usize> = (0..output.masters.len()).filter(|&p| output.masters[p].is_some()).collect();
    if written.is_empty() || output.report.routes.iter().any(|r| r.process.clearance.value == 0.0) {
        return vec![];
    }
    let shared = match &output.report.routes[..] {
        [one] => one.scale,
        _ => 1.0,
    };
    let finished = finished(output);
    let all: Vec<Mesh> = finished
        .iter()
        .map(|(_, m)| m.map(|v| output.report.datum + (v - output.report.datum) * shared))
        .collect();
    let corner = all.iter().map(low).fold(DVec3::INFINITY, DVec3::min);
    let object = |((id, _), m): (&(String, Mesh), &Mesh)| Object {
        name: id.clone(),
        mesh: stl::snapped_closed(&m.map(|v| v - corner)),
    };
    let file = "assembly.mm.3mf".to_string();
    let model = Model {
        title: output.report.name.clone(),
        description: format!("All parts in place with their clearance, at {shared} times the finished size."),
        objects: finished.iter().zip(&all).map(object).collect(),
        build: Build::Whole(DVec3::ZERO),
    };
    let packed = packed(&file, &model, package);
    if packed.is_some() {
        package.assembly =
            Some(AssemblyReport { file, scale: shared, components: written.len(), checks: vec![] });
    }
    packed.into_iter().collect()
}

/// All written parts at finished size, in place.
pub fn finished(output: &Output) -> Vec<(String, Mesh)> {
    let (parts, datum) = (&output.report.parts, output.report.datum);
    let one = |p: usize| {
        let mesh = output.masters[p].as_ref()?;
        Some((parts[p].id.clone(), mesh.map(|v| datum + (v - datum) / parts[p].scale)))
    };
    (0..parts.len()).filter_map(one).collect()
}

/// A coupon for each route: its clearances differ.
pub fn coupons(package: &mut PackageReport) -> Vec<Attachment> {
    let routes: Vec<(String, f64)> =
        package.report.routes.iter().map(|r| (r.process.name.clone(), r.process.clearance.value)).collect();
    let names = stems(&routes.iter().map(|r| r.0.clone()).collect::<Vec<_>>());
    let mut files = Vec::new();
    for ((process, clearance), name) in routes.into_iter().zip(names) {
        let coupon = Coupon::of(clearance);
        for (mesh, what) in [(&coupon.gauge, "gauge"), (&coupon.key, "key")] {
            let mut bytes = Vec::new();
            // Writing into memory can not fail.
            let _ = stl::write(mesh, &mut bytes);
            files.push(Attachment { name: format!("coupon/{name}-{what}.mm.stl"), bytes });
        }
        let model = Model {
            title: format!("coupon for {process}"),
            description: "True size: print at 100 %, no scale.".into(),
            objects: [("gauge", &coupon.gauge), ("key", &coupon.key)]
                .map(|(n, m)| Object { name: n.into(), mesh: grounded(m) })
                .to_vec(),
            build: Build::Items(vec![(0, DVec3::ZERO, "gauge".into()), (1, low(&coupon.key), "key".into())]),
        };
        files.extend(packed(&format!("coupon/{name}.mm.3mf"), &model, package));
        package.coupons.push(CouponReport { process, coupon });
    }
    files
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ears::triangulate;
    use crate::shape::Facet;

    /// An outline in the plane, 5 mm thick, with its corners on f32.
    fn plate(outline: &[(f64, f64)]) -> Mesh {
        let n = outline.len() as u32;
        let at = |z: f64| outline.iter().map(move |&(x, y)| DVec3::new(f64::from(x as f32), y, z));
        let vertices: Vec<DVec3> = at(0.0).chain(at(5.0)).collect();
        let cap = |corners: Vec<u32>, normal| triangulate(&vertices, &Facet { corners, normal });
        let mut triangles = cap((0..n).rev().collect(), DVec3::NEG_Z);
        triangles.extend(cap((n..2 * n).collect(), DVec3::Z));
        triangles
            .extend((0..n).map(|a| (a, (a + 1) % n)).flat_map(|(a, b)| [[a, b, b + n], [a, b + n, a + n]]));
        Mesh { vertices, triangles }
    }

    /// A fin of a nanometre near the origin is there in f32, and a hundred millimetres away it is not: its sides fall
    /// together, and edges would have four triangles. What is put on the bed has it united before.
    #[test]
    fn a_mesh_that_rounding_would_open_is_settled_before_it_is_written() {
        const FIN: f64 = 1e-6;
        let outline = [
            (-100.0, 0.0),
            (10.0, 0.0),
            (10.0, 5.0),
            (FIN, 5.0),
            (FIN, 15.0),
            (0.0, 15.0),
            (0.0, 5.0),
            (-100.0, 5.0),
        ];
        let mesh = plate(&outline);
        assert_eq!((mesh.closure(), stl::snapped(&mesh).closure()), (Closure::Closed, Closure::Closed));
        let plain = stl::snapped(&mesh.map(|v| v - low(&mesh)));
        assert_ne!(plain.closure(), Closure::Closed, "the fin survives: this tests nothing");
        let settled = grounded(&mesh);
        assert_eq!((settled.closure(), low(&settled)), (Closure::Closed, DVec3::ZERO));
        let off = settled.volume() - mesh.volume();
        assert!(off.abs() < FIN * mesh.area(), "{off}");
    }
}
