//! Takes a mold; gives its pictures: draft and undercut on the part from both ends, the halves opened, the prints.

use crate::mold::picture::{Painted, png};
use crate::mold::{Extra, Kind, Maps, Mold, Piece};
use glam::DVec3;

/// Draft from red (none) over yellow to green; undercut in magenta.
fn colours(maps: &Maps, least: f64) -> Vec<[u8; 3]> {
    let of = |(d, u): (&f64, &f64)| match d {
        _ if *u > 0.0 => [200, 0, 160],
        d if *d < least => [214, 69, 65],
        d if *d < 5.0 * least => [232, 190, 80],
        _ => [96, 170, 110],
    };
    maps.draft_deg.iter().zip(&maps.undercut_mm2).map(of).collect()
}

pub fn maps(mold: &Mold) -> Extra {
    let colours = colours(&mold.maps, mold.figures.draft.value);
    let (lo, hi) = mold.part.bounds();
    let over = mold.part.map(|v| DVec3::new(v.x, -v.y, -v.z));
    let below = DVec3::new(0.0, -(hi.y - lo.y) * 1.3 - 0.5 * (hi.z - lo.z), hi.z);
    let views = [
        Painted { mesh: &mold.part, colours: colours.clone(), shift: DVec3::ZERO },
        Painted { mesh: &over, colours, shift: below },
    ];
    Extra { name: format!("{}.draft.png", mold.name), bytes: png(&views, 20.0, 50.0) }
}

/// The halves opened: the upper one turned over beside the lower.
pub fn opened(mold: &Mold) -> Extra {
    let halves: Vec<&Piece> = mold.pieces.iter().filter(|p| p.kind == Kind::Half).collect();
    let over = halves[1].mesh.map(|v| DVec3::new(v.x, -v.y, -v.z));
    let wide = mold.plan.high - mold.plan.low;
    let beside = if wide.x > wide.y {
        DVec3::new(0.0, wide.y + 10.0, 0.0)
    } else {
        DVec3::new(wide.x + 10.0, 0.0, 0.0)
    };
    let level = DVec3::Z * (2.0 * mold.plan.parting);
    let views = [
        Painted { mesh: &halves[0].mesh, colours: vec![[150, 180, 210]], shift: DVec3::ZERO },
        Painted { mesh: &over, colours: vec![[210, 180, 140]], shift: beside + level },
    ];
    Extra { name: format!("{}.opened.png", mold.name), bytes: png(&views, 25.0, 50.0) }
}

/// All prints side by side.
pub fn prints(mold: &Mold) -> Extra {
    let mut along = 0.0;
    let mut views = Vec::new();
    for (k, piece) in mold.pieces.iter().filter(|p| p.copies > 0).enumerate() {
        let (lo, hi) = piece.mesh.bounds();
        let shift = DVec3::new(along - lo.x, 0.0, -lo.z);
        along += hi.x - lo.x + APART;
        views.push(Painted { mesh: &piece.mesh, colours: vec![COLOURS[k % COLOURS.len()]], shift });
    }
    Extra { name: format!("{}.prints.png", mold.name), bytes: png(&views, 25.0, 40.0) }
}

/// Air between prints in the picture, mm.
const APART: f64 = 10.0;

const COLOURS: [[u8; 3]; 3] = [[150, 180, 210], [210, 180, 140], [160, 200, 160]];
