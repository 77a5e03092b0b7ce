//! Takes [[piece]] tables and `held`; gives pieces that do not overlap, their ids, and which are held.
//!
//! Promised: ids are unique and every held id is one of them. Not promised: that pieces touch.

use super::read::home;
use super::reader::{Field, Reader, nearest};
use super::woven::MAX_INDEX;
use super::{HeldSpec, PieceSpec};
use crate::fault::quoted;
use crate::weave::{Kind, Strand};
use std::collections::{BTreeMap, BTreeSet};

/// The ids of pieces, in their order: the strand's, with `/N` appended where it has several, N counting along it.
pub fn piece_ids(pieces: &[PieceSpec]) -> Vec<String> {
    let mut strands: BTreeMap<Strand, Vec<usize>> = BTreeMap::new();
    for (at, piece) in pieces.iter().enumerate() {
        strands.entry(piece.strand).or_default().push(at);
    }
    let mut ids = vec![String::new(); pieces.len()];
    for (strand, mut along) in strands {
        along.sort_by_key(|&at| (pieces[at].from, at));
        for (number, &at) in along.iter().enumerate() {
            ids[at] = if along.len() == 1 { strand.to_string() } else { format!("{strand}/{number}") };
        }
    }
    ids
}

/// The pieces, and those that say `held = true` with the field that says so.
pub fn pieces<'t>(
    reader: &mut Reader<'t>,
    field: &Field<'t>,
) -> Option<(Vec<PieceSpec>, BTreeMap<usize, Field<'t>>)> {
    let items = reader.list(field, "each piece is a table [[piece]]")?;
    if items.is_empty() {
        reader.fault(field, "is empty", "an assembly has at least one piece");
        return None;
    }
    let read: Vec<_> = items.iter().map(|item| piece(reader, item)).collect();
    let known = read.iter().enumerate().filter_map(|(at, piece)| Some((at, piece.as_ref()?.0))).collect();
    let apart = apart(reader, &items, &known);
    let all: Vec<_> = read.into_iter().collect::<Option<_>>()?;
    let pieces: Vec<PieceSpec> = all.iter().map(|(piece, _)| *piece).collect();
    let held = all.into_iter().enumerate().filter_map(|(at, (_, held))| Some((at, held?))).collect();
    apart.then_some((pieces, held))
}

fn piece<'t>(reader: &mut Reader<'t>, item: &Field<'t>) -> Option<(PieceSpec, Option<Field<'t>>)> {
    let fields = reader.table(item)?;
    reader.only(&fields, &["weft", "warp", "from", "to", "held"], home);
    let strand = match (reader.get(&fields, "weft"), reader.get(&fields, "warp")) {
        (Some(_), Some(warp)) => {
            reader.fault(&warp, "stands beside `weft`", "a piece lies on one strand");
            None
        }
        (Some(weft), None) => index(reader, &weft).map(|index| Strand { kind: Kind::Weft, index }),
        (None, Some(warp)) => index(reader, &warp).map(|index| Strand { kind: Kind::Warp, index }),
        (None, None) => reader.lacks(&fields, "", "lies on no strand", "say weft = 0 or warp = 0"),
    };
    let mut end = |key: &str| match reader.get(&fields, key) {
        Some(field) => index(reader, &field),
        None => reader.lacks(&fields, key, "is missing", "a piece reaches from one crossing up to another"),
    };
    let (from, to) = (end("from"), end("to"));
    let held = reader.get(&fields, "held").map(|field| reader.flag(&field).map(|flag| flag.then_some(field)));
    let (from, to) = (from?, to?);
    if from >= to {
        let what = format!("reaches from {from} to {to}");
        reader.fault(item, what, "`from` must be less than `to`, which is not included");
        return None;
    }
    Some((PieceSpec { strand: strand?, from, to }, held.unwrap_or(Some(None))?))
}

fn index<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<i32> {
    reader
        .integer(field, -MAX_INDEX..=MAX_INDEX, "strands and crossings are counted by whole numbers")
        .map(|n| n as i32)
}

