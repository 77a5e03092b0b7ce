//! Assemblies to make: cells with owners over shared vertices, united by dropping the facets between cells of one owner.

use glam::{DAffine3, DVec2, DVec3};
use std::collections::BTreeMap;
use weavelock_fab::shape::{Facet, Job, PlacedPart, Role, Shape};

/// Who owns a cell: a part, or nobody.
pub type Owner = Option<usize>;

/// A convex cell: its facets, counter-clockwise from outside, over the complex's vertices.
pub struct Cell {
    pub owner: Owner,
    pub facets: Vec<Vec<u32>>,
}

/// Cells that share vertices by index; facets that two cells share are the same polygon.
#[derive(Default)]
pub struct Complex {
    pub vertices: Vec<DVec3>,
    pub cells: Vec<Cell>,
}

impl Complex {
    /// Extrudes convex polygons of the plane from z = `low` to `high`.
    pub fn extruded(points: &[DVec2], polygons: &[(Owner, &[u32])], low: f64, high: f64) -> Complex {
        let n = points.len() as u32;
        let at = |z: f64| points.iter().map(move |p| p.extend(z));
        let prism = |&(owner, p): &(Owner, &[u32])| {
            let k = p.len();
            let side = |i: usize| vec![p[i], p[(i + 1) % k], p[(i + 1) % k] + n, p[i] + n];
            let ends = [p.iter().rev().copied().collect(), p.iter().map(|v| v + n).collect()];
            Cell { owner, facets: ends.into_iter().chain((0..k).map(side)).collect() }
        };
        Complex { vertices: at(low).chain(at(high)).collect(), cells: polygons.iter().map(prism).collect() }
    }

    /// Cubes of `size` mm; `owner` of each.
    pub fn voxels(n: [usize; 3], size: f64, owner: impl Fn(usize, usize, usize) -> Owner) -> Complex {
        let id = |x: usize, y: usize, z: usize| ((z * (n[1] + 1) + y) * (n[0] + 1) + x) as u32;
        let mut complex = Complex::default();
        for (z, y, x) in grid([n[0] + 1, n[1] + 1, n[2] + 1]) {
            complex.vertices.push(DVec3::new(x as f64, y as f64, z as f64) * size);
        }
        for (z, y, x) in grid(n) {
            let c = |k: usize| id(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2));
            let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            complex
                .cells
                .push(Cell { owner: owner(x, y, z), facets: quads.map(|q| q.map(c).to_vec()).to_vec() });
        }
        complex
    }

    /// The parts of owners 0.., each with a shape of its own.
    pub fn job(&self, name: &str) -> Job {
        let mut owner_of: BTreeMap<Vec<u32>, Vec<Owner>> = BTreeMap::new();
        for c in &self.cells {
            c.facets.iter().for_each(|f| owner_of.entry(sorted(f)).or_default().push(c.owner));
        }
        let parts = self.cells.iter().filter_map(|c| c.owner).max().map_or(0, |m| m + 1);
        let mut job = Job { name: name.into(), ..Job::default() };
        for part in 0..parts {
            let (shape, roles) = self.part(part, &owner_of);
            let pose = DAffine3::IDENTITY;
            job.parts.push(PlacedPart { id: format!("part-{part}"), shape: job.shapes.len(), pose, roles });
            job.shapes.push(shape);
        }
        job
    }

    fn part(&self, part: usize, owner_of: &BTreeMap<Vec<u32>, Vec<Owner>>) -> (Shape, Vec<Role>) {
        let (mut shape, mut roles, mut index) = (Shape::default(), vec![], BTreeMap::new());
        for cell in self.cells.iter().filter(|c| c.owner == Some(part)) {
            for f in &cell.facets {
                let owners = &owner_of[&sorted(f)];
                let mine = owners.iter().filter(|o| **o == Some(part)).count();
                if mine > 1 {
                    continue;
                }
                let other = owners.iter().flatten().find(|o| **o != part);
                roles.push(other.map_or(Role::Outer, |&with| Role::Contact { with }));
                let corners = f.iter().map(|&v| {
                    *index.entry(v).or_insert_with(|| {
                        shape.vertices.push(self.vertices[v as usize]);
                        shape.vertices.len() as u32 - 1
                    })
                });
                let corners: Vec<u32> = corners.collect();
                let normal = newell(&corners.iter().map(|&c| shape.vertices[c as usize]).collect::<Vec<_>>());
                shape.facets.push(Facet { corners, normal });
            }
        }
        (shape, roles)
    }
}

