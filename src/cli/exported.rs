//! Takes an assembly in place; writes it for other programs: meshes as they touch, the plan as an animation, tables.
//!
//! Not promised: curved surfaces in STEP; its faces are the facets.

use super::draw::ends_in;
use super::load::Placed;
use super::planned;
use super::questions::argument;
use super::told::{News, Told, Trouble};
use crate::assembly::PartIx;
use crate::report::content::{Chapter, Tone};
use crate::report::export::{self, glb, step, tables};
use crate::report::file::write_whole;
use crate::report::moves::Moves;
use crate::spec::Subject;
use crate::weave;
use clap::{Args, ValueEnum};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub struct Export {
    pub file: PathBuf,
    /// The format (default: by the ending of --out, else stl)
    #[arg(long = "as", value_enum, value_name = "FORMAT")]
    pub format: Option<Format>,
    /// One file with all parts in place, or a file for each part (stl, obj, ply)
    #[arg(long, value_enum, default_value = "parts")]
    pub layout: Together,
    #[command(flatten)]
    pub plan: planned::Asked,
    /// Leave the plan out of a glb or csv: no search
    #[arg(long)]
    pub still: bool,
    /// A folder, or a file whose ending is a format: `--out plain.glb`
    #[arg(long, default_value = "export")]
    pub out: PathBuf,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Triangles, f32
    Stl,
    /// Polygons, f64, a group for each part
    Obj,
    /// Polygons, f64, the number of its part on each face
    Ply,
    /// Binary glTF 2.0: named nodes, the plan as an animation
    Glb,
    /// 3MF, an object for each part
    #[value(name = "3mf")]
    ThreeMf,
    /// STEP AP214: solids with flat faces, named
    Step,
    /// Tables: parts, contacts, steps of the plan
    Csv,
    /// The draft of a woven assembly, WIF 1.1
    Wif,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Together {
    /// A file for each part
    Parts,
    /// One file
    Whole,
}

const ENDINGS: [(Format, &str); 8] = [
    (Format::Stl, "stl"),
    (Format::Obj, "obj"),
    (Format::Ply, "ply"),
    (Format::Glb, "glb"),
    (Format::ThreeMf, "3mf"),
    (Format::Step, "step"),
    (Format::Csv, "csv"),
    (Format::Wif, "wif"),
];

fn ending(format: Format) -> &'static str {
    ENDINGS.iter().find(|e| e.0 == format).map_or("", |e| e.1)
}

/// Answer of `export`.
#[derive(Serialize, JsonSchema)]
pub struct ExportAnswer {
    verb: String,
    /// Of the lengths in the files.
    unit: String,
    files: Vec<String>,
}

/// Name and bytes of each file.
type Files = Vec<(String, Vec<u8>)>;

pub fn export(placed: &Placed, asked: &Export) -> Result<Told, Trouble> {
    let named = ENDINGS.iter().find(|e| ends_in(&asked.out, e.1)).map(|e| e.0);
    ending_is_known(asked, named)?;
    let single =
        named.is_some() && asked.format.is_none_or(|f| Some(f) == named) && named != Some(Format::Csv);
    let format = asked.format.or(named).unwrap_or(Format::Stl);
    let layout = if single { Together::Whole } else { asked.layout };
    let mut files = bytes(placed, asked, format, layout)?;
    let mut folder = asked.out.clone();
    if let (true, [(name, _)]) = (single, files.as_mut_slice()) {
        *name = asked.out.file_name().unwrap_or_default().to_string_lossy().into_owned();
        folder = asked.out.parent().unwrap_or(Path::new("")).to_path_buf();
    }
    if folder != Path::new("") {
        make_folder(&folder)?;
    }
    for (name, bytes) in &files {
        write_whole(&folder.join(name), bytes)?;
    }
    let names: Vec<String> = files.into_iter().map(|f| f.0).collect();
    let place = if folder == Path::new("") { ".".into() } else { folder.display().to_string() };
    let unit = if format == Format::Glb { "m" } else { "mm" };
    let headline = match names.len() {
        1 => format!("{} in {place}, in {unit}, in place.", names[0]),
        n => format!("{n} files in {place}, in {unit}, in place."),
    };
    let chapter = Chapter { tone: Tone::Good, headline, words: names.clone(), ..Chapter::default() };
    let answer = ExportAnswer { verb: "export".into(), unit: unit.into(), files: names };
    Ok(Told::new(News::Good, &answer, &placed.joined.assembly.name, "Files", chapter))
}

