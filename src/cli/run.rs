//! Takes a spec; asks every question, writes the answers, parts, pictures and the page into a folder, tells the summary.
//!
//! Not promised: that a question which failed stops the others; it is told as not run, with the reason.

use super::args::Common;
use super::check;
use super::flex;
use super::hands;
use super::load::{self, Loaded, Placed};
use super::make;
use super::molded;
use super::package;
use super::paged;
use super::questions;
use super::repeats;
use super::told::{News, Told, Trouble};
use super::words;
use crate::assembly::PartIx;
use crate::repeats::Search;
use crate::report::answer;
use crate::report::content::{Answer, Chapter, Format, Picture};
use crate::report::draw::{Size, figures};
use crate::report::file::{file_can_be_made, write_whole};
use crate::report::page::{PageInput, page};
use crate::report::viewer::Answers;
use crate::spec::{Cut, Layout, Subject};
use crate::watch::{All, Watch};
use crate::weave::{Origin, Weave};
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};
use weavelock_fab::process::Route;
use weavelock_fab::report::Report;

pub fn example(common: &Common, watch: &Watch) -> Result<Told, Trouble> {
    everything(load::example(watch)?, Path::new("out"), common)
}

pub fn file(file: &Path, out: &Path, common: &Common, watch: &Watch) -> Result<Told, Trouble> {
    everything(load::spec(file, &common.puzzle, watch)?, out, common)
}

/// The mold that a page shows: of a part, as a process makes it (`None`: as the spec says).
pub struct MoldOf<'a> {
    pub part: &'a str,
    pub process: Option<&'a str>,
}

/// The page alone, without making parts; with the mold of one part where that is asked for.
pub fn report(
    file: &Path,
    out: &Path,
    mold: Option<MoldOf>,
    common: &Common,
    watch: &Watch,
) -> Result<Told, Trouble> {
    file_can_be_made(out)?;
    let placed = load::spec(file, &common.puzzle, watch)?.joined()?;
    let of = |m: MoldOf| {
        let part = questions::part(&placed.joined, m.part)?;
        Ok::<_, Trouble>((part, molded::route(&placed, part, m.process)?))
    };
    let mold = mold.map(of).transpose()?;
    let asked = ask(&placed, common)?;
    let none = || Answer::not_run("`weavelock fab` makes the parts");
    let mut input = input(&placed, &asked, None, none(), none());
    if let Some((part, route)) = mold {
        let (exhibits, chapter) = molded::exhibits(&placed, part, route)?;
        input.exhibits.extend(exhibits);
        input.molds = Answer::Given(chapter);
    }
    write_whole(out, page(&input).as_bytes())?;
    let headline = format!("The page is {}.", out.display());
    let chapter = Chapter { headline, ..Chapter::default() };
    let files = ReportAnswer { verb: "report", files: vec![out.display().to_string()] };
    Ok(Told::new(News::Good, &files, &placed.spec.name, "Page", chapter))
}

/// Answer of `report`.
#[derive(Serialize, JsonSchema)]
pub struct ReportAnswer {
    verb: &'static str,
    files: Vec<String>,
}

/// The answers of a run, each told or the reason why not.
struct Asked {
    weave: Option<Told>,
    check: Told,
    plan: Told,
    flex: Result<Told, String>,
    repeats: Result<Told, String>,
    chirality: Result<Told, String>,
    pictures: Vec<Picture>,
    remarks: Vec<String>,
}

/// More parts than this are not searched for flexible ones in a run: `flex` plans again and again, which grows with
/// the cube of the parts. The verb `flex` has no such limit.
const MOST_PARTS_FOR_FLEX: usize = 24;

/// Largest repetition that a run tries.
const MOST_REPEATS: u32 = 4;

