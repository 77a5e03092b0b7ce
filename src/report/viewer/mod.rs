//! Takes parts in place and the answers about them as JSON; gives a piece of a page that shows them in 3D.
//!
//! Promised: the script is this program's own and always the same (the page names its hash, and nothing else may run);
//! every string of the caller travels as data. Not promised: that a browser has WebGL 2; where it has none the still
//! picture stays.

mod colours;
pub mod exhibit;
pub mod facets;
mod pack;
mod signs;

pub use colours::{Rgb, Scheme};
pub use exhibit::{Answers, Exhibit, of_assembly, of_mold};

use hmac_sha256::Hash;
use serde::Serialize;

/// The viewer's script, in the order in which its pieces need one another.
pub const SCRIPT: &str = concat!(
    "\"use strict\";\n(() => {\n",
    include_str!("maths.js"),
    include_str!("model.js"),
    include_str!("stage.js"),
    include_str!("show.js"),
    include_str!("controls.js"),
    include_str!("start.js"),
    "})();\n"
);

pub const STYLE: &str = include_str!("viewer.css");

/// What the script reads.
#[derive(Serialize)]
struct Payload<'a> {
    exhibits: &'a [Exhibit],
}

/// JSON that is safe inside a script element: no `<` in it can end the element or start a comment.
pub fn payload(exhibits: &[Exhibit]) -> String {
    let json = serde_json::to_string(&Payload { exhibits }).unwrap_or_default();
    json.replace('<', "\\u003c").replace('\u{2028}', "\\u2028").replace('\u{2029}', "\\u2029")
}

/// The script's hash as a page's content security policy names it (CSP level 3, hash source).
pub fn script_hash() -> String {
    format!("sha256-{}", base64(&Hash::hash(SCRIPT.as_bytes())))
}

/// RFC 4648, with padding.
pub fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let word = (0..3).fold(0u32, |w, k| w << 8 | u32::from(group.get(k).copied().unwrap_or(0)));
        for k in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * k) & 63) as usize];
            text.push(if k <= group.len() { char::from(letter) } else { '=' });
        }
    }
    text
}
