//! Takes a job, a recipe and an order; gives a folder that a fabricator can use as it is: parts, plates, assembly, coupon,
//! sheets in the order of the work, what was checked, pictures.
//!
//! The folder appears whole or not at all. Not promised: that the sheets replace the data sheet of a product; every figure
//! on them has its source and grade.

pub mod bill;
pub mod folder;
pub mod laying;
mod molds;
pub mod plate;
mod poured;
mod prints;
mod sheets;
mod verdicts;

pub use folder::Replace;
pub use molds::MoldSheet;

use crate::check::Check;
use crate::coupon::Coupon;
use crate::make::{self, FabError, Output, Recipe};
use crate::mesh::Mesh;
use crate::report::{Finding, Report};
use crate::shape::Job;
use bill::Bill;
use folder::Folder;
use glam::DVec3;
use laying::Laying;
use plate::Stand;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// The file that lists a package.
pub const LIST: &str = "package.json";

/// A file of a package: its name below the folder, and its bytes.
#[derive(Clone, Debug, PartialEq)]
pub struct Attachment {
    pub name: String,
    pub bytes: Vec<u8>,
}

/// A plate's file, its bed in mm, and what stands on it.
pub struct ShownPlate {
    pub file: String,
    pub bed: [f64; 3],
    pub stands: Vec<(String, Mesh)>,
}

/// What pictures are made of.
pub struct Shown<'a> {
    pub name: &'a str,
    /// Parts at finished size, in place.
    pub parts: Vec<(String, Mesh)>,
    pub plates: Vec<ShownPlate>,
    pub coupon: Vec<(String, Mesh)>,
}

/// Draws pictures; what is wrong, in words.
pub type Draw<'a> = dyn Fn(&Shown) -> Result<Vec<Attachment>, String> + 'a;

/// How a package is wanted.
pub struct Order<'a> {
    pub replace: Replace,
    pub draw: &'a Draw<'a>,
}

/// A plate as written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlateReport {
    pub file: String,
    pub process: String,
    pub bed: String,
    pub bed_mm: [f64; 3],
    pub stands: Vec<Stand>,
    /// Filament by the slicer; `None` where it was not run.
    pub grams: Option<f64>,
    pub checks: Vec<Check>,
    #[serde(skip)]
    pub(crate) shown: Vec<(String, Mesh)>,
}

/// The assembly as one object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AssemblyReport {
    pub file: String,
    /// 1: finished size; else K of the one route that all parts share, for a print in one piece.
    pub scale: f64,
    pub components: usize,
    pub checks: Vec<Check>,
}

/// How a part lies on its plate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayingReport {
    pub part: String,
    #[serde(flatten)]
    pub laying: Laying,
}

/// The coupon of a process.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CouponReport {
    pub process: String,
    #[serde(flatten)]
    pub coupon: Coupon,
}

/// The answer of a package: the report on the parts, and what came with it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PackageReport {
    #[serde(flatten)]
    pub report: Report,
    pub bill: Bill,
    pub layings: Vec<LayingReport>,
    pub plates: Vec<PlateReport>,
    pub assembly: Option<AssemblyReport>,
    pub coupons: Vec<CouponReport>,
    pub mold_sheets: Vec<MoldSheet>,
    /// Every file of the package but this list, sorted.
    pub files: Vec<String>,
}

/// Makes the package; file names in the report are below the folder.
pub fn pack(job: &Job, recipe: &Recipe, order: &Order, out: &Path) -> Result<PackageReport, FabError> {
    let folder = Folder::new(out, order.replace, LIST)?;
    let mut output = make::output(job, recipe, &folder.path().join("parts"))?;
    relative(&mut output.report, folder.path());
    let mut package = filled(&output, &folder)?;
    molds::molds(job, &output, &mut package, &folder, recipe)?;
    verdicts::ask(&mut package, recipe, folder.path());
    verdicts::collect(&mut package);
    for file in pictures(&mut package, &output, order) {
        folder.write(&file.name, &file.bytes)?;
    }
    sheets::write(&package, &folder)?;
    package.files = folder.names()?;
    folder.write(LIST, json(&package).as_bytes())?;
    folder.commit(&stale(out))?;
    Ok(package)
}

/// The answer as the list holds it.
fn json(package: &PackageReport) -> String {
    serde_json::to_string_pretty(package).unwrap_or_default() + "\n"
}

fn relative(report: &mut Report, folder: &Path) {
    let below = |file: &mut Option<String>| {
        let inside = file.as_deref().and_then(|f| Path::new(f).strip_prefix(folder).ok());
        if let Some(name) = inside.map(|p| p.display().to_string()) {
            *file = Some(name);
        }
    };
    for part in &mut report.parts {
        below(&mut part.file);
        below(&mut part.obj);
    }
}

fn filled(output: &Output, folder: &Folder) -> Result<PackageReport, FabError> {
    let mut package = PackageReport {
        report: output.report.clone(),
        bill: bill::bill(&output.report),
        layings: prints::layings(output),
        plates: vec![],
        assembly: None,
        coupons: vec![],
        mold_sheets: vec![],
        files: vec![],
    };
    let mut files = prints::parts(output, &mut package);
    files.extend(prints::plates(output, &mut package));
    files.extend(prints::assembly(output, &mut package));
    files.extend(prints::coupons(&mut package));
    for file in files {
        folder.write(&file.name, &file.bytes)?;
    }
    Ok(package)
}

fn pictures(package: &mut PackageReport, output: &Output, order: &Order) -> Vec<Attachment> {
    let plates = package
        .plates
        .iter()
        .map(|p| ShownPlate { file: p.file.clone(), bed: p.bed_mm, stands: p.shown.clone() })
        .collect();
    let coupon = package.coupons.first().map_or(vec![], |c| {
        vec![("gauge".to_string(), c.coupon.gauge.clone()), ("key".to_string(), c.coupon.key.clone())]
    });
    let shown = Shown { name: &package.report.name, parts: prints::finished(output), plates, coupon };
    match (order.draw)(&shown) {
        Ok(files) => files,
        Err(why) => {
            package
                .report
                .findings
                .push(Finding::note(format!("no pictures: {why}"), "the files are whole without them"));
            vec![]
        }
    }
}

/// The files that an earlier package in the same folder lists.
fn stale(out: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(out.join(LIST)).unwrap_or_default();
    let old: Option<BTreeMap<String, serde_json::Value>> = serde_json::from_str(&text).ok();
    let files = old.and_then(|o| o.get("files").and_then(|f| f.as_array().cloned())).unwrap_or_default();
    let inside =
        |name: &str| Path::new(name).components().all(|c| matches!(c, std::path::Component::Normal(_)));
    files.iter().filter_map(|f| f.as_str()).filter(|f| inside(f)).map(String::from).collect()
}

/// Lowest corner of a mesh.
pub(crate) fn low(mesh: &Mesh) -> DVec3 {
    mesh.bounds().0
}
