//! Takes a weave and its profile; gives the nearest point of a strand's centreline to a point in space.
//!
//! Exact up to round-off: a centreline is a chain of straight stretches, and every one that can be nearest is tried.

use crate::profile::over_crossing;
use crate::spec::ProfileSpec;
use crate::weave::{Kind, Strand, Weave};
use glam::DVec3;

/// The centrelines of all strands, one crossing at a time, as they repeat.
pub struct Curves {
    wefts: Vec<Vec<Vec<[f64; 2]>>>,
    warps: Vec<Vec<Vec<[f64; 2]>>>,
}

/// The nearest point of a centreline.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    pub at: DVec3,
    pub distance: f64,
}

impl Curves {
    pub fn new(weave: &Weave, profile: &ProfileSpec) -> Curves {
        let (warps, wefts) = (weave.draft.warps() as i32, weave.draft.wefts() as i32);
        let all = |kind, strands: i32, crossings: i32| {
            let strand = |index| {
                (0..crossings).map(|c| over_crossing(weave, profile, Strand { kind, index }, c)).collect()
            };
            (0..strands).map(strand).collect()
        };
        Curves { wefts: all(Kind::Weft, wefts, warps), warps: all(Kind::Warp, warps, wefts) }
    }

    fn over(&self, strand: Strand, crossing: i32) -> &[[f64; 2]] {
        let all = if strand.kind == Kind::Weft { &self.wefts } else { &self.warps };
        let of = &all[strand.index.rem_euclid(all.len() as i32) as usize];
        &of[crossing.rem_euclid(of.len() as i32) as usize]
    }

    /// Where the strand enters a crossing, and its direction there.
    pub fn cut(&self, strand: Strand, crossing: i32) -> (DVec3, DVec3) {
        let curve = self.over(strand, crossing);
        let at = |k: usize| place(strand, f64::from(crossing), curve[k]);
        (at(0), (at(1) - at(0)).normalize_or_zero())
    }

    /// The nearest point on the crossings `from` up to but not including `to`; none where there are none.
    pub fn nearest(&self, strand: Strand, (from, to): (i32, i32), p: DVec3) -> Option<Foot> {
        let along = if strand.kind == Kind::Weft { p.x } else { p.y };
        let home = (along.floor() as i32).clamp(from, to.checked_sub(1)?);
        let mut best = self.on(strand, home, p);
        // A point of a crossing k away is farther than the crossings between.
        for k in 1.. {
            let tried = [home - k, home + k].into_iter().filter(|c| (from..to).contains(c));
            let near = tried.filter(|&c| f64::from((c - home).abs() - 1) < best.distance + 1.0);
            let found: Vec<Foot> = near.map(|c| self.on(strand, c, p)).collect();
            if found.is_empty() {
                break;
            }
            best = found.into_iter().chain([best]).min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        }
        Some(best)
    }

    fn on(&self, strand: Strand, crossing: i32, p: DVec3) -> Foot {
        let curve = self.over(strand, crossing);
        let foot = |w: &[[f64; 2]]| {
            let [a, b] = [w[0], w[1]].map(|q| place(strand, f64::from(crossing), q));
            let d = b - a;
            let share =
                if d == DVec3::ZERO { 0.0 } else { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) };
            let at = a + d * share;
            Foot { at, distance: p.distance(at) }
        };
        let none = Foot { at: DVec3::ZERO, distance: f64::INFINITY };
        curve.windows(2).map(foot).fold(none, |a, b| if b.distance < a.distance { b } else { a })
    }
}

fn place(strand: Strand, crossing: f64, [u, z]: [f64; 2]) -> DVec3 {
    let across = f64::from(strand.index) + 0.5;
    match strand.kind {
        Kind::Weft => DVec3::new(crossing + u, across, z),
        Kind::Warp => DVec3::new(across, crossing + u, z),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{Bounds, Shape};

    #[test]
    fn the_nearest_point_of_a_plain_weft() {
        let weave = Weave::abc(1, 1, 1).unwrap();
        let profile = ProfileSpec {
            shape: Shape::Rise(0.6),
            lift: 1.0,
            cover: 1.0,
            samples: 8,
            bounds: Bounds::Sandwich,
        };
        let curves = Curves::new(&weave, &profile);
        let weft = Strand { kind: Kind::Weft, index: 0 };
        // Over warp 0: level at height 1 from u = 0.3 to 0.7.
        let above = curves.nearest(weft, (-5, 5), DVec3::new(0.5, 0.5, 1.7)).unwrap();
        let off = above.at.distance(DVec3::new(0.5, 0.5, 1.0)) + (above.distance - 0.7).abs();
        assert!(off < 1e-12, "{above:?}");
        // Straight above the middle of a ramp the foot lies on the ramp, nearer than its height.
        let side = curves.nearest(weft, (-5, 5), DVec3::new(1.0, 0.5, 1.0)).unwrap();
        assert!((side.distance - 0.5 * 0.6 / 1.36_f64.sqrt()).abs() < 1e-12, "{side:?}");
        // Kept to a stretch that ends before, the foot is the end.
        let end = curves.nearest(weft, (-5, -1), DVec3::new(1.0, 0.5, 1.0)).unwrap();
        assert!((end.at.x + 1.0).abs() < 1e-12, "{end:?}");
    }
}
