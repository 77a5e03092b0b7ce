//! Takes centrelines, samples and the two sandwiching planes; gives labelled points on an integer grid.
//!
//! Sites are periodic like the draft: one list for each unit square of a period. Symmetric positions are symmetric
//! exactly, since all are multiples of 2^-20 of a crossing, and collinear ones collinear. Not promised: that the points
//! lie on the curve better than a grid step for each site since the last bend (64 sites: 6e-5 crossing), nor that the
//! cells approximate the curved ones to any given chord error.

use crate::profile::{Line, over_crossing};
use crate::spec::{Bounds, ProfileSpec};
use crate::tile::exact::{Grid, SITE_BITS};
use crate::weave::{Kind, Strand, Weave};
use std::collections::BTreeSet;

/// A site by name: the unit square that holds it and its place in that square's list. Lattice translations add to
/// `x` and `y` only.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Site {
    pub x: i32,
    pub y: i32,
    pub place: u16,
}

/// Which of the two sandwiching planes (or prism faces).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    Below,
    Above,
}

/// Who a site belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    Strand { strand: Strand, crossing: i32 },
    Plane(Side),
}

/// What limits the tiles below and above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Faces {
    /// Sites on two planes; the tiles end in parabolic cylinders (paper, figure 2).
    Sites,
    /// Two flat faces at these heights, in grid units, halfway to where the planes would be.
    Flat { below: i64, above: i64 },
}

/// The sites of a weave.
pub struct Sites {
    period: (i32, i32),
    squares: Vec<Square>,
    pub faces: Faces,
}

/// Positions relative to the square's corner: the weft's, then the warp's, then the planes'.
struct Square {
    points: Vec<Grid>,
    wefts: usize,
    strands: usize,
    below: usize,
}

/// Two sites at one point: the cells would be empty.
#[derive(Debug, thiserror::Error)]
#[error("two strands meet at x {x:.4}, y {y:.4}, z {z:.4} (in crossings): their centrelines must stay apart")]
pub struct Coincident {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

fn grid(v: f64) -> i64 {
    (v * f64::from(1 << SITE_BITS)).round() as i64
}

impl Sites {
    pub fn new(weave: &Weave, profile: &ProfileSpec) -> Result<Sites, Coincident> {
        let period = (weave.draft.warps() as i32, weave.draft.wefts() as i32);
        let mut squares = Vec::new();
        for y in 0..period.1 {
            for x in 0..period.0 {
                squares.push(square(weave, profile, x, y)?);
            }
        }
        Ok(Sites { period, squares, faces: faces(profile) })
    }

    fn square(&self, x: i32, y: i32) -> &Square {
        let (px, py) = self.period;
        &self.squares[(y.rem_euclid(py) * px + x.rem_euclid(px)) as usize]
    }

    /// Position of a site, in grid units.
    pub fn at(&self, site: Site) -> Grid {
        let p = self.square(site.x, site.y).points[usize::from(site.place)];
        [p[0] + (i64::from(site.x) << SITE_BITS), p[1] + (i64::from(site.y) << SITE_BITS), p[2]]
    }

    pub fn owner(&self, site: Site) -> Owner {
        let (square, place) = (self.square(site.x, site.y), usize::from(site.place));
        let strand = |kind, index, crossing| Owner::Strand { strand: Strand { kind, index }, crossing };
        match place {
            p if p < square.wefts => strand(Kind::Weft, site.y, site.x),
            p if p < square.strands => strand(Kind::Warp, site.x, site.y),
            p if p < square.below => Owner::Plane(Side::Below),
            _ => Owner::Plane(Side::Above),
        }
    }

    /// All sites of the unit square with its lower corner at (x, y).
    pub fn in_square(&self, x: i32, y: i32) -> impl Iterator<Item = Site> + use<> {
        (0..self.square(x, y).points.len() as u16).map(move |place| Site { x, y, place })
    }

