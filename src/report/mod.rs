//! Takes what the other stages found, gives it to people: pictures, a page, a summary for the terminal.
//!
//! Not promised: any finding of its own. Words and numbers are printed as given; what a caller leaves out is shown as
//! not run, never as passed.

pub mod answer;
pub mod content;
pub mod draw;
pub mod export;
pub mod file;
pub mod graphs;
mod html;
pub mod instructions;
pub mod moves;
pub mod page;
pub mod steps;
pub mod text;
pub mod viewer;
pub mod words;
