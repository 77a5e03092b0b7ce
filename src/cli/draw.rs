//! Takes an assembly in place and what is to be seen of it; writes a picture (PNG, SVG) or printable instructions (HTML).
//!
//! Not promised: a picture of what was not found; where there is no plan or mold, nothing is written and the reason told.

use super::load::Placed;
use super::molded;
use super::planned;
use super::questions::{argument, part};
use super::told::{News, Told, Trouble};
use crate::assembly::PartIx;
use crate::locking::Verdict;
use crate::report::content::{Chapter, Format, Picture, Tone};
use crate::report::draw::figures::{self, Figure};
use crate::report::draw::{
    Background, Colour, Opacity, Projection, Scene, Size, View, render, steps, vector,
};
use crate::report::file::{file_can_be_made, write_whole};
use crate::report::instructions::{self, Instructions, Need};
use clap::{Args, ValueEnum};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub struct Draw {
    pub file: PathBuf,
    /// tile (one part), assembly, exploded, witness (contact forces or motion), step=K (in the order of assembly), mold,
    /// or instructions (every step, to print)
    #[arg(long, value_parser = what, default_value = "assembly")]
    pub what: What,
    /// The part that `tile` or `mold` is about (default: the first)
    #[arg(long, value_name = "PART")]
    pub part: Option<String>,
    /// home, top, bottom, front, back, left, right, or degrees about z and above the horizon: `--view -62,38`
    #[arg(long, value_parser = view, default_value = "home", allow_hyphen_values = true)]
    pub view: View,
    /// Pixels: `--size 1600x1200`
    #[arg(long, value_parser = size, default_value = "1200x900")]
    pub size: Size,
    /// Parts to see through: `--ghost weft-0,warp-1`
    #[arg(long, value_name = "PARTS", value_delimiter = ',')]
    pub ghost: Vec<String>,
    /// The ground behind the parts
    #[arg(long, value_enum, default_value = "white")]
    pub ground: Ground,
    #[command(flatten)]
    pub plan: planned::Asked,
    /// How the mold is made
    #[arg(long, value_enum, default_value = "rigid")]
    pub route: molded::MoldRoute,
    /// The file to write; its ending says which kind: .png, .svg, or .html for instructions
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    Tile,
    Assembly,
    Exploded,
    Witness,
    Step(usize),
    Mold,
    Instructions,
}

#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    White,
    /// Transparent
    None,
}

fn what(text: &str) -> Result<What, String> {
    let step = text.strip_prefix("step=").map(|n| n.trim().parse::<usize>());
    match (text, step) {
        ("tile", _) => Ok(What::Tile),
        ("assembly", _) => Ok(What::Assembly),
        ("exploded", _) => Ok(What::Exploded),
        ("witness", _) => Ok(What::Witness),
        ("mold", _) => Ok(What::Mold),
        ("instructions", _) => Ok(What::Instructions),
        (_, Some(Ok(k))) if k > 0 => Ok(What::Step(k)),
        (_, Some(_)) => Err("steps are counted from 1, as in step=3".into()),
        _ => Err("give tile, assembly, exploded, witness, step=K, mold or instructions".into()),
    }
}

/// Azimuth and elevation of the named views, in degrees; seen without perspective, as in a drawing.
const NAMED: [(&str, f64, f64); 6] = [
    ("top", -90.0, 90.0),
    ("bottom", -90.0, -90.0),
    ("front", -90.0, 0.0),
    ("back", 90.0, 0.0),
    ("left", 180.0, 0.0),
    ("right", 0.0, 0.0),
];

fn view(text: &str) -> Result<View, String> {
    if text == "home" {
        return Ok(View::default());
    }
    if let Some((_, azimuth, elevation)) = NAMED.iter().find(|(name, ..)| *name == text) {
        return Ok(View { azimuth: *azimuth, elevation: *elevation, projection: Projection::Orthographic });
    }
    let wrong = || "give home, top, bottom, front, back, left, right, or two numbers as -62,38".to_string();
    let (a, e) = text.split_once(',').ok_or_else(wrong)?;
    let number = |t: &str| t.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(wrong);
    let (azimuth, elevation) = (number(a)?, number(e)?);
    if !(-90.0..=90.0).contains(&elevation) {
        return Err("the second number, above the horizon, is from -90 to 90".into());
    }
    Ok(View { azimuth, elevation, ..View::default() })
}

