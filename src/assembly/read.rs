//! Takes a mesh spec; gives its assembly, one solid for each file, or the faults of all files at once.
//!
//! Not promised: that parts touch or keep apart; `contact` finds out.

use super::mesh::{MeshFault, Reading, read_mesh};
use super::{Assembly, Part, voxel};
use crate::fault::{Fault, Faults};
use crate::solid::Solid;
use crate::spec::puzzle::Puzzle;
use crate::spec::{MeshPartSpec, MeshSpec, Spec};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;

/// What was read.
pub struct Read {
    pub assembly: Assembly,
    /// By how much each coordinate of each part may be off in its file, in model units.
    pub resolution: Vec<f64>,
    /// What was taken in good faith, in words.
    pub remarks: Vec<String>,
}

/// The assembly that a spec names.
///
/// # Errors
/// All faults of all files.
pub fn assembly(spec: &Spec, meshes: &MeshSpec) -> Result<Read, Faults> {
    if let Some(puzzle) = &meshes.puzzle {
        return of_puzzle(spec, puzzle, meshes.mm_per_unit);
    }
    let reading =
        Reading { mm_per_unit: meshes.mm_per_unit, tolerance: meshes.tolerance_mm / meshes.mm_per_unit };
    let mut first: BTreeMap<&Path, usize> = BTreeMap::new();
    for part in &meshes.parts {
        let next = first.len();
        first.entry(&part.mesh).or_insert(next);
    }
    let mut files: Vec<(&Path, usize)> = first.iter().map(|(p, k)| (*p, *k)).collect();
    files.sort_by_key(|f| f.1);
    let read: Vec<_> = files.par_iter().map(|(path, _)| read_mesh(path, reading)).collect();
    let (mut solids, mut known) = (Vec::<Solid>::new(), Vec::new());
    let (mut faults, mut remarks) = (Vec::new(), Vec::new());
    for ((path, _), mesh) in files.iter().zip(read) {
        match mesh {
            Ok(mesh) => {
                remarks.extend(mesh.remarks.iter().map(|r| format!("{}: {r}", path.display())));
                known.push(mesh.resolution);
                solids.push(mesh.solid);
            }
            Err(bad) => faults.extend(bad.0.into_iter().map(|f| fault(spec, meshes, f))),
        }
    }
    Faults(faults).or(())?;
    let part = |p: &MeshPartSpec| Part {
        id: p.id.clone(),
        solid: first[p.mesh.as_path()],
        pose: p.at,
        mobility: p.held,
    };
    let parts: Vec<Part> = meshes.parts.iter().map(part).collect();
    let resolution = parts.iter().map(|p| known[p.solid]).collect();
    let assembly = Assembly { name: spec.name.clone(), solids, parts, mm_per_unit: meshes.mm_per_unit };
    Ok(Read { assembly, resolution, remarks })
}

/// The assembly of a puzzle's solution; its corners are whole numbers.
fn of_puzzle(spec: &Spec, puzzle: &Puzzle, mm_per_unit: f64) -> Result<Read, Faults> {
    let fault = |what: String, hint: &str| Fault { key: String::new(), ..spec.fault("", what, hint) };
    let Some(solution) = &puzzle.solution else {
        let what = "the file states no solution, so it is not known where the pieces lie".to_string();
        return Err(fault(what, "save it with a solution").into());
    };
    let misfits = |wrong: Vec<voxel::Misfit>| {
        let hint = "solution and shapes do not belong together: solve the puzzle again";
        Faults(wrong.iter().map(|m| fault(m.to_string(), hint)).collect())
    };
    let assembly = voxel::assembly(&spec.name, puzzle, solution, mm_per_unit).map_err(misfits)?;
    let resolution = vec![0.0; assembly.parts.len()];
    Ok(Read { assembly, resolution, remarks: Vec::new() })
}

/// A mesh's fault, with the line of the spec that named the file.
fn fault(spec: &Spec, meshes: &MeshSpec, fault: MeshFault) -> Fault {
    let k = meshes.parts.iter().position(|p| p.mesh == fault.file).unwrap_or(0);
    let what = format!("{}: {}{}", fault.file.display(), fault.place, fault.what);
    spec.fault(&format!("part[{k}].mesh"), what, fault.hint)
}
