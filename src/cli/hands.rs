//! Takes a weave or an assembly; tells its hands, and writes the assembly and its mirror image where that is asked.
//!
//! Not promised: anything beyond what `chirality` promises. What is told about written files was found on them as read
//! back.

use super::args::PuzzleArgs;
use super::load::{self, Placed};
use super::told::{News, Told, Trouble};
use crate::atlas;
use crate::chirality::answer::{
    Agreement, BothHands, Handedness, Hands, NeighboursAnswer, ShapeAnswer, TileAnswer, Touch, WarpIs,
};
use crate::chirality::twin::{self, TwinAnswer, Way};
use crate::chirality::{HandsError, of_assembly, of_weave};
use crate::contact::Origin;
use crate::fault::Fault;
use crate::report::content::{Chapter, Column, Table, Tone};
use crate::report::export;
use crate::report::file::write_whole;
use crate::spec::Subject;
use crate::watch::Watch;
use std::path::Path;

pub fn chirality(
    subject: &str,
    folder: Option<&Path>,
    puzzle: &PuzzleArgs,
    watch: &Watch,
) -> Result<Told, Trouble> {
    let path = Path::new(subject);
    if load::is_spec(path) {
        let placed = load::spec(path, puzzle, watch)?.joined()?;
        let hands = found(&placed)?;
        let twin = folder.map(|folder| exported(&placed, folder)).transpose()?;
        return Ok(told(&Hands { twin, ..hands }));
    }
    if folder.is_some() {
        let hint = "give a spec: `weavelock chirality plain.toml --export DIR`".into();
        return Err(argument("only an assembly can be exported, and a weave is endless".into(), hint));
    }
    let weave = load::weave(subject)?;
    let remarks = load::falls_apart(&weave);
    let hands = of_weave(&weave, &atlas::Settings::default().profile()).map_err(fault)?;
    let mut told = told(&Hands { name: subject.into(), ..hands });
    told.remarks.extend(remarks);
    Ok(told)
}

/// The answer for an assembly in place.
pub fn told_chirality(placed: &Placed) -> Result<Told, Trouble> {
    Ok(told(&found(placed)?))
}

fn found(placed: &Placed) -> Result<Hands, Trouble> {
    of_assembly(&placed.spec, &placed.joined).map_err(fault)
}

fn fault(e: HandsError) -> Trouble {
    argument(e.to_string(), "change rise, lift, cover or samples".into())
}

fn argument(what: String, hint: String) -> Trouble {
    Fault { file: String::new(), place: None, key: String::new(), what, hint }.into()
}

/// Good news: everything is decided, and no two sources disagree.
fn told(hands: &Hands) -> Told {
    let undecided = [hands.tile, hands.assembly].contains(&Some(Handedness::Undecided))
        || hands.warp_is == Some(WarpIs::Undecided)
        || hands.both_hands == Some(BothHands::Undecided)
        || hands.twin.as_ref().is_some_and(|t| t.relation == "undecided");
    let news = News::of(!undecided && hands.agreement != Agreement::Disagree);
    Told { remarks: hands.remarks.clone(), ..Told::new(news, hands, &hands.name, "Hands", chapter(hands)) }
}

/// Writes both ways of putting the parts together as specs and meshes, reads them back and compares them.
fn exported(placed: &Placed, folder: &Path) -> Result<TwinAnswer, Trouble> {
    std::fs::create_dir_all(folder).map_err(|e| {
        Trouble::Word(format!(
            "error: cannot make the folder {}: {e}\n  hint: name a folder that you may write to with --export",
            folder.display()
        ))
    })?;
    let mut files = Vec::new();
    let [given, mirrored] = [Way::Given, Way::Mirrored].map(|way| side(placed, way, folder, &mut files));
    let (given, mirrored) = (given?, mirrored?);
    let [here, there] = [&given, &mirrored].map(found);
    let (here, there) = (here?, there?);
    Ok(twin::twins(&given.spec, (&given.joined, &here), (&mirrored.joined, &there), files))
}

