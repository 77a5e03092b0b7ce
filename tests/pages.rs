//! What the page and the terminal's summary promise, whatever their strings say.

use std::collections::BTreeSet;
use weavelock::report::content::{Align, Answer, Chapter, Column, Format, Picture, Table, Tone};
use weavelock::report::page::{PageInput, page};
use weavelock::report::text::{Columns, Ink, Summary, write};

/// A string that would break out of every context it might land in.
const NASTY: &str = "<script>alert(\"1\")</script>' & \u{1b}[31m \u{202e}";

fn nasty() -> Chapter {
    Chapter {
        tone: Tone::Bad,
        headline: NASTY.into(),
        words: vec![NASTY.into()],
        facts: vec![(NASTY.into(), NASTY.into())],
        tables: vec![Table {
            caption: NASTY.into(),
            head: vec![Column::words(NASTY), Column::numbers("n")],
            rows: vec![
                vec![NASTY.into(), "1".into(), "more than the head".into()],
                vec![],
                vec![NASTY.into()],
            ],
        }],
        pictures: vec![Picture {
            format: Format::Svg(NASTY.into()),
            width: 3,
            height: 2,
            alt: NASTY.into(),
            caption: NASTY.into(),
        }],
        figure: vec![NASTY.into()],
    }
}

fn input() -> PageInput {
    let given = || Answer::Given(nasty());
    let png = |bytes: &[u8]| Picture { format: Format::Png(bytes.into()), ..nasty().pictures.remove(0) };
    PageInput {
        title: NASTY.into(),
        lead: NASTY.into(),
        pictures: vec![png(b"foobar"), png(b"fooba"), png(b"foob"), png(b"")],
        exhibits: vec![],
        blocking: given(),
        molds: given(),
        draft: given(),
        verdict: given(),
        plan: given(),
        flexible: Answer::not_run(NASTY),
        repeats: given(),
        chirality: Answer::not_run("not asked"),
        parts: Answer::Given(Chapter { pictures: vec![], ..nasty() }),
        ledger: given(),
        findings: Answer::Given(Chapter::default()),
        limits: vec![NASTY.into()],
    }
}

/// Tags of the page in order, without their angle brackets.
fn tags(html: &str) -> Vec<&str> {
    html.split('<').skip(1).map(|t| t.split('>').next().unwrap()).collect()
}

#[test]
fn a_page_is_well_formed_whatever_its_strings_say() {
    let html = page(&input());
    let mut open = Vec::new();
    for tag in tags(&html) {
        let name = tag.split([' ', '\n']).next().unwrap();
        if let Some(closed) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed));
        } else if !["!DOCTYPE", "meta", "img"].contains(&name) {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
    assert!(!html.contains(['\u{1b}', '\u{202e}']));
}

#[test]
fn a_page_stands_alone() {
    let html = page(&input());
    let tags = tags(&html);
    assert!(tags.iter().all(|t| !t.starts_with("script") && !t.starts_with("link") && !t.contains("://")));
    assert!(html.contains("default-src &#39;none&#39;"));
    assert!(!html.contains("url(") && !html.contains("@import"));
    for t in tags.iter().filter(|t| t.starts_with("img")) {
        assert!(t.contains(" src=\"data:image/") && t.contains(" alt=\"&lt;script"), "{t}");
    }
    assert_eq!(html, page(&input()));
}

/// Two scripts, the data and ours, named by its hash; what a part is called can neither end the data nor add a third.
#[test]
fn only_the_viewer_runs_whatever_parts_are_called() {
    let mut joined = crate::support::joined(&crate::support::window([1, 1, 1], 2, 2, 2));
    joined.assembly.parts[0].id = format!("</script><!--<script>{NASTY}\u{2028}");
    let exhibits = vec![weavelock::report::viewer::of_assembly(&joined, &Default::default())];
    let html = page(&PageInput { exhibits, ..input() });
    assert_eq!(html.matches("<script").count(), 2);
    assert_eq!(html.matches("</script").count(), 2);
    assert_eq!(html.matches("script-src").count(), 1);
    assert!(html.contains(&format!("script-src &#39;{}&#39;", weavelock::report::viewer::script_hash())));
    let data = html.split("id=\"viewer-data\">").nth(1).unwrap().split("</script>").next().unwrap();
    let read: serde_json::Value = serde_json::from_str(data).unwrap();
    assert_eq!(read["exhibits"][0]["ids"][0], serde_json::json!(joined.assembly.parts[0].id));
    for word in ["http:", "https:", "fetch(", "import(", "XMLHttpRequest", "eval("] {
        assert!(!weavelock::report::viewer::SCRIPT.contains(word), "{word}");
    }
}

