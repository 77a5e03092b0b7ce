//! Takes an assembly and a plan, says whether the plan holds: each move along its whole way, and the book-keeping.
//!
//! Shares no code with the stages that made the plan, only its shape as written. Sound for the solids' convex cells,
//! which are themselves checked against the solid; complete up to the tolerance: a plan that overlaps by less may be
//! accepted. Not checked: the locks that a plan quotes for sets that stayed together (they have their own check).

mod lp;
mod way;

pub use way::{Ball, Gap, Way, by_faces, by_program, gap};

use crate::assembly::{Assembly, Mobility, PartIx};
use crate::sequence::{Outcome, Plan, Step};
use crate::solid::{Cell, Solid};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Radius of the largest ball that may fit into two parts at once, as a share of the smallest part's box diagonal:
/// 2^-20, far above round-off (2^-40) carried over the longest way and far below what can be made. Parts whose corners
/// are known no better than that (meshes with few digits) are checked to twice what these may be off.
pub const TOLERANCE_SHARE: f64 = 1.0 / (1u64 << 20) as f64;

/// How far a direction's length may be from 1, and a length from its value in mm, as a share: nine digits.
const WRITTEN_SHARE: f64 = 1e-9;

#[derive(Clone, Debug, PartialEq)]
pub enum Checked {
    /// `clear`: distance that all moves keep, model units, as claimed and checked; `deepest`: no larger ball fits into
    /// two parts at once anywhere (0 where they only touch).
    Valid { clear: f64, deepest: f64 },
    /// `step`: index, or the number of steps where the fault is in the whole. `t`: where along the way.
    Invalid { step: usize, parts: Vec<String>, depth: f64, t: f64, why: String },
    /// Neither could be shown.
    Undecided { why: String },
}

/// Checks a plan for the whole assembly.
pub fn check<C>(asm: &Assembly, plan: &Plan<C>) -> Checked {
    check_of(asm, &asm.ids().collect::<Vec<_>>(), plan)
}

/// Checks a plan for some of the parts; the others are not there.
pub fn check_of<C>(asm: &Assembly, parts: &[PartIx], plan: &Plan<C>) -> Checked {
    let scene = match Scene::new(asm, parts) {
        Ok(scene) => scene,
        Err(why) => return Checked::Undecided { why },
    };
    let moves = match scene.book(plan) {
        Ok(moves) => moves,
        Err(fault) => return *fault,
    };
    let ways: Vec<Checked> = moves.par_iter().enumerate().map(|(k, m)| scene.walk(k, m)).collect();
    let (mut clear, mut deepest) = (f64::INFINITY, 0.0);
    for way in ways {
        match way {
            Checked::Valid { clear: c, deepest: d } => {
                (clear, deepest) = (f64::min(clear, c), f64::max(deepest, d))
            }
            fault => return fault,
        }
    }
    Checked::Valid { clear: if clear.is_finite() { clear } else { 0.0 }, deepest }
}

type Parts = BTreeSet<PartIx>;

/// A step with its ids looked up.
struct Move {
    moved: Parts,
    stays: Parts,
    way: Way,
    /// As the plan claims it.
    clear: f64,
}

struct Placed {
    cell: Cell,
    lo: DVec3,
    hi: DVec3,
}

/// The parts in place, cell by cell.
struct Scene<'a> {
    asm: &'a Assembly,
    ids: BTreeMap<&'a str, PartIx>,
    cells: BTreeMap<PartIx, Vec<Placed>>,
    tolerance: f64,
}

