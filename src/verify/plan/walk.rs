//! Takes one move, says whether it is clear at its end where it claims to be, and overlaps nothing on its way.
//!
//! Straight against straight: the exact program over the whole way. Where something turns: stretches with a plane each.
//! Both without sampling; see `way` and `sweep` for what is promised.

use super::apart::{parted, slab};
use super::book::Move;
use super::sweep::{Keep, Moving, Swept, box_over, swept};
use super::turn::{Path, Span};
use super::way::{Ball, Way, by_faces, by_program, gap};
use super::{Checked, Parts, Placed, Scene, box_of, placed, refuse, unsolved};
use crate::assembly::PartIx;
use crate::sequence::Ends;
use glam::DVec3;
use std::borrow::Cow;

/// Turns are looked at in stretches of at most this many radians (a quarter): boxes around longer arcs are too wide to
/// tell cells apart. It only affects the cost.
const MOST_ARC: f64 = 0.25;

const OVERLAP: &str = "the parts overlap on the way";
const TOO_NEAR: &str = "the parts come nearer than the plan says";

/// A cell where the move starts, and the box around its places over a stretch.
type Boxed = (Placed, (DVec3, DVec3));

/// A part over a stretch of a move that turns.
#[derive(Clone, Copy)]
struct Over<'m> {
    part: PartIx,
    cells: &'m [Boxed],
    path: &'m Path,
}

/// Two groups of a move: parts that go along the same path.
#[derive(Clone, Copy)]
struct Sides<'m> {
    a: &'m Parts,
    b: &'m Parts,
    paths: (Path, Path),
}

