//! Takes the shapes of an assembly and a picture for each step; gives a page to print: what is needed, then one step a
//! panel, six to a sheet, pictures before words.
//!
//! Promised: as `page`, strings are text; nothing is loaded or run. Not promised: that a step can be done.

use super::content::Picture;
use super::html::Html;

/// A shape and how often it is needed.
#[derive(Clone, Debug, PartialEq)]
pub struct Need {
    pub picture: Picture,
    pub ids: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Instructions {
    pub title: String,
    /// What is to be known before: how firm the plan is, what bends.
    pub words: Vec<String>,
    pub needs: Vec<Need>,
    /// What it becomes.
    pub whole: Picture,
    /// In the order of assembly.
    pub steps: Vec<Picture>,
}

const POLICY: &str =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'";

/// Most ids listed beside a shape.
const MOST_IDS: usize = 12;

pub fn page(all: &Instructions) -> String {
    let mut h = Html::default();
    h.raw("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    h.raw("<meta http-equiv=\"Content-Security-Policy\" content=\"").text(POLICY).raw("\">\n");
    h.raw("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>")
        .text(&all.title);
    h.raw("</title>\n<style>\n").raw(include_str!("instructions.css")).raw("</style>\n</head>\n<body>\n");
    h.raw("<header><div>\n<h1>").text(&all.title).raw("</h1>\n");
    for w in &all.words {
        h.raw("<p>").text(w).raw("</p>\n");
    }
    h.raw("</div>\n");
    figure(&mut h, &all.whole);
    h.raw("</figure></header>\n");
    h.raw("<section class=\"needs\" aria-label=\"What is needed\">\n");
    for need in &all.needs {
        figure(&mut h, &need.picture);
        h.raw("<figcaption><strong>").text(&format!("{} ×", need.ids.len())).raw("</strong> ");
        h.text(&listed(&need.ids)).raw("</figcaption></figure>\n");
    }
    h.raw("</section>\n<ol class=\"steps\">\n");
    for (k, step) in all.steps.iter().enumerate() {
        h.raw("<li><span class=\"number\" aria-hidden=\"true\">").text(&(k + 1).to_string()).raw("</span>");
        figure(&mut h, step);
        h.raw("<figcaption>").text(&step.caption).raw("</figcaption></figure></li>\n");
    }
    h.raw("</ol>\n</body>\n</html>\n");
    h.into_text()
}

fn figure(h: &mut Html, p: &Picture) {
    h.raw("<figure><img width=\"").text(&p.width.to_string()).raw("\" height=\"").text(&p.height.to_string());
    h.raw("\" alt=\"").text(&p.alt).raw("\" src=\"").image(&p.format).raw("\">");
}

fn listed(ids: &[String]) -> String {
    let first = ids.iter().take(MOST_IDS).cloned().collect::<Vec<_>>().join(", ");
    if ids.len() > MOST_IDS { format!("{first} and {} more", ids.len() - MOST_IDS) } else { first }
}
