//! Takes the control points of a centerline; gives them back where the weave has such a line and they pass over and
//! under where it does.
//!
//! Not promised: that cells grown around the curve are one body.

use super::reader::{Field, Reader};
use crate::weave::{Weave, wave};

/// More control points than anyone draws by hand; the paper uses 11.
const MAX_POINTS: usize = 1000;

/// Largest distance of the first control point from the start of the overs, in crossings.
const MAX_START: f64 = 1e6;

/// Control points [x, z] of one period, checked against the weave, `lift` and `cover` as far as those are known.
pub fn points<'t>(
    reader: &mut Reader<'t>,
    field: &Field<'t>,
    weave: Option<&Weave>,
    lift: Option<f64>,
    cover: Option<f64>,
) -> Option<Vec<[f64; 2]>> {
    let hint = "a list of pairs, as in points = [[0, 0.5], [0.5, 1], [1.5, 0], [2, 0.5]]";
    let items = reader.list(field, hint)?;
    if !(2..=MAX_POINTS).contains(&items.len()) {
        reader.fault(field, format!("has {} points", items.len()), "a period needs 2 to 1000 of them");
        return None;
    }
    let (lift, cover) = (lift?, cover?);
    let read: Vec<_> = items.iter().map(|item| pair(reader, item, lift, cover, hint)).collect();
    let points = read.into_iter().collect::<Option<Vec<_>>>()?;
    let forward = forward(reader, &items, &points);
    let (overs, unders) = run_lengths(reader, field, weave?)?;
    forward?;
    closes(reader, field, &points, overs + unders)?;
    passes(reader, field, &points, (overs, unders), lift)?;
    Some(points)
}

fn pair<'t>(
    reader: &mut Reader<'t>,
    item: &Field<'t>,
    lift: f64,
    cover: f64,
    hint: &str,
) -> Option<[f64; 2]> {
    let numbers = reader.list(item, hint)?;
    let [x, z] = &numbers[..] else {
        reader.fault(item, format!("has {} numbers", numbers.len()), hint);
        return None;
    };
    use std::ops::Bound::Excluded;
    let between = (Excluded(-cover), Excluded(lift + cover));
    let why = "a centerline stays between the sandwiching planes, at -cover and lift + cover";
    let x = reader.number(x, -MAX_START..=MAX_START, "x runs along the strand, in crossings");
    let z = reader.number(z, between, why);
    Some([x?, z?])
}

fn forward<'t>(reader: &mut Reader<'t>, items: &[Field<'t>], points: &[[f64; 2]]) -> Option<()> {
    let Some(back) = (1..points.len()).find(|&k| points[k][0] < points[k - 1][0]) else { return Some(()) };
    let what = format!("runs back from x = {} to x = {}", points[back - 1][0], points[back][0]);
    reader.fault(&items[back], what, "x may stand still (a vertical run) but not fall");
    None
}

/// Overs and unders of each weft, where all strands have one run of each; a warp's are the other way around.
fn run_lengths(reader: &mut Reader<'_>, field: &Field<'_>, weave: &Weave) -> Option<(u32, u32)> {
    let odd = match wave(&weave.draft) {
        Ok(wave) => return Some(wave),
        Err(odd) => odd,
    };
    let what = format!("one curve cannot draw this weave: {odd} has other runs");
    let hint = "points need wefts that all pass over a and under b crossings in turn, and warps under a and over b; \
                use `rise` instead";
    reader.fault(field, what, hint);
    None
}

/// Two numbers written in decimals differ by a whole period up to the round-off of reading both and subtracting:
/// half a unit in the last place each.
fn round_off(points: &[[f64; 2]]) -> f64 {
    let most = points.iter().map(|p| p[0].abs()).fold(0.0, f64::max);
    2.0 * f64::EPSILON * most
}

fn closes(reader: &mut Reader<'_>, field: &Field<'_>, points: &[[f64; 2]], period: u32) -> Option<()> {
    let ([x0, z0], [x1, z1]) = (points[0], points[points.len() - 1]);
    if (x1 - x0 - f64::from(period)).abs() > round_off(points) {
        let what = format!("runs from x = {x0} to x = {x1}");
        reader.fault(field, what, format!("it must run over one period, which is {period} crossings here"));
        return None;
    }
    if z0 != z1 {
        let what = format!("begins at z = {z0} and ends at z = {z1}");
        reader.fault(field, what, "the curve goes on into its next period: both ends are the same height");
        return None;
    }
    Some(())
}

/// At the middle of each over the curve is above half the lift, of each under below: the warp's curve is the weft's
/// mirrored there, and the two must not meet.
fn passes(
    reader: &mut Reader<'_>,
    field: &Field<'_>,
    points: &[[f64; 2]],
    (overs, unders): (u32, u32),
    lift: f64,
) -> Option<()> {
    let period = f64::from(overs + unders);
    let wrong = (0..overs + unders).find(|&crossing| {
        let middle = f64::from(crossing) + 0.5;
        let side = |z: f64| if crossing < overs { z > lift / 2.0 } else { z < lift / 2.0 };
        !heights(points, middle, period).all(side)
    });
    let Some(crossing) = wrong else { return Some(()) };
    let side = if crossing < overs { "over: above" } else { "under: below" };
    let middle = f64::from(crossing) + 0.5;
    let what = format!("at x = {middle} the strand passes {side} z = {} is wanted", lift / 2.0);
    reader.fault(field, what, format!("x = 0 is where the overs begin: {overs} over, then {unders} under"));
    None
}

/// Heights of the curve at `x`, moved by whole periods onto it; several where it runs vertically.
fn heights(points: &[[f64; 2]], x: f64, period: f64) -> impl Iterator<Item = f64> {
    let x = points[0][0] + (x - points[0][0]).rem_euclid(period);
    points.windows(2).filter(move |pair| pair[0][0] <= x && x <= pair[1][0]).flat_map(move |pair| {
        let ([x0, z0], [x1, z1]) = (pair[0], pair[1]);
        let between = z0 + (z1 - z0) * (x - x0) / (x1 - x0);
        if x0 == x1 { [z0, z1] } else { [between, between] }
    })
}
