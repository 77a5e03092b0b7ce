//! Takes parts in mm; gives a STEP file (ISO 10303-21, schema AP214): each part a solid with flat faces and shared edges,
//! named by its id.
//!
//! Promised: every edge lies between exactly two faces that run it in opposite directions, else there is no file. Not
//! promised: curved surfaces; a tile is written with the facets that stand for its curved sides.

use crate::assembly::{Assembly, PartIx};
use crate::solid::Solid;
use glam::DVec3;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::fmt::Write;

/// Why there is no file.
#[derive(Debug, PartialEq, thiserror::Error)]
#[error("{part} is not closed: an edge is not between two opposite faces")]
pub struct Open {
    pub part: String,
}

/// What a reader takes as one point, mm: the customary figure of solid modellers, far below what is made.
const ONE_POINT: &str = "1.E-07";

const HEAD: &str = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n";
const SCHEMA: &str = "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n";

/// Entities under construction, numbered from 1.
struct Data {
    text: String,
    count: usize,
}

impl Data {
    fn add(&mut self, entity: &str) -> usize {
        self.count += 1;
        let _ = writeln!(self.text, "#{}={entity};", self.count);
        self.count
    }

    fn triple(&mut self, kind: &str, v: DVec3) -> usize {
        // A real number has a point; 16 digits behind it bring an f64 back as it was. A minus zero is none.
        let [x, y, z] = v.to_array().map(|c| format!("{:.16E}", c + 0.0));
        self.add(&format!("{kind}('',({x},{y},{z}))"))
    }

    /// A frame with its z along `z`.
    fn frame(&mut self, at: DVec3, z: DVec3, x: DVec3) -> usize {
        let (p, z, x) =
            (self.triple("CARTESIAN_POINT", at), self.triple("DIRECTION", z), self.triple("DIRECTION", x));
        self.add(&format!("AXIS2_PLACEMENT3D('',#{p},#{z},#{x})"))
    }
}

/// The parts in place.
pub fn step(asm: &Assembly, parts: &[PartIx]) -> Result<Vec<u8>, Open> {
    let mut data = Data { text: String::new(), count: 0 };
    let origin = data.frame(DVec3::ZERO, DVec3::Z, DVec3::X);
    let mut items = vec![origin];
    for &p in parts {
        let id = &asm.part(p).id;
        let points: Vec<DVec3> = asm.vertices(p).map(|v| v * asm.mm_per_unit).collect();
        let turn = asm.part(p).pose.matrix3;
        let faces = shell(&mut data, asm.solid(p), &points, |n| turn * n);
        let faces = faces.ok_or_else(|| Open { part: id.clone() })?;
        let shell = data.add(&format!("CLOSED_SHELL('',({}))", listed(&faces)));
        items.push(data.add(&format!("MANIFOLD_SOLID_BREP({},#{shell})", quoted(id))));
    }
    product(&mut data, &asm.name, &items);
    let name = format!(
        "FILE_NAME({},'1970-01-01T00:00:00',(''),(''),'weavelock {}','weavelock','');\n",
        quoted(&asm.name),
        env!("CARGO_PKG_VERSION")
    );
    Ok(format!("{HEAD}{name}{SCHEMA}{}ENDSEC;\nEND-ISO-10303-21;\n", data.text).into_bytes())
}

fn listed(numbers: &[usize]) -> String {
    numbers.iter().map(|n| format!("#{n}")).collect::<Vec<_>>().join(",")
}

/// A string of the format: ASCII, quotes doubled; other signs in its own escape for 32 bits.
fn quoted(text: &str) -> String {
    let sign = |c: char| match c {
        '\'' => "''".to_string(),
        '\\' => "\\\\".to_string(),
        ' '..='~' => c.to_string(),
        c => format!("\\X4\\{:08X}\\X0\\", u32::from(c)),
    };
    format!("'{}'", text.chars().map(sign).collect::<String>())
}

