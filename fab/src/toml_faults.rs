//! Takes the text of a TOML file; gives its values one by one, and collects everything that is wrong, with its line.
//!
//! A value that is missing or wrong reads as a harmless stand-in, so that reading goes on to the next fault; whoever
//! reads must look at the faults before using anything.

use serde::Serialize;
use std::fmt;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// One thing wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FileFault {
    /// From 1; 0 where there is no line.
    pub line: usize,
    pub what: String,
    pub hint: String,
}

impl fmt::Display for FileFault {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let line = if self.line > 0 { format!("{}:", self.line) } else { String::new() };
        write!(f, "{line} {} (hint: {})", self.what, self.hint)
    }
}

/// A table being read.
pub struct Cursor<'a> {
    text: &'a str,
    /// `None` where the table itself is missing.
    table: Option<DeTable<'a>>,
    line: usize,
    asked: Vec<&'static str>,
    faults: &'a mut Vec<FileFault>,
}

impl<'a> Cursor<'a> {
    /// The whole file; `None` (and faults) where it is not TOML.
    pub fn parse(text: &'a str, faults: &'a mut Vec<FileFault>) -> Option<Cursor<'a>> {
        let (table, errors) = DeTable::parse_recoverable(text);
        for e in &errors {
            let line = e.span().map_or(1, |s| line_of(text, s.start));
            faults.push(FileFault {
                line,
                what: e.message().to_string(),
                hint: "the file is to be TOML".into(),
            });
        }
        errors.is_empty().then(|| Cursor {
            text,
            table: Some(table.into_inner()),
            line: 1,
            asked: vec![],
            faults,
        })
    }

    pub fn fault(&mut self, key: &str, what: String, hint: &str) {
        let line = self.get(key).map_or(self.line, |v| line_of(self.text, v.span().start));
        self.faults.push(FileFault { line, what, hint: hint.to_string() });
    }

    fn get(&self, key: &str) -> Option<&Spanned<DeValue<'a>>> {
        self.table.as_ref()?.get(key)
    }

    fn missing(&mut self, key: &str, hint: &str) {
        if self.table.is_some() {
            self.fault(key, format!("\"{key}\" is missing"), hint);
        }
    }

    /// A text that is not empty.
    pub fn text(&mut self, key: &'static str) -> String {
        self.asked.push(key);
        let found = self.get(key).map(|v| v.get_ref().as_str().map(str::to_string));
        match found {
            None => self.missing(key, "a text in quotes"),
            Some(Some(s)) if !s.trim().is_empty() => return s,
            Some(_) => self.fault(key, format!("\"{key}\" is not a text, or empty"), "a text in quotes"),
        }
        String::new()
    }

    /// A text out of a few.
    pub fn text_of(&mut self, key: &'static str, choice: &[&str]) -> String {
        let before = self.faults.len();
        let text = self.text(key);
        if before == self.faults.len() && self.table.is_some() && !choice.contains(&text.as_str()) {
            self.fault(key, format!("\"{key}\" is \"{text}\""), &format!("one of: {}", choice.join(", ")));
        }
        text
    }

    /// Whether the key is there.
    pub fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// A number in a range; NaN stands in for a bad one.
    pub fn number_in(&mut self, key: &'static str, least: f64, most: f64, unit: &str) -> f64 {
        self.number_because(key, (least, most), unit, "")
    }

    /// The same, with the reason why nothing beyond the range is possible.
    pub fn number_because(
        &mut self,
        key: &'static str,
        (least, most): (f64, f64),
        unit: &str,
        because: &str,
    ) -> f64 {
        self.asked.push(key);
        let why = if because.is_empty() { String::new() } else { format!("; {because}") };
        let hint = format!("a number from {least} to {most} {unit}{why}");
        match self.get(key).map(|v| number(v.get_ref())) {
            None => self.missing(key, &hint),
            Some(Some(x)) if (least..=most).contains(&x) => return x,
            Some(Some(x)) => self.fault(key, format!("\"{key}\" of {x} {unit} is not possible"), &hint),
            Some(None) => self.fault(key, format!("\"{key}\" is not a number"), &hint),
        }
        f64::NAN
    }

    /// A table below this one, read by `f`.
    pub fn table<T>(&mut self, key: &'static str, f: impl FnOnce(&mut Cursor) -> T) -> T {
        self.asked.push(key);
        let found =
            self.get(key).map(|v| (line_of(self.text, v.span().start), v.get_ref().as_table().cloned()));
        match &found {
            None => self.missing(key, "a table"),
            Some((_, None)) => self.fault(key, format!("\"{key}\" is not a table"), "a table"),
            _ => {}
        }
        let (line, table) = found.unwrap_or((self.line, None));
        f(&mut Cursor { text: self.text, table, line, asked: vec![], faults: self.faults })
    }

    /// Each table of a list of tables, read by `f`; at least one.
    pub fn each<T>(&mut self, key: &'static str, f: impl Fn(&mut Cursor) -> T) -> Vec<T> {
        self.asked.push(key);
        let hint = format!("at least one [[{key}]]");
        let rows: Vec<(usize, Option<DeTable>)> = match self.get(key).map(|v| v.get_ref().as_array()) {
            Some(Some(rows)) => rows
                .iter()
                .map(|r| (line_of(self.text, r.span().start), r.get_ref().as_table().cloned()))
                .collect(),
            _ => vec![],
        };
        if rows.is_empty() || rows.iter().any(|(_, t)| t.is_none()) {
            self.fault(key, format!("\"{key}\" is not a list of tables"), &hint);
        }
        rows.into_iter()
            .filter(|(_, table)| table.is_some())
            .map(|(line, table)| {
                f(&mut Cursor { text: self.text, table, line, asked: vec![], faults: self.faults })
            })
            .collect()
    }

    /// Refuses keys that were not asked for.
    pub fn refuse_others(&mut self, hint: &str) {
        let Some(table) = &self.table else { return };
        let others: Vec<(usize, String)> = table
            .iter()
            .filter(|(k, _)| !self.asked.contains(&k.get_ref().as_ref()))
            .map(|(k, _)| (line_of(self.text, k.span().start), k.get_ref().to_string()))
            .collect();
        for (line, key) in others {
            self.faults.push(FileFault {
                line,
                what: format!("unknown key \"{key}\""),
                hint: hint.to_string(),
            });
        }
    }
}

fn number(v: &DeValue) -> Option<f64> {
    match v {
        DeValue::Float(x) => x.as_str().parse().ok(),
        DeValue::Integer(x) => i64::from_str_radix(x.as_str(), x.radix()).ok().map(|x| x as f64),
        _ => None,
    }
}

fn line_of(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|b| *b == b'\n').count()
}
