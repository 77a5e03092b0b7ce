//! Takes the path of a small text file; gives its bytes and its text, or why it cannot be read.
//!
//! Promised: no more than [`MAX_BYTES`] are ever held, and a pipe or a device is never waited for. Not promised: that
//! the text means anything.

use crate::fault::{Fault, Faults, Place};
use std::fs::{File, Metadata};
use std::io::Read;
use std::path::Path;

/// Largest spec, draft or WIF, in bytes (4 MiB): 512 x 512 crossings drawn in a file take a sixteenth of it.
pub const MAX_BYTES: u64 = 4 << 20;

/// Largest puzzle file, packed or not, in bytes (64 MiB): as many as one may unpack to.
pub const MAX_PUZZLE_BYTES: u64 = 64 << 20;

/// Largest answer that is read back, in bytes (1 GiB): a lock of a million contact forces takes a quarter of it.
pub const MAX_ANSWER_BYTES: u64 = 1 << 30;

/// The bytes of the file, which must be a regular file, not empty, of at most [`MAX_BYTES`].
pub fn bytes(path: &Path) -> Result<Vec<u8>, Faults> {
    up_to(path, MAX_BYTES)
}

/// The bytes of a puzzle's file, of at most [`MAX_PUZZLE_BYTES`].
pub fn packed_bytes(path: &Path) -> Result<Vec<u8>, Faults> {
    up_to(path, MAX_PUZZLE_BYTES)
}

/// The bytes of an answer's file, of at most [`MAX_ANSWER_BYTES`].
pub fn answer_bytes(path: &Path) -> Result<Vec<u8>, Faults> {
    up_to(path, MAX_ANSWER_BYTES)
}

fn up_to(path: &Path, most: u64) -> Result<Vec<u8>, Faults> {
    let fault = |(what, hint): (String, &str)| Faults::from(about(path, None, what, hint));
    let meta = std::fs::metadata(path).map_err(|e| fault(unreadable(&e)))?;
    refused(&meta, most).map_or(Ok(()), |why| Err(fault(why)))?;
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(|e| fault(unreadable(&e)))?;
    file.take(most + 1).read_to_end(&mut bytes).map_err(|e| fault(unreadable(&e)))?;
    match bytes.len() as u64 {
        0 => Err(fault(("the file is empty".into(), "nothing was asked; see the example in the README"))),
        size if size > most => Err(fault(too_large(size, most))),
        _ => Ok(bytes),
    }
}

/// The bytes as UTF-8 text, without a byte order mark.
pub fn text(bytes: Vec<u8>, path: &Path) -> Result<String, Faults> {
    refuse_binary(&bytes, path)?;
    let text = String::from_utf8(bytes).map_err(|e| {
        let good = String::from_utf8_lossy(&e.as_bytes()[..e.utf8_error().valid_up_to()]).into_owned();
        let hint = "save the file as UTF-8";
        Faults::from(about(path, Some(Place::of(&good, good.len())), "this is not UTF-8 text".into(), hint))
    })?;
    Ok(without_mark(text))
}

/// The bytes as text as older programs write it: UTF-8, or else ISO 8859-1, in which every byte is a character.
pub fn legacy_text(bytes: Vec<u8>, path: &Path) -> Result<String, Faults> {
    refuse_binary(&bytes, path)?;
    let text = String::from_utf8(bytes);
    Ok(without_mark(text.unwrap_or_else(|e| e.into_bytes().into_iter().map(char::from).collect())))
}

fn without_mark(text: String) -> String {
    text.strip_prefix('\u{feff}').map(str::to_string).unwrap_or(text)
}

fn refused(meta: &Metadata, most: u64) -> Option<(String, &'static str)> {
    if meta.is_dir() {
        return Some(("this is a directory, not a file".into(), "name the file inside it"));
    }
    if !meta.is_file() {
        let what = "this is a pipe or a device, not a file".into();
        return Some((what, "write it to a file first: places and relative paths need one"));
    }
    (meta.len() > most).then(|| too_large(meta.len(), most))
}

fn too_large(size: u64, most: u64) -> (String, &'static str) {
    let what = format!("the file has {size} bytes or more, the limit is {most} ({} MiB)", most >> 20);
    (what, "is this the right file? meshes are named in a spec, not passed instead of it")
}

fn unreadable(error: &std::io::Error) -> (String, &'static str) {
    use std::io::ErrorKind::{NotFound, PermissionDenied};
    match error.kind() {
        NotFound => ("there is no such file".into(), "check the name and the folder you are in"),
        PermissionDenied => ("the file may not be read".into(), "its permissions forbid it"),
        _ => (format!("the file cannot be read: {error}"), "the system gave this reason"),
    }
}

fn refuse_binary(bytes: &[u8], path: &Path) -> Result<(), Faults> {
    let wide = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
    let fault = |what: String, hint| Err(about(path, None, what, hint).into());
    match bytes.iter().position(|&b| b == 0) {
        _ if wide => fault("this is UTF-16 text".into(), "save the file as UTF-8"),
        Some(at) => fault(format!("this is a binary file (byte {at} is zero)"), "a text file is wanted here"),
        None => Ok(()),
    }
}

fn about(path: &Path, place: Option<Place>, what: String, hint: &str) -> Fault {
    Fault { file: path.display().to_string(), place, key: String::new(), what, hint: hint.into() }
}
