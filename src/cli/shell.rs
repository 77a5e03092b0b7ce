//! Takes the command line's own description; gives completions for a shell, and the manual page.
//!
//! Not promised: completions of what files hold (part ids, say).

use super::args::Args as Program;
use super::told::{News, Told, Trouble};
use crate::report::content::Chapter;
use clap::CommandFactory;
use clap_complete::{Shell, generate};
use std::fmt::Write;

/// For `source <(weavelock completions bash)`, or a file in the shell's folder of completions.
pub fn completions(shell: Shell) -> Result<Told, Trouble> {
    let mut out = Vec::new();
    generate(shell, &mut Program::command(), "weavelock", &mut out);
    bare(out)
}

/// One page: the program, then each verb.
pub fn man() -> Result<Told, Trouble> {
    let mut program = Program::command();
    program.build();
    let mut out = Vec::new();
    let wrong = |e: std::io::Error| Trouble::Word(format!("error: the manual page: {e}"));
    clap_mangen::Man::new(program.clone()).render(&mut out).map_err(wrong)?;
    for verb in program.get_subcommands().filter(|v| v.get_name() != "help") {
        let mut head = String::new();
        let _ = writeln!(head, ".SH \"WEAVELOCK {}\"", verb.get_name().to_uppercase());
        out.extend(head.into_bytes());
        let page = clap_mangen::Man::new(verb.clone());
        page.render_synopsis_section(&mut out).map_err(wrong)?;
        page.render_description_section(&mut out).map_err(wrong)?;
        page.render_options_section(&mut out).map_err(wrong)?;
    }
    bare(out)
}

/// A file to keep: printed as it is, with or without --json.
fn bare(out: Vec<u8>) -> Result<Told, Trouble> {
    let text = String::from_utf8(out).map_err(|e| Trouble::Word(format!("error: {e}")))?;
    let json = serde_json::json!({ "text": text });
    Ok(Told { bare: Some(text), ..Told::new(News::Good, &json, "", "", Chapter::default()) })
}