/// One of the two assemblies: written, then read back.
fn side(placed: &Placed, way: Way, folder: &Path, files: &mut Vec<String>) -> Result<Placed, Trouble> {
    let asm = &placed.joined.assembly;
    let mut put = |name: String, bytes: &[u8]| {
        write_whole(&folder.join(&name), bytes)?;
        files.push(name);
        Ok::<(), Trouble>(())
    };
    let word = way.word();
    let text = match (&placed.spec.subject, &placed.joined.origin) {
        (Subject::Woven(woven), Origin::Woven(built)) => twin::woven_spec(woven, asm, &built.pieces, way),
        (Subject::Meshes(meshes), _) => {
            let twin = if way == Way::Mirrored { twin::mirrored(asm) } else { asm.clone() };
            let names: Vec<String> = (0..asm.parts.len()).map(|k| format!("{word}.{k}.mm.obj")).collect();
            for (part, name) in twin.ids().zip(&names) {
                put(name.clone(), &export::obj(&twin, &[part]))?;
            }
            twin::mesh_spec(asm, meshes.tolerance_mm, &names, way)
        }
        (Subject::Woven(_), Origin::Meshes) => String::new(),
    };
    put(format!("{word}.toml"), text.as_bytes())?;
    let back =
        load::spec(&folder.join(format!("{word}.toml")), &PuzzleArgs::default(), &placed.watch)?.joined()?;
    let (asm, all) = (&back.joined.assembly, back.joined.assembly.ids().collect::<Vec<_>>());
    put(format!("{word}.mm.stl"), &export::stl(asm, &all))?;
    put(format!("{word}.mm.obj"), &export::obj(asm, &all))?;
    Ok(back)
}

fn chapter(a: &Hands) -> Chapter {
    let tile = a.tile.map(|t| match t {
        Handedness::Achiral => "The unit tile is its own mirror image.".to_string(),
        Handedness::Undecided => "The hand of the unit tile is undecided.".into(),
        hand => format!("The unit tile is chiral: a {} one.", lower(hand)),
    });
    let headline =
        tile.or_else(|| a.assembly.map(|h| format!("The assembly is {}.", lower(h)))).unwrap_or_default();
    let tone = match a.agreement {
        Agreement::Disagree => Tone::Undecided,
        _ if a.findings.is_empty() => Tone::Plain,
        _ => Tone::Undecided,
    };
    let tables = [shapes(&a.shapes), neighbours(&a.neighbours, a.twin.as_ref()), tiles(a.twin.as_ref())];
    Chapter {
        tone,
        headline,
        words: words(a),
        facts: facts(a),
        tables: tables.into_iter().flatten().collect(),
        ..Chapter::default()
    }
}

fn words(a: &Hands) -> Vec<String> {
    let warp = a.warp_is.map(|w| match w {
        WarpIs::Same => "The warp tile is the weft tile, turned.",
        WarpIs::Mirror => "The warp tile is the weft tile's mirror image.",
        WarpIs::Both => "The warp tile is the weft tile, turned or mirrored alike: one tile serves both.",
        WarpIs::Different => "The warp tile is another tile than the weft's.",
        WarpIs::Undecided => "How the warp tile follows from the weft's is undecided.",
    });
    let both = a.both_hands.map(|b| match b {
        BothHands::Needed => "Some shape is needed in both hands.",
        BothHands::NotNeeded => "No shape is needed in both hands.",
        BothHands::Undecided => "Whether some shape is needed in both hands is undecided.",
    });
    let twin = a.twin.as_ref().map(twin_words);
    let findings = a.findings.iter().map(|f| format!("Undecided at {}: {}.", f.at, f.what));
    let said = warp.into_iter().chain(both).map(str::to_string).chain(twin).chain(findings);
    said.chain([format!("Convention: {}.", a.convention)]).collect()
}

fn twin_words(t: &TwinAnswer) -> String {
    let tiles = match (&t.tiles, &t.why) {
        (Some(_), _) => "the same tiles fill both".to_string(),
        (None, why) => why.clone().unwrap_or_else(|| "the tiles differ".into()),
    };
    let first = match t.relation.as_str() {
        "mirror" => {
            format!("Two ways, mirror images of each other: {} and {}", lower(t.given), lower(t.mirrored))
        }
        "same" => "One way: the assembly is its own mirror image".into(),
        _ => "Whether the mirrored assembly is another one is undecided".into(),
    };
    format!("{first}; {tiles}.")
}

