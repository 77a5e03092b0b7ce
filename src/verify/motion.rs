//! Takes a motion as written and all contacts; proves that no contact forbids it, or says which one does.
//!
//! `exact`: a motion (the one written, or one near it that is found here) opens or keeps every row, decided in exact
//! arithmetic. `round-off`: every row that the motion breaks as written is broken by no more than the round-off of the
//! numbers in it: within `bound` of the rows there are rows that it keeps. Not complete: a motion that breaks rows by
//! more, although one near it would not, may be refused.

use super::certificate::{About, Arithmetic, Shown};
use super::dyadic::{self, Dyadic};
use super::mend::{Tight, mended};
use super::stress::ROW_ROUND_OFF;
use crate::assembly::{Assembly, PartIx};
use crate::contact::Patch;
use crate::report::answer::{MotionAnswer, TwistAnswer};
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Openings below this share of the top speed are not told from none, nor breaks from round-off, before anything is
/// decided exactly: room for the solves that made the motion.
const SIGN_ROUND_OFF: f64 = 1e-9;

/// Half a unit in the last place of 1.
const UNIT: f64 = f64::EPSILON / 2.0;

/// The velocity v + w x p of a part, exactly, and nearly.
#[derive(Clone)]
pub struct Twist {
    pub v: [Dyadic; 3],
    pub w: [Dyadic; 3],
    pub near: [DVec3; 2],
}

impl Twist {
    pub fn new(v: [Dyadic; 3], w: [Dyadic; 3]) -> Twist {
        let near = [&v, &w].map(|x| DVec3::from_array([0, 1, 2].map(|k| x[k].value())));
        Twist { v, w, near }
    }

    fn written(t: &TwistAnswer) -> Twist {
        let [v, w, c] = [t.translation, t.rotation, t.centre].map(|a| a.map(Dyadic::of));
        let by = dyadic::cross(&w, &c);
        let v = [0, 1, 2].map(|k| v[k].clone().minus(&by[k]));
        Twist::new(v, w)
    }

    /// Multiples of `step`, nearest to this.
    fn rounded(&self, step: f64) -> Twist {
        let [v, w] = self.near.map(|x| ((x / step).round() * step).to_array().map(Dyadic::of));
        Twist::new(v, w)
    }

    fn at(&self, p: DVec3) -> DVec3 {
        self.near[0] + self.near[1].cross(p)
    }

    /// Bounds each part of `at`, whatever cancels.
    fn size(&self, p: DVec3) -> DVec3 {
        let (w, q) = (self.near[1].abs(), p.abs());
        let cross = DVec3::new(w.y * q.z + w.z * q.y, w.z * q.x + w.x * q.z, w.x * q.y + w.y * q.x);
        self.near[0].abs() + cross
    }
}

/// Twists by part; a part without one stands still.
pub type Twists = Vec<Option<Twist>>;

/// A contact row.
#[derive(Clone, Copy)]
pub struct Row {
    pub a: PartIx,
    pub b: PartIx,
    pub n: DVec3,
    pub p: DVec3,
}

fn rows(patches: &[Patch]) -> impl Iterator<Item = Row> + '_ {
    let of = |q: &Patch, p: DVec3| Row { a: q.a, b: q.b, n: q.normal, p };
    patches.iter().flat_map(move |q| q.corners.iter().map(move |&p| of(q, p)))
}

impl Row {
    fn sides(&self) -> [(PartIx, f64); 2] {
        [(self.a, -1.0), (self.b, 1.0)]
    }

    /// Nearly how fast the contact opens, and a bound of the error of that.
    fn near(&self, x: &Twists) -> (f64, f64) {
        let mut sum = (0.0, 0.0);
        for (part, sign) in self.sides() {
            let Some(t) = &x[part.at()] else { continue };
            sum.0 += sign * self.n.dot(t.at(self.p));
            sum.1 += self.n.abs().dot(t.size(self.p));
        }
        // A term: rounded itself, times a point, into a sum of six, times a normal, into a sum of six.
        (sum.0, 16.0 * UNIT * sum.1 + f64::MIN_POSITIVE)
    }

