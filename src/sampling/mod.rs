//! Takes contacts and a verdict about them; gives its margin, and whether it holds beyond the samples of the tiles.
//!
//! Margins are proven bounds (`locking::margin`). `holds` is said where the verdict is shown for the true curved surfaces
//! at the points that were looked at: a lock by forces there, which is a proof; a motion by openings wider than the
//! errors of the facets at their corners and middles, which leaves out contact that only the true surfaces have.

mod known;
mod refine;

pub use known::{checked, known};
pub use refine::{Level, Refined, refined};

use crate::assembly::PartIx;
use crate::contact::chord::{self, ChordError};
use crate::contact::{Joined, Origin, Patch, Slack};
use crate::locking::digits::{self, Within, rows_with_slack};
use crate::locking::margin::{self, Effort, Weighted};
use crate::locking::{Check, Freedom, Motion, Row, Stress, Unknowns, Verdict, decide, rows};
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

/// By how much the contact rows may be wrong before a verdict falls.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Margin {
    /// In words, what is changed and how it is measured.
    pub norm: String,
    /// Proven: the verdict holds for every smaller change. Null where it was not computed (too many parts).
    pub lower: Option<f64>,
    /// A change of this size is known under which the verdict falls. Null where none was found.
    pub upper: Option<f64>,
}

const NORM: &str =
    "angle in radians by which the normal of every contact is turned, each its own way, its point kept";

/// Whether a verdict about the sampled tiles is shown for the true surfaces too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Beyond {
    Holds,
    Unproven,
}

/// How a verdict stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Standing {
    pub margin: Option<Margin>,
    /// Solids read from meshes are as given and nothing is sampled; but their normals are known to their files'
    /// digits only, and a lock holds where it survives that.
    pub beyond_sampling: Beyond,
    pub beyond_why: String,
}

/// How both verdicts stand, and how far the facets are from the true surfaces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sampling {
    #[serde(flatten)]
    pub rigid: Standing,
    pub translation_standing: Standing,
    /// Largest angle between a facet's normal and the true surface's, near its corners and at its middle, radians; 0 for
    /// meshes; null where there are too many contacts to measure.
    pub chord_error: Option<f64>,
    /// Largest distance there of a facet from the true surface, model units; null where a facet is near none.
    pub chord_distance: Option<f64>,
}

/// Contact patches up to which margins and errors are measured: some seconds.
pub const MOST_PATCHES: usize = 100_000;

/// Where contacts are too many for more: the bound for many parts, and no more.
fn not_measured(joined: &Joined, freedom: Freedom, verdict: &Verdict, still: &[PartIx]) -> Standing {
    let margin = match verdict {
        Verdict::Locked(stress) => {
            let rows: Vec<Row> = stress.forces.iter().map(|f| f.row).collect();
            let unknowns = Unknowns::new(&joined.assembly, &rows, still, freedom);
            let lower = margin::of_many(stress, &unknowns);
            Some(Margin { norm: NORM.into(), lower, upper: None })
        }
        _ => None,
    };
    let (beyond_sampling, beyond_why) = match &joined.origin {
        Origin::Meshes => as_given(),
        Origin::Woven(_) => (Beyond::Unproven, format!("not measured for more than {MOST_PATCHES} contacts")),
    };
    Standing { margin, beyond_sampling, beyond_why }
}

/// How the verdicts of a check stand.
pub fn standing(joined: &Joined, check: &Check) -> Sampling {
    let still: Vec<PartIx> = check.held.iter().copied().chain(check.fixed).collect();
    if joined.patches.len() > MOST_PATCHES {
        let rigid = not_measured(joined, Freedom::Rigid, &check.rigid, &still);
        let translation_standing = not_measured(joined, Freedom::Translation, &check.translation, &still);
        return Sampling { rigid, translation_standing, chord_error: None, chord_distance: None };
    }
    let ground = Ground::new(joined, still);
    let largest = match joined.origin {
        Origin::Woven(_) => chord::largest(&ground.errors),
        Origin::Meshes => EXACT,
    };
    Sampling {
        rigid: ground.standing(Freedom::Rigid, &check.rigid),
        translation_standing: ground.standing(Freedom::Translation, &check.translation),
        chord_error: Some(largest.angle),
        chord_distance: largest.distance.is_finite().then_some(largest.distance),
    }
}

/// What both verdicts are held against.
struct Ground<'a> {
    joined: &'a Joined,
    still: Vec<PartIx>,
    /// For each patch.
    errors: Vec<ChordError>,
}

const EXACT: ChordError = ChordError { angle: 0.0, distance: 0.0 };

