//! Takes the tables of an assembly of meshes; gives its parts with ids, files and poses, tolerance and unit.
//!
//! Promised: ids are unique; poses are proper rigid motions to round-off. Not promised: that the mesh files exist.

use super::read::{home, plain_name};
use super::reader::{Field, Fields, Reader};
use super::units;
use super::{MeshPartSpec, MeshSpec};
use crate::assembly::Mobility;
use crate::fault::quoted;
use glam::{DAffine3, DMat3, DVec3};
use std::collections::BTreeMap;
use std::ops::Bound::{Excluded, Included};
use std::path::{Path, PathBuf};

/// Taken where `[contact]` is absent, in mm.
const DEFAULT_TOLERANCE_MM: f64 = 0.001;

/// Largest tolerance and largest shift of a pose, in mm and in the file's unit: a kilometre.
const MAX_LENGTH: f64 = 1e6;

/// How far the product of a pose's rotation with its transpose may be from one: entries written with six decimals are
/// off by 5e-7, each element of the product is a sum of three products with two such factors of size up to one, and
/// by Cauchy-Schwarz 2 * sqrt(3) * 5e-7 bounds it.
const POSE_ERROR: f64 = 2e-6;

pub fn meshes<'t>(reader: &mut Reader<'t>, root: &Fields<'t>, parts: &Field<'t>) -> Option<MeshSpec> {
    let items = reader.list(parts, "each part is a table [[part]]");
    let parts = items.and_then(|items| all_parts(reader, parts, &items));
    let tolerance = tolerance(reader, root);
    let unit = unit(reader, root);
    Some(MeshSpec { parts: parts?, tolerance_mm: tolerance?, mm_per_unit: unit?, puzzle: None })
}

fn all_parts<'t>(
    reader: &mut Reader<'t>,
    field: &Field<'t>,
    items: &[Field<'t>],
) -> Option<Vec<MeshPartSpec>> {
    if items.is_empty() {
        reader.fault(field, "is empty", "an assembly has at least one part");
        return None;
    }
    let read: Vec<_> = items.iter().map(|item| part(reader, item)).collect();
    let mut first: BTreeMap<&str, usize> = BTreeMap::new();
    let mut unique = true;
    for (at, part) in read.iter().enumerate().filter_map(|(at, part)| Some((at, part.as_ref()?))) {
        let before = *first.entry(&part.id).or_insert(at);
        if before != at {
            let what = format!("has the id {} of part[{before}]", quoted(&part.id));
            reader.fault(&items[at], what, "give each part its own `id`; by default it is the file's stem");
            unique = false;
        }
    }
    read.into_iter().collect::<Option<_>>().filter(|_| unique)
}

fn part<'t>(reader: &mut Reader<'t>, item: &Field<'t>) -> Option<MeshPartSpec> {
    let fields = reader.table(item)?;
    reader.only(&fields, &["id", "mesh", "held", "at"], home);
    let mesh = match reader.get(&fields, "mesh") {
        Some(field) => mesh(reader, &field).map(|path| (path, field)),
        None => reader.lacks(&fields, "mesh", "is missing", "the path of an STL, OBJ or 3MF file"),
    };
    let id = match (reader.get(&fields, "id"), &mesh) {
        (Some(field), _) => {
            let id = reader.text(&field, "the name of the part");
            id.and_then(|id| plain_name(reader, &field, id))
        }
        (None, Some((path, field))) => {
            let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
            plain_name(reader, field, &stem)
        }
        (None, None) => None,
    };
    let held = match reader.get(&fields, "held") {
        Some(field) => reader.flag(&field).map(|held| if held { Mobility::Held } else { Mobility::Free }),
        None => Some(Mobility::Free),
    };
    let at = match reader.get(&fields, "at") {
        Some(field) => pose(reader, &field),
        None => Some((DAffine3::IDENTITY, 0.0)),
    };
    let path = reader.file.parent().unwrap_or(Path::new("")).join(mesh?.0);
    let (at, turn) = at?;
    Some(MeshPartSpec { id: id?, mesh: path, held: held?, at, turn })
}

