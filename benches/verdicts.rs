//! Times the rigid verdict of named assemblies, and writes their rows for another solver (`against_highs.py`).
//!
//! `cargo bench --bench verdicts -- FOLDER NAME...`; a name is `window-N`, `tiles-N` (doubled plain tiles) or
//! `unit-ABC-N`, with N wefts and N warps, `roof` or `bunny` (other people's assemblies, where they are), or a spec
//! file. Prints one JSON object a line. After `--reductions` also the times without the reductions of rows.

use std::io::{BufWriter, Write};
use std::path::Path;
use std::time::Instant;
use weavelock::assembly::PartIx;
use weavelock::contact::join;
use weavelock::locking::{Freedom, Row, Start, Unknowns, check, decide_from, rows};
use weavelock::spec::{Spec, Syntax, parse};

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Fallible<()> {
    let mut words = std::env::args().skip(1).filter(|w| w != "--bench");
    let Some(folder) = words.next() else {
        eprintln!("usage: cargo bench --bench verdicts -- FOLDER NAME...");
        return Ok(());
    };
    let mut reductions = Reductions::One;
    for name in words {
        match name.as_str() {
            "--reductions" => reductions = Reductions::Each,
            name => println!("{}", timed(Path::new(&folder), name, reductions)?),
        }
    }
    Ok(())
}

fn woven(abc: &str, strands: &str, rest: &str) -> Fallible<Spec> {
    let text = format!(
        "name = \"bench\"\n[weave]\nabc = [{abc}]\n[profile]\nrise = 0.6\nlift = 1.0\ncover = 1.0\nsamples = 8\n\
         [swatch]\nwefts = {strands}\nwarps = {strands}\n{rest}"
    );
    Ok(parse(&text, Path::new("bench.toml"), Syntax::Toml)?)
}

fn spec(name: &str) -> Fallible<Spec> {
    let parts: Vec<&str> = name.split('-').collect();
    match parts[..] {
        ["window", n] => woven("1,1,1", n, "cut = \"window\"\n"),
        ["tiles", n] => woven("1,1,1", n, "cut = \"tiles\"\nrepeat = 2\nphase = 0\n"),
        ["unit", abc, n] => {
            let abc: Vec<String> = abc.chars().map(String::from).collect();
            woven(&abc.join(","), n, "cut = \"tiles\"\nrepeat = 1\nphase = 0\n")
        }
        ["roof"] => meshes("roof", &["Boundary"]),
        ["bunny"] => meshes("bunny", &["part_1", "part_2"]),
        _ => {
            let file = Path::new(name);
            let text = std::fs::read_to_string(file)?;
            Ok(parse(&text, file, Syntax::of(file, &text))?)
        }
    }
}

/// All OBJ files of a case, some held.
fn meshes(case: &str, held: &[&str]) -> Fallible<Spec> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases/topolite").join(case);
    let mut files: Vec<_> =
        std::fs::read_dir(&folder)?.map(|e| Ok(e?.path())).collect::<std::io::Result<_>>()?;
    files.retain(|f| f.extension().is_some_and(|e| e == "obj"));
    files.sort();
    let mut text = format!("name = \"{case}\"\n[contact]\ntolerance = \"0.001 mm\"\n[size]\nunit = \"mm\"\n");
    for file in files {
        let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        text += &format!("[[part]]\nmesh = \"{stem}.obj\"\nheld = {}\n", held.contains(&stem.as_str()));
    }
    Ok(parse(&text, &folder.join("bench.toml"), Syntax::Toml)?)
}

fn timed(folder: &Path, name: &str, reductions: Reductions) -> Fallible<String> {
    let start = Instant::now();
    let joined = join(&spec(name)?)?;
    let contacts = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let both = check(&joined.assembly, &joined.patches, None);
    let check = start.elapsed().as_secs_f64();
    let still: Vec<PartIx> = both.held.iter().copied().chain(both.fixed).collect();
    let rows = rows(&joined.patches, Freedom::Rigid);
    let unknowns = Unknowns::new(&joined.assembly, &rows, &still, Freedom::Rigid);
    let (word, time, processor) = decided(&rows, &unknowns, Start::Farthest);
    let without = [Start::Outlines, Start::FarthestOfAll, Start::All].map(|s| match reductions {
        Reductions::One => "null".to_string(),
        Reductions::Each => format!("{:.6}", decided(&rows, &unknowns, s).2),
    });
    write_rows(&folder.join(format!("{}.rows", name.replace('/', "_"))), &rows, &unknowns)?;
    Ok(format!(
        "{{\"name\": \"{name}\", \"parts\": {}, \"rows\": {}, \"unknowns\": {}, \"verdict\": \"{word}\", \
         \"contacts_s\": {contacts:.6}, \"check_s\": {check:.6}, \"decide_s\": {time:.6}, \
         \"decide_cpu_s\": {processor:.6}, \"outlines_cpu_s\": {}, \"farthest_cpu_s\": {}, \"all_cpu_s\": {}}}",
        joined.assembly.parts.len(),
        rows.len(),
        unknowns.count,
        without[0],
        without[1],
        without[2]
    ))
}

/// Word, time and processor time of a verdict: medians.
fn decided(rows: &[Row], unknowns: &Unknowns, from: Start) -> (&'static str, f64, f64) {
    let (mut times, mut processor) = (Vec::new(), Vec::new());
    let mut word = "";
    while times.iter().sum::<f64>() < ENOUGH && times.len() < MOST_RUNS {
        let (start, busy) = (Instant::now(), processor_seconds());
        word = decide_from(rows, unknowns, from).word();
        times.push(start.elapsed().as_secs_f64());
        processor.push(processor_seconds() - busy);
    }
    times.sort_by(f64::total_cmp);
    processor.sort_by(f64::total_cmp);
    (word, times[times.len() / 2], processor[processor.len() / 2])
}

/// Which starts of the verdict are timed.
#[derive(Clone, Copy)]
enum Reductions {
    One,
    Each,
}

/// Processor time of all threads so far, as Linux counts it (nanoseconds); NaN elsewhere.
fn processor_seconds() -> f64 {
    let of = |task: std::io::Result<std::fs::DirEntry>| -> Option<f64> {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse().ok()
    };
    std::fs::read_dir("/proc/self/task").map_or(f64::NAN, |tasks| tasks.filter_map(of).sum::<f64>() / 1e9)
}

/// Seconds after which a verdict is not taken again, and how often it is at most; the median counts.
const ENOUGH: f64 = 1.0;
const MOST_RUNS: usize = 15;

/// Little-endian: number of rows and of unknowns (u64); then for each row its number of entries (u64) and the entries
/// (u64 column, f64 value).
fn write_rows(file: &Path, rows: &[Row], unknowns: &Unknowns) -> Fallible<()> {
    let mut out = BufWriter::new(std::fs::File::create(file)?);
    out.write_all(&(rows.len() as u64).to_le_bytes())?;
    out.write_all(&(unknowns.count as u64).to_le_bytes())?;
    for row in rows {
        let entries: Vec<(usize, f64)> = unknowns.entries(row).collect();
        out.write_all(&(entries.len() as u64).to_le_bytes())?;
        for (column, value) in entries {
            out.write_all(&(column as u64).to_le_bytes())?;
            out.write_all(&value.to_le_bytes())?;
        }
    }
    Ok(out.flush()?)
}
