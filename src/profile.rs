//! Takes a weave and the profile of its strands; gives each strand's centreline, one crossing at a time.
//!
//! A centreline is a degree-1 curve in the strand's own plane: u runs along the strand in crossings, z is height.
//! Over is `lift`, under is 0 (DESIGN.md; paper, sections 3 and 4.1). Not promised: that curves of two strands stay
//! apart; `sites` refuses sites that coincide.

use crate::spec::{ProfileSpec, Shape};
use crate::weave::{Draft, Kind, Strand, Weave};

/// A degree-1 curve: points (u, z), u never decreasing.
pub type Curve = Vec<[f64; 2]>;

/// The centreline of `strand` over one crossing, u from 0 to 1, from the cut before it to the cut after it. A cut
/// lies where the curve passes the boundary between crossings, halfway along a vertical run.
pub fn over_crossing(weave: &Weave, profile: &ProfileSpec, strand: Strand, crossing: i32) -> Curve {
    match &profile.shape {
        Shape::Rise(rise) => ramped(&weave.draft, strand, crossing, *rise, profile.lift),
        Shape::Points(points) => drawn(&weave.draft, strand, crossing, points, profile.lift),
    }
}

fn ramped(draft: &Draft, strand: Strand, crossing: i32, rise: f64, lift: f64) -> Curve {
    let height = |c| if draft.is_over(strand, c) { lift } else { 0.0 };
    let [before, here, after] = [crossing - 1, crossing, crossing + 1].map(height);
    let mut curve = vec![[0.0, (before + here) / 2.0]];
    if before != here {
        curve.push([rise / 2.0, here]);
    }
    if after != here {
        curve.push([1.0 - rise / 2.0, here]);
    }
    curve.push([1.0, (here + after) / 2.0]);
    curve
}

/// Own control points describe a weft from the place where it rises; a warp is the weft turned about the diagonal,
/// so its curve is `lift - z` from the place where it sinks.
fn drawn(draft: &Draft, strand: Strand, crossing: i32, points: &[[f64; 2]], lift: f64) -> Curve {
    let mirror = strand.kind == Kind::Warp;
    let rises = |c: i32| draft.is_over(strand, c) != mirror && draft.is_over(strand, c - 1) == mirror;
    let start = (0..).map(|back| crossing - back).take(period(draft, strand)).find(|&c| rises(c));
    let from = f64::from(crossing - start.unwrap_or(0));
    let line = Line::periodic(points);
    let mut curve = line.between(line.cut(from), line.cut(from + 1.0));
    for p in &mut curve {
        *p = [(p[0] - from).clamp(0.0, 1.0), if mirror { lift - p[1] } else { p[1] }];
    }
    curve
}

fn period(draft: &Draft, strand: Strand) -> usize {
    match strand.kind {
        Kind::Weft => draft.warps() as usize,
        Kind::Warp => draft.wefts() as usize,
    }
}

/// A curve with the length from its start to each of its points.
pub struct Line {
    points: Curve,
    length: Vec<f64>,
}

impl Line {
    pub fn new(points: Curve) -> Line {
        let mut length = vec![0.0];
        for w in points.windows(2) {
            length.push(length[length.len() - 1] + (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
        }
        Line { points, length }
    }

    /// Enough periods of `points` to cover u from 0 to two periods, with the same corners in each.
    fn periodic(points: &[[f64; 2]]) -> Line {
        let period = points[points.len() - 1][0] - points[0][0];
        let first = -(points[0][0] / period).ceil() - 1.0;
        let copies = (0..5).flat_map(|k| {
            let by = (first + f64::from(k)) * period;
            points[..points.len() - 1].iter().map(move |p| [p[0] + by, p[1]])
        });
        Line::new(copies.collect())
    }

    pub fn total(&self) -> f64 {
        self.length[self.length.len() - 1]
    }

    /// Number of the straight stretch that holds the point at length `s`, from 0.
    pub fn stretch(&self, s: f64) -> usize {
        self.length.partition_point(|&l| l <= s).clamp(1, self.length.len() - 1) - 1
    }

    /// Unit vector along a stretch; zero where the stretch has no length.
    pub fn direction(&self, stretch: usize) -> [f64; 2] {
        let (p, q) = (self.points[stretch], self.points[stretch + 1]);
        let length = self.length[stretch + 1] - self.length[stretch];
        [0, 1].map(|d| if length > 0.0 { (q[d] - p[d]) / length } else { 0.0 })
    }

    /// The point at length `s` from the start.
    pub fn at(&self, s: f64) -> [f64; 2] {
        let k = self.stretch(s);
        let (d, past) = (self.direction(k), s - self.length[k]);
        [0, 1].map(|c| self.points[k][c] + past * d[c])
    }

    /// Length at which the curve passes u, halfway along a vertical run there.
    pub fn cut(&self, u: f64) -> f64 {
        let first = self.points.partition_point(|p| p[0] < u);
        let last = self.points.partition_point(|p| p[0] <= u);
        if first < last {
            return (self.length[first] + self.length[last - 1]) / 2.0;
        }
        let (p, q) = (self.points[first - 1], self.points[first]);
        self.length[first - 1] + (u - p[0]) / (q[0] - p[0]) * (self.length[first] - self.length[first - 1])
    }

    /// The curve between two lengths, with the bends between them.
    pub fn between(&self, from: f64, to: f64) -> Curve {
        let inner = self.points.iter().zip(&self.length).filter(|(_, l)| **l > from && **l < to);
        let mut curve = vec![self.at(from)];
        curve.extend(inner.map(|(p, _)| *p));
        curve.push(self.at(to));
        curve
    }
}
