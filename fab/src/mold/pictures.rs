//! Takes a mold; gives its pictures: draft and undercut on the part from both ends, the halves opened, the prints.

use crate::mesh::Mesh;
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

/// The mold opened: the upper half turned over beside the lower, cores drawn out of the lower along their pulls.
pub fn opened(mold: &Mold) -> Extra {
    let halves: Vec<&Piece> = mold.pieces.iter().filter(|p| p.kind == Kind::Half).collect();
    beside(mold, &halves[0].mesh, &halves[1].mesh)
}

/// The same of halves that are no pieces of it: those that are poured.
pub fn beside(mold: &Mold, lower: &Mesh, upper: &Mesh) -> Extra {
    let over = upper.map(|v| DVec3::new(v.x, -v.y, -v.z));
    let wide = mold.plan.high - mold.plan.low;
    let cores: Vec<&Piece> = mold.pieces.iter().filter(|p| p.kind == Kind::Core).collect();
    let out = |p: &Piece| p.pull * (extent(p) + APART);
    let aside = |k: usize| {
        let far = |p: &&Piece| out(p)[k].abs() + if p.pull[k] != 0.0 { APART } else { 0.0 };
        cores.iter().map(far).fold(APART, f64::max)
    };
    let beside = if wide.x > wide.y {
        DVec3::new(0.0, wide.y + aside(1), 0.0)
    } else {
        DVec3::new(wide.x + aside(0), 0.0, 0.0)
    };
    let level = DVec3::Z * (2.0 * mold.plan.parting);
    let mut views = vec![
        Painted { mesh: lower, colours: vec![COLOURS[0]], shift: DVec3::ZERO },
        Painted { mesh: &over, colours: vec![COLOURS[1]], shift: beside + level },
    ];
    views.extend(cores.iter().map(|p| Painted { mesh: &p.mesh, colours: vec![COLOURS[2]], shift: out(p) }));
    Extra { name: format!("{}.opened.png", mold.name), bytes: png(&views, 25.0, 50.0) }
}

/// Of a piece along its pull, mm.
fn extent(p: &Piece) -> f64 {
    let along = p.mesh.vertices.iter().map(|v| v.dot(p.pull));
    let (lo, hi) = along.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
    hi - lo
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