/// Notes pieces that overlap others of their strand; whether there are none.
fn apart<'t>(reader: &mut Reader<'t>, items: &[Field<'t>], pieces: &BTreeMap<usize, PieceSpec>) -> bool {
    let mut order: Vec<usize> = pieces.keys().copied().collect();
    order.sort_by_key(|at| (pieces[at].strand, pieces[at].from, *at));
    let mut clean = true;
    let mut reach: Option<usize> = None;
    for at in order {
        let here = pieces[&at];
        let before = reach.filter(|&before| pieces[&before].strand == here.strand);
        if let Some(before) = before.filter(|&before| here.from < pieces[&before].to) {
            let (late, early) = (at.max(before), at.min(before));
            let what = format!("overlaps piece[{early}] on {}", here.strand);
            reader.fault(&items[late], what, "two pieces cannot be in one place; `to` is not included");
            clean = false;
        }
        reach = before.filter(|&before| pieces[&before].to > here.to).or(Some(at));
    }
    clean
}

/// Which parts are held by a list of ids or "rim"; with the fields of the ids.
pub fn held_list<'t>(reader: &mut Reader<'t>, field: &Field<'t>) -> Option<(HeldSpec, Vec<Field<'t>>)> {
    let hint = "a list of part ids, as in held = [\"weft-0\"], or \"rim\" for every part at the edge";
    match field.as_text() {
        Some("rim") => return Some((HeldSpec::Rim, Vec::new())),
        Some(word) => {
            reader.fault(field, format!("{} is neither a list nor \"rim\"", quoted(word)), hint);
            return None;
        }
        None => {}
    }
    let items = reader.list(field, hint)?;
    let ids: Vec<Option<&str>> = items.iter().map(|item| reader.text(item, hint)).collect();
    let ids = ids.into_iter().collect::<Option<Vec<_>>>()?;
    let mut seen = BTreeSet::new();
    for (id, item) in ids.iter().zip(&items).filter(|(id, _)| !seen.insert(**id)) {
        reader.fault(item, format!("{} stands twice", quoted(id)), "name each held part once");
    }
    let held = match ids.is_empty() {
        true => HeldSpec::None,
        false => HeldSpec::Parts(ids.into_iter().map(str::to_string).collect()),
    };
    (seen.len() == items.len()).then_some((held, items))
}

/// Which pieces are held: by their own flags (`flags`, by index), and by a list or "rim" (`outer`, from
/// [`held_list`]).
pub fn held_pieces<'t>(
    reader: &mut Reader<'t>,
    pieces: &[PieceSpec],
    flags: BTreeMap<usize, Field<'t>>,
    outer: Option<(HeldSpec, Vec<Field<'t>>)>,
) -> Option<HeldSpec> {
    let ids = piece_ids(pieces);
    let (held, items) = outer.unwrap_or((HeldSpec::None, Vec::new()));
    let mut named: BTreeSet<String> = flags.keys().map(|&at| ids[at].clone()).collect();
    match held {
        HeldSpec::Rim if flags.is_empty() => return Some(HeldSpec::Rim),
        HeldSpec::Rim => {
            let hint = "either every part at the edge, or the ones named";
            flags.values().for_each(|flag| reader.fault(flag, "stands beside held = \"rim\"", hint));
            return None;
        }
        HeldSpec::Parts(parts) => {
            exist(reader, &parts, &items, &ids)?;
            named.extend(parts);
        }
        HeldSpec::None => {}
    }
    let in_order: Vec<String> = ids.into_iter().filter(|id| named.contains(id)).collect();
    Some(if in_order.is_empty() { HeldSpec::None } else { HeldSpec::Parts(in_order) })
}

/// Ids among which one that was meant is looked for.
const GUESSED: usize = 100;

fn exist(reader: &mut Reader<'_>, parts: &[String], items: &[Field<'_>], ids: &[String]) -> Option<()> {
    let known: BTreeSet<&str> = ids.iter().map(String::as_str).collect();
    let mut all = Some(());
    for (part, item) in parts.iter().zip(items).filter(|(part, _)| !known.contains(part.as_str())) {
        let few = &ids[..ids.len().min(GUESSED)];
        let near = nearest(part, &few.iter().map(String::as_str).collect::<Vec<_>>());
        let first = || format!("parts are named as {}", quoted(&ids[0]));
        let hint = near.map_or_else(first, |near| format!("did you mean {}?", quoted(near)));
        reader.fault(item, format!("there is no part {}", quoted(part)), hint);
        all = None;
    }
    all
}
