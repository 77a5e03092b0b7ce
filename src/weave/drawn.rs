//! Takes a draft drawn with `X` and `.`, as strings or as a text file; gives the draft, or all that is wrong with it.
//!
//! Not promised: more than one fault for each row.

use super::{Draft, Origin, Weave};
use crate::fault::{Fault, Faults, Place};
use std::path::Path;

/// Rows and columns of a drawn draft and of the least period of any draft.
pub const MAX_DRAFT: usize = 512;

/// What is wrong with a drawn draft.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawnFault {
    /// Row, counted from 0.
    pub row: usize,
    /// Character in the row, counted from 0; None where the whole row is concerned.
    pub column: Option<usize>,
    pub what: String,
    pub hint: String,
}

impl Draft {
    /// The draft drawn as strings: row = weft, first row j = 0; `X` where the weft passes over, `.` where under.
    pub fn drawn(rows: &[&str]) -> Result<Draft, Vec<DrawnFault>> {
        let mut faults = size_faults(rows);
        faults.extend(rows.iter().enumerate().take(MAX_DRAFT).flat_map(|(at, row)| mark_fault(at, row)));
        if !faults.is_empty() {
            return Err(faults);
        }
        let cells: Vec<&[u8]> = rows.iter().map(|row| row.as_bytes()).collect();
        let over = |j: u32, i: u32| cells[j as usize][i as usize] == b'X';
        Ok(Draft::from_fn(rows.len() as u32, cells[0].len() as u32, over))
    }
}

fn size_faults(rows: &[&str]) -> Vec<DrawnFault> {
    let Some(first) = rows.first().map(|row| row.chars().count()) else {
        return vec![whole_row(
            0,
            "the draft has no row",
            "draw one string for each weft, as in [\"X.\", \".X\"]",
        )];
    };
    let too_long = format!("a draft has at most {MAX_DRAFT} x {MAX_DRAFT} crossings; draw one period");
    if rows.len() > MAX_DRAFT {
        return vec![whole_row(MAX_DRAFT, &format!("the draft has {} rows", rows.len()), &too_long)];
    }
    let fault = |(at, row): (usize, &&str)| match row.chars().count() {
        0 => Some(whole_row(at, "the row is empty", "a row needs an X or . for each warp")),
        n if n > MAX_DRAFT => Some(whole_row(at, &format!("the row has {n} crossings"), &too_long)),
        n if n != first => {
            let what = format!("the row has {n} crossings, the first row has {first}");
            Some(whole_row(at, &what, "each weft crosses the same warps: draw all rows equally long"))
        }
        _ => None,
    };
    rows.iter().enumerate().filter_map(fault).collect()
}

fn whole_row(row: usize, what: &str, hint: &str) -> DrawnFault {
    DrawnFault { row, column: None, what: what.into(), hint: hint.into() }
}

/// The first character of the row that is neither `X` nor `.`: one fault a row is enough to mend it.
fn mark_fault(row: usize, text: &str) -> Option<DrawnFault> {
    let (column, mark) = text.chars().enumerate().find(|(_, mark)| !matches!(mark, 'X' | '.'))?;
    let what = format!("character {} of the row is {mark:?}", column + 1);
    let hint = "X where the weft passes over, . where it passes under; nothing else".into();
    Some(DrawnFault { row, column: Some(column), what, hint })
}

/// The weave of a text file with one row a line (first line: weft 0), or its faults. Blank lines may stand before
/// and after the rows, white space at the ends of the lines.
pub fn parse_drawn(text: &str, file: &Path) -> Result<Weave, Faults> {
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    let first = lines.iter().position(|line| !line.is_empty()).unwrap_or(0);
    let end = lines.iter().rposition(|line| !line.is_empty()).map_or(first, |at| at + 1);
    let placed = |fault: DrawnFault| Fault {
        file: file.display().to_string(),
        place: Some(Place { line: first + fault.row + 1, column: fault.column.unwrap_or(0) + 1 }),
        key: String::new(),
        what: fault.what,
        hint: fault.hint,
    };
    match Draft::drawn(&lines[first..end]) {
        Ok(draft) => Ok(Weave::of_draft(draft, Origin::Drawn)),
        Err(faults) => Err(Faults::sorted(faults.into_iter().map(placed).collect())),
    }
}
