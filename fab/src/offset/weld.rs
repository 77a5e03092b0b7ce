//! Takes a body, gives it without edges too short to matter: both ends become one corner, and facets that vanish with
//! them bind nothing any more.
//!
//! Why that is allowed: a corner stays under the planes of all facets that are left around it, each of which passes
//! within the reach of the weld, so it loses at most twice that reach of clearance towards a facet that vanished.
//! Why it is needed: a facet of a micrometre has a plane that goes on for ever, and would push corners millimetres away.

use super::body::Body;

/// Unites the ends of edges shorter than `reach` mm, shortest first, as long as no corner strays farther than that
/// from where it came. Gives the number of edges united.
pub fn weld(body: &mut Body, reach: f64) -> usize {
    let mut strayed = vec![0.0_f64; body.corners.len()];
    let mut welds = 0;
    loop {
        let before = welds;
        for (u, w) in short_edges(body, reach) {
            let gone = body.star[u as usize].is_empty() || body.star[w as usize].is_empty();
            let length = body.edge_length(u, w);
            let stray = strayed[u as usize].max(strayed[w as usize] + length);
            if gone || stray > reach || !body.may_unite(u, w) {
                continue;
            }
            let (anchor, live) = (body.corners[u as usize].anchor, body.facets_left(u, w));
            let at = body.place(&live, anchor);
            body.unite(u, w, anchor, at.unwrap_or(anchor));
            let corner = &mut body.corners[u as usize];
            (corner.facets, corner.placed) = (live, at.is_some());
            strayed[u as usize] = stray;
            welds += 1;
        }
        if welds == before {
            return welds;
        }
    }
}

fn short_edges(body: &Body, reach: f64) -> Vec<(u32, u32)> {
    let sides = |t: &[u32; 3]| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])];
    let mut edges: Vec<(u32, u32)> = body.triangles.iter().flatten().flat_map(sides).collect();
    edges.retain(|&(u, w)| u < w && body.edge_length(u, w) <= reach);
    edges.sort_by(|a, b| body.edge_length(a.0, a.1).total_cmp(&body.edge_length(b.0, b.1)).then(a.cmp(b)));
    edges
}