fn mesh<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<PathBuf> {
    let hint = "the path of an STL, OBJ or 3MF file, relative to this one";
    let text = reader.text(field, hint)?;
    if text.contains('\\') && !cfg!(windows) {
        reader.fault(
            field,
            format!("{} has a backslash", quoted(text)),
            "write paths with /, as in \"parts/key.stl\"",
        );
        return None;
    }
    let path = Path::new(text);
    let end = path.extension().map(|end| end.to_string_lossy().to_lowercase());
    if end.is_some_and(|end| ["stl", "obj", "3mf"].contains(&end.as_str())) {
        return Some(path.to_path_buf());
    }
    reader.fault(field, format!("{} is no mesh by its name", quoted(&path.to_string_lossy())), hint);
    None
}

/// The pose, and by how much it may be turned from the one that was meant.
fn pose<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<(DAffine3, f64)> {
    let hint = "twelve numbers, row by row: each row of the rotation, then its part of the translation";
    let items = reader.list(field, hint)?;
    if items.len() != 12 {
        reader.fault(field, format!("has {} numbers", items.len()), hint);
        return None;
    }
    let numbers: Vec<_> =
        items.iter().map(|item| reader.number(item, -MAX_LENGTH..=MAX_LENGTH, hint)).collect();
    let m = numbers.into_iter().collect::<Option<Vec<f64>>>()?;
    let rotation = DMat3::from_cols_array(&[m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]]);
    let error = (rotation.transpose() * rotation - DMat3::IDENTITY).to_cols_array();
    if error.iter().any(|e| e.abs() > POSE_ERROR) {
        reader.fault(
            field,
            "scales or shears",
            "a pose is a rotation and a translation; give six decimals or more",
        );
        return None;
    }
    if rotation.determinant() < 0.0 {
        reader.fault(
            field,
            "mirrors",
            "a part cannot be turned into its mirror image: mirror the mesh instead",
        );
        return None;
    }
    let pose = DAffine3::from_mat3_translation(nearest_rotation(rotation), DVec3::new(m[3], m[7], m[11]));
    Some((pose, turn(rotation)))
}

/// By how much a rotation written in decimals may be turned, in radians: each of nine entries is off by half a unit in
/// the last place, by Frobenius' norm three of them. One that is a rotation to the last bit is meant as it is.
fn turn(rotation: DMat3) -> f64 {
    let finest =
        rotation.to_cols_array().iter().map(|x| format!("{x}")).map(|s| decimals(&s)).max().unwrap_or(0);
    let exact = rotation.transpose() * rotation == DMat3::IDENTITY;
    if exact { 0.0 } else { 1.5 * 10f64.powi(-finest) }
}

fn decimals(numeral: &str) -> i32 {
    numeral.split_once('.').map_or(0, |(_, d)| d.len() as i32)
}

/// The rotation nearest to a matrix within [`POSE_ERROR`] of one. Each step of Newton's iteration for the polar factor
/// squares the error (times 3/4): two bring it below round-off, and exact rotations stay as they are.
fn nearest_rotation(matrix: DMat3) -> DMat3 {
    let step = |m: DMat3| m * (DMat3::IDENTITY * 3.0 - m.transpose() * m) * 0.5;
    step(step(matrix))
}

fn tolerance<'t>(reader: &mut Reader<'t>, root: &Fields<'t>) -> Option<f64> {
    let Some(field) = reader.get(root, "contact") else { return Some(DEFAULT_TOLERANCE_MM) };
    let fields = reader.table(&field)?;
    reader.only(&fields, &["tolerance"], home);
    let why = "the distance within which two faces touch";
    match reader.get(&fields, "tolerance") {
        Some(field) => reader.length(&field, (Excluded(0.0), Included(MAX_LENGTH)), why),
        None => Some(DEFAULT_TOLERANCE_MM),
    }
}

/// Millimetres in the unit of the mesh files; they are taken as millimetres where nothing is said.
fn unit<'t>(reader: &mut Reader<'t>, root: &Fields<'t>) -> Option<f64> {
    let Some(field) = reader.get(root, "size") else { return Some(1.0) };
    let fields = reader.table(&field)?;
    reader.only(&fields, &["unit"], home);
    let Some(field) = reader.get(&fields, "unit") else { return Some(1.0) };
    let names: Vec<(&str, f64)> =
        ["mm", "cm", "m", "in"].into_iter().filter_map(|u| Some((u, units::unit(u)?))).collect();
    reader.choice(&field, &names)
}
