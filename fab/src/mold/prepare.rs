//! Takes a part and an order; gives the part in its mold frame with its pull, parting and high points, or why there can
//! be no mold of it.

use crate::bvh::Bvh;
use crate::cross;
use crate::files::stl;
use crate::mesh::{Closure, Mesh};
use crate::mold::frame::{Footprint, Framed, framed, settled};
use crate::mold::parting::{self, Plane};
use crate::mold::pull::{self, Candidate, Search};
use crate::mold::shadow::{self, Blocked};
use crate::mold::tops::{Top, tops};
use crate::mold::{MoldError, MoldSpec, Pull, Route};
use crate::solid::{NotSolid, Solid};
use glam::DVec3;

/// A part ready for its mold.
#[derive(Clone)]
pub struct Ready {
    pub framed: Framed,
    pub pull: Pull,
    pub blocked: Blocked,
    pub solid: Solid,
    pub plane: Plane,
    pub tops: Vec<Top>,
    /// What was mended in the mesh that came.
    pub mended: Option<String>,
    /// Other pulls that leave little undercut, best first, well apart from this and from each other.
    pub others: Vec<DVec3>,
}

pub fn unfit(what: impl Into<String>, hint: &str) -> MoldError {
    MoldError::Input(what.into(), hint.to_string())
}

impl From<NotSolid> for MoldError {
    fn from(e: NotSolid) -> MoldError {
        unfit(e.0, "repair the mesh; the slicer's repair or admesh may do")
    }
}

/// A part that is a plain solid, and what was mended for it.
pub struct Checked {
    pub mesh: Mesh,
    pub mended: Option<String>,
}

/// Triangles of a part that is molded. The mold of a tile of 2,640 took 0.4 s on two cores, of the same in 42,240 triangles 6 s, in
/// 168,960 29 s: time goes with the number, and this many take about a minute. More detail than this is below what a printer
/// of molds makes: on a part of 200 mm triangles are then half a millimetre wide.
const MOST_TRIANGLES: usize = 300_000;

/// Refuses what is no plain solid of one body.
pub fn checked(part: &Mesh) -> Result<Checked, MoldError> {
    if part.triangles.len() > MOST_TRIANGLES {
        let what =
            format!("the part has {} triangles; molds take up to {MOST_TRIANGLES}", part.triangles.len());
        return Err(unfit(what, "make its mesh coarser: what is below a layer is not seen in a casting"));
    }
    if part.triangles.is_empty() {
        return Err(unfit("the part has no triangles", "give a closed mesh"));
    }
    if part.triangles.iter().flatten().any(|&v| v as usize >= part.vertices.len()) {
        return Err(unfit(
            "a triangle of the part names a corner that is not there",
            "export the mesh again",
        ));
    }
    if part.vertices.iter().any(|v| !v.is_finite()) {
        return Err(unfit("a corner of the part is not a finite number", "export the mesh again"));
    }
    if let Closure::Open { edges, at } = part.closure() {
        let what =
            format!("{edges} edges of the part are not between two opposite triangles, one at {at:.3}");
        return Err(unfit(what, "close the mesh; the slicer's repair or admesh may do"));
    }
    let volume = part.volume();
    if volume <= 0.0 {
        return Err(unfit(format!("the part's volume is {volume:.3} mm3"), "turn its facets outward"));
    }
    let solid = Solid::of(part)?;
    one_body(&solid)?;
    uncrossed(part, &solid)
}

fn one_body(solid: &Solid) -> Result<(), MoldError> {
    let bodies = solid.bodies();
    if bodies.len() < 2 {
        return Ok(());
    }
    Err(if bodies.iter().any(|b| b.mesh().volume() < 0.0) {
        unfit("the part has a hollow inside that no mold can form", "fill it, or open it to the outside")
    } else {
        unfit("the part is several bodies", "give each a mold of its own")
    })
}

