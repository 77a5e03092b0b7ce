//! Takes the text of an INI file as weavers' programs write it; gives its sections and lines, and what is no INI.
//!
//! Names of sections and keys are compared in lower case; `;` starts a comment. Not promised: that a value with a `;`
//! in it survives (only titles and notes have such, and nothing here reads them).

use crate::fault::quoted;
use std::collections::BTreeMap;

/// The sections of a file, in its order.
#[derive(Default)]
pub struct Ini {
    sections: Vec<Section>,
    /// Name in lower case to the index of the first section of that name.
    index: BTreeMap<String, usize>,
}

pub struct Section {
    /// Counted from 1.
    pub line: usize,
    /// Whether its lines must be in order.
    strict: bool,
    pub entries: Vec<Entry>,
    /// Key to its index in `entries`.
    index: BTreeMap<String, usize>,
}

pub struct Entry {
    /// In lower case.
    pub key: String,
    pub value: String,
    pub line: usize,
}

/// Sections whose lines must be in order, in lower case; the others (texts, colours, private ones) are not looked at.
pub const STRICT: [&str; 9] =
    ["wif", "contents", "weaving", "warp", "weft", "threading", "treadling", "tieup", "liftplan"];

/// A line that is not as it should be.
pub struct Wrong {
    pub line: usize,
    pub what: String,
    pub hint: &'static str,
}

impl Ini {
    pub fn parse(text: &str) -> (Ini, Vec<Wrong>) {
        let (mut ini, mut wrong) = (Ini::default(), Vec::new());
        for (at, line) in lines(text).enumerate() {
            let content = line.split(';').next().unwrap_or("").trim();
            if !content.is_empty() {
                wrong.extend(ini.add(at + 1, content));
            }
        }
        (ini, wrong)
    }

    pub fn section(&self, name: &str) -> Option<&Section> {
        self.index.get(name).map(|&at| &self.sections[at])
    }

    fn add(&mut self, line: usize, content: &str) -> Option<Wrong> {
        if let Some(name) = content.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            return self.open(line, name.trim().to_lowercase());
        }
        let Some(section) = self.sections.last_mut() else {
            let what = "this line stands before the first section".into();
            return Some(Wrong {
                line,
                what,
                hint: "a section starts with its name in brackets, as in [WIF]",
            });
        };
        let strict = section.strict;
        let wrong = match content.split_once('=') {
            Some((key, value)) => section.add(key.trim().to_lowercase(), value.trim(), line),
            None => Some((
                format!("{} is neither a section nor a key with a value", quoted(content)),
                "write key=value",
            )),
        };
        wrong.filter(|_| strict).map(|(what, hint)| Wrong { line, what, hint })
    }

    fn open(&mut self, line: usize, name: String) -> Option<Wrong> {
        let strict = STRICT.contains(&name.as_str());
        let before = self.section(&name).filter(|_| strict).map(|section| section.line);
        let what = before.map(|at| format!("section [{}] stands in line {at} already", name.to_uppercase()));
        self.index.entry(name).or_insert(self.sections.len());
        self.sections.push(Section { line, strict, entries: Vec::new(), index: BTreeMap::new() });
        what.map(|what| Wrong { line, what, hint: "a section may stand once" })
    }
}

impl Section {
    /// The entry of a key in lower case.
    pub fn entry(&self, key: &str) -> Option<&Entry> {
        self.index.get(key).map(|&at| &self.entries[at])
    }

    /// Adds a line; a key that stands already keeps its first value.
    fn add(&mut self, key: String, value: &str, line: usize) -> Option<(String, &'static str)> {
        if let Some(before) = self.entry(&key) {
            let what = format!("{} has a value already, in line {}", quoted(&key), before.line);
            return Some((what, "a key may stand once in a section"));
        }
        self.index.insert(key.clone(), self.entries.len());
        self.entries.push(Entry { key, value: value.into(), line });
        None
    }
}

/// Lines ended by LF, CR LF, or CR alone.
fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'))
}
