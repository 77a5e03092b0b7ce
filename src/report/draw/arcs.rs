//! Takes who stops whom along a direction; gives it as a drawing: parts around a circle with arrows, or, where they are
//! many, as a table of dots.
//!
//! Promised: parts that hold one another (a strongly connected component) stand side by side. Not promised: few crossings.

use super::sheet::{Anchor, Mark, Rgb, Sheet, rectangle};
use std::f64::consts::TAU;

/// Parts by id, grouped by component, and arcs between their places.
pub struct Arcs<'a> {
    pub ids: Vec<&'a str>,
    /// The component of each part.
    pub component: Vec<usize>,
    /// From the part that would move to the part that stops it.
    pub arcs: Vec<(usize, usize)>,
}

/// More parts than this would write over one another on the circle.
pub const MOST_ROUND: usize = 28;
/// More parts than this would be dots of less than two pixels.
pub const MOST_DOTS: usize = 320;

const INK: Rgb = [34, 36, 42];
const FAINT: Rgb = [217, 214, 207];
const ONE_WAY: Rgb = [205, 88, 24];
const BOTH_WAYS: Rgb = [22, 92, 152];
/// Side of the sheet, in CSS pixels.
const SIDE: f64 = 640.0;

/// `None` where there are too many parts to draw.
pub fn sheet(graph: &Arcs) -> Option<Sheet> {
    let n = graph.ids.len();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by_key(|&p| (graph.component[p], p));
    match n {
        0..=MOST_ROUND => Some(round(graph, &order)),
        _ if n <= MOST_DOTS => Some(dots(graph, &order)),
        _ => None,
    }
}

fn both(graph: &Arcs, (i, j): (usize, usize)) -> bool {
    graph.arcs.contains(&(j, i))
}

fn round(graph: &Arcs, order: &[usize]) -> Sheet {
    let n = order.len().max(1) as f64;
    let (middle, radius) = ([SIDE / 2.0, SIDE / 2.0], SIDE * 0.36);
    let mut at = vec![[0.0; 2]; order.len()];
    for (k, &p) in order.iter().enumerate() {
        let (s, c) = (k as f64 / n * TAU - TAU / 4.0).sin_cos();
        at[p] = [middle[0] + radius * c, middle[1] + radius * s];
    }
    let mut marks: Vec<Mark> = Vec::new();
    for &(i, j) in &graph.arcs {
        let two = both(graph, (i, j));
        if !two || i < j {
            marks.extend(arrow(at[i], at[j], if two { BOTH_WAYS } else { ONE_WAY }, two));
        }
    }
    for (k, &p) in order.iter().enumerate() {
        let (s, c) = (k as f64 / n * TAU - TAU / 4.0).sin_cos();
        marks.push(Mark::Fill { points: disc(at[p], DOT), ink: INK });
        let anchor = match c {
            c if c > 0.2 => Anchor::Start,
            c if c < -0.2 => Anchor::End,
            _ => Anchor::Middle,
        };
        let place = [at[p][0] + c * 14.0, at[p][1] + s * 18.0 + LETTERS * 0.35];
        marks.push(Mark::Words { at: place, size: LETTERS, anchor, ink: INK, text: graph.ids[p].into() });
    }
    Sheet { width: SIDE, height: SIDE, marks }
}

const DOT: f64 = 5.0;
const LETTERS: f64 = 14.0;
/// Length and half width of an arrow's head.
const HEAD: [f64; 2] = [10.0, 4.0];

fn disc([x, y]: [f64; 2], r: f64) -> Vec<[f64; 2]> {
    let corner = |k: usize| (k as f64 / 16.0 * TAU).sin_cos();
    (0..16).map(corner).map(|(s, c)| [x + r * c, y + r * s]).collect()
}

fn arrow(a: [f64; 2], b: [f64; 2], ink: Rgb, both: bool) -> Vec<Mark> {
    let d = [b[0] - a[0], b[1] - a[1]];
    let length = d[0].hypot(d[1]).max(f64::MIN_POSITIVE);
    let u = [d[0] / length, d[1] / length];
    let on = |from: [f64; 2], along: f64, aside: f64| {
        [from[0] + u[0] * along - u[1] * aside, from[1] + u[1] * along + u[0] * aside]
    };
    let gap = DOT + 3.0;
    let (start, end) = (on(a, gap, 0.0), on(b, -gap, 0.0));
    let head = |tip: [f64; 2], back: f64| Mark::Fill {
        points: vec![tip, on(tip, back * HEAD[0], HEAD[1]), on(tip, back * HEAD[0], -HEAD[1])],
        ink,
    };
    let mut marks = vec![Mark::Line { points: vec![start, end], ink, width: 1.4 }, head(end, -1.0)];
    marks.extend(both.then(|| head(start, 1.0)));
    marks
}

/// Row: the part that would move; column: the part that stops it.
fn dots(graph: &Arcs, order: &[usize]) -> Sheet {
    let cell = (SIDE / order.len() as f64).min(16.0);
    let side = cell * order.len() as f64;
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, &p)| place[p] = k);
    let mut marks = Vec::new();
    let mut first = 0;
    for k in 1..=order.len() {
        if k == order.len() || graph.component[order[k]] != graph.component[order[first]] {
            let (from, size) = (first as f64 * cell, (k - first) as f64 * cell);
            marks.push(Mark::Fill { points: rectangle(from, from, size, size), ink: FAINT });
            first = k;
        }
    }
    let dot = |&(i, j): &(usize, usize)| Mark::Fill {
        points: rectangle(place[j] as f64 * cell, place[i] as f64 * cell, cell * 0.9, cell * 0.9),
        ink: if both(graph, (i, j)) { BOTH_WAYS } else { ONE_WAY },
    };
    marks.extend(graph.arcs.iter().map(dot));
    Sheet { width: side, height: side, marks }
}
