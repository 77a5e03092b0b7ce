//! Instructions on paper: what Chromium prints of the page, read back with pdftotext. Where one of them is missing the
//! test says "not run" and checks nothing.

use crate::browser::{Browser, unbase64};
use crate::drawn::LOOSE;
use crate::support::{ran, room};
use serde_json::json;
use std::process::Command;

#[test]
fn instructions_print_with_each_step_whole_on_one_sheet() {
    if Command::new("pdftotext").arg("-v").output().is_err() {
        println!("not run: no pdftotext on this machine");
        return;
    }
    let Some(mut browser) = Browser::with_webgl() else { return };
    let at = room("printed", "sheets");
    let path = |name: &str| at.join(name).display().to_string();
    // Twelve parts: eleven steps, on more than two sheets if six to a sheet are kept.
    let spec = LOOSE.replace("warps = 4", "warps = 6");
    std::fs::write(at.join("loose.toml"), spec).expect("a spec");
    let args = ["draw", &path("loose.toml"), "--what", "instructions", "--out", &path("build.html")];
    assert_eq!(ran(&args).status.code(), Some(0));
    browser.call("Page.navigate", json!({"url": format!("file://{}", path("build.html"))}));
    let ready = "new Promise((r) => document.readyState === 'complete' ? r(0) : addEventListener('load', () => r(0)))";
    browser.ask(ready);
    let steps = browser.ask("[...document.querySelectorAll('.steps figcaption')].map((c) => c.textContent)");
    let steps: Vec<String> = serde_json::from_value(steps).expect("captions");
    assert_eq!(steps.len(), 11);
    let printed = browser.call("Page.printToPDF", json!({"preferCSSPageSize": true}));
    std::fs::write(at.join("build.pdf"), unbase64(printed["data"].as_str().expect("a PDF"))).expect("a file");
    let read = Command::new("pdftotext").args([&path("build.pdf"), "-"]).output().expect("pdftotext").stdout;
    let text = sheets_of(&String::from_utf8_lossy(&read));
    let sheet_of = |step: &String| {
        let on: Vec<usize> = (0..text.len()).filter(|k| text[*k].contains(step.as_str())).collect();
        assert_eq!(on.len(), 1, "{step:?} stands whole on one sheet of {text:?}");
        on[0]
    };
    let sheets: Vec<usize> = steps.iter().map(sheet_of).collect();
    assert!(sheets.is_sorted(), "{sheets:?}");
    let most = (0..text.len()).map(|s| sheets.iter().filter(|k| **k == s).count()).max();
    assert!(most.is_some_and(|m| m <= 6), "six to a sheet at most: {sheets:?}");
    assert!(text.iter().all(|s| !s.is_empty()), "an empty sheet");
}

/// Sheets of a PDF's text, each with single blanks between its words.
fn sheets_of(text: &str) -> Vec<String> {
    let sheets = text.trim_end_matches('\u{c}').split('\u{c}');
    sheets.map(|s| s.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}
