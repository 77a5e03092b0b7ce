//! Takes two parts (or two convex cells) and a direction, gives whether the first, moved along it from here to
//! infinity, meets the interior of the second, with the pair of cells that does.
//!
//! Sound and complete for convex cells whose interiors are disjoint at the start, up to [`Touch`]. Where two cells
//! overlap at the start by more, the answer is that they meet, whichever way they go: the safe direction.
//!
//! Two convex bodies meet on the way exactly when their shadows overlap and the second is not behind. Because they are
//! disjoint at the start, any one line through both decides which is ahead; the middle of the common shadow is taken,
//! where both are thick.

use super::Touch;
use super::shadow::{Convex, Outline, Span, View};
use crate::assembly::PartIx;
use glam::{DVec2, DVec3};

/// Cell `a` of the moving part meets cell `b` of the still one; their shadows overlap by `depth` (model units).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    pub a: usize,
    pub b: usize,
    pub depth: f64,
}

/// The first pair of cells (by index) that meet when `i` moves along the view's direction; None: it passes.
pub fn meets(view: &View, i: PartIx, j: PartIx, touch: Touch) -> Option<Meeting> {
    meetings(view, i, j, touch, Some)
}

/// Whether boxes leave it open that some cells meet; None of `meetings` where they do not.
pub fn near(view: &View, i: PartIx, j: PartIx, touch: Touch) -> bool {
    let ((seen_i, at_i), (seen_j, at_j)) = (view.part(i), view.part(j));
    !apart(&seen_i.whole, &seen_j.whole.shift(at_j - at_i), touch)
}

/// The first answer that `pick` gives for a pair of cells that meet.
pub fn meetings<T>(
    view: &View,
    i: PartIx,
    j: PartIx,
    touch: Touch,
    mut pick: impl FnMut(Meeting) -> Option<T>,
) -> Option<T> {
    let ((seen_i, at_i), (seen_j, at_j)) = (view.part(i), view.part(j));
    let step = at_j - at_i;
    let whole = seen_j.whole.shift(step);
    if apart(&seen_i.whole, &whole, touch) {
        return None;
    }
    let spans_j = seen_j.spans.iter().map(|s| s.shift(step)).enumerate();
    let near: Vec<(usize, Span)> = spans_j.filter(|(_, s)| !apart(&seen_i.whole, s, touch)).collect();
    let cells_i = seen_i.spans.iter().enumerate().filter(|(_, s)| !apart(s, &whole, touch));
    cells_i
        .flat_map(|(a, sa)| near.iter().filter(|(_, sb)| !apart(sa, sb, touch)).map(move |&(b, _)| (a, b)))
        .find_map(|(a, b)| cells_meet(view, (i, a), (j, b), step, touch).and_then(&mut pick))
}

/// True when boxes alone show that `a` passes `b`: shadows overlap by no more than `touch`, or `b` is behind.
fn apart(a: &Span, b: &Span, touch: Touch) -> bool {
    let common = a.hi.min(b.hi) - a.lo.max(b.lo);
    let t = touch.depth();
    common.x <= t || common.y <= t || b.hi.z - a.lo.z <= t
}

type CellOf = (PartIx, usize);

fn cells_meet(view: &View, a: CellOf, b: CellOf, step: DVec3, touch: Touch) -> Option<Meeting> {
    let (pa, pb) = (view.outline(a.0, a.1), view.outline(b.0, b.1));
    let at = step.truncate();
    let depth = overlap(pa, pb, at).min(overlap(pb, pa, -at));
    if depth <= touch.depth() || behind(view, a, b, step, touch) {
        return None;
    }
    Some(Meeting { a: a.1, b: b.1, depth })
}

/// Least overlap of two convex outlines, `q` shifted by `at`, across the sides of `p`; stops at the first gap.
fn overlap(p: &Outline, q: &Outline, at: DVec2) -> f64 {
    let mut least = f64::INFINITY;
    for &(n, c) in &p.sides {
        let reach = q.corners.iter().fold(f64::INFINITY, |m, &x| m.min(n.dot(x)));
        least = least.min(c - n.dot(at) - reach);
        if least <= 0.0 {
            break;
        }
    }
    least
}

/// Whether `b` lies behind `a` along d, measured on a line through the middle of their common shadow.
/// Where no such line is found (a cell thinner than round-off) the answer is no.
fn behind(view: &View, a: CellOf, b: CellOf, step: DVec3, touch: Touch) -> bool {
    let shadow = common(view.outline(a.0, a.1), view.outline(b.0, b.1), step.truncate());
    let Some(mid) = centroid(&shadow) else {
        return false;
    };
    let base = view.world(mid.extend(0.0));
    let chord_a = chord(&view.shapes.part(a.0).0[a.1], base, view.d);
    let chord_b = chord(&view.shapes.part(b.0).0[b.1], base - view.world(step), view.d);
    match (chord_a, chord_b) {
        (Some((a0, a1)), Some((b0, b1))) => b1 - a0 <= touch.depth() && b0 + b1 < a0 + a1,
        _ => false,
    }
}

/// Where the line `base + s d` runs inside a convex cell: least and greatest s.
fn chord(cell: &Convex, base: DVec3, d: DVec3) -> Option<(f64, f64)> {
    let (mut lo, mut hi) = (f64::NEG_INFINITY, f64::INFINITY);
    for &(n, c) in &cell.planes {
        let (rate, room) = (n.dot(d), c - n.dot(base));
        if rate > 0.0 {
            hi = hi.min(room / rate);
        } else if rate < 0.0 {
            lo = lo.max(room / rate);
        } else if room < 0.0 {
            return None;
        }
    }
    (lo <= hi && (hi - lo).is_finite()).then_some((lo, hi))
}

/// The part of `p` inside `q` shifted by `at` (Sutherland and Hodgman).
fn common(p: &Outline, q: &Outline, at: DVec2) -> Vec<DVec2> {
    let mut poly = p.corners.clone();
    for &(n, c) in &q.sides {
        let side = |x: DVec2| c - n.dot(x - at);
        let old = std::mem::take(&mut poly);
        for (m, &x) in old.iter().enumerate() {
            let y = old[(m + 1) % old.len()];
            let (sx, sy) = (side(x), side(y));
            if sx >= 0.0 {
                poly.push(x);
            }
            if (sx > 0.0 && sy < 0.0) || (sx < 0.0 && sy > 0.0) {
                poly.push(x.lerp(y, sx / (sx - sy)));
            }
        }
    }
    poly
}

/// Centre of area of a convex polygon; None without area.
fn centroid(poly: &[DVec2]) -> Option<DVec2> {
    let &o = poly.first()?;
    let (mut area, mut sum) = (0.0, DVec2::ZERO);
    for w in poly[1..].windows(2) {
        let twice = (w[0] - o).perp_dot(w[1] - o);
        area += twice;
        sum += twice * (w[0] - o + w[1] - o) / 3.0;
    }
    (area > 0.0).then(|| o + sum / area)
}