/// Refuses a name that reads like a file of another format: it would become a folder.
fn ending_is_known(asked: &Export, named: Option<Format>) -> Result<(), Trouble> {
    let all = || ENDINGS.map(|e| e.1).join(", ");
    let ending = asked.out.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let what = match (asked.format, named) {
        (None, None) if !ending.is_empty() && !asked.out.is_dir() => {
            format!("`{}` ends in no format that is written", asked.out.display())
        }
        (Some(format), Some(other)) if format != other && !asked.out.is_dir() => {
            format!("`{}` does not end as {} does", asked.out.display(), self::ending(format))
        }
        _ => return Ok(()),
    };
    let hint = format!("formats are {}; a folder is named without an ending, with --as FORMAT", all());
    Err(argument(what, hint).into())
}

fn make_folder(folder: &Path) -> Result<(), Trouble> {
    std::fs::create_dir_all(folder).map_err(|e| {
        Trouble::Word(format!(
            "error: cannot make the folder {}: {e}\n  hint: name a folder that you may write to with --out",
            folder.display()
        ))
    })
}

fn bytes(placed: &Placed, asked: &Export, format: Format, layout: Together) -> Result<Files, Trouble> {
    let asm = &placed.joined.assembly;
    let all: Vec<PartIx> = asm.ids().collect();
    let stem = asm.name.replace(['/', '\\'], "-");
    let one = |bytes: Vec<u8>| vec![(format!("{stem}.{}", ending(format)), bytes)];
    Ok(match format {
        Format::Stl | Format::Obj | Format::Ply => meshes(placed, format, layout),
        Format::Glb => one(glb::glb(asm, &plan(placed, asked)?.moves)),
        Format::ThreeMf => {
            one(export::threemf(asm, &all).map_err(|e| Trouble::Word(format!("error: 3MF: {e}")))?)
        }
        Format::Step => one(step::step(asm, &all).map_err(|open| {
            argument(open.to_string(), "write it as obj or ply, which keep open surfaces".into())
        })?),
        Format::Csv => csv(placed, asked)?,
        Format::Wif => match &placed.spec.subject {
            Subject::Woven(woven) => one(weave::to_wif(&woven.weave.draft, &asm.name).into_bytes()),
            Subject::Meshes(_) => {
                let hint = "give a woven spec, or another format".to_string();
                return Err(
                    argument("an assembly of meshes has no draft to write as WIF".into(), hint).into()
                );
            }
        },
    })
}

fn plan(placed: &Placed, asked: &Export) -> Result<Moves, Trouble> {
    if asked.still { Ok(Moves::default()) } else { planned::moves(placed, &asked.plan) }
}

fn csv(placed: &Placed, asked: &Export) -> Result<Files, Trouble> {
    let asm = &placed.joined.assembly;
    let ids: Vec<&str> = asm.parts.iter().map(|p| p.id.as_str()).collect();
    let mut files = vec![
        ("parts.csv".to_string(), tables::parts(&placed.joined).into_bytes()),
        ("contacts.csv".into(), tables::contacts(&placed.joined).into_bytes()),
    ];
    if !asked.still {
        let moves = plan(placed, asked)?.moves;
        files.push(("steps.csv".into(), tables::steps(&moves, &ids, asm.mm_per_unit).into_bytes()));
    }
    Ok(files)
}

fn meshes(placed: &Placed, format: Format, layout: Together) -> Files {
    let asm = &placed.joined.assembly;
    let groups: Vec<(String, Vec<PartIx>)> = match layout {
        Together::Whole => vec![(asm.name.clone(), asm.ids().collect())],
        Together::Parts => asm.ids().map(|p| (asm.part(p).id.clone(), vec![p])).collect(),
    };
    let file = |(name, parts): (String, Vec<PartIx>)| {
        // STL has no unit, so the name says it.
        let file = format!("{}.mm.{}", name.replace(['/', '\\'], "-"), ending(format));
        let bytes = match format {
            Format::Obj => export::obj(asm, &parts),
            Format::Ply => export::ply(asm, &parts),
            _ => export::stl(asm, &parts),
        };
        (file, bytes)
    };
    groups.into_iter().map(file).collect()
}
