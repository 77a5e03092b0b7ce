//! Takes a verb that runs; shows on a terminal how far it is, and hears Ctrl-C for it.
//!
//! Promised: nothing is shown before two seconds, nor where stderr is no terminal, nor with --quiet; and nothing is
//! left on the line. Not promised: that a time left is kept; it is the pace so far, carried on.

use super::args::{Common, Verb};
use super::atlas::time;
use crate::watch::{All, Seen, Watch};
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// What is done sooner needs no word.
const PATIENCE: Duration = Duration::from_secs(2);

/// Between two lines: often enough to be seen to move.
const PAUSE: Duration = Duration::from_millis(250);

/// Letters of a line, one less than the narrowest usual terminal has.
const MOST_LETTERS: usize = 79;

/// Exit code of what a user ended before there was an answer: 128 and the signal's number.
pub const INTERRUPTED: u8 = 130;

/// The line on the terminal; it is wiped when this is dropped.
pub struct Line {
    end: Option<(Sender<()>, JoinHandle<()>)>,
}

/// Shows how far `watch` is, where someone can see it.
pub fn shown(watch: &Watch, common: &Common) -> Line {
    if common.quiet || !std::io::stderr().is_terminal() {
        return Line { end: None };
    }
    let (end, ended) = channel();
    let watch = watch.clone();
    let shows = std::thread::spawn(move || {
        let mut pace = Pace::default();
        let start = Instant::now();
        let mut wrote = false;
        while ended.recv_timeout(PAUSE) == Err(RecvTimeoutError::Timeout) {
            let seen = watch.seen();
            let on_stage = pace.on(&seen);
            if start.elapsed() >= PATIENCE && !seen.is_empty() {
                wrote = true;
                let _ = write!(std::io::stderr(), "\r{}\u{1b}[K", line(&seen, start.elapsed(), on_stage));
            }
        }
        if wrote {
            let _ = write!(std::io::stderr(), "\r\u{1b}[K");
        }
    });
    Line { end: Some((end, shows)) }
}

impl Drop for Line {
    fn drop(&mut self) {
        if let Some((end, shows)) = self.end.take() {
            drop(end);
            let _ = shows.join();
        }
    }
}

/// A line that stays, above what is shown.
pub fn say(what: &str) {
    let wipe = if std::io::stderr().is_terminal() { "\r\u{1b}[K" } else { "" };
    let _ = writeln!(std::io::stderr(), "{wipe}{what}");
}

/// Since when the innermost stage runs.
#[derive(Default)]
struct Pace {
    since: Option<(u64, Instant)>,
}

impl Pace {
    fn on(&mut self, seen: &[Seen]) -> Duration {
        let Some(last) = counting(seen) else { return Duration::ZERO };
        match self.since {
            Some((number, at)) if number == last.number => at.elapsed(),
            _ => {
                self.since = Some((last.number, Instant::now()));
                Duration::ZERO
            }
        }
    }
}

/// The innermost stage that counts something.
fn counting(seen: &[Seen]) -> Option<&Seen> {
    seen.iter().rev().find(|s| !s.unit.is_empty())
}

/// The outermost stage and the innermost ones with what they count, the time so far, and the time left where a whole is known.
pub fn line(seen: &[Seen], so_far: Duration, on_stage: Duration) -> String {
    let told = |s: &Seen| match (s.unit, s.all) {
        ("", _) => s.what.clone(),
        (unit, All::Open) => format!("{}, {} {unit}", s.what, s.done),
        (unit, All::Just(all)) => format!("{}, {} of {all} {unit}", s.what, s.done),
        (unit, All::AtMost(most)) => format!("{}, {} of up to {most} {unit}", s.what, s.done),
    };
    let stages: Vec<String> = seen.iter().map(told).collect();
    // A pace of an outer stage says nothing of what runs within it uncounted.
    let last = counting(seen).filter(|s| seen.last() == Some(s));
    let left = last.and_then(|s| left(s, on_stage)).unwrap_or_default();
    let times = format!("; {}{left}", time(so_far));
    let room = MOST_LETTERS.saturating_sub(times.chars().count());
    short(stages, room) + &times
}

