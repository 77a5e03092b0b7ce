//! Takes a side core, the room of its shaft, and the part; gives a solid that a file can hold and that, less the part, is the
//! core: what the OpenSCAD source reads instead of the core, to make the core again.
//!
//! A shaft goes through the part, and may touch itself there in lines, which is no solid to other kernels. What a room takes
//! of the part's place does not matter: so the part is added, or that place left but for a margin around the core, or the
//! core itself pressed into it, or a skin wider all around. What comes of it is compared with the core. Not promised: that
//! one of these is a solid.

use crate::cross::encloses;
use crate::files::stl;
use crate::mesh::Mesh;
use crate::mold::cores::{Core, FINE};
use crate::mold::make::Settled;
use crate::solid::Solid;
use glam::DVec3;

/// What the rooms of a mold's cores are made with.
pub struct Place<'a> {
    part: &'a Solid,
    mesh: Mesh,
    /// The part but for a skin, so that it has no wall in common with the part.
    inner: Solid,
    /// How far a core's margin goes into the part, mm.
    margin: f64,
}

impl Place<'_> {
    pub fn new(part: &Solid, margin: f64) -> Place<'_> {
        let (inner, mesh) = (part.narrowed(SKIN), part.mesh());
        Place { part, inner, mesh, margin }
    }

    /// A room for the core as a file can hold it.
    pub fn room(&self, core: &Core) -> Option<(Solid, Settled)> {
        let around =
            || core.solid.with_copies(DVec3::AXES.into_iter().flat_map(|a| [a, -a].map(|a| a * self.margin)));
        let near = || core.shaft.common(&around());
        let ways: [&dyn Fn() -> Solid; 6] = [
            &|| core.shaft.clone(),
            &|| core.shaft.with(&self.inner),
            &near,
            &|| near().with(&self.inner),
            &|| self.pressed(core),
            &|| core.solid.widened(WIDER),
        ];
        ways.into_iter().find_map(|way| self.kept(holding(&way(), core), core))
    }

    /// The core with its walls against the part pressed into it by a skin.
    fn pressed(&self, core: &Core) -> Solid {
        let Some((mesh, _)) = stl::uncrossed_to(&core.solid, DETAIL) else { return Solid::nothing() };
        let mut against: Vec<Vec<DVec3>> = vec![vec![]; mesh.vertices.len()];
        for (t, corners) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.corners(t);
            let out = (b - a).cross(c - a).normalize_or_zero();
            if encloses(&self.mesh, (a + b + c) / 3.0 + out * (FINE / 2.0)) {
                corners.iter().for_each(|&v| against[v as usize].push(out));
            }
        }
        let into = |normals: &Vec<DVec3>| {
            let way = normals.iter().sum::<DVec3>().normalize_or_zero();
            let least = normals.iter().map(|n| n.dot(way)).fold(1.0, f64::min);
            way * SKIN / least.max(STEEP)
        };
        let vertices = mesh.vertices.iter().zip(&against).map(|(v, n)| v + into(n)).collect();
        Solid::of(&Mesh { vertices, ..mesh }).unwrap_or_else(|_| Solid::nothing())
    }

    /// The room, if a file can hold it and it leaves the core.
    fn kept(&self, room: Solid, core: &Core) -> Option<(Solid, Settled)> {
        let (mesh, size) = stl::uncrossed_to(&room, DETAIL)?;
        let left = Solid::of(&mesh).ok()?.minus(self.part).thick(FINE);
        let apart = left.minus(&core.solid).volume() + core.solid.minus(&left).volume();
        (apart <= SAME * core.solid.volume()).then_some((room, Some((mesh, size))))
    }
}

/// The bodies of a room that the core is in, without hollows.
fn holding(room: &Solid, core: &Core) -> Solid {
    let holds = |b: &Solid| b.mesh().volume() > 0.0 && b.common(&core.solid).volume() > CRUMB;
    Solid::all(room.bodies().into_iter().filter(holds).collect())
}

/// What round-off leaves of bodies that only touch is less, mm3: a grain of `FINE`.
const CRUMB: f64 = FINE * FINE * FINE;

/// Cores that differ by less than this share of their volume are the same: half of what two kernels may differ by.
const SAME: f64 = crate::check::openscad::VOLUME_TOLERANCE / 2.0;

/// Detail up to this may be united in a room, mm: the finest layer. What it does to the core is measured.
const DETAIL: f64 = 0.02;

/// Where walls meet in an edge sharper than this (a cosine), it is pressed in less than they are.
const STEEP: f64 = 0.25;

/// Skin of the part, mm: so that every face goes in by 185 steps of the grid, and the source, which moves rooms by 158, does not
/// bring them out again.
const SKIN: f64 = 320.0 * stl::GRID;

/// How much wider a core is taken all around, mm: eighty steps of the grid, as what the source moves aside.
const WIDER: f64 = 80.0 * stl::GRID;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::cuboid;

    fn block(lo: [f64; 3], hi: [f64; 3]) -> Solid {
        Solid::of(&cuboid(lo.into(), hi.into())).unwrap()
    }

    /// A shaft that touches itself in a line within the part: no file holds it, and a room is found that leaves the same core.
    #[test]
    fn a_shaft_that_touches_itself_in_the_part_gets_a_room() {
        let part =
            block([0.0, 0.0, 0.0], [10.0, 10.0, 10.0]).minus(&block([2.0, 2.0, 5.0], [8.0, 8.0, 11.0]));
        let pinched = block([1.0, 1.0, 1.0], [5.0, 9.0, 3.0]).with(&block([5.0, 1.0, 3.0], [9.0, 9.0, 20.0]));
        let shaft = pinched.with(&block([1.0, 1.0, 6.0], [6.0, 9.0, 20.0]));
        assert!(!stl::settled(&pinched).is_some_and(|(m, _)| stl::is_plain(&m)), "it touches itself");
        let solid = shaft.minus(&part).thick(FINE);
        let core = Core { solid: solid.clone(), room: shaft.clone(), shaft, pull: DVec3::Z };
        let (_, settled) = Place::new(&part, 0.2).room(&core).unwrap();
        let (mesh, _) = settled.unwrap();
        assert!(stl::is_plain(&mesh));
        let left = Solid::of(&mesh).unwrap().minus(&part).volume();
        assert!((left - solid.volume()).abs() < SAME * solid.volume(), "{left} of {}", solid.volume());
    }
}
