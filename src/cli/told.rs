//! Takes an answer; holds it in the two forms that the program prints, with its news and remarks.
//!
//! Not promised: that words and JSON say the same; the verbs make both from one answer.

use crate::fault::{Fault, Faults};
use crate::report::content::{Answer, Chapter};
use crate::report::file::WriteError;
use crate::report::text::{self, Columns, Ink, Summary};
use serde::Serialize;
use std::any::Any;
use std::fmt;

/// Whether the answer is good news for its verb.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum News {
    Good,
    Other,
}

impl News {
    pub fn of(good: bool) -> News {
        if good { News::Good } else { News::Other }
    }
}

/// An answer, ready to print.
pub struct Told {
    pub news: News,
    pub json: String,
    pub title: String,
    pub lead: String,
    pub chapters: Vec<(String, Answer<Chapter>)>,
    pub closing: Vec<String>,
    pub remarks: Vec<String>,
    /// Printed instead of all that, where the answer is a file to keep.
    pub bare: Option<String>,
}

impl Told {
    pub fn new(news: News, answer: &impl Serialize, title: &str, heading: &str, chapter: Chapter) -> Told {
        Told {
            news,
            json: serde_json::to_string(answer).unwrap_or_default(),
            title: title.into(),
            lead: String::new(),
            chapters: vec![(heading.into(), Answer::Given(chapter))],
            closing: Vec::new(),
            remarks: Vec::new(),
            bare: None,
        }
    }

    pub fn text(&self) -> String {
        if let Some(text) = &self.bare {
            return text.clone();
        }
        let summary = Summary {
            title: self.title.clone(),
            lead: self.lead.clone(),
            chapters: self.chapters.clone(),
            closing: self.closing.clone(),
        };
        text::write(&summary, Ink::for_stdout(), Columns::default())
    }
}

/// Why there is no answer: exit code 2.
#[derive(Debug)]
pub enum Trouble {
    Faults(Faults),
    Word(String),
    /// The user ended it before there was anything to tell.
    Stopped(String),
}

impl Trouble {
    /// A panic that was caught.
    pub fn ours(panic: &(dyn Any + Send)) -> Trouble {
        let what = panic.downcast_ref::<&str>().map(|s| (*s).to_string());
        let what = what.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
        Trouble::Word(format!(
            "error: a fault of weavelock's, not of your file: {what}\n  hint: please report it with the file and the command"
        ))
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Trouble::Faults(faults) => write!(f, "error: {faults}"),
            Trouble::Word(word) => write!(f, "{word}"),
            Trouble::Stopped(when) => write!(f, "stopped by the user {when}; there is no answer"),
        }
    }
}

impl From<Faults> for Trouble {
    fn from(faults: Faults) -> Trouble {
        Trouble::Faults(faults)
    }
}

impl From<Fault> for Trouble {
    fn from(fault: Fault) -> Trouble {
        Trouble::Faults(fault.into())
    }
}

impl From<WriteError> for Trouble {
    fn from(e: WriteError) -> Trouble {
        use std::io::ErrorKind;
        let hint = match e.source.kind() {
            ErrorKind::NotFound => "make the folder first, or name another",
            ErrorKind::IsADirectory => "name a file in it",
            _ => "choose a folder that you may write to, with room for the files; nothing was left behind",
        };
        Trouble::Word(format!("error: {e}\n  hint: {hint}"))
    }
}
