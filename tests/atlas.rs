//! Promises of the atlas: known rows, the same files with any threads, stops and shards, and what is refused.

use crate::support;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use weavelock::atlas::{self, Abc, Ask, Phases, Settings, Shard, Status, Which};
use weavelock::weave::{Draft, Hanging, Weave, hangs_together};

fn room(name: &str) -> PathBuf {
    support::room("atlas", name)
}

fn small() -> Ask {
    let settings = Settings { samples: 4, ..Settings::default() };
    Ask { most: 2, flex_up_to: 2, release_up_to: 0, settings, ..Ask::new(4) }
}

const FILES: [&str; 5] = ["atlas.jsonl", "atlas.csv", "atlas.json", "atlas.svg", "atlas.png"];

fn bytes(folder: &Path) -> Vec<Vec<u8>> {
    FILES.map(|name| fs::read(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))).to_vec()
}

fn write(ask: &Ask, shard: Option<Shard>, folder: &Path) -> atlas::Written {
    atlas::write(ask, shard, folder, |_| ()).unwrap_or_else(|f| panic!("{f}"))
}

fn program(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_weavelock"));
    command.args(args);
    command
}

#[test]
fn the_files_are_the_same_with_any_threads_and_after_a_stop() {
    let [one, many, torn] = ["one", "many", "torn"].map(room);
    for (folder, threads) in [(&one, 1), (&many, 3)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let written = pool.install(|| write(&small(), None, folder));
        assert_eq!((written.found, written.rows.len()), (0, atlas::weaves(4, Which::Representatives).len()));
    }
    assert_eq!(bytes(&one), bytes(&many));
    // Stopped at any byte: within the head, at its end, within a row, at the end of one, before the last line end.
    let whole = bytes(&one)[0].clone();
    let ends: Vec<usize> = (0..whole.len()).filter(|&k| whole[k] == b'\n').collect();
    for (cut, found) in [(10, 0), (ends[0] + 1, 0), (ends[1] + 30, 1), (ends[2] + 1, 2), (ends[3], 2), (0, 0)]
    {
        fs::write(torn.join("atlas.jsonl"), &whole[..cut]).expect("written");
        assert_eq!(write(&small(), None, &torn).found, found, "cut at {cut}");
        assert_eq!(bytes(&one), bytes(&torn), "cut at {cut}");
    }
    // Rows in another order, as threads leave them, are found too.
    let text = String::from_utf8(whole.clone()).expect("UTF-8");
    let mut lines: Vec<&str> = text.lines().collect();
    lines[1..].reverse();
    fs::write(torn.join("atlas.jsonl"), lines.join("\n") + "\n").expect("written");
    assert_eq!(write(&small(), None, &torn).found, lines.len() - 1);
    assert_eq!(bytes(&one), bytes(&torn));
}

#[test]
fn another_table_is_refused_and_left_alone() {
    let folder = room("other");
    write(&Ask { max_n: 2, ..small() }, None, &folder);
    let before = bytes(&folder);
    for other in [Ask { most: 3, ..small() }, Ask { phases: Phases::First, ..small() }] {
        assert!(atlas::write(&other, None, &folder, |_| ()).is_err());
        assert_eq!(before, bytes(&folder));
    }
    let twice = format!("{0}{1}{1}", head(&before[0]), row(&before[0]));
    fs::write(folder.join("atlas.jsonl"), &twice).expect("written");
    let told = atlas::write(&small(), None, &folder, |_| ()).expect_err("a row twice").to_string();
    assert!(told.contains("atlas.jsonl:3") && told.contains("[1,1,1] has a row already"), "{told}");
    // A larger table takes up a smaller one.
    fs::write(folder.join("atlas.jsonl"), &before[0]).expect("written");
    assert_eq!(write(&Ask { max_n: 3, ..small() }, None, &folder).found, 1);
}

fn head(file: &[u8]) -> String {
    format!("{}\n", String::from_utf8_lossy(file).lines().next().expect("a head"))
}

fn row(file: &[u8]) -> String {
    format!("{}\n", String::from_utf8_lossy(file).lines().nth(1).expect("a row"))
}

