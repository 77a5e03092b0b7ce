//! Takes points; gives a tree that tells how far they reach along a normal without asking each of them.
//!
//! Exact: what is skipped lies in a box that does not reach as far as a point already seen.

use super::polytope::{Plane, height};
use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode, TraversalAction};

pub(super) struct Reach<'a> {
    points: &'a [DVec3],
    tree: Bvh,
}

impl<'a> Reach<'a> {
    pub fn of(points: &'a [DVec3]) -> Reach<'a> {
        let boxes: Vec<Aabb> = points.iter().map(|&p| Aabb::new(p, p)).collect();
        Reach { points, tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes) }
    }

    /// Whether some point stands higher than `width` above the plane.
    pub fn beyond(&self, plane: Plane, width: f64) -> bool {
        let above = |node: &BvhNode| highest(node, plane) > width;
        self.tree.leaves(above).any(|i| height(plane, self.points[i as usize]) > width)
    }

    /// Height of the highest point above the plane.
    pub fn above(&self, plane: Plane) -> f64 {
        let mut best = f64::NEG_INFINITY;
        self.tree.traverse(|node| {
            if highest(node, plane) <= best {
                return TraversalAction::Prune;
            }
            if let Some(i) = node.leaf_data() {
                best = best.max(height(plane, self.points[i as usize]));
            }
            TraversalAction::Continue
        });
        best
    }
}

/// Height of the box's corner that reaches farthest. Monotone in every coordinate, rounding too, and summed as
/// [`height`] sums: never below that of a point in the box.
fn highest(node: &BvhNode, plane: Plane) -> f64 {
    let (lo, hi) = (node.mins(), node.maxs());
    let pick = |k: usize| if plane.0[k] < 0.0 { lo[k] } else { hi[k] };
    height(plane, DVec3::new(pick(0), pick(1), pick(2)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_reaches_as_far_as_all_its_points() {
        let at = |k: u32| DVec3::new(f64::from(k % 17), f64::from(k % 29) * 0.7, f64::from(k % 13) - 5.0);
        let points: Vec<DVec3> = (0..500).map(at).collect();
        let reach = Reach::of(&points);
        for n in [
            DVec3::X,
            -DVec3::Z,
            DVec3::new(1.0, -2.0, 0.3).normalize(),
            DVec3::new(-0.2, 0.1, 0.9).normalize(),
        ] {
            let plane = (n, 1.5);
            let all = points.iter().map(|&p| height(plane, p)).fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(reach.above(plane), all);
            assert!(reach.beyond(plane, all - 1e-9) && !reach.beyond(plane, all));
        }
    }
}
