//! Takes the command line; gives what was asked for, typed.
//!
//! Not promised: that files exist or hold what they should; the verbs find out.

#![allow(
    rustdoc::broken_intra_doc_links,
    reason = "these texts are help for a terminal; brackets are no links"
)]

use clap::{Args as ClapArgs, Parser, Subcommand};
use std::path::PathBuf;

/// Decides whether an assembly of solid parts locks, proves it, plans how it goes together, makes its parts.
///
/// Without a verb: the embedded example (the paper's plain 2 x 2), everything, into out/.
/// Exit code 0: good news for the verb; 1: answered otherwise; 2: bad input, or a fault of ours.
#[derive(Parser, Debug)]
#[command(name = "weavelock", version, max_term_width = 100)]
pub struct Args {
    #[command(subcommand)]
    pub verb: Option<Verb>,
    #[command(flatten)]
    pub common: Common,
}

#[derive(ClapArgs, Debug, Clone)]
pub struct Common {
    /// Print one JSON object instead of words
    #[arg(long, global = true)]
    pub json: bool,
    /// No remarks on stderr
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Threads to use (default: one for each core); answers do not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    #[command(flatten)]
    pub puzzle: PuzzleArgs,
}

/// What is asked about in a puzzle file of BurrTools, which every verb takes that takes a file.
#[derive(ClapArgs, Debug, Clone, Default)]
pub struct PuzzleArgs {
    /// Of a puzzle file: the problem asked about, from 1 (default: the first with a solution): `--problem 2`
    #[arg(long, global = true, value_name = "N", help_heading = "Puzzle files", value_parser = counted)]
    pub problem: Option<usize>,
    /// Of a puzzle file: the stated solution asked about, from 1 (default: the first): `--solution 3`
    #[arg(long, global = true, value_name = "N", help_heading = "Puzzle files", value_parser = counted)]
    pub solution: Option<usize>,
    /// Of a puzzle file: edge of a voxel (default: 1 mm): `--unit "10 mm"`
    #[arg(long, global = true, value_name = "LENGTH", help_heading = "Puzzle files", value_parser = edge)]
    pub unit: Option<f64>,
}

impl PuzzleArgs {
    /// Whether anything was said.
    pub fn some(&self) -> Option<&PuzzleArgs> {
        (self.problem.is_some() || self.solution.is_some() || self.unit.is_some()).then_some(self)
    }
}

#[derive(Subcommand, Debug)]
pub enum Verb {
    /// Everything for a file, into a folder: `weavelock run plain.toml --out out`
    Run {
        file: PathBuf,
        #[arg(long, default_value = "out")]
        out: PathBuf,
    },
    /// Is it locked? By translations, by rigid motions; with a certificate: `weavelock check plain.toml --refine`
    Check {
        file: PathBuf,
        /// Part to take as fixed where none is held (the verdict does not depend on it)
        #[arg(long, value_name = "PART")]
        fix: Option<String>,
        /// Repeat with doubled samples until the verdict stands, or say that it does not (64 samples at most)
        #[arg(long)]
        refine: bool,
    },
    /// How does it come apart, and together? `weavelock plan twill.toml --json`
    Plan {
        file: PathBuf,
        /// Only these parts; the others are not there: `--of weft-0,weft-1,warp-0`
        #[arg(long, value_name = "PARTS", value_delimiter = ',')]
        of: Vec<String>,
        /// Air on each face of a contact, as "0.5 mm": plans for parts made with that clearance
        #[arg(long, value_name = "LENGTH", value_parser = length)]
        clearance: Option<f64>,
        #[command(flatten)]
        wanted: super::preferred::Asked,
    },
    /// How far do parts made with air shift and tilt? `weavelock play plain.toml --clearance "0.2 mm"`
    Play(super::play::Asked),
    /// How much clearance releases the lock? `weavelock release plain.toml --process fdm-pla`
    Release(super::release::Asked),
    /// Which part stops which: along a direction, or over all of them: `weavelock blocking roof.toml --sphere roof.svg`
    Blocking(super::blocking::Blocking),
    /// Does it need flexible parts? The fewest, all such sets, and the bound's proof: `weavelock flex plain.toml`
    Flex(super::flex::Asked),
    /// The smallest repetition of the unit tile that locks: `weavelock repeats [2,2,1] --swatch n,2n --phases all`
    Repeats(Box<super::repeats::Asked>),
    /// Hands of the tile, of weft against warp, and of the assembly: `weavelock chirality plain.toml --export hands`
    Chirality {
        #[arg(allow_hyphen_values = true, value_name = "FILE|[a,b,c]")]
        subject: String,
        /// Write the assembly and its mirror image as specs and meshes, read them back and compare them
        #[arg(long, value_name = "DIR")]
        export: Option<PathBuf>,
    },
    /// The weave itself: drawing, period, floats, family, does it hang together: `weavelock weave [7,1,3]`
    Weave {
        /// A spec, a WIF or drawn draft, or [a,b,c]
        #[arg(allow_hyphen_values = true, value_name = "FILE|[a,b,c]")]
        subject: String,
        /// Write the drawing as SVG
        #[arg(long, value_name = "FILE")]
        svg: Option<PathBuf>,
        /// Write the draft as WIF 1.1
        #[arg(long, value_name = "FILE")]
        wif: Option<PathBuf>,
    },
    /// A fabricator's package: parts, plates, sheets, coupon, checked: `weavelock fab plain.toml --out package`
    Fab(Fab),
    /// The processes that come along; with a name the file itself, to copy: `weavelock processes fdm-pla > my.toml`
    Processes { name: Option<String> },
    /// Files for other programs, in mm as the parts touch: `weavelock export plain.toml --out plain.glb`
    Export(super::exported::Export),
    /// A picture or printable instructions, without a browser: `weavelock draw plain.toml --what exploded --out a.svg`
    Draw(Box<super::draw::Draw>),
    /// Re-checks a certificate or plan without the solver that made it: `weavelock verify out/check.json`
    Verify { answer: PathBuf },
    /// The table over all [a,b,c] up to a size, with its picture: `weavelock atlas --max-n 6 --out atlas`
    Atlas(super::atlas::Asked),
    /// The page for a file, one self-contained HTML file: `weavelock report plain.toml --out plain.html`
    Report {
        file: PathBuf,
        #[arg(long, default_value = "report.html")]
        out: PathBuf,
        /// Also make a mold of this part, to be seen as it opens: `--mold weft-0`
        #[arg(long, value_name = "PART")]
        mold: Option<String>,
        /// The process whose mold that is (default: the spec's; two printed halves where that prints the part):
        /// `--mold weft-0 --process pu-resin`
        #[arg(long, value_name = "NAME|FILE", requires = "mold")]
        process: Option<String>,
    },
    /// A commented spec from four questions, or none: `weavelock new mine.toml --defaults`
    New(super::new::Asked),
    /// Completions for a shell: `weavelock completions bash`
    Completions { shell: clap_complete::Shell },
    /// The manual page, in roff: `weavelock man`
    Man,
    /// JSON Schema of the files in and of every answer: `weavelock schema`
    Schema,
}

