//! Takes XML text; gives its elements as a tree, each with its place.
//!
//! Promised: bounded depth and size; no entity is expanded but the five of XML and characters by number. Not promised:
//! text around child elements keeps its order; what stands inside `state` elements is passed over.

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};

/// Elements nest no deeper: a puzzle of 64 pieces nests its separations 64 deep, twice.
const DEEPEST: usize = 256;

/// More elements than this are refused: they would take a gigabyte.
const MOST_NODES: usize = 4_000_000;

/// An element.
#[derive(Clone, Debug, Default)]
pub struct Node {
    pub name: String,
    pub attributes: Vec<(String, String)>,
    pub text: String,
    pub children: Vec<Node>,
    /// Byte at which it starts.
    pub at: usize,
}

/// What keeps the text from being read: a byte, and why.
pub type Broken = (usize, String);

impl Node {
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str())
    }

    pub fn all<'n>(&'n self, name: &'n str) -> impl Iterator<Item = &'n Node> + 'n {
        self.children.iter().filter(move |c| c.name == name)
    }

    pub fn first(&self, name: &str) -> Option<&Node> {
        self.children.iter().find(|c| c.name == name)
    }
}

/// The root element, and what processing instructions say to this program.
pub fn read(text: &str) -> Result<(Node, Vec<String>), Broken> {
    let mut reader = Reader::from_str(text);
    let mut open: Vec<Node> = vec![Node::default()];
    let (mut count, mut told) = (0, Vec::new());
    loop {
        let at = reader.buffer_position() as usize;
        let event = reader.read_event().map_err(|e| (at, e.to_string()))?;
        match event {
            Event::Start(e) => {
                count += 1;
                let node = node(&e, at)?;
                if node.name == "state" {
                    reader.read_to_end(e.name()).map_err(|e| (at, e.to_string()))?;
                    give(&mut open, node);
                } else if open.len() > DEEPEST || count > MOST_NODES {
                    return Err((
                        at,
                        format!("more than {DEEPEST} elements inside each other, or {MOST_NODES} in all"),
                    ));
                } else {
                    open.push(node);
                }
            }
            Event::Empty(e) => {
                count += 1;
                give(&mut open, node(&e, at)?);
            }
            Event::End(_) => {
                let Some(done) = open.pop() else { break };
                give(&mut open, done);
            }
            Event::Text(t) => open.last_mut().map_or((), |n| n.text.push_str(&t)),
            Event::CData(t) => open.last_mut().map_or((), |n| n.text.push_str(&t)),
            Event::PI(p) if p.target() == "weavelock" => told.push(p.content().trim().to_string()),
            Event::Eof => break,
            _ => {}
        }
    }
    if let [_, .., inner] = open.as_slice() {
        return Err((text.len(), format!("the text ends inside <{}>", inner.name)));
    }
    let root = open.pop().and_then(|mut top| if top.children.len() == 1 { top.children.pop() } else { None });
    root.map(|root| (root, told)).ok_or((0, "one element is wanted around all others".into()))
}

fn give(open: &mut [Node], done: Node) {
    if let Some(around) = open.last_mut() {
        around.children.push(done);
    }
}

fn node(e: &BytesStart, at: usize) -> Result<Node, Broken> {
    let mut attributes = Vec::new();
    for a in e.attributes() {
        let a = a.map_err(|e| (at, e.to_string()))?;
        let value = a.normalized_value(XmlVersion::Implicit1_0).map_err(|e| (at, e.to_string()))?;
        attributes.push((a.key.as_ref().to_string(), value.into_owned()));
    }
    Ok(Node { name: e.name().as_ref().to_string(), attributes, at, ..Node::default() })
}
