//! Takes contact rows over unknowns; gives products with their matrix A, pair by pair of parts.
//!
//! Rows of a pair share two frames, so a row costs one wrench at the pair's middle. The sums are the same with any
//! number of threads. Not promised: the same round-off as `Unknowns::entries`, which judges at the end.

use super::order::Pattern;
use super::rows::{Freedom, Row, Unknowns};
use super::sparse::{Block, Factor, Pins, dot, transposed, zero};
use crate::assembly::PartIx;
use glam::DVec3;
use rayon::prelude::*;
use std::ops::Range;

/// The rows between two parts, at least one of them free.
struct Pair<const W: usize> {
    /// Up to two sides: node, the map from the pair's wrench to the node's unknowns, and their sign.
    sides: Vec<(usize, Block<W>, f64)>,
    rows: Range<usize>,
}

/// A, with one wrench for each row, in the order given; W unknowns for each node (a free part).
pub struct System<const W: usize> {
    pub pattern: Pattern,
    pairs: Vec<Pair<W>>,
    wrenches: Vec<[f64; W]>,
    /// How many rows act on one node at most.
    crowd: usize,
}

/// Unknowns of all nodes.
pub type Nodes<const W: usize> = Vec<[f64; W]>;

impl<const W: usize> System<W> {
    /// Rows of one pair must stand together, all the same way round. W is the freedom's number of unknowns; `node` says
    /// which of the `nodes` a part is, if any.
    pub fn new(
        rows: &[Row],
        unknowns: &Unknowns,
        nodes: usize,
        node: impl Fn(PartIx) -> Option<usize>,
    ) -> System<W> {
        let mut pairs = Vec::new();
        let mut wrenches = Vec::with_capacity(rows.len());
        for chunk in rows.chunk_by(|r, s| (r.a, r.b) == (s.a, s.b)) {
            let middle = chunk.iter().map(|r| r.point).sum::<DVec3>() / chunk.len() as f64;
            let far = chunk.iter().map(|r| (r.point - middle).length()).fold(0.0, f64::max);
            let lever = if far > 0.0 { far } else { 1.0 };
            let first = wrenches.len();
            wrenches
                .extend(chunk.iter().map(|r| wrench(r.normal, (r.point - middle).cross(r.normal) / lever)));
            let side = |part: PartIx, sign| {
                let node = node(part)?;
                let arm = middle - unknowns.centre[part.at()];
                Some((node, frame(unknowns.freedom, arm, lever, unknowns.lever[part.at()]), sign))
            };
            let sides = [side(chunk[0].a, -1.0), side(chunk[0].b, 1.0)].into_iter().flatten().collect();
            pairs.push(Pair { sides, rows: first..wrenches.len() });
        }
        let edges: Vec<(usize, usize)> = pairs
            .iter()
            .filter(|p: &&Pair<W>| p.sides.len() == 2)
            .map(|p| (p.sides[0].0, p.sides[1].0))
            .collect();
        let pattern = Pattern::new(nodes, &edges);
        let mut on = vec![0; nodes];
        pairs.iter().for_each(|p| p.sides.iter().for_each(|s| on[s.0] += p.rows.len()));
        System { pattern, pairs, wrenches, crowd: on.into_iter().max().unwrap_or(0) }
    }

    pub fn rows(&self) -> usize {
        self.wrenches.len()
    }

    pub fn nodes(&self) -> usize {
        self.pattern.place.len()
    }

    /// A x.
    pub fn openings(&self, x: &[[f64; W]]) -> Vec<f64> {
        let of = |pair: &Pair<W>| {
            let mut twist = [0.0; W];
            for (node, map, sign) in &pair.sides {
                for (line, v) in map.iter().zip(&x[*node]) {
                    (0..W).for_each(|k| twist[k] += sign * line[k] * v);
                }
            }
            twist
        };
        let mut out = vec![0.0; self.rows()];
        for pair in &self.pairs {
            let twist = of(pair);
            let wrenches = &self.wrenches[pair.rows.clone()];
            out[pair.rows.clone()].iter_mut().zip(wrenches).for_each(|(o, w)| *o = dot(w, &twist));
        }
        out
    }