impl<'a> Scene<'a> {
    fn new(asm: &'a Assembly, parts: &[PartIx]) -> Result<Scene<'a>, String> {
        if let Some(p) = parts.iter().find(|p| p.at() >= asm.parts.len()) {
            return Err(format!("there is no part number {}", p.0));
        }
        let ids: BTreeMap<&str, PartIx> = parts.iter().map(|&p| (asm.part(p).id.as_str(), p)).collect();
        let cells: BTreeMap<PartIx, Vec<Placed>> =
            parts.iter().map(|&p| (p, asm.cells(p).into_iter().map(placed).collect())).collect();
        let diagonal = |cells: &Vec<Placed>| {
            let (lo, hi) = box_of(cells);
            (hi - lo).length()
        };
        let share = TOLERANCE_SHARE * cells.values().map(diagonal).fold(f64::INFINITY, f64::min);
        let solids: BTreeSet<usize> = parts.iter().map(|&p| asm.part(p).solid).collect();
        // Two faces that are meant to touch overlap by what the corners of both stand off them.
        let tolerance = solids.iter().map(|&s| 2.0 * asm.solids[s].off).fold(share, f64::max);
        for s in solids {
            cells_fill(asm, s, tolerance).map_err(|why| format!("solid {s}: {why}"))?;
        }
        Ok(Scene { asm, ids, cells, tolerance })
    }

    /// Sets split as the steps say, nothing held moves, and in the end all is as the outcome claims.
    fn book<C>(&self, plan: &Plan<C>) -> Result<Vec<Move>, Box<Checked>> {
        let mut sets: BTreeSet<Parts> = BTreeSet::from([self.ids.values().copied().collect()]);
        let mut moves = Vec::new();
        for (k, step) in plan.steps.iter().enumerate() {
            let fault = |parts: &[String], why: &str| Box::new(refuse(k, parts, 0.0, 0.0, why));
            let m = self.read(step).map_err(|(parts, why)| fault(&parts, &why))?;
            if m.moved.iter().any(|&p| self.asm.part(p).mobility == Mobility::Held) {
                return Err(fault(&step.parts, "a held part moves"));
            }
            if m.moved.is_empty() || m.stays.is_empty() || !m.moved.is_disjoint(&m.stays) {
                return Err(fault(
                    &step.parts,
                    "what moves and what stays must be two sets without a common part",
                ));
            }
            if !sets.remove(&m.moved.union(&m.stays).copied().collect()) {
                return Err(fault(
                    &step.parts,
                    "the parts named are not one of the sets that are still together",
                ));
            }
            sets.extend([m.moved.clone(), m.stays.clone()]);
            moves.push(m);
        }
        let end = plan.steps.len();
        self.ends(&sets, plan).map_err(|why| Box::new(refuse(end, &[], 0.0, 0.0, why)))?;
        Ok(moves)
    }

    fn read(&self, step: &Step) -> Result<Move, (Vec<String>, String)> {
        let find = |ids: &[String]| -> Result<Parts, (Vec<String>, String)> {
            let one = |id: &String| self.ids.get(id.as_str()).copied();
            let set =
                ids.iter().map(|id| one(id).ok_or_else(|| (vec![id.clone()], "no such part".to_owned())));
            let set = set.collect::<Result<Parts, _>>()?;
            if set.len() == ids.len() {
                Ok(set)
            } else {
                Err((ids.to_vec(), "a part is named twice".to_owned()))
            }
        };
        let direction = DVec3::from_array(step.direction);
        let mm = step.distance * self.asm.mm_per_unit;
        let why = match () {
            _ if !near(direction.length(), 1.0) => "the direction is not a unit vector",
            _ if !(step.distance > 0.0 && step.distance.is_finite()) => {
                "the distance is not a positive number"
            }
            _ if !near(step.distance_mm, mm) => "the distance in mm is another one",
            _ if !(step.clear >= 0.0 && step.clear.is_finite()) => {
                "the least distance kept is no such number"
            }
            _ => "",
        };
        if !why.is_empty() {
            return Err((step.parts.clone(), why.to_owned()));
        }
        let way = Way { direction, length: step.distance };
        Ok(Move { moved: find(&step.parts)?, stays: find(&step.stays)?, way, clear: step.clear })
    }

    fn ends<C>(&self, sets: &BTreeSet<Parts>, plan: &Plan<C>) -> Result<(), &'static str> {
        let held = |s: &Parts| s.iter().all(|&p| self.asm.part(p).mobility == Mobility::Held);
        let together: BTreeSet<Parts> = sets.iter().filter(|s| s.len() > 1 && !held(s)).cloned().collect();
        let named =
            |ids: &Vec<String>| ids.iter().filter_map(|id| self.ids.get(id.as_str()).copied()).collect();
        let claimed: BTreeSet<Parts> = plan.stuck.iter().map(|s| named(&s.parts)).collect();
        let apart = plan.outcome == Outcome::Assembled;
        match (together == claimed, together.is_empty() == apart) {
            (false, _) => Err("the sets left together are not those that the plan names"),
            (_, false) => Err("the outcome does not fit the sets left together"),
            _ => Ok(()),
        }
    }

