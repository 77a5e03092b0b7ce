//! Takes a lock and by how much each of its contact rows may be off; gives whether it survives every such change, falls
//! to one, or neither is shown.
//!
//! `Survives` is proven (the margin of `margin`). `Open` comes with a motion that some rows within the changes allow.
//! Not complete: motions are tried, not all, and the margin is not tight; what neither reaches is `Unproven`.

use super::many;
use super::margin::{self, Effort, Weighted};
use super::rows::{Freedom, Row, Unknowns, rows};
use super::{Gap, Motion, ROUND_OFF, Stress, Verdict, decide};
use crate::assembly::PartIx;
use crate::contact::{Patch, Slack};
use glam::DVec3;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

/// What becomes of a lock within the slack of its rows.
#[derive(Clone, Debug)]
pub enum Within {
    /// It holds for all rows within the slack.
    Survives,
    Unproven,
    /// Rows within the slack allow this motion.
    Open(Motion),
}

/// Motions from which an opening is looked for, and how often each is followed: each step is one verdict and one bound.
const STARTS: usize = 6;
const STEPS: usize = 4;

/// Unknowns up to which motions are followed: the bounds' programs stop there too.
const MOST_UNKNOWNS: usize = 120;

/// The lock, or undecided where rows within the slack let a motion pass.
pub fn guarded(rows: &[Row], unknowns: &Unknowns, slack: &[Slack], verdict: Verdict) -> Verdict {
    let Verdict::Locked(stress) = verdict else { return verdict };
    let (rows, slack) = telling(rows, slack);
    // A lock by rows that tell something is the better proof.
    let stress = match leaning(&rows, unknowns, &slack, &stress) {
        Some(Verdict::Locked(firmer)) => firmer,
        Some(Verdict::Free(_)) => return Verdict::Undecided(open(&slack)),
        Some(Verdict::Undecided(_)) | None => stress,
    };
    match within(&rows, unknowns, &slack, &stress) {
        Within::Open(_) => Verdict::Undecided(open(&slack)),
        Within::Survives | Within::Unproven => Verdict::Locked(stress),
    }
}

/// Rows whose normals are known to better than a right angle. Any other gives way to every motion: some normal within a right
/// angle of its own lets it pass.
fn telling(rows: &[Row], slack: &[Slack]) -> (Vec<Row>, Vec<Slack>) {
    rows.iter().zip(slack).filter(|(_, s)| s.angle < FRAC_PI_2).map(|(r, s)| (*r, *s)).unzip()
}

/// Where a lock leans on rows other than these: what these say by themselves.
fn leaning(rows: &[Row], unknowns: &Unknowns, slack: &[Slack], stress: &Stress) -> Option<Verdict> {
    slack_of_forces(rows, slack, stress).is_none().then(|| decide(rows, unknowns))
}

/// Why such a lock is undecided.
pub fn open(slack: &[Slack]) -> Gap {
    Gap {
        why: "locked as written, but the files' digits leave open a motion: contact normals and points within them let \
              it pass (normals are known to so many radians)"
            .into(),
        size: slack.iter().map(|s| s.angle).filter(|a| *a < FRAC_PI_2).fold(0.0, f64::max),
    }
}

/// Rows of patches with the slack of each (exact where it has none). Where several patches stand behind one row the least:
/// each of them is a contact of its own.
pub fn rows_with_slack(patches: &[Patch], slack: &[Slack], freedom: Freedom) -> (Vec<Row>, Vec<Slack>) {
    let own = |k: usize| slack.get(k).copied().unwrap_or_default();
    let rows = rows(patches, freedom);
    let mut least = BTreeMap::new();
    for (k, patch) in patches.iter().enumerate() {
        for &point in &patch.corners {
            let row = Row { a: patch.a, b: patch.b, normal: patch.normal, point };
            least.entry(place(&row, freedom)).and_modify(|s| *s = firmer(*s, own(k))).or_insert(own(k));
        }
    }
    let of = rows.iter().map(|r| least.get(&place(r, freedom)).copied().unwrap_or_default()).collect();
    (rows, of)
}

/// What tells rows apart; where nothing turns, points do not count.
fn place(row: &Row, freedom: Freedom) -> (PartIx, PartIx, [u64; 3], [u64; 3]) {
    let bits = |v: DVec3| v.to_array().map(f64::to_bits);
    let point = match freedom {
        Freedom::Translation => DVec3::ZERO,
        Freedom::Rigid => row.point,
    };
    (row.a, row.b, bits(row.normal), bits(point))
}

/// The one whose normal is known better.
fn firmer(a: Slack, b: Slack) -> Slack {
    if (b.angle, b.distance) < (a.angle, a.distance) { b } else { a }
}

/// What becomes of the lock within the slack.
pub fn within(rows: &[Row], unknowns: &Unknowns, slack: &[Slack], stress: &Stress) -> Within {
    if unknowns.count == 0 || slack.iter().all(|s| *s == Slack::default()) {
        return Within::Survives;
    }
    let (rows, slack) = telling(rows, slack);
    match leaning(&rows, unknowns, &slack, stress) {
        None => shown(&rows, unknowns, &slack, stress),
        Some(Verdict::Locked(stress)) => shown(&rows, unknowns, &slack, &stress),
        Some(Verdict::Free(motion)) => Within::Open(motion),
        Some(Verdict::Undecided(_)) => Within::Unproven,
    }
}

