//! Takes chapters, gives the lines that a terminal shows.
//!
//! Promised: no line longer than asked for, except where a figure or one word is; no escape sequence comes from the
//! caller's strings, and none at all in plain ink. Not promised: alignment of characters wider than one column.

use super::content::{Align, Answer, Chapter, Table, Tone, harmless};
use std::io::IsTerminal;

/// Whether the lines carry colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    Plain,
    Colour,
}

impl Ink {
    /// Colour where standard output is a terminal that wants it (`NO_COLOR` unset or empty, `TERM` not `dumb`).
    pub fn for_stdout() -> Ink {
        let set = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
        let dumb = std::env::var_os("TERM").is_some_and(|t| t == "dumb");
        let wanted = std::io::stdout().is_terminal() && !set("NO_COLOR") && !dumb;
        if wanted { Ink::Colour } else { Ink::Plain }
    }
}

/// Length of a line, in columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Columns(pub usize);

impl Default for Columns {
    fn default() -> Self {
        Columns(100)
    }
}

/// What a run found, in the order to be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    pub title: String,
    /// What was looked at, in one sentence.
    pub lead: String,
    pub chapters: Vec<(String, Answer<Chapter>)>,
    /// The last words, such as where to read on.
    pub closing: Vec<String>,
}

/// Columns that a chapter's contents stand in from the left.
const INDENT: usize = 2;
/// Columns between a name and its value, and between the columns of a table.
const GAP: usize = 3;
/// Least columns left for a value, however long its name.
const LEAST_VALUE: usize = 24;

#[derive(Clone, Copy)]
enum Style {
    Title,
    Heading,
    Faint,
    Verdict(Tone),
}

struct Paper {
    out: String,
    ink: Ink,
    width: usize,
    /// Length of `out` right after the last chapter's title.
    chapter_starts: usize,
}

/// The summary as lines, each ended by a newline.
pub fn write(summary: &Summary, ink: Ink, width: Columns) -> String {
    let mut paper =
        Paper { out: String::new(), ink, width: width.0.max(INDENT + LEAST_VALUE + GAP), chapter_starts: 0 };
    paper.styled(0, &summary.title, Style::Title);
    paper.wrapped(0, "", &summary.lead);
    for (title, answer) in &summary.chapters {
        paper.blank();
        paper.styled(0, title, Style::Heading);
        match answer {
            Answer::Given(chapter) => paper.chapter(chapter),
            Answer::NotRun { why } => paper.wrapped(INDENT, "not run: ", why),
        }
    }
    if !summary.closing.is_empty() {
        paper.blank();
        summary.closing.iter().for_each(|w| paper.wrapped(0, "", w));
    }
    paper.out
}

impl Paper {
    fn chapter(&mut self, c: &Chapter) {
        self.chapter_starts = self.out.len();
        if !c.headline.is_empty() {
            self.headline(c.tone, &c.headline);
        }
        c.words.iter().for_each(|w| self.wrapped(INDENT, "", w));
        self.gap_before(!c.figure.is_empty());
        c.figure.iter().for_each(|l| self.line(INDENT, &clean(l)));
        self.gap_before(!c.facts.is_empty());
        self.facts(&c.facts);
        for t in &c.tables {
            self.gap_before(true);
            self.table(t);
        }
    }

    fn headline(&mut self, tone: Tone, words: &str) {
        let first = format!("{} ", tone.mark());
        for (k, line) in wrap(&clean(words), self.width - INDENT - 2).into_iter().enumerate() {
            let lead = if k == 0 { first.as_str() } else { "  " };
            self.styled(INDENT, &format!("{lead}{line}"), Style::Verdict(tone));
        }
    }

    /// Names on the left, values on a common edge.
    fn facts(&mut self, facts: &[(String, String)]) {
        let longest = facts.iter().map(|(n, _)| clean(n).chars().count()).max().unwrap_or(0);
        let edge = (longest + GAP).min(self.width - INDENT - LEAST_VALUE);
        for (name, value) in facts {
            let name = clean(name);
            let lines = wrap(&clean(value), self.width - INDENT - edge);
            let fits = name.chars().count() < edge;
            if !fits {
                self.styled(INDENT, &name, Style::Faint);
            }
            for (k, line) in lines.into_iter().enumerate() {
                let name = if k == 0 && fits { pad(&name, edge, Align::Left) } else { " ".repeat(edge) };
                let name = self.tinted(&name, Style::Faint);
                self.line(INDENT, &format!("{name}{line}"));
            }
        }
    }

    /// In columns; where even the longest words do not fit side by side, each row becomes a list of its own.
    fn table(&mut self, table: &Table) {
        if !table.caption.is_empty() {
            self.wrapped(INDENT, "", &table.caption);
        }
        let Some(widths) = self.widths(table) else { return self.stacked(table) };
        let titles: Vec<String> = table.head.iter().map(|c| c.title.clone()).collect();
        for line in self.row(table, &titles, &widths) {
            self.styled(INDENT, &line, Style::Faint);
        }
        for row in &table.rows {
            self.row(table, row, &widths).iter().for_each(|line| self.line(INDENT, line));
        }
        if table.rows.is_empty() {
            self.line(INDENT, "none");
        }
    }

