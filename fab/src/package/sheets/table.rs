//! Takes rows of words; gives a Markdown table, and figures as a reader wants them.
//!
//! Not promised: columns that line up in the source.

use crate::process::Figure;

/// A table with a head.
pub fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let line =
        |cells: &[String]| format!("| {} |\n", cells.iter().map(|c| cell(c)).collect::<Vec<_>>().join(" | "));
    let head: Vec<String> = head.iter().map(ToString::to_string).collect();
    let rule = vec!["---".to_string(); head.len()];
    let rows: String = rows.into_iter().map(|r| line(&r)).collect();
    format!("\n{}{}{rows}\n", line(&head), line(&rule))
}

/// A bar would end the cell, a line break the row.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace(['\n', '\r'], " ")
}

/// Value and unit.
pub fn value(f: &Figure) -> String {
    format!("{} {}", f.value, unit(f.unit))
}

fn unit(unit: &str) -> &str {
    if unit == "C" { "\u{b0}C" } else { unit }
}

/// The range, where there is one.
pub fn range(f: &Figure) -> String {
    if f.low == f.high { String::new() } else { format!("{} to {}", f.low, f.high) }
}

/// Up to three decimals, none that say nothing.
pub fn short(x: f64) -> String {
    let text = format!("{x:.3}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}
