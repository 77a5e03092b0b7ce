//! Takes what a spec says of an assembly of meshes, reads the files, gives the assembly.
//!
//! Each file is read once, however many parts it makes. Not promised: that the parts touch or keep clear of each other;
//! `contact` tells.

use super::{Mesh, MeshFault, MeshFaults, Reading, read_mesh};
use crate::assembly::{Assembly, Part};
use crate::spec::MeshSpec;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Parts in place, and what their files were like.
#[derive(Clone, Debug)]
pub struct MeshAssembly {
    pub assembly: Assembly,
    /// The user's contact tolerance, in model units.
    pub tolerance: f64,
    /// What was taken in good faith, with the file that it is about.
    pub remarks: Vec<(PathBuf, String)>,
}

/// Reads all mesh files of a spec.
///
/// # Errors
/// All faults of all files, in the order of the parts.
pub fn assemble(name: &str, spec: &MeshSpec) -> Result<MeshAssembly, MeshFaults> {
    let tolerance = spec.tolerance_mm / spec.mm_per_unit;
    let reading = Reading { mm_per_unit: spec.mm_per_unit, tolerance };
    let mut index: BTreeMap<&PathBuf, usize> = BTreeMap::new();
    let (mut meshes, mut faults): (Vec<Mesh>, Vec<MeshFault>) = (Vec::new(), Vec::new());
    let (mut remarks, mut parts) = (Vec::new(), Vec::new());
    for part in &spec.parts {
        let solid = *index.entry(&part.mesh).or_insert_with(|| {
            match read_mesh(&part.mesh, reading) {
                Ok(mesh) => {
                    remarks.extend(mesh.remarks.iter().map(|r| (part.mesh.clone(), r.clone())));
                    meshes.push(mesh);
                }
                Err(all) => faults.extend(all.0),
            }
            meshes.len().saturating_sub(1)
        });
        parts.push(Part { id: part.id.clone(), solid, pose: part.at, mobility: part.held });
    }
    if !faults.is_empty() {
        return Err(MeshFaults(faults));
    }
    let solids = meshes.into_iter().map(|m| m.solid).collect();
    let assembly = Assembly { name: name.to_owned(), solids, parts, mm_per_unit: spec.mm_per_unit };
    Ok(MeshAssembly { assembly, tolerance, remarks })
}
