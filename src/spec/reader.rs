//! Takes a tree of values; hands out typed fields and notes every fault, so that one run tells them all.
//!
//! Promised: a reading that gives None has noted why. Not promised: an order of faults; they are sorted at the end.

use super::Places;
use super::tree::{Node, SyntaxFault, Table, Value};
use super::units::{Wrong, millimetres, percent};
use crate::fault::{Fault, Faults, Lines, Place, QUOTED, quoted, shortened};
use std::collections::BTreeSet;
use std::fmt::Display;
use std::ops::{Bound, RangeBounds, RangeInclusive};
use std::path::PathBuf;

/// A key, an item of a list, or the whole file, and what it holds.
#[derive(Clone)]
pub struct Field<'t> {
    pub path: String,
    at: Option<usize>,
    value: &'t Value,
}

/// The keys of a table.
#[derive(Clone)]
pub struct Fields<'t> {
    pub path: String,
    at: Option<usize>,
    table: &'t Table,
}

impl Field<'_> {
    pub fn as_text(&self) -> Option<&str> {
        match self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }
}

impl<'t> Fields<'t> {
    pub fn keys(&self) -> impl Iterator<Item = &'t str> + use<'t> {
        self.table.0.iter().map(|(key, _)| key.name.as_str())
    }
}

/// Faults of one file that are kept.
const MAX_FAULTS: usize = 1000;

pub struct Reader<'t> {
    lines: Lines<'t>,
    pub file: PathBuf,
    faults: Vec<Fault>,
    places: Places,
    /// Lines with a fault of syntax: what stands there is not read as if it were meant.
    broken: BTreeSet<usize>,
}