fn size(text: &str) -> Result<Size, String> {
    let wrong = || "give pixels as 1200x900".to_string();
    let (w, h) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let number = |t: &str| t.trim().parse::<u32>().map_err(|_| wrong());
    Size::new(number(w)?, number(h)?).map_err(|e| e.to_string())
}

/// What a file's ending asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Ending {
    Png,
    Svg,
    Html,
}

fn ending(asked: &Draw) -> Result<Ending, Trouble> {
    let text = asked.out.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    let sheet = asked.what == What::Instructions;
    match (text.as_deref(), sheet) {
        (Some("png"), false) => Ok(Ending::Png),
        (Some("svg"), false) => Ok(Ending::Svg),
        (Some("html" | "htm"), true) => Ok(Ending::Html),
        _ => {
            let hint =
                if sheet { "instructions are a page: end it in .html" } else { "end it in .png or .svg" };
            let what = format!("the kind of `{}` is not known for this drawing", asked.out.display());
            Err(argument(what, hint.into()).into())
        }
    }
}

/// Answer of `draw`.
#[derive(Serialize, JsonSchema)]
pub struct DrawAnswer {
    verb: String,
    files: Vec<String>,
    /// Why nothing was drawn.
    #[serde(skip_serializing_if = "Option::is_none")]
    not_drawn: Option<String>,
}

pub fn draw(placed: &Placed, asked: &Draw) -> Result<Told, Trouble> {
    let ending = ending(asked)?;
    file_can_be_made(&asked.out)?;
    let ghosts: Vec<PartIx> =
        asked.ghost.iter().map(|id| part(&placed.joined, id.trim())).collect::<Result<_, _>>()?;
    let asm = &placed.joined.assembly;
    let figure = match asked.what {
        What::Assembly => Ok(figures::together(asm)),
        What::Exploded => Ok(figures::exploded(asm)),
        What::Tile => Ok(figures::alone(asm, subject(placed, asked)?)),
        What::Witness => witness(placed),
        What::Mold => molded::figure(placed, subject(placed, asked)?, asked.route)?,
        What::Step(k) => step(placed, asked, k)?,
        What::Instructions => {
            return match sheet(placed, asked)? {
                Ok(html) => written(placed, asked, html.into_bytes()),
                Err(why) => Ok(nothing(placed, why)),
            };
        }
    };
    match figure {
        Err(why) => Ok(nothing(placed, why)),
        Ok(figure) => {
            let scene = staged(&figure, asked, &ghosts);
            let bytes = match ending {
                Ending::Png => render(&scene, asked.size).png(),
                _ => vector::svg(&scene, asked.size, &figure.alt).map(String::into_bytes),
            };
            written(placed, asked, bytes.map_err(|e| Trouble::Word(format!("error: {e}")))?)
        }
    }
}

fn subject(placed: &Placed, asked: &Draw) -> Result<PartIx, Trouble> {
    match &asked.part {
        Some(id) => part(&placed.joined, id.trim()),
        None => Ok(PartIx(0)),
    }
}

/// The scene of a figure from where and on what it was asked for.
fn staged(figure: &Figure, asked: &Draw, ghosts: &[PartIx]) -> Scene {
    let background = match asked.ground {
        Ground::White => Background::Plain(Colour::srgb([255; 3])),
        Ground::None => Background::Transparent,
    };
    let mut scene = Scene { background, view: asked.view, ..figure.scene.clone() };
    // Only where item `k` is part `k`: in the figures of the whole.
    if matches!(asked.what, What::Assembly | What::Exploded | What::Witness) {
        for p in ghosts {
            scene = scene.with(*p, Opacity::Ghost { alpha: SEEN_THROUGH });
        }
    }
    scene
}

/// What a part keeps that is seen through: enough to see what it is.
const SEEN_THROUGH: f64 = 0.3;

fn witness(placed: &Placed) -> Result<Figure, String> {
    let asm = &placed.joined.assembly;
    match placed.check().rigid {
        Verdict::Locked(stress) if stress.forces.is_empty() => {
            Err("nothing is free to move: there are no forces".into())
        }
        Verdict::Locked(stress) => Ok(figures::forces(asm, &stress)),
        Verdict::Free(motion) => Ok(figures::moving(asm, &motion)),
        Verdict::Undecided(gap) => {
            Err(format!("the verdict is undecided, so there is no witness: {}", gap.why))
        }
    }
}

