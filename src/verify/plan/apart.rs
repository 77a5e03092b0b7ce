//! Takes two sets of points, gives how far a plane between them keeps them apart, if one is found.
//!
//! Sound: the plane is measured on every point. Complete up to the solver: sets that a plane parts by less than about
//! a millionth of their size may be called not parted.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT};
use glam::DVec3;

/// Width of the widest slab found between the two sets, model units; None where no plane was found.
pub fn parted(a: &[DVec3], b: &[DVec3]) -> Option<f64> {
    let all = || a.iter().chain(b);
    let (lo, hi) = all().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(*p), h.max(*p)));
    let (middle, size) = ((lo + hi) / 2.0, (hi - lo).length());
    // The least |n| with n . p - c >= 1 for a and <= -1 for b, coordinates scaled to 1.
    let row = |p: &DVec3, sign: f64| {
        let q = (*p - middle) * (sign / size);
        [q.x, q.y, q.z, -sign]
    };
    let rows: Vec<[f64; 4]> = a.iter().map(|p| row(p, -1.0)).chain(b.iter().map(|p| row(p, 1.0))).collect();
    let limits = vec![-1.0; rows.len()];
    let square: Vec<[f64; 4]> =
        (0..4).map(|i| std::array::from_fn(|j| f64::from(u8::from(i == j && i < 3)))).collect();
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(limits.len())];
    let (p, rows) = (CscMatrix::from(&square), CscMatrix::from(&rows));
    let mut solver = DefaultSolver::new(&p, &[0.0; 4], &rows, &limits, &cones, settings).ok()?;
    solver.solve();
    let x = &solver.solution.x;
    let normal = DVec3::new(x[0], x[1], x[2]).try_normalize()?;
    let width = slab(a, b, normal);
    (width > 0.0).then_some(width)
}

/// How far `a` lies beyond `b` along a unit normal; negative where they overlap.
pub fn slab(a: &[DVec3], b: &[DVec3], normal: DVec3) -> f64 {
    let least = a.iter().map(|p| normal.dot(*p)).fold(f64::INFINITY, f64::min);
    let most = b.iter().map(|p| normal.dot(*p)).fold(f64::NEG_INFINITY, f64::max);
    least - most
}
