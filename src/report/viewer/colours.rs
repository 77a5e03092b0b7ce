//! Takes parts and the answers about them; gives the ways in which they can be coloured, each with its legend.
//!
//! Colours are those of `palette` (told apart by every kind of colour vision); every meaning is in the legend's words too.

use super::exhibit::Answers;
use crate::assembly::Assembly;
use crate::report::draw::palette::{COOL, OTHER, WARM, bytes_of_part};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;

pub type Rgb = [u8; 3];

/// One way to colour all parts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scheme {
    pub name: &'static str,
    /// Colour and meaning.
    pub legend: Vec<(Rgb, String)>,
    /// For each part.
    pub colours: Vec<Rgb>,
}

/// Parts that a scheme says nothing of.
const PALE: Rgb = [196, 196, 192];
const STRONG: Rgb = [205, 88, 24];
const SECOND: Rgb = [22, 92, 152];

/// The schemes that the answers allow; the first is how pictures are coloured.
pub fn schemes(asm: &Assembly, answers: &Answers) -> Vec<Scheme> {
    let all = [
        Some(parts(asm)),
        strands(asm),
        Some(shapes(asm)),
        answers.chirality.as_ref().and_then(|a| hands(asm, a)),
        answers.flex.as_ref().and_then(|a| flexible(asm, a)),
        answers.check.as_ref().and_then(|a| keys(asm, a)),
        Some(held(asm)).filter(|s| s.colours.contains(&SECOND)),
    ];
    all.into_iter().flatten().collect()
}

fn parts(asm: &Assembly) -> Scheme {
    let colours: Vec<Rgb> = asm.parts.iter().enumerate().map(|(k, p)| bytes_of_part(&p.id, k)).collect();
    let woven = asm.parts.iter().all(|p| p.id.starts_with("weft-") || p.id.starts_with("warp-"));
    let legend = if woven {
        vec![(WARM[0], "wefts: warm".into()), (COOL[0], "warps: cool".into())]
    } else if asm.parts.len() <= OTHER.len() {
        colours.iter().copied().zip(asm.parts.iter().map(|p| p.id.clone())).collect()
    } else {
        vec![]
    };
    Scheme { name: "part", legend, colours }
}

/// Pieces of one strand alike, neighbouring strands apart.
fn strands(asm: &Assembly) -> Option<Scheme> {
    let strand = |id: &str| id.split_once('/').map_or(id, |(s, _)| s).to_string();
    let number = |id: &str| strand(id).rsplit('-').next().and_then(|n| n.parse::<i64>().ok());
    let colour = |id: &str| {
        let table = if id.starts_with("weft-") { WARM } else { COOL };
        number(id).map(|n| table[n.rem_euclid(table.len() as i64) as usize])
    };
    let woven = asm.parts.iter().all(|p| p.id.starts_with("weft-") || p.id.starts_with("warp-"));
    let in_pieces = asm.parts.iter().any(|p| p.id.contains('/'));
    let colours: Option<Vec<Rgb>> = asm.parts.iter().map(|p| colour(&p.id)).collect();
    let legend = vec![(WARM[0], "wefts, four shades".into()), (COOL[0], "warps, four shades".into())];
    colours.filter(|_| woven && in_pieces).map(|colours| Scheme { name: "strand", legend, colours })
}

/// Congruent parts (those that share a solid) alike.
fn shapes(asm: &Assembly) -> Scheme {
    let mut count: BTreeMap<usize, usize> = BTreeMap::new();
    asm.parts.iter().for_each(|p| *count.entry(p.solid).or_default() += 1);
    let colour = |k: usize| OTHER[k % OTHER.len()];
    let legend: Vec<(Rgb, String)> =
        count.iter().enumerate().map(|(k, (_, n))| (colour(k), format!("shape {}: {n}", k + 1))).collect();
    let place: BTreeMap<usize, usize> = count.keys().enumerate().map(|(k, s)| (*s, k)).collect();
    let colours = asm.parts.iter().map(|p| colour(place[&p.solid])).collect();
    let legend = if legend.len() > OTHER.len() { vec![] } else { legend };
    Scheme { name: "shape", legend, colours }
}

fn hands(asm: &Assembly, answer: &Value) -> Option<Scheme> {
    let of: BTreeMap<&str, &str> = (answer["parts"].as_array()?.iter())
        .filter_map(|p| Some((p["id"].as_str()?, p["hand"].as_str()?)))
        .collect();
    let colour = |hand: Option<&&str>| match hand {
        Some(&"left") => STRONG,
        Some(&"right") => SECOND,
        _ => PALE,
    };
    let colours: Vec<Rgb> = asm.parts.iter().map(|p| colour(of.get(p.id.as_str()))).collect();
    let count = |c: Rgb| colours.iter().filter(|k| **k == c).count();
    let legend = vec![
        (STRONG, format!("left: {}", count(STRONG))),
        (SECOND, format!("right: {}", count(SECOND))),
        (PALE, format!("achiral, or not known: {}", count(PALE))),
    ];
    Some(Scheme { name: "hand", legend, colours })
}

fn ids(list: &Value) -> Vec<&str> {
    list.as_array().into_iter().flatten().filter_map(Value::as_str).collect()
}

fn picked(asm: &Assembly, name: &'static str, groups: [(Rgb, String, Vec<&str>); 2]) -> Option<Scheme> {
    let colour = |id: &str| groups.iter().find(|g| g.2.contains(&id)).map_or(PALE, |g| g.0);
    let colours: Vec<Rgb> = asm.parts.iter().map(|p| colour(&p.id)).collect();
    let used = groups.iter().filter(|g| !g.2.is_empty());
    let mut legend: Vec<(Rgb, String)> = used.map(|g| (g.0, g.1.clone())).collect();
    legend.push((PALE, "the others".into()));
    (legend.len() > 1).then_some(Scheme { name, legend, colours })
}

fn flexible(asm: &Assembly, answer: &Value) -> Option<Scheme> {
    let set = ids(answer["sets"].get(0)?);
    let core = ids(&answer["cores"][0]["parts"]);
    let words =
        format!("flexible: {} (one of {} such sets)", set.join(", "), answer["sets"].as_array()?.len());
    picked(asm, "flexible", [(STRONG, words, set), (SECOND, "locked among themselves".into(), core)])
}

fn keys(asm: &Assembly, answer: &Value) -> Option<Scheme> {
    let interlock = answer.get("interlock")?;
    let keys: Vec<&str> =
        interlock["keys"].as_array().into_iter().flatten().flat_map(|k| ids(&k["parts"])).collect();
    let core: Vec<&str> =
        interlock["cores"].as_array().into_iter().flatten().flat_map(|k| ids(&k["parts"])).collect();
    picked(
        asm,
        "keys",
        [(STRONG, "can start alone (keys)".into(), keys), (SECOND, "locked cores".into(), core)],
    )
}

fn held(asm: &Assembly) -> Scheme {
    let held: Vec<usize> = asm.held().map(|p| p.at()).collect();
    let colours = (0..asm.parts.len()).map(|k| if held.contains(&k) { SECOND } else { PALE }).collect();
    Scheme { name: "held", legend: vec![(SECOND, "held".into()), (PALE, "free".into())], colours }
}
