//! Takes triangles on the picture's plane, gives for each sample the nearest one.
//!
//! Promised: samples on an edge belong to both of its triangles, the nearer wins, in a tie the lower number. Faces seen
//! from behind are left out: of two parts that touch, the hidden face cannot fight with the covering one.

use super::camera::Camera;
use super::scene::{Opacity, Scene};
use glam::DVec3;
use std::ops::Range;

/// Share of the largest nearness by which a triangle must beat another: far above round-off, far below what is seen;
/// so two parts with faces in one plane do not fight, the first one shows.
const TIE: f64 = 1e-9;

/// Index into [`Stage::triangles`] of a sample that sees nothing.
pub(super) const NOTHING: u32 = u32::MAX;

/// Slack of a span's ends, in samples: far above the round-off of an intersection (1e-16 times 25,000 samples across),
/// far below what is seen; so no sample falls between two triangles that share an edge.
const SPAN_SLACK: f64 = 1e-9;

/// A triangle in place: corners in the scene and, with nearness as z, in samples on the picture.
pub(super) struct Facing {
    pub item: u32,
    pub triangle: u32,
    pub corners: [DVec3; 3],
    pub seen: [DVec3; 3],
}

/// All triangles that face the viewer, ghosts included.
pub(super) struct Stage {
    pub triangles: Vec<Facing>,
    /// Nearness that counts as none.
    pub tie: f64,
}

impl Stage {
    pub fn of(scene: &Scene, camera: &Camera, samples: usize) -> Stage {
        let mut triangles = Vec::new();
        for (i, item) in scene.items.iter().enumerate().filter(|(_, i)| i.opacity != Opacity::Hidden) {
            let placed: Vec<DVec3> = item.points().collect();
            let fine = DVec3::new(samples as f64, samples as f64, 1.0);
            let seen: Vec<DVec3> = placed.iter().map(|&p| camera.project(p) * fine).collect();
            triangles.extend((item.mesh.triangles.iter().enumerate()).map(|(t, tri)| Facing {
                item: i as u32,
                triangle: t as u32,
                corners: tri.corners.map(|c| placed[c as usize]),
                seen: tri.corners.map(|c| seen[c as usize]),
            }));
        }
        // Counter-clockwise from outside turns clockwise where y points down.
        triangles.retain(|f| turn(&f.seen) < 0.0);
        let most = triangles.iter().flat_map(|f| f.seen).map(|p| p.z.abs()).fold(0.0, f64::max);
        Stage { triangles, tie: most * TIE }
    }

    /// Where the triangles of an item stand: they come in the order of their items.
    pub fn of_item(&self, item: u32) -> Range<usize> {
        let all = &self.triangles;
        all.partition_point(|f| f.item < item)..all.partition_point(|f| f.item <= item)
    }
}

/// Twice the signed area on the plane.
fn turn([a, b, c]: &[DVec3; 3]) -> f64 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

/// The nearest triangle of each sample in a window of the picture.
pub(super) struct Layer {
    /// Of the window, in samples.
    pub width: usize,
    pub first_column: usize,
    pub first_row: i64,
    pub rows: usize,
    pub nearest: Vec<u32>,
    pub near: Vec<f64>,
    tie: f64,
}

impl Layer {
    pub fn empty(columns: Range<usize>, rows: Range<i64>, tie: f64) -> Layer {
        let width = columns.len();
        let count = width * (rows.end - rows.start) as usize;
        Layer {
            width,
            first_column: columns.start,
            first_row: rows.start,
            rows: (rows.end - rows.start) as usize,
            nearest: vec![NOTHING; count],
            near: vec![f64::NEG_INFINITY; count],
            tie,
        }
    }

    pub fn draw(&mut self, number: u32, seen: &[DVec3; 3]) {
        let rows = self.first_row..self.first_row + self.rows as i64;
        let columns = self.first_column..self.first_column + self.width;
        let (tie, width, first, left) = (self.tie, self.width, self.first_row, self.first_column);
        let (nearest, near) = (&mut self.nearest, &mut self.near);
        spans(seen, columns, rows, |y, xs, ramp| {
            let row = (y - first) as usize * width;
            for x in xs {
                let (v, at) = (ramp.at(x), row + x - left);
                if v > near[at] + tie {
                    near[at] = v;
                    nearest[at] = number;
                }
            }
        });
    }

