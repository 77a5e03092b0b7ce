//! Takes from a stage how far it is, and from a user that he wants no more; gives each to the other.
//!
//! A plain value that is handed down: nothing here prints or reads a clock, and without a stop no answer depends on it.
//! Not promised: when a stage that was asked to stop does; each looks between two of its own counted steps.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The line between a run and who looks on; clones are the same line.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    stop: Arc<AtomicBool>,
    open: Arc<Mutex<Open>>,
}

/// Stages that run now, the outer ones first.
#[derive(Debug, Default)]
struct Open {
    begun: u64,
    stages: Vec<(u64, String, &'static str, All, Arc<AtomicU64>)>,
}

/// What is known of the whole that a stage counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum All {
    /// Nothing: it ends when it finds.
    Open,
    /// So many.
    Just(u64),
    /// A bound on counted work: it may end before.
    AtMost(u64),
}

/// A stage as it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Of its own for each stage of a run, in the order in which they began.
    pub number: u64,
    pub what: String,
    /// What is counted, in the plural; nothing where this is empty.
    pub unit: &'static str,
    pub done: u64,
    pub all: All,
}

/// A stage that runs, until this is dropped.
#[derive(Debug)]
pub struct Stage {
    number: u64,
    done: Arc<AtomicU64>,
    open: Arc<Mutex<Open>>,
}

impl Watch {
    /// Asks all stages to stop.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Begins a stage within those that run.
    pub fn stage(&self, what: impl Into<String>, unit: &'static str, all: All) -> Stage {
        let done = Arc::new(AtomicU64::new(0));
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.begun += 1;
        let number = open.begun;
        open.stages.push((number, what.into(), unit, all, done.clone()));
        Stage { number, done, open: self.open.clone() }
    }

    /// Stops with this one, but nobody sees its stages: for work whose stages would run beside each other, or be too
    /// short to be read.
    pub fn unseen(&self) -> Watch {
        Watch { stop: self.stop.clone(), open: Arc::default() }
    }

    /// The stages that run now, the outer ones first.
    pub fn seen(&self) -> Vec<Seen> {
        let open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let seen = open.stages.iter().map(|(number, what, unit, all, done)| Seen {
            number: *number,
            what: what.clone(),
            unit,
            done: done.load(Ordering::Relaxed),
            all: *all,
        });
        seen.collect()
    }
}

impl Stage {
    /// So many more are done.
    pub fn add(&self, more: usize) {
        self.done.fetch_add(more as u64, Ordering::Relaxed);
    }

    /// So many are done in all.
    pub fn reach(&self, done: usize) {
        self.done.store(done as u64, Ordering::Relaxed);
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        open.stages.retain(|s| s.0 != self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_are_seen_while_they_run_and_a_stop_reaches_what_is_unseen() {
        let watch = Watch::default();
        let outer = watch.stage("outer", "", All::Open);
        {
            let inner = watch.stage("inner", "things", All::Just(3));
            inner.add(2);
            let seen = watch.seen();
            assert_eq!(seen.iter().map(|s| s.what.as_str()).collect::<Vec<_>>(), ["outer", "inner"]);
            assert_eq!((seen[1].done, seen[1].all), (2, All::Just(3)));
        }
        let unseen = watch.unseen();
        let _hidden = unseen.stage("hidden", "", All::Open);
        assert_eq!(watch.seen().len(), 1);
        watch.stop();
        assert!(unseen.is_stopped());
        drop(outer);
        assert!(watch.seen().is_empty());
    }
}
