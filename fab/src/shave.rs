//! Takes a part as it is to be printed, how it lies, and what is wanted of its print face; gives the part with a slice cut
//! off below and a chamfer around what then lies on the bed.
//!
//! The chamfer leaves 45 degrees: as wide as it is high. Not promised: that a fit which reaches down to the print face is
//! as tight there as elsewhere; both only take away.

use crate::files::stl;
use crate::mesh::Mesh;
use crate::mold::fill::prism;
use crate::package::laying::Laying;
use crate::solid::{NotSolid, Solid, cuboid};
use glam::DVec3;
use std::collections::BTreeSet;

/// What is taken off, mm; 0 is off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaving {
    /// Cut off below.
    pub flatten: f64,
    /// Width and height of the chamfer against the elephant's foot.
    pub chamfer: f64,
}

/// Why a part could not be shaved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotShaved {
    #[error(transparent)]
    Solid(#[from] NotSolid),
    #[error("there is no flat face on the bed to put a chamfer around")]
    NoFace,
    #[error("what is left can not be written in f32")]
    Unwritable,
}

impl Shaving {
    pub fn is_off(&self) -> bool {
        self.flatten <= 0.0 && self.chamfer <= 0.0
    }
}

/// How far tools reach beyond the part, mm: enough that no face of a tool lies in a face of the part.
const BEYOND: f64 = 1.0;

/// A point that is off the print face by no more than this lies in it, mm: far above what turning and f32 do to a metre,
/// far below a layer.
const IN_FACE: f64 = 1e-3;

/// The part shaved, in its own frame again, as f32 can hold it.
pub fn shaved(part: &Mesh, laying: &Laying, what: Shaving) -> Result<Mesh, NotShaved> {
    let turned = part.map(|v| laying.turn * v);
    let (low, high) = turned.bounds();
    let mut solid = Solid::of(&turned)?;
    let bed = low.z + what.flatten.max(0.0);
    if what.flatten > 0.0 {
        let keep = cuboid(low.with_z(bed) - DVec3::new(BEYOND, BEYOND, 0.0), high + DVec3::splat(BEYOND));
        solid = solid.common(&Solid::of(&keep)?);
    }
    if what.chamfer > 0.0 {
        let tools = tools(&solid.mesh(), bed, what.chamfer)?;
        solid = solid.minus(&Solid::all(tools));
    }
    let back = laying.turn.inverse();
    // Turned before it is rounded: rounding a settled mesh again can make it cross itself.
    let turned = Solid::of(&solid.mesh().map(|v| back * v))?;
    let (mesh, _) = stl::settled(&turned).ok_or(NotShaved::Unwritable)?;
    Ok(mesh)
}

/// A wedge along each edge of the print face.
fn tools(mesh: &Mesh, bed: f64, wide: f64) -> Result<Vec<Solid>, NotShaved> {
    let in_face = |t: &[u32; 3]| t.iter().all(|&v| (mesh.vertices[v as usize].z - bed).abs() < IN_FACE);
    let sides = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    let face: BTreeSet<(u32, u32)> = mesh.triangles.iter().filter(|t| in_face(t)).flat_map(sides).collect();
    let rim: Vec<(u32, u32)> = face.iter().filter(|(a, b)| !face.contains(&(*b, *a))).copied().collect();
    if rim.is_empty() {
        return Err(NotShaved::NoFace);
    }
    let at = |v: u32| mesh.vertices[v as usize];
    rim.iter().filter_map(|&(a, b)| wedge(at(a), at(b), wide)).map(|w| Ok(Solid::of(&w)?)).collect()
}

/// The room outside a chamfer, a little longer than its edge, so that wedges meet at corners. The face is seen from
/// below: it lies on the right of its edges, and what is outside on the left.
fn wedge(a: DVec3, b: DVec3, wide: f64) -> Option<Mesh> {
    let along = (b - a).with_z(0.0).try_normalize()?;
    let out = DVec3::Z.cross(along);
    let (a, b) = (a - along * wide, b + along * wide);
    // From the face's inside up at 45 degrees to twice the width outside, and down below the bed.
    let section = |p: DVec3| {
        vec![p - out * wide, p + out * wide - DVec3::Z * wide, p + out * wide + DVec3::Z * 2.0 * wide]
    };
    let body = prism(section(a), section(b));
    let volume = body.volume();
    match volume {
        v if v > 0.0 => Some(body),
        v if v < 0.0 => {
            Some(Mesh { triangles: body.triangles.iter().map(|t| [t[0], t[2], t[1]]).collect(), ..body })
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::tests::cuboid;
    use crate::mesh::{Closure, Topology};
    use crate::package::laying::lay;

    #[test]
    fn a_box_loses_a_slice_and_the_chamfer_of_its_four_edges() {
        let part = cuboid(DVec3::ZERO, DVec3::new(30.0, 20.0, 10.0));
        let what = Shaving { flatten: 1.0, chamfer: 0.5 };
        let mesh = shaved(&part, &lay(&part), what).unwrap();
        // Four prisms under a roof: the sum of the edges, less what the corners share.
        let rim = 0.5 * 0.5 / 2.0 * 2.0 * (30.0 + 20.0) - 4.0 * 0.5_f64.powi(3) / 3.0;
        assert!((mesh.volume() - (30.0 * 20.0 * 9.0 - rim)).abs() < 1e-3, "{}", mesh.volume());
        assert_eq!((mesh.closure(), mesh.topology()), (Closure::Closed, Topology { bodies: 1, genus: 0 }));
        assert_eq!(mesh.bounds(), (DVec3::new(0.0, 0.0, 1.0), DVec3::new(30.0, 20.0, 10.0)));
    }
}
