//! Takes a puzzle file of BurrTools (`.xmpuzzle`: XML, gzip or plain); gives its shapes and one problem with one of its
//! stated solutions, checked, or all its faults at once.
//!
//! The format is that of BurrTools 0.6 (A. Roever; `voxel.cpp`, `problem.cpp`, `assembly.cpp`); only its grid of bricks
//! (type 0) is read. Promised: numbers lie in the bounds stated here; a solution has as many placements as the problem
//! has pieces. Not promised: that the pieces of a solution fill the result; `assembly::voxel` finds out.

pub mod groups;
mod level;
mod problem;
mod shape;
pub mod text;
pub mod turn;
pub mod unpack;
mod xml;

pub use shape::{Fill, Shape, Voxel};

use super::{MeshSpec, Places, Spec, Subject, length_mm};
use crate::fault::{Fault, Faults, Lines, quoted};
use crate::input;
use problem::Wanted;
use std::collections::BTreeSet;
use std::path::Path;
use xml::Node;

/// Edge of a voxel where nothing is said, in mm.
pub const DEFAULT_UNIT_MM: f64 = 1.0;

/// Largest edge of a voxel, in mm: that of a pitch.
const MAX_UNIT_MM: f64 = 10_000.0;

/// Which problem and which of its stated solutions is asked about, counted from 1, and how large a voxel is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Choice {
    /// By default the first with a solution, or else the first.
    pub problem: Option<usize>,
    /// By default the first.
    pub solution: Option<usize>,
    /// Edge of a voxel in mm; by default what the file says, or else 1.
    pub unit_mm: Option<f64>,
}

/// A puzzle: its shapes, the problem asked about, and how it goes together where that is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Puzzle {
    pub shapes: Vec<Shape>,
    /// Colours that the file defines.
    pub colours: usize,
    pub problem: Problem,
    pub solution: Option<Solution>,
    /// Number of the problem in its file, from 1, and how many there are.
    pub number: (usize, usize),
    /// The same of the solution; 0 of those that are stated where none is chosen.
    pub chosen: (usize, usize),
}

/// A set of pieces and the shape that they are to fill.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    pub name: String,
    pub pieces: Vec<Pieces>,
    /// Index of the shape to fill.
    pub result: usize,
    /// Colours of a piece and of the result that may meet, from 1; others only where either is 0.
    pub allowed: BTreeSet<(u32, u32)>,
    /// Most voxels of the result that may stay empty.
    pub most_holes: Option<usize>,
}

/// Pieces of one shape.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pieces {
    /// Index of their shape.
    pub shape: usize,
    pub least: usize,
    pub most: usize,
    /// Group and count: pieces of one group need not be parted.
    pub groups: Vec<(u32, usize)>,
}

/// One way in which the pieces fill the result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Solution {
    /// Shape by shape as the problem lists them, as many as it has at most; None: not used.
    pub placements: Vec<Option<Placement>>,
    /// Moves until pieces part, as the file states them.
    pub level: Option<Vec<usize>>,
}

/// A shape turned, its hot spot set down at a voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placement {
    pub at: [i32; 3],
    /// Index of the turn, as in [`turn::matrix`].
    pub turn: usize,
}

impl Problem {
    /// Index of the shape of each piece, in the order of placements.
    pub fn shapes(&self) -> impl Iterator<Item = usize> + '_ {
        self.pieces.iter().flat_map(|p| std::iter::repeat_n(p.shape, p.most))
    }
}

/// What a stretch of the file is read with: places and faults.
struct Reading<'t> {
    file: String,
    lines: Lines<'t>,
    faults: Vec<Fault>,
}

impl Reading<'_> {
    fn fault(&mut self, node: &Node, key: &str, what: impl Into<String>, hint: &str) {
        let key = if key.is_empty() { node.name.clone() } else { format!("{}.{key}", node.name) };
        let place = Some(self.lines.place(node.at));
        self.faults.push(Fault { file: self.file.clone(), place, key, what: what.into(), hint: hint.into() });
    }

    /// A whole number in bounds; `default` where the attribute is not there.
    fn number(&mut self, node: &Node, key: &str, default: Option<i64>, bounds: (i64, i64)) -> Option<i64> {
        let hint = format!("a whole number from {} to {}", bounds.0, bounds.1);
        match (node.attribute(key), default) {
            (None, Some(default)) => return Some(default),
            (None, None) => self.fault(node, key, "is missing", &hint),
            (Some(text), _) => match text.trim().parse::<i64>() {
                Ok(n) if (bounds.0..=bounds.1).contains(&n) => return Some(n),
                _ => self.fault(node, key, format!("is {}", quoted(text)), &hint),
            },
        }
        None
    }
}