#[test]
fn shards_join_to_the_bytes_of_one_run() {
    let [whole, parts, joined] = ["whole", "parts", "joined"].map(room);
    write(&small(), None, &whole);
    let shard = |i: u32| Shard::parse(&format!("{i}/3")).expect("a shard");
    let mut files = Vec::new();
    for i in [2, 1] {
        files.extend(write(&small(), Some(shard(i)), &parts).files);
    }
    // One is missing: its rows and its name are told, and nothing is written.
    let told = atlas::merge(&files, &joined).expect_err("a shard is missing").to_string();
    assert!(told.contains("--shard 3/3") && told.contains("are in no file"), "{told}");
    assert_eq!(fs::read_dir(&joined).expect("a folder").count(), 0);
    files.extend(write(&small(), Some(shard(3)), &parts).files);
    atlas::merge(&files, &joined).unwrap_or_else(|f| panic!("{f}"));
    assert_eq!(bytes(&whole), bytes(&joined));
    // A folder stands for its files, and a file given twice does no harm.
    atlas::merge(&[parts.clone(), files[0].clone()], &joined).unwrap_or_else(|f| panic!("{f}"));
    assert_eq!(bytes(&whole), bytes(&joined));
    // A row that differs in two files is told with both.
    let text = fs::read_to_string(&files[0]).expect("a shard");
    let other = parts.join("atlas.changed.jsonl");
    fs::write(&other, text.replacen("\"minimal_repeat\":2", "\"minimal_repeat\":1", 1)).expect("written");
    let told = atlas::merge(std::slice::from_ref(&parts), &joined).expect_err("rows differ").to_string();
    assert!(told.contains("differs from that of") && told.contains("atlas.changed.jsonl"), "{told}");
    fs::write(&other, text.replacen("\"most\":2", "\"most\":3", 1)).expect("written");
    let told = atlas::merge(&[parts], &joined).expect_err("tables differ").to_string();
    assert!(told.contains("is another table than"), "{told}");
    assert_eq!(bytes(&whole), bytes(&joined));
}

#[test]
fn shards_share_the_work_evenly_and_fully() {
    let all = atlas::weaves(16, Which::Representatives);
    for count in [1, 2, 7, 16] {
        let shards: Vec<Vec<Abc>> =
            (1..=count).map(|i| Shard::parse(&format!("{i}/{count}")).expect("a shard").of(&all)).collect();
        let mut together: Vec<Abc> = shards.concat();
        together.sort_by_key(|abc| abc.rank());
        assert_eq!(together, all);
        let work = |s: &Vec<Abc>| s.iter().map(|&abc| atlas::cost(abc)).sum::<u64>();
        let (least, most) = (shards.iter().map(work).min(), shards.iter().map(work).max());
        let dearest = all.iter().map(|&abc| atlas::cost(abc)).max();
        assert!(most.zip(least).map(|(m, l)| m - l) <= dearest, "{count} shards: {least:?} to {most:?}");
    }
    for wrong in ["0/2", "3/2", "1", "a/b", "1/0", "-1/2", ""] {
        assert!(Shard::parse(wrong).is_err(), "{wrong}");
    }
}

/// The draft after an isometry that keeps the grid: exchange, turn axes round, turn over.
fn image(draft: &Draft, n: i32, exchange: bool, against: [bool; 2], over: bool) -> BTreeSet<Vec<bool>> {
    let at = |x: i32, y: i32| {
        let (x, y) = (if against[0] { -x } else { x }, if against[1] { -y } else { y });
        let (x, y) = if exchange { (y, x) } else { (x, y) };
        draft.weft_over(y, x) ^ exchange ^ over
    };
    let shifted = |dx: i32, dy: i32| (0..n * n).map(|k| at(k % n + dx, k / n + dy)).collect();
    (0..n).flat_map(|dx| (0..n).map(move |dy| (dx, dy))).map(|(dx, dy)| shifted(dx, dy)).collect()
}

/// Every way in which one draft is another, tried on all crossings; the rule in `weaves` is algebra.
#[test]
fn equivalents_are_those_that_trying_all_isometries_finds() {
    for n in 2..=7_u32 {
        let every = |a: u32, c: i32| Abc(a, n - a, c);
        let all: Vec<Abc> = (1..n).flat_map(|a| (0..n as i32).map(move |c| every(a, c))).collect();
        let holds: Vec<&Abc> = all.iter().filter(|abc| together(abc)).collect();
        let drafts: Vec<Vec<bool>> = holds.iter().map(|abc| flat(&draft(abc), n as i32)).collect();
        for abc in &holds {
            let mut found: BTreeSet<(Abc, bool)> = BTreeSet::new();
            for bits in 0..16_u32 {
                let is = |k: u32| bits >> k & 1 == 1;
                let images = image(&draft(abc), n as i32, is(0), [is(1), is(2)], is(3));
                let improper = bits.count_ones() % 2 == 1;
                found.extend(
                    holds.iter().zip(&drafts).filter(|d| images.contains(d.1)).map(|d| (**d.0, improper)),
                );
            }
            let told: BTreeSet<Abc> = atlas::equivalents(**abc).iter().map(|e| e.abc).collect();
            let names: BTreeSet<Abc> = found.iter().map(|f| f.0).filter(|other| *other != **abc).collect();
            assert_eq!(told, names, "{abc}");
            for e in atlas::equivalents(**abc) {
                let by = [false, true].map(|m| found.contains(&(e.abc, m)));
                let words = match by {
                    [true, true] => "both",
                    [true, false] => "motion",
                    _ => "mirror",
                };
                assert_eq!(e.by.word(), words, "{abc} to {}", e.abc);
            }
        }
    }
}

