//! Takes the bytes of a puzzle file, gzip or plain; gives its text.
//!
//! Promised: no more than [`MOST_BYTES`] are ever unpacked. Not promised: that the text is XML.

use crate::fault::{Fault, Faults};
use flate2::read::MultiGzDecoder;
use std::io::Read;
use std::path::Path;

/// No file is unpacked beyond this many bytes (64 MiB): ten thousand stated solutions of twenty pieces take half of it.
pub const MOST_BYTES: u64 = 64 << 20;

/// The two bytes that begin a gzip file (RFC 1952).
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// The text of a puzzle file; `file` names it in faults.
pub fn text(bytes: Vec<u8>, file: &Path) -> Result<String, Faults> {
    let fault = |what: String, hint: &str| {
        let file = file.display().to_string();
        Faults::from(Fault { file, place: None, key: String::new(), what, hint: hint.into() })
    };
    let bytes = if bytes.starts_with(&GZIP) { unpacked(&bytes) } else { Ok(bytes) };
    let bytes = bytes.map_err(|what| fault(what, "save the puzzle again; the file may be cut off"))?;
    if bytes.len() as u64 > MOST_BYTES {
        let what = format!("it unpacks to more than {MOST_BYTES} bytes ({} MiB)", MOST_BYTES >> 20);
        return Err(fault(what, "remove solutions that you do not ask about"));
    }
    String::from_utf8(bytes)
        .map_err(|_| fault("this is not UTF-8 text".into(), "a puzzle file is XML, gzip or plain"))
}

fn unpacked(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let mut out = Vec::new();
    let read = MultiGzDecoder::new(bytes).take(MOST_BYTES + 1).read_to_end(&mut out);
    read.map(|_| out).map_err(|e| format!("this is no whole gzip file: {e}"))
}
