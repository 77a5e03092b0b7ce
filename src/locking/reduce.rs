//! Takes contact rows; gives those that generate the wrench cone of each pair of parts, as far as cheap tests tell.
//!
//! A row that is left out is a nonnegative combination of rows of the same pair that are kept, up to round-off: so the
//! same motions are allowed and the rank is the same. Nothing rests on that round-off: forces act on rows that exist,
//! and a motion is tested on every row. Not promised: that no row too many is kept.

use super::rows::{Freedom, Row, Unknowns};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use robust::{Coord, orient2d};
use std::collections::BTreeSet;

/// Normals within this of each other are taken for one: round-off of a unit vector computed from coordinates of size
/// 1 at a resolution of 2^-40 of them.
const SAME_NORMAL: f64 = 1.0 / (1_u64 << 36) as f64;

/// Pair, normal in units of [`SAME_NORMAL`], and which row.
type Key = ((u32, u32), [i64; 3], usize);

/// The rows to keep, pair by pair, by their index. A row's wrench depends on its point only across the normal, so of
/// rows with one normal the corners of their outline span the cone, whichever planes they lie in.
pub fn kept(rows: &[Row], unknowns: &Unknowns) -> Vec<usize> {
    let free = |r: &Row| unknowns.column[r.a.at()].is_some() || unknowns.column[r.b.at()].is_some();
    let mut keys: Vec<Key> =
        rows.par_iter().enumerate().filter(|(_, r)| free(r)).map(|(k, r)| key(k, r)).collect();
    keys.par_sort_unstable();
    keys.par_chunk_by(|k, l| (k.0, k.1) == (l.0, l.1)).flat_map_iter(|group| outline(rows, group)).collect()
}

/// All rows on a part that may move, pair by pair, by their index.
pub fn by_pair(rows: &[Row], unknowns: &Unknowns) -> Vec<usize> {
    let free = |r: &Row| unknowns.column[r.a.at()].is_some() || unknowns.column[r.b.at()].is_some();
    let mut all: Vec<usize> = (0..rows.len()).filter(|&k| free(&rows[k])).collect();
    all.sort_unstable_by_key(|&k| (pair(&rows[k]), k));
    all
}

/// Of rows that stand pair by pair, those of each pair that lie farthest along the axes of force and moment and their
/// diagonals: few, and mostly enough for a lock. Not all extreme rays of the pair's cone are among them.
pub fn outermost(rows: &[Row], kept: &[usize], freedom: Freedom) -> Vec<usize> {
    let along = probes(freedom);
    kept.par_chunk_by(|&i, &j| pair(&rows[i]) == pair(&rows[j]))
        .flat_map_iter(|own| farthest(rows, own, &along))
        .collect()
}

fn farthest(rows: &[Row], own: &[usize], along: &[(DVec3, DVec3)]) -> BTreeSet<usize> {
    let middle = own.iter().map(|&k| rows[k].point).sum::<DVec3>() / own.len() as f64;
    let wrench = |&k: &usize| {
        let row = turned(&rows[k]);
        (k, row.normal, (row.point - middle).cross(row.normal))
    };
    let wrenches: Vec<(usize, DVec3, DVec3)> = own.iter().map(wrench).collect();
    let best = |&(f, m): &(DVec3, DVec3)| {
        let value = |w: &(usize, DVec3, DVec3)| f.dot(w.1) + m.dot(w.2);
        let of_two = |i: &(usize, f64), j: &(usize, f64)| i.1.total_cmp(&j.1).then(j.0.cmp(&i.0));
        wrenches.iter().map(|w| (w.0, value(w))).max_by(of_two).map(|w| w.0)
    };
    along.iter().filter_map(best).collect()
}

fn probes(freedom: Freedom) -> Vec<(DVec3, DVec3)> {
    let sign = |k: i32| f64::from(k % 3 - 1);
    let signs = (0..27).map(|k| DVec3::new(sign(k), sign(k / 3), sign(k / 9)));
    let along: Vec<DVec3> = signs.filter(|d| *d != DVec3::ZERO).collect();
    let forces = along.iter().map(|&d| (d, DVec3::ZERO));
    match freedom {
        Freedom::Translation => forces.collect(),
        Freedom::Rigid => forces.chain(along.iter().map(|&d| (DVec3::ZERO, d))).collect(),
    }
}

fn key(k: usize, row: &Row) -> Key {
    let n = turned(row).normal / SAME_NORMAL;
    (pair(row), n.to_array().map(|v| v.round() as i64), k)
}

/// The two parts of a row, the lower one first.
pub fn pair(row: &Row) -> (u32, u32) {
    (row.a.0.min(row.b.0), row.a.0.max(row.b.0))
}

/// The same row with the lower part first.
pub fn turned(row: &Row) -> Row {
    if row.a <= row.b { *row } else { Row { a: row.b, b: row.a, normal: -row.normal, point: row.point } }
}

/// The corners of the convex outline of rows with one normal, seen along it.
fn outline(rows: &[Row], group: &[Key]) -> Vec<usize> {
    let first = &rows[group[0].2];
    let (origin, (u, v)) = (first.point, first.normal.normalize().any_orthonormal_pair());
    let flat = |k: usize| DVec2::new((rows[k].point - origin).dot(u), (rows[k].point - origin).dot(v));
    let mut points: Vec<(DVec2, usize)> = group.iter().map(|&(_, _, k)| (flat(k), k)).collect();
    points.sort_by(|(p, i), (q, j)| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)).then(i.cmp(j)));
    points.dedup_by(|p, q| p.0 == q.0);
    let mut hull: Vec<(DVec2, usize)> = Vec::new();
    half(points.iter(), &mut hull);
    hull.pop();
    let lower = hull.len();
    let mut upper = Vec::new();
    half(points.iter().rev(), &mut upper);
    upper.pop();
    hull.extend(upper);
    if lower == 0 {
        hull = points;
    }
    hull.into_iter().map(|(_, k)| k).collect()
}

/// The strictly convex chain over points in order.
fn half<'a>(points: impl Iterator<Item = &'a (DVec2, usize)>, chain: &mut Vec<(DVec2, usize)>) {
    for p in points {
        while let [.., q, r] = chain[..] {
            let turn = orient2d(coord(q.0), coord(r.0), coord(p.0));
            if turn > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(*p);
    }
}

fn coord(p: DVec2) -> Coord<f64> {
    Coord { x: p.x, y: p.y }
}