fn grid(n: [usize; 3]) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..n[2]).flat_map(move |z| (0..n[1]).flat_map(move |y| (0..n[0]).map(move |x| (z, y, x))))
}

fn sorted(f: &[u32]) -> Vec<u32> {
    let mut f = f.to_vec();
    f.sort_unstable();
    f
}

fn newell(p: &[DVec3]) -> DVec3 {
    let turn = |k: usize| (p[k] - p[0]).cross(p[(k + 1) % p.len()] - p[0]);
    (1..p.len()).map(turn).sum::<DVec3>().normalize()
}

/// Two boxes, one on the other: 20 x 20 x 10 mm each.
pub fn two_boxes() -> Job {
    Complex::voxels([2, 2, 2], 10.0, |_, _, z| Some(z)).job("two-boxes")
}

/// A dovetail: a tail of 8 mm at its neck, 14 at its end, in a socket, both 20 mm deep.
pub fn dovetail() -> Job {
    let p = |x: f64, y: f64| DVec2::new(x, y);
    let points = [
        p(-20., 0.),
        p(-4., 0.),
        p(4., 0.),
        p(20., 0.),
        p(-20., 8.),
        p(-7., 8.),
        p(7., 8.),
        p(20., 8.),
        p(-20., 16.),
        p(-7., 16.),
        p(7., 16.),
        p(20., 16.),
        p(-20., -10.),
        p(-4., -10.),
        p(4., -10.),
        p(20., -10.),
    ];
    let polygons: [(Owner, &[u32]); 9] = [
        (Some(0), &[12, 13, 1, 0]),
        (Some(0), &[13, 14, 2, 1]),
        (Some(0), &[14, 15, 3, 2]),
        (Some(1), &[0, 1, 5, 4]),
        (Some(0), &[1, 2, 6, 5]),
        (Some(1), &[2, 3, 7, 6]),
        (Some(1), &[4, 5, 9, 8]),
        (Some(1), &[5, 6, 10, 9]),
        (Some(1), &[6, 7, 11, 10]),
    ];
    Complex::extruded(&points, &polygons, 0.0, 20.0).job("dovetail")
}

/// Three parts of a hexagonal bar whose ridges meet along its axis; the axis is a chain of steps, so that they also
/// meet in corners.
pub fn three_around_an_axis() -> Job {
    let around = |k: usize| DVec2::from_angle(k as f64 * std::f64::consts::TAU / 6.0 + 0.1) * 20.0;
    let points: Vec<DVec2> = std::iter::once(DVec2::new(1.0, 2.0)).chain((0..6).map(around)).collect();
    let polygons: [(Owner, &[u32]); 3] =
        [(Some(0), &[0, 1, 2, 3]), (Some(1), &[0, 3, 4, 5]), (Some(2), &[0, 5, 6, 1])];
    Complex::extruded(&points, &polygons, -10.0, 10.0).job("three-around-an-axis")
}

/// Two voxel parts that hook into one another in all directions; every inner corner is a sharp one.
pub fn voxel_hooks() -> Job {
    let upper = |x: usize, y: usize, z: usize| match z {
        0 => false,
        1 => x == 2 || (x == 3 && y == 2),
        2 => x > 0,
        _ => true,
    };
    Complex::voxels([4, 3, 4], 8.0, |x, y, z| Some(usize::from(upper(x, y, z)))).job("voxel-hooks")
}

/// Steps along an axis of 40 mm: irregular, some of them a thousandth of a millimetre and less.
fn uneven(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let steps: Vec<f64> =
        (0..n).map(|k| if k % 4 == 3 { 10f64.powf(-3.0 - 2.0 * next()) } else { 0.5 + next() }).collect();
    let total: f64 = steps.iter().sum();
    let mut at = 0.0;
    std::iter::once(0.0)
        .chain(steps.iter().map(|s| {
            at += s * 40.0 / total;
            at
        }))
        .collect()
}