/// The same for rows that all tell something.
fn shown(rows: &[Row], unknowns: &Unknowns, slack: &[Slack], stress: &Stress) -> Within {
    if slack_of_forces(rows, slack, stress).is_some_and(|own| many::survives(stress, &own, unknowns) > 1.0) {
        return Within::Survives;
    }
    let problem = Weighted { rows: rows.to_vec(), unknowns, weights: changes(rows, unknowns, slack) };
    if problem.weights.iter().any(|c| !c.is_finite()) {
        return Within::Unproven;
    }
    // First without programs: most locks survive by far.
    let mut near = Vec::new();
    for effort in [Effort::Plain, Effort::Programs] {
        match margin::lock(&problem, stress, effort) {
            None => break,
            Some(bound) if bound.lower > 1.0 => return Within::Survives,
            Some(bound) => near = bound.near,
        }
    }
    let field = Field { rows, unknowns, slack };
    field.opened(margin::tried(rows, unknowns, &near)).map_or(Within::Unproven, Within::Open)
}

/// The slack of the rows that carry a force; none where one is not among the rows.
fn slack_of_forces(rows: &[Row], slack: &[Slack], stress: &Stress) -> Option<Vec<Slack>> {
    let key = |r: &Row| place(r, Freedom::Rigid);
    let of: BTreeMap<_, Slack> = rows.iter().zip(slack).map(|(r, s)| (key(r), *s)).collect();
    stress.forces.iter().map(|f| of.get(&key(&f.row)).copied()).collect()
}

/// By how much each row may change over the unit box: turning by an angle moves a unit normal by less, a point elsewhere
/// moves with the rate of turning.
pub fn changes(rows: &[Row], unknowns: &Unknowns, slack: &[Slack]) -> Vec<f64> {
    let speeds = margin::speeds(rows, unknowns);
    let turnings = margin::turnings(rows, unknowns);
    let change = |((s, v), w): ((&Slack, f64), f64)| s.angle * (v + s.distance * w) + s.distance * w;
    slack.iter().zip(speeds).zip(turnings).map(change).collect()
}

struct Field<'a> {
    rows: &'a [Row],
    unknowns: &'a Unknowns,
    slack: &'a [Slack],
}

impl Field<'_> {
    /// A motion that rows within the slack allow, found from these and their opposites.
    fn opened(&self, motions: Vec<Vec<f64>>) -> Option<Motion> {
        let back = |x: &Vec<f64>| x.iter().map(|v| -v).collect::<Vec<f64>>();
        let all: Vec<Vec<f64>> = motions.iter().flat_map(|x| [x.clone(), back(x)]).collect();
        let mut order: Vec<(f64, Vec<f64>)> = all.into_iter().map(|x| (self.lacks(&x), x)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        order.into_iter().take(STARTS).find_map(|(lacks, x)| self.followed(lacks, x))
    }

    /// Gives way to a motion, asks what the rows then allow or nearly allow, and so on.
    fn followed(&self, mut lacks: f64, mut x: Vec<f64>) -> Option<Motion> {
        for _ in 0..STEPS {
            let rows: Vec<Row> =
                self.rows.iter().zip(self.slack).map(|(r, s)| self.yielding(r, s, &x)).collect();
            let stress = match decide(&rows, self.unknowns) {
                Verdict::Free(motion) => return Some(motion),
                Verdict::Locked(stress) => stress,
                Verdict::Undecided(_) => return None,
            };
            if self.unknowns.count > MOST_UNKNOWNS {
                return None;
            }
            let problem = Weighted {
                weights: changes(&rows, self.unknowns, self.slack),
                rows,
                unknowns: self.unknowns,
            };
            let near = margin::lock(&problem, &stress, Effort::Programs)?.near;
            let next = near.into_iter().map(|x| (self.lacks(&x), x)).min_by(|a, b| a.0.total_cmp(&b.0))?;
            // Not nearer by a tenth: it does not come through.
            if next.0 > 0.9 * lacks {
                return None;
            }
            (lacks, x) = next;
        }
        None
    }

    /// How many times its slack the worst row would have to give for the motion to pass; 1 or less: it passes.
    fn lacks(&self, x: &[f64]) -> f64 {
        let size = x.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let of = |(row, s): (&Row, &Slack)| {
            let into = -self.unknowns.opening(row, x) - ROUND_OFF * size;
            let (v, w) = margin::velocity(row, self.unknowns, x);
            if into > 0.0 { into / (v.length() * s.angle.sin() + w.length() * s.distance) } else { 0.0 }
        };
        self.rows.iter().zip(self.slack).map(of).fold(0.0, f64::max)
    }

    /// The row within its slack that gives way most to the motion.
    fn yielding(&self, row: &Row, slack: &Slack, x: &[f64]) -> Row {
        let (v, w) = margin::velocity(row, self.unknowns, x);
        // Moving the point by s opens it by n . (w x s) more.
        let point = row.point + slack.distance * row.normal.cross(w).normalize_or_zero();
        let across = v.reject_from_normalized(row.normal).normalize_or_zero();
        let turn = slack.angle.min(row.normal.angle_between(v));
        let normal = if turn > 0.0 { row.normal * turn.cos() + across * turn.sin() } else { row.normal };
        Row { normal: normal.normalize_or(row.normal), point, ..*row }
    }
}
