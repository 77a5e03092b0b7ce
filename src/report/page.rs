//! Takes chapters and exhibits, gives one HTML file that stands alone: no address outside, the same bytes every time.
//!
//! Promised: caller's strings are text wherever they appear, never markup; an SVG is shown as an image, which runs
//! nothing; no script runs but the viewer's own, named by its hash. Not promised: any knowledge of geometry, or that a
//! picture's bytes are a picture.

use super::content::{Align, Answer, Chapter, Picture, Table, Tone};
use super::html::Html;
use super::viewer::{self, Exhibit};

/// Everything that the page says. Chapters that nobody asked for are [`Answer::NotRun`] and are shown so.
#[derive(Clone, Debug, PartialEq)]
pub struct PageInput {
    pub title: String,
    /// What was looked at, in one sentence.
    pub lead: String,
    /// Shown above everything else; the first one large. A live view takes their place where a browser can show it.
    pub pictures: Vec<Picture>,
    /// What can be turned and taken apart; none: the pictures stay.
    pub exhibits: Vec<Exhibit>,
    pub draft: Answer<Chapter>,
    pub verdict: Answer<Chapter>,
    pub plan: Answer<Chapter>,
    pub blocking: Answer<Chapter>,
    pub flexible: Answer<Chapter>,
    pub repeats: Answer<Chapter>,
    pub chirality: Answer<Chapter>,
    pub parts: Answer<Chapter>,
    pub molds: Answer<Chapter>,
    pub ledger: Answer<Chapter>,
    pub findings: Answer<Chapter>,
    pub limits: Vec<String>,
}

impl PageInput {
    /// Anchor, title and answer of each chapter, in the order of the page.
    fn chapters(&self) -> [(&'static str, &'static str, &Answer<Chapter>); 11] {
        [
            ("verdict", "Does it lock?", &self.verdict),
            ("draft", "The weave", &self.draft),
            ("plan", "How it goes together", &self.plan),
            ("blocking", "Who stops whom", &self.blocking),
            ("flexible", "Flexible parts", &self.flexible),
            ("repeats", "Repetition", &self.repeats),
            ("chirality", "Chirality", &self.chirality),
            ("parts", "Parts as made", &self.parts),
            ("molds", "Molds", &self.molds),
            ("ledger", "Scale ledger", &self.ledger),
            ("findings", "Findings", &self.findings),
        ]
    }
}

/// Nothing may be fetched, whatever a string smuggled in, and nothing run but the viewer's own script; only embedded
/// images and the page's own style.
fn policy(input: &PageInput) -> String {
    let script = match input.exhibits.is_empty() {
        true => String::new(),
        false => format!(" script-src '{}';", viewer::script_hash()),
    };
    format!(
        "default-src 'none'; img-src data:; style-src 'unsafe-inline';{script} base-uri 'none'; form-action 'none'"
    )
}

/// The page as UTF-8 HTML.
pub fn page(input: &PageInput) -> String {
    let mut h = Html::default();
    h.raw("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    h.raw("<meta http-equiv=\"Content-Security-Policy\" content=\"").text(&policy(input)).raw("\">\n");
    h.raw("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    h.raw("<meta name=\"color-scheme\" content=\"light dark\">\n");
    h.raw("<title>").text(&input.title).raw("</title>\n<style>\n");
    h.raw(include_str!("page.css")).raw(viewer::STYLE).raw("</style>\n</head>\n<body>\n");
    h.raw("<a class=\"skip\" href=\"#main\">Skip to the answers</a>\n");
    header(&mut h, input);
    contents(&mut h, input);
    h.raw("<main id=\"main\">\n");
    input.chapters().iter().for_each(|(anchor, title, answer)| section(&mut h, anchor, title, answer));
    limits(&mut h, &input.limits);
    h.raw("</main>\n<footer><p>Made by weavelock. This file is complete: it loads nothing from elsewhere.</p></footer>\n");
    script(&mut h, &input.exhibits);
    h.raw("</body>\n</html>\n");
    h.into_text()
}

fn header(h: &mut Html, input: &PageInput) {
    h.raw("<header>\n<h1>")
        .text(&input.title)
        .raw("</h1>\n<p class=\"lead\">")
        .text(&input.lead)
        .raw("</p>\n");
    if let Answer::Given(c) = &input.verdict {
        headline(h, c);
    }
    h.raw("</header>\n");
    look(h, input);
}

/// The still pictures, in a place that the live view takes over.
fn look(h: &mut Html, input: &PageInput) {
    if input.exhibits.is_empty() {
        return pictures(h, &input.pictures);
    }
    h.raw("<div class=\"viewer\" id=\"viewer\" role=\"region\" aria-label=\"The parts in 3D\">\n<div class=\"still\">\n");
    pictures(h, &input.pictures);
    h.raw("</div>\n<noscript><p class=\"note\">Scripts are off: these pictures stand for the view in 3D.</p></noscript>\n</div>\n");
}

/// The exhibits as data and the script that shows them.
fn script(h: &mut Html, exhibits: &[Exhibit]) {
    if exhibits.is_empty() {
        return;
    }
    h.raw("<script type=\"application/json\" id=\"viewer-data\">");
    // Safe inside a script element by its making.
    h.data(&viewer::payload(exhibits));
    h.raw("</script>\n<script>").raw(viewer::SCRIPT).raw("</script>\n");
}

