//! Takes an assembly; gives the isometries that carry it to itself, each as it moves the parts.
//!
//! Sound up to the distance within which vertices are matched: each part's boundary vertices meet those of its image,
//! and held parts go to held parts. Not complete: where the parts' centres lie on one line with their mean, none but the
//! identity is found. A symmetry that is missed makes orbits smaller, no answer wrong.

use crate::assembly::{Assembly, PartIx};
use glam::{DAffine3, DMat3, DVec3};
use std::collections::{BTreeSet, HashMap};

/// An isometry and where it takes each part.
#[derive(Clone, Debug)]
pub struct Symmetry {
    pub map: DAffine3,
    /// Image of each part, by number.
    pub to: Vec<usize>,
}

/// All that were found, the identity first. `within`: distance at which two vertices count as one, model units.
pub fn symmetries(asm: &Assembly, within: f64) -> Vec<Symmetry> {
    let parts: Vec<Part> = asm.ids().map(|p| Part::new(asm, p, within)).collect();
    let mut found = vec![Symmetry { map: DAffine3::IDENTITY, to: (0..parts.len()).collect() }];
    for map in candidates(&parts, within) {
        let images: Option<Vec<usize>> = parts.iter().map(|p| image(p, &parts, &map, within)).collect();
        let Some(to) = images else { continue };
        let onto = to.iter().collect::<BTreeSet<_>>().len() == parts.len();
        if onto && found.iter().all(|f| f.to != to || !same(&f.map, &map)) {
            found.push(Symmetry { map, to });
        }
    }
    found
}

fn same(a: &DAffine3, b: &DAffine3) -> bool {
    (a.matrix3.determinant() > 0.0) == (b.matrix3.determinant() > 0.0)
}

/// A part as its boundary vertices, found by place.
struct Part {
    points: Vec<DVec3>,
    centre: DVec3,
    mobility: crate::assembly::Mobility,
    width: f64,
    boxes: HashMap<[i64; 3], Vec<u32>>,
}

impl Part {
    fn new(asm: &Assembly, p: PartIx, within: f64) -> Part {
        let (solid, pose) = (asm.solid(p), asm.part(p).pose);
        let corners: BTreeSet<u32> = solid.facets.iter().flat_map(|f| f.corners.iter().copied()).collect();
        let points: Vec<DVec3> =
            corners.iter().map(|&k| pose.transform_point3(solid.vertices[k as usize])).collect();
        let centre = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let width = 4.0 * within;
        let mut part = Part { centre, mobility: asm.part(p).mobility, width, boxes: HashMap::new(), points };
        for (k, &q) in part.points.iter().enumerate() {
            let cube = part.cube(q);
            part.boxes.entry(cube).or_default().push(k as u32);
        }
        part
    }

    fn cube(&self, p: DVec3) -> [i64; 3] {
        (p / self.width).to_array().map(|c| c.floor() as i64)
    }

    fn has(&self, p: DVec3, within: f64) -> bool {
        let (lo, hi) = (self.cube(p - within), self.cube(p + within));
        let mut cubes = (lo[0]..=hi[0])
            .flat_map(|x| (lo[1]..=hi[1]).flat_map(move |y| (lo[2]..=hi[2]).map(move |z| [x, y, z])));
        cubes.any(|c| {
            self.boxes
                .get(&c)
                .is_some_and(|l| l.iter().any(|&k| self.points[k as usize].distance(p) <= within))
        })
    }
}

/// The part that the map takes this one to.
fn image(part: &Part, all: &[Part], map: &DAffine3, within: f64) -> Option<usize> {
    let centre = map.transform_point3(part.centre);
    all.iter().position(|q| {
        q.centre.distance(centre) <= within
            && q.mobility == part.mobility
            && q.points.len() == part.points.len()
            && part.points.iter().all(|&x| q.has(map.transform_point3(x), within))
    })
}

/// Isometries about the mean of the parts' centres that carry two chosen centres to two of the same distances.
fn candidates(parts: &[Part], within: f64) -> Vec<DAffine3> {
    let middle = parts.iter().map(|p| p.centre).sum::<DVec3>() / parts.len().max(1) as f64;
    let at: Vec<DVec3> = parts.iter().map(|p| p.centre - middle).collect();
    let far =
        |lever: &dyn Fn(DVec3) -> f64| (0..at.len()).max_by(|&i, &j| lever(at[i]).total_cmp(&lever(at[j])));
    let Some(p) = far(&|v| v.length()) else { return Vec::new() };
    // Two centres nearer to one line than this do not fix a frame: the map would be known to no better than a tenth.
    let least = 10.0 * within;
    let off = |v: DVec3| if at[p].length() > least { v.reject_from(at[p]).length() } else { 0.0 };
    let Some(q) = far(&off).filter(|&q| off(at[q]) > least) else { return Vec::new() };
    let alike = |a: usize, b: usize| {
        parts[a].points.len() == parts[b].points.len() && (at[a].length() - at[b].length()).abs() <= within
    };
    let own = frame(at[p], at[q]);
    let mut maps = Vec::new();
    for p2 in (0..at.len()).filter(|&k| alike(p, k)) {
        for q2 in (0..at.len()).filter(|&k| alike(q, k)) {
            if (at[p2].distance(at[q2]) - at[p].distance(at[q])).abs() > 2.0 * within {
                continue;
            }
            for side in [1.0, -1.0] {
                let turn = frame(at[p2], at[q2])
                    * DMat3::from_diagonal(DVec3::new(1.0, 1.0, side))
                    * own.transpose();
                maps.push(DAffine3::from_mat3_translation(turn, middle - turn * middle));
            }
        }
    }
    maps
}

/// Right-handed orthonormal axes: along p, then in the plane of p and q.
fn frame(p: DVec3, q: DVec3) -> DMat3 {
    let x = p.normalize();
    let y = (q - x * x.dot(q)).normalize();
    DMat3::from_cols(x, y, x.cross(y))
}