    fn stacked(&mut self, table: &Table) {
        for (k, row) in table.rows.iter().enumerate() {
            if k > 0 {
                self.blank();
            }
            let named = table.cells(row).filter(|(_, text)| !text.is_empty());
            self.facts(&named.map(|(c, text)| (c.title.clone(), text.to_string())).collect::<Vec<_>>());
        }
    }

    /// As wide as the contents; where that is too wide, the widest columns give way down to their longest words.
    fn widths(&self, table: &Table) -> Option<Vec<usize>> {
        let count = |s: &str| s.chars().count();
        let longest_word = |s: &str| s.split(' ').map(count).max().unwrap_or(0);
        let most = |measure: &dyn Fn(&str) -> usize| -> Vec<usize> {
            let column =
                |k: usize| table.rows.iter().filter_map(move |r| r.get(k)).chain([&table.head[k].title]);
            (0..table.head.len()).map(|k| column(k).map(|t| measure(&clean(t))).max().unwrap_or(0)).collect()
        };
        let (mut widths, least) = (most(&count), most(&longest_word));
        let room = (self.width - INDENT).checked_sub(GAP * widths.len().saturating_sub(1))?;
        while widths.iter().sum::<usize>() > room {
            let gives = (0..widths.len()).filter(|&k| widths[k] > least[k]).max_by_key(|&k| widths[k])?;
            widths[gives] -= 1;
        }
        Some(widths)
    }

    /// The lines of a table's row: every cell wrapped inside its column.
    fn row(&self, table: &Table, row: &[String], widths: &[usize]) -> Vec<String> {
        let cells: Vec<Vec<String>> =
            table.cells(row).zip(widths).map(|((_, text), &w)| wrap(&clean(text), w)).collect();
        let height = cells.iter().map(Vec::len).max().unwrap_or(0);
        let at = |k: usize, y: usize| {
            let text = cells[k].get(y).map_or("", String::as_str);
            pad(text, widths[k], table.head[k].align)
        };
        let join = |y| (0..cells.len()).map(|k| at(k, y)).collect::<Vec<_>>().join(&" ".repeat(GAP));
        (0..height).map(|y| join(y).trim_end().to_string()).collect()
    }

    /// Words that start with `lead` and hang below it.
    fn wrapped(&mut self, indent: usize, lead: &str, words: &str) {
        let hang = lead.chars().count();
        for (k, line) in wrap(&clean(words), self.width - indent - hang).into_iter().enumerate() {
            let before = if k == 0 { lead.to_string() } else { " ".repeat(hang) };
            self.line(indent, &format!("{before}{line}"));
        }
    }

    fn styled(&mut self, indent: usize, text: &str, style: Style) {
        let text = self.tinted(&clean(text), style);
        self.line(indent, &text);
    }

    fn tinted(&self, text: &str, style: Style) -> String {
        match self.ink {
            Ink::Plain => text.to_string(),
            Ink::Colour => format!("\x1b[{}m{text}\x1b[0m", code(style)),
        }
    }

    fn line(&mut self, indent: usize, text: &str) {
        let line = format!("{}{text}", " ".repeat(indent));
        self.out.push_str(line.trim_end());
        self.out.push('\n');
    }

    /// A blank line where a block follows, but not right below the chapter's title.
    fn gap_before(&mut self, block: bool) {
        if block && self.out.len() > self.chapter_starts {
            self.blank();
        }
    }

    fn blank(&mut self) {
        self.out.push('\n');
    }
}

/// Select Graphic Rendition codes out of the 16 colours that every theme sets to be legible.
fn code(style: Style) -> &'static str {
    match style {
        Style::Title => "1",
        Style::Heading => "1;34",
        Style::Faint => "2",
        Style::Verdict(Tone::Good) => "1;32",
        Style::Verdict(Tone::Bad) => "1;31",
        Style::Verdict(Tone::Undecided) => "1;33",
        Style::Verdict(Tone::Plain) => "0",
    }
}

fn clean(text: &str) -> String {
    text.chars().map(|c| if c == '\n' { ' ' } else { harmless(c) }).collect()
}

fn pad(text: &str, width: usize, align: Align) -> String {
    let missing = " ".repeat(width.saturating_sub(text.chars().count()));
    match align {
        Align::Left => format!("{text}{missing}"),
        Align::Right => format!("{missing}{text}"),
    }
}

/// Lines of at most `width` characters, broken at spaces; a longer word (a path) is cut only where it must be.
fn wrap(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let (mut lines, mut line, mut used) = (Vec::new(), String::new(), 0);
    for word in text.split(' ').filter(|w| !w.is_empty()) {
        let length = word.chars().count();
        if used > 0 && used + 1 + length > width {
            lines.push(std::mem::take(&mut line));
            used = 0;
        }
        if used > 0 {
            line.push(' ');
            used += 1;
        }
        for c in word.chars() {
            if used == width {
                lines.push(std::mem::take(&mut line));
                used = 0;
            }
            line.push(c);
            used += 1;
        }
    }
    lines.push(line);
    lines
}
