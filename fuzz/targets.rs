//! Takes bytes; reads them as a spec, a WIF or a drawn draft, and checks everything that the reader promises.
//!
//! Not promised: that a spec means what its author meant; that is what the fixtures are for.

use super::driver::Target;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use weavelock::fault::Faults;
use weavelock::input;
use weavelock::spec::{
    HeldSpec, Layout, MAX_SITES, Shape, Spec, Subject, Syntax, WovenSpec, parse, piece_ids,
};
use weavelock::weave::{
    Hanging, MAX_DRAFT, Weave, family, floats, hangs_together, parse_drawn, parse_wif, svg, terminal, to_wif,
};

/// The readers by name, with the endings of the files that they know.
pub const READERS: [(&str, Target, &[&str]); 3] =
    [("spec", spec, &["toml", "json"]), ("wif", wif, &["wif"]), ("draft", drawn, &["draft"])];

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

/// All fixtures with one of the endings, in the order of their names.
pub fn corpus(endings: &[&str]) -> Vec<Vec<u8>> {
    let folders = ["specs", "weaves", "bad"].map(|name| fixtures().join(name));
    let entries = folders.iter().flat_map(|folder| fs::read_dir(folder).expect("fixtures are there"));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("readable").path()).collect();
    paths.retain(|path| endings.iter().any(|end| path.extension().is_some_and(|e| e == *end)));
    paths.sort();
    paths.iter().map(|path| fs::read(path).expect("readable")).collect()
}

fn spec(bytes: &[u8]) -> String {
    let file = fixtures().join("specs/mutant.toml");
    let text = match input::text(bytes.to_vec(), &file) {
        Ok(text) => text,
        Err(faults) => return said(&faults, ""),
    };
    match parse(&text, &file, Syntax::of(&file, &text)) {
        Ok(spec) => sound_spec(&spec),
        Err(faults) => said(&faults, &text),
    }
}

fn wif(bytes: &[u8]) -> String {
    let file = Path::new("mutant.wif");
    let read = input::legacy_text(bytes.to_vec(), file).and_then(|text| parse_wif(&text, file));
    read.map_or_else(|faults| said(&faults, &String::from_utf8_lossy(bytes)), |weave| sound_weave(&weave))
}

fn drawn(bytes: &[u8]) -> String {
    let file = Path::new("mutant.draft");
    let read = input::text(bytes.to_vec(), file).and_then(|text| parse_drawn(&text, file));
    read.map_or_else(|faults| said(&faults, &String::from_utf8_lossy(bytes)), |weave| sound_weave(&weave))
}

/// Faults have words and hints and are sorted; they point into the text (none of another file can be checked here).
fn said(faults: &Faults, text: &str) -> String {
    assert!(!faults.0.is_empty(), "refused without a fault");
    assert!(faults.0.iter().all(|f| !f.what.is_empty() && !f.hint.is_empty()), "{faults:?}");
    assert!(faults.0.is_sorted_by_key(|f| (&f.file, f.place)), "{faults:?}");
    let lines = text.split(['\n', '\r']).count();
    for place in faults.0.iter().filter(|f| f.file.contains("mutant")).filter_map(|f| f.place) {
        assert!(
            text.is_empty() || (1..=lines).contains(&place.line) && place.column >= 1,
            "{place:?} of {lines}"
        );
    }
    faults.to_string()
}

fn sound_spec(spec: &Spec) -> String {
    assert!(spec.fab.as_ref().and_then(|fab| fab.clearance_mm).is_none_or(|c| c.is_finite() && c >= 0.0));
    match &spec.subject {
        Subject::Woven(woven) => sound_woven(woven),
        Subject::Meshes(meshes) => {
            let ids: BTreeSet<&str> = meshes.parts.iter().map(|part| part.id.as_str()).collect();
            assert_eq!(ids.len(), meshes.parts.len(), "ids are unique");
            for part in &meshes.parts {
                assert!((part.at.matrix3.determinant() - 1.0).abs() < 1e-12, "{:?}", part.at);
            }
            assert!(meshes.tolerance_mm > 0.0 && meshes.mm_per_unit > 0.0);
            "meshes".into()
        }
    }
}

fn sound_woven(spec: &WovenSpec) -> String {
    let profile = &spec.profile;
    assert!((0.0..=10_000.0).contains(&spec.pitch_mm) && spec.pitch_mm > 0.0);
    assert!(profile.lift > 0.0 && profile.lift <= 6.0 && profile.cover > 0.0 && profile.cover <= 6.0);
    assert!((2..=64).contains(&profile.samples));
    let shape = match &profile.shape {
        Shape::Rise(rise) => format!("rise {}", (0.0..=1.0).contains(rise)),
        Shape::Points(points) => {
            assert!(points.is_sorted_by_key(|p| p[0]) && points.iter().flatten().all(|x| x.is_finite()));
            let ([x0, z0], [x1, z1]) = (points[0], points[points.len() - 1]);
            assert!((x1 - x0 - f64::from(spec.weave.tile.0)).abs() < 1e-9 && z0 == z1, "{points:?}");
            "points".into()
        }
    };
    let layout = match &spec.layout {
        Layout::Swatch { wefts, warps, .. } => {
            assert!(2 * u64::from(*wefts) * u64::from(*warps) * u64::from(profile.samples) <= MAX_SITES);
            format!("swatch {:?}", spec.held)
        }
        Layout::Pieces(pieces) => {
            let ids = piece_ids(pieces);
            assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), pieces.len(), "ids are unique: {ids:?}");
            assert!(pieces.iter().all(|piece| piece.from < piece.to));
            let held = if let HeldSpec::Parts(held) = &spec.held { &held[..] } else { &[] };
            assert!(held.iter().all(|id| ids.contains(id)), "{held:?} of {ids:?}");
            format!("pieces, held {}", held.len())
        }
    };
    format!("{shape}; {layout}; {}", sound_weave(&spec.weave))
}

/// A weave that was read is small, can be drawn, and survives a round trip through WIF.
fn sound_weave(weave: &Weave) -> String {
    let draft = &weave.draft;
    assert!(draft.wefts() as usize <= MAX_DRAFT && draft.warps() as usize <= MAX_DRAFT);
    assert!(!svg(draft).is_empty() && !terminal(draft, 80).is_empty());
    let back = parse_wif(&to_wif(draft, "mutant"), Path::new("back.wif")).expect("what is written is read");
    assert_eq!(&back.draft, draft, "a round trip keeps the draft");
    let hangs = matches!(hangs_together(draft), Hanging::Together);
    format!("{:?} {:?} {hangs}", family(draft), floats(draft))
}