fn draft(abc: &Abc) -> Draft {
    Weave::abc(abc.0, abc.1, abc.2).expect("in bounds").draft
}

fn together(abc: &Abc) -> bool {
    hangs_together(&draft(abc)) == Hanging::Together
}

fn flat(draft: &Draft, n: i32) -> Vec<bool> {
    (0..n * n).map(|k| draft.weft_over(k / n, k % n)).collect()
}

#[test]
fn every_weave_that_hangs_together_is_in_the_table_or_named_in_it() {
    let rows = atlas::weaves(9, Which::Representatives);
    let mut named: Vec<Abc> = rows.clone();
    named.extend(rows.iter().flat_map(|abc| atlas::equivalents(*abc)).map(|e| e.abc));
    named.sort_by_key(|abc| abc.rank());
    let every = atlas::weaves(9, Which::Every);
    assert_eq!(named, every, "none missing, none twice");
    let by_hand =
        (2..=9_u32).flat_map(|n| (1..n).flat_map(move |a| (0..n as i32).map(move |c| Abc(a, n - a, c))));
    assert_eq!(every.len(), by_hand.filter(together).count());
}

#[test]
fn rows_hold_the_known_answers() {
    let of = |a, b, c| {
        let ask = Ask { flex_up_to: 2, release_up_to: 0, ..Ask::new(8) };
        atlas::row(Abc(a, b, c), &ask).unwrap_or_else(|f| panic!("{f}"))
    };
    let plain = of(1, 1, 1);
    assert_eq!((plain.minimal_repeat, plain.flexible.minimum), (Some(2), Some(1)));
    let twill = of(2, 2, 1);
    assert_eq!((twill.minimal_repeat, twill.flexible.status), (Some(2), Status::NotRun));
    assert_eq!(twill.by_phase[1].tried[0].rigid, "free");
    assert_eq!(twill.by_phase[1].tried[0].translation, "locked");
    assert_eq!(twill.release_clearance.status, Status::NotRun);
}

/// What `release` says of the same swatch; a plan at one clearance is one at every larger.
#[test]
#[ignore = "a quarter of a minute: a dozen plans"]
fn release_clearance_is_bracketed_where_it_was_asked_for() {
    let ask = Ask { flex_up_to: 0, release_up_to: 2, phases: Phases::First, ..Ask::new(3) };
    let of = |a, b, c| atlas::row(Abc(a, b, c), &ask).unwrap_or_else(|f| panic!("{f}")).release_clearance;
    let (plain, twill) = (of(1, 1, 1), of(2, 1, 1));
    let (Some(low), Some(high)) = (plain.low, plain.high) else { panic!("no bracket: {plain:?}") };
    assert_eq!((plain.status, twill.status), (Status::Found, Status::NotRun));
    assert!(0.0 < low && low < high && high <= low * weavelock::release::NARROW, "{low} to {high}");
}

const FLAGS: [&str; 12] = [
    "--max-n",
    "4",
    "--most",
    "2",
    "--samples",
    "4",
    "--flex-up-to",
    "2",
    "--release-up-to",
    "0",
    "--phases",
    "first",
];

/// Killed without a warning at many moments, the table goes on where it stood.
#[cfg(unix)]
#[test]
fn a_killed_run_is_taken_up() {
    let [whole, killed] = ["uninterrupted", "killed"].map(room);
    let args = |folder: &Path| {
        let mut args = vec!["atlas".to_string()];
        args.extend(FLAGS.map(String::from));
        args.extend(["--out".into(), folder.display().to_string(), "--quiet".into()]);
        args
    };
    let run = |folder: &Path| {
        let mut command = program(&[]);
        command.args(args(folder)).stdout(Stdio::null());
        command
    };
    assert!(run(&whole).status().expect("starts").success());
    let mut kills = 0;
    for pause in (0..40).map(|k| 20 * k) {
        let mut child = run(&killed).spawn().expect("starts");
        std::thread::sleep(std::time::Duration::from_millis(pause));
        let ended = child.try_wait().expect("a state").is_some();
        child.kill().expect("killed");
        child.wait().expect("waited for");
        kills += usize::from(!ended);
        if ended {
            break;
        }
    }
    assert!(run(&killed).status().expect("starts").success());
    assert!(kills > 0, "no run was killed");
    assert_eq!(bytes(&whole), bytes(&killed));
    let left: BTreeSet<_> =
        fs::read_dir(&killed).expect("a folder").map(|e| e.expect("an entry").file_name()).collect();
    let known = |name: &std::ffi::OsString| {
        FILES.iter().any(|f| name == f) || name.to_string_lossy().ends_with(".part")
    };
    assert!(left.iter().all(known), "{left:?}");
}