/// In so many letters; what stands before the last stage goes before letters do, the outermost last.
fn short(mut stages: Vec<String>, room: usize) -> String {
    while stages.len() > 1 && stages.iter().map(|s| s.chars().count() + 2).sum::<usize>() > room + 2 {
        stages.remove(stages.len() - 2);
    }
    stages.join(": ").chars().take(room).collect()
}

/// At the pace so far.
fn left(s: &Seen, on_stage: Duration) -> Option<String> {
    let (all, word) = match s.all {
        All::Open => return None,
        All::Just(all) => (all, "about"),
        All::AtMost(most) => (most, "up to"),
    };
    let share = all.saturating_sub(s.done) as f64 / s.done as f64;
    let left = Duration::try_from_secs_f64(on_stage.as_secs_f64() * share).ok()?;
    (s.done > 0 && !on_stage.is_zero()).then(|| format!(", {word} {} left", time(left)))
}

/// Whether a verb ends with the best answer so far when it is asked to; the others end at once.
pub fn can_stop(verb: Option<&Verb>) -> bool {
    matches!(
        verb,
        Some(
            Verb::Plan { .. }
                | Verb::Play(_)
                | Verb::Release(_)
                | Verb::Blocking(_)
                | Verb::Flex(_)
                | Verb::Repeats(_)
        )
    )
}

/// The first Ctrl-C asks for the answer so far, the second ends the program.
pub fn hear(watch: &Watch, quiet: bool) {
    let (watch, once) = (watch.clone(), AtomicBool::new(false));
    let heard = move || {
        if once.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED.into());
        }
        watch.stop();
        if !quiet {
            say("stopping with what was found; Ctrl-C again ends it at once");
        }
    };
    // Without a handler Ctrl-C ends the program at once, as everywhere.
    let _ = ctrlc::set_handler(heard);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(what: &str, unit: &'static str, done: u64, all: All) -> Seen {
        Seen { number: 1, what: what.into(), unit, done, all }
    }

    #[test]
    fn a_line_names_the_stage_its_counts_and_the_time_left() {
        let s = Duration::from_secs;
        let plain = [seen("fab", "", 0, All::Open)];
        assert_eq!(line(&plain, s(3), s(3)), "fab; 3 s");
        let play = [seen("play", "", 0, All::Open), seen("reach", "programs", 120, All::Just(480))];
        assert_eq!(line(&play, s(14), s(12)), "play: reach, 120 of 480 programs; 14 s, about 36 s left");
        let plan = [seen("plan", "", 0, All::Open), seen("apart", "positions", 50, All::AtMost(100))];
        assert_eq!(
            line(&plan, s(200), s(150)),
            "plan: apart, 50 of up to 100 positions; 4 min, up to 3 min left"
        );
        let none = [seen("plan", "positions", 0, All::AtMost(100))];
        assert_eq!(line(&none, s(5), s(5)), "plan, 0 of up to 100 positions; 5 s");
        let three = ["release", "a stage between the two that has a long name", "the innermost of all"];
        let three = three.map(|name| seen(name, "", 0, All::Open));
        assert_eq!(line(&three, s(5), s(5)), "release: the innermost of all; 5 s");
        let long = [seen(&"long ".repeat(40), "", 0, All::Open)];
        assert_eq!(line(&long, s(5), s(5)).chars().count(), MOST_LETTERS);
    }

    #[test]
    fn the_pace_is_that_of_the_stage_that_counts() {
        let mut pace = Pace::default();
        let first = [seen("a", "things", 0, All::Just(2))];
        assert_eq!(pace.on(&first), Duration::ZERO);
        std::thread::sleep(Duration::from_millis(3));
        assert!(pace.on(&first) >= Duration::from_millis(3));
        let next = [Seen { number: 2, ..first[0].clone() }];
        assert_eq!(pace.on(&next), Duration::ZERO);
    }
}
