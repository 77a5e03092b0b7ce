//! Takes the text of a JSON file; gives its values as a tree that knows where each one stands, or its first fault.
//!
//! Promised: the grammar of RFC 8259, with keys that stand twice refused. Not promised: more than one fault, nor
//! nesting deeper than [`DEPTH`].

use super::tree::{Key, Node, SyntaxFault, Table, Value, integer};
use std::collections::BTreeSet;

/// Deepest nesting that is read; a spec needs 4. The same as the TOML reader's, and far from the end of the stack.
const DEPTH: usize = 80;

/// The table that the text holds.
pub fn json(text: &str) -> Result<Table, SyntaxFault> {
    let mut cursor = Cursor { text, at: 0, depth: 0 };
    cursor.blanks();
    let node = cursor.value()?;
    cursor.blanks();
    if cursor.at < text.len() {
        return Err(cursor.fault("something stands behind the end", "a file holds one object in braces"));
    }
    match node.value {
        Value::Table(table) => Ok(table),
        _ => Err(SyntaxFault {
            at: 0,
            what: "this is no object".into(),
            hint: "a spec is one object in braces",
        }),
    }
}

struct Cursor<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

type Read<T> = Result<T, SyntaxFault>;

impl Cursor<'_> {
    fn fault(&self, what: &str, hint: &'static str) -> SyntaxFault {
        SyntaxFault { at: self.at, what: what.into(), hint }
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn blanks(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\n' | b'\r')) {
            self.at += 1;
        }
    }

    fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    fn value(&mut self) -> Read<Node> {
        let at = self.at;
        let value = match self.peek() {
            Some(b'{') => self.deeper(Self::object)?,
            Some(b'[') => self.deeper(Self::list)?,
            Some(b'"') => Value::Text(self.string()?),
            Some(b'-' | b'0'..=b'9') => self.number()?,
            _ => self.word()?,
        };
        Ok(Node { at, value })
    }

    fn deeper(&mut self, read: impl Fn(&mut Self) -> Read<Value>) -> Read<Value> {
        if self.depth == DEPTH {
            return Err(self.fault("lists and objects are nested too deep", "a spec needs four levels"));
        }
        self.depth += 1;
        self.at += 1;
        let value = read(self)?;
        self.depth -= 1;
        Ok(value)
    }

    fn word(&mut self) -> Read<Value> {
        let words = [("true", Value::Flag(true)), ("false", Value::Flag(false)), ("null", Value::Null)];
        let found = words.into_iter().find(|(word, _)| self.text[self.at..].starts_with(word));
        let hint = "a value is a number, a string in double quotes, true, false, a list or an object; JSON has no NaN";
        let (word, value) = found.ok_or_else(|| self.fault("a value is wanted here", hint))?;
        self.at += word.len();
        Ok(value)
    }

    fn object(&mut self) -> Read<Value> {
        let (mut entries, mut names) = (Vec::new(), BTreeSet::new());
        while self.more(entries.is_empty(), b'}')? {
            let at = self.at;
            if self.peek() != Some(b'"') {
                return Err(self
                    .fault("a key is wanted here", "keys stand in double quotes; no comma after the last"));
            }
            let name = self.string()?;
            if !names.insert(name.clone()) {
                self.at = at;
                return Err(self.fault("this key stands twice", "a key may stand once in an object"));
            }
            self.blanks();
            if !self.take(b':') {
                return Err(self.fault("a colon is wanted here", "write \"key\": value"));
            }
            self.blanks();
            entries.push((Key { name, at }, self.value()?));
        }
        Ok(Value::Table(Table(entries)))
    }

    fn list(&mut self) -> Read<Value> {
        let mut items = Vec::new();
        while self.more(items.is_empty(), b']')? {
            items.push(self.value()?);
        }
        Ok(Value::List(items))
    }

    /// Steps to the next item, over the comma before it; false at the end.
    fn more(&mut self, first: bool, end: u8) -> Read<bool> {
        self.blanks();
        if self.take(end) {
            return Ok(false);
        }
        if !first && !self.take(b',') {
            let what = format!("a comma or {} is wanted here", char::from(end));
            return Err(self.fault(&what, "commas part items; brackets and braces close"));
        }
        self.blanks();
        Ok(true)
    }

    fn digits(&mut self) -> Read<()> {
        let start = self.at;
        while matches!(self.peek(), Some(b'0'..=b'9')) {
            self.at += 1;
        }
        let hint = "a number has digits before and after its point, and in its exponent";
        if self.at > start { Ok(()) } else { Err(self.fault("a digit is wanted here", hint)) }
    }

    fn number(&mut self) -> Read<Value> {
        let start = self.at;
        self.take(b'-');
        if !self.take(b'0') {
            self.digits()?;
        }
        let whole = self.at;
        if self.take(b'.') {
            self.digits()?;
        }
        if self.take(b'e') || self.take(b'E') {
            let _ = self.take(b'+') || self.take(b'-');
            self.digits()?;
        }
        let written = &self.text[start..self.at];
        Ok(match self.at == whole {
            true => integer(written, 10),
            false => written.parse().map_or(Value::Null, Value::Float),
        })
    }

    fn string(&mut self) -> Read<String> {
        let mut text = String::new();
        self.at += 1;
        loop {
            match self.text[self.at..].chars().next() {
                Some('"') => break,
                Some('\\') => text.push(self.escape()?),
                Some(c) if c >= ' ' => {
                    text.push(c);
                    self.at += c.len_utf8();
                }
                _ => {
                    return Err(
                        self.fault("the string does not end", "close it with a double quote on its line")
                    );
                }
            }
        }
        self.at += 1;
        Ok(text)
    }

    fn escape(&mut self) -> Read<char> {
        let hint =
            "after a backslash: \" \\ / b f n r t, or u and four hexadecimal digits (two such for one sign)";
        let wrong = self.fault("this escape means nothing", hint);
        let sign = self.text.as_bytes().get(self.at + 1).copied().ok_or_else(|| wrong.clone())?;
        self.at += 2;
        Ok(match sign {
            b'"' | b'\\' | b'/' => char::from(sign),
            b'b' => '\u{8}',
            b'f' => '\u{c}',
            b'n' => '\n',
            b'r' => '\r',
            b't' => '\t',
            b'u' => self.unicode().ok_or(wrong)?,
            _ => return Err(wrong),
        })
    }

    /// The character of one `XXXX`, or of a pair `XXXX\uXXXX` of surrogates.
    fn unicode(&mut self) -> Option<char> {
        let first = self.hex()?;
        if !(0xd800..0xdc00).contains(&first) {
            return char::from_u32(first);
        }
        let second = (self.take(b'\\') && self.take(b'u')).then(|| self.hex()).flatten()?;
        let low = second.checked_sub(0xdc00).filter(|&low| low < 0x400)?;
        char::from_u32(0x10000 + ((first - 0xd800) << 10) + low)
    }

    fn hex(&mut self) -> Option<u32> {
        let digits =
            self.text.get(self.at..self.at + 4).filter(|d| d.bytes().all(|b| b.is_ascii_hexdigit()))?;
        self.at += 4;
        u32::from_str_radix(digits, 16).ok()
    }
}