impl Ground<'_> {
    fn new(joined: &Joined, still: Vec<PartIx>) -> Ground<'_> {
        let errors = match &joined.origin {
            Origin::Woven(woven) => chord::errors(woven, &joined.patches),
            Origin::Meshes => {
                joined.slack.iter().map(|s| ChordError { angle: s.angle, distance: s.distance }).collect()
            }
        };
        Ground { joined, still, errors }
    }

    fn standing(&self, freedom: Freedom, verdict: &Verdict) -> Standing {
        match verdict {
            Verdict::Locked(stress) => self.locked(&self.weighed(freedom), stress),
            Verdict::Free(motion) => self.free(&self.weighed(freedom), motion),
            Verdict::Undecided(_) => Standing {
                margin: None,
                beyond_sampling: Beyond::Unproven,
                beyond_why: "the verdict is undecided".into(),
            },
        }
    }

    fn weighed(&self, freedom: Freedom) -> Weighed {
        let rows = rows(&self.joined.patches, freedom);
        let unknowns = Unknowns::new(&self.joined.assembly, &rows, &self.still, freedom);
        let errors = self.of_rows(&rows);
        Weighed { rows, unknowns, errors }
    }

    /// The largest error of the patches that a row stands for.
    fn of_rows(&self, rows: &[Row]) -> Vec<ChordError> {
        let bits = |v: DVec3| v.to_array().map(f64::to_bits);
        let mut by: BTreeMap<_, ChordError> = BTreeMap::new();
        for (q, e) in self.joined.patches.iter().zip(&self.errors) {
            let entry = by.entry((q.a, q.b, bits(q.normal))).or_insert(EXACT);
            *entry = chord::largest(&[*entry, *e]);
        }
        rows.iter().map(|r| by.get(&(r.a, r.b, bits(r.normal))).copied().unwrap_or(EXACT)).collect()
    }

    fn locked(&self, of: &Weighed, stress: &Stress) -> Standing {
        let speeds = margin::speeds(&of.rows, &of.unknowns);
        let bound = margin::lock(&of.weighted(speeds), stress, Effort::Programs);
        let few = bound.as_ref().map(|b| b.lower).filter(|l| l.is_finite());
        let margin = Margin {
            norm: NORM.into(),
            lower: few.into_iter().chain(margin::of_many(stress, &of.unknowns)).reduce(f64::max),
            upper: bound.as_ref().and_then(|b| margin::shown(&of.rows, &of.unknowns, &b.near)),
        };
        let (beyond_sampling, beyond_why) = self.lock_beyond(of, stress, &margin);
        Standing { margin: Some(margin), beyond_sampling, beyond_why }
    }

    fn lock_beyond(&self, of: &Weighed, stress: &Stress, margin: &Margin) -> (Beyond, String) {
        let most = chord::largest(&of.errors);
        if of.unknowns.count == 0 || most.angle == 0.0 {
            return (Beyond::Holds, "the facets are parts of the true surfaces".into());
        }
        let what = match self.joined.origin {
            Origin::Woven(_) => "the facets' errors",
            Origin::Meshes => "what the files' digits leave open",
        };
        let survives = match self.joined.origin {
            Origin::Meshes => {
                let (rows, slack) =
                    rows_with_slack(&self.joined.patches, &self.joined.slack, of.unknowns.freedom);
                matches!(digits::within(&rows, &of.unknowns, &slack, stress), Within::Survives)
            }
            // Facets err by so much that more effort is in vain where the plain bound falls.
            Origin::Woven(_) => {
                let slack: Vec<Slack> =
                    of.errors.iter().map(|e| Slack { angle: e.angle, distance: e.distance }).collect();
                let change = digits::changes(&of.rows, &of.unknowns, &slack);
                change.iter().all(|c| c.is_finite())
                    && margin::lock(&of.weighted(change), stress, Effort::Plain)
                        .is_some_and(|b| b.lower > 1.0)
            }
        };
        if survives {
            return (Beyond::Holds, format!("the lock survives every change of the contacts within {what}"));
        }
        let Origin::Woven(woven) = &self.joined.origin else {
            let known = self.joined.slack.iter().map(|s| s.angle).filter(|a| *a < FRAC_PI_2);
            let why = format!(
                "the lock leans on normals known to {:.1e} rad at worst, and is not shown to survive that",
                known.fold(0.0, f64::max)
            );
            return (Beyond::Unproven, why);
        };
        let on_curves = chord::true_contacts(woven, &self.joined.patches);
        if self.locks(&on_curves, of.unknowns.freedom) {
            let n = on_curves.len();
            return (Beyond::Holds, format!("{n} contacts computed on the true surfaces lock by themselves"));
        }
        let lower = margin.lower.map_or("not known".into(), |l| format!("{l:.1e}"));
        let why = format!(
            "the margin ({lower}) is below the facets' error ({:.1e}), and no lock was found from contacts on the true \
             surfaces",
            most.angle
        );
        (Beyond::Unproven, why)
    }

    fn locks(&self, patches: &[Patch], freedom: Freedom) -> bool {
        let rows = rows(patches, freedom);
        let unknowns = Unknowns::new(&self.joined.assembly, &rows, &self.still, freedom);
        matches!(decide(&rows, &unknowns), Verdict::Locked(_))
    }

    fn free(&self, of: &Weighed, motion: &Motion) -> Standing {
        let lower = margin::motion(&of.rows, motion);
        let margin = Some(Margin { norm: NORM.into(), lower: Some(lower), upper: None });
        let (beyond_sampling, beyond_why) = match &self.joined.origin {
            Origin::Meshes => as_given(),
            Origin::Woven(woven) => {
                let bare = chord::true_contacts(woven, &self.joined.patches);
                let kept = margin::opens(&of.rows, motion, &of.errors_of_rows())
                    && margin::opens(&rows(&bare, of.unknowns.freedom), motion, &[]);
                if kept {
                    (Beyond::Holds, "every contact opens by more than its facet's error, or is exact".into())
                } else {
                    let why = "some contact opens by less than its facet's error";
                    (Beyond::Unproven, why.into())
                }
            }
        };
        Standing { margin, beyond_sampling, beyond_why }
    }
}

fn as_given() -> (Beyond, String) {
    (Beyond::Holds, "the solids are as given: nothing was sampled".into())
}

/// Rows with their errors.
struct Weighed {
    rows: Vec<Row>,
    unknowns: Unknowns,
    errors: Vec<ChordError>,
}

impl Weighed {
    fn weighted(&self, weights: Vec<f64>) -> Weighted<'_> {
        Weighted { rows: self.rows.clone(), unknowns: &self.unknowns, weights }
    }

    /// Angle and distance for each row.
    fn errors_of_rows(&self) -> Vec<(f64, f64)> {
        self.errors.iter().map(|e| (e.angle, e.distance)).collect()
    }
}