/// Whether a file's name is that of a puzzle.
pub fn is_named(path: &Path) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case("xmpuzzle"))
}

/// The text of a puzzle file, unpacked.
pub fn read_text(path: &Path) -> Result<String, Faults> {
    unpack::text(input::packed_bytes(path)?, path)
}

/// Reads a puzzle's text; `file` names it in faults.
pub fn parse(text: &str, file: &Path, choice: Choice) -> Result<Spec, Faults> {
    let mut reading =
        Reading { file: file.display().to_string(), lines: Lines::new(text), faults: Vec::new() };
    let (root, told) = xml::read(text).map_err(|(at, what)| broken(&reading, at, what))?;
    let puzzle = whole(&mut reading, &root, choice);
    let unit_mm = unit_mm(&mut reading, &root, &told, choice);
    let name = file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    match (puzzle, unit_mm, reading.faults.is_empty()) {
        (Some(puzzle), Some(unit_mm), true) => Ok(Spec {
            name,
            subject: Subject::Meshes(MeshSpec {
                parts: Vec::new(),
                tolerance_mm: unit_mm * TOLERANCE_SHARE,
                mm_per_unit: unit_mm,
                puzzle: Some(Box::new(puzzle)),
            }),
            fab: None,
            file: file.to_path_buf(),
            places: Places::default(),
        }),
        _ => Err(Faults::sorted(reading.faults)),
    }
}

/// Contact tolerance as a share of a voxel: corners are whole numbers, so that any share below a half would do.
const TOLERANCE_SHARE: f64 = 1e-6;

fn broken(reading: &Reading, at: usize, what: String) -> Faults {
    let place = Some(reading.lines.place(at));
    let hint = "a puzzle file is XML as BurrTools writes it; it may be cut off".to_string();
    Fault { file: reading.file.clone(), place, key: String::new(), what, hint }.into()
}

fn unit_mm(reading: &mut Reading, root: &Node, told: &[String], choice: Choice) -> Option<f64> {
    if choice.unit_mm.is_some() {
        return choice.unit_mm;
    }
    let Some(said) = told.iter().find_map(|t| t.strip_prefix("unit=\"")?.strip_suffix('"')) else {
        return Some(DEFAULT_UNIT_MM);
    };
    match length_mm(said) {
        Ok(mm) if mm > 0.0 && mm <= MAX_UNIT_MM => Some(mm),
        _ => {
            let what = format!("the instruction to weavelock says unit={}", quoted(said));
            reading.fault(root, "", what, "write a length with its unit, as in <?weavelock unit=\"10 mm\"?>");
            None
        }
    }
}

fn whole(reading: &mut Reading, root: &Node, choice: Choice) -> Option<Puzzle> {
    if root.name != "puzzle" {
        reading.fault(
            root,
            "",
            format!("the outermost element is <{}>", root.name),
            "a BurrTools file has <puzzle>",
        );
        return None;
    }
    grid(reading, root)?;
    let colours = root.first("colors").map_or(0, |c| c.all("color").count());
    let shapes: Vec<Option<Shape>> = root
        .first("shapes")
        .map_or(Vec::new(), |s| s.all("voxel").map(|v| shape::shape(reading, v)).collect());
    let shapes = shapes.into_iter().collect::<Option<Vec<Shape>>>()?;
    let problems: Vec<&Node> = root.first("problems").map_or(Vec::new(), |p| p.all("problem").collect());
    let (number, node) = problem::chosen(reading, root, &problems, choice)?;
    let wanted = Wanted { shapes: &shapes, choice };
    let (problem, solution, chosen) = problem::problem(reading, node, &wanted)?;
    Some(Puzzle { shapes, colours, problem, solution, number: (number, problems.len()), chosen })
}

/// Names of BurrTools' grids by their number.
const GRIDS: [&str; 5] =
    ["bricks", "triangular prisms", "spheres", "rhombic tetrahedra", "tetrahedra and octahedra"];

fn grid(reading: &mut Reading, root: &Node) -> Option<()> {
    let Some(grid) = root.first("gridType") else { return Some(()) };
    let kind = grid.attribute("type").unwrap_or("0").trim();
    if kind == "0" {
        return Some(());
    }
    let name = kind.parse::<usize>().ok().and_then(|k| GRIDS.get(k));
    let name = name.map_or(String::new(), |n| format!(" ({n})"));
    let what = format!("the grid has type {}{name}", quoted(kind));
    reading.fault(grid, "type", what, "only the grid of bricks, type 0, is read");
    None
}
