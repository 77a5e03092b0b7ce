//! Takes the text of a Wavefront OBJ file, gives its polygons; `v` and `f` count, everything else is passed
//! over.
//!
//! Not promised: free-form surfaces (`cstype`, `curv`, `surf`) and lines are not faces; a file of those alone
//! is refused.

use super::digits::Digits;
use super::faults::{Found, Place, found};
use super::soup::{Soup, finite};
use glam::DVec3;

pub(super) fn read(text: &str) -> Result<Soup, Vec<Found>> {
    let mut soup = Soup::default();
    let mut faults = Vec::new();
    let mut points: Vec<Option<DVec3>> = Vec::new();
    let mut digits = Digits::default();
    for (place, line) in logical_lines(text) {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numerals: Vec<&str> = words.take(3).collect();
                numerals.iter().for_each(|s| digits.note(s));
                points.push(vertex(&numerals, place).map_err(|f| faults.push(f)).ok());
            }
            Some("f") => match face(words, &points, place) {
                Ok(Some(corners)) => soup.push(&corners, place),
                Ok(None) => {} // a corner is faulty and already reported
                Err(f) => faults.push(f),
            },
            _ => {}
        }
    }
    soup.resolution = digits.resolution();
    if faults.is_empty() { Ok(soup) } else { Err(faults) }
}

/// Lines without their comments, those ending in a backslash joined with the next; each with where it starts.
fn logical_lines(text: &str) -> impl Iterator<Item = (Place, String)> + '_ {
    let mut lines = text.lines().enumerate();
    std::iter::from_fn(move || {
        let (k, first) = lines.next()?;
        let mut whole = code(first).to_owned();
        while whole.ends_with('\\') {
            whole.pop();
            match lines.next() {
                Some((_, next)) => whole.extend([" ", code(next)]),
                None => break,
            }
        }
        Some((Place::Line(k + 1), whole))
    })
}

fn code(line: &str) -> &str {
    line.split('#').next().unwrap_or("").trim_end()
}

fn vertex(numerals: &[&str], place: Place) -> Result<DVec3, Found> {
    let parsed: Vec<f64> = numerals.iter().filter_map(|s| s.parse().ok()).collect();
    match parsed[..] {
        [x, y, z] => finite([x, y, z], place),
        _ => Err(found(place, "vertex without three numbers", "write `v x y z`")),
    }
}

/// The corners of a face; nothing where one of them was refused before.
fn face<'a>(
    words: impl Iterator<Item = &'a str>,
    points: &[Option<DVec3>],
    place: Place,
) -> Result<Option<Vec<DVec3>>, Found> {
    let corners = words.map(|w| corner(w, points, place)).collect::<Result<Vec<_>, _>>()?;
    if corners.len() < 3 {
        return Err(found(place, "face with fewer than three corners", "a face needs at least three"));
    }
    Ok(corners.into_iter().collect())
}

/// `7`, `7/1`, `7//2`, `7/1/2`, or negative: counted back from the last vertex read so far.
fn corner(word: &str, points: &[Option<DVec3>], place: Place) -> Result<Option<DVec3>, Found> {
    let index: i64 = word.split('/').next().and_then(|s| s.parse().ok()).unwrap_or(0);
    let at = match index {
        1.. => usize::try_from(index - 1).ok(),
        0 => None,
        _ => points.len().checked_sub(index.unsigned_abs() as usize),
    };
    match at.and_then(|k| points.get(k)) {
        Some(p) => Ok(*p),
        None => Err(found(
            place,
            format!("corner `{word}` names no vertex; {} are known here", points.len()),
            "indices count from 1, negative ones back from the last vertex",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_slashes_negatives_continuations_and_crlf() {
        let text = "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0 # here\r\nvertex count = 3\r\ng a\r\nf 1/2/3 -2//1 \\\r\n -1/4\r\n";
        let soup = read(text).unwrap();
        assert_eq!(soup.faces, [[0, 1, 2]]);
        assert_eq!(soup.places, [Place::Line(6)]);
    }

    #[test]
    fn all_faults_at_once() {
        let faults = read("v 0 0\nv 0 0 nan\nv 1 1 1\nf 1 2 9\nf 3 3\n").unwrap_err();
        let places: Vec<_> = faults.iter().map(|f| f.place).collect();
        assert_eq!(places, [1, 2, 4, 5].map(Place::Line));
    }
}