/// Two blocks that meet in a saddle, sampled on an uneven grid with very short edges.
pub fn saddle() -> Job {
    let (xs, ys) = (uneven(14, 7), uneven(11, 11));
    let height = |x: f64, y: f64| 20.0 + ((x - 20.0).powi(2) - (y - 20.0).powi(2)) / 60.0;
    let (nx, ny) = (xs.len(), ys.len());
    let mut complex = Complex::default();
    for &y in &ys {
        xs.iter().for_each(|&x| complex.vertices.push(DVec3::new(x, y, height(x, y))));
    }
    let id = |x: usize, y: usize| (y * nx + x) as u32;
    let mut sheet = vec![];
    for y in 0..ny - 1 {
        for x in 0..nx - 1 {
            let [a, b, c, d] = [id(x, y), id(x + 1, y), id(x + 1, y + 1), id(x, y + 1)];
            sheet.extend([vec![a, b, c], vec![a, c, d]]);
        }
    }
    // Counter-clockwise from above; below and above each of its vertices stands one of the floor and of the ceiling.
    let right = (1..ny).map(|y| id(nx - 1, y));
    let back = (0..nx - 1).rev().map(|x| id(x, ny - 1));
    let left = (1..ny - 1).rev().map(|y| id(0, y));
    let rim: Vec<u32> = (0..nx).map(|x| id(x, 0)).chain(right).chain(back).chain(left).collect();
    let n = rim.len();
    let [floor, ceiling] = [0.0, 40.0].map(|z| {
        let first = complex.vertices.len() as u32;
        rim.iter().for_each(|&v| complex.vertices.push(complex.vertices[v as usize].with_z(z)));
        (first..first + n as u32).collect::<Vec<u32>>()
    });
    let walls = |low: &[u32], high: &[u32]| -> Vec<Vec<u32>> {
        let next = |k: usize| (k + 1) % n;
        (0..n).map(|k| vec![low[k], low[next(k)], high[next(k)], high[k]]).collect()
    };
    let turned = |f: &Vec<u32>| f.iter().rev().copied().collect::<Vec<u32>>();
    let lower = sheet.iter().cloned().chain(walls(&floor, &rim)).chain([turned(&floor)]).collect();
    let upper = sheet.iter().map(turned).chain(walls(&rim, &ceiling)).chain([ceiling.clone()]).collect();
    complex.cells = vec![Cell { owner: Some(0), facets: lower }, Cell { owner: Some(1), facets: upper }];
    complex.job("saddle")
}

/// Two plates of 2 mm with a third of 1 mm between them.
pub fn thin_plate() -> Job {
    let heights = [0.0, 2.0, 3.0, 5.0];
    let mut complex = Complex::voxels([1, 1, 3], 20.0, |_, _, z| Some(z));
    complex.vertices.iter_mut().for_each(|v| v.z = heights[(v.z / 20.0).round() as usize]);
    complex.job("thin-plate")
}

/// A block of 30 x 20 x 20 mm with a slot of `wide` mm in it, 10 mm deep.
pub fn slotted(wide: f64) -> Job {
    let mut complex = Complex::voxels([3, 1, 2], 10.0, |x, _, z| (x != 1 || z == 0).then_some(0));
    let xs = [0.0, 15.0 - wide / 2.0, 15.0 + wide / 2.0, 30.0];
    for v in &mut complex.vertices {
        *v = DVec3::new(xs[(v.x / 10.0).round() as usize], v.y * 2.0, v.z);
    }
    complex.job("slotted")
}

/// The same two-box job with one shape in two poses, turned half a turn about x.
pub fn two_boxes_of_one_shape() -> Job {
    let mut job = two_boxes();
    let middle = DVec3::new(0.0, 10.0, 10.0);
    let turn = DAffine3::from_rotation_x(std::f64::consts::PI);
    job.parts[1].shape = 0;
    job.parts[1].pose = DAffine3::from_translation(middle) * turn * DAffine3::from_translation(-middle);
    job.parts[1].roles = job.parts[0]
        .roles
        .iter()
        .map(|r| if *r == Role::Outer { Role::Outer } else { Role::Contact { with: 0 } })
        .collect();
    job.shapes.truncate(1);
    job
}

/// A ring of cubes that touches itself in one edge, both ends of which are inside its matter, and the two bars that it holds.
pub fn ring_on_an_edge() -> Job {
    let owner = |x: usize, y: usize, z: usize| match [x, y, z] {
        [1, 0, 0] | [1, 0, 1] => 1,
        [0, 1, 1] | [0, 1, 2] => 2,
        _ => 0,
    };
    Complex::voxels([2, 2, 3], 8.0, |x, y, z| Some(owner(x, y, z))).job("ring-on-an-edge")
}