fn ask(placed: &Placed, common: &Common) -> Result<Asked, Trouble> {
    let progress = |what: &str| {
        if !common.quiet {
            super::watch::say(&format!("{what} ..."));
        }
    };
    let asm = &placed.joined.assembly;
    progress("is it locked");
    let stage = placed.watch.stage("is it locked", "", All::Open);
    let check = placed.check();
    let pictures = pictures(placed, &check)?;
    let check = check::told(placed, &check, None);
    drop(stage);
    progress("how does it go together");
    let all: Vec<PartIx> = asm.ids().collect();
    let plan = questions::told_plan(placed, &questions::planned(placed, &all, 0.0));
    progress("does it need a flexible part");
    let flex = if asm.parts.len() <= MOST_PARTS_FOR_FLEX {
        flex::flexed(placed, &flex::Settings::default()).map(|a| flex::told(&a)).map_err(|t| t.to_string())
    } else {
        Err(format!("not searched for more than {MOST_PARTS_FOR_FLEX} parts in a run; `weavelock flex` does"))
    };
    let (weave, repeats, chirality) = woven(placed, &progress)?;
    let remarks = check.remarks.clone();
    Ok(Asked { weave, check, plan, flex, repeats, chirality, pictures, remarks })
}

type Woven = (Option<Told>, Result<Told, String>, Result<Told, String>);

fn woven(placed: &Placed, progress: &impl Fn(&str)) -> Result<Woven, Trouble> {
    let Subject::Woven(woven) = &placed.spec.subject else {
        let why = "an assembly of meshes has no weave".to_string();
        return Ok((None, Err(why.clone()), Err(why)));
    };
    progress("what does the weave say");
    let weave = questions::told_weave(&woven.weave, &name(&woven.weave));
    let phase = match woven.layout {
        Layout::Swatch { cut: Cut::Tiles, phase, .. } => phase,
        _ => 0,
    };
    let n = woven.weave.tile;
    let search = Search { wefts: n.1, warps: n.0, phases: vec![phase], most: MOST_REPEATS };
    let repeats =
        repeats::repeated(&woven.weave, &name(&woven.weave), &woven.profile, &search, &placed.watch);
    let repeats = repeats.map(|a| repeats::told(&a)).map_err(|t| t.to_string());
    let chirality = hands::told_chirality(placed).map_err(|t| t.to_string());
    Ok((Some(weave), repeats, chirality))
}

pub fn name(weave: &Weave) -> String {
    match &weave.origin {
        Origin::Abc { a, b, c } => format!("[{a},{b},{c}]"),
        Origin::Drawn => "the drawn draft".into(),
        Origin::Wif(path) => path.display().to_string(),
    }
}

/// Pixels of a picture on the page: wide enough for a column on a sharp screen.
const PICTURE: (u32, u32) = (1200, 900);

fn pictures(placed: &Placed, check: &crate::locking::Check) -> Result<Vec<Picture>, Trouble> {
    use crate::locking::Verdict;
    let asm = &placed.joined.assembly;
    let mut all = vec![figures::together(asm), figures::exploded(asm)];
    match &check.rigid {
        Verdict::Locked(stress) => all.push(figures::forces(asm, stress)),
        Verdict::Free(motion) => all.push(figures::moving(asm, motion)),
        Verdict::Undecided(_) => {}
    }
    let drawn = |f: &figures::Figure| {
        let size = Size::new(PICTURE.0, PICTURE.1).map_err(|e| Trouble::Word(format!("error: {e}")))?;
        f.picture(size).map_err(|e| Trouble::Word(format!("error: a picture: {e}")))
    };
    all.iter().map(drawn).collect()
}

fn everything(loaded: Loaded, out: &Path, common: &Common) -> Result<Told, Trouble> {
    writable(out)?;
    let placed = loaded.joined()?;
    let asked = ask(&placed, common)?;
    if !common.quiet {
        super::watch::say("making the parts ...");
    }
    let stage = placed.watch.stage("making the parts", "", All::Open);
    let folder = out.join("parts");
    let made = make::made(&placed, &folder)?;
    let fab = make::told_fab(&made, &folder);
    drop(stage);
    let cast = packaged(&placed, &made, &out.join("package"), common)?;
    let mut files = vec![folder.display().to_string()];
    files.extend(cast.iter().map(|_| out.join("package").display().to_string()));
    let mut keep = |name: &str, bytes: &[u8]| -> Result<(), Trouble> {
        let path = out.join(name);
        write_whole(&path, bytes)?;
        files.push(path.display().to_string());
        Ok(())
    };
    let as_made = plan_as_made(&placed, &asked, made.clearance.value);
    let more = [("fab", Some(&fab)), ("plan-as-made", as_made.as_ref())];
    let more = more.into_iter().filter_map(|(name, told)| Some((name, told?)));
    for (verb, told) in asked.all().into_iter().chain(more) {
        keep(&format!("{verb}.json"), format!("{}\n", told.json).as_bytes())?;
    }
    for (k, picture) in asked.pictures.iter().enumerate() {
        if let Format::Png(bytes) = &picture.format {
            keep(&format!("{}.png", ["together", "exploded", "witness"][k.min(2)]), bytes)?;
        }
    }
    let parts = Answer::Given(make::fab_chapter(&made, &folder, &[]));
    let ledger = Answer::Given(make::ledger_chapter(&made));
    let mut input = input(&placed, &asked, as_made.as_ref(), parts, ledger);
    let (exhibits, molds) = molded::of_cast(&placed, &made);
    input.exhibits.extend(exhibits);
    input.molds = molds.map_or(input.molds, Answer::Given);
    input.findings = Answer::Given(make::findings_chapter(&made));
    keep("report.html", page(&input).as_bytes())?;
    let fab = cast.unwrap_or(fab);
    Ok(summary(&placed, asked, as_made, fab, files, out))
}

