//! Parts that are one solid in several places are made alike, so that one mold serves them; a mirror image is another.

use super::*;

type Cells = [[usize; 3]; 4];

/// Four cubes each, apart from one another.
fn tetracubes(of: &[Cells]) -> Job {
    let owner = |x: usize, y: usize, z: usize| {
        of.get(x / 3).filter(|cells| cells.contains(&[x % 3, y, z])).map(|_| x / 3)
    };
    solids::Complex::voxels([3 * of.len(), 2, 2], 10.0, owner).job("tetracubes")
}

const SCREW: Cells = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1]];
/// A quarter turn about z.
const TURNED: Cells = [[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 1]];
/// In a mirror across x.
const MIRRORED: Cells = [[1, 0, 0], [0, 0, 0], [0, 1, 0], [0, 1, 1]];

fn same(report: &Report) -> Vec<Option<&str>> {
    report.parts.iter().map(|p| p.same_as.as_deref()).collect()
}

#[test]
fn a_turned_part_is_the_same_and_a_mirror_image_is_another() {
    let report = made(&tetracubes(&[SCREW, MIRRORED, TURNED, MIRRORED]), &recipe(0.2));
    assert_eq!(same(&report), [None, None, Some("part-0"), Some("part-1")]);
}

/// Each on the shape of the first, in its own place: every corner is where it was.
#[test]
fn a_part_on_the_shape_of_another_stays_in_its_place() {
    let job = tetracubes(&[SCREW, TURNED]);
    let united = weavelock_fab::congruent::united(&job, 1e-6);
    assert_eq!((united.parts[0].shape, united.parts[1].shape, united.faults()), (0, 0, vec![]));
    assert!((united.parts[1].pose.matrix3.determinant() - 1.0).abs() < 1e-12);
    let corners = |job: &Job| -> Vec<[i64; 3]> {
        let part = &job.parts[1];
        let place = |v: &DVec3| part.pose.transform_point3(*v).to_array().map(|x| (x * 1e6).round() as i64);
        let mut all: Vec<_> = job.shapes[part.shape].vertices.iter().map(place).collect();
        all.sort_unstable();
        all
    };
    assert_eq!(corners(&job), corners(&united));
}

/// The ends of a row touch on opposite faces: turned, they are one; the middle touches on both.
#[test]
fn what_is_contact_tells_equal_shapes_apart_and_is_turned_with_them() {
    let row = solids::Complex::voxels([3, 1, 1], 10.0, |x, _, _| Some(x)).job("row");
    assert_eq!(same(&all_is_well(&row, 0.2)), [None, None, Some("part-0")]);
}

/// What f32 can not tell apart is the same; a hundredth of a millimetre is not.
#[test]
fn parts_that_differ_really_stay_apart() {
    for (off, expected) in [(1e-8, Some("part-0")), (0.01, None)] {
        let mut job = tetracubes(&[SCREW, TURNED]);
        let high = job.shapes[1].vertices.iter().map(|v| v.z).fold(f64::MIN, f64::max);
        job.shapes[1].vertices.iter_mut().filter(|v| v.z == high).for_each(|v| v.z += off);
        assert_eq!(same(&made(&job, &recipe(0.2)))[1], expected, "{off}");
    }
}

/// The tiles of a plain window are one solid, and stay so where bodies had to be parted: what one gives way by, all do.
#[test]
fn tiles_that_are_one_solid_stay_one_through_clearance() {
    let two = woven("[1, 1, 1]", "wefts = 2\nwarps = 2\ncut = \"window\"", 6, 0.6);
    let report = all_is_well(&two, 0.2);
    assert_eq!(same(&report), [None, Some("weft-0"), Some("weft-0"), Some("weft-0")]);
    let four = woven("[1, 1, 1]", "wefts = 4\nwarps = 4\ncut = \"window\"", 6, 0.6);
    let report = all_is_well(&four, 0.2);
    let (edge, inner) = (Some("weft-0"), Some("weft-1"));
    assert_eq!(same(&report), [None, None, inner, edge, edge, inner, inner, edge]);
}