    fn exact(&self, x: &Twists) -> Dyadic {
        let (n, p) = (dyadic::vector(self.n), dyadic::vector(self.p));
        let mut sum = Dyadic::zero();
        for (part, sign) in self.sides() {
            let Some(t) = &x[part.at()] else { continue };
            let turn = dyadic::cross(&t.w, &p);
            let v = [0, 1, 2].map(|k| t.v[k].clone().plus(&turn[k]));
            let along = dyadic::dot(&n, &v);
            sum = if sign > 0.0 { sum.plus(&along) } else { sum.minus(&along) };
        }
        sum
    }

    fn sign(&self, x: &Twists) -> Ordering {
        let (near, error) = self.near(x);
        // What is no number is left to the exact sum.
        if near > error {
            Ordering::Greater
        } else if near < -error {
            Ordering::Less
        } else {
            self.exact(x).sign()
        }
    }

    /// How far the numbers of this broken row must be off, at least, for it to be kept: the opening over its change for
    /// a unit off in each part of the normal and each coordinate (as a share of the largest).
    fn off(&self, x: &Twists) -> f64 {
        let (mut v, mut w, mut size) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        for (part, sign) in self.sides() {
            let Some(t) = &x[part.at()] else { continue };
            v += sign * t.at(self.p);
            w += sign * t.near[1];
            size += t.size(self.p) + t.near[1].abs() * self.p.abs().max_element();
        }
        let one = |u: DVec3| u.abs().element_sum();
        let change = one(v) + self.p.abs().max_element() * one(w.cross(self.n));
        let sure = change - 64.0 * UNIT * one(size);
        if sure > 0.0 { self.exact(x).size_above() / sure } else { f64::INFINITY }
    }
}

/// A motion that is none of standing still, keeps still parts still, and breaks no contact row.
pub fn motion(
    asm: &Assembly,
    patches: &[Patch],
    m: &MotionAnswer,
    still: &[String],
    about: About,
) -> Result<Shown, String> {
    let x = read(asm, m, still, about)?;
    let speed = asm.ids().flat_map(|p| asm.vertices(p).map(move |v| (p, v)));
    let speed = speed.filter_map(|(p, v)| Some(x[p.at()].as_ref()?.at(v).length())).fold(0.0, f64::max);
    if !(speed > 0.0 && speed.is_finite()) {
        return Err("nothing moves".into());
    }
    let (mut widest, mut tight) = (0.0_f64, Vec::new());
    for row in rows(patches) {
        let (opening, error) = row.near(&x);
        if (opening + error) / speed < -SIGN_ROUND_OFF {
            return Err(approach(asm, &row, opening / speed));
        }
        if opening / speed <= SIGN_ROUND_OFF {
            tight.push(row);
        }
        widest = widest.max(opening / speed);
    }
    match (m.kind.as_str(), widest > SIGN_ROUND_OFF) {
        ("opens", true) | ("slides", false) => {}
        _ => {
            let kind = &m.kind;
            return Err(format!(
                "it is said to be a motion that {kind}, but the widest opening is {widest:.3e}"
            ));
        }
    }
    decided(asm, patches, &x, &tight, about, speed)
}