/// The faces of a solid; `None` where an edge is not between two opposite ones.
fn shell(
    data: &mut Data,
    solid: &Solid,
    points: &[DVec3],
    turned: impl Fn(DVec3) -> DVec3,
) -> Option<Vec<usize>> {
    let mut corners: BTreeMap<u32, usize> = BTreeMap::new();
    // Each edge from its lower to its higher vertex, with how often it is run forward and backward.
    let mut edges: BTreeMap<(u32, u32), (usize, [u32; 2])> = BTreeMap::new();
    let mut faces = Vec::new();
    for facet in &solid.facets {
        let n = facet.corners.len();
        let mut ring = Vec::new();
        for k in 0..n {
            let (a, b) = (facet.corners[k], facet.corners[(k + 1) % n]);
            let key = (a.min(b), a.max(b));
            let (number, runs) = match edges.entry(key) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => new.insert((edge(data, &mut corners, points, key)?, [0, 0])),
            };
            runs[usize::from(a > b)] += 1;
            let way = if a < b { ".T." } else { ".F." };
            ring.push(data.add(&format!("ORIENTED_EDGE('',*,*,#{number},{way})")));
        }
        let first = *points.get(*facet.corners.first()? as usize)?;
        let normal = turned(facet.normal);
        let along = (points[facet.corners[1] as usize] - first).try_normalize()?;
        let frame = data.frame(first, normal, along);
        let plane = data.add(&format!("PLANE('',#{frame})"));
        let ring = data.add(&format!("EDGE_LOOP('',({}))", listed(&ring)));
        let bound = data.add(&format!("FACE_OUTER_BOUND('',#{ring},.T.)"));
        faces.push(data.add(&format!("ADVANCED_FACE('',(#{bound}),#{plane},.T.)")));
    }
    edges.values().all(|(_, runs)| *runs == [1, 1]).then_some(faces)
}

fn edge(
    data: &mut Data,
    corners: &mut BTreeMap<u32, usize>,
    points: &[DVec3],
    (a, b): (u32, u32),
) -> Option<usize> {
    let [p, q] = [*points.get(a as usize)?, *points.get(b as usize)?];
    let ends = [(a, p), (b, q)].map(|(v, at)| {
        *corners.entry(v).or_insert_with(|| {
            let point = data.triple("CARTESIAN_POINT", at);
            data.add(&format!("VERTEX_POINT('',#{point})"))
        })
    });
    let start = data.triple("CARTESIAN_POINT", p);
    let along = data.triple("DIRECTION", (q - p).try_normalize()?);
    let vector = data.add(&format!("VECTOR('',#{along},1.)"));
    let line = data.add(&format!("LINE('',#{start},#{vector})"));
    Some(data.add(&format!("EDGE_CURVE('',#{},#{},#{line},.T.)", ends[0], ends[1])))
}

/// The product that the solids are the shape of, in mm.
fn product(data: &mut Data, name: &str, items: &[usize]) {
    let name = quoted(name);
    let mm = data.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
    let rad = data.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
    let sr = data.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
    let fine = data.add(&format!(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({ONE_POINT}),#{mm},'distance_accuracy_value','')"
    ));
    let space = data.add(&format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{fine}))GLOBAL_UNIT_ASSIGNED_CONTEXT((#{mm},#{rad},#{sr}))REPRESENTATION_CONTEXT('',''))"
    ));
    let shape = data.add(&format!("ADVANCED_BREP_SHAPE_REPRESENTATION('',({}),#{space})", listed(items)));
    let context = data.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')");
    data.add(&format!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{context})"
    ));
    let of = data.add(&format!("PRODUCT_CONTEXT('',#{context},'mechanical')"));
    let product = data.add(&format!("PRODUCT({name},{name},'',(#{of}))"));
    let formation = data.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
    let stage = data.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{context},'design')"));
    let definition = data.add(&format!("PRODUCT_DEFINITION('design','',#{formation},#{stage})"));
    let whole = data.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{definition})"));
    data.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{whole},#{shape})"));
}
