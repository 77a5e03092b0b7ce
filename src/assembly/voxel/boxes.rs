//! Takes voxels; gives boxes without a common voxel that hold all of them.
//!
//! Not promised: fewest boxes; they grow along x, then y, then z.

use std::collections::BTreeSet;

type At = [i32; 3];

/// Least corners, and corners beyond the farthest voxel.
pub fn boxes(mut left: BTreeSet<At>) -> Vec<(At, At)> {
    let mut out = Vec::new();
    while let Some(&lo) = left.first() {
        let mut hi = lo.map(|x| x + 1);
        for axis in 0..3 {
            while within(lo, hi, axis).all(|v| left.contains(&v)) {
                hi[axis] += 1;
            }
        }
        let inside: BTreeSet<At> =
            left.iter().copied().filter(|v| (0..3).all(|k| lo[k] <= v[k] && v[k] < hi[k])).collect();
        left.retain(|v| !inside.contains(v));
        out.push((lo, hi));
    }
    out
}

/// The voxels of the next layer of a box along an axis.
fn within(lo: At, hi: At, axis: usize) -> impl Iterator<Item = At> {
    let range = move |k: usize| if k == axis { hi[k]..hi[k] + 1 } else { lo[k]..hi[k] };
    range(0).flat_map(move |x| range(1).flat_map(move |y| range(2).map(move |z| [x, y, z])))
}