impl Verb {
    /// What is said to run; nothing of verbs that tell of themselves.
    pub fn stage(&self) -> Option<&'static str> {
        Some(match self {
            Verb::Run { .. } | Verb::Atlas(_) => return None,
            Verb::Check { .. } => "check",
            Verb::Plan { .. } => "plan",
            Verb::Play(_) => "play",
            Verb::Release(_) => "release",
            Verb::Blocking(_) => "blocking",
            Verb::Flex(_) => "flex",
            Verb::Repeats(_) => "repeats",
            Verb::Chirality { .. } => "chirality",
            Verb::Weave { .. } => "weave",
            Verb::Fab(_) => "fab",
            Verb::Export(_) => "export",
            Verb::Draw(_) => "draw",
            Verb::Verify { .. } => "verify",
            Verb::Report { .. } => "report",
            Verb::Processes { .. } | Verb::New(_) | Verb::Completions { .. } | Verb::Man | Verb::Schema => {
                return None;
            }
        })
    }
}

/// What a package is made of, and how.
#[derive(ClapArgs, Debug)]
pub struct Fab {
    pub file: PathBuf,
    /// Process by name or file, over the spec's: `--process sla`, `--process my.toml`
    #[arg(long, value_name = "NAME|FILE")]
    pub process: Option<String>,
    /// Another process for one part: `--part weft-0=silicone-platinum`; may be given several times
    #[arg(long = "part", value_name = "ID=NAME|FILE")]
    pub parts: Vec<String>,
    #[arg(long, default_value = "package")]
    pub out: PathBuf,
    /// Replace files that are there
    #[arg(long)]
    pub force: bool,
    /// Air on each face, over the processes: `--clearance "0.25 mm"`; of one process among several:
    /// `--clearance "sla=0.1 mm"`; several with commas, or the flag again
    #[arg(long, value_name = "[PROCESS=]LENGTH", value_delimiter = ',')]
    pub clearance: Vec<String>,
    /// Lengths in mm of the coupon's 60 mm bar after a step: `--measured print=59.80,silicone=59.75`; of one process
    /// among several: `--measured sla:print=59.72`
    #[arg(long, value_name = "[PROCESS:]STEP=MM", value_delimiter = ',')]
    pub measured: Vec<String>,
    /// Print bed by name or size: `--bed ender-3`, `--bed "250 x 210 x 220 mm"`
    #[arg(long, value_name = "NAME|SIZE")]
    pub bed: Option<String>,
    /// Chamfer around the print face: `--elephant-foot "0.3 mm"`
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub elephant_foot: Option<f64>,
    /// Cut this much off below, for a flat print face: `--flatten "0.2 mm"`
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pub flatten: Option<f64>,
    /// Form molds by the parts around a part instead of the part: the direct mold, without clearance
    #[arg(long)]
    pub direct: bool,
    /// Castings of a shape at once in each mold
    #[arg(long, value_name = "N", default_value = "1", value_parser = clap::value_parser!(u8).range(1..=100))]
    pub gang: u8,
    /// Also check with OpenSCAD, PrusaSlicer (information and slicing) and ADMesh, where installed
    #[arg(long)]
    pub check: bool,
}

/// A number counted from 1.
fn counted(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|&n| n > 0).ok_or_else(|| "numbers are counted from 1".into())
}

/// Largest edge of a voxel, in mm: that of a pitch.
const MAX_EDGE_MM: f64 = 10_000.0;

fn edge(text: &str) -> Result<f64, String> {
    let mm = length(text)?;
    if mm > 0.0 && mm <= MAX_EDGE_MM {
        Ok(mm)
    } else {
        Err("a voxel is larger than 0, and at most 10 m".into())
    }
}

/// A length with its unit, in mm; none is negative.
pub fn length(text: &str) -> Result<f64, String> {
    match crate::spec::length_mm(text)? {
        mm if mm >= 0.0 => Ok(mm),
        _ => Err("a length is not negative".into()),
    }
}
