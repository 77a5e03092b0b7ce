//! Takes an assembly and a direction, gives the shadow of every convex cell: its outline in the plane across the
//! direction and its extent along it. Parts that differ by a translation share theirs.
//!
//! Not promised: outlines are exact only to round-off, and a corner nearer than that to an edge may be left out.

use crate::assembly::{Assembly, PartIx};
use glam::{DMat3, DVec2, DVec3};
use std::collections::BTreeMap;
use std::sync::OnceLock;

/// A convex cell turned as its part is turned, not yet moved to its place.
#[derive(Clone, Debug)]
pub struct Convex {
    pub vertices: Vec<DVec3>,
    /// Inside is `n . x <= c`.
    pub planes: Vec<(DVec3, f64)>,
}

/// The cells of all parts: one list for each solid and orientation, and for each part which list and where it is.
#[derive(Clone, Debug)]
pub struct Shapes {
    turned: Vec<Vec<Convex>>,
    place: Vec<(usize, DVec3)>,
}

impl Shapes {
    pub fn of(asm: &Assembly) -> Shapes {
        let mut known = BTreeMap::new();
        let mut turned = Vec::new();
        let place = asm
            .parts
            .iter()
            .map(|part| {
                let m: DMat3 = part.pose.matrix3;
                let key = (part.solid, m.to_cols_array().map(f64::to_bits));
                let at = *known.entry(key).or_insert_with(|| {
                    turned.push(asm.solids[part.solid].cells.iter().map(|c| turn(c, m)).collect());
                    turned.len() - 1
                });
                (at, part.pose.translation)
            })
            .collect();
        Shapes { turned, place }
    }

    /// The part's cells (turned, not moved) and the translation that puts them in place.
    pub fn part(&self, p: PartIx) -> (&[Convex], DVec3) {
        let (shape, offset) = self.place[p.at()];
        (&self.turned[shape], offset)
    }
}

impl Shapes {
    /// The number of the part's solid in its orientation: parts of one number differ by a translation.
    pub fn shape(&self, p: PartIx) -> usize {
        self.place[p.at()].0
    }
}

fn turn(cell: &crate::solid::Cell, m: DMat3) -> Convex {
    Convex {
        vertices: cell.vertices.iter().map(|&v| m * v).collect(),
        planes: cell.planes.iter().map(|&(n, c)| (m * n, c)).collect(),
    }
}

/// A box in (u, v, along d).
#[derive(Clone, Copy, Debug)]
pub struct Span {
    pub lo: DVec3,
    pub hi: DVec3,
}

impl Span {
    const NOTHING: Span = Span { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY };

    fn join(self, o: Span) -> Span {
        Span { lo: self.lo.min(o.lo), hi: self.hi.max(o.hi) }
    }

    pub fn shift(self, by: DVec3) -> Span {
        Span { lo: self.lo + by, hi: self.hi + by }
    }
}

/// A convex polygon, counter-clockwise, and for each side from corner k to k + 1 its unit outward normal `n` and offset
/// `c`: inside is `n . x <= c`.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    pub corners: Vec<DVec2>,
    pub sides: Vec<(DVec2, f64)>,
}

impl Outline {
    fn around(points: Vec<DVec2>) -> Outline {
        let corners = hull(points);
        let side = |k: usize| {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            let n = -(b - a).perp().normalize_or_zero();
            (n, n.dot(a))
        };
        Outline { sides: (0..corners.len()).map(side).collect(), corners }
    }
}

/// The cells of one solid in one orientation seen along the direction. Outlines are made when first asked for.
#[derive(Debug)]
pub struct Shadows {
    pub spans: Vec<Span>,
    /// Around all cells.
    pub whole: Span,
    outlines: Vec<OnceLock<Outline>>,
}

/// An assembly seen along one direction. Shadows are made when first asked for.
#[derive(Debug)]
pub struct View<'a> {
    pub shapes: &'a Shapes,
    /// Unit direction of motion.
    pub d: DVec3,
    /// Rows u, v, d: from the world to (u, v, along d).
    frame: DMat3,
    made: Vec<OnceLock<Shadows>>,
}

impl<'a> View<'a> {
    /// `d` must be a unit vector.
    pub fn new(shapes: &'a Shapes, d: DVec3) -> View<'a> {
        let (u, v) = d.any_orthonormal_pair();
        let frame = DMat3::from_cols(u, v, d).transpose();
        View { shapes, d, frame, made: shapes.turned.iter().map(|_| OnceLock::new()).collect() }
    }

    /// The part's shadows and their offset in (u, v, along d).
    pub fn part(&self, p: PartIx) -> (&Shadows, DVec3) {
        let (shape, offset) = self.shapes.place[p.at()];
        let shadows = self.made[shape].get_or_init(|| shadows(&self.shapes.turned[shape], &self.frame));
        (shadows, self.frame * offset)
    }

    /// Outline of one cell before its part's offset.
    pub fn outline(&self, p: PartIx, cell: usize) -> &Outline {
        let (cells, _) = self.shapes.part(p);
        let seen = || cells[cell].vertices.iter().map(|&v| (self.frame * v).truncate()).collect();
        self.part(p).0.outlines[cell].get_or_init(|| Outline::around(seen()))
    }

    /// Box of the part in (u, v, along d).
    pub fn span(&self, p: PartIx) -> Span {
        let (shadows, offset) = self.part(p);
        shadows.whole.shift(offset)
    }

    /// Back from (u, v, along d) to the world.
    pub fn world(&self, p: DVec3) -> DVec3 {
        self.frame.transpose() * p
    }
}

fn shadows(cells: &[Convex], frame: &DMat3) -> Shadows {
    let span = |c: &Convex| {
        let (lo, hi) = super::bounds(c.vertices.iter().map(|&v| *frame * v));
        Span { lo, hi }
    };
    let spans: Vec<Span> = cells.iter().map(span).collect();
    let whole = spans.iter().fold(Span::NOTHING, |s, &c| s.join(c));
    Shadows { whole, outlines: spans.iter().map(|_| OnceLock::new()).collect(), spans }
}

/// Convex hull of points in the plane, counter-clockwise, without corners on its edges (Andrew's monotone chain).
pub fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut out = chain(points.iter().copied());
    let upper = chain(points.iter().rev().copied());
    out.pop();
    out.extend_from_slice(&upper[..upper.len() - 1]);
    out
}

fn chain(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::new();
    for p in points {
        while out.len() >= 2
            && (out[out.len() - 1] - out[out.len() - 2]).perp_dot(p - out[out.len() - 1]) <= 0.0
        {
            out.pop();
        }
        out.push(p);
    }
    out
}
