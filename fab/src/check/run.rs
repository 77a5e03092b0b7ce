//! Takes a program and its arguments; gives what it said, within a time limit.

use super::Outcome;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// A part takes OpenSCAD well under a minute; what needs ten is stuck, and an unfinished check is one that was not run.
const LIMIT: Duration = Duration::from_secs(600);

/// How often a running program is looked at: short beside any run, long beside the look itself.
const LOOK: Duration = Duration::from_millis(10);

/// What a program that ended by itself left behind.
#[derive(Clone, Debug)]
pub struct Ran {
    /// `None` where a signal ended it.
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Ran {
    pub fn all(&self) -> String {
        format!("{}\n{}", self.stdout, self.stderr)
    }
}

/// Runs a program to its end; `NotRun` where it is absent, can not start, or takes too long.
pub fn run(program: &str, arguments: &[String]) -> Result<Ran, Outcome> {
    let mut command = Command::new(program);
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => Outcome::NotRun(format!("{program} is not installed")),
        _ => Outcome::NotRun(format!("{program} can not be started: {e}")),
    })?;
    let (stdout, stderr) = (drain(child.stdout.take()), drain(child.stderr.take()));
    let code = wait(&mut child, program)?;
    let text = |t: JoinHandle<String>| t.join().unwrap_or_default();
    Ok(Ran { code, stdout: text(stdout), stderr: text(stderr) })
}

fn wait(child: &mut Child, program: &str) -> Result<Option<i32>, Outcome> {
    let start = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Ok(status.code()),
            Ok(None) if start.elapsed() < LIMIT => std::thread::sleep(LOOK),
            other => {
                let _ = child.kill();
                let _ = child.wait();
                let why =
                    other.err().map_or(format!("took longer than {} s", LIMIT.as_secs()), |e| e.to_string());
                return Err(Outcome::NotRun(format!("{program}: {why}")));
            }
        }
    }
}

fn drain(pipe: Option<impl Read + Send + 'static>) -> JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // A pipe that breaks has said all that it will say.
        let _ = pipe.map(|mut p| p.read_to_end(&mut bytes));
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// The first line of what the program says of itself that holds a digit, else its name.
pub fn version(program: &str, argument: &str) -> String {
    let said = run(program, &[argument.to_string()]).map(|r| r.all()).unwrap_or_default();
    let line = said.lines().find(|l| !l.starts_with('[') && l.chars().any(|c| c.is_ascii_digit()));
    line.map_or(program.to_string(), |l| l.trim().trim_end_matches(',').to_string())
}
