//! Takes typed arguments; runs a verb; prints its answer on stdout, remarks on stderr; gives the exit code.
//!
//! Not promised: any finding of its own. No panic reaches a user: what slips through is reported as a fault of ours.

pub mod args;
pub mod atlas;
mod blocking;
mod check;
mod clearances;
mod draw;
mod exported;
mod filled;
pub mod flex;
mod hands;
mod interlock;
mod load;
mod make;
mod mistaken;
mod mold_map;
mod molded;
pub mod new;
mod package;
mod paged;
mod pictured;
mod planned;
mod play;
mod preferred;
mod puzzle;
mod questions;
mod release;
mod repeated;
pub mod repeats;
mod run;
mod schema;
mod shell;
mod told;
mod unmolded;
mod watch;
mod words;

use crate::watch::{All, Watch};
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
    match guarded(|| watched(&args)).and_then(|told| print(&told, &args.common)) {
        Ok(News::Good) => ExitCode::SUCCESS,
        Ok(News::Other) => ExitCode::from(1),
        Err(trouble) => {
            let _ = writeln!(std::io::stderr(), "{trouble}");
            ExitCode::from(if matches!(trouble, Trouble::Stopped(_)) { watch::INTERRUPTED } else { 2 })
        }
    }
}

/// The verb's answer; on a terminal its progress is shown, and Ctrl-C heard where that leaves an answer.
fn watched(args: &Args) -> Result<Told, Trouble> {
    let watch = Watch::default();
    if watch::can_stop(args.verb.as_ref()) {
        watch::hear(&watch, args.common.quiet);
    }
    let _line = watch::shown(&watch, &args.common);
    dispatch(args, &watch)
}

fn dispatch(args: &Args, watch: &Watch) -> Result<Told, Trouble> {
    let puzzle = &args.common.puzzle;
    let _stage = args.verb.as_ref().and_then(Verb::stage).map(|name| watch.stage(name, "", All::Open));
    match &args.verb {
        None => run::example(&args.common, watch),
        Some(Verb::Run { file, out }) => run::file(file, out, &args.common, watch),
        Some(Verb::Check { file, fix, refine }) => {
            check::check(&load::spec(file, puzzle, watch)?.joined()?, fix.as_deref(), *refine)
        }
        Some(Verb::Plan { file, of, clearance, wanted }) => {
            questions::plan(&load::spec(file, puzzle, watch)?.joined()?, of, clearance.unwrap_or(0.0), wanted)
        }
        Some(Verb::Play(asked)) => play::play(asked, puzzle, watch),
        Some(Verb::Release(asked)) => release::release(asked, puzzle, watch),
        Some(Verb::Blocking(asked)) => {
            blocking::blocking(&load::spec(&asked.file, puzzle, watch)?.joined()?, asked)
        }
        Some(Verb::Flex(asked)) => flex::flex(asked, puzzle, watch),
        Some(Verb::Repeats(asked)) => repeats::repeats(asked, watch),
        Some(Verb::Chirality { subject, export }) => {
            hands::chirality(subject, export.as_deref(), puzzle, watch)
        }
        Some(Verb::Weave { subject, svg, wif }) => questions::weave(subject, svg.as_deref(), wif.as_deref()),
        Some(Verb::Fab(asked)) => {
            package::fab(&load::spec(&asked.file, puzzle, watch)?.joined()?, asked, &args.common)
        }
        Some(Verb::Processes { name }) => package::processes(name.as_deref()),
        Some(Verb::Export(asked)) => {
            exported::export(&load::spec(&asked.file, puzzle, watch)?.joined()?, asked)
        }
        Some(Verb::Draw(asked)) => draw::draw(&load::spec(&asked.file, puzzle, watch)?.joined()?, asked),
        Some(Verb::Verify { answer }) => questions::verify(answer),
        Some(Verb::Atlas(asked)) => atlas::atlas(asked, &args.common),
        Some(Verb::Report { file, out, mold, process }) => {
            let mold = mold.as_deref().map(|part| run::MoldOf { part, process: process.as_deref() });
            run::report(file, out, mold, &args.common, watch)
        }
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
pub fn answered(words: &[String], watch: &Watch) -> Result<Answered, String> {
    let all =
        std::iter::once("weavelock").chain(words.iter().map(String::as_str)).chain(["--json", "--quiet"]);
    let args = <Args as clap::Parser>::try_parse_from(all).map_err(|e| e.render().to_string())?;
    let told = guarded(|| dispatch(&args, watch)).map_err(|trouble| trouble.to_string())?;
    let code = match told.news {
        News::Good => 0,
        News::Other => 1,
    };
    Ok(Answered { code, json: told.json, remarks: told.remarks })
}

/// The assembly of a spec or puzzle file, with its contacts.
pub fn joined(file: &std::path::Path, watch: &Watch) -> Result<crate::contact::Joined, String> {
    let placed = guarded(|| Ok(load::spec(file, &args::PuzzleArgs::default(), watch)?.joined()?));
    placed.map(|p| p.joined).map_err(|trouble| trouble.to_string())
}

/// What slips through as a panic is a fault of ours, told as such.
fn guarded<T>(call: impl FnOnce() -> Result<T, Trouble>) -> Result<T, Trouble> {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|panic| Err(Trouble::ours(panic.as_ref())))
}
