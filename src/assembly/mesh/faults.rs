//! Takes nothing, gives the words in which a mesh file is refused: each fault with its file, its place and a
//! hint.
//!
//! Not promised: that two faults have different causes (one missing triangle opens three edges).

use glam::DVec3;
use std::fmt;
use std::path::PathBuf;

/// Where in a mesh file a fault sits. Lines count from 1, bytes and faces from 0; points are in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    File,
    Line(usize),
    Byte(usize),
    Face(usize),
    Vertex(DVec3),
    Edge(DVec3, DVec3),
}

/// One thing that is wrong with one mesh file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}: {place}{what} ({hint})", file.display())]
pub struct MeshFault {
    pub file: PathBuf,
    pub place: Place,
    pub what: String,
    pub hint: String,
}

/// Everything that is wrong with one mesh file; never empty.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct MeshFaults(pub Vec<MeshFault>);

impl fmt::Display for MeshFaults {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let lines: Vec<String> = self.0.iter().map(MeshFault::to_string).collect();
        f.write_str(&lines.join("\n"))
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Place::File => Ok(()),
            Place::Line(n) => write!(f, "line {n}: "),
            Place::Byte(n) => write!(f, "byte {n}: "),
            Place::Face(n) => write!(f, "face {n}: "),
            Place::Vertex(p) => write!(f, "vertex {}: ", Point(*p)),
            Place::Edge(p, q) => write!(f, "edge {} to {}: ", Point(*p), Point(*q)),
        }
    }
}

struct Point(DVec3);

impl fmt::Display for Point {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "[{}, {}, {}]", self.0.x, self.0.y, self.0.z)
    }
}

/// A fault before it is known which file it belongs to.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Found {
    pub place: Place,
    pub what: String,
    pub hint: &'static str,
}

pub(super) fn found(place: Place, what: impl Into<String>, hint: &'static str) -> Found {
    Found { place, what: what.into(), hint }
}