/// Where something is cast, parts alone are of little use: then the whole package, with its molds.
fn packaged(placed: &Placed, made: &Report, out: &Path, common: &Common) -> Result<Option<Told>, Trouble> {
    if made.routes.iter().all(|r| r.process.route == Route::Print) {
        return Ok(None);
    }
    if !common.quiet {
        super::watch::say("making the molds ...");
    }
    package::of_run(placed, out).map(Some)
}

/// Where the parts as they touch do not go together: whether they do with the clearance that they are made with.
fn plan_as_made(placed: &Placed, asked: &Asked, clearance_mm: f64) -> Option<Told> {
    let all: Vec<PartIx> = placed.joined.assembly.ids().collect();
    (asked.plan.news == News::Other && clearance_mm > 0.0)
        .then(|| questions::told_plan(placed, &questions::planned(placed, &all, clearance_mm)))
}

/// Finds out before the work whether the folder can be written to.
fn writable(out: &Path) -> Result<(), Trouble> {
    let cannot = |e: std::io::Error| {
        Trouble::Word(format!(
            "error: cannot write to the folder {}: {e}\n  hint: name one that you may write to with --out",
            out.display()
        ))
    };
    std::fs::create_dir_all(out).map_err(cannot)?;
    let probe = out.join(format!(".weavelock-{}", std::process::id()));
    std::fs::write(&probe, b"").and_then(|()| std::fs::remove_file(&probe)).map_err(cannot)
}

impl Asked {
    fn all(&self) -> Vec<(&'static str, &Told)> {
        let mut all = vec![("check", &self.check), ("plan", &self.plan)];
        let more = [("flex", &self.flex), ("repeats", &self.repeats), ("chirality", &self.chirality)];
        all.extend(self.weave.iter().map(|t| ("weave", t)));
        all.extend(more.into_iter().filter_map(|(verb, told)| Some((verb, told.as_ref().ok()?))));
        all
    }
}

fn first_chapter(told: &Told) -> Answer<Chapter> {
    told.chapters.first().map_or(Answer::not_run("nothing was told"), |c| c.1.clone())
}

fn chapter(told: &Result<Told, String>) -> Answer<Chapter> {
    told.as_ref().map_or_else(|why| Answer::not_run(why.clone()), first_chapter)
}

/// What is not built; said wherever a whole run is told.
const LIMITS: [&str; 4] = [
    "A run makes the parts, and where something is cast the package with its molds; `weavelock fab` makes a package with plates, sheets and coupon of prints too.",
    "Turns, joint motions and moves that stop half way are searched with counted work: what is not found is not excluded.",
    "Locked is first order at zero clearance; `weavelock release` looks for the clearance that opens a lock.",
    "The tiles are those of the sampled sites; the check says whether its verdict holds for the curved bisectors too.",
];

fn answers(asked: &Asked, as_made: Option<&Told>) -> Answers {
    Answers {
        check: paged::json(Some(&asked.check)),
        plan: paged::json(Some(&asked.plan)),
        plan_as_made: paged::json(as_made),
        flex: paged::json(asked.flex.as_ref().ok()),
        chirality: paged::json(asked.chirality.as_ref().ok()),
    }
}

