//! Takes the answer of `blocking`; gives its graphs as DOT (Graphviz) and GraphML.
//!
//! With a direction asked for: that one graph. Else first `ndbg`, an undirected graph of the cells of the sphere with an
//! edge where two bound one another, then each distinct blocking graph as a directed graph of its own, `dbg-K`.
//! Not promised: that a reader takes more than the first graph of a file; some do not.

use super::answer::{BlockingAnswer, NdbgAnswer};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};
use std::fmt::Write as _;
use std::io;

/// A graph in the words that both formats share.
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    pub id: String,
    pub directed: bool,
    pub nodes: Vec<Node>,
    /// Places of two nodes, and attributes.
    pub edges: Vec<(usize, usize, Attributes)>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    pub id: String,
    pub attributes: Attributes,
}

/// Name and value; names are those of `KEYS`.
pub type Attributes = Vec<(&'static str, String)>;

/// Every attribute: what it belongs to, its name and its type in GraphML.
const KEYS: [(&str, &str, &str); 11] = [
    ("node", "label", "string"),
    ("node", "held", "boolean"),
    ("node", "component", "int"),
    ("node", "leaves", "boolean"),
    ("node", "x", "double"),
    ("node", "y", "double"),
    ("node", "z", "double"),
    ("node", "dimension", "int"),
    ("node", "graph", "string"),
    ("node", "components", "int"),
    ("edge", "witness", "string"),
];

/// The graphs of an answer, in the order in which they are written.
pub fn graphs(answer: &BlockingAnswer) -> Vec<Graph> {
    if let Some(dbg) = &answer.dbg {
        let place = |id: &String| answer.parts.iter().position(|p| p == id);
        let arc = |a: &super::answer::ArcAnswer| {
            let witness = serde_json::to_string(&a.witness).unwrap_or_default();
            Some((place(&a.from)?, place(&a.to)?, vec![("witness", witness)]))
        };
        let nodes = parts(answer, &dbg.components, &dbg.leave);
        let edges = dbg.arcs.iter().filter_map(arc).collect();
        return vec![Graph { id: "dbg".into(), directed: true, nodes, edges }];
    }
    let Some(ndbg) = &answer.ndbg else { return Vec::new() };
    let each = ndbg.graphs.iter().enumerate().map(|(k, g)| Graph {
        id: format!("dbg-{k}"),
        directed: true,
        nodes: parts(answer, &g.components, &g.leave),
        edges: g.arcs.iter().map(|&[i, j]| (i, j, Vec::new())).collect(),
    });
    std::iter::once(sphere(ndbg)).chain(each).collect()
}

fn parts(answer: &BlockingAnswer, components: &[Vec<String>], leave: &[Vec<String>]) -> Vec<Node> {
    let node = |id: &String| {
        let component = components.iter().position(|c| c.contains(id)).unwrap_or(0);
        let attributes = vec![
            ("label", id.clone()),
            ("held", answer.held.contains(id).to_string()),
            ("component", component.to_string()),
            ("leaves", leave.iter().any(|s| s.contains(id)).to_string()),
        ];
        Node { id: id.clone(), attributes }
    };
    answer.parts.iter().map(node).collect()
}

fn sphere(ndbg: &NdbgAnswer) -> Graph {
    let node = |(k, c): (usize, &super::answer::CellAnswer)| {
        let [x, y, z] = c.direction.map(|v| v.to_string());
        let components = ndbg.graphs[c.graph].components.len().to_string();
        let attributes = vec![
            ("label", format!("cell {k}")),
            ("x", x),
            ("y", y),
            ("z", z),
            ("dimension", c.dimension.to_string()),
            ("graph", format!("dbg-{}", c.graph)),
            ("components", components),
        ];
        Node { id: format!("cell-{k}"), attributes }
    };
    Graph {
        id: "ndbg".into(),
        directed: false,
        nodes: ndbg.cells.iter().enumerate().map(node).collect(),
        edges: ndbg.beside.iter().map(|&[a, b]| (a, b, Vec::new())).collect(),
    }
}

/// All graphs as DOT, one after the other.
pub fn dot(graphs: &[Graph]) -> String {
    let mut out = String::new();
    for g in graphs {
        let (kind, arrow) = if g.directed { ("digraph", "->") } else { ("graph", "--") };
        let _ = writeln!(out, "{kind} {} {{", quoted(&g.id));
        for n in &g.nodes {
            let _ = writeln!(out, "  {}{};", quoted(&n.id), listed(&n.attributes));
        }
        for (i, j, attributes) in &g.edges {
            let (from, to) = (quoted(&g.nodes[*i].id), quoted(&g.nodes[*j].id));
            let _ = writeln!(out, "  {from} {arrow} {to}{};", listed(attributes));
        }
        out.push_str("}\n");
    }
    out
}

fn listed(attributes: &Attributes) -> String {
    let all: Vec<String> = attributes.iter().map(|(k, v)| format!("{k}={}", quoted(v))).collect();
    if all.is_empty() { String::new() } else { format!(" [{}]", all.join(", ")) }
}

/// A DOT string: quotes and backslashes escaped, line breaks as spaces.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace(['\n', '\r'], " "))
}

/// All graphs in one GraphML file.
pub fn graphml(graphs: &[Graph]) -> io::Result<Vec<u8>> {
    let mut w = Writer::new_with_indent(Vec::new(), b' ', 1);
    w.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let root = w.create_element("graphml").with_attribute(("xmlns", "http://graphml.graphdrawing.org/xmlns"));
    root.write_inner_content(|w| {
        for (about, name, kind) in KEYS {
            let key = [("id", name), ("for", about), ("attr.name", name), ("attr.type", kind)];
            w.create_element("key").with_attributes(key).write_empty()?;
        }
        graphs.iter().try_for_each(|g| one(w, g))
    })?;
    let mut bytes = w.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

fn one(w: &mut Writer<Vec<u8>>, g: &Graph) -> io::Result<()> {
    let kind = if g.directed { "directed" } else { "undirected" };
    let graph = w.create_element("graph").with_attributes([("id", g.id.as_str()), ("edgedefault", kind)]);
    graph.write_inner_content(|w| {
        for n in &g.nodes {
            let node = w.create_element("node").with_attribute(("id", n.id.as_str()));
            node.write_inner_content(|w| data(w, &n.attributes))?;
        }
        for (i, j, attributes) in &g.edges {
            let ends = [("source", g.nodes[*i].id.as_str()), ("target", g.nodes[*j].id.as_str())];
            let edge = w.create_element("edge").with_attributes(ends);
            edge.write_inner_content(|w| data(w, attributes))?;
        }
        Ok(())
    })?;
    Ok(())
}

fn data(w: &mut Writer<Vec<u8>>, attributes: &Attributes) -> io::Result<()> {
    for (key, value) in attributes {
        let data = w.create_element("data").with_attribute(("key", *key));
        data.write_text_content(BytesText::new(value))?;
    }
    Ok(())
}