/// Decides every row exactly, for the motion as written, rounded, or mended; else bounds what the rows are off by.
fn decided(
    asm: &Assembly,
    patches: &[Patch],
    x: &Twists,
    tight: &[Row],
    about: About,
    speed: f64,
) -> Result<Shown, String> {
    let exact = |how: &str| Ok(Shown { how: how.into(), ..Shown::new(Arithmetic::Exact) });
    let keeps = |x: &Twists| rows(patches).all(|r| r.sign(x) != Ordering::Less);
    if keeps(x) {
        return exact("the motion as written breaks no contact row");
    }
    for rounded in simpler(x, speed) {
        if moves(&rounded) && keeps(&rounded) {
            return exact("a motion that rounds to the one written breaks no contact row");
        }
    }
    let tight = Tight { rows: tight, width: about.width(), least: SIGN_ROUND_OFF * speed };
    if mended(x, &tight).is_some_and(|x| moves(&x) && keeps(&x)) {
        return exact("a motion near the one written keeps its tight contacts exactly and breaks none");
    }
    // Parts that move by noise alone stand still: their rows would have to be off by much to excuse it.
    let x = &without_noise(x, speed);
    let broken = rows(patches).filter(|r| r.sign(x) == Ordering::Less);
    let worst = broken.map(|r| (r.off(x), r)).max_by(|a, b| a.0.total_cmp(&b.0));
    match worst {
        Some((bound, _)) if bound <= ROW_ROUND_OFF => Ok(Shown {
            how: format!(
                "free for rows that differ from those written by at most {bound:.1e}, which is round-off"
            ),
            bound: Some(bound),
            ..Shown::new(Arithmetic::RoundOff)
        }),
        Some((bound, row)) => Err(format!(
            "{}: no motion near it was found to keep the rows, which would have to be off by {bound:.1e}, more than \
             round-off ({ROW_ROUND_OFF:.1e})",
            approach(asm, &row, row.near(x).0 / speed)
        )),
        None if moves(x) => {
            exact("the motion as written, without twists that are noise, breaks no contact row")
        }
        None => Err("nothing moves".into()),
    }
}

fn without_noise(x: &Twists, speed: f64) -> Twists {
    let loud = |t: &&Twist| t.near.iter().any(|v| v.abs().max_element() > SIGN_ROUND_OFF * speed);
    x.iter().map(|t| t.as_ref().filter(loud).cloned()).collect()
}

fn moves(x: &Twists) -> bool {
    let some = |t: &Twist| t.v.iter().chain(&t.w).any(|d| d.sign() != Ordering::Equal);
    x.iter().flatten().any(some)
}

/// The motion in ever finer multiples of a power of two: solved numbers that stand for simple ones become those.
fn simpler(x: &Twists, speed: f64) -> impl Iterator<Item = Twists> + '_ {
    let top = 2f64.powi(speed.log2().ceil().clamp(-900.0, 900.0) as i32);
    [8, 16, 24, 32, 40].into_iter().map(move |digits| {
        let step = top * 2f64.powi(-digits);
        x.iter().map(|t| t.as_ref().map(|t| t.rounded(step))).collect()
    })
}

fn approach(asm: &Assembly, row: &Row, opening: f64) -> String {
    let (a, b) = (&asm.part(row.a).id, &asm.part(row.b).id);
    format!("`{a}` and `{b}` approach each other at {}, at {:.3e} of the top speed", row.p, -opening)
}

fn read(asm: &Assembly, m: &MotionAnswer, still: &[String], about: About) -> Result<Twists, String> {
    let twists: BTreeMap<&str, &TwistAnswer> = m.twists.iter().map(|t| (t.part.as_str(), t)).collect();
    if twists.len() != m.twists.len() {
        return Err("a part has two twists".into());
    }
    if let Some(id) = twists.keys().find(|id| still.iter().any(|s| s == *id)) {
        return Err(format!("`{id}` may not move"));
    }
    if let Some(id) = twists.keys().find(|id| asm.parts.iter().all(|p| p.id != **id)) {
        return Err(format!("no part is called `{id}`"));
    }
    if about == About::Translations && m.twists.iter().any(|t| t.rotation != [0.0; 3]) {
        return Err("a translation does not turn".into());
    }
    let numbers = |t: &TwistAnswer| [t.translation, t.rotation, t.centre].concat();
    if m.twists.iter().any(|t| numbers(t).iter().any(|v| !v.is_finite())) {
        return Err("a twist is not a number".into());
    }
    Ok(asm.parts.iter().map(|p| twists.get(p.id.as_str()).map(|t| Twist::written(t))).collect())
}
