//! Takes the clearance of a process; gives the calibration coupon: two bars that tell the shrinkage, and a row of notches
//! with a key that tells the clearance.
//!
//! The coupon is drawn at its true size: no scale is applied to it, or there would be nothing to measure.

use crate::ears::triangulate;
use crate::mesh::Mesh;
use crate::process::COUPON_MM;
use crate::shape::Facet;
use glam::DVec3;
use serde::Serialize;

/// Width of the bars and thickness of everything, mm: stiff enough to be measured, thin enough to print in minutes.
const BAR: f64 = 10.0;
const THICK: f64 = 5.0;
/// The key's section and length, mm.
const KEY: (f64, f64) = (5.0, 30.0);
/// Depth of a notch, mm: the key stands in it, and most of the bar is left.
const NOTCH: f64 = 4.0;
/// From one notch to the next, mm: a notch and a land of two walls.
const PITCH: f64 = 8.0;
/// Clearances of the notches, in those of the process: from press to loose.
const STEPS: [f64; 6] = [0.5, 0.75, 1.0, 1.25, 1.5, 2.0];
/// Where the process has no clearance, the notches stand for multiples of this, mm: half of a common press fit.
const SMALLEST: f64 = 0.05;

/// A notch and what it stands for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Notch {
    /// From the corner, from 1.
    pub number: usize,
    pub width_mm: f64,
    /// Air on each face of two parts that go together as the key in this notch.
    pub clearance_mm: f64,
}

/// What is printed to find out about a machine and its material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coupon {
    pub bar_mm: f64,
    pub key_mm: f64,
    pub notches: Vec<Notch>,
    /// An L with notches, and the key beside it; closed, in the positive octant.
    #[serde(skip)]
    pub gauge: Mesh,
    #[serde(skip)]
    pub key: Mesh,
}

impl Coupon {
    /// For a clearance on each face, mm.
    pub fn of(clearance: f64) -> Coupon {
        let unit = if clearance > 0.0 { clearance } else { SMALLEST };
        let notch = |(k, step): (usize, &f64)| {
            // Both faces of the key leave the air of two parts: four clearances in all.
            let c = step * unit;
            Notch { number: k + 1, width_mm: KEY.0 + 4.0 * c, clearance_mm: c }
        };
        let room = (COUPON_MM - BAR) / PITCH;
        let fits = |n: &Notch| n.width_mm <= PITCH - 1.0 && (n.number as f64) <= room;
        let notches: Vec<Notch> = STEPS.iter().enumerate().map(notch).filter(fits).collect();
        let key = [(20.0, 20.0), (20.0 + KEY.1, 20.0), (20.0 + KEY.1, 20.0 + KEY.0), (20.0, 20.0 + KEY.0)];
        Coupon {
            bar_mm: COUPON_MM,
            key_mm: KEY.0,
            gauge: prism(&outline(&notches)),
            key: prism(&key),
            notches,
        }
    }
}

/// The L, counter-clockwise from its corner: along x below, back above with the notches, up the other bar.
fn outline(notches: &[Notch]) -> Vec<(f64, f64)> {
    let mut points = vec![(0.0, 0.0), (COUPON_MM, 0.0), (COUPON_MM, BAR)];
    for n in notches.iter().rev() {
        let middle = BAR + PITCH * (n.number as f64 - 0.5) + 1.0;
        let (left, right) = (middle - n.width_mm / 2.0, middle + n.width_mm / 2.0);
        points.extend([(right, BAR), (right, BAR - NOTCH), (left, BAR - NOTCH), (left, BAR)]);
    }
    points.extend([(BAR, BAR), (BAR, COUPON_MM), (0.0, COUPON_MM)]);
    points
}

/// The polygon with a thickness; coordinates are rounded to f32, as files hold them.
fn prism(outline: &[(f64, f64)]) -> Mesh {
    let n = outline.len() as u32;
    let point = |z: f64| move |&(x, y): &(f64, f64)| DVec3::new(f64::from(x as f32), f64::from(y as f32), z);
    let vertices: Vec<DVec3> =
        outline.iter().map(point(0.0)).chain(outline.iter().map(point(THICK))).collect();
    let facet = |corners: Vec<u32>, normal| Facet { corners, normal };
    let mut triangles = triangulate(&vertices, &facet((0..n).rev().collect(), DVec3::NEG_Z));
    triangles.extend(triangulate(&vertices, &facet((n..2 * n).collect(), DVec3::Z)));
    for a in 0..n {
        let b = (a + 1) % n;
        triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
    }
    Mesh { vertices, triangles }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Closure;

    #[test]
    fn the_coupon_is_closed_and_has_the_lengths_that_it_says() {
        for clearance in [0.0, 0.1, 0.2, 0.3] {
            let c = Coupon::of(clearance);
            assert_eq!((c.gauge.closure(), c.key.closure()), (Closure::Closed, Closure::Closed));
            assert!(c.notches.len() >= 5, "{clearance}: {}", c.notches.len());
            assert_eq!(c.gauge.bounds(), (DVec3::ZERO, DVec3::new(COUPON_MM, COUPON_MM, THICK)));
            let cut: f64 = c.notches.iter().map(|n| n.width_mm * NOTCH * THICK).sum();
            let bars = (2.0 * COUPON_MM * BAR - BAR * BAR) * THICK;
            assert!((c.gauge.volume() - (bars - cut)).abs() < 0.01);
        }
    }
}
