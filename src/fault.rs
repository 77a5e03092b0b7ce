//! Takes what is wrong with a file; gives it back as text with place and hint, sorted as the file runs.
//!
//! Promised: faults of one file stand in the order of their places, those without a place first. Not promised: that a
//! reader finds every fault; a syntax error can hide what stands behind it.

use std::fmt;

/// Where in a file: line and column, both counted from 1, columns in characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    pub line: usize,
    pub column: usize,
}

impl Place {
    /// The place of the byte `offset` in `text`; an offset past the end is the place behind the last character.
    pub fn of(text: &str, offset: usize) -> Place {
        let mut end = offset.min(text.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &text[..end];
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        Place { line: before.matches('\n').count() + 1, column: before[start..].chars().count() + 1 }
    }
}

/// Finds the places of many bytes of one text, each in a time that does not grow with the text or its lines.
pub struct Lines<'t> {
    text: &'t str,
    /// Bytes at which lines start.
    starts: Vec<usize>,
    /// Characters that start before byte `k * BLOCK`.
    characters: Vec<usize>,
}

/// Bytes whose characters are counted for each place.
const BLOCK: usize = 256;

impl<'t> Lines<'t> {
    pub fn new(text: &'t str) -> Lines<'t> {
        let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        let mut characters = vec![0];
        for block in text.as_bytes().chunks(BLOCK) {
            characters.push(characters[characters.len() - 1] + count(block));
        }
        Lines { text, starts, characters }
    }

    /// The place of the byte `at`, as [`Place::of`] gives it.
    pub fn place(&self, at: usize) -> Place {
        let at = at.min(self.text.len());
        let line = self.starts.partition_point(|&start| start <= at);
        let column = self.before(at) - self.before(self.starts[line - 1]) + 1;
        Place { line, column }
    }

    fn before(&self, at: usize) -> usize {
        let block = at / BLOCK;
        self.characters[block] + count(&self.text.as_bytes()[block * BLOCK..at])
    }
}

/// Characters that start in these bytes of UTF-8.
fn count(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte & 0xc0 != 0x80).count()
}

/// Characters of a user's text that a message repeats.
pub const QUOTED: usize = 60;

/// The text, cut where it is longer than [`QUOTED`] characters.
pub fn shortened(text: &str) -> String {
    let head: String = text.chars().take(QUOTED).collect();
    if head.len() < text.len() { head + "..." } else { head }
}

/// The user's text in quotes, not too much of it, and nothing in it that a terminal would obey.
pub fn quoted(text: &str) -> String {
    format!("{:?}", shortened(text))
}

/// One thing that is wrong with an input file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Path as the user gave it; empty where the input did not come from a file.
    pub file: String,
    pub place: Option<Place>,
    /// Path of the key, as in `swatch.wefts` or `piece[2].from`; empty where no key is concerned.
    pub key: String,
    pub what: String,
    pub hint: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let from = match self.place {
            Some(Place { line, column }) => format!("{}:{line}:{column}: ", self.file),
            None if self.file.is_empty() => String::new(),
            None => format!("{}: ", self.file),
        };
        let key = if self.key.is_empty() {
            String::new()
        } else {
            format!("`{}`: ", shortened(&self.key).escape_debug())
        };
        write!(f, "{from}{key}{}", self.what)?;
        if self.hint.is_empty() { Ok(()) } else { write!(f, "\n  hint: {}", self.hint) }
    }
}

/// All faults of an input, in the order of their places; never empty when handed out as an error.
#[derive(Clone, Debug, Default, PartialEq, Eq, thiserror::Error)]
pub struct Faults(pub Vec<Fault>);

/// Faults written out; a file of another kind can have one on each of its lines, and nobody reads on after a screen.
const SHOWN: usize = 40;

impl Faults {
    pub fn sorted(mut faults: Vec<Fault>) -> Faults {
        faults.sort_by(|a, b| (&a.file, a.place, &a.key).cmp(&(&b.file, b.place, &b.key)));
        Faults(faults)
    }

    /// `value` where nothing is wrong, else what is.
    pub fn or<T>(self, value: T) -> Result<T, Faults> {
        if self.0.is_empty() { Ok(value) } else { Err(self) }
    }
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Faults {
        Faults(vec![fault])
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, fault) in self.0.iter().take(SHOWN).enumerate() {
            let gap = if at == 0 { "" } else { "\n\n" };
            write!(f, "{gap}{fault}")?;
        }
        match self.0.len().saturating_sub(SHOWN) {
            0 => Ok(()),
            more => write!(f, "\n\n... and {more} more"),
        }
    }
}
