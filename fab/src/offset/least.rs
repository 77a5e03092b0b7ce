//! Takes half-spaces and a point; gives the nearest point in all of them.
//!
//! Complete up to `slack`: `None` means that no point of the kinds tried (corners, edges and faces of the arrangement)
//! satisfies all of them within `slack`. Not promised: that the answer moves little when the planes do.

use glam::DVec3;

/// A half-space: its points have `normal . x <= offset`. Unit normal, offset in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    pub normal: DVec3,
    pub offset: f64,
}

impl HalfSpace {
    /// How far `x` stands out of the half-space, in mm; negative inside.
    pub fn excess(&self, x: DVec3) -> f64 {
        self.normal.dot(x) - self.offset
    }
}

/// The point nearest to `from` on all planes of `on` and inside all half-spaces of `within`, to `slack` mm.
///
/// Grows a set of binding half-spaces by the worst offender until none is left. Each round adds one that the last
/// answer violated, so it ends; within the set, the optimum binds at most three planes, and every choice is tried.
pub fn nearest(from: DVec3, on: &[HalfSpace], within: &[HalfSpace], slack: f64) -> Option<DVec3> {
    let mut binding: Vec<HalfSpace> = Vec::new();
    loop {
        let x = nearest_by_choice(from, on, &binding, slack)?;
        let worst = within.iter().max_by(|a, b| a.excess(x).total_cmp(&b.excess(x)));
        match worst {
            Some(w) if w.excess(x) > slack => binding.push(*w),
            _ => return Some(x),
        }
    }
}

/// Tries every choice of planes that could bind; any feasible candidate is at least as far as the optimum, which is
/// one of them, so the nearest feasible candidate is the optimum.
fn nearest_by_choice(from: DVec3, on: &[HalfSpace], within: &[HalfSpace], slack: f64) -> Option<DVec3> {
    let mut best: Option<(f64, DVec3)> = None;
    let mut consider = |rows: &[HalfSpace]| {
        let Some(x) = onto(from, rows) else { return };
        let feasible =
            within.iter().all(|h| h.excess(x) <= slack) && on.iter().all(|h| h.excess(x).abs() <= slack);
        let far = x.distance_squared(from);
        if feasible && best.is_none_or(|(d, _)| far < d) {
            best = Some((far, x));
        }
    };
    for_each_choice(on, within, &mut consider);
    best.map(|(_, x)| x)
}

/// Calls `f` with `on` and every choice of `within` that makes at most three planes together.
fn for_each_choice(on: &[HalfSpace], within: &[HalfSpace], f: &mut impl FnMut(&[HalfSpace])) {
    let mut rows = on.to_vec();
    f(&rows);
    extend_choice(&mut rows, within, f);
}

fn extend_choice(rows: &mut Vec<HalfSpace>, within: &[HalfSpace], f: &mut impl FnMut(&[HalfSpace])) {
    if rows.len() >= 3 {
        return;
    }
    for (k, &h) in within.iter().enumerate() {
        rows.push(h);
        f(rows);
        extend_choice(rows, &within[k + 1..], f);
        rows.pop();
    }
}

/// The point nearest to `from` on all of up to three planes; `None` where they are parallel.
fn onto(from: DVec3, rows: &[HalfSpace]) -> Option<DVec3> {
    let lack = |h: &HalfSpace| -h.excess(from);
    let step = match rows {
        [] => DVec3::ZERO,
        [a] => a.normal * lack(a),
        [a, b] => {
            let (c, p, q) = (a.normal.dot(b.normal), lack(a), lack(b));
            let det = a.normal.cross(b.normal).length_squared();
            (a.normal * (p - c * q) + b.normal * (q - c * p)) / det
        }
        [a, b, c] => {
            let (bc, ca, ab) = (b.normal.cross(c.normal), c.normal.cross(a.normal), a.normal.cross(b.normal));
            (bc * lack(a) + ca * lack(b) + ab * lack(c)) / a.normal.dot(bc)
        }
        _ => return None,
    };
    step.is_finite().then_some(from + step)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn below(n: [f64; 3], offset: f64) -> HalfSpace {
        HalfSpace { normal: DVec3::from_array(n).normalize(), offset }
    }

    #[test]
    fn a_corner_of_a_box_moves_along_its_diagonal() {
        let walls = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(|n| below(n, -0.2));
        let x = nearest(DVec3::ZERO, &[], &walls, 1e-12).unwrap();
        assert!(x.distance(DVec3::splat(-0.2)) < 1e-12);
    }

    #[test]
    fn equal_planes_count_once_and_slack_planes_not_at_all() {
        let walls = [below([0., 0., 1.], -0.2), below([0., 0., 1.], -0.2), below([1., 0., 0.], 5.0)];
        let x = nearest(DVec3::ZERO, &[], &walls, 1e-12).unwrap();
        assert!(x.distance(DVec3::new(0.0, 0.0, -0.2)) < 1e-12);
    }

    #[test]
    fn a_kept_plane_is_kept() {
        let x =
            nearest(DVec3::ZERO, &[below([0., 0., 1.], 0.0)], &[below([1., 0., 1.], -0.2)], 1e-12).unwrap();
        assert!(x.distance(DVec3::new(-0.2 * 2f64.sqrt(), 0.0, 0.0)) < 1e-12);
    }

    #[test]
    fn opposite_walls_leave_no_room() {
        let walls = [below([0., 0., 1.], -0.2), below([0., 0., -1.], -0.2)];
        assert_eq!(nearest(DVec3::ZERO, &[], &walls, 1e-12), None);
    }
}
