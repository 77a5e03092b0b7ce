//! Takes words, numbers already written out, and pictures; gives the chapters that page and terminal both print.
//!
//! Not promised: truth. Tone and words are the caller's; an answer that is missing says why it is.

/// What an answer means to the reader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    Good,
    Bad,
    /// Neither was shown.
    Undecided,
    /// A statement, not a verdict.
    #[default]
    Plain,
}

impl Tone {
    /// A sign of its own, so that colour is never the only carrier.
    pub fn mark(self) -> char {
        match self {
            Tone::Good => '✓',
            Tone::Bad => '✗',
            Tone::Undecided => '?',
            Tone::Plain => '·',
        }
    }
}

/// Something that was asked, or was not.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer<T> {
    Given(T),
    /// Printed as "not run" with the reason; never looks like a pass.
    NotRun {
        why: String,
    },
}

impl<T> Answer<T> {
    pub fn not_run(why: impl Into<String>) -> Answer<T> {
        Answer::NotRun { why: why.into() }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Left,
    Right,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    pub title: String,
    pub align: Align,
}

impl Column {
    pub fn words(title: &str) -> Column {
        Column { title: title.into(), align: Align::Left }
    }

    pub fn numbers(title: &str) -> Column {
        Column { title: title.into(), align: Align::Right }
    }
}

/// Rows may be shorter than the head (the rest stays empty); what is longer is not printed.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    pub caption: String,
    pub head: Vec<Column>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// The cells of a row, as many as the head has columns.
    pub(super) fn cells<'a>(&'a self, row: &'a [String]) -> impl Iterator<Item = (&'a Column, &'a str)> {
        self.head.iter().enumerate().map(|(k, c)| (c, row.get(k).map_or("", String::as_str)))
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum Format {
    Png(Vec<u8>),
    Svg(String),
}

#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    pub format: Format,
    /// Pixels, so that a page keeps its place while it loads.
    pub width: u32,
    pub height: u32,
    /// What a reader who does not see the picture is told.
    pub alt: String,
    pub caption: String,
}

/// One answer: a headline, sentences, named values, tables, pictures; whatever is empty is not printed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chapter {
    pub tone: Tone,
    pub headline: String,
    pub words: Vec<String>,
    /// Name and value, the value with its unit.
    pub facts: Vec<(String, String)>,
    pub tables: Vec<Table>,
    /// The page shows them; a terminal does not.
    pub pictures: Vec<Picture>,
    /// Lines in fixed-width letters, kept as they are; the terminal shows them, the page does not where it has pictures.
    pub figure: Vec<String>,
}

/// Characters that could steer a terminal or reorder a line (controls, bidirectional overrides) become U+FFFD.
pub(super) fn harmless(c: char) -> char {
    let steers = c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    if steers { char::REPLACEMENT_CHARACTER } else { c }
}