#[test]
fn progress_is_told_in_lines_where_nobody_looks() {
    let folder = room("progress").display().to_string();
    let run = |quiet: bool| {
        let mut args = vec!["atlas", "--out", &folder];
        args.extend(FLAGS);
        args.extend(quiet.then_some("--quiet"));
        program(&args).output().expect("starts")
    };
    let out = run(false);
    let told = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.success() && told.contains("5 of 5 weaves") && told.contains("left"), "{told}");
    assert!(!told.contains(['\r', '\u{1b}']), "{told}");
    let out = run(true);
    assert!(out.status.success() && out.stderr.is_empty(), "{}", String::from_utf8_lossy(&out.stderr));
    assert!(String::from_utf8_lossy(&out.stdout).contains("5 of them found there from before"));
}

#[test]
fn two_runs_in_one_folder_are_refused() {
    let folder = room("locked");
    let path = folder.join("atlas.jsonl");
    let file = fs::File::create(&path).expect("a file");
    if file.try_lock().is_err() {
        println!("not run: this system has no file locks");
        return;
    }
    let told = atlas::write(&small(), None, &folder, |_| ()).expect_err("locked").to_string();
    assert!(told.contains("another run is writing"), "{told}");
}

/// The body of the example for Slurm, every task of its array in turn, and the join.
#[cfg(unix)]
#[test]
fn the_slurm_example_gives_the_bytes_of_one_run() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cluster/atlas.sbatch");
    let [whole, out] = ["slurm-whole", "slurm"].map(room);
    let bin = env!("CARGO_BIN_EXE_weavelock");
    let flags = FLAGS.join(" ");
    for task in 1..=3 {
        let mut command = Command::new("bash");
        command.arg(&script).current_dir(&out);
        command.env("WEAVELOCK", bin).env("ATLAS_FLAGS", &flags).env("ATLAS_OUT", "shards");
        command.env("SLURM_ARRAY_TASK_ID", task.to_string()).env("SLURM_ARRAY_TASK_COUNT", "3");
        command.env("SLURM_CPUS_PER_TASK", "2");
        let done = command.output().expect("bash starts");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    }
    let merged = program(&["atlas", "--merge", "shards", "--out", "atlas"]).current_dir(&out).output();
    let merged = merged.expect("starts");
    assert!(merged.status.success(), "{}", String::from_utf8_lossy(&merged.stderr));
    let mut args = vec!["atlas", "--out"];
    let folder = whole.display().to_string();
    args.push(&folder);
    args.extend(FLAGS);
    assert!(program(&args).output().expect("starts").status.success());
    assert_eq!(bytes(&whole), bytes(&out.join("atlas")));
}

/// The example for Snakemake, where it is installed.
#[cfg(unix)]
#[test]
#[ignore = "starts Snakemake, where installed"]
fn the_snakemake_example_gives_the_bytes_of_one_run() {
    if Command::new("snakemake").arg("--version").output().is_err() {
        println!("not run: snakemake is not installed");
        return;
    }
    let [whole, out] = ["snake-whole", "snake"].map(room);
    let rules = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cluster/Snakefile");
    let config = |key: &str, value: &str| format!("{key}={value}");
    let done = Command::new("snakemake")
        .current_dir(&out)
        .args(["--cores", "2", "--snakefile"])
        .arg(&rules)
        .arg("--config")
        .args([config("weavelock", env!("CARGO_BIN_EXE_weavelock")), config("shards", "3")])
        .arg(format!("flags={}", FLAGS.join(" ")))
        .output()
        .expect("starts");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let folder = whole.display().to_string();
    let mut args = vec!["atlas", "--out", &folder];
    args.extend(FLAGS);
    assert!(program(&args).output().expect("starts").status.success());
    assert_eq!(bytes(&whole), bytes(&out.join("atlas")));
}

#[test]
fn flags_that_make_no_sense_are_told() {
    let folder = room("flags");
    let at = folder.join("none").display().to_string();
    let cases: [&[&str]; 7] = [
        &["atlas", "--max-n", "1"],
        &["atlas", "--shard", "3/2"],
        &["atlas", "--merge"],
        &["atlas", "--merge", "nothing-here"],
        &["atlas", "--merge", "x", "--shard", "1/2"],
        &["atlas", "--rise", "2", "--lift", "-1"],
        &["atlas", "--samples", "1"],
    ];
    for args in cases {
        let out = program(args).args(["--out", &at]).current_dir(&folder).output().expect("starts");
        let told = String::from_utf8_lossy(&out.stderr).into_owned();
        assert_eq!(out.status.code(), Some(2), "{args:?}: {told}");
        assert!(
            !told.is_empty() && !told.contains("panicked") && !Path::new(&at).exists(),
            "{args:?}: {told}"
        );
    }
}