#[test]
fn a_page_can_be_heard_and_walked_by_keyboard() {
    let html = page(&input());
    let tags = tags(&html);
    let ids: Vec<&str> = tags.iter().filter_map(|t| t.split(" id=\"").nth(1)?.split('"').next()).collect();
    let unique: BTreeSet<&str> = ids.iter().copied().collect();
    assert_eq!(ids.len(), unique.len());
    for t in &tags {
        let named = |attr: &str| t.split(attr).nth(1).and_then(|r| r.split('"').next());
        let targets = [named(" href=\"#"), named(" aria-labelledby=\"")];
        assert!(targets.into_iter().flatten().all(|id| unique.contains(id)), "{t}");
        assert!(!t.starts_with("th") || t.contains("scope=") || *t == "thead", "{t}");
    }
    for landmark in ["header", "nav ", "main ", "footer"] {
        assert_eq!(tags.iter().filter(|t| t.starts_with(landmark)).count(), 1, "{landmark}");
    }
    assert_eq!(tags.iter().filter(|t| t.starts_with("h1")).count(), 1);
}

#[test]
fn what_was_not_run_is_said_on_the_page_and_never_looks_passed() {
    let html = page(&input());
    assert_eq!(html.matches("<strong>Not run.</strong>").count(), 2);
    assert_eq!(html.matches("(not run)").count(), 2);
}

#[test]
fn pictures_are_embedded_as_base64() {
    let html = page(&input());
    // The examples of RFC 4648, section 10.
    for code in ["base64,Zm9vYmFy\"", "base64,Zm9vYmE=\"", "base64,Zm9vYg==\"", "base64,\""] {
        assert!(html.contains(code), "{code}");
    }
}

fn summary() -> Summary {
    let chapter = Chapter {
        tone: Tone::Good,
        headline: "Locked: no part can start to move, alone or together with others.".into(),
        words: vec!["Forces balance on every part, and the rows that they act on have full rank.".into()],
        facts: vec![("rank".into(), "18 of 18".into()), ("self-stress".into(), "44 forces".into())],
        tables: vec![Table {
            caption: String::new(),
            head: vec![Column::words("part"), Column { title: "volume".into(), align: Align::Right }],
            rows: vec![vec!["weft-0".into(), "15.1".into()], vec!["warp-10".into(), "7.25".into()]],
        }],
        ..Chapter::default()
    };
    Summary {
        title: "plain-2x2".into(),
        lead: "Four strands, two by two.".into(),
        chapters: vec![
            ("Lock".into(), Answer::Given(chapter)),
            ("Repeats".into(), Answer::not_run("not built yet")),
        ],
        closing: vec!["Files are in out/.".into()],
    }
}

#[test]
fn the_terminal_shows_names_and_columns_aligned() {
    let text = write(&summary(), Ink::Plain, Columns::default());
    let expected = "\
plain-2x2
Four strands, two by two.

Lock
  ✓ Locked: no part can start to move, alone or together with others.
  Forces balance on every part, and the rows that they act on have full rank.

  rank          18 of 18
  self-stress   44 forces

  part      volume
  weft-0      15.1
  warp-10     7.25

Repeats
  not run: not built yet

Files are in out/.
";
    assert_eq!(text, expected);
}

#[test]
fn no_line_is_longer_than_asked_for() {
    let chapters = vec![("Nasty".into(), Answer::Given(nasty()))];
    let nasty = Summary { lead: "words ".repeat(90), chapters, ..summary() };
    for width in 29..130 {
        for s in [&summary(), &nasty] {
            let text = write(s, Ink::Plain, Columns(width));
            let figure = |l: &str| l.contains("alert");
            let too_long = text.lines().find(|l| l.chars().count() > width && !figure(l));
            assert_eq!(too_long, None, "at {width}");
        }
    }
    assert!(!write(&summary(), Ink::Plain, Columns(0)).is_empty());
}

#[test]
fn only_our_own_colours_reach_the_terminal() {
    let nasty = Summary { chapters: vec![("x".into(), Answer::Given(nasty()))], ..summary() };
    assert!(!write(&nasty, Ink::Plain, Columns::default()).contains(['\u{1b}', '\u{202e}']));
    let coloured = write(&nasty, Ink::Colour, Columns::default());
    let codes: BTreeSet<&str> =
        coloured.split('\u{1b}').skip(1).map(|c| c.split('m').next().unwrap()).collect();
    let ours = BTreeSet::from(["[0", "[1", "[2", "[1;31", "[1;34"]);
    assert!(codes.is_subset(&ours), "{codes:?}");
    let plain: String =
        coloured.split('\u{1b}').map(|c| c.split_once('m').map_or(c, |(_, rest)| rest)).collect();
    assert_eq!(
        plain.matches("script").count(),
        write(&nasty, Ink::Plain, Columns::default()).matches("script").count()
    );
}
