//! Takes markup of this program and strings of others; gives HTML in which the strings are text and never markup.

use super::content::{Format, harmless};
use super::viewer::base64;

/// Markup under construction. Only words of this program get in raw; a caller's string has no way around [`Html::text`].
#[derive(Default)]
pub(super) struct Html(String);

impl Html {
    pub fn raw(&mut self, markup: &'static str) -> &mut Html {
        self.0.push_str(markup);
        self
    }

    /// Safe between tags and inside double quotes.
    pub fn text(&mut self, text: &str) -> &mut Html {
        for c in text.chars() {
            match c {
                '&' => self.0.push_str("&amp;"),
                '<' => self.0.push_str("&lt;"),
                '>' => self.0.push_str("&gt;"),
                '"' => self.0.push_str("&quot;"),
                '\'' => self.0.push_str("&#39;"),
                '\n' => self.0.push('\n'),
                c => self.0.push(harmless(c)),
            }
        }
        self
    }

    /// Data of an element that is not markup; its maker sees to it that nothing in it ends the element.
    pub fn data(&mut self, json: &str) -> &mut Html {
        self.0.push_str(json);
        self
    }

    /// The source of an image.
    pub fn image(&mut self, format: &Format) -> &mut Html {
        let (kind, bytes): (&str, &[u8]) = match format {
            Format::Png(bytes) => ("data:image/png;base64,", bytes),
            Format::Svg(text) => ("data:image/svg+xml;base64,", text.as_bytes()),
        };
        self.0.push_str(kind);
        self.0.push_str(&base64(bytes));
        self
    }

    /// The finished markup.
    pub fn into_text(self) -> String {
        self.0
    }
}
