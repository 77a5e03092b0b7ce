//! Takes a job, a recipe and a folder; gives files and the report on them.
//!
//! Promised: a file that is there was read back, closed, of one body, free of crossings, and its gaps were measured at
//! finished size, each part by its own route; what failed one of these is not written and has a finding. Not promised:
//! that a process can make every detail; thin walls and sharp edges are told, not mended.

use crate::bvh::Bvh;
use crate::check::Programs;
use crate::congruent;
use crate::cross;
use crate::external;
use crate::files::{Batch, FileError, obj, stl};
use crate::findings;
use crate::gap::{self, Gap, Made, Promise, Verdict};
use crate::ledger::Scale;
use crate::mesh::Mesh;
use crate::mold::fins::{self, Fins};
use crate::offset::Offset;
use crate::package::laying::Laying;
use crate::pieces::pieces;
use crate::pinch;
use crate::process::Process;
use crate::report::{Finding, PartReport, ReadBack, Report, RouteReport};
use crate::shape::{Fault, Job, Role};
use crate::wall;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// How a job is to be made.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// What makes every part that is not named below.
    pub process: Process,
    /// Parts made otherwise, by id.
    pub parts: BTreeMap<String, Process>,
    /// The point that scaling leaves where it is, mm.
    pub datum: DVec3,
    /// OBJ beside STL.
    pub obj: bool,
    /// Programs of others to check with; `None` checks with none.
    pub programs: Option<Programs>,
    /// What forms the cavity of a mold.
    pub cavity: Cavity,
    /// Castings of a shape at once in a rigid or silicone mold; at least 1.
    pub gang: usize,
}

/// What forms the cavity of a mold.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Cavity {
    /// The part itself, with its clearance.
    #[default]
    Part,
    /// The hollow that the solids around it leave (paper, 4.3): it reaches up to them, so the casting has no clearance.
    /// They are the other parts of the job, and these: in place, in mm, as they touch. Where there are any of these, all
    /// together fill space, and the hollow is the part as it touches.
    Surroundings(Vec<Mesh>),
}

impl Recipe {
    /// The process, scaled about the assembly's origin, both formats, all checkers.
    pub fn new(process: Process) -> Recipe {
        Recipe {
            process,
            parts: BTreeMap::new(),
            datum: DVec3::ZERO,
            obj: true,
            programs: Some(Programs::default()),
            cavity: Cavity::default(),
            gang: 1,
        }
    }

    pub fn process_of(&self, id: &str) -> &Process {
        self.parts.get(id).unwrap_or(&self.process)
    }

    /// Ids that no part of the job has.
    fn faults(&self, job: &Job) -> Vec<Fault> {
        let known: BTreeSet<&str> = job.parts.iter().map(|p| p.id.as_str()).collect();
        let fault = |id: &String| Fault {
            place: "fab.parts".into(),
            what: format!(
                "names a process for \"{id}\", which is no part (hint: parts are {})",
                some(&known)
            ),
        };
        let strangers = self.parts.keys().filter(|id| !known.contains(id.as_str())).map(fault);
        strangers.chain(self.namesakes()).collect()
    }

    /// Processes that differ and are called the same: sheets, plates and coupons go by the name.
    fn namesakes(&self) -> Vec<Fault> {
        let all: Vec<&Process> = std::iter::once(&self.process).chain(self.parts.values()).collect();
        let other = |k: usize| all[..k].iter().any(|q| q.name == all[k].name && *q != all[k]);
        let names: BTreeSet<&str> = (0..all.len()).filter(|&k| other(k)).map(|k| &all[k].name[..]).collect();
        let fault = |name: &str| Fault {
            place: "fab.process".into(),
            what: format!(
                "two processes that differ are called \"{name}\" (hint: give the copied file a name of its own, in its line name = ...)"
            ),
        };
        names.into_iter().map(fault).collect()
    }
}

/// Ids that a message names.
const NAMED: usize = 12;

