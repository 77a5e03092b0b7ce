//! Progress and Ctrl-C: a search that a user stops leaves a well-formed answer that says so, and a terminal sees how far
//! it is.

use crate::support::{joined, window, woven};
use glam::DVec3;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use weavelock::repeats::{AsMade, Search, repeats_watched};
use weavelock::sequence::wanted::{Ask, Table, Wish, prefer};
use weavelock::sequence::{Motions, Outcome, plan_by, plan_watched};
use weavelock::verify::plan::{Checked, check};
use weavelock::watch::Watch;

/// A closed case of 6 x 6 x 6 voxels with five loose ones in it: nothing comes apart, and there are hundreds of millions
/// of positions.
fn rattle(folder: &Path) -> PathBuf {
    const EDGE: i32 = 6;
    const LOOSE: [[i32; 3]; 5] = [[1, 1, 1], [3, 3, 3], [1, 3, 2], [3, 1, 4], [4, 4, 1]];
    let all = (0..EDGE.pow(3)).map(|k| [k % EDGE, k / EDGE % EDGE, k / (EDGE * EDGE)]);
    let wall = |v: &[i32; 3]| v.iter().any(|&x| x == 0 || x == EDGE - 1);
    let drawn = |full: &dyn Fn(&[i32; 3]) -> bool| -> String {
        let voxels = all.clone().map(|v| if full(&v) { '#' } else { '_' }).collect::<String>();
        format!("<voxel x=\"{EDGE}\" y=\"{EDGE}\" z=\"{EDGE}\" type=\"0\">{voxels}</voxel>")
    };
    let shapes = [
        drawn(&wall),
        "<voxel x=\"1\" y=\"1\" z=\"1\" type=\"0\">#</voxel>".into(),
        drawn(&|v| wall(v) || LOOSE.contains(v)),
    ];
    let text = format!(
        "<?xml version=\"1.0\"?>\n<puzzle version=\"2\"><gridType type=\"0\"/><colors/><shapes>{}</shapes><problems>\
         <problem><shapes><shape id=\"0\" count=\"1\"/><shape id=\"1\" count=\"{}\"/></shapes><result id=\"2\"/><bitmap/>\
         </problem></problems><comment/></puzzle>",
        shapes.concat(),
        LOOSE.len()
    );
    let path = folder.join("rattle.xmpuzzle");
    std::fs::write(&path, text).expect("a folder to write to");
    path
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("weavelock-stop-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn started(words: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weavelock"));
    command.args(words).args(["--threads", "1"]).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("the program runs")
}

