//! Promises of side cores on pipes: tees, crosses, elbows, a mug; each gets a right mold, whose cores can be gripped where possible.

use super::{measured, solid, sound, spec};
use glam::DVec3;
use weavelock_fab::mesh::Mesh;
use weavelock_fab::mold::{Kind, Mold, Route, make};
use weavelock_fab::solid::{Solid, cuboid, frustum};

/// A rod of radius `r` from `from` to `to` along its axis, turned by `map`.
fn rod(r: f64, from: f64, to: f64, map: fn(DVec3) -> DVec3) -> Solid {
    solid(&frustum(DVec3::Z * from, to - from, r, r).map(map))
}

fn x(v: DVec3) -> DVec3 {
    DVec3::new(v.z, v.x, v.y)
}

fn y(v: DVec3) -> DVec3 {
    DVec3::new(v.y, v.z, v.x)
}

fn z(v: DVec3) -> DVec3 {
    v
}

/// A run of 24 mm and a branch of 20 mm outside; bored 16 mm along the run and 12 mm along the branch.
fn bored_tee() -> Mesh {
    let outside = rod(10.0, -12.0, 12.0, x).with(&rod(10.0, 0.0, 24.0, z));
    outside.minus(&rod(8.0, -13.0, 13.0, x)).minus(&rod(6.0, 0.0, 25.0, z)).mesh()
}

pub fn cross() -> Mesh {
    let outside = rod(10.0, -30.0, 30.0, x).with(&rod(10.0, -30.0, 30.0, y));
    outside.minus(&rod(6.0, -31.0, 31.0, x)).minus(&rod(6.0, -31.0, 31.0, y)).mesh()
}

/// Two pipes that end in a cube of the outer size. Their bores end flat, beyond one another, so that four cores are the least
/// along straight ways: what is beyond the upright bore can leave only through it, along x; the core that goes there sweeps
/// over all of the lying bore's width, and cuts what is below that bore off from the upright one, in two pieces that meet in
/// a line. Those can leave only upwards, after both, without a grip of their own.
pub fn elbow() -> Mesh {
    let corner = solid(&cuboid(DVec3::splat(-10.0), DVec3::splat(10.0)));
    let outside = Solid::all(vec![corner, rod(10.0, 0.0, 30.0, x), rod(10.0, 0.0, 30.0, z)]);
    outside.minus(&rod(6.0, -6.0, 31.0, x)).minus(&rod(6.0, -6.0, 31.0, z)).mesh()
}

/// A cup of 50 mm with a square handle at its side.
fn mug() -> Mesh {
    let cup = rod(25.0, 0.0, 60.0, z);
    let handle = solid(&cuboid(DVec3::new(20.0, -4.0, 10.0), DVec3::new(45.0, 4.0, 50.0)));
    let hole = solid(&cuboid(DVec3::new(20.0, -5.0, 18.0), DVec3::new(37.0, 5.0, 42.0)));
    cup.with(&handle.minus(&hole)).minus(&rod(21.0, 5.0, 61.0, z)).mesh()
}

/// `loose`: how many of its cores may stand behind another's place, without a grip.
fn molded(name: &str, part: &Mesh, most: usize, loose: usize) -> Mold {
    let mold = make(part, &spec(name, Route::Rigid)).unwrap();
    let cores: Vec<_> = mold.pieces.iter().filter(|p| p.kind == Kind::Core).collect();
    assert!((1..=most).contains(&cores.len()), "{name}: {} cores; {:#?}", cores.len(), mold.findings);
    let gripped = cores.iter().filter(|core| {
        let reach = core.mesh.vertices.iter().map(|v| v.dot(core.pull)).fold(f64::MIN, f64::max);
        let (low, high) = (mold.plan.low * core.pull, mold.plan.high * core.pull);
        reach > low.max(high).element_sum() + 9.0
    });
    assert!(gripped.count() + loose >= cores.len(), "{name}");
    mold
}

#[test]
fn a_bored_tee_gets_its_cores() {
    sound(&measured(&molded("bored-tee", &bored_tee(), 2, 0)));
}

#[test]
#[ignore = "half a minute"]
fn crosses_elbows_and_mugs_get_theirs() {
    for (name, part, most, loose) in
        [("cross", cross(), 3, 1), ("elbow", elbow(), 4, 2), ("mug", mug(), 1, 0)]
    {
        sound(&measured(&molded(name, &part, most, loose)));
    }
}