    /// A^T y.
    pub fn sums(&self, y: &[f64]) -> Nodes<W> {
        let mut sums = vec![[0.0; W]; self.nodes()];
        for pair in &self.pairs {
            let mut total = [0.0; W];
            for (w, f) in self.wrenches[pair.rows.clone()].iter().zip(&y[pair.rows.clone()]) {
                (0..W).for_each(|k| total[k] += w[k] * f);
            }
            for (node, map, sign) in &pair.sides {
                (0..W).for_each(|r| sums[*node][r] += sign * dot(&map[r], &total));
            }
        }
        sums
    }

    /// The factor of A^T D A for weights D, one for each row.
    pub fn factor(&self, weights: &[f64], pins: Pins) -> Factor<W> {
        let grams: Vec<Block<W>> = self.pairs.par_iter().map(|p| self.gram(p, weights)).collect();
        let mut blocks = vec![zero::<W>(); self.pattern.row.len()];
        for (pair, gram) in self.pairs.iter().zip(&grams) {
            for (k, (a, map, _)) in pair.sides.iter().enumerate() {
                let half = product(map, gram);
                let own = self.pattern.start[self.pattern.place[*a]];
                add(&mut blocks[own], &product(&half, &transposed(map)), 1.0);
                // The other side's block: signs differ.
                let Some((b, other, _)) = pair.sides.get(k + 1) else { continue };
                let cross = product(&half, &transposed(other));
                if let Some((at, rows_of_a)) = self.pattern.block(*a, *b) {
                    add(&mut blocks[at], &if rows_of_a { cross } else { transposed(&cross) }, -1.0);
                }
            }
        }
        Factor::new(&self.pattern, blocks, self.crowd + 2 * W, pins)
    }

    fn gram(&self, pair: &Pair<W>, weights: &[f64]) -> Block<W> {
        let mut gram = zero::<W>();
        for (w, d) in self.wrenches[pair.rows.clone()].iter().zip(&weights[pair.rows.clone()]) {
            for (line, v) in gram.iter_mut().zip(w) {
                let by = v * d;
                (0..W).for_each(|c| line[c] += by * w[c]);
            }
        }
        gram
    }
}

fn wrench<const W: usize>(force: DVec3, moment: DVec3) -> [f64; W] {
    let all = [force.x, force.y, force.z, moment.x, moment.y, moment.z];
    std::array::from_fn(|k| all[k])
}

/// The map from a wrench about a point, moments counted in `lever`, to one about another point `arm` away, moments
/// counted in `own`.
fn frame<const W: usize>(freedom: Freedom, arm: DVec3, lever: f64, own: f64) -> Block<W> {
    let mut map = zero::<W>();
    (0..W).for_each(|k| map[k][k] = if k < 3 { 1.0 } else { lever / own });
    if freedom == Freedom::Rigid {
        let a = arm / own;
        let cross = [[0.0, -a.z, a.y], [a.z, 0.0, -a.x], [-a.y, a.x, 0.0]];
        (0..3).for_each(|r| (0..3).for_each(|c| map[r + 3][c] = cross[r][c]));
    }
    map
}

fn product<const W: usize>(a: &Block<W>, b: &Block<W>) -> Block<W> {
    std::array::from_fn(|r| std::array::from_fn(|c| (0..W).map(|k| a[r][k] * b[k][c]).sum()))
}

fn add<const W: usize>(to: &mut Block<W>, from: &Block<W>, sign: f64) {
    to.iter_mut().zip(from).for_each(|(t, f)| t.iter_mut().zip(f).for_each(|(t, f)| *t += sign * f));
}
