//! Takes two convex cells and their motions, at least one of them a turn, and says whether they keep a distance, or
//! overlap by no more than the tolerance, over the whole motion.
//!
//! Sound: each stretch is vouched for by one plane fixed to one of the cells, whose distances are bounded over the whole
//! stretch; a stretch without such a plane is halved. Nothing between two samples is missed. Complete up to a counted
//! number of stretches; then the answer is undecided. Sliding on a face costs one plane, however long it is.

use super::Placed;
use super::turn::{Path, Plane, Span, least_height};
use super::way::{Way, gap, parting};
use glam::DVec3;

/// Stretches looked at for one pair of cells before giving up: an edge that rolls along an edge at no distance is off
/// its plane by arm * angle^2 / 8 over a stretch, so 2^-20 of its arm (the tolerance) takes about 2^10 stretches of a
/// radian; this is sixteen times that.
const MOST_STRETCHES: usize = 1 << 14;

/// A cell and the way that it goes.
#[derive(Clone, Copy)]
pub struct Moving<'a> {
    pub cell: &'a Placed,
    pub path: &'a Path,
}

/// What a pair of cells must keep: at least this plane distance, model units; below 0: an overlap that is tolerated.
#[derive(Clone, Copy, Debug)]
pub struct Keep {
    pub distance: f64,
    pub tolerance: f64,
}

pub enum Swept {
    Kept,
    /// A ball of this radius fits into both at this share of the motion (0: they only come too near).
    Broken {
        radius: f64,
        at: f64,
    },
    Undecided,
}

pub fn swept(x: Moving, y: Moving, span: Span, keep: Keep) -> Swept {
    let mut open = vec![span];
    for _ in 0..MOST_STRETCHES {
        let Some(span) = open.pop() else { return Swept::Kept };
        if boxes_keep(x, y, span, keep.distance) || faces_keep(x, y, span, keep.distance) {
            continue;
        }
        match at_middle(x, y, span, keep) {
            Middle::Broken { radius } => return Swept::Broken { radius, at: span.middle() },
            Middle::Unsolved => return Swept::Undecided,
            Middle::Normal(n) if plane_keeps(x, y, n, span, keep.distance) => {}
            Middle::Normal(_) => {
                let middle = span.middle();
                open.push(Span { from: middle, ..span });
                open.push(Span { to: middle, ..span });
            }
        }
    }
    Swept::Undecided
}

/// Corners of the box around all places of the cell over the stretch.
pub fn box_over(m: Moving, span: Span) -> (DVec3, DVec3) {
    let (from, to) = (m.path.at(span.from), m.path.at(span.to));
    let corners = m.cell.cell.vertices.iter();
    let ends = corners.flat_map(|&v| [from.transform_point3(v), to.transform_point3(v)]);
    let (lo, hi) = ends.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
    let arm = m.cell.cell.vertices.iter().map(|&v| m.path.arm(v)).fold(0.0, f64::max);
    let more = m.path.sagitta(arm, span);
    (lo - more, hi + more)
}

fn boxes_keep(x: Moving, y: Moving, span: Span, distance: f64) -> bool {
    let ((xlo, xhi), (ylo, yhi)) = (box_over(x, span), box_over(y, span));
    (xlo - yhi).max(ylo - xhi).max_element() > distance.max(0.0)
}

/// Whether a face of one of the cells keeps the other at the distance.
fn faces_keep(x: Moving, y: Moving, span: Span, distance: f64) -> bool {
    faces_of(x, y, span, distance) || faces_of(y, x, span, distance)
}

fn faces_of(own: Moving, other: Moving, span: Span, distance: f64) -> bool {
    // A look at the middle first: a plane that fails there need not be bounded.
    let s = span.middle();
    let seen = own.path.at(s).inverse() * other.path.at(s);
    let there: Vec<DVec3> = other.cell.cell.vertices.iter().map(|&v| seen.transform_point3(v)).collect();
    own.cell.cell.planes.iter().zip(&own.cell.cell.facets).any(|(&(normal, d), facet)| {
        let promising = there.iter().all(|v| normal.dot(*v) - d >= distance);
        let Some(&point) = facet.first().and_then(|&k| own.cell.cell.vertices.get(k as usize)) else {
            return false;
        };
        promising && keeps(Plane { point, normal }, own, other, span, distance)
    })
}

fn keeps(plane: Plane, own: Moving, other: Moving, span: Span, distance: f64) -> bool {
    let height = |&v: &DVec3| least_height(plane, own.path, v, other.path, span);
    other.cell.cell.vertices.iter().all(|v| height(v) >= distance)
}

enum Middle {
    Broken {
        radius: f64,
    },
    /// Unit normal, from y to x, of a plane between the cells at the middle, in the world.
    Normal(DVec3),
    Unsolved,
}

fn at_middle(x: Moving, y: Moving, span: Span, keep: Keep) -> Middle {
    let s = span.middle();
    let [a, b] = [x, y].map(|m| m.cell.cell.moved(&m.path.at(s)));
    let Some(found) = parting(&a, &b) else { return Middle::Unsolved };
    if found.radius > keep.tolerance {
        return Middle::Broken { radius: found.radius };
    }
    if keep.distance <= 0.0 {
        return Middle::Normal(found.normal);
    }
    match gap(&a, &b, Way { direction: DVec3::Z, length: 0.0 }) {
        Some(g) if g.distance < keep.distance => Middle::Broken { radius: 0.0 },
        Some(g) => Middle::Normal(g.apart.try_normalize().unwrap_or(found.normal)),
        None => Middle::Unsolved,
    }
}

/// Whether the plane across `normal`, fixed to either cell where it is at the middle, keeps the other at the distance.
fn plane_keeps(x: Moving, y: Moving, normal: DVec3, span: Span, distance: f64) -> bool {
    fixed_keeps(y, x, normal, span, distance) || fixed_keeps(x, y, -normal, span, distance)
}

fn fixed_keeps(own: Moving, other: Moving, normal: DVec3, span: Span, distance: f64) -> bool {
    let n = own.path.at(span.middle()).inverse().transform_vector3(normal);
    let outermost = own.cell.cell.vertices.iter().max_by(|a, b| n.dot(**a).total_cmp(&n.dot(**b)));
    let Some(&point) = outermost else { return false };
    keeps(Plane { point, normal: n }, own, other, span, distance)
}
