//! Woven assemblies that one could make, each with its verdict in its file and a twin that says the opposite.
//!
//! A fixture's comments hold `# expect: translation = W, rigid = W, plan = W` and `# twin: NAME`. A fixture that the
//! program is known to answer wrongly carries `# wrong: REASON`; once it is answered rightly the mark must go.

use crate::second::{Opinion, opinion};
use crate::support::words;
use std::collections::BTreeMap;
use std::path::Path;
use weavelock::assembly::{Assembly, PartIx};
use weavelock::contact::{Joined, join};
use weavelock::locking::check_some;
use weavelock::sequence::{Outcome, plan};
use weavelock::spec;

type Answers = BTreeMap<String, String>;

#[derive(Clone, Debug, PartialEq)]
struct Fixture {
    expect: Answers,
    twin: String,
    wrong: Option<String>,
}

fn fixture(text: &str) -> Result<Fixture, String> {
    let after = |key: &str| text.lines().find_map(|l| l.strip_prefix(key)).map(|l| l.trim().to_string());
    let pair = |p: &str| p.split_once('=').map(|(k, v)| (k.trim().to_string(), v.trim().to_string()));
    let expect = after("# expect:").ok_or("no `# expect:`")?;
    let expect: Option<Answers> = expect.split(',').map(pair).collect();
    let expect = expect.ok_or("`# expect:` is not a list of key = word")?;
    let keys: Vec<&str> = expect.keys().map(String::as_str).collect();
    if keys != ["plan", "rigid", "translation"] {
        return Err(format!("expects {keys:?}"));
    }
    Ok(Fixture { expect, twin: after("# twin:").ok_or("no `# twin:`")?, wrong: after("# wrong:") })
}

/// Whether one of the words says the opposite of the other.
fn opposite(a: &str, b: &str) -> bool {
    let good = ["locked", "needs-flexible"];
    let bad = ["free", "assembled"];
    let pair = |x: &str, y: &str| good.iter().zip(bad).any(|(g, d)| x == *g && y == d);
    pair(a, b) || pair(b, a)
}

/// What is wrong with a corpus and the answers to it; nothing where all is as expected.
fn faults(corpus: &BTreeMap<String, Fixture>, found: &BTreeMap<String, Answers>) -> Vec<String> {
    if corpus.is_empty() {
        return vec!["there are no fixtures".into()];
    }
    let mut faults = Vec::new();
    for (name, fixture) in corpus {
        match corpus.get(&fixture.twin) {
            None => faults.push(format!("{name}: no twin `{}`", fixture.twin)),
            Some(twin) if !fixture.expect.iter().any(|(k, v)| opposite(v, &twin.expect[k])) => {
                faults.push(format!("{name}: its twin `{}` does not say the opposite", fixture.twin));
            }
            Some(_) => {}
        }
        match (found.get(name) == Some(&fixture.expect), &fixture.wrong) {
            (true, Some(why)) => faults.push(format!("{name}: right now; take away `# wrong: {why}`")),
            (false, None) => {
                faults.push(format!("{name}: expected {:?}, found {:?}", fixture.expect, found.get(name)))
            }
            _ => {}
        }
    }
    faults
}

fn folder() -> BTreeMap<String, (Fixture, Joined)> {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/assemblies/woven");
    let mut all = BTreeMap::new();
    for entry in std::fs::read_dir(&dir).expect("the folder of woven fixtures") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&path).expect("text");
        let fixture = fixture(&text).unwrap_or_else(|why| panic!("{name}: {why}"));
        let spec = spec::read(&path).unwrap_or_else(|faults| panic!("{faults}"));
        all.insert(name, (fixture, join(&spec).unwrap_or_else(|faults| panic!("{faults}"))));
    }
    all
}

fn answers(joined: &Joined) -> Answers {
    let (asm, patches) = (&joined.assembly, &joined.patches);
    let (translation, rigid) = words(asm, patches);
    let locked = |set: &[PartIx]| (check_some(asm, patches, set).word() == "locked").then_some(());
    let outcome = match plan(asm, patches, locked).expect("cells").outcome {
        Outcome::Assembled => "assembled",
        Outcome::NeedsFlexible => "needs-flexible",
        Outcome::NotFound => "not-found",
    };
    let all = [("translation", translation), ("rigid", rigid), ("plan", outcome)];
    all.map(|(k, v)| (k.to_string(), v.to_string())).into()
}

#[test]
fn every_woven_fixture_is_answered_as_it_says() {
    let folder = folder();
    let found = folder.iter().map(|(name, (_, joined))| (name.clone(), answers(joined))).collect();
    let corpus = folder.iter().map(|(name, (fixture, _))| (name.clone(), fixture.clone())).collect();
    let faults = faults(&corpus, &found);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

fn still(asm: &Assembly) -> Vec<PartIx> {
    let held: Vec<PartIx> = asm.held().collect();
    if held.is_empty() { vec![PartIx(0)] } else { held }
}

/// The verdicts in the files are not our own word alone.
#[test]
#[ignore = "slow: a simplex over all rows"]
fn the_second_opinion_agrees_with_the_fixtures() {
    for (name, (fixture, joined)) in folder() {
        let asm = &joined.assembly;
        for (key, turning) in [("translation", false), ("rigid", true)] {
            let second = opinion(asm, &joined.patches, &still(asm), turning);
            println!("{name} {key}: {second:?}");
            if second != Opinion::InDoubt {
                assert_eq!(second.word(), fixture.expect[key], "{name}, {key}");
            }
        }
    }
}

#[test]
fn the_corpus_is_judged_strictly() {
    let of = |words: &str, twin: &str, wrong: &str| {
        fixture(&format!("# expect: {words}\n# twin: {twin}\n{wrong}")).expect("a fixture")
    };
    let locked = "translation = locked, rigid = locked, plan = needs-flexible";
    let free = "translation = free, rigid = free, plan = assembled";
    let good: BTreeMap<String, Fixture> =
        [("a".into(), of(locked, "b", "")), ("b".into(), of(free, "a", ""))].into();
    let found: BTreeMap<String, Answers> = good.iter().map(|(k, f)| (k.clone(), f.expect.clone())).collect();
    assert_eq!(faults(&good, &found), Vec::<String>::new());
    assert_eq!(faults(&BTreeMap::new(), &found).len(), 1, "an empty corpus");
    let with = |fixture: Fixture| {
        let mut corpus = good.clone();
        corpus.insert("a".into(), fixture);
        faults(&corpus, &found).len()
    };
    assert_eq!(with(of(locked, "b", "# wrong: not yet")), 1, "an expected failure that passes");
    assert_eq!(with(of(free, "b", "# wrong: not yet")), 2, "twins that say the same");
    assert_eq!(with(of(locked, "c", "")), 1, "a twin that is not there");
    assert!(fixture("# expect: rigid = locked\n# twin: b").is_err());
}