fn some(ids: &BTreeSet<&str>) -> String {
    let named = ids.iter().take(NAMED).copied().collect::<Vec<_>>().join(", ");
    if ids.len() > NAMED { format!("{named} and {} more", ids.len() - NAMED) } else { named }
}

#[derive(Debug, thiserror::Error)]
pub enum FabError {
    #[error("{}", .0.iter().map(Fault::to_string).collect::<Vec<_>>().join("\n"))]
    Job(Vec<Fault>),
    #[error(transparent)]
    File(#[from] FileError),
    /// The file of figures that the program carries.
    #[error("{0}")]
    Figures(String),
}

/// How much deeper than promised faces go, in snap distances: one for the snap itself, one so that `relief` has
/// something to stop at.
pub(crate) const MARGIN_IN_SNAPS: f64 = 2.0;

/// How often a pair's distance can be off by one snap distance: the margins of both faces and their snaps.
const PAIR_IN_SNAPS: f64 = 2.0 * (MARGIN_IN_SNAPS + 1.0);

/// A part on its way to the file.
pub(crate) struct Piece {
    pub id: String,
    /// Of its file names.
    pub stem: String,
    pub scale: Scale,
    pub offset: Offset,
    /// How it lies on the bed, where its print face was shaved.
    pub laid: Option<Laying>,
    /// On the master, as f32 can hold it.
    pub master: Mesh,
    /// What was read back, at finished size; `None` where the part is not to be written.
    pub made: Option<Made>,
    /// What keeps it from being written, and what does not.
    pub faults: Vec<Finding>,
    pub notes: Vec<Finding>,
}

/// What was made: the report, and the meshes on the master in the order of the parts (`None`: not written).
pub struct Output {
    pub report: Report,
    pub masters: Vec<Option<Mesh>>,
    /// How parts lie whose print face was shaved; `None` where nothing was.
    pub laid: Vec<Option<Laying>>,
}

/// Makes everything: offsets, files, measurements, findings.
pub fn make(job: &Job, recipe: &Recipe, folder: &Path) -> Result<Report, FabError> {
    Ok(output(job, recipe, folder)?.report)
}

/// The same, with the meshes.
pub fn output(job: &Job, recipe: &Recipe, folder: &Path) -> Result<Output, FabError> {
    let job = &Job { shapes: job.shapes.iter().map(pinch::parted).collect(), ..job.clone() };
    let faults = [job.faults(), recipe.faults(job)].concat();
    if !faults.is_empty() {
        return Err(FabError::Job(faults));
    }
    let scales: Vec<Scale> =
        job.parts.iter().map(|p| Scale::of(recipe.process_of(&p.id), recipe.datum)).collect();
    let snap = snap_finished(job, &scales);
    // Parts that no file can tell apart are one solid; what this shifts a face by, `relief` makes up for.
    let job = &congruent::united(&job.planar(), snap);
    let mut pieces = pieces(job, recipe, snap, scales);
    let mut batch = Batch::new(folder)?;
    for piece in &mut pieces {
        write(piece, recipe, &mut batch)?;
    }
    let gaps = measure(job, recipe, snap, &mut pieces);
    for piece in pieces.iter().filter(|p| p.made.is_none()) {
        file_names(&piece.stem).iter().for_each(|n| batch.discard(n));
    }
    batch.commit()?;
    let mut report = report(job, recipe, &pieces, gaps, folder);
    if let Some(programs) = &recipe.programs {
        external::check_all(&mut report, &pieces, programs);
    }
    findings::collect(&mut report);
    let laid = pieces.iter().map(|p| p.laid).collect();
    let masters = pieces.into_iter().map(|p| p.made.is_some().then_some(p.master)).collect();
    Ok(Output { report, masters, laid })
}

/// How far writing in f32 moves a point of the finished assembly, mm: the worst over all routes.
fn snap_finished(job: &Job, scales: &[Scale]) -> f64 {
    let of_part = |(part, scale): (&crate::shape::PlacedPart, &Scale)| {
        let points = job.shapes[part.shape].vertices.iter();
        let largest = points.map(|&v| scale.up(part.pose.transform_point3(v)).abs().max_element());
        stl::snap_distance(largest.fold(0.0, f64::max)) / scale.factor
    };
    job.parts.iter().zip(scales).map(of_part).fold(0.0, f64::max)
}

/// Gaps of what was read back; a piece that comes too near to another is not to be written.
fn measure(job: &Job, recipe: &Recipe, snap: f64, pieces: &mut [Piece]) -> Vec<Gap> {
    let neighbours = job.neighbours();
    let clearances: Vec<f64> = pieces.iter().map(|p| recipe.process_of(&p.id).clearance.value).collect();
    let promise =
        Promise { clearances: &clearances, round_off: PAIR_IN_SNAPS * snap, neighbours: &neighbours };
    let made: Vec<Option<Made>> = pieces.iter_mut().map(|p| p.made.take()).collect();
    let gaps = gap::gaps(&made, &promise);
    let bad = |g: &&Gap| matches!(g.verdict, Verdict::Short | Verdict::Crossing);
    let spoilt: BTreeSet<&str> = gaps.iter().filter(bad).flat_map(|g| [g.a.as_str(), g.b.as_str()]).collect();
    for (piece, made) in pieces.iter_mut().zip(made) {
        piece.made = made.filter(|m| !spoilt.contains(m.id.as_str()));
    }
    gaps
}

fn report(job: &Job, recipe: &Recipe, pieces: &[Piece], gaps: Vec<Gap>, folder: &Path) -> Report {
    let scale = Scale::of(&recipe.process, recipe.datum);
    Report {
        name: job.name.clone(),
        process: recipe.process.name.clone(),
        clearance: recipe.process.clearance.clone(),
        fit_mm: 2.0 * recipe.process.clearance.value,
        scale: scale.factor,
        scale_range: scale.range,
        datum: scale.datum,
        ledger: scale.ledger,
        routes: routes(job, recipe),
        parts: (0..pieces.len())
            .into_par_iter()
            .map(|p| part_report(job, pieces, p, recipe, folder))
            .collect(),
        gaps,
        pair_checks: vec![],
        molds: vec![],
        molds_note: "a package makes them".into(),
        findings: pieces.iter().flat_map(|p| [&p.faults[..], &p.notes].concat()).collect(),
    }
}

/// The processes in use, each with its scale and the parts that it makes, in the order of their first part.
fn routes(job: &Job, recipe: &Recipe) -> Vec<RouteReport> {
    let mut routes: Vec<RouteReport> = Vec::new();
    for part in &job.parts {
        let process = recipe.process_of(&part.id);
        match routes.iter_mut().find(|r| r.process == *process) {
            Some(route) => route.parts.push(part.id.clone()),
            None => {
                let scale = Scale::of(process, recipe.datum);
                routes.push(RouteReport {
                    process: process.clone(),
                    scale: scale.factor,
                    scale_range: scale.range,
                    ledger: scale.ledger,
                    parts: vec![part.id.clone()],
                });
            }
        }
    }
    routes
}

pub(crate) fn file_names(stem: &str) -> [String; 2] {
    ["stl", "obj"].map(|ending| format!("{stem}.mm.{ending}"))
}

/// Stages the files of a sound piece and reads them back.
fn write(piece: &mut Piece, recipe: &Recipe, batch: &mut Batch) -> Result<(), FileError> {
    if !piece.faults.is_empty() {
        return Ok(());
    }
    let [stl_name, obj_name] = file_names(&piece.stem);
    let path = batch.stage(&stl_name, |out| stl::write(&piece.master, out))?;
    let mesh = reread(&path, |p| stl::read(&mut std::fs::File::open(p)?))?;
    if recipe.obj {
        let path = batch.stage(&obj_name, |out| obj::write(&piece.master, &piece.id, out))?;
        let back = reread(&path, |p| obj::read(&std::fs::read_to_string(p)?))?;
        piece.faults.extend(findings::of_copy(&piece.id, &obj_name, back == piece.master));
    }
    piece.faults.extend(findings::of_copy(&piece.id, &stl_name, same_solid(&mesh, &piece.master)));
    if piece.faults.is_empty() {
        let mesh = mesh.map(|v| piece.scale.down(v));
        let tree = Bvh::new(&mesh);
        piece.made = Some(Made { id: piece.id.clone(), mesh, tree });
    }
    Ok(())
}

fn reread(path: &PathBuf, read: impl FnOnce(&PathBuf) -> std::io::Result<Mesh>) -> Result<Mesh, FileError> {
    read(path).map_err(|cause| FileError { action: "read back", path: path.clone(), cause })
}

/// Whether what was read back is what was written: coordinates are f32 on both sides, so it is the same or it is wrong.
fn same_solid(read: &Mesh, written: &Mesh) -> bool {
    let corners = |m: &Mesh| (0..m.triangles.len()).map(|t| m.corners(t)).collect::<Vec<_>>();
    corners(read) == corners(written)
}

fn part_report(job: &Job, pieces: &[Piece], p: usize, recipe: &Recipe, folder: &Path) -> PartReport {
    let (part, piece) = (&job.parts[p], &pieces[p]);
    let process = recipe.process_of(&part.id);
    let shape = &job.shapes[part.shape];
    let (nominal, finished) = (shape.volume(), piece.master.volume() / piece.scale.factor.powi(3));
    let [stl_name, obj_name] = file_names(&piece.stem).map(|name| folder.join(name).display().to_string());
    let same = piece.offset.same_as;
    let slots = piece.made.as_ref().map_or(Fins::NONE, |m| slots(m, process));
    PartReport {
        id: part.id.clone(),
        process: process.name.clone(),
        scale: piece.scale.factor,
        clearance_mm: process.clearance.value,
        file: piece.made.as_ref().map(|_| stl_name),
        obj: piece.made.as_ref().filter(|_| recipe.obj).map(|_| obj_name),
        // One of them may have been shaved and the other not.
        same_as: (same != p && piece.laid.is_some() == pieces[same].laid.is_some())
            .then(|| job.parts[same].id.clone()),
        read_back: piece.made.as_ref().map(|_| ReadBack::of(&piece.master)).unwrap_or_default(),
        expected_volume_mm3: piece.master.volume(),
        nominal_volume_mm3: nominal,
        removed_mm3: nominal - finished,
        clearance_volume_mm3: process.clearance.value * contact_area(job, p),
        mass_g: finished * process.density.value / MM3_IN_CM3,
        longest_move_mm: piece.offset.longest_move,
        wall: piece.made.as_ref().map(|m| wall::measure(&m.mesh, &m.tree, process.least_wall.value)),
        least_wall_mm: process.least_wall.value,
        slot: slots.widest,
        slots_looked_at: slots.looked,
        checks: vec![],
    }
}

/// Slots of a printed shape that are narrower than two faces need to stay apart: fins of air.
fn slots(made: &Made, process: &Process) -> Fins {
    let fit = 2.0 * process.clearance.value;
    let turned = Mesh {
        triangles: made.mesh.triangles.iter().map(|t| [t[0], t[2], t[1]]).collect(),
        vertices: made.mesh.vertices.clone(),
    };
    if process.route.prints_the_shape() { fins::fins(&turned, &made.tree, fit) } else { Fins::NONE }
}

fn contact_area(job: &Job, p: usize) -> f64 {
    let part = &job.parts[p];
    let contact = part.roles.iter().enumerate().filter(|(_, r)| **r != Role::Outer);
    contact.map(|(f, _)| job.shapes[part.shape].facet_area(f)).sum()
}

pub(crate) const MM3_IN_CM3: f64 = 1000.0;

/// Crossings of a mesh with itself, for `findings`.
pub(crate) fn crossings(mesh: &Mesh) -> Result<Vec<cross::Crossing>, cross::Crowded> {
    cross::within(mesh, &Bvh::new(mesh))
}