fn step(placed: &Placed, asked: &Draw, k: usize) -> Result<Result<Figure, String>, Trouble> {
    let moves = planned::moves(placed, &asked.plan)?;
    let count = moves.moves.len();
    if count == 0 {
        return Ok(Err(planned::no_steps(&asked.plan, &moves)));
    }
    if k > count {
        let hint = format!("the plan has {count} steps: give 1 to {count}");
        return Err(argument(format!("there is no step {k}"), hint).into());
    }
    Ok(steps::step(&placed.joined.assembly, &moves.moves, k, asked.view)
        .ok_or_else(|| "there is no such step".into()))
}

/// Pixels of a panel: 90 mm at 170 dots per inch.
const PANEL: (u32, u32) = (600, 450);
/// More panels than this are a book: the page would be tens of megabytes.
const MOST_PANELS: usize = 240;

fn sheet(placed: &Placed, asked: &Draw) -> Result<Result<String, String>, Trouble> {
    let asm = &placed.joined.assembly;
    let found = planned::moves(placed, &asked.plan)?;
    let count = found.moves.len();
    if count == 0 {
        return Ok(Err(planned::no_steps(&asked.plan, &found)));
    }
    if count > MOST_PANELS {
        return Ok(Err(format!(
            "{count} steps are more than {MOST_PANELS} panels; draw single steps with --what step=K"
        )));
    }
    let panel = Size::new(PANEL.0, PANEL.1).map_err(|e| Trouble::Word(format!("error: {e}")))?;
    let drawn = |f: Figure| picture(f, asked.view, panel);
    let all = (1..=count).filter_map(|k| steps::step(asm, &found.moves, k, asked.view));
    let steps = all.map(drawn).collect::<Result<Vec<_>, _>>()?;
    let words = vec![planned::told(placed, &asked.plan, &found)];
    let title = format!("{}: how it goes together", asm.name);
    let whole = picture(figures::together(asm), asked.view, panel)?;
    let needs = needs(placed, panel)?;
    Ok(Ok(instructions::page(&Instructions { title, words, needs, whole, steps })))
}

fn picture(figure: Figure, view: View, size: Size) -> Result<Picture, Trouble> {
    let scene = Scene { background: Background::Plain(Colour::srgb([255; 3])), view, ..figure.scene };
    let png = render(&scene, size).png().map_err(|e| Trouble::Word(format!("error: a picture: {e}")))?;
    let (width, height) = (size.width(), size.height());
    Ok(Picture { format: Format::Png(png), width, height, alt: figure.alt, caption: figure.caption })
}

/// Each shape with the parts that have it.
fn needs(placed: &Placed, size: Size) -> Result<Vec<Need>, Trouble> {
    let asm = &placed.joined.assembly;
    let mut shapes: Vec<(usize, Vec<PartIx>)> = Vec::new();
    for p in asm.ids() {
        let solid = asm.part(p).solid;
        match shapes.iter_mut().find(|(s, _)| *s == solid) {
            Some((_, parts)) => parts.push(p),
            None => shapes.push((solid, vec![p])),
        }
    }
    let need = |(_, parts): &(usize, Vec<PartIx>)| {
        let ids = parts.iter().map(|&p| asm.part(p).id.clone()).collect();
        Ok(Need { picture: picture(figures::alone(asm, parts[0]), View::default(), size)?, ids })
    };
    shapes.iter().map(need).collect()
}

fn written(placed: &Placed, asked: &Draw, bytes: Vec<u8>) -> Result<Told, Trouble> {
    write_whole(&asked.out, &bytes)?;
    let file = asked.out.display().to_string();
    let chapter = Chapter { tone: Tone::Good, headline: format!("Drawn: {file}."), ..Chapter::default() };
    let answer = DrawAnswer { verb: "draw".into(), files: vec![file], not_drawn: None };
    Ok(Told::new(News::Good, &answer, &placed.joined.assembly.name, "Picture", chapter))
}

fn nothing(placed: &Placed, why: String) -> Told {
    let chapter = Chapter {
        tone: Tone::Undecided,
        headline: "Nothing was drawn.".into(),
        words: vec![why.clone()],
        ..Chapter::default()
    };
    let answer = DrawAnswer { verb: "draw".into(), files: vec![], not_drawn: Some(why) };
    Told::new(News::Other, &answer, &placed.joined.assembly.name, "Picture", chapter)
}

/// Whether a path names a file of this ending.
pub fn ends_in(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending))
}