    /// One move: clear at its end, and no overlap on its way.
    fn walk(&self, step: usize, m: &Move) -> Checked {
        let names = |parts: &[PartIx]| parts.iter().map(|&p| self.asm.part(p).id.clone()).collect::<Vec<_>>();
        let short = self.short_of_clear(m);
        if short > self.tolerance {
            let moved: Vec<PartIx> = m.moved.iter().copied().collect();
            return refuse(
                step,
                &names(&moved),
                short,
                m.way.length,
                "at its end the move is not clear of the rest",
            );
        }
        let mut deepest = 0.0f64;
        for (&a, &b) in m.moved.iter().flat_map(|a| m.stays.iter().map(move |b| (a, b))) {
            for (x, y) in self.near(a, b, m.way, self.tolerance.max(m.clear)) {
                let Some(ball) = self.ball(x, y, m.way) else { return unsolved(step) };
                if ball.radius > self.tolerance {
                    return refuse(
                        step,
                        &names(&[a, b]),
                        ball.radius,
                        ball.at,
                        "the parts overlap on the way",
                    );
                }
                deepest = deepest.max(ball.radius);
                if m.clear > self.tolerance && -2.0 * ball.radius < m.clear {
                    let Some(gap) = gap(&x.cell, &y.cell, m.way) else { return unsolved(step) };
                    if gap.distance < m.clear - self.tolerance {
                        return refuse(
                            step,
                            &names(&[a, b]),
                            0.0,
                            gap.at,
                            "the parts come nearer than the plan says",
                        );
                    }
                }
            }
        }
        Checked::Valid { clear: m.clear, deepest }
    }

    fn ball(&self, x: &Placed, y: &Placed, way: Way) -> Option<Ball> {
        let radius = by_faces(&x.cell, &y.cell, way);
        if radius <= self.tolerance {
            return Some(Ball { radius, at: 0.0 });
        }
        by_program(&x.cell, &y.cell, way)
    }

    /// Pairs of cells whose boxes come within `margin` on the way.
    fn near(&self, a: PartIx, b: PartIx, way: Way, margin: f64) -> impl Iterator<Item = (&Placed, &Placed)> {
        let run = way.direction * way.length;
        let meets = move |(alo, ahi): (DVec3, DVec3), (blo, bhi): (DVec3, DVec3)| {
            let (alo, ahi) = (alo.min(alo + run) - margin, ahi.max(ahi + run) + margin);
            alo.cmple(bhi).all() && blo.cmple(ahi).all()
        };
        let (xs, ys) = (&self.cells[&a], &self.cells[&b]);
        let (whole, open) = (box_of(ys), meets(box_of(xs), box_of(ys)));
        let xs = xs.iter().filter(move |x| open && meets((x.lo, x.hi), whole));
        xs.flat_map(move |x| {
            ys.iter().filter(move |y| meets((x.lo, x.hi), (y.lo, y.hi))).map(move |y| (x, y))
        })
    }

    /// How much further the move would have to go until a plane across it parts the moved from the rest.
    fn short_of_clear(&self, m: &Move) -> f64 {
        let along = |parts: &Parts| -> (f64, f64) {
            let corners = parts.iter().flat_map(|p| &self.cells[p]).flat_map(|c| &c.cell.vertices);
            corners
                .map(|v| v.dot(m.way.direction))
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), s| (l.min(s), h.max(s)))
        };
        along(&m.stays).1 - along(&m.moved).0 - m.way.length
    }
}

