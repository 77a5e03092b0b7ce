//! Takes a spec; gives the assembly that it describes, with the contact patches between its parts.
//!
//! Between woven tiles contacts are known by identity of sites; between meshes they are searched within the user's
//! tolerance. Not promised: contacts of meshes that lie farther apart than the tolerance, or have no normal.

pub mod chord;
mod curve;
pub mod mesh;
pub mod woven;

use crate::assembly::woven::Woven;
use crate::assembly::{Assembly, PartIx, read};
use crate::fault::Faults;
use crate::spec::{MeshSpec, Spec, Subject};
use glam::DVec3;

/// A planar convex polygon on which part `a` and part `b` touch, in the assembly's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    pub a: PartIx,
    pub b: PartIx,
    /// Unit normal from `a` to `b`.
    pub normal: DVec3,
    pub corners: Vec<DVec3>,
}

/// A place where two convex corners or edges touch and many planes lie between them: no row, but a motion must keep one
/// of the planes. One point, or the two ends of a stretch.
#[derive(Clone, Debug, PartialEq)]
pub struct Loose {
    pub a: PartIx,
    pub b: PartIx,
    pub corners: Vec<DVec3>,
    /// Unit normals from `a` to `b`; those of all the planes are combinations of them.
    pub normals: Vec<DVec3>,
}

/// By how much a contact may be off.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slack {
    /// Of the normal, radians.
    pub angle: f64,
    /// Of the points, model units.
    pub distance: f64,
}

/// Where parts touch, as far as questions about locks go.
#[derive(Clone, Copy)]
pub struct Touching<'a> {
    pub assembly: &'a Assembly,
    pub patches: &'a [Patch],
    /// For each patch; empty: exact.
    pub slack: &'a [Slack],
    pub loose: &'a [Loose],
}

impl<'a> Touching<'a> {
    /// With these contacts and no doubt about them.
    pub fn exactly(assembly: &'a Assembly, patches: &'a [Patch]) -> Touching<'a> {
        Touching { assembly, patches, slack: &[], loose: &[] }
    }
}

impl Joined {
    pub fn touching(&self) -> Touching<'_> {
        Touching { assembly: &self.assembly, patches: &self.patches, slack: &self.slack, loose: &self.loose }
    }
}

/// Parts in place, and where they touch.
pub struct Joined {
    pub assembly: Assembly,
    pub patches: Vec<Patch>,
    /// By how much each patch may be off as far as the files tell; empty where contacts are known by identity.
    pub slack: Vec<Slack>,
    /// Contacts without a unique normal.
    pub loose: Vec<Loose>,
    pub origin: Origin,
    /// What was taken in good faith, in words.
    pub remarks: Vec<String>,
}

/// What the parts were made from.
pub enum Origin {
    Woven(Box<Woven>),
    Meshes,
}

/// Builds the assembly of a spec and finds its contacts.
pub fn join(spec: &Spec) -> Result<Joined, Faults> {
    match &spec.subject {
        Subject::Woven(woven) => {
            let woven = crate::assembly::woven::build(spec, woven)?;
            let patches = woven::patches(&woven);
            let assembly = woven.assembly.clone();
            Ok(Joined {
                assembly,
                patches,
                slack: Vec::new(),
                loose: Vec::new(),
                origin: Origin::Woven(Box::new(woven)),
                remarks: Vec::new(),
            })
        }
        Subject::Meshes(meshes) => join_meshes(spec, meshes),
    }
}

fn join_meshes(spec: &Spec, meshes: &MeshSpec) -> Result<Joined, Faults> {
    let read::Read { assembly, resolution, mut remarks } = read::assembly(spec, meshes)?;
    let tolerance = meshes.tolerance_mm / meshes.mm_per_unit;
    // A puzzle lists no parts from files: its pieces are turned exactly.
    let turns = meshes.parts.iter().map(|p| p.turn).chain(std::iter::repeat(0.0));
    let accuracy: Vec<_> =
        resolution.into_iter().zip(turns).map(|(corner, turn)| mesh::Accuracy { corner, turn }).collect();
    let found = mesh::mesh_patches(&assembly, &accuracy, tolerance).map_err(|overlaps| {
        let fault = |o: &mesh::Overlap| {
            let hint =
                "move the parts apart, or raise [contact] tolerance if the overlap is not meant to count";
            spec.fault(&format!("part[{}]", o.b.at()), o.to_string(), hint)
        };
        Faults(overlaps.0.iter().map(fault).collect())
    })?;
    remarks.extend(unvouched(&found.assumed));
    remarks.extend(found.settled.words());
    let slack =
        found.facts.iter().zip(&found.off).map(|(f, &distance)| Slack { angle: f.known, distance }).collect();
    let loose = found.assumed.into_iter().filter(|a| !a.normals.is_empty());
    let loose = loose.map(|l| Loose { a: l.a, b: l.b, corners: l.corners, normals: l.normals }).collect();
    Ok(Joined { assembly, patches: found.patches, slack, loose, origin: Origin::Meshes, remarks })
}

/// What was assumed of contacts without a unique normal.
fn unvouched(assumed: &[mesh::Assumed]) -> Vec<String> {
    let (many, none): (Vec<_>, Vec<_>) = assumed.iter().partition(|a| !a.normals.is_empty());
    let many = (!many.is_empty()).then(|| {
        format!(
            "{} contacts of convex corners or edges have no unique normal and got no row: locked holds without \
             them, and a free motion keeps to one of their planes each",
            many.len()
        )
    });
    let none = (!none.is_empty()).then(|| {
        let at = none.iter().take(3).map(|a| a.corners[0].to_string()).collect::<Vec<_>>().join(", ");
        format!(
            "{} contacts have no normal of their own and got no row: safe for locked, not for free ({at})",
            none.len()
        )
    });
    many.into_iter().chain(none).collect()
}