/// Waits until the program catches SIGINT itself, by what the kernel says of it.
fn hears(child: &Child) -> bool {
    let caught = || {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
        let mask = status.lines().find_map(|l| l.strip_prefix("SigCgt:"))?;
        u64::from_str_radix(mask.trim(), 16).ok()
    };
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(20) {
        if caught().is_some_and(|mask| mask >> 1 & 1 == 1) {
            std::thread::sleep(Duration::from_millis(400));
            return true;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    false
}

fn not_run(child: &mut Child) {
    println!("not run: the kernel does not say who catches signals");
    let _ = child.kill();
    let _ = child.wait();
}

fn interrupt(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.is_ok_and(|s| s.success()), "a signal was sent");
}

/// The program's end after one Ctrl-C.
fn stopped(words: &[&str]) -> Option<Output> {
    let mut child = started(words);
    if !hears(&child) {
        not_run(&mut child);
        return None;
    }
    interrupt(&child);
    Some(child.wait_with_output().expect("an end"))
}

#[test]
fn a_plan_that_is_stopped_leaves_an_answer_that_says_so_and_verifies() {
    let folder = folder("plan");
    let file = rattle(&folder);
    let Some(out) = stopped(&["plan", &file.display().to_string(), "--json"]) else { return };
    assert_eq!(out.status.code(), Some(1), "{}", String::from_utf8_lossy(&out.stderr));
    let answer: Value = serde_json::from_slice(&out.stdout).expect("one whole JSON object");
    assert_eq!(answer["outcome"], "not-found");
    assert_eq!(answer["stopped"], true);
    assert_eq!(answer["kept"][0]["looked_at"], "stopped");
    let remarks = answer["remarks"].to_string();
    assert!(remarks.contains("stopped by the user after"), "{remarks}");
    assert!(String::from_utf8_lossy(&out.stderr).contains("Ctrl-C again ends it at once"));
    let kept = folder.join("plan.json");
    std::fs::write(&kept, &out.stdout).expect("written");
    let again = Command::new(env!("CARGO_BIN_EXE_weavelock")).arg("verify").arg(&kept).output();
    assert_eq!(again.expect("it runs").status.code(), Some(0), "a stopped plan claims nothing false");
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn a_second_interrupt_ends_it_at_once() {
    let words = ["repeats", "[9,4,5]", "--swatch", "6n"];
    let mut child = started(&words);
    if !hears(&child) {
        not_run(&mut child);
        return;
    }
    interrupt(&child);
    std::thread::sleep(Duration::from_millis(100));
    interrupt(&child);
    assert_eq!(child.wait().expect("an end").code(), Some(130));
}

#[test]
fn a_terminal_sees_how_far_a_plan_is() {
    let folder = folder("pty");
    let file = rattle(&folder);
    let line = format!(
        "timeout --foreground -s INT 4 '{}' plan '{}' --threads 1",
        env!("CARGO_BIN_EXE_weavelock"),
        file.display()
    );
    let ran = Command::new("script").args(["-qec", &line, "/dev/null"]).stdin(Stdio::null()).output();
    let Ok(out) = ran else {
        println!("not run: no `script` here that makes a terminal");
        return;
    };
    let text = String::from_utf8_lossy(&out.stdout);
    assert!(text.contains("moves along the axes, ") && text.contains(" positions; "), "{text}");
    assert!(text.contains("stopped by the user after"), "{text}");
    let _ = std::fs::remove_dir_all(folder);
}

#[test]
fn what_was_found_before_a_stop_is_kept_and_nothing_is_said_of_the_rest() {
    let made = joined(&window([2, 2, 1], 4, 4, 4));
    let (asm, patches) = (&made.assembly, &made.patches);
    let all: Vec<_> = asm.ids().collect();
    let whole = plan_by(asm, &all, patches, Motions::Straight, |_| None::<()>).expect("sane parts");
    let watched = plan_watched(asm, &all, patches, Motions::Straight, &Watch::default(), |_| None::<()>);
    assert_eq!(watched.as_ref(), Ok(&whole), "watching changes nothing");
    let watch = Watch::default();
    watch.stop();
    let plan = plan_watched(asm, &all, patches, Motions::Any, &watch, |_| Some(())).expect("sane parts");
    assert_eq!((plan.outcome, plan.stopped), (Outcome::NotFound, true));
    assert!(plan.steps.is_empty() && plan.stuck.iter().all(|s| s.lock.is_none()));
    assert_eq!(plan.stuck[0].parts.len(), all.len());
    // Stopped while a lock is looked for: what came off before that stays off.
    let watch = Watch::default();
    let stops = |_: &[_]| {
        watch.stop();
        None::<()>
    };
    let part = plan_watched(asm, &all, patches, Motions::Any, &watch, stops).expect("sane parts");
    assert_eq!((part.steps, part.stopped), (whole.steps, !whole.stuck.is_empty()));
}

#[test]
fn a_plan_stands_when_its_wishes_are_stopped() {
    let swatch = "[swatch]\nwefts = 2\nwarps = 2\ncut = \"tiles\"\nrepeat = 1\n";
    let made = joined(&woven([1, 1, 1], 4, swatch));
    let (asm, patches) = (&made.assembly, &made.patches);
    let all: Vec<_> = asm.ids().collect();
    let found = plan_by(asm, &all, patches, Motions::Straight, |_| None::<()>).expect("sane parts");
    let ask = Ask { up: DVec3::Z, table: Table::There, ranked: Wish::RANKED, flexible: Default::default() };
    let watch = Watch::default();
    let mut whole = found.clone();
    prefer(asm, patches, &mut whole, &ask, false, &watch);
    assert_eq!((whole.outcome, whole.stopped), (Outcome::Assembled, false));
    watch.stop();
    let mut cut = found.clone();
    let came = prefer(asm, patches, &mut cut, &ask, false, &watch);
    assert_eq!((cut.outcome, cut.stopped, came.judged.count(Wish::Air)), (Outcome::Assembled, true, None));
    assert!(matches!(check(asm, &cut), Checked::Valid { .. }), "whatever its order, it is a plan");
}

#[test]
fn repeats_that_are_stopped_tell_only_of_whole_rounds() {
    let weave = weavelock::weave::Weave::parse_abc("[2,2,1]").expect("a weave");
    let profile = weavelock::spec::ProfileSpec {
        shape: weavelock::spec::Shape::Rise(0.6),
        lift: 1.0,
        cover: 1.0,
        samples: 4,
        bounds: weavelock::spec::Bounds::Sandwich,
    };
    let search = Search { wefts: 4, warps: 4, phases: vec![0, 1], most: 3 };
    let watch = Watch::default();
    watch.stop();
    let found = repeats_watched(&weave, &profile, &search, AsMade::TOUCHING, &watch).expect("sane");
    assert!(found.least.is_none() && found.tried.is_empty());
}
