//! Groups: pieces that need not be parted, as the file says; and ways to fill a result when none is stated.

use super::{puzzle, ran, room};
use serde_json::Value;
use std::ops::ControlFlow;
use weavelock::assembly::voxel::cover::{Covered, assemblies};
use weavelock::spec::puzzle::groups::Groups;

/// A ring that a rod with two heads holds for good, and a cube beside the rod's upper head.
fn bound(ring: &str, rod: &str) -> String {
    let solved = "<solutions><solution><assembly>0 0 1 0 1 0 0 0 1 1 3 0</assembly></solution></solutions>";
    format!(
        "<puzzle><shapes><voxel x=\"3\" y=\"3\" z=\"1\" name=\"ring\" type=\"0\">####_####</voxel>\
         <voxel x=\"1\" y=\"2\" z=\"3\" name=\"rod\" type=\"0\">##_###</voxel>\
         <voxel x=\"1\" y=\"1\" z=\"1\" name=\"cube\" type=\"0\">#</voxel>\
         <voxel x=\"3\" y=\"3\" z=\"4\" type=\"0\">_#__#____#########_#__#________#____</voxel></shapes><problems><problem>\
         <shapes><shape id=\"0\"{ring}</shape><shape id=\"1\"{rod}</shape><shape id=\"2\"/></shapes><result id=\"3\"/>\
         <bitmap/>{solved}</problem></problems></puzzle>"
    )
}

const ONE: &str = "><group group=\"1\" count=\"1\"/>";

#[test]
fn pieces_of_one_group_stay_together_and_verify_holds_it_against_the_file() {
    let at = room("groups");
    let planned = |ring: &str, rod: &str| -> (i32, Value) {
        std::fs::write(at.join("p.xmpuzzle"), bound(ring, rod)).expect("written");
        let (code, out, err) = ran(&["plan", "p.xmpuzzle", "--json"], &at);
        std::fs::write(at.join("plan.json"), &out).expect("written");
        let (verified, told, _) = ran(&["verify", "plan.json"], &at);
        assert_eq!(verified, 0, "{told}");
        (code, serde_json::from_str(&out).unwrap_or_else(|e| panic!("{e}: {err}")))
    };
    for (ring, rod) in [(" group=\"1\">", " group=\"1\">"), (ONE, ONE)] {
        let (code, plan) = planned(ring, rod);
        assert_eq!(
            (code, plan["outcome"].as_str(), plan["level"].as_str()),
            (0, Some("assembled"), Some("1"))
        );
        assert_eq!(plan["together"], serde_json::json!([["ring", "rod"]]));
    }
    // The same claim about a file whose groups do not say so.
    let good: weavelock::report::answer::PlanAnswer =
        serde_json::from_str(&std::fs::read_to_string(at.join("plan.json")).expect("there"))
            .expect("an answer");
    let mut forged = good;
    forged.source.text = forged.source.text.replace("group=\"1\"", "group=\"0\"");
    forged.checksum.clear();
    forged.checksum = weavelock::report::answer::checksum(&forged);
    std::fs::write(at.join("forged.json"), serde_json::to_string(&forged).expect("JSON")).expect("written");
    let (code, out, _) = ran(&["verify", "forged.json"], &at);
    assert!(code == 1 && out.contains("group"), "{code}: {out}");
    // Other groups, or none: what stays together is no plan.
    for (ring, rod) in [(">", ">"), (" group=\"1\">", " group=\"2\">"), (" group=\"1\">", ">")] {
        let (code, plan) = planned(ring, rod);
        assert_eq!((code, plan["level"].as_str()), (1, None));
        assert_eq!(plan["kept"][0]["looked_at"], "all-positions");
        assert!(plan.get("together").is_none());
    }
}

#[test]
fn a_group_has_no_more_pieces_than_it_says() {
    let file = |first: &str, second: &str| {
        format!(
            "<puzzle><shapes><voxel x=\"1\" y=\"1\" z=\"1\" type=\"0\">#</voxel><voxel x=\"2\" y=\"1\" z=\"1\" type=\"0\">##</voxel>\
             <voxel x=\"6\" y=\"1\" z=\"1\" type=\"0\">######</voxel></shapes><problems><problem><shapes>\
             <shape id=\"0\" count=\"2\">{first}</shape><shape id=\"1\" count=\"2\">{second}</shape></shapes><result id=\"2\"/>\
             <solutions><solution><assembly>0 0 0 0 1 0 0 0 2 0 0 0 4 0 0 0</assembly></solution></solutions></problem></problems>\
             </puzzle>"
        )
    };
    let group = |n: u32, count: u32| format!("<group group=\"{n}\" count=\"{count}\"/>");
    let of = |first: &str, second: &str| Groups::of(&puzzle(&file(first, second)));
    assert_eq!(of("", ""), None);
    // Two groups for the first shape: only the counts tell.
    let both = group(1, 1) + &group(2, 1);
    let groups = of(&both, &(group(1, 1) + &group(2, 1))).expect("groups");
    assert!(!groups.is_one(&[0, 2]));
    assert!(groups.allow(&[vec![0, 2]]) && groups.allow(&[vec![0, 2], vec![1, 3]]));
    assert!(!groups.allow(&[vec![0, 1]]), "no group has two of the first shape");
    let groups = of(&both, &group(1, 2)).expect("groups");
    assert!(groups.allow(&[vec![0, 2, 3]]) && !groups.allow(&[vec![0, 2], vec![1, 3]]));
    let groups = of(&group(1, 1), "").expect("groups");
    assert!(groups.is_one(&[0, 1]) && !groups.allow(&[vec![0, 2]]));
}

/// Sticks of one shape: how many are used is left open, and one voxel of the result may stay empty.
#[test]
fn pieces_that_need_not_be_used_fill_what_may_not_stay_empty() {
    let file = |least: u32, holes: u32| {
        format!(
            "<puzzle><shapes><voxel x=\"2\" y=\"1\" z=\"1\" type=\"0\">##</voxel><voxel x=\"5\" y=\"1\" z=\"1\" type=\"0\">+++++\
             </voxel></shapes><problems><problem maxHoles=\"{holes}\"><shapes><shape id=\"0\" min=\"{least}\" max=\"3\"/></shapes>\
             <result id=\"1\"/></problem></problems></puzzle>"
        )
    };
    let count = |text: &str| {
        let mut ways = Vec::new();
        let end = assemblies(&puzzle(text), 10_000, |s| {
            ways.push(s.placements.iter().flatten().count());
            ControlFlow::Continue(())
        });
        assert_eq!(end, Covered::All);
        ways
    };
    // Two sticks: the hole is at either end or in the middle.
    assert_eq!(count(&file(0, 1)), [2, 2, 2]);
    assert_eq!(count(&file(2, 1)), [2, 2, 2]);
    assert_eq!(count(&file(1, 3)).len(), 4, "one stick, anywhere");
    assert_eq!(count(&file(3, 5)), Vec::<usize>::new(), "three sticks are too long");
}
