//! Takes what was found about keys and cores, gives it in words.
//!
//! Not promised: all of them; `--json` has those that are not printed.

use crate::report::answer::{InterlockAnswer, InterlockWord, KeyAnswer, LockedCore, TwistAnswer};
use glam::DVec3;

/// Keys and cores that are printed.
const MOST: usize = 6;

/// A turn slower than this share of the shift is not told as one; shifts likewise.
const SMALL: f64 = 1e-6;

/// Names and values.
pub fn told(a: &InterlockAnswer) -> Vec<(String, String)> {
    let mut facts = vec![("interlocked".to_string(), word(a.word).to_string())];
    let keys: Vec<String> = a.keys.iter().take(MOST).map(key).collect();
    facts.push(("keys".into(), format!("{}{}", some(&keys, a.keys.len()), searched(a))));
    for kind in ["largest", "smallest"] {
        let of: Vec<String> = a.cores.iter().filter(|c| c.kind == kind).map(core).collect();
        if kind == "largest" || !of.is_empty() {
            facts.push((format!("{kind} locked cores"), some(&of[..of.len().min(MOST)], of.len())));
        }
    }
    if !a.searched.undecided.is_empty() {
        facts.push((
            "keys or cores undecided".into(),
            format!("{} sets of parts", a.searched.undecided.len()),
        ));
    }
    if !a.searched.not_asked.is_empty() {
        facts.push((
            "cores not searched in".into(),
            format!("{} sets of parts, too large", a.searched.not_asked.len()),
        ));
    }
    facts
}

fn word(word: InterlockWord) -> &'static str {
    match word {
        InterlockWord::Interlocked => "yes: locked whichever one part is held",
        InterlockWord::NotInterlocked => "no: with one part held, whichever, something can start to move",
        InterlockWord::Undecided => "undecided",
        InterlockWord::NotRun => "not run: too many parts",
    }
}

fn some(told: &[String], all: usize) -> String {
    match (told.len(), all) {
        (0, _) => "none".into(),
        (n, all) if n < all => format!("{} ... ({all} in all)", told.join("; ")),
        _ => told.join("; "),
    }
}

fn searched(a: &InterlockAnswer) -> String {
    match a.searched.keys_up_to {
        None => String::new(),
        Some(n) => format!(" (all of up to {n} parts were asked)"),
    }
}

fn core(c: &LockedCore) -> String {
    let parts = if c.parts.len() <= 2 * MOST {
        c.parts.join(" + ")
    } else {
        format!("{} parts with {}", c.parts.len(), c.parts[0])
    };
    if c.within_digits == "holds" {
        parts
    } else {
        format!("{parts} (as written; not shown within the files' digits)")
    }
}

fn key(k: &KeyAnswer) -> String {
    let parts = if k.parts.len() <= MOST {
        k.parts.join(" + ")
    } else {
        format!("{} parts without the others", k.parts.len())
    };
    let least = if k.least == "shown" { "" } else { " (perhaps fewer)" };
    format!("{parts}{least} {}", moves(k))
}

/// How a key moves, in words: along what, or about what.
fn moves(k: &KeyAnswer) -> String {
    let verb = if k.motion.kind == "slides" { "slides" } else { "moves" };
    if let Some(d) = k.directions.as_ref().filter(|d| !d.lines.is_empty() || !d.rays.is_empty()) {
        let lines = d.lines.iter().map(|&v| format!("both ways along {}", vector(v)));
        let rays = d.rays.iter().map(|&v| vector(v));
        let rays: Vec<String> = rays.collect();
        let between = match rays.len() {
            0 => None,
            1 => Some(format!("along {}", rays[0])),
            n if n <= MOST => Some(format!("along any direction between {}", rays.join(", "))),
            n => Some(format!("along any direction between {n} extreme ones")),
        };
        return format!("{verb} {}", lines.chain(between).collect::<Vec<_>>().join(" and "));
    }
    match k.motion.twists.as_slice() {
        [t] => screw(t),
        _ => "move, each in its own way".into(),
    }
}

/// A twist as a turn about an axis.
fn screw(t: &TwistAnswer) -> String {
    let [v, w, c] = [t.translation, t.rotation, t.centre].map(DVec3::from_array);
    if w.length() <= SMALL * v.length() {
        return format!("moves along {}", vector(v.normalize_or_zero().to_array()));
    }
    let (axis, through) = (w.normalize(), c + w.cross(v) / w.length_squared());
    let pitch = v.dot(axis);
    let turn = format!("turns about {} through {}", vector(axis.to_array()), vector(through.to_array()));
    if pitch.abs() <= SMALL * v.length().max(w.length()) {
        turn
    } else {
        format!("{turn}, shifting {:.3} along it for each radian", pitch / w.length())
    }
}

fn vector(v: [f64; 3]) -> String {
    // A minus zero would be read as a direction.
    let [x, y, z] = v.map(|c| format!("{:.3}", if c.abs() < 5e-4 { 0.0 } else { c }));
    format!("({x}, {y}, {z})")
}