fn contents(h: &mut Html, input: &PageInput) {
    h.raw("<nav aria-label=\"Contents\">\n<ul>\n");
    for (anchor, title, answer) in input.chapters() {
        h.raw("<li><a href=\"#").text(anchor).raw("\">").text(title).raw("</a>");
        if matches!(answer, Answer::NotRun { .. }) {
            h.raw(" <span class=\"quiet\">(not run)</span>");
        }
        h.raw("</li>\n");
    }
    h.raw("<li><a href=\"#limits\">Limits</a></li>\n</ul>\n</nav>\n");
}

fn section(h: &mut Html, anchor: &str, title: &str, answer: &Answer<Chapter>) {
    h.raw("<section id=\"")
        .text(anchor)
        .raw("\" aria-labelledby=\"")
        .text(anchor)
        .raw("-title\">\n<h2 id=\"");
    h.text(anchor).raw("-title\">").text(title).raw("</h2>\n");
    match answer {
        Answer::Given(c) => chapter(h, c),
        Answer::NotRun { why } => {
            h.raw("<p class=\"quiet\"><strong>Not run.</strong> ").text(why).raw("</p>\n");
        }
    }
    h.raw("</section>\n");
}

fn chapter(h: &mut Html, c: &Chapter) {
    headline(h, c);
    for w in &c.words {
        h.raw("<p>").text(w).raw("</p>\n");
    }
    if c.pictures.is_empty() && !c.figure.is_empty() {
        h.raw("<pre>").text(&c.figure.join("\n")).raw("</pre>\n");
    }
    pictures(h, &c.pictures);
    if !c.facts.is_empty() {
        h.raw("<dl>\n");
        for (name, value) in &c.facts {
            h.raw("<div><dt>").text(name).raw("</dt><dd>").text(value).raw("</dd></div>\n");
        }
        h.raw("</dl>\n");
    }
    c.tables.iter().for_each(|t| table(h, t));
}

fn headline(h: &mut Html, c: &Chapter) {
    if c.headline.is_empty() {
        return;
    }
    let class = match c.tone {
        Tone::Good => "good",
        Tone::Bad => "bad",
        Tone::Undecided => "undecided",
        Tone::Plain => "plain",
    };
    h.raw("<p class=\"headline ").text(class).raw("\">");
    if c.tone != Tone::Plain {
        h.raw("<span class=\"mark\" aria-hidden=\"true\">")
            .text(c.tone.mark().encode_utf8(&mut [0; 4]))
            .raw("</span> ");
    }
    h.text(&c.headline).raw("</p>\n");
}

fn pictures(h: &mut Html, pictures: &[Picture]) {
    if pictures.is_empty() {
        return;
    }
    h.raw("<div class=\"pictures\">\n");
    for p in pictures {
        h.raw("<figure><img width=\"")
            .text(&p.width.to_string())
            .raw("\" height=\"")
            .text(&p.height.to_string());
        h.raw("\" alt=\"").text(&p.alt).raw("\" src=\"");
        h.image(&p.format).raw("\">");
        if !p.caption.is_empty() {
            h.raw("<figcaption>").text(&p.caption).raw("</figcaption>");
        }
        h.raw("</figure>\n");
    }
    h.raw("</div>\n");
}

/// A table in a box of its own, which a keyboard can reach and scroll where the screen is narrow.
fn table(h: &mut Html, t: &Table) {
    let label = if t.caption.is_empty() { "Table" } else { &t.caption };
    h.raw("<div class=\"table\" role=\"region\" tabindex=\"0\" aria-label=\"")
        .text(label)
        .raw("\">\n<table>\n");
    if !t.caption.is_empty() {
        h.raw("<caption>").text(&t.caption).raw("</caption>\n");
    }
    h.raw("<thead><tr>");
    for c in &t.head {
        h.raw(head_cell(c.align)).text(&c.title).raw("</th>");
    }
    h.raw("</tr></thead>\n<tbody>\n");
    for row in &t.rows {
        h.raw("<tr>");
        for (c, text) in t.cells(row) {
            h.raw(cell(text, c.align)).text(text).raw("</td>");
        }
        h.raw("</tr>\n");
    }
    if t.rows.is_empty() {
        h.raw("<tr><td colspan=\"").text(&t.head.len().max(1).to_string()).raw("\">None.</td></tr>\n");
    }
    h.raw("</tbody>\n</table>\n</div>\n");
}

fn head_cell(align: Align) -> &'static str {
    match align {
        Align::Left => "<th scope=\"col\">",
        Align::Right => "<th scope=\"col\" class=\"number\">",
    }
}

/// Words up to this many characters, ids among them, are not broken at their hyphens.
const SHORT: usize = 16;

fn cell(text: &str, align: Align) -> &'static str {
    match align {
        Align::Right => "<td class=\"number\">",
        Align::Left if text.chars().count() <= SHORT => "<td class=\"short\">",
        Align::Left => "<td>",
    }
}

fn limits(h: &mut Html, limits: &[String]) {
    h.raw("<section id=\"limits\" aria-labelledby=\"limits-title\">\n<h2 id=\"limits-title\">Limits</h2>\n");
    if limits.is_empty() {
        h.raw("<p>None stated.</p>\n");
    } else {
        h.raw("<ul>\n");
        for l in limits {
            h.raw("<li>").text(l).raw("</li>\n");
        }
        h.raw("</ul>\n");
    }
    h.raw("</section>\n");
}
