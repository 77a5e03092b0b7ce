//! What a page is to who hears it or has no mouse: the tree that Chromium gives to screen readers, and the way of the Tab
//! key. Without a browser the tests say "not run" and check nothing.

use crate::browser::{Browser, bare, shown_plan, swatch};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use weavelock::report::page::page;
use weavelock::report::viewer::{Answers, of_assembly};

/// Roles that a person acts on.
const CONTROLS: [&str; 7] = ["button", "slider", "combobox", "checkbox", "link", "spinbutton", "textbox"];

fn opened() -> Option<Browser> {
    let mut browser = Browser::with_webgl()?;
    let joined = swatch(2, 4);
    let answers = Answers { plan: Some(shown_plan(&joined)), ..Answers::default() };
    browser.load(&page(&bare(vec![of_assembly(&joined, &answers)], vec![])));
    Some(browser)
}

/// Role, name, description and level of what is not ignored.
fn heard(browser: &mut Browser) -> Vec<(String, String, String, Option<u64>)> {
    let tree = browser.call("Accessibility.getFullAXTree", json!({}));
    let word = |v: &Value| v["value"].as_str().unwrap_or_default().trim().to_string();
    let level = |n: &Value| {
        let found = n["properties"].as_array()?.iter().find(|p| p["name"] == json!("level"))?;
        found["value"]["value"].as_u64()
    };
    let nodes = tree["nodes"].as_array().expect("nodes").iter().filter(|n| n["ignored"] != json!(true));
    nodes.map(|n| (word(&n["role"]), word(&n["name"]), word(&n["description"]), level(n))).collect()
}

#[test]
fn every_control_has_a_name_and_headings_come_in_order() {
    let Some(mut browser) = opened() else { return };
    let heard = heard(&mut browser);
    let controls: Vec<_> = heard.iter().filter(|n| CONTROLS.contains(&n.0.as_str())).collect();
    assert!(controls.len() > 20, "{} controls", controls.len());
    assert!(controls.iter().all(|n| !n.1.is_empty()), "a control without a name: {controls:?}");
    let of_one_role =
        |role: &str| controls.iter().filter(|n| n.0 == role).map(|n| n.1.clone()).collect::<Vec<_>>();
    for role in ["button", "slider", "checkbox"] {
        let names = of_one_role(role);
        let different: BTreeSet<&String> = names.iter().collect();
        assert_eq!(names.len(), different.len(), "two of one name: {names:?}");
    }
    let levels: Vec<u64> = heard.iter().filter(|n| n.0 == "heading").filter_map(|n| n.3).collect();
    assert_eq!(levels.first(), Some(&1));
    assert_eq!(levels.iter().filter(|l| **l == 1).count(), 1);
    assert!(levels.windows(2).all(|w| w[1] <= w[0] + 1), "a level is left out: {levels:?}");
    let view = heard.iter().find(|n| n.1 == "The parts in 3D" && n.0 != "region").expect("the view");
    assert!(view.2.contains("arrow keys"), "{view:?}");
}

#[test]
fn tab_reaches_every_control_and_shows_where_it_is() {
    let Some(mut browser) = opened() else { return };
    let all = "[...document.querySelectorAll('a[href], button, input, select, canvas[tabindex]')].filter((e) => !e.disabled && e.offsetParent !== null).length";
    let all = browser.ask(all).as_u64().expect("a count");
    let here = "(() => { const e = document.activeElement, s = getComputedStyle(e); window.met = window.met || new Set(); if (e !== document.body) window.met.add(e); return [e.tagName, s.outlineStyle, parseFloat(s.outlineWidth)]; })()";
    for _ in 0..all {
        browser.key("Tab", 9);
        let at = browser.ask(here);
        assert!(at[1] != json!("none") && at[2].as_f64() >= Some(2.0), "focus is not seen: {at}");
    }
    assert_eq!(browser.ask("window.met.size").as_u64(), Some(all));
    // What the keys do is told: the live region names the step.
    browser.ask("document.querySelector('canvas').focus()");
    browser.key("n", 0);
    browser.reads("[aria-live]", "step 1 of 7");
}
