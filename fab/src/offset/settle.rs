//! Takes a moved body; collapses edges until no triangle is turned over, tilted off its facet or too thin to write.
//!
//! Sound: what it calls settled has no such triangle. Not complete: where it finds no collapse that helps it says
//! where. It does not look for triangles that cross (see `cross`).

use super::body::Body;
use glam::DVec3;

/// A triangle whose normal has turned from its facet's by more than this (cosine of 60 degrees) stands for that facet
/// no longer. A turned-over one has a negative cosine.
pub(super) const LEAST_COSINE: f64 = 0.5;

/// What was done, and where it failed.
#[derive(Clone, Debug, Default)]
pub struct Settled {
    pub collapses: usize,
    /// A point of each triangle that is still turned over or degenerate.
    pub unsettled: Vec<DVec3>,
}

/// How strict a collapse is judged by the faulty triangles around it.
#[derive(Clone, Copy, PartialEq)]
enum Demand {
    Fewer,
    NoMore,
    Any,
}

struct Collapse {
    keep: u32,
    drop: u32,
    anchor: DVec3,
    at: DVec3,
    faulty: usize,
    /// The farther of the two ways by which the corners jump, in mm.
    jump: f64,
}

/// Collapses edges of faulty triangles until none is left or nothing helps. `thinnest`: least altitude of a triangle,
/// in mm.
pub fn settle(body: &mut Body, thinnest: f64) -> Settled {
    let mut done = Settled::default();
    let mut demand = Demand::Fewer;
    loop {
        let faulty = faulty_triangles(body, thinnest);
        if faulty.is_empty() {
            break;
        }
        let before = done.collapses;
        for t in faulty {
            if still_faulty(body, t, thinnest) && collapse_one(body, t, thinnest, demand) {
                done.collapses += 1;
            }
        }
        demand = match (done.collapses > before, demand) {
            (true, _) => Demand::Fewer,
            (false, Demand::Fewer) => Demand::NoMore,
            (false, Demand::NoMore) => Demand::Any,
            (false, Demand::Any) => break,
        };
    }
    done.unsettled = (0..body.triangles.len())
        .filter_map(|t| body.triangles[t].filter(|_| upside_down(body, t, thinnest)))
        .map(|tri| body.points(tri).iter().sum::<DVec3>() / 3.0)
        .collect();
    done
}

/// Faulty triangles, the one with the shortest edge first: it costs least to give up.
fn faulty_triangles(body: &Body, thinnest: f64) -> Vec<usize> {
    let mut faulty: Vec<usize> =
        (0..body.triangles.len()).filter(|&t| still_faulty(body, t, thinnest)).collect();
    let shortest = |t: usize| body.triangles[t].map_or(0.0, |tri| shortest_anchor_edge(body, tri));
    faulty.sort_by(|&a, &b| shortest(a).total_cmp(&shortest(b)).then(a.cmp(&b)));
    faulty
}

fn shortest_anchor_edge(body: &Body, tri: [u32; 3]) -> f64 {
    let [a, b, c] = tri.map(|c| body.corners[c as usize].anchor);
    a.distance_squared(b).min(b.distance_squared(c)).min(c.distance_squared(a))
}

fn still_faulty(body: &Body, t: usize, thinnest: f64) -> bool {
    let normal = body.moved[body.facet[t] as usize].plane.normal;
    body.triangles[t].is_some_and(|tri| is_faulty(body.points(tri), normal, thinnest, LEAST_COSINE))
}

fn upside_down(body: &Body, t: usize, thinnest: f64) -> bool {
    let normal = body.moved[body.facet[t] as usize].plane.normal;
    body.triangles[t].is_some_and(|tri| is_faulty(body.points(tri), normal, thinnest, 0.0))
}

/// Whether a triangle is thinner than that, or faces away from its facet.
pub(super) fn is_faulty([a, b, c]: [DVec3; 3], normal: DVec3, thinnest: f64, least_cosine: f64) -> bool {
    let n = (b - a).cross(c - a);
    let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a)).sqrt();
    let twice_area = n.length();
    let sound = twice_area > thinnest * longest && n.dot(normal) > least_cosine * twice_area;
    !sound
}

fn collapse_one(body: &mut Body, t: usize, thinnest: f64, demand: Demand) -> bool {
    let Some(tri) = body.triangles[t] else { return false };
    let edges = [(tri[0], tri[1]), (tri[1], tri[2]), (tri[2], tri[0])];
    let best = edges
        .iter()
        .flat_map(|&(u, w)| candidates(body, u.min(w), u.max(w), thinnest, demand))
        .min_by(|a, b| a.jump.total_cmp(&b.jump).then(a.faulty.cmp(&b.faulty)));
    let Some(c) = best else { return false };
    body.unite(c.keep, c.drop, c.anchor, c.at);
    true
}

/// Ways to unite two corners: anchored at either, or half way.
fn candidates(body: &Body, u: u32, w: u32, thinnest: f64, demand: Demand) -> Vec<Collapse> {
    if !body.may_unite(u, w) {
        return vec![];
    }
    let facets = body.united_facets(u, w);
    let live = body.facets_left(u, w);
    let (p, q) = (body.corners[u as usize].anchor, body.corners[w as usize].anchor);
    let before = faulty_around(body, u, w, None, thinnest);
    [p, q, (p + q) / 2.0]
        .into_iter()
        .filter_map(|anchor| {
            let at = place_united(body, &facets, &live, anchor)?;
            let faulty = faulty_around(body, u, w, Some(at), thinnest);
            let jump = body.corners[u as usize].at.distance(at).max(body.corners[w as usize].at.distance(at));
            Some(Collapse { keep: u, drop: w, anchor, at, faulty, jump })
        })
        .filter(|c| match demand {
            Demand::Fewer => c.faulty < before,
            Demand::NoMore => c.faulty <= before,
            Demand::Any => true,
        })
        .collect()
}

/// Where the united corner goes: under the planes of vanished facets too, unless that costs more than another depth.
/// Far from it, the plane of a facet that is gone forbids what the facet itself never did.
fn place_united(body: &Body, all: &[u32], live: &[u32], anchor: DVec3) -> Option<DVec3> {
    let loose = body.place(live, anchor)?;
    let tight = body.place(all, anchor);
    Some(tight.filter(|x| x.distance(anchor) <= loose.distance(anchor) + body.depth).unwrap_or(loose))
}

/// Faulty triangles around either corner; with `at`, as they would be with both corners there.
fn faulty_around(body: &Body, u: u32, w: u32, at: Option<DVec3>, thinnest: f64) -> usize {
    let (su, sw) = (&body.star[u as usize], &body.star[w as usize]);
    let all = su.iter().chain(sw.iter().filter(|t| !su.contains(t)));
    all.filter(|&&t| {
        let Some(tri) = body.triangles[t as usize] else { return false };
        let dies = tri.contains(&u) && tri.contains(&w);
        let normal = body.moved[body.facet[t as usize] as usize].plane.normal;
        let point = |c: u32| at.filter(|_| c == u || c == w).unwrap_or(body.corners[c as usize].at);
        !(dies && at.is_some()) && is_faulty(tri.map(point), normal, thinnest, LEAST_COSINE)
    })
    .count()
}