    /// Where a sample of the picture lies in the window's lists; `None` beside it.
    pub fn at(&self, x: usize, y: i64) -> Option<usize> {
        let column = x.checked_sub(self.first_column).filter(|c| *c < self.width)?;
        let row = usize::try_from(y - self.first_row).ok().filter(|r| *r < self.rows)?;
        Some(row * self.width + column)
    }

    /// Column and row in the picture of an entry of the lists.
    pub fn place(&self, k: usize) -> (usize, i64) {
        (k % self.width + self.first_column, (k / self.width) as i64 + self.first_row)
    }

    /// Empties every sample that `front` covers with something at least as near.
    pub fn hide_behind(&mut self, front: &Layer) {
        for k in 0..self.nearest.len() {
            let (x, y) = self.place(k);
            let Some(f) = front.at(x, y) else { continue };
            if front.nearest[f] != NOTHING && front.near[f] >= self.near[k] - self.tie {
                self.nearest[k] = NOTHING;
            }
        }
    }
}

/// Nearness along one row of samples.
pub(super) struct Ramp {
    start: f64,
    slope: f64,
}

impl Ramp {
    pub fn at(&self, x: usize) -> f64 {
        self.start + (x as f64 + 0.5) * self.slope
    }
}

/// Calls `row(y, xs, nearness)` for each row of samples that the triangle covers in a window.
pub(super) fn spans(
    seen: &[DVec3; 3],
    columns: Range<usize>,
    rows: Range<i64>,
    mut row: impl FnMut(i64, Range<usize>, Ramp),
) {
    let area = turn(seen);
    if !area.is_finite() || area == 0.0 {
        return;
    }
    let [a, b, c] = *seen;
    let (ab, ac) = (b - a, c - a);
    let slope = [(ab.z * ac.y - ac.z * ab.y) / area, (ac.z * ab.x - ab.z * ac.x) / area];
    let (lo, hi) = (a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y));
    let first = ((lo - 0.5 - SPAN_SLACK).ceil() as i64).max(rows.start);
    let last = ((hi - 0.5 + SPAN_SLACK).floor() as i64).min(rows.end - 1);
    for y in first..=last {
        let v = y as f64 + 0.5;
        let Some((left, right)) = cut(seen, v) else { continue };
        let (begin, end) = (columns.start as f64, columns.end as f64);
        let x0 = (left - 0.5 - SPAN_SLACK).ceil().max(begin) as usize;
        let x1 = ((right - 0.5 + SPAN_SLACK).floor() + 1.0).clamp(begin, end) as usize;
        let start = a.z + (v - a.y) * slope[1] - a.x * slope[0];
        row(y, x0..x1, Ramp { start, slope: slope[0] });
    }
}

/// Where the horizontal line at `v` enters and leaves the triangle.
fn cut(seen: &[DVec3; 3], v: f64) -> Option<(f64, f64)> {
    let mut ends: Option<(f64, f64)> = None;
    for k in 0..3 {
        // Both triangles at an edge take it from the lower end up: the same round-off on both sides.
        let (p, q) = (seen[k], seen[(k + 1) % 3]);
        let (p, q) = if (p.y, p.x) <= (q.y, q.x) { (p, q) } else { (q, p) };
        if v < p.y - SPAN_SLACK || v > q.y + SPAN_SLACK {
            continue;
        }
        let share = if q.y > p.y { ((v - p.y) / (q.y - p.y)).clamp(0.0, 1.0) } else { 0.0 };
        let xs = if q.y > p.y { [p.x + share * (q.x - p.x); 2] } else { [p.x, q.x] };
        for x in xs {
            ends = Some(ends.map_or((x, x), |(l, r)| (l.min(x), r.max(x))));
        }
    }
    ends
}
