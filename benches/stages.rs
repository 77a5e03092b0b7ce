//! Times of the stages, and how tile and verdict grow with the number of strands. Ratios within one run count, not
//! times between machines; `README.md` keeps the table.

use divan::{Bencher, black_box};
use std::path::Path;
use weavelock::assembly::PartIx;
use weavelock::contact::{Joined, Origin, join, woven};
use weavelock::locking::{Freedom, check, check_some, rows};
use weavelock::sequence::plan;
use weavelock::sites::Sites;
use weavelock::spec::{Spec, Subject, Syntax, WovenSpec, parse};
use weavelock::tile::{Lattice, Piece, tiles};
use weavelock::weave::{Kind, Strand};

fn main() {
    divan::main();
}

type Abc = [i32; 3];

const WEAVES: [Abc; 3] = [[1, 1, 1], [2, 2, 1], [7, 1, 3]];

fn spec(abc: Abc, swatch: &str) -> Spec {
    let text = format!(
        "name = \"bench\"\n[weave]\nabc = {abc:?}\n[profile]\nrise = 0.6\nlift = 1.0\ncover = 1.0\nsamples = 8\n\
         [swatch]\n{swatch}"
    );
    parse(&text, Path::new("bench.toml"), Syntax::Toml).expect("a good file")
}

/// n x n strands, each one piece of `repeat` unit tiles.
fn doubled(abc: Abc, repeat: u32) -> Spec {
    let n = abc[0] + abc[1];
    spec(abc, &format!("wefts = {n}\nwarps = {n}\ncut = \"tiles\"\nrepeat = {repeat}\nphase = 0\n"))
}

/// A plain window of `strands` / 2 wefts and as many warps.
fn window(strands: u32) -> Spec {
    let n = strands / 2;
    spec([1, 1, 1], &format!("wefts = {n}\nwarps = {n}\ncut = \"window\"\n"))
}

fn joined(spec: &Spec) -> Joined {
    join(spec).expect("an assembly")
}

fn woven_spec(spec: &Spec) -> &WovenSpec {
    let Subject::Woven(woven) = &spec.subject else { unreachable!("a weave") };
    woven
}

/// Sites and one unit tile, from a checked weave.
#[divan::bench(args = WEAVES)]
fn tile(bencher: Bencher, abc: Abc) {
    let spec = doubled(abc, 1);
    let woven = woven_spec(&spec);
    let piece = Piece { strand: Strand { kind: Kind::Weft, index: 0 }, from: 0, to: abc[0] + abc[1] };
    bencher.bench(|| {
        let sites = Sites::new(&woven.weave, &woven.profile).expect("sites");
        tiles(&sites, &Lattice::new(&woven.weave.draft), black_box(&[piece])).expect("a tile")
    });
}

/// Patches and rows of a swatch of doubled tiles that is already in place.
#[divan::bench(args = WEAVES)]
fn contact_rows(bencher: Bencher, abc: Abc) {
    let joined = joined(&doubled(abc, 2));
    let Origin::Woven(placed) = &joined.origin else { unreachable!("woven") };
    bencher.bench(|| rows(&woven::patches(black_box(placed)), Freedom::Rigid).len());
}

/// Both verdicts of a swatch of doubled tiles: locked.
#[divan::bench(args = WEAVES)]
fn verdict_locked(bencher: Bencher, abc: Abc) {
    let joined = joined(&doubled(abc, 2));
    bencher.bench(|| check(&joined.assembly, black_box(&joined.patches), None));
}

/// Both verdicts of a swatch of unit tiles: free.
#[divan::bench(args = WEAVES)]
fn verdict_free(bencher: Bencher, abc: Abc) {
    let joined = joined(&doubled(abc, 1));
    bencher.bench(|| check(&joined.assembly, black_box(&joined.patches), None));
}

#[divan::bench(args = WEAVES, sample_count = 10)]
fn plan_unit_tiles(bencher: Bencher, abc: Abc) {
    let joined = joined(&doubled(abc, 1));
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let locked = |set: &[PartIx]| (check_some(asm, patches, set).word() == "locked").then_some(());
    bencher.bench(|| plan(asm, patches, locked).expect("cells"));
}

const STRANDS: [u32; 4] = [2, 8, 32, 128];

/// From the file to contacts: one tile for each orbit of pieces, the rest are instances.
#[divan::bench(args = STRANDS, sample_count = 10)]
fn growth_of_tile_and_contacts(bencher: Bencher, strands: u32) {
    let spec = window(strands);
    bencher.bench(|| joined(black_box(&spec)).patches.len());
}

#[divan::bench(args = STRANDS, sample_count = 5)]
fn growth_of_verdict(bencher: Bencher, strands: u32) {
    let joined = joined(&window(strands));
    bencher.bench(|| check(&joined.assembly, black_box(&joined.patches), None));
}
