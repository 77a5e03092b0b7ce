//! Takes what is to be printed and a bed; gives plates with a place for each, or what does not fit.
//!
//! Rows of boxes, the deepest first: simple and never overlapping. Not promised: the fewest plates.

use crate::process::Bed;
use glam::{DVec2, DVec3};
use serde::Serialize;

/// Air between two things on a bed, and to its edge, mm: room for a brim of 2.5 on each and a blade between them.
pub const SPACING: f64 = 6.0;

/// Where a thing stands: its index, and the lowest corner of its box on the bed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stand {
    #[serde(skip)]
    pub thing: usize,
    pub part: String,
    pub at: DVec3,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plates {
    pub plates: Vec<Vec<Stand>>,
    /// Things that are larger than the bed.
    pub too_large: Vec<usize>,
}

/// Arranges boxes (sizes in mm, with the ids of their parts) on as many beds as it takes.
pub fn arrange(sizes: &[(DVec3, String)], bed: &Bed) -> Plates {
    let room = DVec3::from_array(bed.size);
    let free = room.truncate() - DVec2::splat(2.0 * SPACING);
    let fits = |s: DVec3| s.x <= free.x && s.y <= free.y && s.z <= room.z;
    let (mut fitting, too_large): (Vec<usize>, Vec<usize>) =
        (0..sizes.len()).partition(|&k| fits(sizes[k].0));
    fitting.sort_by(|&a, &b| sizes[b].0.y.total_cmp(&sizes[a].0.y).then(a.cmp(&b)));
    let mut plates: Vec<Vec<Stand>> = Vec::new();
    let (mut corner, mut depth) = (DVec2::ZERO, 0.0_f64);
    for k in fitting {
        let size = sizes[k].0;
        if corner.x + size.x > free.x {
            corner = DVec2::new(0.0, corner.y + depth + SPACING);
            depth = 0.0;
        }
        if plates.is_empty() || corner.y + size.y > free.y {
            plates.push(vec![]);
            (corner, depth) = (DVec2::ZERO, 0.0);
        }
        let at = (corner + DVec2::splat(SPACING)).extend(0.0);
        if let Some(plate) = plates.last_mut() {
            plate.push(Stand { thing: k, part: sizes[k].1.clone(), at });
        }
        corner.x += size.x + SPACING;
        depth = depth.max(size.y);
    }
    plates.iter_mut().for_each(|plate| centre(plate, sizes, room));
    Plates { plates, too_large }
}

/// Moves all on a plate together, so that as much is free on the left as on the right, before and behind.
fn centre(plate: &mut [Stand], sizes: &[(DVec3, String)], room: DVec3) {
    let far = plate.iter().map(|s| s.at + sizes[s.thing].0).fold(DVec3::ZERO, DVec3::max);
    let shift = (room - far - DVec3::splat(SPACING)) / 2.0;
    plate.iter_mut().for_each(|s| s.at += DVec3::new(shift.x, shift.y, 0.0));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn things_stand_apart_on_the_bed_and_what_is_too_large_is_told() {
        let bed = Bed { name: "b".into(), size: [100.0, 80.0, 50.0] };
        let sizes: Vec<(DVec3, String)> = (0..13)
            .map(|k| (DVec3::new(20.0 + f64::from(k), 10.0 + f64::from(k % 5), 5.0), k.to_string()))
            .chain([
                (DVec3::new(20.0, 20.0, 51.0), "tall".into()),
                (DVec3::new(95.0, 5.0, 5.0), "long".into()),
            ])
            .collect();
        let plates = arrange(&sizes, &bed);
        assert_eq!(plates.too_large, [13, 14]);
        assert!(plates.plates.len() > 1);
        assert_eq!(plates.plates.iter().map(Vec::len).sum::<usize>(), 13);
        for plate in &plates.plates {
            for (i, a) in plate.iter().enumerate() {
                let end = a.at + sizes[a.thing].0;
                assert!(a.at.truncate().min_element() >= SPACING && end.x <= 94.0 && end.y <= 74.0, "{a:?}");
                for b in &plate[..i] {
                    let gap = (a.at - (b.at + sizes[b.thing].0)).max(b.at - end);
                    assert!(gap.x.max(gap.y) >= SPACING, "{a:?} {b:?}");
                }
            }
        }
    }
}
