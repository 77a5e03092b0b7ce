//! Takes a lost-wax tree; gives its picture: the tree alone with patterns, gates and runner in colours of their own, the tree
//! in its flask cut open, and the investment cut open with the hollow that the wax leaves.
//!
//! Not promised: anything to measure by; the cut goes through the runner's axis.

use crate::mesh::Mesh;
use crate::mold::picture::{Painted, png};
use crate::mold::wax::{self, Tree};
use crate::mold::{Extra, Mold};
use crate::solid::{NotSolid, Solid, cuboid, frustum};
use glam::DVec3;

const PATTERN: [u8; 3] = [150, 180, 210];
const GATE: [u8; 3] = [214, 110, 80];
const RUNNER: [u8; 3] = [210, 180, 140];
const FLASK: [u8; 3] = [130, 134, 140];
const INVESTMENT: [u8; 3] = [228, 224, 214];

/// Air between the three, as a share of the flask's radius.
const APART: f64 = 0.5;

/// Degrees above the ground: low enough to see the patterns one above another, and into the flask.
const TILT: f64 = 28.0;

/// `flask`: the tube, `wall` thick.
pub fn opened(mold: &Mold, tree: &Tree, flask: &Solid, wall: f64) -> Result<Extra, NotSolid> {
    let (radius, low, high) = wax::flask(tree, &mold.figures);
    let outer = radius + wall;
    // The half beyond the runner's axis, seen from the front.
    let front = Solid::of(&cuboid(
        DVec3::new(-2.0 * outer, -2.0 * outer, low - outer),
        DVec3::new(2.0 * outer, 0.0, high + outer),
    ))?;
    let tube = flask.minus(&front).mesh();
    let poured = Solid::of(&frustum(DVec3::Z * low, high - low, radius, radius))?;
    let burnt = poured.minus(&tree.solid).minus(&front).mesh();
    let grown = coloured(tree);
    let cut = [(&tube, FLASK), (&burnt, INVESTMENT)];
    let whole = || grown.iter().map(|(m, c)| (m, *c));
    let paint = |k: f64, (mesh, colour): (_, [u8; 3])| {
        let shift = DVec3::X * (k * (2.0 + APART) * outer);
        Painted { mesh, colours: vec![colour], shift }
    };
    let mut views: Vec<Painted> = whole().map(|g| paint(-1.0, g)).collect();
    views.extend(whole().chain([cut[0]]).map(|g| paint(0.0, g)));
    views.extend(cut.into_iter().map(|g| paint(1.0, g)));
    Ok(Extra { name: format!("{}.opened.png", mold.name), bytes: png(&views, 0.0, TILT) })
}

/// Patterns, gates and runner as they stand.
fn coloured(tree: &Tree) -> Vec<(Mesh, [u8; 3])> {
    let mut all = vec![(tree.stem.clone(), RUNNER)];
    for place in &tree.places {
        all.push((tree.lying.map(|v| place.transform_point3(v + DVec3::X * tree.reach)), PATTERN));
        all.push((tree.bar.map(|v| place.transform_point3(v)), GATE));
    }
    all
}