/// By how much of itself the volume may change when crossings are mended: what f32 makes of coordinates.
const MENDED_SHARE: f64 = 1e-6;

/// Crossings of the size of round-off (programs that write f32 make them) are mended by uniting short edges; others are
/// refused.
fn uncrossed(part: &Mesh, solid: &Solid) -> Result<Checked, MoldError> {
    let crossings = |m: &Mesh| {
        cross::within(m, &Bvh::new(m))
            .map_err(|e| unfit(e.to_string(), "make its mesh anew with fewer triangles"))
    };
    let Some(first) = crossings(part)?.first().copied() else {
        return Ok(Checked { mesh: part.clone(), mended: None });
    };
    for size in stl::details(part, stl::COARSEST) {
        let plain = solid.plain(size).mesh();
        let same = (plain.volume() - part.volume()).abs() <= MENDED_SHARE * part.volume();
        if same && plain.closure() == Closure::Closed && crossings(&plain)?.is_empty() {
            let what = format!(
                "the part's surface crossed itself at {:.3}; edges below {size:.5} mm were united",
                first.at
            );
            return Ok(Checked { mesh: plain, mended: Some(what) });
        }
    }
    Err(unfit(format!("the part's surface crosses itself at {:.3}", first.at), "unite its bodies first"))
}

/// Depths within this share of the least count as the same; among them the plainer parting wins.
const SAME_DEPTH: f64 = 0.01;

pub fn ready(part: &Mesh, spec: &MoldSpec) -> Result<Ready, MoldError> {
    let checked = checked(part)?;
    let part = &checked.mesh;
    match spec.pull.map(|d| d.try_normalize()) {
        None => {
            let search = pull::search(part);
            let chosen =
                plainest(part, &search).ok_or_else(|| unfit("no pull direction was found", "give one"))?;
            let direction = better_end(part, chosen.direction, spec);
            let others = others(part, &search, direction);
            Ok(Ready {
                others,
                ..turned(&checked, spec, chosen, direction, Footprint::Smallest, search.looked_at)?
            })
        }
        Some(Some(d)) => turned(&checked, spec, &pull::measured(part, d), d, Footprint::Smallest, 1),
        Some(None) => Err(unfit("the pull direction given has no length", "give three numbers, not all 0")),
    }
}

/// The part with the pull that was chosen, and with each of the others at the end that leaves fewer high points.
pub fn with_others(
    part: &Mesh,
    spec: &MoldSpec,
    first: &Ready,
    footprint: Footprint,
) -> Result<Vec<Ready>, MoldError> {
    let checked = checked(part)?;
    let chosen = (first.pull.direction, first.pull.direction);
    let others = first.others.iter().map(|&p| (p, better_end(&checked.mesh, p, spec)));
    let along = |(pull, direction): (DVec3, DVec3)| {
        let measured = pull::measured(&checked.mesh, pull);
        turned(&checked, spec, &measured, direction, footprint, first.pull.candidates)
    };
    std::iter::once(chosen).chain(others).map(along).collect()
}

fn turned(
    checked: &Checked,
    spec: &MoldSpec,
    chosen: &Candidate,
    direction: DVec3,
    footprint: Footprint,
    looked_at: usize,
) -> Result<Ready, MoldError> {
    let framed = gang(framed(&checked.mesh, direction, footprint), spec);
    let blocked = pull::undercut(&framed.mesh, framed.snap);
    let looks = parting::looks(&framed.mesh, framed.snap);
    let plane = parting::plane(&framed.mesh, &looks, framed.snap);
    let tops = tops(&framed.mesh, spec.figures.vent_prominence.value);
    let pull = answer(looked_at, chosen, direction, &blocked, &framed);
    let (solid, mended) = (Solid::of(&framed.mesh)?, checked.mended.clone());
    Ok(Ready { solid, framed, pull, blocked, plane, tops, mended, others: vec![] })
}