impl Scene<'_> {
    pub(super) fn walk(&self, step: usize, m: &Move) -> Checked {
        let mut groups: Vec<(&Parts, Path)> = m.movers.iter().map(|(parts, path)| (parts, *path)).collect();
        groups.push((&m.stays, Path::STILL));
        let mut deepest = 0.0f64;
        for (k, &(a, path)) in groups.iter().enumerate() {
            for &(b, other) in &groups[k + 1..] {
                let sides = Sides { a, b, paths: (path, other) };
                match self.pass(step, m, sides) {
                    Checked::Valid { deepest: d, .. } => deepest = deepest.max(d),
                    bad => return bad,
                }
            }
        }
        Checked::Valid { clear: m.clear, deepest }
    }

    fn pass(&self, step: usize, m: &Move, sides: Sides) -> Checked {
        let short = if m.ends == Ends::Apart { self.short_of_clear(m, sides) } else { 0.0 };
        if short > self.tolerance {
            let why = "at its end the move is not clear of the rest";
            return refuse(step, &self.names(sides.a.iter().copied()), short, 1.0, why);
        }
        let (p, q) = sides.paths;
        if p.turns() || q.turns() { self.turns(step, m, sides) } else { self.slides(step, m, sides) }
    }

    fn names(&self, parts: impl Iterator<Item = PartIx>) -> Vec<String> {
        parts.map(|p| self.asm.part(p).id.clone()).collect()
    }

    /// The cells of a part where the move starts.
    fn start(&self, p: PartIx, m: &Move) -> Cow<'_, [Placed]> {
        match m.from.get(&p) {
            Some(pose) => self.cells[&p].iter().map(|c| placed(c.cell.moved(pose))).collect(),
            None => Cow::Borrowed(&self.cells[&p]),
        }
    }

    /// Both go straight: the way of the first as the second sees it.
    fn slides(&self, step: usize, m: &Move, sides: Sides) -> Checked {
        let run = sides.paths.0.slide - sides.paths.1.slide;
        let length = run.length();
        let way = Way { direction: run.try_normalize().unwrap_or(DVec3::Z), length };
        let all = |parts: &Parts| parts.iter().map(|&p| (p, self.start(p, m))).collect::<Vec<_>>();
        let (moving, still) = (all(sides.a), all(sides.b));
        let mut deepest = 0.0f64;
        for ((a, xs), (b, ys)) in moving.iter().flat_map(|x| still.iter().map(move |y| (x, y))) {
            for (x, y) in close(xs, ys, way, self.tolerance.max(m.clear)) {
                let Some(ball) = self.ball(x, y, way) else { return unsolved(step) };
                let (both, at) = ([*a, *b], ball.at);
                if ball.radius > self.tolerance {
                    let names = self.names(both.into_iter());
                    return refuse(step, &names, ball.radius, at, OVERLAP);
                }
                deepest = deepest.max(ball.radius);
                if m.clear > self.tolerance && -2.0 * ball.radius < m.clear {
                    let Some(gap) = gap(&x.cell, &y.cell, way) else { return unsolved(step) };
                    if gap.distance < m.clear - self.tolerance {
                        let names = self.names(both.into_iter());
                        return refuse(step, &names, 0.0, gap.at, TOO_NEAR);
                    }
                }
            }
        }
        Checked::Valid { clear: m.clear, deepest }
    }

    fn ball(&self, x: &Placed, y: &Placed, way: Way) -> Option<Ball> {
        let radius = by_faces(&x.cell, &y.cell, way);
        if radius <= self.tolerance {
            return Some(Ball { radius, at: 0.0 });
        }
        by_program(&x.cell, &y.cell, way)
    }

    fn turns(&self, step: usize, m: &Move, sides: Sides) -> Checked {
        let (p, q) = sides.paths;
        let tolerance = self.tolerance;
        let distance = if m.clear > tolerance { m.clear - tolerance } else { -2.0 * tolerance };
        let keep = Keep { distance, tolerance };
        let arcs = ((p.angle.abs() + q.angle.abs()) / MOST_ARC).ceil().max(1.0);
        for span in (0..arcs as usize).map(|k| Span { from: k as f64 / arcs, to: (k as f64 + 1.0) / arcs }) {
            for &a in sides.a {
                let xs = self.over(a, m, &p, span);
                for &b in sides.b {
                    let ys = self.over(b, m, &q, span);
                    let (x, y) =
                        (Over { part: a, cells: &xs, path: &p }, Over { part: b, cells: &ys, path: &q });
                    if let Some(bad) = self.arc(step, x, y, span, keep) {
                        return bad;
                    }
                }
            }
        }
        Checked::Valid { clear: m.clear, deepest: 0.0 }
    }

    /// The cells of a part with their boxes over the stretch, and the box around all.
    fn over(&self, p: PartIx, m: &Move, path: &Path, span: Span) -> Vec<Boxed> {
        let boxed = |c: Placed| {
            let b = box_over(Moving { cell: &c, path }, span);
            (c, b)
        };
        self.start(p, m).into_owned().into_iter().map(boxed).collect()
    }

    fn arc(&self, step: usize, x: Over, y: Over, span: Span, keep: Keep) -> Option<Checked> {
        let margin = keep.distance.max(0.0);
        let meet =
            |a: &(DVec3, DVec3), b: &(DVec3, DVec3)| (a.0 - b.1).max(b.0 - a.1).max_element() <= margin;
        let whole = |cells: &[Boxed]| {
            let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            cells.iter().fold(start, |(l, h), (_, b)| (l.min(b.0), h.max(b.1)))
        };
        let (all_x, all_y) = (whole(x.cells), whole(y.cells));
        if !meet(&all_x, &all_y) {
            return None;
        }
        for (a, around) in x.cells.iter().filter(|a| meet(&a.1, &all_y)) {
            for (b, _) in y.cells.iter().filter(|b| meet(around, &b.1)) {
                let pair = (Moving { cell: a, path: x.path }, Moving { cell: b, path: y.path });
                let names = || self.names([x.part, y.part].into_iter());
                match swept(pair.0, pair.1, span, keep) {
                    Swept::Kept => {}
                    Swept::Broken { radius, at } => {
                        let overlap = radius > keep.tolerance;
                        let why = if overlap { OVERLAP } else { TOO_NEAR };
                        return Some(refuse(step, &names(), radius, at, why));
                    }
                    Swept::Undecided => return Some(undecided(step, &names())),
                }
            }
        }
        None
    }

    /// How much is missing until a plane parts the two sides at the end of the move.
    fn short_of_clear(&self, m: &Move, sides: Sides) -> f64 {
        let corners = |parts: &Parts, path: &Path| -> Vec<DVec3> {
            let end = path.at(1.0);
            let cells = parts.iter().flat_map(|&p| self.start(p, m).into_owned());
            cells.flat_map(|c| c.cell.vertices).map(|v| end.transform_point3(v)).collect()
        };
        let (a, b) = (corners(sides.a, &sides.paths.0), corners(sides.b, &sides.paths.1));
        let run = sides.paths.0.slide - sides.paths.1.slide;
        let along = run.try_normalize().map_or(f64::INFINITY, |d| -slab(&a, &b, d));
        if along <= self.tolerance {
            return along;
        }
        // Another plane may part them: where something turned, or was clear before.
        match parted(&a, &b) {
            Some(_) => 0.0,
            None => along,
        }
    }
}

fn undecided(step: usize, parts: &[String]) -> Checked {
    let parts = parts.join(" and ");
    Checked::Undecided {
        why: format!("step {}: {parts} turn so closely that no plane between them was found", step + 1),
    }
}

/// Pairs of cells whose boxes come within `margin` on the way.
fn close<'c>(
    xs: &'c [Placed],
    ys: &'c [Placed],
    way: Way,
    margin: f64,
) -> impl Iterator<Item = (&'c Placed, &'c Placed)> {
    let run = way.direction * way.length;
    let meets = move |(alo, ahi): (DVec3, DVec3), (blo, bhi): (DVec3, DVec3)| {
        let (alo, ahi) = (alo.min(alo + run) - margin, ahi.max(ahi + run) + margin);
        alo.cmple(bhi).all() && blo.cmple(ahi).all()
    };
    let (whole, open) = (box_of(ys), meets(box_of(xs), box_of(ys)));
    let xs = xs.iter().filter(move |x| open && meets((x.lo, x.hi), whole));
    xs.flat_map(move |x| ys.iter().filter(move |y| meets((x.lo, x.hi), (y.lo, y.hi))).map(move |y| (x, y)))
}