fn input(
    placed: &Placed,
    asked: &Asked,
    as_made: Option<&Told>,
    parts: Answer<Chapter>,
    ledger: Answer<Chapter>,
) -> PageInput {
    let none = || Answer::not_run("an assembly of meshes has no weave");
    PageInput {
        title: placed.spec.name.clone(),
        lead: lead(placed),
        pictures: asked.pictures.clone(),
        exhibits: paged::exhibits(placed, &answers(asked, as_made)),
        draft: asked.weave.as_ref().map_or_else(none, |t| with_drawing(placed, first_chapter(t))),
        verdict: first_chapter(&asked.check),
        plan: first_chapter(&asked.plan),
        blocking: paged::blocking(placed),
        molds: Answer::not_run(
            "`weavelock fab` makes molds for parts that are cast; `weavelock report --mold PART` shows one",
        ),
        flexible: chapter(&asked.flex),
        repeats: chapter(&asked.repeats),
        chirality: chapter(&asked.chirality),
        ledger,
        findings: Answer::not_run("`weavelock fab` makes the parts and tells what it finds"),
        parts,
        limits: LIMITS.map(String::from).to_vec(),
    }
}

/// The draft's drawing beside its words.
fn with_drawing(placed: &Placed, chapter: Answer<Chapter>) -> Answer<Chapter> {
    let (Answer::Given(mut chapter), Subject::Woven(woven)) = (chapter, &placed.spec.subject) else {
        return Answer::not_run("no weave");
    };
    let svg = crate::weave::svg(&woven.weave.draft);
    let alt = format!("The draft of {}.", name(&woven.weave));
    // The drawing scales; these only keep its place while the page loads.
    chapter.pictures =
        vec![Picture { format: Format::Svg(svg), width: 640, height: 400, alt, caption: String::new() }];
    Answer::Given(chapter)
}

fn lead(placed: &Placed) -> String {
    let asm = &placed.joined.assembly;
    let what = match &placed.spec.subject {
        Subject::Woven(woven) => format!("woven of {}", name(&woven.weave)),
        Subject::Meshes(meshes) if meshes.puzzle.is_some() => "of a puzzle".into(),
        Subject::Meshes(_) => "read from meshes".into(),
    };
    let unit = match &placed.spec.subject {
        Subject::Woven(_) => format!("a pitch of {} mm", asm.mm_per_unit),
        Subject::Meshes(_) => format!("a unit of {} mm", asm.mm_per_unit),
    };
    format!("{} parts {what}, {} contact patches, {unit}.", asm.parts.len(), placed.joined.patches.len())
}

/// Answer of `run`: what it wrote; the answers of the verbs are among the files.
#[derive(Serialize, JsonSchema)]
pub struct RunAnswer {
    verb: &'static str,
    name: String,
    verdict: answer::Word,
    files: Vec<String>,
}

fn summary(
    placed: &Placed,
    asked: Asked,
    as_made: Option<Told>,
    fab: Told,
    files: Vec<String>,
    out: &Path,
) -> Told {
    let verdict = match asked.check.news {
        News::Good => answer::Word::Locked,
        News::Other => words::verdict_word(&asked.check.json),
    };
    let news = News::of(asked.check.news == News::Good && fab.news == News::Good);
    let answer = RunAnswer { verb: "run", name: placed.spec.name.clone(), verdict, files };
    let mut chapters = vec![
        ("Does it lock?".to_string(), first_chapter(&asked.check)),
        ("How it goes together".into(), first_chapter(&asked.plan)),
        ("Flexible parts".into(), chapter(&asked.flex)),
        ("Repetition".into(), chapter(&asked.repeats)),
        ("Hands".into(), chapter(&asked.chirality)),
        ("Parts as made".into(), first_chapter(&fab)),
    ];
    chapters.extend(as_made.map(|told| ("How it goes together as made".into(), first_chapter(&told))));
    let page: PathBuf = out.join("report.html");
    let closing = vec![
        format!(
            "Read on: {}; answers as JSON beside it. Check a proof: weavelock verify {}",
            page.display(),
            out.join("check.json").display()
        ),
        format!("Limits: {}", LIMITS.join(" ")),
    ];
    let json = serde_json::to_string(&answer).unwrap_or_default();
    Told {
        news,
        json,
        title: placed.spec.name.clone(),
        lead: lead(placed),
        chapters,
        closing,
        remarks: asked.remarks,
        bare: None,
    }
}
