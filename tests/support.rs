//! What several test files need: woven assemblies from the text of their file, seeded numbers, ways to take a verdict.

use std::path::{Path, PathBuf};
use weavelock::assembly::{Assembly, PartIx};
use weavelock::contact::{Joined, Origin, Patch, join};
use weavelock::locking::{Check, Verdict, check, check_some};
use weavelock::report::answer::{self, PlanAnswer, Source};
use weavelock::sequence::plan;
use weavelock::spec::{Syntax, parse};

/// The file of a woven assembly with the known answers' profile; `layout` is its last tables.
pub fn woven(abc: [i32; 3], samples: u32, layout: &str) -> String {
    format!(
        "name = \"test\"\n[weave]\nabc = {abc:?}\n[profile]\nrise = 0.6\nlift = 1.0\ncover = 1.0\n\
         samples = {samples}\n{layout}"
    )
}

/// `wefts` x `warps` strands, each one piece as long as the window.
pub fn window(abc: [i32; 3], samples: u32, wefts: u32, warps: u32) -> String {
    woven(abc, samples, &format!("[swatch]\nwefts = {wefts}\nwarps = {warps}\ncut = \"window\"\n"))
}

/// `n` x `n` strands cut into pieces of `repeat` unit tiles.
pub fn tiles(abc: [i32; 3], samples: u32, n: u32, repeat: u32, phase: i32) -> String {
    let swatch = format!("wefts = {n}\nwarps = {n}\ncut = \"tiles\"\nrepeat = {repeat}\nphase = {phase}\n");
    woven(abc, samples, &format!("[swatch]\n{swatch}"))
}

pub fn joined(text: &str) -> Joined {
    let spec = parse(text, Path::new("test.toml"), Syntax::Toml).unwrap_or_else(|f| panic!("{f}\n{text}"));
    join(&spec).unwrap_or_else(|f| panic!("{f}\n{text}"))
}

/// Where the pieces of a woven assembly start, in the order of its parts.
pub fn starts(joined: &Joined) -> Vec<i32> {
    match &joined.origin {
        Origin::Woven(w) => w.pieces.iter().map(|p| p.from).collect(),
        Origin::Meshes => panic!("not woven"),
    }
}

/// Words for translations and for rigid motions.
pub type Words = (&'static str, &'static str);

pub fn words(asm: &Assembly, patches: &[Patch]) -> Words {
    words_of(&check(asm, patches, None))
}

pub fn words_fixing(asm: &Assembly, patches: &[Patch], fixed: PartIx) -> Words {
    words_of(&check(asm, patches, Some(fixed)))
}

fn words_of(check: &Check) -> Words {
    (check.translation.word(), check.rigid.word())
}

/// Numbers that follow from a seed (splitmix64): the same on every machine.
pub struct Dice(u64);

impl Dice {
    pub fn new(seed: u64) -> Dice {
        Dice(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `n`, which must not be 0. The bias of the remainder is no matter here.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// In [-1, 1).
    pub fn signed(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn shuffled(&mut self, n: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..n).collect();
        (1..n).rev().for_each(|k| order.swap(k, self.below(k + 1)));
        order
    }
}

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// An empty folder of a test's own; `of` is the file that the test stands in.
pub fn room(of: &str, name: &str) -> PathBuf {
    let room = Path::new(env!("CARGO_TARGET_TMPDIR")).join(of).join(name);
    let _ = std::fs::remove_dir_all(&room);
    std::fs::create_dir_all(&room).expect("a folder");
    room
}

pub fn source(file: &str, text: &str) -> Source {
    Source { file: file.into(), text: text.into() }
}

/// The plan of all parts as they touch, as `plan` writes it.
pub fn plan_answer(joined: &Joined, source: Source) -> PlanAnswer {
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let prove = |set: &[PartIx]| match check_some(asm, patches, set) {
        Verdict::Locked(stress) => Some(answer::certificate(asm, &set[..1], &stress)),
        _ => None,
    };
    let found = plan(asm, patches, prove).expect("cells");
    let all: Vec<PartIx> = asm.ids().collect();
    answer::plan(joined, found, &all, 0.0, None, source)
}

/// The program with these arguments.
pub fn ran(args: &[&str]) -> std::process::Output {
    std::process::Command::new(env!("CARGO_BIN_EXE_weavelock")).args(args).output().expect("runs")
}

/// What `verify` says of an answer as JSON.
pub fn verified(answer: &serde_json::Value) -> weavelock::verify::Verified {
    let sealed: weavelock::report::answer::Sealed =
        serde_json::from_value(answer.clone()).expect("an answer");
    weavelock::verify::answer(&sealed).expect("a spec")
}
