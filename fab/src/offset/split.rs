//! Takes a body with corners that no point can satisfy; splits each in two, until each part of it has its place.
//!
//! Such a corner has facets that face each other, as where a wall ends on the edge of a hole: inward from it there are
//! several places, not one. Not complete: a corner for which no split helps stays unplaced, and is a finding.

use super::body::{Body, Corner};
use super::settle::{LEAST_COSINE, is_faulty};
use glam::DVec3;

/// One way to split: triangles `from..to` of the fan stay, the others go to the new corner.
#[derive(Clone, Debug)]
struct Split {
    from: usize,
    to: usize,
    /// Facets of the two triangles that fill the gaps at spokes `from` and `to`.
    fill: [u32; 2],
    /// For the old corner and the new one.
    facets: [Vec<u32>; 2],
    at: [Option<DVec3>; 2],
}

/// Splits every unplaced corner.
pub fn split(body: &mut Body) {
    let mut todo: Vec<u32> = (0..body.corners.len() as u32).filter(|&c| is_lost(body, c)).collect();
    while let Some(c) = todo.pop() {
        let Some((fan, best)) = best_split(body, c) else { continue };
        let new = apply(body, c, &fan, best);
        todo.extend([c, new].into_iter().filter(|&c| is_lost(body, c)));
    }
}

fn is_lost(body: &Body, c: u32) -> bool {
    !body.corners[c as usize].placed && !body.star[c as usize].is_empty()
}

/// The best split that places at least one half, and gets on with the other.
fn best_split(body: &Body, c: u32) -> Option<(Vec<u32>, Split)> {
    let fan = fan(body, c)?;
    let splits = ways(body, c, &fan);
    let ranked = splits.into_iter().map(|s| (rank(body, c, &fan, &s), s));
    let best = ranked.min_by(|(a, _), (b, _)| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    best.map(|(_, s)| (fan, s))
}

/// Halves without a place, then triangles that the split leaves faulty, then the longer way. Several spokes of one facet
/// place both halves alike; only from the one where the surface really parts do the two new triangles face outward.
fn rank(body: &Body, c: u32, fan: &[u32], s: &Split) -> (usize, usize, f64) {
    let lost = s.at.iter().filter(|x| x.is_none()).count();
    let anchor = body.corners[c as usize].anchor;
    (lost, faulty(body, c, fan, s), s.at.iter().flatten().map(|x| x.distance(anchor)).fold(0.0, f64::max))
}

/// Triangles around both halves, and the two between them, that would be turned over or have no area. What hangs on a half
/// without a place is not counted: where that goes is not known yet.
fn faulty(body: &Body, c: u32, fan: &[u32], s: &Split) -> usize {
    let at = |x: u32| body.corners[x as usize].at;
    let around = fan.iter().enumerate().filter_map(|(k, &t)| {
        let half = s.at[usize::from(!(s.from..s.to).contains(&k))]?;
        let [before, after] = spokes(body, c, t)?;
        Some(([half, at(before), at(after)], body.facet[t as usize]))
    });
    let between =
        [(s.from, s.fill[0]), (s.to, s.fill[1])].into_iter().enumerate().filter_map(|(k, (spoke, f))| {
            let end = at(spokes(body, c, fan[spoke % fan.len()])?[0]);
            let [mine, other] = [s.at[0]?, s.at[1]?];
            Some((if k == 0 { [end, mine, other] } else { [mine, end, other] }, f))
        });
    let normal = |f: u32| body.moved[f as usize].plane.normal;
    around
        .chain(between)
        .filter(|&(points, f)| is_faulty(points, normal(f), body.slack, LEAST_COSINE))
        .count()
}

/// The triangles around a corner, counter-clockwise from its lowest; `None` where they are not one fan.
fn fan(body: &Body, c: u32) -> Option<Vec<u32>> {
    let star = &body.star[c as usize];
    let mut fan = vec![*star.first()?];
    while fan.len() <= star.len() {
        let last = spokes(body, c, fan[fan.len() - 1])?[1];
        let next = *star.iter().find(|&&t| spokes(body, c, t).is_some_and(|s| s[0] == last))?;
        if next == fan[0] {
            break;
        }
        fan.push(next);
    }
    (fan.len() == star.len()).then_some(fan)
}

/// The corners before and after which triangle `t` lies, seen from `c`.
fn spokes(body: &Body, c: u32, t: u32) -> Option<[u32; 2]> {
    let tri = body.triangles[t as usize]?;
    let k = tri.iter().position(|&x| x == c)?;
    Some([tri[(k + 1) % 3], tri[(k + 2) % 3]])
}

/// All ways to split that place at least one half.
fn ways(body: &Body, c: u32, fan: &[u32]) -> Vec<Split> {
    let n = fan.len();
    let facet = |k: usize| body.facet[fan[k % n] as usize];
    let anchor = body.corners[c as usize].anchor;
    let whole = body.corners[c as usize].facets.len();
    let mut all = Vec::new();
    for from in 0..n {
        for to in from + 1..n {
            let kept: Vec<u32> = (from..to).map(facet).collect();
            let gone: Vec<u32> = (to..n + from).map(facet).collect();
            for (i, j) in [(n + from - 1, n + to - 1), (n + from - 1, to), (from, n + to - 1), (from, to)] {
                let fill = [facet(i), facet(j)];
                let facets = [&kept, &gone].map(|half| with(half, &fill));
                let at = [0, 1].map(|k| body.place(&facets[k], anchor));
                let split = Split { from, to, fill, facets, at };
                if split.at.iter().any(Option::is_some) && gets_on(&split, n, whole) {
                    all.push(split);
                }
            }
        }
    }
    all
}

/// Whether a half without a place has fewer facets than the corner had, or as many and fewer triangles (two fill the
/// gap): so splitting ends.
fn gets_on(s: &Split, triangles: usize, facets: usize) -> bool {
    let kept = s.to - s.from;
    [kept, triangles - kept]
        .into_iter()
        .enumerate()
        .all(|(k, own)| s.at[k].is_some() || (s.facets[k].len(), own + 2) < (facets, triangles))
}

fn with(half: &[u32], fill: &[u32; 2]) -> Vec<u32> {
    let mut all = [half, fill].concat();
    all.sort_unstable();
    all.dedup();
    all
}

/// Makes the new corner and the two triangles between it and the old one; gives the new corner.
fn apply(body: &mut Body, c: u32, fan: &[u32], s: Split) -> u32 {
    let new = body.corners.len() as u32;
    let anchor = body.corners[c as usize].anchor;
    let corner = |facets: Vec<u32>, at: Option<DVec3>| Corner {
        anchor,
        facets,
        at: at.unwrap_or(anchor),
        placed: at.is_some(),
    };
    let [mine, other] = s.facets;
    body.corners[c as usize] = corner(mine, s.at[0]);
    body.corners.push(corner(other, s.at[1]));
    body.star.push(vec![]);
    let spoke = |body: &Body, k: usize| spokes(body, c, fan[k % fan.len()]).map_or(c, |s| s[0]);
    let (first, second) = (spoke(body, s.from), spoke(body, s.to));
    for &t in fan[s.to..].iter().chain(&fan[..s.from]) {
        body.triangles[t as usize] =
            body.triangles[t as usize].map(|tri| tri.map(|x| if x == c { new } else { x }));
        body.star[c as usize].retain(|&x| x != t);
        body.star[new as usize].push(t);
    }
    body.star[new as usize].sort_unstable();
    body.add([first, c, new], s.fill[0]);
    body.add([c, second, new], s.fill[1]);
    new
}
