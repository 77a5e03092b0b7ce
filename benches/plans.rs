//! Times of plans: swatches of unit tiles that come apart, one of doubled tiles that is shown to be locked, and what each
//! stage of both costs. Ratios within one run count; `README.md` keeps the table.

use divan::{Bencher, black_box};
use std::path::Path;
use weavelock::assembly::PartIx;
use weavelock::contact::{Joined, join};
use weavelock::locking::check_some;
use weavelock::sequence::{Motions, Outcome, Plan, plan, plan_by};
use weavelock::spec::{Spec, Syntax, parse};
use weavelock::verify::plan::check;

fn main() {
    divan::main();
}

/// n x n strands, cut into pieces of `repeat` unit tiles.
fn spec(abc: [i32; 3], n: u32, repeat: u32, phase: i32) -> Spec {
    let text = format!(
        "name = \"bench\"\n[weave]\nabc = {abc:?}\n[profile]\nrise = 0.6\nlift = 1.0\ncover = 1.0\nsamples = 8\n\
         [swatch]\nwefts = {n}\nwarps = {n}\ncut = \"tiles\"\nrepeat = {repeat}\nphase = {phase}\n"
    );
    parse(&text, Path::new("bench.toml"), Syntax::Toml).expect("a good file")
}

fn joined(spec: &Spec) -> Joined {
    join(spec).expect("an assembly")
}

fn locked(joined: &Joined, set: &[PartIx]) -> Option<()> {
    (check_some(&joined.assembly, &joined.patches, set).word() == "locked").then_some(())
}

fn planned(joined: &Joined) -> Plan<()> {
    plan(&joined.assembly, &joined.patches, |set| locked(joined, set)).expect("cells")
}

/// Strands each way.
const SIZES: [u32; 3] = [4, 8, 16];

/// From the text to parts in place and their contacts: plain unit tiles.
#[divan::bench(args = SIZES, sample_count = 3)]
fn plain_contacts(bencher: Bencher, n: u32) {
    let spec = spec([1, 1, 1], n, 1, 0);
    bencher.bench(|| joined(black_box(&spec)).patches.len());
}

/// The whole plan: plain unit tiles, which come apart.
#[divan::bench(args = SIZES, sample_count = 3)]
fn plain_plan(bencher: Bencher, n: u32) {
    let joined = joined(&spec([1, 1, 1], n, 1, 0));
    bencher.bench(|| {
        let plan = planned(black_box(&joined));
        assert_eq!(plan.outcome, Outcome::Assembled);
    });
}

/// The check of that plan by other code.
#[divan::bench(args = [4, 8], sample_count = 2)]
fn plain_verify(bencher: Bencher, n: u32) {
    let joined = joined(&spec([1, 1, 1], n, 1, 0));
    let plan = planned(&joined);
    bencher.bench(|| check(&joined.assembly, black_box(&plan)));
}

/// The swatch of one period of `[7,1,3]` in doubled tiles: straight moves excluded, then the lock proven.
#[divan::bench(sample_count = 3)]
fn locked_713_plan(bencher: Bencher) {
    let joined = joined(&spec([7, 1, 3], 8, 2, 0));
    bencher.bench(|| {
        let plan = planned(black_box(&joined));
        assert_eq!(plan.outcome, Outcome::NeedsFlexible);
    });
}

/// Of that, the proof of the lock alone.
#[divan::bench(sample_count = 3)]
fn locked_713_proof(bencher: Bencher) {
    let joined = joined(&spec([7, 1, 3], 8, 2, 0));
    let all: Vec<PartIx> = joined.assembly.ids().collect();
    bencher.bench(|| locked(&joined, black_box(&all)));
}

/// `[2,2,1]` at phase 1: no straight move and no lock; three tiles turn out, the other five are locked.
#[divan::bench(sample_count = 1, sample_size = 1)]
fn turning_221_plan(bencher: Bencher) {
    let joined = joined(&spec([2, 2, 1], 4, 1, 1));
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let all: Vec<PartIx> = asm.ids().collect();
    bencher.bench(|| plan_by(asm, &all, patches, Motions::Any, |set| locked(&joined, set)).expect("cells"));
}