    /// The sites of a strand at one of its crossings, in the order of its centreline.
    pub fn of_strand(&self, strand: Strand, crossing: i32) -> impl Iterator<Item = Site> + use<> {
        let (x, y) = match strand.kind {
            Kind::Weft => (crossing, strand.index),
            Kind::Warp => (strand.index, crossing),
        };
        let square = self.square(x, y);
        let places = match strand.kind {
            Kind::Weft => 0..square.wefts,
            Kind::Warp => square.wefts..square.strands,
        };
        places.map(move |place| Site { x, y, place: place as u16 })
    }
}

fn faces(profile: &ProfileSpec) -> Faces {
    match profile.bounds {
        Bounds::Sandwich => Faces::Sites,
        Bounds::Prism => Faces::Flat {
            below: -grid(profile.cover / 2.0),
            above: grid(profile.lift) + grid(profile.cover / 2.0),
        },
    }
}

fn square(weave: &Weave, profile: &ProfileSpec, x: i32, y: i32) -> Result<Square, Coincident> {
    let half = grid(0.5);
    let weft = samples(weave, profile, Strand { kind: Kind::Weft, index: y }, x);
    let warp = samples(weave, profile, Strand { kind: Kind::Warp, index: x }, y);
    let wefts = weft.len();
    let mut points: Vec<Grid> = weft.into_iter().map(|[u, z]| [u, half, z]).collect();
    points.extend(warp.into_iter().map(|[v, z]| [half, v, z]));
    let strands = points.len();
    let mut below = strands;
    if profile.bounds == Bounds::Sandwich {
        points.extend(plane(profile.samples, -grid(profile.cover)));
        below = points.len();
        points.extend(plane(profile.samples, grid(profile.lift) + grid(profile.cover)));
    }
    apart(&points)?;
    Ok(Square { points, wefts, strands, below })
}

/// Sites spaced evenly along each half of a crossing's centreline, from its cut to its middle: as many as the profile
/// asks for that length of curve, and at least one. By halves, since then a rise is sampled alike wherever it occurs:
/// cuts fall where the piece is said to end, and ties between strands that are congruent there stay exact.
fn samples(weave: &Weave, profile: &ProfileSpec, strand: Strand, crossing: i32) -> Vec<[i64; 2]> {
    let line = Line::new(over_crossing(weave, profile, strand, crossing));
    let middle = line.cut(0.5);
    let mut far = line.between(middle, line.total());
    far.reverse();
    let mut sites = spaced(&line.between(0.0, middle), profile.samples);
    let back = spaced(&far, profile.samples);
    sites.extend(back.into_iter().rev());
    sites
}

/// Sites on a curve that starts at a cut, the first half a step from there. On each straight stretch they advance by
/// one whole grid vector (twice a rounded half step), so that they stay collinear exactly, across the cut too: a
/// contact between two straight runs keeps its rulings, along which parts may slide. Level and upright stretches are
/// collinear anyway; there each site is rounded by itself.
fn spaced(curve: &[[f64; 2]], samples: u32) -> Vec<[i64; 2]> {
    let line = Line::new(curve.to_vec());
    let count = (f64::from(samples) * line.total()).round().max(1.0);
    let step = line.total() / count;
    let mut sites: Vec<[i64; 2]> = Vec::with_capacity(count as usize);
    let mut stretch = None;
    for k in 0..count as u32 {
        let s = (f64::from(k) + 0.5) * step;
        let here = line.stretch(s);
        let direction = line.direction(here);
        let half = direction.map(|d| grid(d * step / 2.0));
        let site = match (sites.last(), stretch) {
            _ if direction.contains(&0.0) => line.at(s).map(grid),
            (None, _) if here == 0 => [0, 1].map(|d| grid(curve[0][d]) + half[d]),
            (Some(last), Some(before)) if before == here => [0, 1].map(|d| last[d] + 2 * half[d]),
            _ => line.at(s).map(grid),
        };
        stretch = Some(here);
        sites.push(site);
    }
    sites
}

/// A square lattice of sites on a plane, as dense as the strands'.
fn plane(samples: u32, z: i64) -> impl Iterator<Item = Grid> {
    let at = move |k: u32| grid((f64::from(k) + 0.5) / f64::from(samples));
    (0..samples * samples).map(move |k| [at(k % samples), at(k / samples), z])
}

fn apart(points: &[Grid]) -> Result<(), Coincident> {
    let mut seen = BTreeSet::new();
    let twice = points.iter().find(|&&p| !seen.insert(p));
    let to = |v: i64| v as f64 / f64::from(1 << SITE_BITS);
    twice.map_or(Ok(()), |p| Err(Coincident { x: to(p[0]), y: to(p[1]), z: to(p[2]) }))
}