/// False for what is no number.
fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= WRITTEN_SHARE * expected.abs()
}

fn unsolved(step: usize) -> Checked {
    Checked::Undecided { why: format!("step {step}: a program was not solved") }
}

fn refuse(step: usize, parts: &[String], depth: f64, t: f64, why: &str) -> Checked {
    Checked::Invalid { step, parts: parts.to_vec(), depth, t, why: why.to_owned() }
}

fn placed(cell: Cell) -> Placed {
    let lo = cell.vertices.iter().fold(DVec3::INFINITY, |m, v| m.min(*v));
    let hi = cell.vertices.iter().fold(DVec3::NEG_INFINITY, |m, v| m.max(*v));
    Placed { cell, lo, hi }
}

fn box_of(cells: &[Placed]) -> (DVec3, DVec3) {
    cells.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), c| (lo.min(c.lo), hi.max(c.hi)))
}

/// Whether the cells may stand for the solid: faces, corners and planes agree, none is so thin that overlaps could hide
/// in it, and their volumes add up to the solid's.
fn cells_fill(asm: &Assembly, solid: usize, tolerance: f64) -> Result<(), String> {
    /// Balls of four tolerances must fit, or a stack of slivers could hide an overlap from a test of single cells.
    const LEAST_BALL: f64 = 4.0;
    /// Share of the volume that round-off may lose: corners are known to 2^-40, cells to a fraction of the solid.
    const VOLUME_SHARE: f64 = 1e-6;
    let solid = &asm.solids[solid];
    if solid.cells.is_empty() {
        return Err("no convex cells are known".to_owned());
    }
    let mut volume = 0.0;
    for (k, cell) in solid.cells.iter().enumerate() {
        agrees(cell, tolerance).map_err(|why| format!("cell {k}: {why}"))?;
        let still = Way { direction: DVec3::Z, length: 0.0 };
        let room = by_program(cell, cell, still).map_or(0.0, |ball| ball.radius);
        if room < LEAST_BALL * tolerance {
            return Err(format!("cell {k} is thinner than the tolerance"));
        }
        volume += volume_of(cell);
    }
    let (whole, surface) = (solid.volume(), surface(solid));
    if (volume - whole).abs() <= VOLUME_SHARE * whole.abs() + solid.off * surface {
        Ok(())
    } else {
        Err(format!("the cells hold {volume}, the solid {whole}"))
    }
}

fn agrees(cell: &Cell, tolerance: f64) -> Result<(), &'static str> {
    if cell.planes.len() != cell.facets.len() {
        return Err("as many planes as facets are needed");
    }
    let off = |n: DVec3, d: f64, v: DVec3| n.dot(v) - d;
    for (&(n, d), facet) in cell.planes.iter().zip(&cell.facets) {
        let on = |&k: &u32| cell.vertices.get(k as usize).is_some_and(|&v| off(n, d, v).abs() <= tolerance);
        if !near(n.length(), 1.0) {
            return Err("a plane's normal is not a unit vector");
        }
        if !facet.iter().all(on) || !cell.vertices.iter().all(|&v| off(n, d, v) <= tolerance) {
            return Err("corners and planes do not agree");
        }
    }
    Ok(())
}

fn surface(solid: &Solid) -> f64 {
    let at = |i: u32| solid.vertices[i as usize];
    solid.triangles().map(|[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)).length() / 2.0).sum()
}

/// By the divergence theorem over the facets, as fans.
fn volume_of(cell: &Cell) -> f64 {
    let Some(&o) = cell.vertices.first() else { return 0.0 };
    let fan = |f: &Vec<u32>| -> f64 {
        let at = |k: usize| cell.vertices[f[k] as usize] - o;
        (1..f.len().saturating_sub(1)).map(|k| at(0).dot(at(k).cross(at(k + 1)))).sum()
    };
    cell.facets.iter().map(fan).sum::<f64>() / 6.0
}