fn facts(a: &Hands) -> Vec<(String, String)> {
    let fact = |name: &str, value: String| (name.to_string(), value);
    let assembly = a.assembly.map(|h| fact(&format!("the assembly ({})", a.assembly_is), lower(h)));
    let twill = a.twill.map(|h| fact("the twill's diagonal", format!("{h:?}")));
    let agreement = fact("solids and draft", agreement(a.agreement).into());
    let group = a.cloth.as_ref().map(|c| {
        let all = &c.group.elements;
        let count = |f: &dyn Fn(&crate::chirality::answer::ElementAnswer) -> bool| {
            all.iter().filter(|e| f(e)).count()
        };
        let text = format!(
            "{} proper, {} improper; {} exchange wefts and warps, {} turn the cloth over; {} keep the cuts",
            count(&|e| e.proper),
            count(&|e| !e.proper),
            count(&|e| e.exchange),
            count(&|e| e.turned_over),
            count(&|e| e.keeps_cuts)
        );
        fact("symmetries of the weave, up to translations", text)
    });
    let tile = |t: &TileAnswer| {
        let all = &t.hand.evidence.isometries;
        let proper = all.iter().filter(|i| i.proper).count();
        let worst = all.iter().map(|i| i.residual).fold(0.0, f64::max);
        let text = format!(
            "{proper} proper, {} improper, found on the solid; residual {worst:.1e}",
            all.len() - proper
        );
        fact(&format!("isometries of {}", t.strand), text)
    };
    let tiles = a.tiles.iter().map(tile);
    assembly.into_iter().chain(twill).chain([agreement]).chain(group).chain(tiles).collect()
}

fn agreement(a: Agreement) -> &'static str {
    match a {
        Agreement::Agree => "agree",
        Agreement::SolidsAlone => "solids alone: there is no draft",
        Agreement::DraftAlone => "draft alone: a solid has too few clear corners to be searched",
        Agreement::Disagree => "DISAGREE, see the findings",
    }
}

/// Rows that a terminal shows.
const MOST_ROWS: usize = 24;

fn shapes(shapes: &[ShapeAnswer]) -> Option<Table> {
    let row = |s: &ShapeAnswer| {
        vec![lower(s.hand), short(&s.same), short(&s.mirrored), format!("{:.1e}", s.residual)]
    };
    let head = vec![
        Column::words("hand"),
        Column::words("parts"),
        Column::words("its mirror image"),
        Column::numbers("residual"),
    ];
    let rows = shapes.iter().take(MOST_ROWS).map(row).collect();
    (!shapes.is_empty()).then(|| Table { caption: "Parts of one shape".into(), head, rows })
}

fn short(ids: &[String]) -> String {
    let some = ids.iter().take(8).cloned().collect::<Vec<_>>().join(", ");
    if ids.len() > 8 { format!("{some} ... ({} in all)", ids.len()) } else { some }
}

fn neighbours(pairs: &[NeighboursAnswer], twin: Option<&TwinAnswer>) -> Option<Table> {
    let touch = |t: Touch| match t {
        Touch::Crossing => "cross",
        Touch::Beside => "side by side",
        Touch::EndToEnd => "end to end",
        Touch::Meshes => "touch",
    };
    let mirrored = |n: &NeighboursAnswer| {
        let same = twin.and_then(|t| t.neighbours.iter().find(|p| p.a == n.a && p.b == n.b));
        same.map_or(String::new(), |p| lower(p.mirrored))
    };
    let row = |n: &NeighboursAnswer| {
        vec![n.a.clone(), n.b.clone(), touch(n.touch).into(), lower(n.hand), mirrored(n)]
    };
    let mut head = ["part", "part", "they", "hand of the pair"].map(Column::words).to_vec();
    head.extend(twin.map(|_| Column::words("mirrored")));
    let caption = match pairs.len().checked_sub(MOST_ROWS) {
        Some(more) if more > 0 => format!("Neighbours (--json has {more} more)"),
        _ => "Neighbours".into(),
    };
    let rows = pairs.iter().take(MOST_ROWS).map(row).collect();
    (!pairs.is_empty()).then_some(Table { caption, head, rows })
}

fn tiles(twin: Option<&TwinAnswer>) -> Option<Table> {
    let fills = twin?.tiles.as_ref()?;
    let row = |f: &twin::FillAnswer| vec![f.place.clone(), f.by.clone()];
    let head = ["place in the mirrored assembly", "filled by the given tile"].map(Column::words).to_vec();
    Some(Table {
        caption: "The same tiles".into(),
        head,
        rows: fills.iter().take(MOST_ROWS).map(row).collect(),
    })
}

fn lower(hand: Handedness) -> String {
    format!("{hand:?}").to_lowercase()
}
