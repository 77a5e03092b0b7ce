//! Takes corners as they stand in a file, gives polygons over vertices that are welded by identity of
//! coordinates.
//!
//! Not promised: that the polygons close. Corners that differ in the last bit are two vertices; nothing is
//! guessed by distance.

use super::faults::{Found, Place, found};
use glam::DVec3;
use std::collections::HashMap;

/// Polygons as read. `places[k]` says where in the file face `k` stands.
#[derive(Clone, Debug, Default)]
pub(super) struct Soup {
    pub vertices: Vec<DVec3>,
    pub faces: Vec<Vec<u32>>,
    pub places: Vec<Place>,
    /// Half a unit in the last place in which the file wrote its coordinates, in model units: no coordinate
    /// is known better.
    pub resolution: f64,
    ids: HashMap<[u64; 3], u32>,
}

impl Soup {
    /// The vertex with exactly these coordinates.
    pub fn weld(&mut self, p: DVec3) -> u32 {
        // Adding zero turns -0 into +0: one place, one key.
        let key = (p + DVec3::ZERO).to_array().map(f64::to_bits);
        *self.ids.entry(key).or_insert_with(|| {
            self.vertices.push(p + DVec3::ZERO);
            self.vertices.len() as u32 - 1
        })
    }

    pub fn push(&mut self, corners: &[DVec3], place: Place) {
        let face = corners.iter().map(|&p| self.weld(p)).collect();
        self.faces.push(face);
        self.places.push(place);
    }
}

/// The three coordinates if they are all finite.
pub(super) fn finite(p: [f64; 3], place: Place) -> Result<DVec3, Found> {
    if p.iter().all(|x| x.is_finite()) {
        Ok(DVec3::from_array(p))
    } else {
        Err(found(
            place,
            format!("coordinate {p:?} is not a finite number"),
            "write finite numbers in model units",
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn welds_by_identity_only() {
        let mut s = Soup::default();
        let p = DVec3::new(0.1, 0.0, 1.0);
        assert_eq!(s.weld(p), s.weld(DVec3::new(0.1, -0.0, 1.0)));
        assert_ne!(s.weld(p), s.weld(DVec3::new(0.1f64.next_up(), 0.0, 1.0)));
    }
}
