//! Takes a spec; gives its verdicts at more and more samples, until they stand or the budget ends.
//!
//! Stands: the same verdict at two successive levels, the last of which holds beyond its samples. Not promised: anything
//! about levels that were not computed.

use super::{Beyond, standing};
use crate::contact::join;
use crate::fault::Faults;
use crate::locking::check;
use crate::spec::{Spec, Subject};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One number of samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Level {
    pub samples: u32,
    pub verdict: String,
    pub translation: String,
    pub rows: usize,
    /// Proven lower bound of the verdict's margin, radians.
    pub margin: Option<f64>,
    pub chord_error: Option<f64>,
    pub beyond_sampling: Beyond,
}

/// What refinement showed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Refined {
    /// Samples doubled from one to the next.
    pub levels: Vec<Level>,
    pub stands: Beyond,
    pub why: String,
}

/// Most samples that a spec may have.
const MOST_SAMPLES: u32 = 64;

/// A level is not begun where the one before had more rows than this: the next has about four times as many.
pub const MOST_ROWS: usize = 200_000;

/// Repeats the check with doubled samples.
pub fn refined(spec: &Spec) -> Result<Refined, Faults> {
    let mut levels: Vec<Level> = Vec::new();
    let Subject::Woven(woven) = &spec.subject else {
        let why = "the solids are as given: there are no samples to refine".to_string();
        return Ok(Refined { levels, stands: Beyond::Holds, why });
    };
    let mut samples = woven.profile.samples;
    loop {
        levels.push(level(spec, samples)?);
        if let Some((stands, why)) = ended(&levels) {
            return Ok(Refined { levels, stands, why });
        }
        samples *= 2;
    }
}

fn level(spec: &Spec, samples: u32) -> Result<Level, Faults> {
    let mut finer = spec.clone();
    if let Subject::Woven(woven) = &mut finer.subject {
        woven.profile.samples = samples;
    }
    let joined = join(&finer)?;
    let check = check(&joined.assembly, &joined.patches, None);
    let found = standing(&joined, &check);
    Ok(Level {
        samples,
        verdict: check.rigid.word().into(),
        translation: check.translation.word().into(),
        rows: check.rows,
        margin: found.rigid.margin.and_then(|m| m.lower),
        chord_error: found.chord_error,
        beyond_sampling: found.rigid.beyond_sampling,
    })
}

/// Whether no further level is needed or allowed.
fn ended(levels: &[Level]) -> Option<(Beyond, String)> {
    let [.., before, last] = levels else {
        return levels.last().filter(|l| l.samples * 2 > MOST_SAMPLES || l.rows > MOST_ROWS).map(|_| {
            (Beyond::Unproven, "the budget ends at the first level: nothing to compare it with".into())
        });
    };
    let same = before.verdict == last.verdict;
    if same && last.beyond_sampling == Beyond::Holds && last.verdict != "undecided" {
        let why =
            format!("{} with {} and with {} samples, and beyond", last.verdict, before.samples, last.samples);
        return Some((Beyond::Holds, why));
    }
    let spent = if last.samples * 2 > MOST_SAMPLES {
        format!("{MOST_SAMPLES} samples are the most")
    } else if last.rows > MOST_ROWS {
        format!("a level is not begun after one of more than {MOST_ROWS} rows")
    } else {
        return None;
    };
    let fell = if same {
        "the verdict is not shown beyond the samples"
    } else {
        "the verdict changed at the last refinement"
    };
    Some((Beyond::Unproven, format!("{fell}; the budget ended: {spent}")))
}
