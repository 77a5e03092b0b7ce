//! Takes the text of a TOML file; gives its values as a tree that knows where each one stands.
//!
//! Promised: one tree for both syntaxes (JSON: see `json`). Not promised: after a syntax fault the tree holds what
//! could be saved, not what was meant.

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value and the byte offset at which it starts.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub at: usize,
    pub value: Value,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Text(String),
    Integer(i64),
    /// An integer beyond 64 bits, as written.
    Huge(String),
    Float(f64),
    Flag(bool),
    /// JSON's null.
    Null,
    Date,
    List(Vec<Node>),
    Table(Table),
}

/// The keys of a table in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table(pub Vec<(Key, Node)>);

#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    pub name: String,
    pub at: usize,
}

/// A fault of syntax, at a byte offset.
#[derive(Clone, Debug, PartialEq)]
pub struct SyntaxFault {
    pub at: usize,
    pub what: String,
    pub hint: &'static str,
}

impl Value {
    /// What the value is, with its article, for use in a sentence.
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Text(_) => "a string",
            Value::Integer(_) => "a whole number",
            Value::Huge(_) => "a number beyond 64 bits",
            Value::Float(_) => "a number with a fraction",
            Value::Flag(_) => "true or false",
            Value::Null => "null",
            Value::Date => "a date",
            Value::List(_) => "a list",
            Value::Table(_) => "a table",
        }
    }
}

/// The tree of a TOML text, as far as it could be read, and its faults of syntax.
pub fn toml(text: &str) -> (Table, Vec<SyntaxFault>) {
    let (document, errors) = DeTable::parse_recoverable(text);
    let faults = errors.iter().map(|error| SyntaxFault {
        at: error.span().map_or(0, |span| span.start),
        what: error.message().lines().next().unwrap_or("this is not TOML").to_string(),
        hint: hint(error.message()),
    });
    (table(document.into_inner()), faults.collect())
}

fn hint(message: &str) -> &'static str {
    if message.contains("duplicate key") {
        "a key may stand once in a table; [[piece]] and [[part]] begin a new one each"
    } else if message.contains("escape") {
        "a backslash begins a sign of its own; write paths with /, as in \"parts/key.stl\""
    } else {
        "TOML: a line is `key = value` or `[table]`; strings stand in quotes"
    }
}

fn table(source: DeTable<'_>) -> Table {
    let entry = |(key, value): (Spanned<_>, Spanned<DeValue<'_>>)| {
        let at = key.span().start;
        (Key { name: std::borrow::Cow::into_owned(key.into_inner()), at }, node(value))
    };
    let mut entries: Vec<(Key, Node)> = source.into_iter().map(entry).collect();
    entries.sort_by_key(|(key, _)| key.at);
    Table(entries)
}

fn node(source: Spanned<DeValue<'_>>) -> Node {
    let at = source.span().start;
    let value = match source.into_inner() {
        DeValue::String(text) => Value::Text(text.into_owned()),
        DeValue::Integer(number) => integer(number.as_str(), number.radix()),
        DeValue::Float(number) => number.as_str().parse().map_or(Value::Null, Value::Float),
        DeValue::Boolean(flag) => Value::Flag(flag),
        DeValue::Datetime(_) => Value::Date,
        DeValue::Array(items) => Value::List(items.into_iter().map(node).collect()),
        DeValue::Table(inner) => Value::Table(table(inner)),
    };
    Node { at, value }
}

/// An integer of the radix; beyond 64 bits its digits.
pub fn integer(digits: &str, radix: u32) -> Value {
    i64::from_str_radix(digits, radix).map_or_else(|_| Value::Huge(digits.into()), Value::Integer)
}
