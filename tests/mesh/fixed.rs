//! Whichever part is fixed, an assembly in which nothing is held has one verdict; a part that is held alone is no more
//! than fixed.

use super::files::Made;
use super::made::all;
use super::noisy::{Folder, joined, judged, turned};
use super::{case, contacts};
use weavelock::assembly::{Assembly, Mobility};
use weavelock::contact::Patch;
use weavelock::locking;

fn words(a: &Assembly, patches: &[Patch]) -> Vec<[&'static str; 2]> {
    let of = |p| {
        let c = locking::check(a, patches, Some(p));
        [c.translation.word(), c.rigid.word()]
    };
    a.ids().map(of).collect()
}

#[test]
#[ignore = "slow: every part of every case of others is fixed in turn"]
fn cases_of_others_whichever_part_is_fixed() {
    // The roof's one held part locks it, so any part does.
    let wanted = [
        ("bunny", "free"),
        ("cube9", "free"),
        ("roof", "locked"),
        ("frame14", "free"),
        ("between-bars-3", "free"),
    ];
    for (name, want) in wanted {
        let Some(a) = case(name, &[]) else { return };
        let found = words(&a, &contacts(&a).patches);
        assert!(found.iter().all(|w| *w == [want; 2]), "{name}: {found:?}");
        println!("{name}: {} parts", found.len());
    }
}

#[test]
fn made_assemblies_with_one_part_held_have_its_verdict_whichever_part_is_fixed() {
    let (folder, mut tried) = (Folder::new("fixed"), 0);
    let one_held = |m: &Made| m.parts.iter().filter(|p| p.held).count() == 1;
    for mut m in all().into_iter().filter(one_held) {
        m.parts.iter_mut().for_each(|p| p.held = false);
        let j = joined(&turned(&m, &folder)).unwrap_or_else(|e| panic!("{}: {e}", m.name));
        assert!(j.assembly.parts.iter().all(|p| p.mobility == Mobility::Free));
        for p in j.assembly.ids() {
            assert_eq!(judged(&j, Some(p)), m.want, "{}, {} fixed", m.name, j.assembly.part(p).id);
            tried += 1;
        }
    }
    assert!(tried > 20, "{tried}");
}