impl<'t> Reader<'t> {
    pub fn new(text: &'t str, file: PathBuf, syntax: Vec<SyntaxFault>) -> Reader<'t> {
        let mut reader = Reader {
            lines: Lines::new(text),
            file,
            faults: Vec::new(),
            places: Places::default(),
            broken: BTreeSet::new(),
        };
        for fault in syntax {
            let place = reader.place(fault.at);
            reader.note(Some(place), "", fault.what, fault.hint);
            reader.broken.insert(place.line);
        }
        reader
    }

    /// What was read, where nothing is wrong; else all faults.
    pub fn finish<T>(self, value: Option<T>) -> Result<(T, Places), Faults> {
        match value {
            Some(value) if self.faults.is_empty() => Ok((value, self.places)),
            _ => Err(Faults::sorted(self.faults)),
        }
    }

    fn place(&self, at: usize) -> Place {
        self.lines.place(at)
    }

    fn note(&mut self, place: Option<Place>, key: &str, what: impl Into<String>, hint: impl Into<String>) {
        let broken = place.is_some_and(|place| self.broken.contains(&place.line));
        if broken || self.faults.len() == MAX_FAULTS {
            return;
        }
        let file = self.file.display().to_string();
        self.faults.push(Fault { file, place, key: key.into(), what: what.into(), hint: hint.into() });
    }

    /// Notes a fault of the field.
    pub fn fault(&mut self, field: &Field, what: impl Into<String>, hint: impl Into<String>) {
        let place = field.at.map(|at| self.place(at));
        self.note(place, &field.path, what, hint);
    }

    /// Notes a fault of a whole table, such as a key that is missing; after a fault of syntax nothing is missing for
    /// sure, and nothing is noted.
    pub fn lacks<T>(&mut self, table: &Fields, key: &str, what: &str, hint: &str) -> Option<T> {
        let place = table.at.map(|at| self.place(at));
        if self.broken.is_empty() {
            self.note(place, &joined(&table.path, key), what, hint);
        }
        None
    }

    /// Notes faults found elsewhere, in another file.
    pub fn others(&mut self, faults: Faults) {
        self.faults.extend(faults.0);
    }

    pub fn root(&mut self, table: &'t Table) -> Fields<'t> {
        Fields { path: String::new(), at: None, table }
    }

    /// The field of a key, its place remembered.
    pub fn get(&mut self, fields: &Fields<'t>, key: &str) -> Option<Field<'t>> {
        let (name, node) = fields.table.0.iter().find(|(name, _)| name.name == key)?;
        let at = if matches!(node.value, Value::Table(_)) { name.at } else { node.at };
        Some(self.field(joined(&fields.path, key), at, node))
    }

    fn field(&mut self, path: String, at: usize, node: &'t Node) -> Field<'t> {
        let place = self.place(at);
        self.places.0.insert(path.clone(), place);
        Field { path, at: Some(at), value: &node.value }
    }

    /// The keys of a table field.
    pub fn table(&mut self, field: &Field<'t>) -> Option<Fields<'t>> {
        match field.value {
            Value::Table(table) => Some(Fields { path: field.path.clone(), at: field.at, table }),
            _ => self.wrong_kind(field, "a table", "write it as [name] with its keys below"),
        }
    }

    /// The items of a list field.
    pub fn list(&mut self, field: &Field<'t>, hint: &str) -> Option<Vec<Field<'t>>> {
        let Value::List(items) = field.value else { return self.wrong_kind(field, "a list", hint) };
        let item = |(k, node): (usize, &'t Node)| self.field(format!("{}[{k}]", field.path), node.at, node);
        Some(items.iter().enumerate().map(item).collect())
    }

    fn wrong_kind<T>(&mut self, field: &Field, wanted: &str, hint: &str) -> Option<T> {
        self.fault(field, format!("{} is wanted here, not {}", wanted, field.value.kind()), hint);
        None
    }

    /// Notes each key of the table that is not `known`; `home` may tell where else such a key belongs.
    pub fn only(&mut self, fields: &Fields<'t>, known: &[&str], home: impl Fn(&str) -> Option<&'static str>) {
        for (key, _) in fields.table.0.iter().filter(|(key, _)| !known.contains(&key.name.as_str())) {
            let hint = match (home(&key.name), nearest(&key.name, known)) {
                (Some(home), _) => home.to_string(),
                (None, Some(near)) => format!("did you mean `{near}`?"),
                (None, None) => format!("known here: {}", known.join(", ")),
            };
            let place = self.place(key.at);
            // Behind a table header that is broken, keys seem to stand at the top.
            if fields.path.is_empty() && self.broken.first().is_some_and(|&line| line < place.line) {
                continue;
            }
            self.note(Some(place), &fields.path, format!("unknown key {}", quoted(&key.name)), hint);
        }
    }

    pub fn text(&mut self, field: &Field<'t>, hint: &str) -> Option<&'t str> {
        match field.value {
            Value::Text(text) => Some(text),
            _ => self.wrong_kind(field, "a string", hint),
        }
    }

    pub fn flag(&mut self, field: &Field<'t>) -> Option<bool> {
        match field.value {
            Value::Flag(flag) => Some(*flag),
            _ => self.wrong_kind(field, "true or false", "without quotes"),
        }
    }

    /// One of the words, as what it stands for.
    pub fn choice<T: Copy>(&mut self, field: &Field<'t>, words: &[(&str, T)]) -> Option<T> {
        let names: Vec<String> = words.iter().map(|(word, _)| format!("\"{word}\"")).collect();
        let hint = format!("one of {}", names.join(", "));
        let text = self.text(field, &hint)?;
        let found = words.iter().find(|(word, _)| *word == text).map(|(_, meaning)| *meaning);
        if found.is_none() {
            self.fault(field, format!("{} is not known here", quoted(text)), hint);
        }
        found
    }

    /// A whole number in the range; `why` gives the reason of the bounds.
    pub fn integer(&mut self, field: &Field<'t>, range: RangeInclusive<i64>, why: &str) -> Option<i64> {
        let outside = |written: &dyn Display| {
            format!("is {written}, but it must be {} to {}", range.start(), range.end())
        };
        match field.value {
            Value::Integer(n) if range.contains(n) => return Some(*n),
            Value::Integer(n) => self.fault(field, outside(n), why),
            Value::Huge(digits) => self.fault(field, outside(&quoted(digits)), why),
            Value::Float(x) => {
                let hint = "no fraction, no decimal point, no exponent";
                self.fault(field, format!("is {x:?}, but a whole number is wanted"), hint);
            }
            _ => return self.wrong_kind(field, "a whole number", why),
        }
        None
    }

    /// A finite number in the range; `why` gives the reason of the bounds.
    pub fn number(&mut self, field: &Field<'t>, range: impl RangeBounds<f64>, why: &str) -> Option<f64> {
        let value = match field.value {
            Value::Integer(n) => *n as f64,
            Value::Float(x) => *x,
            Value::Huge(digits) => digits.parse().unwrap_or(f64::INFINITY),
            _ => return self.wrong_kind(field, "a number", why),
        };
        self.within(field, value, "", range, why)
    }

    /// Millimetres of a length with its unit, in the range.
    pub fn length(&mut self, field: &Field<'t>, range: impl RangeBounds<f64>, why: &str) -> Option<f64> {
        let mm = self.quantity(field, "\"20 mm\"", millimetres)?;
        self.within(field, mm, " mm", range, why)
    }

    /// Fraction of a share with its percent sign; the range is in percent.
    pub fn share(&mut self, field: &Field<'t>, range: impl RangeBounds<f64>, why: &str) -> Option<f64> {
        let share = self.quantity(field, "\"0.2 %\"", percent)?;
        self.within(field, share, " %", range, why).map(|percent| percent / 100.0)
    }

    fn quantity(
        &mut self,
        field: &Field<'t>,
        example: &str,
        read: impl Fn(&str) -> Result<f64, Wrong>,
    ) -> Option<f64> {
        let text =
            self.text(field, &format!("write the number and its unit as a string, as in {example}"))?;
        match read(&shortened(text)) {
            Ok(value) => Some(value),
            Err((what, hint)) => {
                self.fault(field, what, hint);
                None
            }
        }
    }

    fn within(
        &mut self,
        field: &Field,
        value: f64,
        unit: &str,
        range: impl RangeBounds<f64>,
        why: &str,
    ) -> Option<f64> {
        if !value.is_finite() {
            self.fault(field, format!("is {value}, but a finite number is wanted"), why);
            return None;
        }
        if range.contains(&value) {
            return Some(value);
        }
        let low = limit(range.start_bound(), "at least", "above", unit);
        let high = limit(range.end_bound(), "at most", "below", unit);
        let both: Vec<String> = low.into_iter().chain(high).collect();
        self.fault(field, format!("is {value:?}{unit}, but it must be {}", both.join(" and ")), why);
        None
    }
}

fn limit(bound: Bound<&f64>, closed: &str, open: &str, unit: &str) -> Option<String> {
    match bound {
        Bound::Included(x) => Some(format!("{closed} {x}{unit}")),
        Bound::Excluded(x) => Some(format!("{open} {x}{unit}")),
        Bound::Unbounded => None,
    }
}

fn joined(path: &str, key: &str) -> String {
    match (path, key) {
        ("", key) => key.to_string(),
        (path, "") => path.to_string(),
        (path, key) => format!("{path}.{key}"),
    }
}

/// The known word that a slip of the fingers turns into `word`: at most one slip in three letters.
pub fn nearest<'k>(word: &str, known: &[&'k str]) -> Option<&'k str> {
    if word.len() > QUOTED {
        return None;
    }
    let lower = word.to_lowercase();
    let slips = known.iter().map(|name| (strsim::osa_distance(&lower, name), *name));
    slips.min().filter(|(count, name)| 3 * count <= name.len().max(3)).map(|(_, name)| name)
}
