//! Takes the bytes of an STL file, binary or ASCII, gives its triangles.
//!
//! Not promised: the normals in the file are passed over, the corners' order alone says which side is out.
//! ASCII numbers are read as f64, so two files that differ beyond single precision stay different.

use super::digits::Digits;
use super::faults::{Found, Place, found};
use super::soup::{Soup, finite};
use glam::DVec3;
use std::io::Cursor;

/// Header of 80 bytes, then the number of triangles.
const HEAD: usize = 84;
/// Bytes of one binary triangle: four vectors of three f32, two bytes of attributes.
const TRIANGLE: usize = 50;

pub(super) fn read(bytes: &[u8]) -> Result<Soup, Vec<Found>> {
    let claimed = claimed_triangles(bytes);
    let needed = claimed.map(|n| HEAD as u64 + TRIANGLE as u64 * u64::from(n));
    let have = bytes.len() as u64;
    match needed {
        Some(need) if need == have => binary(bytes),
        _ if looks_ascii(bytes) => ascii(&String::from_utf8_lossy(bytes)),
        // Some writers append bytes of their own; the triangles are all there.
        Some(need) if need < have && claimed != Some(0) => binary(bytes),
        _ => Err(vec![neither(have, claimed, needed)]),
    }
}

fn claimed_triangles(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(80..84)?.try_into().ok()?))
}

/// "solid" first and only text after: binary files may start with "solid" too.
fn looks_ascii(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    start.len() >= 5 && start[..5].eq_ignore_ascii_case(b"solid") && !bytes.contains(&0)
}

fn neither(have: u64, claimed: Option<u32>, needed: Option<u64>) -> Found {
    let what = match (claimed, needed) {
        (Some(n), Some(need)) if n > 0 => {
            format!(
                "neither ASCII STL nor complete binary STL: {n} triangles need {need} bytes, the file has {have}"
            )
        }
        _ => format!("neither ASCII STL (no `solid`) nor binary STL ({have} bytes)"),
    };
    found(Place::Byte(80), what, "export it again; the file may be cut short, or no STL at all")
}

fn binary(bytes: &[u8]) -> Result<Soup, Vec<Found>> {
    let (mut soup, mut digits) = (Soup::default(), Digits::default());
    let mut faults = Vec::new();
    // stl_io takes a file that starts with "solid" for ASCII; the length has already said binary.
    let mut owned = bytes.to_vec();
    owned[..80].fill(0);
    let mut cursor = Cursor::new(owned);
    let triangles = match stl_io::create_stl_reader(&mut cursor) {
        Ok(t) => t,
        Err(e) => return Err(vec![found(Place::Byte(0), e.to_string(), "export it again")]),
    };
    for (k, triangle) in triangles.enumerate() {
        let place = Place::Face(k);
        match triangle {
            Ok(t) => {
                t.vertices.iter().flat_map(|v| v.0).for_each(|x| digits.note_single(x));
                let corners: Result<Vec<_>, _> =
                    t.vertices.iter().map(|v| finite(v.0.map(f64::from), place)).collect();
                corners.map(|c| soup.push(&c, place)).unwrap_or_else(|f| faults.push(f));
            }
            Err(e) => faults.push(found(place, e.to_string(), "export it again")),
        }
    }
    soup.resolution = digits.resolution();
    if faults.is_empty() { Ok(soup) } else { Err(faults) }
}

fn ascii(text: &str) -> Result<Soup, Vec<Found>> {
    let mut soup = Soup::default();
    let mut faults = Vec::new();
    let mut digits = Digits::default();
    let mut corners: Vec<DVec3> = Vec::new();
    let mut opened = Place::Line(1);
    for (k, line) in text.lines().enumerate() {
        let place = Place::Line(k + 1);
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            [w, ..] if w.eq_ignore_ascii_case("facet") => {
                corners.clear();
                opened = place;
            }
            [w, ref numerals @ ..] if w.eq_ignore_ascii_case("vertex") => {
                numerals.iter().for_each(|s| digits.note(s));
                vertex(numerals, place).map(|p| corners.push(p)).unwrap_or_else(|f| faults.push(f));
            }
            [w, ..] if w.eq_ignore_ascii_case("endfacet") => {
                if corners.len() == 3 {
                    soup.push(&corners, opened);
                } else if faults.is_empty() {
                    let what = format!("facet with {} vertices", corners.len());
                    faults.push(found(opened, what, "an STL facet is a triangle"));
                }
            }
            _ => {}
        }
    }
    if !text
        .trim_end()
        .lines()
        .last()
        .is_some_and(|l| l.trim_start().to_ascii_lowercase().starts_with("endsolid"))
    {
        faults.push(found(
            Place::Line(text.lines().count()),
            "no `endsolid` at the end",
            "the file may be cut short",
        ));
    }
    soup.resolution = digits.resolution();
    if faults.is_empty() { Ok(soup) } else { Err(faults) }
}

fn vertex(numerals: &[&str], place: Place) -> Result<DVec3, Found> {
    let parsed: Vec<f64> = numerals.iter().filter_map(|s| s.parse().ok()).collect();
    match parsed[..] {
        [x, y, z] if numerals.len() == 3 => finite([x, y, z], place),
        _ => Err(found(place, "vertex without three numbers", "write `vertex x y z`")),
    }
}