/// Pulls nearer to each other than this (their dot product; 30 degrees) would need much the same cores.
const MUCH_THE_SAME: f64 = 0.866;

/// Pulls this near (half a degree) are one, though an upright wall makes much of the difference between two.
const SAME_PULL: f64 = 0.99996;

/// Other pulls that are worth a try with side cores.
const OTHERS: usize = 6;

/// First the axes, as people draw, then square to the largest faces, as they pull, then whatever leaves little undercut.
fn others(part: &Mesh, search: &Search, chosen: DVec3) -> Vec<DVec3> {
    let faces = pull::large_normals(part);
    let mut kept = vec![chosen];
    let mut keep = |d: DVec3, apart: f64, most: usize| {
        if kept.len() <= most && kept.iter().all(|k| k.dot(d).abs() < apart) {
            kept.push(d);
        }
    };
    DVec3::AXES.iter().for_each(|d| keep(*d, SAME_PULL, OTHERS));
    faces.iter().for_each(|d| keep(*d, SAME_PULL, OTHERS - 1));
    search.best.iter().for_each(|c| keep(c.direction, MUCH_THE_SAME, OTHERS));
    kept.split_off(1)
}

/// Among the directions with the least undercut and about the least depth, the one whose plane leaves least off it.
fn plainest<'a>(part: &Mesh, search: &'a Search) -> Option<&'a Candidate> {
    let first = search.best.first()?;
    let as_good = |c: &&Candidate| c.level == first.level && c.depth <= first.depth * (1.0 + SAME_DEPTH);
    let off = |c: &Candidate| {
        let f = framed(part, c.direction, Footprint::Smallest);
        parting::plane(&f.mesh, &parting::looks(&f.mesh, f.snap), f.snap).wrong
    };
    let rated = search.best.iter().filter(as_good).map(|c| (off(c), c));
    rated.min_by(|a, b| a.0.total_cmp(&b.0)).map(|r| r.1)
}

/// Of both ends of the pull the one that leaves fewer high points.
fn better_end(part: &Mesh, d: DVec3, spec: &MoldSpec) -> DVec3 {
    let count =
        |d: DVec3| tops(&framed(part, d, Footprint::Smallest).mesh, spec.figures.vent_prominence.value).len();
    if count(-d) < count(d) { -d } else { d }
}

fn answer(
    looked_at: usize,
    chosen: &Candidate,
    direction: DVec3,
    blocked: &Blocked,
    framed: &Framed,
) -> Pull {
    let search_words = "normals of the largest facets, their cross products, the axes, 160 directions over the half \
                        sphere; the best varied where an undercut is left";
    Pull {
        direction,
        undercut_mm2: chosen.undercut,
        undercut_reach_mm: if chosen.undercut > 0.0 { shadow::reach(blocked, REACH_STEP) } else { 0.0 },
        depth_mm: framed.mesh.bounds().1.z,
        candidates: looked_at,
        search: search_words.to_string(),
    }
}

/// Widths of undercuts are found to this, mm: a fortieth of what snaps.
const REACH_STEP: f64 = 0.01;

/// Copies beside each other along the short side of the footprint, a wall apart.
fn gang(one: Framed, spec: &MoldSpec) -> Framed {
    if spec.count < 2 || spec.route == Route::LostWax {
        return one;
    }
    let (lo, hi) = one.mesh.bounds();
    let size = hi - lo;
    let axis = usize::from(size.y < size.x);
    // Whole millimetres, so that copies differ by round-off alone.
    let pitch = (size[axis] + spec.figures.wall.value).ceil();
    let mut mesh = Mesh::default();
    for k in 0..spec.count {
        let by = DVec3::AXES[axis] * (pitch * (k as f64 - (spec.count - 1) as f64 / 2.0));
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend(one.mesh.vertices.iter().map(|v| *v + by));
        mesh.triangles.extend(one.mesh.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let (mesh, snap) = settled(&mesh);
    Framed { mesh, snap, ..one }
}
