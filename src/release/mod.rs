//! Takes a way to ask whether parts come apart at a clearance; gives a bracket of the clearance that releases them.
//!
//! The upper end is a clearance at which they came apart. Parts with more clearance lie inside those with less, so every
//! plan stays one at any larger clearance: what the ends say does not depend on what was tried between. The lower end
//! is only as good as its evidence: that nothing was *found* there is no proof of anything.

use crate::assembly::Assembly;
use crate::blocking::bounds;

/// What was found at one clearance.
#[derive(Clone, Debug)]
pub enum At<P> {
    Apart(P),
    NotFound(String),
    /// Some part has nothing left, so there is no larger clearance either.
    Gone(String),
    /// The user stopped it: nothing is known.
    Stopped,
}

/// One clearance that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    pub clearance: f64,
    pub word: &'static str,
}

#[derive(Clone, Debug)]
pub struct Bracket<P> {
    /// The largest clearance below `hi` at which no plan was found, and what was searched; none: 0, not tried.
    pub lo: f64,
    pub why: Option<String>,
    /// The smallest clearance at which the parts came apart.
    pub hi: Option<(f64, P)>,
    /// The smallest clearance tried that leaves nothing of some part, and of which.
    pub gone: Option<(f64, String)>,
    pub tried: Vec<Tried>,
    /// Whether it was brought to its end.
    pub end: End,
}

/// How a search for a bracket ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    Done,
    Stopped,
}

/// Lengths between which the bracket is looked for.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// Tried first, then doubled or halved.
    pub start: f64,
    /// Below this nothing is tried: finer than any workshop's clearance.
    pub least: f64,
    pub most: f64,
}

/// Clearances from this share of the smallest part's box diagonal on are tried, doubled while nothing comes apart.
const START_SHARE: f64 = 1.0 / 256.0;
/// A hundredth of a millimetre on a part of 160 mm: nobody makes less.
const LEAST_SHARE: f64 = 1.0 / 16384.0;

/// Where the clearance that releases these parts is looked for, model units.
pub fn range(asm: &Assembly) -> Range {
    let diagonal = |p| {
        let (lo, hi) = bounds(asm.solid(p).vertices.iter().copied());
        (hi - lo).length()
    };
    let size = asm.ids().map(diagonal).fold(f64::INFINITY, f64::min);
    Range { start: size * START_SHARE, least: size * LEAST_SHARE, most: size / 2.0 }
}

/// `hi` is narrowed until it is at most this times `lo`: a sixteenth, finer than clearances are made.
pub const NARROW: f64 = 17.0 / 16.0;

pub fn bracket<P>(range: Range, at: impl Fn(f64) -> At<P>) -> Bracket<P> {
    let mut found = Bracket { lo: 0.0, why: None, hi: None, gone: None, tried: Vec::new(), end: End::Done };
    let mut next = range.start;
    while next <= range.most && found.hi.is_none() && found.gone.is_none() && found.end == End::Done {
        found.take(next, at(next));
        next *= 2.0;
    }
    while let Some(next) = found.between(range.least).filter(|_| found.end == End::Done) {
        found.take(next, at(next));
    }
    found
}

impl<P> Bracket<P> {
    fn take(&mut self, clearance: f64, at: At<P>) {
        let word = match at {
            At::Apart(plan) => {
                self.hi = Some((clearance, plan));
                "comes-apart"
            }
            At::NotFound(why) => {
                (self.lo, self.why) = (clearance, Some(why));
                "not-found"
            }
            At::Gone(why) => {
                self.gone = Some((clearance, why));
                "nothing-left"
            }
            At::Stopped => {
                self.end = End::Stopped;
                "stopped"
            }
        };
        self.tried.push(Tried { clearance, word });
    }

    /// The clearance to try next, while the ends are far apart.
    fn between(&self, least: f64) -> Option<f64> {
        // Where nothing came apart yet the upper end may lie below what leaves nothing.
        let hi = self.hi.as_ref().map(|h| h.0).or(self.gone.as_ref().map(|g| g.0))?;
        match () {
            () if self.lo > 0.0 => (hi > self.lo * NARROW).then(|| (self.lo * hi).sqrt()),
            () => (hi / 2.0 >= least).then_some(hi / 2.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RANGE: Range = Range { start: 0.01, least: 1e-4, most: 0.5 };

    fn opens_at(limit: f64) -> impl Fn(f64) -> At<f64> {
        move |c| match () {
            () if c >= 0.3 => At::Gone("thin".into()),
            () if c >= limit => At::Apart(c),
            () => At::NotFound("nothing".into()),
        }
    }

    #[test]
    fn a_limit_is_bracketed_wherever_it_is() {
        for limit in [0.00017, 0.003, 0.01, 0.0100001, 0.07, 0.29] {
            let b = bracket(RANGE, opens_at(limit));
            let (hi, plan) = b.hi.expect("an upper end");
            assert!(hi == plan && b.lo < limit && limit <= hi, "{limit}: {} to {hi}", b.lo);
            assert!(hi <= b.lo * NARROW, "{limit}: {} to {hi}", b.lo);
        }
    }

    #[test]
    fn what_never_opens_has_no_upper_end_and_what_opens_at_once_no_lower() {
        let never = bracket(RANGE, opens_at(1.0));
        assert!(never.hi.is_none() && never.gone.is_some() && never.lo > 0.28);
        let at_once = bracket(RANGE, opens_at(0.0));
        assert_eq!(at_once.lo, 0.0);
        assert!(at_once.hi.is_some_and(|h| h.0 < 2.0 * RANGE.least));
    }
}
