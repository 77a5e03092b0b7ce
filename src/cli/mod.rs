//! Takes typed arguments; runs a verb; prints its answer on stdout, remarks on stderr; gives the exit code.
//!
//! Not promised: any finding of its own. No panic reaches a user: what slips through is reported as a fault of ours.

pub mod args;
pub mod atlas;
mod blocking;
mod check;
mod draw;
mod exported;
pub mod flex;
mod hands;
mod interlock;
mod load;
mod make;
mod mold_map;
mod molded;
pub mod new;
mod package;
mod paged;
mod pictured;
mod planned;
mod play;
mod puzzle;
mod questions;
mod release;
mod repeated;
pub mod repeats;
mod run;
mod schema;
mod shell;
mod told;
mod words;

use args::{Args, Common, Verb};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use told::{News, Told, Trouble};

/// Runs the program.
pub fn main(args: Args) -> ExitCode {
    if let Some(n) = args.common.threads {
        // Fails only when a pool exists already, which nothing before this made.
        let _ = rayon::ThreadPoolBuilder::new().num_threads(usize::from(n)).build_global();
    }
    std::panic::set_hook(Box::new(|_| {}));
    match guarded(|| dispatch(&args)).and_then(|told| print(&told, &args.common)) {
        Ok(News::Good) => ExitCode::SUCCESS,
        Ok(News::Other) => ExitCode::from(1),
        Err(trouble) => {
            let _ = writeln!(std::io::stderr(), "{trouble}");
            ExitCode::from(2)
        }
    }
}

fn dispatch(args: &Args) -> Result<Told, Trouble> {
    let puzzle = &args.common.puzzle;
    match &args.verb {
        None => run::example(&args.common),
        Some(Verb::Run { file, out }) => run::file(file, out, &args.common),
        Some(Verb::Check { file, fix, refine }) => {
            check::check(&load::spec(file, puzzle)?.joined()?, fix.as_deref(), *refine)
        }
        Some(Verb::Plan { file, of, clearance }) => {
            questions::plan(&load::spec(file, puzzle)?.joined()?, of, clearance.unwrap_or(0.0))
        }
        Some(Verb::Play(asked)) => play::play(asked, puzzle),
        Some(Verb::Release(asked)) => release::release(asked, puzzle),
        Some(Verb::Blocking(asked)) => blocking::blocking(&load::spec(&asked.file, puzzle)?.joined()?, asked),
        Some(Verb::Flex(asked)) => flex::flex(asked, puzzle),
        Some(Verb::Repeats(asked)) => repeats::repeats(asked),
        Some(Verb::Chirality { subject, export }) => hands::chirality(subject, export.as_deref(), puzzle),
        Some(Verb::Weave { subject, svg, wif }) => questions::weave(subject, svg.as_deref(), wif.as_deref()),
        Some(Verb::Fab(asked)) => {
            package::fab(&load::spec(&asked.file, puzzle)?.joined()?, asked, &args.common)
        }
        Some(Verb::Processes { name }) => package::processes(name.as_deref()),
        Some(Verb::Export(asked)) => exported::export(&load::spec(&asked.file, puzzle)?.joined()?, asked),
        Some(Verb::Draw(asked)) => draw::draw(&load::spec(&asked.file, puzzle)?.joined()?, asked),
        Some(Verb::Verify { answer }) => questions::verify(answer),
        Some(Verb::Atlas(asked)) => atlas::atlas(asked, &args.common),
        Some(Verb::Report { file, out, mold }) => run::report(file, out, mold.as_deref(), &args.common),
        Some(Verb::New(asked)) => new::new(asked),
        Some(Verb::Completions { shell }) => shell::completions(*shell),
        Some(Verb::Man) => shell::man(),
        Some(Verb::Schema) => schema::schema(),
    }
}

/// Remarks that a terminal shows; a hundred parts may each have one.
const MOST_REMARKS: usize = 6;

/// The answer on stdout, remarks on stderr. A reader who closes the pipe early has what he wanted.
fn print(told: &Told, common: &Common) -> Result<News, Trouble> {
    if !common.quiet {
        for remark in told.remarks.iter().take(MOST_REMARKS) {
            let _ = writeln!(std::io::stderr(), "note: {remark}");
        }
        if told.remarks.len() > MOST_REMARKS {
            let _ = writeln!(
                std::io::stderr(),
                "note: and {} more (--json has all)",
                told.remarks.len() - MOST_REMARKS
            );
        }
    }
    let text = if common.json { format!("{}\n", told.json) } else { told.text() };
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => Err(Trouble::Word(format!("stdout: {e}"))),
        _ => Ok(told.news),
    }
}

/// What the program prints with `--json`, for callers that are no terminal.
pub struct Answered {
    /// The exit code: 0 good news for the verb, 1 answered otherwise.
    pub code: u8,
    pub json: String,
    pub remarks: Vec<String>,
}

/// The answer to these words (without the program's name). Bad input, or a fault of ours: what is wrong, in words.
pub fn answered(words: &[String]) -> Result<Answered, String> {
    let all =
        std::iter::once("weavelock").chain(words.iter().map(String::as_str)).chain(["--json", "--quiet"]);
    let args = <Args as clap::Parser>::try_parse_from(all).map_err(|e| e.render().to_string())?;
    let told = guarded(|| dispatch(&args)).map_err(|trouble| trouble.to_string())?;
    let code = match told.news {
        News::Good => 0,
        News::Other => 1,
    };
    Ok(Answered { code, json: told.json, remarks: told.remarks })
}

/// The assembly of a spec or puzzle file, with its contacts.
pub fn joined(file: &std::path::Path) -> Result<crate::contact::Joined, String> {
    let placed = guarded(|| Ok(load::spec(file, &args::PuzzleArgs::default())?.joined()?));
    placed.map(|p| p.joined).map_err(|trouble| trouble.to_string())
}

/// What slips through as a panic is a fault of ours, told as such.
fn guarded<T>(call: impl FnOnce() -> Result<T, Trouble>) -> Result<T, Trouble> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| Err(Trouble::ours(panic.as_ref())))
}
